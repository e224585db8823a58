//! Cameras: views from a side, projections and turntables.

use super::ViewArgs;
use crate::cli::Failure;
use glam::DVec3;
use spherule_render::overlay::annotations;
use spherule_render::scene::{Camera, Insets, Pose, Projection, Scene};
use spherule_render::suggest;
use spherule_render::world::{WorldError, framing};
use std::f64::consts::TAU;

/// A view direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum View {
    /// Along the principal axis of least extent.
    Auto,
    /// Row of [`SIDES`].
    Side(usize),
}

/// Names, view directions, and up directions: z, or else y.
const SIDES: [(&str, DVec3, DVec3); 7] = [
    ("x", DVec3::NEG_X, DVec3::Z),
    ("-x", DVec3::X, DVec3::Z),
    ("y", DVec3::NEG_Y, DVec3::Z),
    ("-y", DVec3::Y, DVec3::Z),
    ("z", DVec3::NEG_Z, DVec3::Y),
    ("-z", DVec3::Z, DVec3::Y),
    ("iso", DVec3::NEG_ONE, DVec3::Z),
];

impl View {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Side(row) => SIDES[row].0,
        }
    }
}

/// Parses `auto` or the name of a side.
pub(super) fn view(text: &str) -> Result<View, String> {
    let side = SIDES.iter().position(|side| side.0 == text).map(View::Side);
    let view = if text == "auto" { Some(View::Auto) } else { side };
    let names = || SIDES.iter().map(|side| side.0).chain(["auto"]);
    view.ok_or_else(|| suggest::help(text, names(), "sides are"))
}

/// 0 to 0.9.
pub(super) fn margin(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=0.9).contains(share));
    share.ok_or_else(|| "give a fraction of the image from 0 to 0.9, as in 0.05".to_owned())
}

impl ViewArgs {
    /// Places the camera of a scene whose image size is set, for image `turn` of a turntable. `normals` are
    /// those of slices, as [`ViewArgs::choose`] takes them.
    pub(in crate::cli) fn frame(
        &self,
        scene: &mut Scene,
        turn: Option<u32>,
        normals: &[DVec3],
    ) -> Result<(), Failure> {
        self.choose(scene, normals)?;
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
    /// not set its position. The default view shows the caps of slices, whose `normals` point to the side that
    /// is cut away.
    pub(in crate::cli) fn choose(
        &self,
        scene: &mut Scene,
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
            scene.camera = of_view(view, scene);
        }
        if let Pose::Fit { direction, .. } = &mut scene.camera.pose {
            match self.view {
                None if *direction == Camera::FIT_DIRECTION => {
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

pub(super) fn of_view(view: View, scene: &Scene) -> Camera {
    let mut camera = scene.camera.clone();
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height = None;
    }
    camera.near = 0.0;
    match view {
        View::Auto => framing::broadside(&scene.spheres, &camera),
        View::Side(row) => {
            let (_, direction, up) = SIDES[row];
            let margin = match camera.pose {
                Pose::Fit { margin, .. } => margin,
                Pose::LookAt { .. } => Camera::FIT_MARGIN,
            };
            Camera { pose: Pose::Fit { direction, margin }, up, ..camera }
        }
    }
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
        for (_, direction, up) in SIDES {
            assert!(direction.cross(up).length() > 0.5);
        }
    }

    #[test]
    fn margins_are_less_than_the_whole() {
        assert_eq!(margin("0.1"), Ok(0.1));
        assert!(margin("-0.1").is_err() && margin("1").is_err() && margin("NaN").is_err());
    }
}
