//! Spheres in columns, single precision, in the order of the tree's leaves.

use super::materials::{MaterialId, Materials};
use super::{Frame, WorldError};
use crate::scene::{self, Scene};
use glam::{DVec3, Vec3};

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

    fn permute(&mut self, order: &[u32]) {
        if let Self::Rows(rows) = self {
            permute(rows, order);
        }
    }
}

/// The spheres. All columns have the same length.
#[derive(Clone, Debug)]
pub struct Spheres {
    /// Centers, x.
    pub x: Vec<f32>,
    /// Centers, y.
    pub y: Vec<f32>,
    /// Centers, z.
    pub z: Vec<f32>,
    /// Radii, more than 0.
    pub radius: Vec<f32>,
    /// Row in the user's scene; of two spheres at the same distance the lower one is hit.
    pub id: Vec<u32>,
    /// What the sphere is made of.
    pub material: Column<MaterialId>,
    /// Factor on the material's color; none if every one is white.
    pub color: Option<Vec<[f32; 3]>>,
}

impl Spheres {
    /// The most spheres a world can hold.
    pub const MAX: usize = (u32::MAX - 16) as usize;

    /// Spheres of one material without colors, as given: for tests and benches.
    pub fn from_columns(x: Vec<f32>, y: Vec<f32>, z: Vec<f32>, radius: Vec<f32>) -> Self {
        let id = (0..radius.len() as u32).collect();
        Self { x, y, z, radius, id, material: Column::Uniform(MaterialId::default()), color: None }
    }

    pub(super) fn build(scene: &Scene, frame: &Frame, materials: &Materials) -> Self {
        let from = &scene.spheres;
        let single = |i: usize| {
            let center = frame.point(center(from, i)).as_vec3();
            (center, frame.length(from.radius[i]) as f32)
        };
        let kept: Vec<u32> =
            (0..from.len() as u32).filter(|&i| single(i as usize).1 > 0.0).collect();
        let column = |f: &dyn Fn(usize) -> f32| kept.iter().map(|&i| f(i as usize)).collect();
        Self {
            x: column(&|i| single(i).0.x),
            y: column(&|i| single(i).0.y),
            z: column(&|i| single(i).0.z),
            radius: column(&|i| single(i).1),
            material: material_column(from, &kept, materials),
            color: (!from.color.is_empty())
                .then(|| kept.iter().map(|&i| from.color[i as usize].to_array()).collect()),
            id: kept,
        }
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
        let colors = self.color.as_ref().map_or(0, |colors| size_of_val(colors.as_slice()));
        self.len() * (4 * size_of::<f32>() + size_of::<u32>()) + self.material.bytes() + colors
    }

    /// Puts row `order[i]` in row `i` of every column.
    pub(crate) fn permute(&mut self, order: &[u32]) {
        for column in [&mut self.x, &mut self.y, &mut self.z, &mut self.radius] {
            permute(column, order);
        }
        permute(&mut self.id, order);
        self.material.permute(order);
        if let Some(colors) = &mut self.color {
            permute(colors, order);
        }
    }
}

fn permute<T: Copy>(rows: &mut Vec<T>, order: &[u32]) {
    *rows = order.iter().map(|&row| rows[row as usize]).collect();
}

fn center(spheres: &scene::Spheres, i: usize) -> DVec3 {
    DVec3::new(spheres.x[i], spheres.y[i], spheres.z[i])
}

fn material_column(
    from: &scene::Spheres,
    kept: &[u32],
    materials: &Materials,
) -> Column<MaterialId> {
    let row_of = |i: u32| from.material.get(i as usize).copied().unwrap_or(0);
    let first = kept.first().map_or(0, |&i| row_of(i));
    if kept.iter().all(|&i| row_of(i) == first) {
        return Column::Uniform(materials.id(first));
    }
    Column::Rows(kept.iter().map(|&i| materials.id(row_of(i))).collect())
}

/// Checks what only code can get wrong: files are checked when they are read, with their lines.
pub(super) fn validate(scene: &Scene) -> Result<(), WorldError> {
    let spheres = &scene.spheres;
    let n = spheres.len();
    if n > Spheres::MAX {
        return Err(WorldError::TooManySpheres(n));
    }
    let invalid = |what: String| Err(WorldError::Invalid(what));
    let optional = |len: usize| len == 0 || len == n;
    if [spheres.x.len(), spheres.y.len(), spheres.z.len()] != [n; 3]
        || !optional(spheres.material.len())
        || !optional(spheres.color.len())
    {
        return invalid(format!("the columns of the spheres differ in length from `radius`, {n}"));
    }
    for i in 0..n {
        if !(center(spheres, i).is_finite()
            && spheres.radius[i].is_finite()
            && spheres.radius[i] > 0.0)
        {
            return invalid(format!(
                "sphere {i}: the center must be finite and the radius more than 0, not {:?} and {}",
                center(spheres, i),
                spheres.radius[i]
            ));
        }
    }
    let used = spheres.material.iter().copied().max().unwrap_or(0);
    let used = used.max(scene.ground.as_ref().map_or(0, |ground| ground.material));
    if (n > 0 || scene.ground.is_some()) && used as usize >= scene.materials.len() {
        return invalid(format!(
            "material {used} does not exist: the scene has {}",
            scene.materials.len()
        ));
    }
    Ok(())
}
