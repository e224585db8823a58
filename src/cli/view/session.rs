//! Changes of a viewer by its scene: what pages and scripts share.

use super::events::{Picked, Purpose};
use super::load::LoadedScene;
use super::viewer::{SELECTED, Viewer};
use crate::cli::options::views::from_side;
use spherule_render::compose::{Descriptions, corners};
use spherule_render::scene::{Camera, Measure, Pose, Projection, Scene, Settings};
use spherule_render::world::framing;
use std::collections::{HashMap, HashSet};
use std::sync::{PoisonError, RwLock, TryLockError};

/// Default number of samples per pixel.
const SAMPLES: u32 = 1024;

/// Shows the first scene in a viewer.
pub(super) fn begin(viewer: &mut Viewer, stage: &LoadedScene) {
    let (camera, settings) = view_of(stage);
    let (scale, content) = (viewer.scale, std::mem::take(&mut viewer.content));
    *viewer = Viewer::new(&camera, &settings, viewer.frame_rate);
    (viewer.scale, viewer.content) = (scale, content);
    viewer.loaded(stage.facts.clone());
    viewer.history.begin(viewer.state());
}

/// Shows another scene, with the current camera and settings unless options changed them.
pub(super) fn set(viewer: &mut Viewer, stage: &LoadedScene) {
    let (camera, settings) = view_of(stage);
    if std::mem::take(&mut viewer.takes_settings) {
        let Settings { width, height, .. } = viewer.settings;
        viewer.settings = Settings { width, height, ..settings };
    }
    if std::mem::take(&mut viewer.takes_camera) {
        viewer.home = camera.clone();
        viewer.set_camera(camera);
    }
    viewer.loaded(stage.facts.clone());
    find_picked(viewer, stage);
    viewer.history.amend(viewer.state());
}

/// Camera and settings of a scene, as the viewer has them.
fn view_of(stage: &LoadedScene) -> (Camera, Settings) {
    let scene = stage.scene.read().unwrap_or_else(PoisonError::into_inner);
    let spp = stage.samples.unwrap_or(SAMPLES);
    let settings = Settings { spp, until_error: None, time: None, ..scene.settings.clone() };
    (scene.camera.clone(), settings)
}

/// Fits everything into view, from a side or from the current direction.
pub(super) fn frame(viewer: &mut Viewer, scene: &RwLock<Scene>, side: Option<&str>) {
    let mut scene = match scene.try_write() {
        Ok(scene) => scene,
        Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
        // The viewer does not wait for a file that is written.
        Err(TryLockError::WouldBlock) => {
            return viewer.show_message("the scene is being saved; try again");
        }
    };
    scene.camera = viewer.control.camera.clone();
    scene.settings = viewer.settings.clone();
    scene.look = viewer.look();
    let orientation = viewer.facts.orientation;
    let seen = side.and_then(|side| from_side(side, &scene, orientation.as_ref()));
    let up = seen.as_ref().map(|(_, up)| *up);
    match seen {
        Some((camera, _)) => scene.camera = camera,
        None => fit(&mut scene.camera),
    }
    let corners = corners(&scene);
    if framing::include_points(&mut scene, &corners).is_err() {
        return viewer.show_message("no spheres to fit into view");
    }
    viewer.set_camera(scene.camera.clone());
    if let Some(up) = up.filter(|_| side != Some("auto")) {
        viewer.control.set_vertical(up.vector());
    }
}

/// Returns a camera with the same direction that shows everything.
fn fit(camera: &mut Camera) {
    if let Pose::LookAt { eye, target } = camera.pose {
        camera.pose = Pose::Fit { direction: target - eye, margin: Camera::FIT_MARGIN };
    }
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height = None;
    }
}

/// Selects a sphere beside others, or no longer if it is selected; returns the text to print.
fn add(viewer: &mut Viewer, picked: Picked) -> Option<String> {
    if let Some(own) = viewer.picked.iter().position(|own| own.center == picked.center) {
        viewer.picked.remove(own);
        return None;
    }
    if viewer.picked.len() == SELECTED {
        viewer.show_message(format!("{SELECTED} are selected; click without Shift to begin anew"));
        return None;
    }
    let text = picked.text.clone();
    viewer.picked.push(picked);
    let measure = measure(viewer, false);
    if let Some(measure) = &measure {
        viewer.show_message(measure.clone());
    }
    Some(measure.map_or_else(|| text.clone(), |measure| format!("{text}\n{measure}")))
}

/// Selects spheres instead of those that are selected.
pub(super) fn select(viewer: &mut Viewer, picked: Vec<Picked>) {
    viewer.show_message(match &picked[..] {
        [] => "no particle is selected".to_owned(),
        [own] => own.text.clone(),
        several => format!("{} particles are selected", several.len()),
    });
    viewer.named = picked.last().and_then(|own| own.kind.clone());
    viewer.picked = picked;
}

/// Returns what two to four selected spheres measure, perhaps between nearest periodic images.
pub(super) fn measure(viewer: &Viewer, periodic: bool) -> Option<String> {
    let name = ["distance", "angle", "dihedral"].get(viewer.picked.len().checked_sub(2)?)?;
    let points = viewer.picked.iter().map(|picked| picked.center).collect();
    let mut measure = Measure { points, unit: viewer.facts.unit.to_owned() };
    if periodic {
        let cell = viewer.facts.cell.filter(|cell| cell.periodic.contains(&true))?;
        measure = measure.with_nearest_images(&cell);
    }
    Some(format!("{name} {}", measure.text()))
}

/// Finds the selected spheres in another scene, as of another frame; those that are not there are no longer selected.
fn find_picked(viewer: &mut Viewer, stage: &LoadedScene) {
    if viewer.picked.is_empty() {
        return;
    }
    if stage.origin.is_some() {
        // There is only a sketch of the spheres.
        return viewer.picked.clear();
    }
    let scene = stage.scene.read().unwrap_or_else(PoisonError::into_inner);
    let wanted: HashSet<u64> =
        viewer.picked.iter().filter_map(|own| own.id).map(f64::to_bits).collect();
    let rows =
        (0..scene.spheres.len()).filter_map(|row| Some((stage.labels.id(row)?.to_bits(), row)));
    // Of copies, the first.
    let rows: HashMap<u64, usize> = rows.filter(|(id, _)| wanted.contains(id)).rev().collect();
    let descriptions = Descriptions::new(&stage.labels, stage.facts.size);
    viewer.picked.retain_mut(|picked| {
        let row = picked.id.and_then(|id| rows.get(&id.to_bits()));
        row.inspect(|&&row| {
            (picked.center, picked.radius) = (scene.spheres.center(row), scene.spheres.radius[row]);
            picked.text = descriptions.text(row, picked.center, picked.radius);
        })
        .is_some()
    });
}

/// Handles a picked sphere by its purpose; returns the text to print.
pub(super) fn picked_by(
    viewer: &mut Viewer,
    picked: Option<Picked>,
    purpose: Purpose,
) -> Option<String> {
    if purpose == Purpose::Hover {
        return picked.map(|picked| picked.text);
    }
    let Some(picked) = picked else {
        if purpose == Purpose::Name {
            viewer.picked.clear();
        }
        viewer.show_message("no sphere here");
        return None;
    };
    viewer.show_message(picked.text.clone());
    match purpose {
        Purpose::Name => {
            viewer.named.clone_from(&picked.kind);
            viewer.picked = vec![picked.clone()];
            return Some(picked.text);
        }
        Purpose::Add => return add(viewer, picked),
        Purpose::Pivot => viewer.control.set_pivot(picked.point),
        Purpose::Focus => viewer.control.focus(picked.point),
        Purpose::Hover => (),
    }
    viewer.change();
    None
}
