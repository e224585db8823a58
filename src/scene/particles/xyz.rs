//! XYZ of chemistry: atoms by their symbols, positions in angstrom.

use super::elements::{Element, element};
use super::lines::{Line, Lines};
use super::sink::{Row, Sink};
use crate::scene::SceneError;
use glam::DVec3;
use std::collections::HashMap;
use std::io::BufRead;

/// How the columns of extended XYZ begin where they are those of plain XYZ.
const PLAIN: &str = "species:S:1:pos:R:3";

/// Reads the first frame.
pub(super) fn read(lines: &mut Lines<impl BufRead>, sink: &mut Sink) -> Result<(), SceneError> {
    let Some(count) = count(lines)? else { return Ok(()) };
    match lines.next()? {
        Some(comment) => check_columns(&comment)?,
        None => return Err(lines.ended("the file ends before the comment line")),
    }
    let mut elements = HashMap::new();
    let mut unknown = Vec::new();
    for atom in 0..count {
        let Some(line) = lines.next()? else {
            let message = format!("the file ends after {atom} of {count} atoms");
            return Err(lines
                .ended(message)
                .with_help("the file is cut off, or its first line wrong"));
        };
        let (symbol, center) = parse(&line)?;
        if !elements.contains_key(symbol) {
            let element = element(symbol);
            if !element.known {
                unknown.push(symbol.to_owned());
            }
            elements.insert(symbol.to_owned(), element);
        }
        push(sink, center, elements[symbol])?;
    }
    sink.warn_of("no radius is known for these elements, so 1.7 is taken", &unknown);
    while let Some(line) = lines.next()? {
        if !line.text.trim().is_empty() {
            sink.warn("only the first frame is read; more lines follow");
            break;
        }
    }
    Ok(())
}

fn push(sink: &mut Sink, center: DVec3, element: Element) -> Result<(), SceneError> {
    let radius = if sink.has_radius() { None } else { Some(element.radius) };
    sink.push(&Row { center, radius, material: "", color: element.color })
}

/// The number of atoms, after blank lines and comments; `None` if there is nothing else.
fn count(lines: &mut Lines<impl BufRead>) -> Result<Option<u64>, SceneError> {
    while let Some(line) = lines.next()? {
        let text = line.text.trim();
        if !text.is_empty() && !text.starts_with('#') {
            return text.parse().map(Some).map_err(|_| {
                line.whole(format!("`{text}` is not a number of atoms"))
                    .with_help("the first line of an XYZ file is the number of atoms")
            });
        }
    }
    Ok(None)
}

/// Extended XYZ may put other columns first.
fn check_columns(comment: &Line) -> Result<(), SceneError> {
    let Some(start) = comment.text.find("Properties=") else { return Ok(()) };
    let value = start + "Properties=".len();
    if comment.text[value..].trim_start_matches('"').starts_with(PLAIN) {
        return Ok(());
    }
    let error =
        comment.error(start..comment.text.len(), "columns in an order that is not read here");
    Err(error.with_help(format!("write the file with Properties={PLAIN} first")))
}

fn parse<'l>(line: &Line<'l>) -> Result<(&'l str, DVec3), SceneError> {
    let mut fields = line.fields();
    let mut next = || fields.next().ok_or_else(|| line.whole("an atom is `symbol x y z`"));
    let (_, symbol) = next()?;
    let center = [line.number(next()?)?, line.number(next()?)?, line.number(next()?)?];
    Ok((symbol, DVec3::from_array(center)))
}
