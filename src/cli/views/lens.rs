//! Options for the lens of the camera.

use crate::cli::failure::Failure;
use crate::cli::settings::List;
use crate::cli::with_text::{self, WithText};
use glam::DVec3;
use serde_json::json;
use spherule_render::scene::{Lens, Scene};
use spherule_render::world::{WorldError, framing};
use std::str::FromStr;

/// Options for the lens.
#[derive(Clone, Debug, Default, clap::Args)]
pub(in crate::cli) struct LensArgs {
    /// Depth of field: diameter of the camera's lens in the file's unit of length; 0 is a pinhole. Points at
    /// the depth D, with the focus at F, are blurred to discs of the diameter |D / F - 1| times this [default:
    /// the scene's lens, or a pinhole]
    #[arg(long, value_name = "DIAMETER", allow_hyphen_values = true, value_parser = aperture)]
    aperture: Option<f64>,
    /// Focus of the lens: id:ID of a particle in the column of ids, or without one its number from 0; or a
    /// distance from the camera along the view axis [default: the middle of the particles, or the scene's]
    #[arg(
        long,
        value_name = "id:ID|DISTANCE",
        allow_hyphen_values = true,
        value_parser = |text: &str| text.parse::<WithText<Focus>>()
    )]
    focus: Option<WithText<Focus>>,
}

/// The point or particle in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Focus {
    /// The center of a particle.
    Particle(f64),
    /// A distance along the view axis.
    Distance(f64),
}

impl FromStr for Focus {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number =
            |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        let focus = match text.strip_prefix("id:") {
            Some(id) => number(id).map(Self::Particle),
            None => number(text).filter(|distance| *distance > 0.0).map(Self::Distance),
        };
        focus.ok_or_else(|| {
            "give the id of a particle, as in id:1234, or a distance greater than 0".to_owned()
        })
    }
}

fn aperture(text: &str) -> Result<f64, String> {
    let diameter = text.parse().ok().filter(|diameter| (0.0..f64::INFINITY).contains(diameter));
    diameter.ok_or_else(|| "give a diameter of 0 or more in the file's unit of length".to_owned())
}

impl LensArgs {
    /// Returns the id of the particle in focus, if the focus is a particle.
    pub(in crate::cli) fn particle(&self) -> Option<f64> {
        match self.focus.as_deref() {
            Some(Focus::Particle(id)) => Some(*id),
            Some(Focus::Distance(_)) | None => None,
        }
    }

    /// Returns whether a focus is given that a pinhole ignores.
    pub(in crate::cli) fn is_idle(&self, scene: &Scene) -> bool {
        self.focus.is_some() && scene.camera.lens.is_none_or(|lens| lens.aperture == 0.0)
    }

    /// Settings for the image's metadata.
    pub(super) fn list(&self) -> List {
        let mut list = List::new();
        if let Some(aperture) = self.aperture {
            list.insert("aperture".to_owned(), json!(aperture));
        }
        with_text::insert(&mut list, "focus", &self.focus);
        list
    }

    /// Sets the lens of a scene's camera, whose view is chosen; `point` is the center of the particle in
    /// focus, if the focus is a particle.
    pub(super) fn set(&self, scene: &mut Scene, point: Option<DVec3>) -> Result<(), Failure> {
        if let Some(aperture) = self.aperture {
            let focus = scene.camera.lens.and_then(|lens| lens.focus);
            scene.camera.lens = Some(Lens { aperture, focus });
        }
        let Some(focus) = self.focus.as_deref() else { return Ok(()) };
        if scene.camera.lens.is_none() {
            let message = "--focus needs a lens; add --aperture with its diameter";
            return Err(Failure::usage("render", message));
        }
        let distance = match (focus, point) {
            (Focus::Distance(distance), _) => *distance,
            // Frames of a trajectory may be empty.
            (Focus::Particle(_), None) if scene.is_empty() => return Ok(()),
            (Focus::Particle(_), None) => {
                let message = "--focus id:ID needs a particle file; give a distance";
                return Err(Failure::usage("render", message));
            }
            (Focus::Particle(id), Some(point)) => {
                // The vertical axis of the scene stays, which lights follow.
                let up = scene.camera.up;
                let name = scene.title.clone();
                let failure = |error: WorldError| Failure::World(name, error);
                framing::include_points(scene, &[]).map_err(failure)?;
                let depth = framing::depth(&scene.camera, point);
                scene.camera.up = up;
                depth.filter(|depth| *depth > 0.0).ok_or_else(|| {
                    let message = format!("--focus: the particle {id} is behind the camera");
                    Failure::usage("render", message)
                })?
            }
        };
        if let Some(lens) = &mut scene.camera.lens {
            lens.focus = Some(distance);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_render::scene::{Camera, Pose, Rgb};

    #[test]
    fn focuses_are_particles_or_distances() {
        assert_eq!("id:12".parse(), Ok(Focus::Particle(12.0)));
        assert_eq!("2.5".parse(), Ok(Focus::Distance(2.5)));
        for text in ["", "id:", "id:a", "0", "-1", "inf", "nan", "12:id"] {
            assert!(text.parse::<Focus>().is_err(), "{text}");
        }
        assert_eq!((aperture("0"), aperture("0.5")), (Ok(0.0), Ok(0.5)));
        assert!(aperture("-1").is_err() && aperture("f/2").is_err() && aperture("inf").is_err());
    }

    #[test]
    fn particles_are_in_focus_from_the_camera_that_frames_all() {
        let mut scene = Scene::default();
        for x in 0..4 {
            scene.spheres.push(DVec3::X * f64::from(x), 0.5, 0, Rgb::ONE);
        }
        scene.camera = Camera {
            pose: Pose::Fit { direction: DVec3::NEG_X, margin: 0.0 },
            ..Camera::default()
        };
        let lens = |focus: &str| LensArgs {
            aperture: Some(0.2),
            focus: Some(focus.parse().expect("a focus")),
        };
        let mut focused = scene.clone();
        lens("id:3").set(&mut focused, Some(DVec3::X)).expect("in front of the camera");
        let Pose::LookAt { eye, .. } = focused.camera.pose else { panic!("a fixed camera") };
        let focus = focused.camera.lens.and_then(|lens| lens.focus).expect("a focus");
        assert!((focus - (eye.x - 1.0)).abs() < 1e-9, "{focus} {eye}");
        assert!(lens("id:3").set(&mut scene.clone(), Some(DVec3::X * 1e6)).is_err());
        assert!(lens("id:3").set(&mut scene.clone(), None).is_err());
        assert!(lens("id:3").set(&mut Scene::default(), None).is_ok(), "an empty frame");
        let idle = LensArgs { aperture: None, ..lens("4") };
        assert!(idle.set(&mut scene, None).is_err(), "a pinhole");
        lens("4").set(&mut scene, None).expect("a distance");
        assert_eq!(scene.camera.lens, Some(Lens { aperture: 0.2, focus: Some(4.0) }));
    }
}
