//! Titles of colored columns, in which `_` and `^` mark subscripts and superscripts.

use super::ColumnColors;
use crate::scene::particles::select::expression;
use crate::scene::particles::{Format, ParticleFrame};

/// Names that are lengths.
const LENGTHS: [&str; 5] = ["x", "y", "z", "radius", "diameter"];

/// Names of vectors in short, and their symbols.
const VECTORS: [(&str, &str); 3] = [("v", "v"), ("f", "F"), ("mu", "\u{3bc}")];

/// Beginnings of names in dumps of LAMMPS: numbers of computes, fixes, variables and custom properties.
const ORIGINS: [&str; 5] = ["c_", "f_", "v_", "d_", "i_"];

impl ColumnColors {
    /// Returns the title of the colors: the one that is given, or one that is made of the name of the column, with the unit if
    /// it is a length.
    pub fn label(&self, frame: &ParticleFrame) -> String {
        match &self.title {
            Some(title) => title.clone(),
            None => title(&self.column, frame),
        }
    }
}

/// Returns a readable name of a column.
fn title(column: &str, frame: &ParticleFrame) -> String {
    if expression::is_arithmetic(column) {
        // Powers may be raised, but underscores are those of names.
        return column.replace('_', "\\_");
    }
    if LENGTHS.iter().any(|name| name.eq_ignore_ascii_case(column)) {
        let unit = frame.unit.symbol();
        return if unit.is_empty() { column.to_owned() } else { format!("{column} ({unit})") };
    }
    if let Some(component) = component(column) {
        return component;
    }
    if let Some(rest) = column.strip_prefix("coordination")
        && (rest.is_empty() || rest.starts_with('['))
    {
        return "coordination number".to_owned();
    }
    let is_dump = matches!(frame.format, Format::LammpsDump);
    let origin = ORIGINS.iter().find_map(|origin| column.strip_prefix(origin));
    let name = origin.filter(|name| is_dump && name.len() > 1).unwrap_or(column);
    match name.rsplit_once(['_', '.', ':']) {
        Some((stem, axes)) if !stem.is_empty() && is_axes(axes) => {
            format!("{}_{axes}", words(stem))
        }
        _ => words(name),
    }
}

/// Returns the symbol of a component of a vector: of `vx`, `v_x`.
fn component(column: &str) -> Option<String> {
    let (stem, axis) = column.split_at_checked(column.len().checked_sub(1)?)?;
    let (_, symbol) = VECTORS.iter().find(|(name, _)| *name == stem)?;
    is_axes(axis).then(|| format!("{symbol}_{axis}"))
}

/// Returns whether a text names an axis, or two for a component of a tensor.
fn is_axes(text: &str) -> bool {
    (1..=2).contains(&text.len()) && text.bytes().all(|letter| matches!(letter, b'x'..=b'z'))
}

/// Replaces underscores by spaces; `^` is itself.
fn words(name: &str) -> String {
    name.replace('_', " ").trim().replace('^', "\\^")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::LengthUnit;

    #[test]
    fn titles_are_readable() {
        let frame = |format, unit| ParticleFrame { format, unit, ..ParticleFrame::default() };
        let table = frame(Format::Csv, LengthUnit::Unknown);
        let dump = frame(Format::LammpsDump, LengthUnit::Unknown);
        let crystal = frame(Format::Cif, LengthUnit::Angstrom);
        for (column, frame, expected) in [
            ("x", &table, "x"),
            ("RADIUS", &crystal, "RADIUS (\u{c5})"),
            ("vx", &table, "v_x"),
            ("fz", &dump, "F_z"),
            ("muy", &dump, "\u{3bc}_y"),
            ("velocity_x", &table, "velocity_x"),
            ("stress_xy", &table, "stress_xy"),
            ("atomic_mass", &table, "atomic mass"),
            ("c_pe", &dump, "pe"),
            ("c_pe", &table, "c pe"),
            ("c_stress[1]", &dump, "stress[1]"),
            ("v_x", &dump, "v_x"),
            ("coordination[3.2]", &dump, "coordination number"),
            ("cluster", &dump, "cluster"),
            ("c_pe / mass^2", &dump, "c\\_pe / mass^2"),
            ("_x", &table, "x"),
            ("a^b", &table, "a^b"),
            ("", &table, ""),
        ] {
            assert_eq!(title(column, frame), expected, "{column}");
        }
        let given = ColumnColors { title: Some("T (K)".to_owned()), ..ColumnColors::default() };
        assert_eq!(given.label(&table), "T (K)");
    }
}
