//! What spheres look like: columns beside those that rays meet, in the same order.

use super::materials::{MaterialId, Materials};
use crate::scene;

/// A component that every sphere has: one value for all, or one for each.
#[derive(Clone, Debug, PartialEq)]
pub enum Column<T> {
    /// The same for every sphere: no column.
    Uniform(T),
    /// Row `i` belongs to sphere `i`.
    Rows(Vec<T>),
}

impl<T: Copy> Column<T> {
    /// Row `i`.
    #[inline(always)]
    pub fn row(&self, i: usize) -> T {
        match self {
            Self::Uniform(value) => *value,
            Self::Rows(rows) => rows[i],
        }
    }

    /// Bytes that the column occupies.
    pub fn bytes(&self) -> usize {
        match self {
            Self::Uniform(_) => 0,
            Self::Rows(rows) => size_of_val(rows.as_slice()),
        }
    }
}

/// What each sphere is made of, and its color.
#[derive(Clone, Debug)]
pub struct Appearance {
    /// What the sphere is made of.
    pub material: Column<MaterialId>,
    /// Factor on the material's color; none if every one is white.
    pub color: Option<Vec<[f32; 3]>>,
}

impl Appearance {
    /// Of no sphere.
    pub(super) const NONE: Self = Self { material: Column::Rows(Vec::new()), color: None };

    /// For the spheres whose places in the user's scene are `ids`.
    pub(super) fn build(from: &scene::Spheres, ids: &[u32], materials: &Materials) -> Self {
        let material = |id: u32| from.material_of(id as usize);
        let first = ids.first().map_or(0, |&id| material(id));
        let material = if ids.iter().all(|&id| material(id) == first) {
            Column::Uniform(materials.id(first))
        } else {
            Column::Rows(ids.iter().map(|&id| materials.id(material(id))).collect())
        };
        let color = (!from.color.is_empty())
            .then(|| ids.iter().map(|&id| from.color_of(id as usize).to_array()).collect());
        Self { material, color }
    }

    /// Bytes that the columns occupy.
    pub fn bytes(&self) -> usize {
        let colors = self.color.as_ref().map_or(0, |colors| size_of_val(colors.as_slice()));
        self.material.bytes() + colors
    }
}
