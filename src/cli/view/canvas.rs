//! Contents of the window: the image, with lines, color bar and text over it.

use super::colorbar;
use super::font::{ACCENT, LIGHT, PAPER, SizedFont, Surface};
use super::help::Layout;
use super::image::Picture;
use super::loading::Loading;
use super::slicing;
use super::tonemap::{DisplaySettings, ToneMapper};
use super::viewer::Viewer;
use super::wrap::{flow, wrap};
use indicatif::HumanCount;
use spherule_render::scene::Settings;

/// Opacity of the background of text.
const COVER: f32 = 0.9;

/// The status line takes at most this fraction (1 / STATUS) of the window's height.
const STATUS: u32 = 2;

/// Pixels of the window: `0x00RRGGBB`, row by row from the top left.
#[derive(Clone, Default)]
pub(super) struct Canvas {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) pixels: Vec<u32>,
    tone_mapper: ToneMapper,
    /// Font for a display of this scale; `None` until text is drawn.
    font: Option<(f64, SizedFont)>,
}

impl Canvas {
    /// Draws the contents of the window.
    pub(super) fn draw(&mut self, viewer: &Viewer) {
        let Settings { width, height, .. } = viewer.settings;
        (self.width, self.height) = (width, height);
        self.pixels.resize(width as usize * height as usize, PAPER);
        match &viewer.shown {
            Some(picture) => self.show(picture, &viewer.settings),
            None => self.pixels.fill(PAPER),
        }
        let mut surface = Surface { pixels: &mut self.pixels, width, height };
        if let Some(cut) = viewer.cut() {
            slicing::draw(&mut surface, cut, viewer.scale);
        }
        let same = |(scale, _): &(f64, SizedFont)| *scale == viewer.scale;
        if !self.font.as_ref().is_some_and(same) {
            self.font = SizedFont::new(viewer.scale).map(|font| (viewer.scale, font));
        }
        // Without a font the viewer still shows images.
        let Some((_, font)) = &mut self.font else { return };
        let text = if viewer.status { status(viewer) } else { Vec::new() };
        let top = draw_status(font, &text, &mut surface);
        if let Some(legend) =
            viewer.facts.legend.as_ref().filter(|_| viewer.bar && !viewer.facts.color_bar)
        {
            colorbar::draw(font, legend, &mut surface, top);
        }
        if let Some(loading) = &viewer.loading {
            draw_loading(font, loading, &mut surface);
        }
        if let Some(page) = viewer.help {
            draw_help(font, page, &mut surface);
        }
    }

    /// Copies the tone-mapped image, or tone-maps the image again if the window's settings changed.
    fn show(&mut self, picture: &Picture, settings: &Settings) {
        let display = DisplaySettings::of(settings);
        match &picture.tone_mapped {
            Some(tone_mapped) if tone_mapped.display == display => {
                self.pixels.copy_from_slice(&tone_mapped.pixels);
            }
            _ => {
                let (image, matte) = picture.visible();
                self.tone_mapper.map(image, matte, display, &mut self.pixels);
            }
        }
    }

    /// Returns the pixels as 8-bit RGB.
    pub(super) fn codes(&self) -> Vec<u8> {
        let channels = |pixel: &u32| [16, 8, 0].map(|shift| (pixel >> shift) as u8);
        self.pixels.iter().flat_map(channels).collect()
    }
}

/// Draws the status line at the bottom, wrapped as needed; returns its top row.
fn draw_status(font: &mut SizedFont, parts: &[String], surface: &mut Surface) -> u32 {
    if parts.is_empty() {
        return surface.height;
    }
    let (line, margin) = (font.line(), font.margin());
    let most = (surface.height / STATUS / line).max(1) as usize;
    let lines = flow(font, parts, surface.width.saturating_sub(2 * margin), most);
    let top = surface.height.saturating_sub(lines.len() as u32 * line);
    surface.fill_rows(top..surface.height, PAPER, COVER);
    for (text, y) in lines.iter().zip((top..).step_by(line as usize)) {
        font.draw(text, (margin, y), LIGHT, surface);
    }
    top
}

/// Draws the progress of loading in the middle of the window, with a bar.
fn draw_loading(font: &mut SizedFont, loading: &Loading, surface: &mut Surface) {
    let (line, margin) = (font.line(), font.margin());
    let width = surface.width.saturating_sub(2 * margin);
    let lines = wrap(font, &loading.text(), width, (surface.height / 2 / line).max(1) as usize);
    let height = (lines.len() as u32 + 1) * line;
    let top = surface.height.saturating_sub(height) / 2;
    surface.fill_rows(top..top + height, PAPER, COVER);
    let mut y = top;
    for text in &lines {
        let x = surface.width.saturating_sub(font.width(text)) / 2;
        font.draw(text, (x, y), LIGHT, surface);
        y += line;
    }
    let Some(done) = loading.done else { return };
    let end = margin + (f64::from(width) * done.clamp(0.0, 1.0)) as u32;
    for row in y + line / 4..y + line / 2 {
        for column in margin..margin + width {
            let (color, cover) = if column < end { (ACCENT, 1.0) } else { (LIGHT, 0.2) };
            surface.blend((column as i32, row as i32), color, cover);
        }
    }
}

/// Draws a page of the help at the top.
fn draw_help(font: &mut SizedFont, page: usize, surface: &mut Surface) {
    let Layout { pages, width, indent } = Layout::new(font, surface.width, surface.height);
    let (line, margin) = (font.line(), font.margin());
    let page = page.min(pages.len().saturating_sub(1));
    let Some(columns) = pages.get(page) else { return };
    let rows = columns.iter().map(Vec::len).max().unwrap_or(0) as u32;
    let more = pages.len() > 1;
    let lines = rows + u32::from(more);
    surface.fill_rows(0..lines * line, PAPER, 1.0);
    for (column, x) in columns.iter().zip((margin..).step_by(width as usize)) {
        for (row, y) in column.iter().zip((0..).step_by(line as usize)) {
            font.draw(&row.keys, (x, y), ACCENT, surface);
            font.draw(&row.what, (x + indent, y), LIGHT, surface);
        }
    }
    if more {
        let (page, count, width) =
            (page + 1, pages.len(), surface.width.saturating_sub(2 * margin));
        let long = format!("page {page} of {count}: ? for the next");
        let fits = font.width(&long) <= width;
        let text = if fits { long } else { format!("{page} of {count}: ?") };
        let text = wrap(font, &text, width, 1).concat();
        font.draw(&text, (margin, rows * line), ACCENT, surface);
    }
}

/// Returns the parts of the status line.
pub(super) fn status(viewer: &Viewer) -> Vec<String> {
    let facts = &viewer.facts;
    let mut parts = Vec::new();
    if facts.spheres > 0 || viewer.loading.is_none() {
        parts.push(format!("{} spheres", HumanCount(facts.spheres as u64)));
    }
    if let Some(picture) = &viewer.shown {
        parts.push(match picture.samples {
            0 => "preview".to_owned(),
            samples => {
                let limit = HumanCount(viewer.settings.spp.into());
                format!("{} of {limit} samples", HumanCount(samples.into()))
            }
        });
        if let Some(noise) = picture.noise {
            let denoised = if picture.before.is_some() { ", denoised" } else { "" };
            parts.push(format!("error {:.2} %{denoised}", 100.0 * noise.error));
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
