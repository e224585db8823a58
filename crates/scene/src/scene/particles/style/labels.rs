//! Integers and texts that have colors of their own.

use super::ColumnColors;
use super::columns::Column;
use crate::color::{Rgb, Spacing, category, srgb};
use crate::scene::FileError;
use crate::scene::particles::Codes;
use crate::scene::particles::select::expression;
use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::path::Path;

/// Maximum number of integers that have colors of their own without being asked for.
const USUAL: usize = 12;

/// Words in the names of columns whose integers are labels.
const WORDS: [&str; 33] = [
    "basin",
    "body",
    "chain",
    "chainid",
    "class",
    "cluster",
    "cna",
    "community",
    "coordination",
    "domain",
    "fragment",
    "grain",
    "group",
    "label",
    "mol",
    "molecule",
    "moleculeid",
    "molid",
    "phase",
    "population",
    "ptm",
    "region",
    "resi",
    "resid",
    "residue",
    "resnum",
    "resseq",
    "segment",
    "site",
    "species",
    "state",
    "structure",
    "structuretype",
];

/// Greatest integer up to which all integers are numbers of double precision.
const GREATEST: f64 = 9_007_199_254_740_992.0;

/// Colors of columns of numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NumberColors {
    /// Colors of their own for at most 12 different integers in columns that are named as labels are (`cluster`,
    /// `coordination`, `mol`), if neither a map nor a range is given; else a color map.
    #[default]
    Auto,
    /// A color map.
    Map,
    /// A color for each integer.
    Categories,
}

/// The values of a column, by the treatment of their colors.
pub(super) enum Colored<'p> {
    /// Numbers for a color map, NaN for missing values.
    Numbers(Cow<'p, [f64]>),
    /// Names with colors of their own.
    Names {
        names: Vec<Cow<'p, str>>,
        /// The color of each name.
        colors: Vec<Rgb>,
        /// The row of each particle in `names`.
        codes: Cow<'p, Codes>,
        /// Number of particles without a value.
        missing: usize,
    },
}

/// Returns the integers of a column, if they have colors of their own.
pub(super) fn of(colors: &ColumnColors, values: &[f64]) -> Option<BTreeSet<i64>> {
    let most = match colors.numbers {
        NumberColors::Categories => usize::MAX,
        NumberColors::Auto if colors.is_plain() && is_label(&colors.column) => USUAL,
        NumberColors::Auto | NumberColors::Map => return None,
    };
    let mut labels = BTreeSet::new();
    let mut last = f64::NAN;
    for &value in values.iter().filter(|value| !value.is_nan()) {
        if value != last {
            labels.insert(integer(value)?);
            last = value;
        }
        if labels.len() > most {
            return None;
        }
    }
    Some(labels)
}

/// Returns whether the integers of all frames are not too many to have colors of their own.
pub(super) fn suit(colors: &ColumnColors, labels: &[i64]) -> bool {
    colors.numbers == NumberColors::Categories || labels.len() <= USUAL
}

/// Returns the values of a column with their colors.
///
/// # Errors
///
/// Values that are no integers should have colors of their own, or what has them a range.
pub(super) fn colored<'p>(
    colors: &ColumnColors,
    path: &Path,
    column: Column<'p>,
) -> Result<Colored<'p>, FileError> {
    let values = match column {
        Column::Numbers(values) => values,
        Column::Texts { names, codes } => {
            check(colors, path, "holds texts")?;
            let colors = colors_of(&names);
            let names = names.into_iter().map(Cow::Borrowed).collect();
            return Ok(Colored::Names { names, colors, codes, missing: 0 });
        }
    };
    let found = of(colors, &values);
    if colors.numbers == NumberColors::Categories {
        check(colors, path, "is colored by categories")?;
        if found.is_none() {
            let message = format!(
                "cannot color by categories of the column `{}`, as not all of its values are integers",
                colors.column
            );
            let help = "choose a color map, or a column of integers or texts";
            return Err(FileError::whole_file(path, message).with_help(help));
        }
    }
    let labels = match &colors.shared {
        // Frames that were not known before may have more.
        Some(shared) => shared.labels.as_ref().map(|labels| {
            let is_new = |label: &i64| labels.binary_search(label).is_err();
            let new = found.into_iter().flatten().filter(is_new);
            labels.iter().copied().chain(new).collect::<Vec<i64>>()
        }),
        None => found.map(|labels| labels.into_iter().collect()),
    };
    Ok(match labels {
        Some(labels) => coded(&labels, &values),
        None => Colored::Numbers(values),
    })
}

/// Returns integers as names.
fn coded<'p>(labels: &[i64], values: &[f64]) -> Colored<'p> {
    let rows: HashMap<i64, u32> = labels.iter().copied().zip(0..).collect();
    let none = labels.len() as u32;
    let code = |value: &f64| integer(*value).and_then(|label| rows.get(&label).copied());
    let codes: Vec<u32> = values.iter().map(|value| code(value).unwrap_or(none)).collect();
    let missing = codes.iter().filter(|code| **code == none).count();
    let mut names: Vec<Cow<str>> = labels.iter().map(|label| label.to_string().into()).collect();
    let mut colors: Vec<Rgb> = (0..labels.len()).map(category).collect();
    if missing > 0 {
        names.push("missing".into());
        colors.push(srgb(0x80_80_80));
    }
    Colored::Names { names, colors, codes: Cow::Owned(Codes::Words(codes)), missing }
}

/// Returns the colors of texts: equal texts have equal colors.
fn colors_of(names: &[&str]) -> Vec<Rgb> {
    let mut indices = HashMap::new();
    let mut index = |name| {
        let next = indices.len();
        *indices.entry(name).or_insert(next)
    };
    names.iter().map(|&name| category(index(name))).collect()
}

/// Checks that neither a map nor a range is given, which are for numbers.
fn check(colors: &ColumnColors, path: &Path, because: &str) -> Result<(), FileError> {
    if colors.is_plain() {
        return Ok(());
    }
    let message = format!(
        "the column `{}` {because}, to which color map and range do not apply",
        colors.column
    );
    Err(FileError::whole_file(path, message).with_help("name a column of numbers and a color map"))
}

fn integer(value: f64) -> Option<i64> {
    (value.fract() == 0.0 && value.abs() <= GREATEST).then_some(value as i64)
}

/// Returns whether the integers of a column are labels, by its name.
fn is_label(column: &str) -> bool {
    let name = column.to_ascii_lowercase();
    let parts = || name.split(|letter: char| !letter.is_ascii_alphanumeric());
    let known = |word: &str| WORDS.binary_search(&word).is_ok();
    let is_label = parts().any(known) || known(&parts().collect::<String>());
    is_label && !expression::is_arithmetic(column)
}

impl ColumnColors {
    /// Returns whether neither a map nor a range nor its spacing is chosen.
    fn is_plain(&self) -> bool {
        self.map.is_none()
            && self.ends == super::ColorEnds::default()
            && self.spacing == Spacing::Linear
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_in_order() {
        assert!(WORDS.windows(2).all(|pair| pair[0] < pair[1]));
    }

    #[test]
    fn labels_are_known_by_their_names() {
        for name in [
            "cluster",
            "Cluster",
            "coordination[3.2]",
            "mol",
            "Molecule Identifier",
            "grain_id",
            "resid",
            "c_cna",
            "Structure Type",
            "structure_type",
            "StructureType",
            "chain",
        ] {
            assert!(is_label(name), "{name}");
        }
        for name in
            ["id", "q", "charge", "x", "mass", "moles", "cluster * 2", "2 * mol", "speed", ""]
        {
            assert!(!is_label(name), "{name}");
        }
    }

    #[test]
    fn texts_that_are_the_same_have_one_color() {
        assert_eq!(colors_of(&["C", "N", "C", "O"]), [0, 1, 0, 2].map(category));
    }

    #[test]
    fn only_a_few_integers_have_colors_of_their_own() {
        let by = |numbers, column: &str| ColumnColors {
            column: column.to_owned(),
            numbers,
            ..ColumnColors::default()
        };
        let values =
            |count: u32| (0..count).map(|row| f64::from(row * 7 % count)).collect::<Vec<_>>();
        let count =
            |colors: &ColumnColors, values: &[f64]| of(colors, values).map(|labels| labels.len());
        let auto = by(NumberColors::Auto, "cluster");
        assert_eq!([count(&auto, &values(12)), count(&auto, &values(13))], [Some(12), None]);
        assert_eq!(count(&auto, &[1.0, f64::NAN, 2.0]), Some(2));
        for odd in [0.5, f64::INFINITY, 1e300] {
            assert_eq!(count(&auto, &[1.0, odd]), None, "{odd}");
        }
        assert_eq!(count(&by(NumberColors::Auto, "q"), &values(3)), None);
        assert_eq!(count(&by(NumberColors::Map, "cluster"), &values(3)), None);
        assert_eq!(count(&by(NumberColors::Categories, "q"), &values(50)), Some(50));
    }
}
