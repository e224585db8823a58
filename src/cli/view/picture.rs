//! Pictures, as a viewer orders and gets them.

use super::develop::{Developed, Print};
use super::over::Drawn;
use spherule::image::Image;
use spherule::overlay::Matte;
use spherule::scene::{Camera, Look, Settings};
use std::sync::Arc;
use std::time::Duration;

/// A picture to be rendered.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Order {
    /// Of what the viewer shows: grows with every change.
    pub(super) version: u64,
    pub(super) camera: Camera,
    /// With the size and the samples of this picture.
    pub(super) settings: Settings,
    pub(super) look: Look,
    /// How the window is going to show it.
    pub(super) print: Print,
    /// Whether it is the first of its version, which is not to be broken off.
    pub(super) first: bool,
}

/// A picture that was ordered.
#[derive(Clone, Debug)]
pub(super) struct Picture {
    pub(super) version: u64,
    pub(super) samples: u32,
    /// What was rendered.
    pub(super) image: Image,
    /// The same with what is drawn over it, if anything is.
    pub(super) drawn: Option<Drawn>,
    /// The same as the window shows it.
    pub(super) developed: Option<Arc<Developed>>,
    /// Rays of the last samples, and how long they took.
    pub(super) rays: u64,
    pub(super) elapsed: Duration,
}

impl Picture {
    pub(super) fn size(&self) -> (u32, u32) {
        (self.image.width, self.image.height)
    }

    /// What is to be seen of it, and how much of each pixel is not background unless all is.
    pub(super) fn seen(&self) -> (&Image, Option<&Matte>) {
        match &self.drawn {
            Some(drawn) => (&drawn.image, drawn.matte.as_ref()),
            None => (&self.image, None),
        }
    }
}
