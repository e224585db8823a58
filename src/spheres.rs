//! Spheres as rays meet them: columns of centers and radii, single precision.

use glam::{DVec3, Vec3};

/// The spheres. All columns have the same length, and row `i` of each belongs to sphere `i`.
#[derive(Clone, Debug, Default)]
pub struct Spheres {
    /// Centers, x.
    pub x: Vec<f32>,
    /// Centers, y.
    pub y: Vec<f32>,
    /// Centers, z.
    pub z: Vec<f32>,
    /// Radii, more than 0.
    pub radius: Vec<f32>,
    /// Place in the user's order, which the rows leave when the tree is built; of two spheres at
    /// the same distance the one with the lower id is hit.
    pub id: Vec<u32>,
    /// What centers and radii are exactly, if the columns could not hold it; empty otherwise.
    pub(crate) precise: Vec<(DVec3, f64)>,
}

impl Spheres {
    /// The most spheres there can be: the last few numbers of 32 bits mean something else.
    pub const MAX: usize = (u32::MAX - 16) as usize;

    /// Spheres in the order given, which becomes their id.
    pub fn from_columns(x: Vec<f32>, y: Vec<f32>, z: Vec<f32>, radius: Vec<f32>) -> Self {
        let id = (0..radius.len() as u32).collect();
        Self { x, y, z, radius, id, precise: Vec::new() }
    }

    /// No spheres, with room for as many.
    pub(crate) fn with_capacity(count: usize) -> Self {
        let column = || Vec::with_capacity(count);
        let id = Vec::with_capacity(count);
        Self { x: column(), y: column(), z: column(), radius: column(), id, precise: Vec::new() }
    }

    /// Number of spheres.
    pub fn len(&self) -> usize {
        self.radius.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.radius.is_empty()
    }

    /// The center of sphere `i`.
    #[inline(always)]
    pub fn center(&self, i: usize) -> Vec3 {
        Vec3::new(self.x[i], self.y[i], self.z[i])
    }

    /// Center and radius of sphere `i` for the exact test.
    #[inline(always)]
    pub fn exact(&self, i: usize) -> (DVec3, f64) {
        match self.precise.get(i) {
            Some(&sphere) => sphere,
            None => (self.center(i).as_dvec3(), f64::from(self.radius[i])),
        }
    }

    /// For each of some spheres the one that is hit in its place: of those that coincide the first
    /// of the user's. Ascending, without repetition; not all are of the rows given.
    pub fn first_of_equals(&self, rows: impl Iterator<Item = u32>) -> Vec<u32> {
        let key = |i: usize| [self.x[i], self.y[i], self.z[i], self.radius[i]].map(f32::to_bits);
        let mut firsts: Vec<_> = rows.map(|row| (key(row as usize), row)).collect();
        if firsts.is_empty() {
            return Vec::new();
        }
        firsts.sort_unstable();
        firsts.dedup_by_key(|first| first.0);
        for i in 0..self.len() {
            if let Ok(place) = firsts.binary_search_by_key(&key(i), |first| first.0)
                && self.id[i] < self.id[firsts[place].1 as usize]
            {
                firsts[place].1 = i as u32;
            }
        }
        let mut firsts: Vec<_> = firsts.into_iter().map(|first| first.1).collect();
        firsts.sort_unstable();
        firsts
    }

    /// Bytes that the columns occupy.
    pub fn bytes(&self) -> usize {
        self.len() * (4 * size_of::<f32>() + size_of::<u32>())
            + size_of_val(self.precise.as_slice())
    }

    /// Puts row `order[i]` in row `i` of every column.
    pub(crate) fn permute(&mut self, order: &[u32]) {
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
            permute(column, order);
        }
        permute(&mut self.id, order);
        if !self.precise.is_empty() {
            permute(&mut self.precise, order);
        }
    }
}

fn permute<T: Copy>(rows: &mut Vec<T>, order: &[u32]) {
    *rows = order.iter().map(|&row| rows[row as usize]).collect();
}
