//! The sections of a scene file as text.

use crate::scene::bodies::FileBodies;
use crate::scene::keys::{GroundKeys, quoted, section_text};
use crate::scene::{Annotations, Lettering, Look, Scene};
use crate::settings::{SETTINGS, Setting, Settings, Value};

pub(super) fn render(settings: &Settings) -> String {
    let paper = settings.paper();
    let line = |setting: &Setting| match setting.get(settings) {
        // Without the key there is no limit.
        Value::None | Value::Word("inf") => String::new(),
        // Nor does it decide when the render stops.
        _ if setting.name == "spp" && is_undecided(settings) => String::new(),
        pixels @ Value::Size(_) => {
            let size = paper.map_or_else(|| pixels.to_string(), |paper| quoted(&paper.text()));
            format!("size = {size}\n")
        }
        Value::Word(word) => format!("{} = \"{word}\"\n", setting.name),
        value => format!("{} = {value}\n", setting.name),
    };
    format!("[render]\n{}\n", SETTINGS.iter().map(line).collect::<String>())
}

/// Returns whether it is left to the program when a render stops.
fn is_undecided(settings: &Settings) -> bool {
    !settings.stop_given && !settings.has_target() && settings.spp == Settings::default().spp
}

/// Nothing if nothing is drawn over the picture.
pub(in crate::scene) fn look(look: &Look) -> String {
    if *look == Look::default() { String::new() } else { section_text(look) }
}

/// Returns the sections of all annotations; empty if there are none.
pub(in crate::scene) fn annotations(annotations: &Annotations) -> String {
    let Annotations { color_bar, legend, axes, scale_bar, labels, measures, lettering } =
        annotations;
    let mut text = color_bar.as_ref().map_or_else(String::new, section_text);
    text += &legend.as_ref().map_or_else(String::new, section_text);
    text += &axes.as_ref().map_or_else(String::new, section_text);
    text += &scale_bar.as_ref().map_or_else(String::new, section_text);
    text.extend(labels.iter().map(section_text));
    text.extend(measures.iter().map(section_text));
    if *lettering != Lettering::default() {
        text += &section_text(lettering);
    }
    text
}

/// The section of the ground.
pub(super) fn ground(scene: &Scene) -> String {
    let section = scene.ground.clone().map(|ground| {
        let material = Some(quoted(&scene.materials[ground.material as usize].name));
        section_text(&GroundKeys { ground, material })
    });
    section.unwrap_or_default()
}

/// The sections of bodies; `material` gives the name of a row of the materials.
pub(in crate::scene) fn bodies(
    bodies: &dyn FileBodies,
    material: impl Fn(u32) -> String,
) -> String {
    let materials = bodies.materials().iter().enumerate();
    materials.map(|(row, &name)| bodies.section(row, material(name))).collect()
}
