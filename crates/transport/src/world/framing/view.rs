//! Cameras that frame all of a scene from a side.

use super::{broadside, facing};
use crate::elementary::{cos, sin};
use crate::scene::particles::Orientation;
use crate::scene::{Axis, Camera, Pose, Projection, Scene};
use crate::suggest;
use glam::DVec3;
use std::fmt;
use std::str::FromStr;

/// Minimum sine of the angle between a view and what is up in its image.
const PARALLEL: f64 = 1e-6;

/// A view direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum View {
    /// Along the principal axis of least extent.
    Auto,
    /// From a corner.
    Iso,
    /// From the end of an axis.
    Side(Axis),
    /// From a direction, in degrees.
    Angles {
        /// Counterclockwise about what is up, as seen from there; 0 is the direction of [`Axis::front`] to the right: x, if z
        /// is up.
        azimuth: f64,
        /// Above the horizon, -90 to 90.
        elevation: f64,
    },
    /// From the end of a vector, which is not 0.
    Direction(DVec3),
}

impl View {
    /// Returns whether what is up in the image is what is up in views from sides.
    pub fn is_from_side(self) -> bool {
        !matches!(self, Self::Auto)
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
            Self::Angles { azimuth, elevation } => {
                let ([right, toward], up) = (up.front(), up.vector());
                let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
                let level = right * cos(azimuth) - toward * sin(azimuth);
                let from = level * cos(elevation) + up * sin(elevation);
                // From straight above, the image has the direction on top toward which the view tilts.
                let tilted = up * cos(elevation) - level * sin(elevation);
                (-from, if cos(elevation) > PARALLEL { up } else { tilted })
            }
            Self::Direction(from) => {
                let from = from / from.abs().max_element();
                let [_, toward] = up.front();
                let up = up.vector();
                let slanted = from.normalize().cross(up).length() > PARALLEL;
                (-from, if slanted { up } else { -toward })
            }
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

    /// Parses `auto`, `iso`, the name of a side, two angles or the three components of a vector.
    fn from_str(text: &str) -> Result<Self, String> {
        if text.contains(',') {
            return of_numbers(text);
        }
        let view = match text {
            "auto" => Some(Self::Auto),
            "iso" => Some(Self::Iso),
            _ => Axis::named(text).map(Self::Side),
        };
        let names = || Axis::ALL.iter().map(|(name, _)| *name).chain(["iso", "auto"]);
        view.ok_or_else(|| {
            let help = suggest::help(text, names(), "sides are");
            format!(
                "{help}; or give azimuth and elevation, as in 30,20 or, from above, 0,90, or a vector, as in 1,1,0"
            )
        })
    }
}

impl fmt::Display for View {
    /// Writes what options take.
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Auto => formatter.write_str("auto"),
            Self::Iso => formatter.write_str("iso"),
            Self::Side(axis) => formatter.write_str(axis.name()),
            Self::Angles { azimuth, elevation } => write!(formatter, "{azimuth},{elevation}"),
            Self::Direction(DVec3 { x, y, z }) => write!(formatter, "{x},{y},{z}"),
        }
    }
}

/// Parses two angles or three components.
fn of_numbers(text: &str) -> Result<View, String> {
    let number = |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
    let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
    match numbers.as_deref() {
        Some(&[azimuth, elevation]) if (-90.0..=90.0).contains(&elevation) => {
            Ok(View::Angles { azimuth, elevation })
        }
        Some([_, elevation]) => {
            Err(format!("the elevation is {elevation}, but must be from -90 to 90 degrees"))
        }
        Some([0.0, 0.0, 0.0]) => Err("0,0,0 is no direction".to_owned()),
        Some(&[x, y, z]) => Ok(View::Direction(DVec3::new(x, y, z))),
        _ => {
            Err("give azimuth and elevation in degrees, as in 30,20, or the vector from which one \
                  looks, as in 1,1,0"
                .to_owned())
        }
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
        (Some(view), Some(orientation)) if view.is_from_side() => {
            orientation.up_of_sides().vector()
        }
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
            assert_eq!(name.parse().map(|view: View| view.to_string()).as_deref(), Ok(name));
        }
        for text in ["30,-20.5", "1,1,0", "-3,0.5,1e-6"] {
            let view: View = text.parse().expect(text);
            assert_eq!(view.to_string().parse(), Ok(view));
        }
        for text in ["top", "", "30", "0,91", "0,0,0", "1,2,3,4", "1,,2", "a,b", "nan,0", "1,inf"] {
            assert!(text.parse::<View>().is_err(), "{text}");
        }
    }

    /// The direction in which a camera looks, of unit length, and its direction that is up.
    fn seen(text: &str, up: Axis) -> (DVec3, DVec3) {
        let reason = UpReason::Chosen;
        let orientation = Orientation { up, reason, projection: Camera::LONG_LENS, front: None };
        let view: View = text.parse().expect(text);
        let camera = view.camera(&Scene::default(), Some(&orientation));
        let Pose::Fit { direction, .. } = camera.pose else { panic!("it frames all") };
        (direction.normalize(), camera.up)
    }

    #[test]
    fn angles_and_vectors_are_those_of_matplotlib() {
        for (text, side) in [
            ("0,0", Axis::X),
            ("90,0", Axis::Y),
            ("180,0", Axis::NegX),
            ("-90,0", Axis::NegY),
            ("0,90", Axis::Z),
            ("0,-90", Axis::NegZ),
            ("2,0,0", Axis::X),
            ("0,-3,0", Axis::NegY),
            ("0,0,1e-300", Axis::Z),
        ] {
            let (direction, up) = seen(text, Axis::Z);
            assert!((direction + side.vector()).length() < 1e-12, "{text}: {direction}");
            assert!(up.dot(direction).abs() < 1e-12 && up.is_normalized(), "{text}: {up}");
        }
        let (direction, up) = seen("30,20", Axis::Z);
        let (a, e) = (30_f64.to_radians(), 20_f64.to_radians());
        let from = DVec3::new(e.cos() * a.cos(), e.cos() * a.sin(), e.sin());
        assert!((direction + from).length() < 1e-12 && up == DVec3::Z, "{direction}");
        assert_eq!(seen("1,1,0", Axis::Z).0, -DVec3::new(1.0, 1.0, 0.0).normalize());
        // From above, as from the sides: x to the right, y up.
        assert_eq!(seen("-90,90", Axis::Z).1.round(), DVec3::Y);
        assert_eq!(seen("0,0,1", Axis::Z).1, seen("z", Axis::Z).1);
        assert_eq!(seen("0,-1,0", Axis::Y).1, seen("-y", Axis::Y).1);
        // Whatever is up, the azimuth turns counterclockwise about it, as seen from there.
        for (_, up) in Axis::ALL {
            let [from, turned] = ["0,0", "90,0"].map(|text| -seen(text, up).0);
            assert!((from.cross(turned) - up.vector()).length() < 1e-12, "{up:?}");
        }
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
