//! Materials and colors of spheres: columns in the same order as the geometry.

use crate::scene::Rgb;
use crate::shade::{MaterialId, Materials};
use std::borrow::Cow;
use std::collections::HashMap;

/// A component of all spheres: one value for all, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Column<T> {
    /// The same for every sphere: no column.
    Uniform(T),
    /// Row `i` belongs to sphere `i`.
    Rows(Vec<T>),
}

impl<T: Copy> Column<T> {
    /// Returns row `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> T {
        match self {
            Self::Uniform(value) => *value,
            Self::Rows(rows) => rows[i],
        }
    }

    /// Returns the bytes that the column occupies.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Uniform(_) => 0,
            Self::Rows(rows) => size_of_val(rows.as_slice()),
        }
    }
}

/// A color for each sphere: three numbers, or a byte if there are few distinct colors.
#[derive(Clone, Debug, PartialEq)]
pub enum Colors {
    /// Row `i` belongs to sphere `i`.
    Rows(Vec<Rgb>),
    /// Row `i` of `codes` is the index in `table` of the color of sphere `i`.
    Coded {
        /// The distinct colors, at most 256.
        table: Vec<Rgb>,
        /// An index into `table` for each sphere.
        codes: Vec<u8>,
    },
}

impl Colors {
    /// Stores colors in as few bytes as possible.
    pub(super) fn new(colors: Cow<[Rgb]>) -> Self {
        coded(&colors).unwrap_or_else(|| Self::Rows(colors.into_owned()))
    }

    /// Returns the color of sphere `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> Rgb {
        match self {
            Self::Rows(rows) => rows[i],
            Self::Coded { table, codes } => table[usize::from(codes[i])],
        }
    }

    /// Returns the colors of the spheres whose ids are `ids`.
    fn reordered(self, ids: &[u32]) -> Self {
        match self {
            Self::Rows(rows) => Self::Rows(reordered(&rows, ids)),
            Self::Coded { table, codes } => Self::Coded { table, codes: reordered(&codes, ids) },
        }
    }

    /// Returns the bytes that the columns occupy.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Rows(rows) => size_of_val(rows.as_slice()),
            Self::Coded { table, codes } => size_of_val(table.as_slice()) + codes.len(),
        }
    }
}

/// Encodes the colors, if at most 256 are distinct.
fn coded(colors: &[Rgb]) -> Option<Colors> {
    let (mut table, mut known) = (Vec::new(), HashMap::new());
    let mut last = None;
    let mut code = |color: &Rgb| {
        let bits = color.to_array().map(f32::to_bits);
        if let Some((_, code)) = last.filter(|(same, _)| *same == bits) {
            return Some(code);
        }
        let code = *known.entry(bits).or_insert_with(|| {
            table.push(*color);
            table.len() - 1
        });
        let code = u8::try_from(code).ok()?;
        last = Some((bits, code));
        Some(code)
    };
    let codes = colors.iter().map(&mut code).collect::<Option<_>>()?;
    Some(Colors::Coded { table, codes })
}

fn reordered<T: Copy>(rows: &[T], ids: &[u32]) -> Vec<T> {
    ids.iter().map(|&id| rows[id as usize]).collect()
}

/// Materials and colors of a scene's spheres in the scene's order, kept until the leaf order is known.
pub(super) struct SceneAppearance<'s> {
    /// Rows of the scene's materials; empty if every one is 0.
    pub(super) material: Cow<'s, [u32]>,
    color: Option<Colors>,
}

impl<'s> SceneAppearance<'s> {
    pub(super) fn new(material: Cow<'s, [u32]>, color: Cow<[Rgb]>) -> Self {
        Self { material, color: (!color.is_empty()).then(|| Colors::new(color)) }
    }
}

/// Material and color of each sphere.
#[derive(Clone, Debug)]
pub struct Appearance {
    /// Material of the sphere.
    pub material: Column<MaterialId>,
    /// Factor on the material's color; `None` if all are white.
    pub color: Option<Colors>,
}

impl Appearance {
    /// The appearance of no spheres.
    pub(super) const NONE: Self = Self { material: Column::Rows(Vec::new()), color: None };

    /// Builds the appearance of the spheres whose ids in the user's scene are `ids`.
    pub(super) fn build(from: SceneAppearance, ids: &[u32], materials: &Materials) -> Self {
        let material = |id: u32| from.material.get(id as usize).copied().unwrap_or(0);
        let first = ids.first().map_or(0, |&id| material(id));
        let column = if ids.iter().all(|&id| material(id) == first) {
            Column::Uniform(materials.id(first))
        } else {
            Column::Rows(ids.iter().map(|&id| materials.id(material(id))).collect())
        };
        Self { material: column, color: from.color.map(|colors| colors.reordered(ids)) }
    }

    /// Returns the bytes that the columns occupy.
    pub fn bytes(&self) -> usize {
        self.material.bytes() + self.color.as_ref().map_or(0, Colors::bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_colors_take_a_byte_and_all_are_preserved() {
        for (count, each) in [(1, 1), (256, 1), (257, 12)] {
            let own: Vec<Rgb> =
                (0..1000).map(|row| Rgb::new(0.1, (row % count) as f32 / 300.0, 1.0)).collect();
            let ids: Vec<u32> = (0..700).rev().collect();
            let colors = Colors::new(Cow::Borrowed(&own)).reordered(&ids);
            let table = if each == 1 { 12 * count } else { 0 };
            assert_eq!(colors.bytes(), each * 700 + table, "{count}");
            for (row, &id) in ids.iter().enumerate() {
                assert_eq!(colors.row(row), own[id as usize], "{count}");
            }
        }
    }
}
