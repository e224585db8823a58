//! Cameras that frame all of a scene from a side.

use super::{broadside, facing};
use crate::scene::particles::Orientation;
use crate::scene::{Axis, Camera, Pose, Projection, Scene};
use crate::suggest;
use glam::DVec3;
use std::str::FromStr;

/// A view direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Along the principal axis of least extent.
    Auto,
    /// From a corner.
    Iso,
    /// From the end of an axis.
    Side(Axis),
}

impl View {
    /// Returns the name in options.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Iso => "iso",
            Self::Side(axis) => axis.name(),
        }
    }

    /// Returns the camera that frames all of a scene from this side; `orientation` is that of particles.
    pub fn camera(self, scene: &Scene, orientation: Option<&Orientation>) -> Camera {
        let mut camera = scene.camera.clone();
        if let Projection::Orthographic { height } = &mut camera.projection {
            *height = None;
        }
        camera.near = 0.0;
        let up = up_of_sides(orientation);
        let (direction, up) = match self {
            Self::Auto => {
                let fixed = orientation.filter(|orientation| orientation.reason.is_evident());
                let fixed = fixed.map(|orientation| orientation.up.vector());
                return broadside(&scene.spheres, &camera, fixed);
            }
            Self::Iso => {
                let up = up.vector();
                (up.abs() - up - DVec3::ONE, up)
            }
            Self::Side(side) if side == up || side == up.opposite() => {
                let [_, toward] = up.front();
                (-side.vector(), -toward)
            }
            Self::Side(side) => (-side.vector(), up.vector()),
        };
        let margin = match camera.pose {
            Pose::Fit { margin, .. } => margin,
            Pose::LookAt { .. } => Camera::FIT_MARGIN,
        };
        Camera { pose: Pose::Fit { direction, margin }, up, ..camera }
    }
}

impl FromStr for View {
    type Err = String;

    /// Parses `auto`, `iso` or the name of a side.
    fn from_str(text: &str) -> Result<Self, String> {
        let view = match text {
            "auto" => Some(Self::Auto),
            "iso" => Some(Self::Iso),
            _ => Axis::named(text).map(Self::Side),
        };
        let names = || Axis::ALL.iter().map(|(name, _)| *name).chain(["iso", "auto"]);
        view.ok_or_else(|| suggest::help(text, names(), "sides are"))
    }
}

/// Turns the scene's camera to a side, if one is given. A camera that frames all of the scene, and whose side is not
/// given, shows the caps of slices, whose `normals` point to the part that is cut away.
pub fn choose(
    scene: &mut Scene,
    view: Option<View>,
    orientation: Option<&Orientation>,
    normals: &[DVec3],
) {
    if let Some(view) = view {
        scene.camera = view.camera(scene, orientation);
    }
    let usual = orientation.map_or(Axis::Y, |orientation| orientation.up);
    if let Pose::Fit { direction, .. } = &mut scene.camera.pose {
        match view {
            None if *direction == Camera::fit_direction(usual) => {
                *direction = facing(*direction, normals);
            }
            // The opposite direction is equally broadside.
            Some(View::Auto) if faces_away(*direction, normals) => *direction = -*direction,
            _ => (),
        }
    }
}

/// Returns the direction that is up in a scene whose camera is chosen: that of the ground. In a view from above it is
/// not that of the image.
pub fn vertical(view: Option<View>, camera: &Camera, orientation: Option<&Orientation>) -> DVec3 {
    match (view, orientation) {
        (Some(View::Side(_)), Some(orientation)) => orientation.up_of_sides().vector(),
        _ => camera.up,
    }
}

/// Returns the direction that is up in views from a side: z without particles.
pub fn up_of_sides(orientation: Option<&Orientation>) -> Axis {
    orientation.map_or(Axis::Z, Orientation::up_of_sides)
}

/// Returns whether more of the planes face away from a camera than toward it.
fn faces_away(direction: DVec3, normals: &[DVec3]) -> bool {
    let count =
        |direction: DVec3| normals.iter().filter(|normal| direction.dot(**normal) < 0.0).count();
    count(direction) < count(-direction)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::UpReason;

    #[test]
    fn sides_are_read_and_named() {
        for name in ["auto", "x", "-x", "y", "-y", "z", "-z", "iso"] {
            assert_eq!(name.parse().map(View::name), Ok(name));
        }
        assert!("top".parse::<View>().is_err() && "".parse::<View>().is_err());
    }

    #[test]
    fn views_from_sides_have_what_is_up_on_top() {
        for (_, up) in Axis::ALL {
            let reason = UpReason::Chosen;
            let orientation =
                Orientation { up, reason, projection: Camera::LONG_LENS, front: None };
            for (name, side) in Axis::ALL {
                let camera = View::Side(side).camera(&Scene::default(), Some(&orientation));
                let Pose::Fit { direction, .. } = camera.pose else { panic!("it frames all") };
                assert_eq!(direction, -side.vector());
                assert_eq!(camera.up.dot(direction), 0.0, "{name}");
                let vertical = side == up || side == up.opposite();
                assert_eq!(camera.up == up.vector(), !vertical, "{name}");
            }
            let camera = View::Iso.camera(&Scene::default(), Some(&orientation));
            let Pose::Fit { direction, .. } = camera.pose else { panic!("it frames all") };
            assert_eq!(direction.dot(up.vector()), -1.0, "the camera is above");
        }
        let plain = View::Side(Axis::Z).camera(&Scene::default(), None);
        assert_eq!(plain.up, DVec3::Y);
    }
}
