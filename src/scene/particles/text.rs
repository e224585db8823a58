//! Rows of `x y z` or `x y z radius`.

use super::lines::Lines;
use super::sink::{Row, Sink};
use crate::scene::{Rgb, SceneError};
use glam::DVec3;
use std::io::BufRead;

/// Reads all rows; the first one decides whether there are radii.
pub(super) fn read(lines: &mut Lines<impl BufRead>, sink: &mut Sink) -> Result<(), SceneError> {
    let mut width = None;
    while let Some(line) = lines.next()? {
        let mut numbers = [0.0; 4];
        let mut count = 0;
        for field in line.fields() {
            if let Some(number) = numbers.get_mut(count) {
                *number = line.number(field)?;
            }
            count += 1;
        }
        if count == 0 {
            continue;
        }
        if !(3..=4).contains(&count) {
            let message = format!("{count} columns, but a row is `x y z` or `x y z radius`");
            let help = "for other columns write a CSV file with a header that names them";
            return Err(line.whole(message).with_help(help));
        }
        if *width.get_or_insert(count) != count {
            let message = format!("{count} columns, but the rows above have {}", 7 - count);
            return Err(line.whole(message).with_help("give all rows a radius, or none"));
        }
        let [x, y, z, radius] = numbers;
        sink.push(&Row {
            center: DVec3::new(x, y, z),
            radius: (count == 4).then_some(radius),
            material: "",
            color: Rgb::ONE,
        })?;
    }
    Ok(())
}
