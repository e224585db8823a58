//! Conversion of particle frames to spheres: finds radii and colors, and drops invalid rows.

use super::radii::{FoundRadii, apply_expression, half_spacing, radii};
use super::style::ElementColors;
use super::{Cell, FirstFrame, ParticleFrame, Particles, ReadOptions, TextColumn};
use crate::color::category;
use crate::memory;
use crate::scene::{FileError, Rgb, Spheres};
use spherule_particles::internals::{clipped, listed};
use std::path::Path;

/// Converts a frame that was read from `path` to spheres, ignoring the options' choice of a frame.
///
/// # Errors
///
/// It holds no particles, or lacks the radii that are asked for.
pub fn of_frame(
    path: &Path,
    frame: ParticleFrame,
    options: &ReadOptions,
) -> Result<Particles, FileError> {
    of_frame_in(path, frame, options, None)
}

/// Converts a frame to spheres as [`of_frame`], with the choices by the first frame, if there are several.
///
/// # Errors
///
/// The same.
pub fn of_frame_in(
    path: &Path,
    mut frame: ParticleFrame,
    options: &ReadOptions,
    first_frame: Option<FirstFrame>,
) -> Result<Particles, FileError> {
    options.check().map_err(|message| FileError::whole_file(path, message))?;
    let mut warnings = Warnings { path, list: Vec::new() };
    for warning in std::mem::take(&mut frame.warnings) {
        warnings.add(&warning);
    }
    if frame.is_empty() && !options.allow_empty {
        return Err(FileError::whole_file(path, "holds no particles"));
    }
    memory::check(bytes_to_add(&frame))
        .map_err(|shortage| FileError::whole_file(path, format!("its spheres need {shortage}")))?;
    let (has_crystal_cell, is_crystal) = (frame.has_crystal_cell(), frame.is_crystal());
    if options.scale != 1.0 {
        let columns = [&mut frame.x, &mut frame.y, &mut frame.z];
        columns.into_iter().flatten().for_each(|value| *value *= options.scale);
        frame.trails.scale(options.scale);
    }
    let FoundRadii { radius, guessed } = radii(path, &mut frame, options, &mut warnings)?;
    frame.radius = radius;
    drop_rows(path, &mut frame, options, &mut warnings)?;
    let of_first = first_frame.as_ref().and_then(|first| first.guessed_radius);
    let guessed_radius = (guessed && !frame.is_empty())
        .then(|| of_first.unwrap_or_else(|| half_spacing([&frame.x, &frame.y, &frame.z])));
    if let Some(radius) = guessed_radius {
        frame.radius.fill(radius * options.radius_scale);
        warnings.add(&format!(
            "no radii in the file, using half of the mean spacing: radius = {radius}"
        ));
    }
    let color = colors(&mut frame);
    let material = material_rows(&frame.materials);
    frame.cell = frame.cell.map(|cell| Cell {
        origin: cell.origin * options.scale,
        vectors: cell.vectors.map(|vector| vector * options.scale),
        ..cell
    });
    let take = std::mem::take::<Vec<f64>>;
    let spheres = Spheres {
        x: take(&mut frame.x),
        y: take(&mut frame.y),
        z: take(&mut frame.z),
        radius: take(&mut frame.radius),
        material,
        color,
    };
    let material_names = material_names(std::mem::take(&mut frame.materials));
    frame.warnings = warnings.list;
    let mut particles = Particles { spheres, frame, material_names, ..Particles::default() };
    (particles.guessed_radius, particles.first_frame) = (guessed_radius, first_frame);
    (particles.has_crystal_cell, particles.is_crystal) = (has_crystal_cell, is_crystal);
    apply_expression(path, &mut particles, options)?;
    Ok(particles)
}

/// Returns the bytes of the columns that spheres have in addition to the frame's.
fn bytes_to_add(frame: &ParticleFrame) -> u64 {
    let radius = if frame.radius.is_empty() { size_of::<f64>() } else { 0 };
    let kinds = &frame.kinds.table;
    let by_kind = kinds.len() > 1 || kinds.iter().any(|kind| kind.element.is_some());
    let color = if frame.color.is_empty() && by_kind { size_of::<Rgb>() } else { 0 };
    let material = if frame.materials.names.len() > 1 { size_of::<u32>() } else { 0 };
    (frame.len() * (radius + color + material)) as u64
}

/// Warnings, each with the file's name before it.
pub(super) struct Warnings<'p> {
    path: &'p Path,
    list: Vec<String>,
}

impl Warnings<'_> {
    pub(super) fn add(&mut self, message: &str) {
        self.list.push(format!("{}: {}", self.path.display(), clipped(message)));
    }

    /// Warns of names with a common reason, which begins the sentence; of nothing if there are none.
    pub(super) fn add_of(&mut self, reason: &str, names: &[&str]) {
        if !names.is_empty() {
            self.add(&listed(reason, names));
        }
    }
}

/// Drops invalid rows, and warns of their number.
fn drop_rows(
    path: &Path,
    frame: &mut ParticleFrame,
    options: &ReadOptions,
    warnings: &mut Warnings,
) -> Result<(), FileError> {
    let virtual_kinds: Vec<bool> = frame.kinds.table.iter().map(|kind| kind.virtual_site).collect();
    let any_virtual = virtual_kinds.contains(&true);
    let is_virtual =
        |row: usize| any_virtual && virtual_kinds[frame.kinds.codes.code(row) as usize];
    let finite = |row: usize| frame.position(row).is_finite() && frame.radius[row].is_finite();
    let (mut sites, mut not_finite, mut not_positive) = (0_u64, 0_u64, 0_u64);
    let mut is_valid = |row: usize| {
        let positive = frame.radius[row] > 0.0;
        if is_virtual(row) {
            sites += 1;
        } else if !finite(row) {
            not_finite += 1;
        } else if positive {
            return true;
        } else {
            not_positive += 1;
        }
        false
    };
    let count = frame.len();
    let Some(first) = (0..count).find(|&row| !is_valid(row)) else { return Ok(()) };
    let mut keep = vec![true; count];
    keep[first] = false;
    (first + 1..count).for_each(|row| keep[row] = is_valid(row));
    let dropped = not_finite + not_positive;
    let reasons = format!("{not_finite} not finite, {not_positive} with a radius of 0 or less");
    if !keep.contains(&true) && !options.allow_empty {
        let message = format!("none of its {count} rows is a sphere: {reasons}");
        return Err(FileError::whole_file(path, message));
    }
    if sites > 0 {
        warnings.add(&format!(
            "{sites} sites without an atom, of water models or ghosts, are not drawn"
        ));
    }
    if dropped > 0 {
        warnings.add(&format!("{dropped} of {count} rows were dropped: {reasons}"));
    }
    frame.retain(&keep);
    frame.shrink();
    Ok(())
}

/// Returns the file's colors, or those of elements or types; empty if all are white or unknown.
fn colors(frame: &mut ParticleFrame) -> Vec<Rgb> {
    if !frame.color.is_empty() {
        let own = std::mem::take(&mut frame.color);
        return if own.iter().all(|color| *color == Rgb::ONE) { Vec::new() } else { own };
    }
    let kinds = &frame.kinds;
    let has_elements = kinds.table.iter().any(|kind| kind.element.is_some());
    if !has_elements && kinds.table.len() < 2 {
        return Vec::new();
    }
    let table = kinds.table.iter().enumerate();
    let table: Vec<Rgb> = table
        .map(
            |(row, kind)| {
                if has_elements { ElementColors::Jmol.of(kind.element) } else { category(row) }
            },
        )
        .collect();
    (0..kinds.codes.len()).map(|row| table[kinds.codes.code(row) as usize]).collect()
}

/// Returns the material of each sphere; empty if all have the first.
fn material_rows(materials: &TextColumn) -> Vec<u32> {
    let codes = &materials.codes;
    let rows = 0..codes.len();
    if rows.clone().all(|row| codes.code(row) == 0) {
        return Vec::new();
    }
    rows.map(|row| codes.code(row)).collect()
}

fn material_names(materials: TextColumn) -> Vec<String> {
    if materials.names.is_empty() { vec![String::new()] } else { materials.names }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::Element;
    use crate::scene::particles::Kind;

    #[test]
    fn additional_columns_of_spheres_take_bytes() {
        let plain = ParticleFrame { x: vec![0.0; 10], ..ParticleFrame::default() };
        let kind = |name: &str, element| Kind { name: name.to_owned(), element, ..Kind::default() };
        let with = |change: &dyn Fn(&mut ParticleFrame)| {
            let mut frame = plain.clone();
            change(&mut frame);
            bytes_to_add(&frame)
        };
        let carbon = Element::from_symbol("C");
        let color = size_of::<Rgb>() as u64 * 10;
        // Ten radii; colors by type or element; rows of materials.
        assert_eq!(with(&|_| ()), 80);
        assert_eq!(with(&|frame| frame.radius = vec![1.0; 10]), 0);
        assert_eq!(with(&|frame| frame.kinds.table = vec![kind("a", None)]), 80);
        assert_eq!(with(&|frame| frame.kinds.table = vec![kind("C", carbon)]), 80 + color);
        let two = vec![kind("a", None), kind("b", None)];
        assert_eq!(with(&|frame| frame.kinds.table.clone_from(&two)), 80 + color);
        let own = |frame: &mut ParticleFrame| {
            frame.kinds.table.clone_from(&two);
            frame.color = vec![Rgb::ONE; 10];
        };
        assert_eq!(with(&own), 80);
        let names = |count: usize| vec![String::new(); count];
        assert_eq!(with(&|frame| frame.materials.names = names(1)), 80);
        assert_eq!(with(&|frame| frame.materials.names = names(2)), 120);
        let all = |frame: &mut ParticleFrame| {
            frame.kinds.table.clone_from(&two);
            frame.materials.names = names(2);
        };
        assert_eq!(with(&all), 120 + color);
    }
}
