//! What the window shows: a picture, as large as the window, and letters over it.

use super::develop::{Developer, Print};
use super::keys;
use super::picture::Picture;
use super::viewer::Viewer;
use glam::DVec2;
use indicatif::HumanCount;
use plotters::backend::DrawingBackend;
use plotters::style::RGBColor;
use plotters::style::text_anchor::HPos;
use spherule::drawing::{self, Area, Drawn, letters};
use spherule::scene::Settings;

/// Pixels: of letters, and of a line of them.
const LETTERS: u32 = 14;
const LINE: u32 = 20;

/// Pixels from the first part of a line to the second.
const INDENT: i32 = 180;

const PAPER: RGBColor = RGBColor(24, 24, 28);
const LIGHT: RGBColor = RGBColor(230, 230, 230);
const ACCENT: RGBColor = RGBColor(255, 200, 90);

/// What the window shows where there is no picture yet.
const EMPTY: u32 = 0x0018_181C;

/// Of the line along which is cut.
const CUT: u32 = 0x00FF_C040;

/// Pixels as windows have them: `0x00RRGGBB`, row by row from the top left.
#[derive(Clone, Debug, Default)]
pub(super) struct Canvas {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) pixels: Vec<u32>,
    developer: Developer,
}

impl Canvas {
    /// Draws all that the viewer shows.
    pub(super) fn draw(&mut self, viewer: &Viewer) {
        let Settings { width, height, .. } = viewer.settings;
        (self.width, self.height) = (width, height);
        self.pixels.resize(width as usize * height as usize, EMPTY);
        match &viewer.shown {
            Some(picture) => self.show(picture, &viewer.settings),
            None => self.pixels.fill(EMPTY),
        }
        if let Some([a, b]) = viewer.cut() {
            self.line(a, b);
        }
        if viewer.status {
            self.strip(&[("", &status(viewer))], height.saturating_sub(LINE));
        }
        if viewer.help {
            self.strip(&keys::HELP, 0);
        }
    }

    /// Shows a picture; what it was developed to, if the window still asks for the same.
    fn show(&mut self, picture: &Picture, settings: &Settings) {
        let print = Print::of(settings);
        match picture.developed.as_ref().filter(|developed| developed.print == print) {
            Some(developed) => self.pixels.copy_from_slice(&developed.pixels),
            None => self.developer.develop(picture.seen(), print, &mut self.pixels),
        }
    }

    fn line(&mut self, a: DVec2, b: DVec2) {
        let steps = (b - a).abs().max_element().ceil().max(1.0);
        for step in 0..=steps as usize {
            let at = a.lerp(b, step as f64 / steps).round();
            let inside = at.cmpge(DVec2::ZERO).all()
                && at.x < f64::from(self.width)
                && at.y < f64::from(self.height);
            if inside {
                self.pixels[at.y as usize * self.width as usize + at.x as usize] = CUT;
            }
        }
    }

    /// Lines of text on a strip as wide as the window: side by side where there are too many.
    fn strip(&mut self, lines: &[(&str, &str)], top: u32) {
        let most = (self.height - top) / LINE;
        let columns = (lines.len() as u32).div_ceil(most.max(1)).max(1);
        let rows = (lines.len() as u32).div_ceil(columns);
        let size = (self.width, (rows * LINE).min(self.height - top));
        let text = Text { lines, rows: rows.max(1), columns, size };
        // Letters that cannot be drawn leave the picture as it is.
        let Ok(codes) = drawing::codes(&text, PAPER) else { return };
        let first = top as usize * self.width as usize;
        for (pixel, code) in self.pixels[first..].iter_mut().zip(codes.as_chunks::<3>().0) {
            *pixel = code.iter().fold(0, |packed, &channel| packed << 8 | u32::from(channel));
        }
    }

    /// The pixels as codes, three bytes each.
    pub(super) fn codes(&self) -> Vec<u8> {
        let channels = |pixel: &u32| [16, 8, 0].map(|shift| (pixel >> shift) as u8);
        self.pixels.iter().flat_map(channels).collect()
    }
}

/// Lines of text, of two parts if there is something in the first.
struct Text<'a> {
    lines: &'a [(&'a str, &'a str)],
    rows: u32,
    columns: u32,
    size: (u32, u32),
}

impl drawing::Picture for Text<'_> {
    fn size(&self) -> (u32, u32) {
        self.size
    }

    fn draw<B: DrawingBackend>(&self, area: &Area<B>) -> Drawn<B> {
        let style = |color| letters(LETTERS, color, HPos::Left);
        for (place, (left, right)) in (0..).zip(self.lines) {
            let y = (place % self.rows * LINE + LINE / 2) as i32;
            let x = (place / self.rows * self.size.0 / self.columns + LINE / 2) as i32;
            let indent = if left.is_empty() { 0 } else { INDENT };
            area.draw_text(left, &style(ACCENT), (x, y))?;
            area.draw_text(right, &style(LIGHT), (x + indent, y))?;
        }
        Ok(())
    }
}

/// The status line.
pub(super) fn status(viewer: &Viewer) -> String {
    let facts = &viewer.facts;
    let mut parts = vec![format!("{} spheres", HumanCount(facts.spheres as u64))];
    if let Some(picture) = &viewer.shown {
        parts.push(format!("{} of {} samples", picture.samples, viewer.settings.spp));
        if let Some(noise) = viewer.noise {
            parts.push(format!("noise {:.2} %", 100.0 * noise));
        }
        let rate = picture.rays as f64 / picture.elapsed.as_secs_f64().max(1e-9);
        parts.push(format!("{:.1} Mrays/s", rate / 1e6));
    }
    if let Some(frames) = facts.frames.filter(|frames| *frames > 1) {
        parts.push(format!("frame {} of {frames}", facts.frame));
    }
    if !viewer.message.is_empty() {
        parts.push(viewer.message.clone());
    }
    parts.join("  |  ")
}
