//! The color bar in the window: the colors of numbers, in the letters of the window.

use super::canvas::{LIGHT, PAPER};
use super::letters::{Letters, Target};
use super::wrap::wrap;
use spherule::color::{Rgb, Tick, ticks};
use spherule::image::tone::srgb_encode;
use spherule::scene::particles::Legend;

/// Share of the window's height, and lines, that colors are high; fewer lines are not shown.
const SHARE: f64 = 0.35;
const LEAST: u32 = 3;

/// Share of the picture that the panel hides.
const COVER: f32 = 0.75;

/// Share of the window's width that the panel may take.
const WIDEST: u32 = 2;

/// Draws the bar in the lower right corner, above row `bottom`; nothing where there is no room.
pub(super) fn draw(letters: &mut Letters, legend: &Legend, target: &mut Target, bottom: u32) {
    let (line, margin) = (letters.line(), letters.margin());
    let length = (f64::from(target.height) * SHARE) as u32;
    let (thick, gap) = (line * 3 / 4, margin / 2);
    let most = (length / line).clamp(2, 8) as usize;
    let ticks = ticks(&legend.scale.range, most);
    let numbers = ticks.iter().map(|tick| letters.width(&tick.label)).max().unwrap_or(0);
    let room = target.width / WIDEST;
    let title = wrap(letters, &legend.label, room.saturating_sub(2 * margin), 1).concat();
    let width = (thick + gap + margin / 2 + numbers).max(letters.width(&title)) + 2 * margin;
    let height = length + 2 * line + margin;
    if length < LEAST * line || height > bottom || width > room {
        return;
    }
    let (left, top) = (target.width - width, bottom - height);
    for y in top..bottom {
        for x in left..target.width {
            target.blend((x as i32, y as i32), PAPER, COVER);
        }
    }
    letters.draw(&title, (left + margin, top + margin / 2), LIGHT, target);
    let first = top + margin / 2 + line + line / 2;
    for along in 0..length {
        let position = f64::from(length - 1 - along) / f64::from((length - 1).max(1));
        let color = code(legend.scale.at(position));
        for x in left + margin..left + margin + thick {
            target.blend((x as i32, (first + along) as i32), color, 1.0);
        }
    }
    for Tick { value, label } in &ticks {
        let position = legend.scale.range.position(*value);
        let y = first + ((1.0 - position) * f64::from(length - 1)).round() as u32;
        let x = left + margin + thick;
        for x in x..x + margin / 2 {
            target.blend((x as i32, y as i32), LIGHT, 1.0);
        }
        letters.draw(label, (x + gap + margin / 2, y.saturating_sub(line / 2)), LIGHT, target);
    }
}

fn code(color: Rgb) -> u32 {
    let channel =
        |value: f32| (srgb_encode(f64::from(value.clamp(0.0, 1.0))) * 255.0).round() as u32;
    color.to_array().iter().fold(0, |packed, &value| packed << 8 | channel(value))
}
