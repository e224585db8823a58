//! Contents of the window: a picture as large as the window, and lines, color bar and text over it.

use super::colorbar;
use super::develop::{Developer, Print};
use super::help::Layout;
use super::letters::{Letters, Target};
use super::loading::Loading;
use super::picture::Picture;
use super::slicing;
use super::viewer::Viewer;
use super::wrap::{flow, wrap};
use indicatif::HumanCount;
use spherule::scene::Settings;

/// The paper under text, and its letters.
pub(super) const PAPER: u32 = 0x0018_181C;
pub(super) const LIGHT: u32 = 0x00E6_E6E6;
pub(super) const ACCENT: u32 = 0x00FF_C85A;

/// Share of the picture that paper hides.
const COVER: f32 = 0.9;

/// Share of the window's height that the status line may take.
const STATUS: u32 = 2;

/// Pixels as windows have them: `0x00RRGGBB`, row by row from the top left.
#[derive(Clone, Default)]
pub(super) struct Canvas {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) pixels: Vec<u32>,
    developer: Developer,
    /// Letters for a display of this scale; `None` until text is drawn.
    letters: Option<(f64, Letters)>,
}

impl Canvas {
    /// Draws all that the viewer shows.
    pub(super) fn draw(&mut self, viewer: &Viewer) {
        let Settings { width, height, .. } = viewer.settings;
        (self.width, self.height) = (width, height);
        self.pixels.resize(width as usize * height as usize, PAPER);
        match &viewer.shown {
            Some(picture) => self.show(picture, &viewer.settings),
            None => self.pixels.fill(PAPER),
        }
        let mut target = Target { pixels: &mut self.pixels, width, height };
        if let Some(cut) = viewer.cut() {
            slicing::draw(&mut target, cut, viewer.scale);
        }
        let same = |(scale, _): &(f64, Letters)| *scale == viewer.scale;
        if !self.letters.as_ref().is_some_and(same) {
            self.letters = Letters::new(viewer.scale).map(|letters| (viewer.scale, letters));
        }
        // Without its font the viewer shows pictures still.
        let Some((_, letters)) = &mut self.letters else { return };
        let text = if viewer.status { status(viewer) } else { Vec::new() };
        let top = draw_status(letters, &text, &mut target);
        if let Some(legend) =
            viewer.facts.legend.as_ref().filter(|_| viewer.bar && !viewer.facts.color_bar)
        {
            colorbar::draw(letters, legend, &mut target, top);
        }
        if let Some(loading) = &viewer.loading {
            draw_loading(letters, loading, &mut target);
        }
        if let Some(page) = viewer.help {
            draw_help(letters, page, &mut target);
        }
    }

    /// Shows a picture: the pixels that it was developed to, if the window still asks for the same.
    fn show(&mut self, picture: &Picture, settings: &Settings) {
        let print = Print::of(settings);
        match picture.developed.as_ref().filter(|developed| developed.print == print) {
            Some(developed) => self.pixels.copy_from_slice(&developed.pixels),
            None => self.developer.develop(picture.seen(), print, &mut self.pixels),
        }
    }

    /// The pixels as codes, three bytes each.
    pub(super) fn codes(&self) -> Vec<u8> {
        let channels = |pixel: &u32| [16, 8, 0].map(|shift| (pixel >> shift) as u8);
        self.pixels.iter().flat_map(channels).collect()
    }
}

/// Draws the status line at the bottom, in as many lines as it takes; returns where it begins.
fn draw_status(letters: &mut Letters, parts: &[String], target: &mut Target) -> u32 {
    if parts.is_empty() {
        return target.height;
    }
    let (line, margin) = (letters.line(), letters.margin());
    let most = (target.height / STATUS / line).max(1) as usize;
    let lines = flow(letters, parts, target.width.saturating_sub(2 * margin), most);
    let top = target.height.saturating_sub(lines.len() as u32 * line);
    target.fill_rows(top..target.height, PAPER, COVER);
    for (text, y) in lines.iter().zip((top..).step_by(line as usize)) {
        letters.draw(text, (margin, y), LIGHT, target);
    }
    top
}

/// Draws what is being loaded in the middle of the window, with a bar below.
fn draw_loading(letters: &mut Letters, loading: &Loading, target: &mut Target) {
    let (line, margin) = (letters.line(), letters.margin());
    let width = target.width.saturating_sub(2 * margin);
    let lines = wrap(letters, &loading.text(), width, (target.height / 2 / line).max(1) as usize);
    let height = (lines.len() as u32 + 1) * line;
    let top = target.height.saturating_sub(height) / 2;
    target.fill_rows(top..top + height, PAPER, COVER);
    let mut y = top;
    for text in &lines {
        let x = target.width.saturating_sub(letters.width(text)) / 2;
        letters.draw(text, (x, y), LIGHT, target);
        y += line;
    }
    let Some(done) = loading.done else { return };
    let end = margin + (f64::from(width) * done.clamp(0.0, 1.0)) as u32;
    for row in y + line / 4..y + line / 2 {
        for column in margin..margin + width {
            let (color, cover) = if column < end { (ACCENT, 1.0) } else { (LIGHT, 0.2) };
            target.blend((column as i32, row as i32), color, cover);
        }
    }
}

/// Draws a page of the help at the top.
fn draw_help(letters: &mut Letters, page: usize, target: &mut Target) {
    let Layout { pages, width, indent } = Layout::new(letters, target.width, target.height);
    let (line, margin) = (letters.line(), letters.margin());
    let page = page.min(pages.len().saturating_sub(1));
    let Some(columns) = pages.get(page) else { return };
    let rows = columns.iter().map(Vec::len).max().unwrap_or(0) as u32;
    let more = pages.len() > 1;
    let lines = rows + u32::from(more);
    target.fill_rows(0..lines * line, PAPER, 1.0);
    for (column, x) in columns.iter().zip((margin..).step_by(width as usize)) {
        for (row, y) in column.iter().zip((0..).step_by(line as usize)) {
            letters.draw(&row.keys, (x, y), ACCENT, target);
            letters.draw(&row.what, (x + indent, y), LIGHT, target);
        }
    }
    if more {
        let (page, count, width) = (page + 1, pages.len(), target.width.saturating_sub(2 * margin));
        let long = format!("page {page} of {count}: ? for the next");
        let fits = letters.width(&long) <= width;
        let text = if fits { long } else { format!("{page} of {count}: ?") };
        let text = wrap(letters, &text, width, 1).concat();
        letters.draw(&text, (margin, rows * line), ACCENT, target);
    }
}

/// The parts of the status line.
pub(super) fn status(viewer: &Viewer) -> Vec<String> {
    let facts = &viewer.facts;
    let mut parts = Vec::new();
    if facts.spheres > 0 || viewer.loading.is_none() {
        parts.push(format!("{} spheres", HumanCount(facts.spheres as u64)));
    }
    if let Some(picture) = &viewer.shown {
        parts.push(format!(
            "{} of {} samples",
            HumanCount(picture.samples.into()),
            HumanCount(viewer.settings.spp.into())
        ));
        if let Some(noise) = viewer.noise {
            parts.push(format!("noise {:.2} %", 100.0 * noise));
        }
        let rate = picture.rays as f64 / picture.elapsed.as_secs_f64().max(1e-9);
        parts.push(format!("{:.1} Mrays/s", rate / 1e6));
    }
    if let Some(frames) = facts.frames.filter(|frames| *frames > 1) {
        let frame = HumanCount(facts.frame);
        parts.push(format!("frame {frame} of {}", HumanCount(frames)));
    }
    if !viewer.message.is_empty() {
        parts.push(viewer.message.clone());
    }
    parts
}
