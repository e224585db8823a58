//! Display of the image in the terminal while it refines: with the protocols of Kitty or iTerm, as sixels, or
//! else in half blocks with two pixels per character.

mod blocks;
mod codes;
mod inline;
mod probe;
mod sixels;

use self::codes::Codes;
use self::probe::{Protocol, Screen};
use crate::cli::failure::Failure;
use crate::cli::output;
use spherule_render::image::Image;
use spherule_render::image::tone::{Codes8, DisplayTransform};
use spherule_render::scene::Settings;
use std::io::{self, IsTerminal, Write, stdin, stdout};
use std::time::{Duration, Instant};

/// Minimum time between two updates: a duration, and a multiple of the time of the last update.
const PAUSE: (Duration, u32) = (Duration::from_millis(250), 20);

/// An area of the terminal in which images are drawn.
pub(super) struct Terminal {
    protocol: Protocol,
    screen: Screen,
    table: Codes8,
    /// Lines of the current image.
    lines: u32,
    /// Time to draw the current image.
    took: Duration,
    /// True after an error, when nothing is drawn any more.
    failed: bool,
}

/// Returns an error if standard output or input is not a terminal.
pub(super) fn check(wanted: bool) -> Result<(), Failure> {
    if wanted && !(stdin().is_terminal() && stdout().is_terminal()) {
        let message = "--terminal needs a terminal, not a file or a pipe";
        return Err(Failure::usage("render", message));
    }
    Ok(())
}

impl Terminal {
    /// Creates an area for images with these settings.
    pub(super) fn new(settings: &Settings) -> Self {
        let transform = DisplayTransform::nearest(settings.exposure, settings.tone);
        Self {
            protocol: probe::protocol(),
            screen: probe::screen(),
            table: Codes8::new(transform),
            lines: 0,
            took: Duration::ZERO,
            failed: false,
        }
    }

    /// Time until the next update.
    pub(super) fn pause(&self) -> Duration {
        PAUSE.0.max(self.took * PAUSE.1)
    }

    /// Draws an image in place of the last one.
    pub(super) fn draw(&mut self, image: &Image) {
        if self.failed {
            return;
        }
        let start = Instant::now();
        let (text, lines) = self.text(image);
        let mut output = stdout().lock();
        let drawn = output.write_all(&text).and_then(|()| output.flush());
        drop(output);
        match drawn {
            Ok(()) => self.lines = lines,
            // The terminal is closed.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => self.failed = true,
            Err(error) => {
                self.failed = true;
                output::warn(format_args!("cannot draw in the terminal: {error}"));
            }
        }
        self.took = start.elapsed();
    }

    /// Returns the bytes that draw an image in place of the last one, and its number of lines.
    fn text(&self, image: &Image) -> (Vec<u8>, u32) {
        let [columns, rows] = fit([image.width, image.height], self.screen);
        let mut text = Vec::new();
        if self.lines > 0 {
            text.extend(format!("\x1b[{}A\r", self.lines).bytes());
        }
        // Make room for the image, which may scroll the text above it.
        text.extend(b"\n".repeat(rows as usize));
        text.extend(format!("\x1b[{rows}A\r").bytes());
        match self.protocol {
            Protocol::Blocks { true_color } => {
                let codes = Codes::of(image, &self.table, [columns, 2 * rows]);
                text.extend(blocks::text(&codes, true_color));
            }
            protocol => {
                let [width, height] = self.screen.cell;
                let codes = Codes::of(image, &self.table, [columns * width, rows * height]);
                // Restore the cursor, because terminals differ in where they leave it.
                text.extend(b"\x1b7");
                text.extend(match protocol {
                    Protocol::Kitty => inline::kitty(&codes, [columns, rows]),
                    Protocol::Iterm => inline::iterm(&codes, [columns, rows]),
                    _ => sixels::text(&codes),
                });
                text.extend(format!("\x1b8\x1b[{rows}B\r").bytes());
            }
        }
        (text, rows)
    }
}

/// Columns and rows of cells for an image: as many as the terminal has, except for one line for the prompt,
/// but no more than pixels, of which a cell has two, one above the other.
fn fit([width, height]: [u32; 2], screen: Screen) -> [u32; 2] {
    let most = [screen.columns.max(1), 2 * screen.rows.saturating_sub(1).max(1)].map(f64::from);
    let size = [width, height].map(f64::from);
    let scale = (most[0] / size[0]).min(most[1] / size[1]).min(1.0);
    let columns = (size[0] * scale).round().max(1.0);
    let rows = (size[1] * scale / 2.0).round().max(1.0);
    [columns as u32, rows as u32]
}

#[cfg(test)]
mod tests {
    use super::*;

    const SCREEN: Screen = Screen { columns: 80, rows: 24, cell: [8, 16] };

    fn terminal(protocol: Protocol) -> Terminal {
        let settings = Settings::default();
        let transform = DisplayTransform::nearest(settings.exposure, settings.tone);
        let table = Codes8::new(transform);
        let (lines, took, failed) = (0, Duration::ZERO, false);
        Terminal { protocol, screen: SCREEN, table, lines, took, failed }
    }

    #[test]
    fn pictures_fit_into_the_screen_and_are_not_enlarged() {
        for (size, cells) in [
            ([800, 600], [61, 23]),
            ([1600, 100], [80, 3]),
            ([100, 1600], [3, 23]),
            ([40, 24], [40, 12]),
            ([1, 1], [1, 1]),
            ([65_535, 1], [80, 1]),
        ] {
            assert_eq!(fit(size, SCREEN), cells, "{size:?}");
        }
        let tiny = Screen { columns: 0, rows: 0, ..SCREEN };
        assert_eq!(fit([800, 600], tiny), [1, 1]);
    }

    #[test]
    fn every_picture_replaces_the_previous_one() {
        let image = Image::filled(40, 24, [0.5; 3]).expect("a picture");
        let blocks = Protocol::Blocks { true_color: true };
        for protocol in [Protocol::Kitty, Protocol::Iterm, Protocol::Sixels, blocks] {
            let mut terminal = terminal(protocol);
            let (first, lines) = terminal.text(&image);
            assert_eq!(lines, 12);
            terminal.lines = lines;
            let (second, _) = terminal.text(&image);
            assert_eq!(second, [b"\x1b[12A\r", &first[..]].concat(), "{protocol:?}");
            // As many lines down as up.
            assert!(first.starts_with(&[&b"\n".repeat(12)[..], b"\x1b[12A\r"].concat()));
            let end = if protocol == blocks { &b"\x1b[0m\r\n"[..] } else { b"\x1b8\x1b[12B\r" };
            assert!(first.ends_with(end), "{protocol:?}");
        }
    }
}
