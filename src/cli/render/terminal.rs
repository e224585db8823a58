//! The picture in the terminal, while it refines.
//!
//! `viuer` finds out what the terminal can: the protocols of Kitty and iTerm, sixels, or else two
//! pixels in each character, one above the other.

use crate::cli::failure::Failure;
use crate::cli::output;
use image::{DynamicImage, RgbImage};
use spherule::image::Image;
use spherule::image::tone::{Codes8, DisplayTransform};
use spherule::scene::Settings;
use std::io::{IsTerminal, Write, stdin, stdout};
use std::time::{Duration, Instant};
use viuer::Config;

/// Least time between two pictures; and in times of what drawing the last one took.
const PAUSE: (Duration, u32) = (Duration::from_millis(250), 20);

/// A place in the terminal where one picture after another is drawn.
pub(super) struct Terminal {
    table: Codes8,
    /// Lines of the picture that is there.
    lines: u32,
    /// Time that it took to draw it.
    took: Duration,
    /// Whether there was something wrong, and no more is drawn.
    failed: bool,
}

/// Refuses to draw where nothing answers the question what can be drawn.
pub(super) fn check(wanted: bool) -> Result<(), Failure> {
    if wanted && !(stdin().is_terminal() && stdout().is_terminal()) {
        let message = "--terminal is for a terminal, not for files and pipes";
        return Err(Failure::usage("render", message));
    }
    Ok(())
}

impl Terminal {
    /// A place for pictures that are shown as these settings say.
    pub(super) fn new(settings: &Settings) -> Self {
        let transform = DisplayTransform::new(settings.exposure, settings.tone);
        Self { table: Codes8::new(transform), lines: 0, took: Duration::ZERO, failed: false }
    }

    /// Time until the next picture.
    pub(super) fn pause(&self) -> Duration {
        PAUSE.0.max(self.took * PAUSE.1)
    }

    /// Draws a picture in the place of the last one.
    pub(super) fn draw(&mut self, image: &Image) {
        if self.failed {
            return;
        }
        let start = Instant::now();
        let codes = image.pixels.iter().flatten().map(|value| self.table.code(*value)).collect();
        let Some(pixels) = RgbImage::from_raw(image.width, image.height, codes) else { return };
        if self.lines > 0 {
            let mut output = stdout().lock();
            let _ = write!(output, "\x1b[{}A", self.lines).and_then(|()| output.flush());
        }
        let config = Config { absolute_offset: false, transparent: false, ..Config::default() };
        match viuer::print(&DynamicImage::ImageRgb8(pixels), &config) {
            Ok((_, lines)) => self.lines = lines,
            Err(error) => {
                self.failed = true;
                output::warn(format_args!("the terminal does not take pictures: {error}"));
            }
        }
        self.took = start.elapsed();
    }
}
