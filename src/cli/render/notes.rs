//! Notes about options that have no effect.

use super::setup::RenderSetup;
use crate::cli::options::appearance::BarPlace;
use crate::cli::options::settings::option_name;
use crate::cli::source::Source;
use spherule_render::World;
use spherule_render::compose::Staged;
use spherule_render::graphics;
use spherule_render::image::{Depth, Format};
use spherule_render::scene::{Integrator, LetterSize, Scene, Settings, Tone};
use spherule_render::settings::{INTEGRATORS, Need, Scope, Setting, Value};
use spherule_render::trace::Traversal;

/// The bounce at which Russian roulette by throughput starts, from 1.
const ROULETTE_BEGINS: u32 = 4;

/// Returns a sentence for each option that has no effect.
pub(super) fn notes(setup: &RenderSetup, scene: &Scene, world: &World) -> Vec<String> {
    let settings = &scene.settings;
    let mut notes = Vec::new();
    let mut note = |asked: bool, idle: bool, name: &str, why: &str| {
        if asked && idle {
            notes.push(format!("{name} has no effect: {why}"));
        }
    };
    let picture = &setup.picture.settings;
    for setting in picture.given() {
        let name = format!("--{}", option_name(setting));
        let reason = idle_reason(setting, settings, world);
        note(true, reason.is_some(), &name, reason.as_deref().unwrap_or_default());
    }
    let ao = matches!(settings.integrator, Integrator::Ao { .. });
    let materials = setup.request.style.types.iter().any(|look| look.properties.material.is_some());
    let matte = "the integrator ao ignores materials";
    note(materials, ao, "--type with a material", matte);
    let short = settings.depth.is_some_and(|depth| depth < ROULETTE_BEGINS);
    let late = !ao && short && picture.value("roulette") == Some(Value::Word("throughput"));
    note(late, true, "--roulette throughput", "it starts at the fourth bounce, beyond --depth");
    let alone = matches!(setup.speed.traversal, Traversal::Single | Traversal::Stream);
    note(
        setup.speed.lanes.is_some(),
        alone,
        "--lanes",
        "--traversal scalar and stream trace no packets",
    );
    let encoding = setup.encoding;
    let linear = setup.format.is_linear();
    let holds = format!("{} files store linear radiance", setup.format);
    note(exposed(setup, settings), linear, "exposure", &holds);
    note(toned(setup, settings), linear, "tone", &holds);
    note(encoding.bits.is_some(), linear, "--bits", "EXR and PFM files store 32-bit floats");
    let eight = !linear && !setup.format.has_sixteen_bits();
    let deep = encoding.bits.is_some_and(|bits| bits != Depth::Eight);
    note(deep, eight, "--bits", &format!("{} files store 8 bits", setup.format));
    let lossless = setup.format != Format::Jpeg;
    note(encoding.quality.is_some(), lossless, "--quality", "the output is not JPEG");
    let part = setup.part.is_some();
    note(encoding.bits.is_some(), part, "--bits", "parts are not images; use it with merge");
    note(encoding.ppm.is_some(), part, "--ppm", "parts are not images; use it with merge");
    note(encoding.ppm.is_some(), setup.format != Format::Ppm, "--ppm", "the output is not PPM");
    let pdf = setup.page == Some(graphics::Format::Pdf);
    note(deep, pdf, "--bits", "PDF files store 8 bits");
    note(
        setup.views.has_idle_focus(scene),
        true,
        "--focus",
        "the lens is a pinhole; set --aperture",
    );
    let bare = scene.annotations.is_empty();
    let sizes = settings.paper().is_some()
        || matches!(setup.color_bar, Some(BarPlace::File(..)))
        || !bare && !matches!(scene.annotations.lettering.size, Some(LetterSize::Share(_)));
    let unsized_file = !setup.format.has_resolution() && !sizes;
    let why = "the output's format stores no resolution";
    note(encoding.display.value("dpi").is_some(), unsized_file, "--dpi", why);
    let letters = setup.annotations.lettering();
    note(letters.is_some(), bare, letters.unwrap_or_default(), "the image has no annotations");
    notes
}

/// Returns a sentence for each option that has no effect on a scene of particles.
pub(super) fn of_staged(setup: &RenderSetup, staged: &Staged) -> Vec<String> {
    let Source::Particles(_, options) = &setup.source else { return Vec::new() };
    if setup.is_of_sequence() {
        // Other frames may show an effect.
        return Vec::new();
    }
    let (scene, style) = (&staged.scene, &setup.request.style);
    let is_single = staged.first_frame.is_none();
    let single = "the file has a single frame";
    let is_opaque = scene.materials.iter().all(|row| row.material.opacity() >= 1.0);
    let is_uncut = staged.normals.is_empty();
    let rules = [
        (options.smooth > 0 && is_single, "--smooth", single),
        (options.trail > 0 && is_single, "--trail", single),
        (!setup.slices.planes().is_empty() && is_uncut, "--slice", "the planes cut nothing"),
        (style.translucent.is_some() && is_opaque, "--translucent", "no particle is translucent"),
        (
            style.bond_radius.is_some() && scene.sticks.is_empty(),
            "--bond-radius",
            "no bonds are drawn",
        ),
    ];
    let idle = rules.into_iter().filter(|(is_idle, ..)| *is_idle && !scene.is_empty());
    idle.map(|(_, name, why)| format!("{name} has no effect: {why}")).collect()
}

/// Returns the reason why a setting has no effect, if it has none.
fn idle_reason(setting: &Setting, settings: &Settings, world: &World) -> Option<String> {
    let integrator = INTEGRATORS.name(&settings.integrator);
    if let Scope::Only(users) | Scope::ParameterOf(users) = setting.scope
        && !users.contains(&integrator)
    {
        return Some(format!("it applies only to the integrator {}", users.join(" and ")));
    }
    let path = settings.integrator == Integrator::Path;
    let (is_met, reason) = match setting.need {
        Need::Nothing => return None,
        Need::Bounces => (integrator != "ao", "the integrator ao traces no paths"),
        Need::Light => (world.features.lights, "the scene has no lights to sample"),
        Need::Lights => (world.lights.len() >= 2, "the scene has fewer than two lights"),
        Need::Caustics => {
            let sampled = path && world.samples_specular_light();
            (sampled, "the scene has no caustics that are sampled")
        }
    };
    (!is_met).then(|| reason.to_owned())
}

/// Returns whether the command or the scene sets an exposure.
fn exposed(setup: &RenderSetup, settings: &Settings) -> bool {
    setup.encoding.display.value("exposure").is_some() || settings.exposure != 0.0
}

/// Returns whether the command or the scene sets a tone curve.
fn toned(setup: &RenderSetup, settings: &Settings) -> bool {
    setup.encoding.display.value("tone").is_some() || settings.tone != Tone::Linear
}
