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
    /// Factors on the material's color; empty if every one is white.
    pub color: Vec<Rgb>,
}

impl Spheres {
    /// The most spheres a scene may hold: row numbers are `u32`, and a few of them are reserved.
    pub const MAX: u64 = spherule_particles::MAX_PARTICLES;

    /// Bytes that the center and the radius of a sphere take.
    pub const POSITION_BYTES: u64 = 4 * size_of::<f64>() as u64;

    /// Bytes that a sphere takes in all columns together.
    pub const BYTES: u64 = Self::POSITION_BYTES + (size_of::<u32>() + size_of::<Rgb>()) as u64;

    /// Number of spheres.
    pub fn len(&self) -> usize {
        self.radius.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.radius.is_empty()
    }

    /// Center of sphere `row`, which is less than [`Spheres::len`].
    pub fn center(&self, row: usize) -> DVec3 {
        DVec3::new(self.x[row], self.y[row], self.z[row])
    }

    /// Material of sphere `row`, whether or not the column is there.
    pub fn material_of(&self, row: usize) -> u32 {
        self.material.get(row).copied().unwrap_or(0)
    }

    /// Color of sphere `row`, whether or not the column is there.
    pub fn color_of(&self, row: usize) -> Rgb {
        self.color.get(row).copied().unwrap_or(Rgb::ONE)
    }

    /// Appends one sphere; the columns of materials and colors stay empty for as long as they may.
    pub fn push(&mut self, center: DVec3, radius: f64, material: u32, color: Rgb) {
        extend(&mut self.material, self.radius.len(), 0, [material].into_iter());
        extend(&mut self.color, self.radius.len(), Rgb::ONE, [color].into_iter());
        self.x.push(center.x);
        self.y.push(center.y);
        self.z.push(center.z);
        self.radius.push(radius);
    }

    /// Keeps the rows that `keep` is true for: one entry for each.
    pub fn retain(&mut self, keep: &[bool]) {
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
            retain(column, keep);
        }
        retain(&mut self.material, keep);
        retain(&mut self.color, keep);
    }

    /// Appends all of `other`; its material `i` becomes `rows[i]` here, and what `rows` lacks
    /// becomes 0.
    pub fn append(&mut self, mut other: Self, rows: &[u32]) {
        let row = |material: u32| rows.get(material as usize).copied().unwrap_or(0);
        let (before, added) = (self.len(), other.len());
        other.material.iter_mut().for_each(|material| *material = row(*material));
        append_usual(&mut self.material, before, take(&mut other.material), (added, row(0)), 0);
        append_usual(&mut self.color, before, take(&mut other.color), (added, Rgb::ONE), Rgb::ONE);
        append_or_take(&mut self.x, other.x);
        append_or_take(&mut self.y, other.y);
        append_or_take(&mut self.z, other.z);
        append_or_take(&mut self.radius, other.radius);
    }

    /// Bytes of a sphere in the columns that are there.
    pub(crate) fn row_bytes(&self) -> u64 {
        let material = if self.material.is_empty() { 0 } else { size_of::<u32>() };
        let color = if self.color.is_empty() { 0 } else { size_of::<Rgb>() };
        Self::POSITION_BYTES + (material + color) as u64
    }

    /// Makes room for `additional` spheres without materials and colors.
    ///
    /// # Errors
    ///
    /// There is not that much memory.
    pub fn try_reserve(&mut self, additional: usize) -> Result<(), TryReserveError> {
        [&mut self.x, &mut self.y, &mut self.z, &mut self.radius]
            .into_iter()
            .try_for_each(|column| column.try_reserve_exact(additional))
    }
}

/// Appends `values` to a column that may be empty where all of its `before` values are `usual`.
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

/// Appends a column that may be empty where all of its `count` values are `value` to one that may be
/// empty where all of its `before` values are `usual`.
fn append_usual<T: Copy + PartialEq>(
    column: &mut Vec<T>,
    before: usize,
    other: Vec<T>,
    (count, value): (usize, T),
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

/// Appends without a copy where there is nothing to append to: columns can be gigabytes.
fn append_or_take(column: &mut Vec<f64>, mut other: Vec<f64>) {
    if column.is_empty() { *column = other } else { column.append(&mut other) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_stay_empty_until_something_unusual_comes() {
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
    fn columns_are_taken_where_there_are_none() {
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
