//! Spheres as rays meet them: columns of centers and radii, single precision.

use glam::Vec3;

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
}

impl Spheres {
    /// The most spheres there can be: the last few numbers of 32 bits mean something else.
    pub const MAX: usize = (u32::MAX - 16) as usize;

    /// Spheres in the order given, which becomes their id.
    pub fn from_columns(x: Vec<f32>, y: Vec<f32>, z: Vec<f32>, radius: Vec<f32>) -> Self {
        let id = (0..radius.len() as u32).collect();
        Self { x, y, z, radius, id }
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

    /// Bytes that the columns occupy.
    pub fn bytes(&self) -> usize {
        self.len() * (4 * size_of::<f32>() + size_of::<u32>())
    }

    /// Puts row `order[i]` in row `i` of every column.
    pub(crate) fn permute(&mut self, order: &[u32]) {
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
            permute(column, order);
        }
        permute(&mut self.id, order);
    }
}

fn permute<T: Copy>(rows: &mut Vec<T>, order: &[u32]) {
    *rows = order.iter().map(|&row| rows[row as usize]).collect();
}
