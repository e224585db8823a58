//! The color bar of the window.

use super::font::{LIGHT, PAPER, SizedFont, Surface};
use super::wrap::wrap;
use spherule_render::color::{Rgb, Tick, ticks};
use spherule_render::graphics::unmarked;
use spherule_render::image::tone::srgb_encode;
use spherule_render::scene::particles::Legend;

/// Height of the bar as a fraction of the window's height, and the minimum height in lines of text.
const SHARE: f64 = 0.35;
const LEAST: u32 = 3;

/// Opacity of the panel.
const COVER: f32 = 0.75;

/// The panel takes at most this fraction (1 / WIDEST) of the window's width.
const WIDEST: u32 = 2;

/// Draws the bar in the lower right corner, above row `bottom`, if it fits.
pub(super) fn draw(font: &mut SizedFont, legend: &Legend, surface: &mut Surface, bottom: u32) {
    let (line, margin) = (font.line(), font.margin());
    let length = (f64::from(surface.height) * SHARE) as u32;
    let (thick, gap) = (line * 3 / 4, margin / 2);
    let most = (length / line).clamp(2, 8) as usize;
    let ticks = ticks(&legend.scale.range, most);
    let numbers = ticks.iter().map(|tick| font.width(&tick.label)).max().unwrap_or(0);
    let room = surface.width / WIDEST;
    let title = wrap(font, &unmarked(&legend.label), room.saturating_sub(2 * margin), 1).concat();
    let width = (thick + gap + margin / 2 + numbers).max(font.width(&title)) + 2 * margin;
    let height = length + 2 * line + margin;
    if length < LEAST * line || height > bottom || width > room {
        return;
    }
    let (left, top) = (surface.width - width, bottom - height);
    for y in top..bottom {
        for x in left..surface.width {
            surface.blend((x as i32, y as i32), PAPER, COVER);
        }
    }
    font.draw(&title, (left + margin, top + margin / 2), LIGHT, surface);
    let first = top + margin / 2 + line + line / 2;
    for along in 0..length {
        let position = f64::from(length - 1 - along) / f64::from((length - 1).max(1));
        let color = code(legend.scale.at(position));
        for x in left + margin..left + margin + thick {
            surface.blend((x as i32, (first + along) as i32), color, 1.0);
        }
    }
    for Tick { value, label } in &ticks {
        let position = legend.scale.range.position(*value);
        let y = first + ((1.0 - position) * f64::from(length - 1)).round() as u32;
        let x = left + margin + thick;
        for x in x..x + margin / 2 {
            surface.blend((x as i32, y as i32), LIGHT, 1.0);
        }
        font.draw(label, (x + gap + margin / 2, y.saturating_sub(line / 2)), LIGHT, surface);
    }
}

fn code(color: Rgb) -> u32 {
    let channel =
        |value: f32| (srgb_encode(f64::from(value.clamp(0.0, 1.0))) * 255.0).round() as u32;
    color.to_array().iter().fold(0, |packed, &value| packed << 8 | channel(value))
}
