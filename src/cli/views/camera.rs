//! Cameras: what is up, views from a side, projections and turntables.

use super::ViewArgs;
use crate::cli::Failure;
use glam::DVec3;
use spherule_render::overlay::annotations;
use spherule_render::scene::particles::{Orientation, Particles, UpReason};
use spherule_render::scene::{Axis, Camera, Insets, Pose, Projection, Scene};
use spherule_render::suggest;
use spherule_render::world::{WorldError, framing};
use std::f64::consts::TAU;

/// A view direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum View {
    /// Along the principal axis of least extent.
    Auto,
    /// From a corner.
    Iso,
    /// From the end of an axis.
    Side(Axis),
}

/// The direction that is up, or `auto`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UpArg(pub(super) Option<Axis>);

impl View {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Iso => "iso",
            Self::Side(axis) => axis.name(),
        }
    }
}

impl UpArg {
    pub(super) fn name(self) -> &'static str {
        self.0.map_or("auto", Axis::name)
    }
}

/// Names of the coordinate axes.
fn axes() -> impl Iterator<Item = &'static str> + Clone {
    Axis::ALL.iter().map(|(name, _)| *name)
}

/// Parses `auto`, `iso` or the name of a side.
pub(super) fn view(text: &str) -> Result<View, String> {
    let view = match text {
        "auto" => Some(View::Auto),
        "iso" => Some(View::Iso),
        _ => Axis::named(text).map(View::Side),
    };
    view.ok_or_else(|| suggest::help(text, axes().chain(["iso", "auto"]), "sides are"))
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
        if let Some(view) = self.view {
            scene.camera = of_view(view, scene, orientation);
        }
        let usual = orientation.map_or(Axis::Y, |orientation| orientation.up);
        if let Pose::Fit { direction, .. } = &mut scene.camera.pose {
            match self.view {
                None if *direction == Camera::fit_direction(usual) => {
                    *direction = framing::facing(*direction, normals);
                }
                // The opposite direction is equally broadside.
                Some(View::Auto) if faces_away(*direction, normals) => *direction = -*direction,
                _ => (),
            }
        }
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
        match (self.view, orientation) {
            (Some(View::Side(_)), Some(orientation)) => orientation.up_of_sides().vector(),
            _ => camera.up,
        }
    }
}

/// Returns whether more of the planes face away from a camera than toward it.
fn faces_away(direction: DVec3, normals: &[DVec3]) -> bool {
    let count =
        |direction: DVec3| normals.iter().filter(|normal| direction.dot(**normal) < 0.0).count();
    count(direction) < count(-direction)
}

/// Points that must be in view besides spheres: the corners of a cell that is drawn.
pub(in crate::cli) fn corners(scene: &Scene) -> Vec<DVec3> {
    scene.look.cell.map_or_else(Vec::new, |cell| cell.corners().to_vec())
}

/// Returns the direction that is up in views from a side: z without particles.
pub(super) fn up_of_sides(orientation: Option<&Orientation>) -> Axis {
    orientation.map_or(Axis::Z, Orientation::up_of_sides)
}

/// Returns the camera that frames all of a scene from a side.
pub(super) fn of_view(view: View, scene: &Scene, orientation: Option<&Orientation>) -> Camera {
    let mut camera = scene.camera.clone();
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height = None;
    }
    camera.near = 0.0;
    let up = up_of_sides(orientation);
    let (direction, up) = match view {
        View::Auto => {
            let fixed = orientation.filter(|orientation| orientation.reason.is_evident());
            let fixed = fixed.map(|orientation| orientation.up.vector());
            return framing::broadside(&scene.spheres, &camera, fixed);
        }
        View::Iso => {
            let up = up.vector();
            (up.abs() - up - DVec3::ONE, up)
        }
        View::Side(side) if side == up || side == up.opposite() => {
            let [_, toward] = up.front();
            (-side.vector(), -toward)
        }
        View::Side(side) => (-side.vector(), up.vector()),
    };
    let margin = match camera.pose {
        Pose::Fit { margin, .. } => margin,
        Pose::LookAt { .. } => Camera::FIT_MARGIN,
    };
    Camera { pose: Pose::Fit { direction, margin }, up, ..camera }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_read_and_named() {
        for name in ["auto", "x", "-x", "y", "-y", "z", "-z", "iso"] {
            assert_eq!(view(name).map(View::name), Ok(name));
        }
        assert!(view("top").is_err() && view("").is_err());
        for name in ["auto", "x", "-x", "y", "-y", "z", "-z"] {
            assert_eq!(up(name).map(UpArg::name), Ok(name));
        }
        assert!(up("iso").is_err() && up("").is_err() && up("+z").is_err());
    }

    #[test]
    fn views_from_sides_have_what_is_up_on_top() {
        for (_, up) in Axis::ALL {
            let reason = UpReason::Chosen;
            let orientation = Orientation { up, reason, projection: Camera::LONG_LENS };
            for (name, side) in Axis::ALL {
                let camera = of_view(View::Side(side), &Scene::default(), Some(&orientation));
                let Pose::Fit { direction, .. } = camera.pose else { panic!("it frames all") };
                assert_eq!(direction, -side.vector());
                assert_eq!(camera.up.dot(direction), 0.0, "{name}");
                let vertical = side == up || side == up.opposite();
                assert_eq!(camera.up == up.vector(), !vertical, "{name}");
            }
            let camera = of_view(View::Iso, &Scene::default(), Some(&orientation));
            let Pose::Fit { direction, .. } = camera.pose else { panic!("it frames all") };
            assert_eq!(direction.dot(up.vector()), -1.0, "the camera is above");
        }
        let plain = of_view(View::Side(Axis::Z), &Scene::default(), None);
        assert_eq!(plain.up, DVec3::Y);
    }

    #[test]
    fn margins_are_less_than_the_whole() {
        assert_eq!(margin("0.1"), Ok(0.1));
        assert!(margin("-0.1").is_err() && margin("1").is_err() && margin("NaN").is_err());
    }
}
