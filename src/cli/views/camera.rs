//! Cameras: what is up, views from a side, projections and turntables.

use super::ViewArgs;
use crate::cli::failure::Failure;
use glam::DVec3;
use spherule_render::overlay::annotations;
use spherule_render::scene::particles::{Orientation, Particles, UpReason};
use spherule_render::scene::{Axis, Camera, Insets, Pose, Scene};
use spherule_render::suggest;
use spherule_render::world::framing::view::{self, View};
use spherule_render::world::{WorldError, framing};
use std::f64::consts::TAU;

/// The direction that is up, or `auto`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UpArg(pub(super) Option<Axis>);

impl UpArg {
    pub(super) fn name(self) -> &'static str {
        self.0.map_or("auto", Axis::name)
    }
}

/// Names of the coordinate axes.
fn axes() -> impl Iterator<Item = &'static str> + Clone {
    Axis::ALL.iter().map(|(name, _)| *name)
}

/// Parses `auto` or the name of an axis.
pub(super) fn up(text: &str) -> Result<UpArg, String> {
    let axis = Axis::named(text).map(Some);
    let up = if text == "auto" { Some(None) } else { axis };
    up.map(UpArg).ok_or_else(|| suggest::help(text, axes().chain(["auto"]), "directions are"))
}

/// 0 to 0.9.
pub(super) fn margin(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=0.9).contains(share));
    share.ok_or_else(|| "give a fraction of the image from 0 to 0.9, as in 0.05".to_owned())
}

impl ViewArgs {
    /// Returns the orientation of particles, with the direction that `--up` chooses.
    pub(in crate::cli) fn orientation(&self, particles: &Particles) -> Orientation {
        let found = Orientation::of(particles);
        match self.up {
            Some(UpArg(Some(up))) => Orientation { up, reason: UpReason::Chosen, ..found },
            Some(UpArg(None)) | None => found,
        }
    }

    /// Returns a sentence on what is up and why; `None` if the view does not depend on it.
    pub(in crate::cli) fn explain_up(&self, orientation: &Orientation) -> Option<String> {
        let reason = orientation.reason;
        let up = match self.view {
            Some(View::Auto) if !reason.is_evident() => return None,
            Some(View::Iso | View::Side(_)) => orientation.up_of_sides(),
            Some(View::Auto) | None => orientation.up,
        };
        let chosen = reason == UpReason::Chosen;
        (!chosen).then(|| format!("{} is up: {reason}; --up chooses another direction", up.name()))
    }

    /// Places the camera of a scene whose image size is set, for image `turn` of a turntable. `normals` are
    /// those of slices, as [`ViewArgs::choose`] takes them.
    pub(in crate::cli) fn frame(
        &self,
        scene: &mut Scene,
        orientation: Option<&Orientation>,
        turn: Option<u32>,
        normals: &[DVec3],
    ) -> Result<(), Failure> {
        self.choose(scene, orientation, normals)?;
        let corners = corners(scene);
        if let Some(turn) = turn {
            framing::orbit(scene, &corners, self.angle(turn));
        }
        let name = scene.title.clone();
        let failure = |error: WorldError| Failure::World(name, error);
        if corners.is_empty() {
            Ok(())
        } else {
            framing::include_points(scene, &corners).map_err(failure)
        }
    }

    /// Angle of an image of the turntable, in radians.
    pub(in crate::cli) fn angle(&self, turn: u32) -> f64 {
        TAU * f64::from(turn) / f64::from(self.turntable.unwrap_or(1))
    }

    /// Sets projection and direction of the camera of a scene, and leaves room for its annotations, but does
    /// not set its position. `orientation` is that of particles. The default view shows the caps of slices,
    /// whose `normals` point to the side that is cut away.
    pub(in crate::cli) fn choose(
        &self,
        scene: &mut Scene,
        orientation: Option<&Orientation>,
        normals: &[DVec3],
    ) -> Result<(), Failure> {
        if let Some(projection) = self.projection {
            let same = std::mem::discriminant(&projection)
                == std::mem::discriminant(&scene.camera.projection);
            if !same {
                scene.camera.projection = projection;
            }
        }
        view::choose(scene, self.view, orientation, normals);
        match (&mut scene.camera.pose, self.margin) {
            (Pose::Fit { margin, .. }, Some(typed)) => *margin = typed,
            (Pose::LookAt { .. }, Some(_)) => {
                let message = "--margin has no effect on the scene's own camera; add --view";
                return Err(Failure::usage("render", message));
            }
            (_, None) => (),
        }
        if scene.camera.insets == Insets::default() {
            scene.camera.insets = annotations::insets(scene, self.turntable.is_some());
        }
        Ok(())
    }

    /// Returns the direction that is up in a scene whose camera is chosen: that of the ground. In a view
    /// from above it is not that of the image.
    pub(in crate::cli) fn vertical(
        &self,
        camera: &Camera,
        orientation: Option<&Orientation>,
    ) -> DVec3 {
        view::vertical(self.view, camera, orientation)
    }
}

/// Points that must be in view besides spheres: the corners of a cell that is drawn.
pub(in crate::cli) fn corners(scene: &Scene) -> Vec<DVec3> {
    scene.look.cell.map_or_else(Vec::new, |cell| cell.corners().to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_read_and_named() {
        for name in ["auto", "x", "-x", "y", "-y", "z", "-z"] {
            assert_eq!(up(name).map(UpArg::name), Ok(name));
        }
        assert!(up("iso").is_err() && up("").is_err() && up("+z").is_err());
    }

    #[test]
    fn margins_are_less_than_the_whole() {
        assert_eq!(margin("0.1"), Ok(0.1));
        assert!(margin("-0.1").is_err() && margin("1").is_err() && margin("NaN").is_err());
    }
}
