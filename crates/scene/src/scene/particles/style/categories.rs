//! Categories: the names that colors of particles stand for.

use super::labels::{self, Colored};
use super::{Applied, Coloring, ParticleStyle};
use crate::color::Rgb;
use crate::scene::particles::{Element, Particles};
use std::collections::BTreeMap;
use std::path::Path;

/// A name that a color stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Category {
    /// The name: an element, a type, a text or an integer of a column, or a selection of one color.
    pub name: String,
    /// Linear color.
    pub color: Rgb,
    /// Number of particles.
    pub count: u64,
    /// Meaning of the name: a column or an expression, `element` or `selection`.
    pub source: String,
    /// The selection whose style has the color; empty for the colors of all particles.
    pub selection: String,
}

/// The particles of one code of a column.
#[derive(Clone, Debug, Default)]
struct Group {
    color: Option<Rgb>,
    count: u64,
    /// True if particles have different colors.
    mixed: bool,
}

impl Particles {
    /// Returns the names that the colors of particles stand for, without repetition, after `style` was applied: the texts of the
    /// column that they are colored by, or else their elements or types; and selections that have one color. `None`
    /// if colors stand for numbers or for nothing, as those of a file that differ within a type.
    pub fn categories(&self, style: &ParticleStyle, applied: &Applied) -> Option<Vec<Category>> {
        let painters = &applied.painters;
        let painted_by = |painter: u32| -> Vec<usize> {
            let rows = 0..self.spheres.len();
            rows.filter(|&row| painters.get(row).copied().unwrap_or(0) == painter).collect()
        };
        let mut categories: Vec<Category> = Vec::new();
        let mut named = false;
        let own =
            style.styles.iter().map(|own| (own.selection.text(), own.properties.color.as_ref()));
        let colorings = [("", Some(&style.coloring))].into_iter().chain(own);
        for (painter, (name, coloring)) in colorings.enumerate() {
            let Some(coloring) = coloring else { continue };
            let rows = painted_by(painter as u32);
            if painter > 0 && rows.is_empty() {
                continue;
            }
            let Some(found) = self.categories_of(name, coloring, &rows) else { continue };
            named = true;
            for category in found {
                let same = |own: &&mut Category| {
                    let Category { name, color, source, .. } = &**own;
                    (name, color, source) == (&category.name, &category.color, &category.source)
                };
                match categories.iter_mut().find(same) {
                    Some(own) => own.count += category.count,
                    None => categories.push(category),
                }
            }
        }
        named.then_some(categories)
    }

    /// Returns the names that the colors of these rows stand for; `name` is that of their selection.
    fn categories_of(
        &self,
        name: &str,
        coloring: &Coloring,
        rows: &[usize],
    ) -> Option<Vec<Category>> {
        match coloring {
            Coloring::Uniform(_) if name.is_empty() => None,
            Coloring::Uniform(color) => {
                let count = rows.len() as u64;
                let (name, source) = (name.to_owned(), "selection".to_owned());
                let selection = name.clone();
                Some(vec![Category { name, color: *color, count, source, selection }])
            }
            Coloring::Column(colors) => {
                let path = Path::new("");
                let column = colors.evaluate(path, self).ok()?.of_rows(rows);
                let column = labels::colored(colors, path, column).ok()?;
                let Colored::Names { names, codes, .. } = column else { return None };
                let coded = rows.iter().enumerate().map(|(at, &row)| (row, codes.code(at)));
                let groups = self.groups(coded, names.len())?;
                let groups = names.iter().map(|own| [&**own; 2]).zip(groups);
                Some(merged(groups, &colors.column, name))
            }
            Coloring::Usual | Coloring::Elements(_) => {
                let kinds = &self.frame.kinds;
                if kinds.codes.is_empty() {
                    return None;
                }
                let coded = rows.iter().map(|&row| (row, kinds.codes.code(row)));
                let groups = self.groups(coded, kinds.table.len())?;
                let named = kinds.table.iter().map(|kind| {
                    let element: Option<&str> = kind.element.map(Element::symbol);
                    [element.unwrap_or(&kind.name), &kind.name]
                });
                Some(merged(named.zip(groups), "element", name))
            }
        }
    }

    /// Returns the color and the number of the particles of each code, of pairs of row and code; `None` if those of one code have
    /// different colors.
    fn groups(
        &self,
        coded: impl Iterator<Item = (usize, u32)>,
        count: usize,
    ) -> Option<Vec<Group>> {
        let mut groups = vec![Group::default(); count];
        for (row, code) in coded {
            let group = groups.get_mut(code as usize)?;
            let color = self.spheres.color_of(row);
            group.mixed |= *group.color.get_or_insert(color) != color;
            group.count += 1;
        }
        groups.iter().all(|group| !group.mixed).then_some(groups)
    }
}

/// Merges groups of one name and color. Of several colors of a name, only the most frequent keeps the
/// name; the others have the second, more precise name.
fn merged<'a>(
    groups: impl Iterator<Item = ([&'a str; 2], Group)>,
    source: &str,
    selection: &str,
) -> Vec<Category> {
    let groups: Vec<([&str; 2], Rgb, u64)> = groups
        .filter_map(|(names, Group { color, count, .. })| Some((names, color?, count)))
        .collect();
    let bits = |color: Rgb| color.to_array().map(f32::to_bits);
    let mut counts: BTreeMap<(&str, [u32; 3]), u64> = BTreeMap::new();
    for (names, color, count) in &groups {
        *counts.entry((names[0], bits(*color))).or_default() += count;
    }
    let mut usual: BTreeMap<&str, ([u32; 3], u64)> = BTreeMap::new();
    for ((name, color), count) in &counts {
        let most = usual.entry(name).or_insert((*color, *count));
        if *count > most.1 {
            *most = (*color, *count);
        }
    }
    let mut categories: Vec<Category> = Vec::new();
    for (names, color, count) in groups {
        let is_usual = usual.get(names[0]).is_some_and(|(usual, _)| *usual == bits(color));
        let name = if is_usual { names[0] } else { names[1] };
        let same = |category: &&mut Category| category.name == name && category.color == color;
        match categories.iter_mut().find(same) {
            Some(category) => category.count += count,
            None => categories.push(Category {
                name: name.to_owned(),
                color,
                count,
                source: source.to_owned(),
                selection: selection.to_owned(),
            }),
        }
    }
    categories
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::{ColumnColors, Columns, ParticleStyle, ReadOptions, read};

    const ATOMS: &str = "ATOM      1  N   GLY A   1       0.000   0.000   0.000  1.00  0.00\n\
                         ATOM      2  CA  GLY A   1       1.400   0.000   0.000  1.00  0.00\n\
                         ATOM      3  CB  GLY B   2       2.800   0.000   0.000  1.00  0.00\n\
                         ATOM      4  O   GLY B   2       4.200   0.000   0.000  1.00  0.00\n";

    fn categories(style: &ParticleStyle) -> Option<Vec<(String, u64)>> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.pdb");
        std::fs::write(&path, ATOMS).expect("a file");
        let columns = Columns { wanted: style.columns(), ..Columns::default() };
        let mut particles =
            read(&path, &ReadOptions { columns, ..ReadOptions::default() }).expect("particles");
        let applied = style.apply(&path, &mut particles).expect("a valid style");
        let found = particles.categories(style, &applied)?;
        Some(found.into_iter().map(|category| (category.name, category.count)).collect())
    }

    fn named(pairs: &[(&str, u64)]) -> Vec<(String, u64)> {
        pairs.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect()
    }

    #[test]
    fn colors_stand_for_elements_types_and_texts() {
        let elements = ParticleStyle::default();
        assert_eq!(categories(&elements), Some(named(&[("N", 1), ("C", 2), ("O", 1)])));
        let by = |column: &str| {
            let column = ColumnColors { column: column.to_owned(), ..ColumnColors::default() };
            ParticleStyle { coloring: Coloring::Column(column), ..ParticleStyle::default() }
        };
        assert_eq!(categories(&by("chain")), Some(named(&[("A", 2), ("B", 2)])));
        assert_eq!(categories(&by("x")), None);
    }

    /// Carbon of a ligand and carbon of all others are one name if they have one color.
    #[test]
    fn names_of_styles_are_told_apart_by_their_source() {
        let by = |column: &str| {
            let column = ColumnColors { column: column.to_owned(), ..ColumnColors::default() };
            Coloring::Column(column)
        };
        let styles = vec!["chain B: color=element".parse().expect("a style")];
        let style = ParticleStyle { coloring: by("chain"), styles, ..ParticleStyle::default() };
        assert_eq!(categories(&style), Some(named(&[("A", 2), ("C", 1), ("O", 1)])));
        let same = ParticleStyle { coloring: Coloring::Usual, ..style };
        assert_eq!(categories(&same), Some(named(&[("N", 1), ("C", 2), ("O", 1)])));
    }

    #[test]
    fn types_with_a_color_of_their_own_have_a_name_of_their_own() {
        let types = vec!["CB:color=red".parse().expect("a style")];
        let style = ParticleStyle { types, ..ParticleStyle::default() };
        let found = categories(&style).expect("categories");
        assert!(found.contains(&("CB".to_owned(), 1)) || found.contains(&("CA".to_owned(), 1)));
        assert_eq!(found.len(), 4, "{found:?}");
    }
}
