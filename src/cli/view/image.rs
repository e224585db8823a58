//! Render requests of the viewer, and their images.

use super::frame_rate::Moving;
use super::tonemap::DisplaySettings;
use spherule_render::image::Image;
use spherule_render::noise::Noise;
use spherule_render::overlay::Matte;
use spherule_render::scene::{Camera, Look, Settings};
use std::sync::Arc;
use std::time::{Duration, Instant};

/// The way to render an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quality {
    /// Without noise, but with direct light alone.
    Preview { shadows: bool },
    /// With the samples and the integrator of the settings.
    Sampled,
}

/// A render request.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RenderRequest {
    /// Version of the view, which grows with every change.
    pub(super) version: u64,
    pub(super) camera: Camera,
    /// Settings with the size and the samples of this image.
    pub(super) settings: Settings,
    pub(super) quality: Quality,
    pub(super) look: Look,
    /// True if it has the size of the page's image.
    pub(super) whole: bool,
    pub(super) display: DisplaySettings,
    /// True for the first image of its version, which is not cancelled.
    pub(super) first: bool,
}

/// A rendered image.
#[derive(Clone, Debug)]
pub(super) struct Picture {
    pub(super) version: u64,
    pub(super) camera: Camera,
    /// Samples per pixel; 0 for a preview.
    pub(super) samples: u32,
    pub(super) quality: Quality,
    /// The rendered image.
    pub(super) image: Image,
    /// Estimated error of the image; `None` for a preview, and as long as it is unknown.
    pub(super) noise: Option<Noise>,
    /// Estimated error before denoising, if the image is denoised.
    pub(super) before: Option<Noise>,
    /// The image with overlays, if there are any.
    pub(super) drawn: Option<OverlaidImage>,
    /// Display values of what is shown: `0x00RRGGBB`, row by row from the top left.
    pub(super) pixels: Arc<Vec<u32>>,
    /// Rays of the last samples, and their time.
    pub(super) rays: u64,
    pub(super) elapsed: Duration,
    /// Start of the render.
    pub(super) started: Instant,
}

/// An image with overlays.
#[derive(Clone, Debug)]
pub(super) struct OverlaidImage {
    pub(super) image: Image,
    /// The part of each pixel that is not background, with premultiplied colors; `None` for an opaque image.
    pub(super) matte: Option<Matte>,
}

impl Picture {
    pub(super) fn size(&self) -> (u32, u32) {
        (self.image.width, self.image.height)
    }

    /// Returns its size and shadows, as a preview.
    pub(super) fn moving(&self) -> Moving {
        let shadows = self.quality == Quality::Preview { shadows: true };
        Moving { size: self.size(), shadows }
    }

    /// Returns the image to show, with its matte if it is transparent.
    pub(super) fn visible(&self) -> (&Image, Option<&Matte>) {
        match &self.drawn {
            Some(drawn) => (&drawn.image, drawn.matte.as_ref()),
            None => (&self.image, None),
        }
    }
}
