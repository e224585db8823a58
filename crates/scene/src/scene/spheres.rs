//! The spheres of a scene, in columns.

use super::Rgb;
use glam::DVec3;
use spherule_particles::internals::retain;
use std::collections::TryReserveError;
use std::mem::take;

/// Spheres in columns: row `i` of every column belongs to sphere `i`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spheres {
    /// Centers, x.
    pub x: Vec<f64>,
    /// Centers, y.
    pub y: Vec<f64>,
    /// Centers, z.
    pub z: Vec<f64>,
    /// Radii, more than 0.
    pub radius: Vec<f64>,
    /// Rows of [`Scene::materials`](super::Scene::materials); empty if every sphere has material 0.
    pub material: Vec<u32>,
    /// Factors on the material's color; empty if all are white.
    pub color: Vec<Rgb>,
}

impl Spheres {
    /// Maximum number of spheres in a scene: row numbers are `u32`, and a few of them are reserved.
    pub const MAX: u64 = spherule_particles::MAX_PARTICLES;

    /// Bytes of the center and the radius of a sphere.
    pub const POSITION_BYTES: u64 = 4 * size_of::<f64>() as u64;

    /// Bytes of a sphere in all columns.
    pub const BYTES: u64 = Self::POSITION_BYTES + (size_of::<u32>() + size_of::<Rgb>()) as u64;

    /// Number of spheres.
    pub fn len(&self) -> usize {
        self.radius.len()
    }

    /// Returns whether there are no spheres.
    pub fn is_empty(&self) -> bool {
        self.radius.is_empty()
    }

    /// Returns the center of sphere `row`, which is less than [`Spheres::len`].
    pub fn center(&self, row: usize) -> DVec3 {
        DVec3::new(self.x[row], self.y[row], self.z[row])
    }

    /// Returns the material of sphere `row`, even if the column is empty.
    pub fn material_of(&self, row: usize) -> u32 {
        self.material.get(row).copied().unwrap_or(0)
    }

    /// Returns the color of sphere `row`, even if the column is empty.
    pub fn color_of(&self, row: usize) -> Rgb {
        self.color.get(row).copied().unwrap_or(Rgb::ONE)
    }

    /// Appends one sphere; the columns of materials and colors stay empty as long as possible.
    pub fn push(&mut self, center: DVec3, radius: f64, material: u32, color: Rgb) {
        extend(&mut self.material, self.radius.len(), 0, [material].into_iter());
        extend(&mut self.color, self.radius.len(), Rgb::ONE, [color].into_iter());
        self.x.push(center.x);
        self.y.push(center.y);
        self.z.push(center.z);
        self.radius.push(radius);
    }

    /// Keeps the rows for which `keep`, with one entry per row, is true.
    pub fn retain(&mut self, keep: &[bool]) {
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
            retain(column, keep);
        }
        retain(&mut self.material, keep);
        retain(&mut self.color, keep);
    }

    /// Appends all of `other`; its material `i` becomes `rows[i]` here, or 0 if `rows` is too short.
    pub fn append(&mut self, mut other: Self, rows: &[u32]) {
        let row = |material: u32| rows.get(material as usize).copied().unwrap_or(0);
        let (before, added) = (self.len(), other.len());
        other.material.iter_mut().for_each(|material| *material = row(*material));
        append_usual(&mut self.material, before, take(&mut other.material), added, row(0), 0);
        append_usual(&mut self.color, before, take(&mut other.color), added, Rgb::ONE, Rgb::ONE);
        append_or_take(&mut self.x, other.x);
        append_or_take(&mut self.y, other.y);
        append_or_take(&mut self.z, other.z);
        append_or_take(&mut self.radius, other.radius);
    }

    /// Returns the bytes of a sphere in the columns that are not empty.
    pub(crate) fn row_bytes(&self) -> u64 {
        let material = if self.material.is_empty() { 0 } else { size_of::<u32>() };
        let color = if self.color.is_empty() { 0 } else { size_of::<Rgb>() };
        Self::POSITION_BYTES + (material + color) as u64
    }

    /// Reserves memory for `additional` spheres without materials and colors.
    ///
    /// # Errors
    ///
    /// There is not enough memory.
    pub fn try_reserve(&mut self, additional: usize) -> Result<(), TryReserveError> {
        [&mut self.x, &mut self.y, &mut self.z, &mut self.radius]
            .into_iter()
            .try_for_each(|column| column.try_reserve_exact(additional))
    }
}

/// Appends `values` to a column that may be empty if all of its `before` values are `usual`.
fn extend<T, I>(column: &mut Vec<T>, before: usize, usual: T, values: I)
where
    T: Clone + PartialEq,
    I: Iterator<Item = T> + Clone,
{
    if column.is_empty() {
        if values.clone().all(|value| value == usual) {
            return;
        }
        column.resize(before, usual);
    }
    column.extend(values);
}

/// Appends a column that may be empty if all of its `count` values are `value` to one that may be empty
/// if all of its `before` values are `usual`.
fn append_usual<T: Copy + PartialEq>(
    column: &mut Vec<T>,
    before: usize,
    other: Vec<T>,
    count: usize,
    value: T,
    usual: T,
) {
    if other.is_empty() {
        extend(column, before, usual, std::iter::repeat_n(value, count));
    } else if before == 0 && other.iter().any(|value| *value != usual) {
        *column = other;
    } else {
        extend(column, before, usual, other.iter().copied());
    }
}

/// Appends without a copy if the column is empty: columns can be gigabytes.
fn append_or_take(column: &mut Vec<f64>, mut other: Vec<f64>) {
    if column.is_empty() { *column = other } else { column.append(&mut other) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stay_empty_until_an_unusual_value() {
        let mut spheres = Spheres::default();
        spheres.push(DVec3::X, 1.0, 0, Rgb::ONE);
        assert!(spheres.material.is_empty() && spheres.color.is_empty());
        spheres.push(DVec3::Y, 2.0, 3, Rgb::ONE);
        spheres.push(DVec3::Z, 3.0, 0, Rgb::X);
        assert_eq!(spheres.material, [0, 3, 0]);
        assert_eq!(spheres.color, [Rgb::ONE, Rgb::ONE, Rgb::X]);
        assert_eq!(spheres.center(1), DVec3::Y);
    }

    #[test]
    fn columns_move_into_empty_columns() {
        let mut added = Spheres::default();
        added.push(DVec3::X, 1.0, 1, Rgb::ONE);
        added.push(DVec3::Y, 1.0, 0, Rgb::X);
        let colors = added.color.as_ptr();
        let mut spheres = Spheres::default();
        spheres.append(added.clone(), &[0, 0]);
        assert!(spheres.material.is_empty());
        let mut spheres = Spheres::default();
        spheres.append(added, &[2, 3]);
        assert_eq!((&spheres.material[..], spheres.color.as_ptr()), (&[3, 2][..], colors));
        let mut plain = Spheres::default();
        plain.push(DVec3::Z, 1.0, 0, Rgb::ONE);
        spheres.append(plain, &[4]);
        assert_eq!(spheres.material, [3, 2, 4]);
        assert_eq!(spheres.color, [Rgb::ONE, Rgb::X, Rgb::ONE]);
    }

    #[test]
    fn appending_renames_materials() {
        let mut first = Spheres::default();
        first.push(DVec3::ZERO, 1.0, 0, Rgb::ONE);
        let mut second = Spheres::default();
        second.push(DVec3::X, 1.0, 1, Rgb::ONE);
        second.push(DVec3::Y, 1.0, 0, Rgb::Y);
        first.append(second, &[5, 7]);
        assert_eq!(first.material, [0, 7, 5]);
        assert_eq!(first.color, [Rgb::ONE, Rgb::ONE, Rgb::Y]);
        assert_eq!(first.x, [0.0, 1.0, 0.0]);
    }
}
