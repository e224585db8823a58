//! Options for the lens of the camera.

use crate::cli::options::lists::{self, List};
use crate::cli::options::with_text::{self, WithText};
use spherule_render::compose::{Focus, LensRequest};
use spherule_render::scene::Scene;

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

fn aperture(text: &str) -> Result<f64, String> {
    let diameter = text.parse().ok().filter(|diameter| (0.0..f64::INFINITY).contains(diameter));
    diameter.ok_or_else(|| "give a diameter of 0 or more in the file's unit of length".to_owned())
}

impl LensArgs {
    /// Returns the lens that is asked for.
    pub(super) fn request(&self) -> LensRequest {
        LensRequest { aperture: self.aperture, focus: self.focus.as_deref().copied() }
    }

    /// Returns whether a focus is given that a pinhole ignores.
    pub(in crate::cli) fn is_idle(&self, scene: &Scene) -> bool {
        self.focus.is_some() && scene.camera.lens.is_none_or(|lens| lens.aperture == 0.0)
    }

    /// Settings for the image's metadata.
    pub(super) fn list(&self) -> List {
        let mut list = List::new();
        lists::put(&mut list, "aperture", self.aperture);
        with_text::insert(&mut list, "focus", &self.focus);
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn apertures_are_diameters() {
        assert_eq!((aperture("0"), aperture("0.5")), (Ok(0.0), Ok(0.5)));
        assert!(aperture("-1").is_err() && aperture("f/2").is_err() && aperture("inf").is_err());
    }
}
