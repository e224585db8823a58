//! A viewer with its scene and what it shows: what windows and scripts have in common.

use super::canvas::Canvas;
use super::command::Purpose;
use super::load::{Origin, Stage};
use super::pace::Pace;
use super::studio::{Picked, Studio};
use super::viewer::Viewer;
use crate::cli::output;
use crate::cli::render::Job;
use crate::cli::views::{corners, from_side};
use glam::DVec3;
use spherule::scene::{Camera, Pose, Projection, Scene, Settings};
use spherule::world::framing;
use std::sync::{PoisonError, RwLock, TryLockError};

/// Samples of a pixel that a viewer takes if nobody says how many.
pub(super) const SAMPLES: u32 = 1024;

/// A viewer with its scene and what it shows.
pub(super) struct Session {
    pub(super) viewer: Viewer,
    pub(super) canvas: Canvas,
    /// Where pictures are made, unless a thread of its own has it.
    pub(super) studio: Option<Studio>,
}

impl Session {
    /// A viewer of nothing yet.
    pub(super) fn new(pace: Pace) -> Self {
        let (camera, settings) = (Camera::default(), Settings::default());
        let viewer = Viewer::new(&camera, &settings, pace);
        Self { viewer, canvas: Canvas::default(), studio: None }
    }

    /// Shows the first scene.
    pub(super) fn begin(&mut self, stage: Stage, job: &Job) {
        let samples = job.picture.spp.unwrap_or(SAMPLES);
        begin(&mut self.viewer, &stage, samples);
        stage.warnings.iter().for_each(output::warn);
        self.studio = Some(Studio::new(stage, job.tracer, builder(job, &self.viewer)));
    }

    /// Drops a large world that can be read again, to make room for the next.
    pub(super) fn make_room(&mut self) {
        let is_large =
            |studio: &mut Studio| studio.stage.origin.as_ref().is_some_and(Origin::is_readable);
        drop(self.studio.take_if(is_large));
    }

    /// Shows another scene from where the camera stands.
    pub(super) fn set(&mut self, stage: Stage, job: &Job) {
        self.viewer.loaded(stage.facts.clone());
        match &mut self.studio {
            Some(studio) => studio.set(stage),
            None => {
                self.studio = Some(Studio::new(stage, job.tracer, builder(job, &self.viewer)));
            }
        }
    }

    /// Frames everything from a side, or from where the camera stands.
    pub(super) fn frame(&mut self, side: Option<&str>) {
        if let Some(studio) = &self.studio {
            frame(&mut self.viewer, &studio.stage.scene, side);
        }
    }

    /// Does with what was picked what it was picked for; returns what is to be told of it.
    pub(super) fn picked(&mut self, picked: Option<Picked>, purpose: Purpose) -> Option<String> {
        picked_by(&mut self.viewer, picked, purpose)
    }
}

/// The tree for a window's pictures.
pub(super) fn builder(job: &Job, viewer: &Viewer) -> spherule::bvh::builders::Builder {
    let Settings { width, height, spp, .. } = viewer.settings;
    let samples = u64::from(width) * u64::from(height) * u64::from(spp);
    job.builder(viewer.facts.spheres, samples)
}

/// Shows the first scene in a viewer, with so many samples in the end.
pub(super) fn begin(viewer: &mut Viewer, stage: &Stage, samples: u32) {
    let scene = stage.scene.read().unwrap_or_else(PoisonError::into_inner);
    let settings = Settings { spp: samples, ..scene.settings.clone() };
    let scale = viewer.scale;
    *viewer = Viewer::new(&scene.camera, &settings, viewer.pace);
    viewer.scale = scale;
    viewer.loaded(stage.facts.clone());
}

/// Frames everything from a side, or from where the camera stands.
pub(super) fn frame(viewer: &mut Viewer, scene: &RwLock<Scene>, side: Option<&str>) {
    let mut scene = match scene.try_write() {
        Ok(scene) => scene,
        Err(TryLockError::Poisoned(poisoned)) => poisoned.into_inner(),
        // The window does not wait for a file.
        Err(TryLockError::WouldBlock) => return viewer.say("the scene is in use: once more, soon"),
    };
    scene.camera = viewer.rig.camera.clone();
    scene.settings = viewer.settings.clone();
    scene.look = viewer.look();
    match side.and_then(|side| from_side(side, &scene)) {
        Some(camera) => scene.camera = camera,
        None => fit(&mut scene.camera),
    }
    let (up, corners) = (scene.camera.up, corners(&scene));
    if framing::hold(&mut scene, &corners).is_err() {
        return viewer.say("there is nothing to frame");
    }
    // The way that is up, not that of the picture, which leans: the camera turns about it.
    scene.camera.up = up;
    viewer.stand(scene.camera.clone());
    if side.is_some_and(|side| side != "auto") {
        viewer.rig.turn_upright(DVec3::Z);
    }
}

/// A camera that looks the same way and frames everything.
fn fit(camera: &mut Camera) {
    if let Pose::LookAt { eye, target } = camera.pose {
        camera.pose = Pose::Fit { direction: target - eye, margin: Camera::FIT_MARGIN };
    }
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height = None;
    }
}

/// Does with what was picked what it was picked for; returns what is to be told of it.
pub(super) fn picked_by(
    viewer: &mut Viewer,
    picked: Option<Picked>,
    purpose: Purpose,
) -> Option<String> {
    let Some(picked) = picked else {
        viewer.say("nothing but ground and sky is here");
        return None;
    };
    viewer.say(picked.text.clone());
    match purpose {
        Purpose::Name => {
            viewer.named = picked.kind;
            return Some(picked.text);
        }
        Purpose::Pivot => viewer.rig.turn_about(picked.point),
        Purpose::Focus => viewer.rig.focus(picked.point),
    }
    viewer.change();
    None
}
