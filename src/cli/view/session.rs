//! A viewing session: viewer, scene and actions that windows and scripts share.

use super::canvas::Canvas;
use super::events::Purpose;
use super::frame_rate::FrameRate;
use super::load::{LoadedScene, Origin};
use super::renderer::{Picked, Renderer};
use super::viewer::Viewer;
use crate::cli::options::views::from_side;
use crate::cli::output;
use crate::cli::render::RenderSetup;
use spherule_render::compose::corners;
use spherule_render::scene::{Camera, Pose, Projection, Scene, Settings};
use spherule_render::world::framing;
use std::sync::{PoisonError, RwLock, TryLockError};

/// Default number of samples per pixel.
pub(super) const SAMPLES: u32 = 1024;

/// A viewer with its scene.
pub(super) struct Session {
    pub(super) viewer: Viewer,
    pub(super) canvas: Canvas,
    /// The renderer, unless it belongs to another thread.
    pub(super) renderer: Option<Renderer>,
}

impl Session {
    /// Creates a session without a scene.
    pub(super) fn new(frame_rate: FrameRate) -> Self {
        let (camera, settings) = (Camera::default(), Settings::default());
        let viewer = Viewer::new(&camera, &settings, frame_rate);
        Self { viewer, canvas: Canvas::default(), renderer: None }
    }

    /// Shows the first scene.
    pub(super) fn begin(&mut self, stage: LoadedScene, setup: &RenderSetup) {
        let samples = setup.picture.settings.spp().unwrap_or(SAMPLES);
        begin(&mut self.viewer, &stage, samples);
        stage.warnings.iter().for_each(output::warn);
        self.renderer = Some(Renderer::new(stage, setup.tracer, builder(setup, &self.viewer)));
    }

    /// Drops a large world that can be read again, to free memory for the next one.
    pub(super) fn drop_world(&mut self) {
        let is_large = |renderer: &mut Renderer| {
            renderer.stage.origin.as_ref().is_some_and(Origin::is_readable)
        };
        drop(self.renderer.take_if(is_large));
    }

    /// Shows another scene with the current camera.
    pub(super) fn set(&mut self, stage: LoadedScene, setup: &RenderSetup) {
        self.viewer.loaded(stage.facts.clone());
        match &mut self.renderer {
            Some(renderer) => renderer.set(stage),
            None => {
                self.renderer =
                    Some(Renderer::new(stage, setup.tracer, builder(setup, &self.viewer)));
            }
        }
    }

    /// Fits everything into view, from a side or from the current direction.
    pub(super) fn frame(&mut self, side: Option<&str>) {
        if let Some(renderer) = &self.renderer {
            frame(&mut self.viewer, &renderer.stage.scene, side);
        }
    }

    /// Handles a picked sphere by its purpose; returns the text to print.
    pub(super) fn picked(&mut self, picked: Option<Picked>, purpose: Purpose) -> Option<String> {
        picked_by(&mut self.viewer, picked, purpose)
    }
}

/// Returns the BVH builder for the viewer.
pub(super) fn builder(
    setup: &RenderSetup,
    viewer: &Viewer,
) -> spherule_render::bvh::builders::Builder {
    let Settings { width, height, spp, .. } = viewer.settings;
    let samples = u64::from(width) * u64::from(height) * u64::from(spp);
    setup.builder(viewer.facts.spheres, samples)
}

/// Shows the first scene in a viewer, with `samples` per pixel.
pub(super) fn begin(viewer: &mut Viewer, stage: &LoadedScene, samples: u32) {
    let scene = stage.scene.read().unwrap_or_else(PoisonError::into_inner);
    let settings = Settings { spp: samples, ..scene.settings.clone() };
    let scale = viewer.scale;
    *viewer = Viewer::new(&scene.camera, &settings, viewer.frame_rate);
    viewer.scale = scale;
    viewer.loaded(stage.facts.clone());
}

/// Fits everything into view, from a side or from the current direction.
pub(super) fn frame(viewer: &mut Viewer, scene: &RwLock<Scene>, side: Option<&str>) {
    let mut scene = match scene.try_write() {
        Ok(scene) => scene,
        Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
        // The window does not wait for a file that is written.
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

/// Handles a picked sphere by its purpose; returns the text to print.
pub(super) fn picked_by(
    viewer: &mut Viewer,
    picked: Option<Picked>,
    purpose: Purpose,
) -> Option<String> {
    let Some(picked) = picked else {
        viewer.show_message("no sphere here");
        return None;
    };
    viewer.show_message(picked.text.clone());
    match purpose {
        Purpose::Name => {
            viewer.named = picked.kind;
            return Some(picked.text);
        }
        Purpose::Pivot => viewer.control.set_pivot(picked.point),
        Purpose::Focus => viewer.control.focus(picked.point),
    }
    viewer.change();
    None
}
