//! Memory that a world takes while it is built, and once it is there.
//!
//! The columns of a scene are large, and so are those of its world: which of them exist at the same time
//! decides how much memory a render takes at most. The numbers here follow [`World::build_taking`] step
//! by step and are bytes for each sphere.

use super::World;
use crate::scene::{self, Material, NamedMaterial, Rgb, Scene, SliceMode};
use std::collections::HashSet;

/// Center and radius in single precision, and the id.
const COLUMNS: u64 = 20;

/// Nodes of the tree: between 4.6, where all are full, and 8.
const TREE: u64 = 6;

/// Rows that the tree is made of, their copy and keys while they are sorted, and the branches of the
/// binary tree.
const BUILDING: u64 = 48;

/// An emissive sphere in the tree of lights while that is grown.
const EMITTER: u64 = 220;

/// A flag, such as whether slices hide a sphere from the camera.
const FLAG: u64 = 1;

/// Spheres in which colors are looked for, to find out whether there are few different ones.
const SAMPLED: usize = 4096;

/// Different colors of single spheres that a byte tells apart.
const CODED: usize = 256;

/// Colors of single spheres, in the order of the memory that they take.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum ColorColumn {
    /// Every sphere has the color of its material.
    #[default]
    None,
    /// At most 256 different ones: the world keeps a byte for each sphere.
    Coded,
    /// The world keeps three numbers for each sphere.
    Rows,
}

/// Counts of a scene that decide how much memory its world takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Spheres of the scene.
    pub spheres: u64,
    /// Colors of single spheres.
    pub colors: ColorColumn,
    /// Whether spheres have different materials.
    pub materials: bool,
    /// Spheres that emit light.
    pub emitters: u64,
    /// Spheres that the camera sees, where slices hide the others.
    pub visible: Option<u64>,
}

impl Footprint {
    /// Counts of a scene that is there.
    pub fn of(scene: &Scene) -> Self {
        let spheres = &scene.spheres;
        let columns = Self::of_columns(spheres, &scene.materials);
        let hiding: Vec<_> =
            scene.slices.iter().filter(|slice| slice.mode == SliceMode::Hide).collect();
        let hidden = |row: &usize| hiding.iter().any(|slice| slice.hides(spheres.center(*row)));
        let visible = || (0..spheres.len()).filter(|row| !hidden(row)).count() as u64;
        Self { visible: (!hiding.is_empty()).then(visible), ..columns }
    }

    /// Counts of spheres in their columns.
    pub fn of_columns(spheres: &scene::Spheres, materials: &[NamedMaterial]) -> Self {
        Self {
            spheres: spheres.len() as u64,
            colors: ColorColumn::of(&spheres.color),
            materials: !spheres.material.is_empty(),
            emitters: emitters(spheres, materials),
            visible: None,
        }
    }

    /// Counts of both, in one scene.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            spheres: self.spheres.saturating_add(other.spheres),
            colors: self.colors.max(other.colors),
            materials: self.materials || other.materials,
            emitters: self.emitters.saturating_add(other.emitters),
            visible: None,
        }
    }

    /// Bytes of the scene's own columns.
    pub fn scene(&self) -> u64 {
        let colors = if self.colors == ColorColumn::None { 0 } else { size_of::<Rgb>() as u64 };
        let each = scene::Spheres::POSITION_BYTES + colors + self.material_bytes();
        self.spheres.saturating_mul(each)
    }

    /// Bytes of the scene and the world together at most, while [`World::build_taking`] builds it.
    pub fn peak(&self) -> u64 {
        self.peak_beside(0)
    }

    /// Bytes of the world once it is there.
    pub fn resident(&self) -> u64 {
        self.spheres.saturating_mul(COLUMNS + TREE + self.look_bytes())
    }

    /// Bytes at most while the world is built, where `kept` bytes of the scene's columns are not given
    /// away.
    fn peak_beside(&self, kept: u64) -> u64 {
        let each = |bytes: u64| self.spheres.saturating_mul(bytes);
        let coded = if self.colors == ColorColumn::Coded { FLAG } else { 0 };
        let flags = if self.visible.is_some() { FLAG } else { 0 };
        let encoding = self.scene().saturating_add(each(coded));
        let positions = if kept > 0 { 0 } else { each(scene::Spheres::POSITION_BYTES) };
        let placing = positions
            .saturating_add(each(COLUMNS + self.look_bytes() + flags))
            .saturating_add(kept);
        let building = each(BUILDING + self.look_bytes() + flags).saturating_add(kept);
        // Each with its row, and a tree of its own.
        let visible = self.visible.unwrap_or(0);
        let hiding = visible.saturating_mul(size_of::<usize>() as u64 + COLUMNS + BUILDING);
        let world = self.resident().saturating_add(kept);
        let hiding = world.saturating_add(each(flags)).saturating_add(hiding);
        let lighting = world.saturating_add(self.emitters.saturating_mul(EMITTER));
        encoding.max(placing).max(building).max(hiding).max(lighting)
    }

    fn material_bytes(&self) -> u64 {
        if self.materials { size_of::<u32>() as u64 } else { 0 }
    }

    /// Bytes of a sphere's color and material in the world.
    fn look_bytes(&self) -> u64 {
        let colors = match self.colors {
            ColorColumn::None => 0,
            ColorColumn::Coded => FLAG,
            ColorColumn::Rows => size_of::<Rgb>() as u64,
        };
        colors + self.material_bytes()
    }
}

impl ColorColumn {
    /// By the first of the colors.
    fn of(colors: &[Rgb]) -> Self {
        if colors.is_empty() {
            return Self::None;
        }
        let sample = colors.iter().take(SAMPLED).map(|color| color.to_array().map(f32::to_bits));
        let different: HashSet<_> = sample.collect();
        if different.len() > CODED { Self::Rows } else { Self::Coded }
    }
}

/// Number of spheres of a material that emits light.
fn emitters(spheres: &scene::Spheres, materials: &[NamedMaterial]) -> u64 {
    let emits: Vec<bool> =
        materials.iter().map(|row| matches!(row.material, Material::Emitter { .. })).collect();
    let emits = |row: u32| emits.get(row as usize).copied().unwrap_or(false);
    if spheres.material.is_empty() {
        return if emits(0) { spheres.len() as u64 } else { 0 };
    }
    spheres.material.iter().filter(|&&row| emits(row)).count() as u64
}

impl World {
    /// Bytes that [`World::build_taking`] takes at most, beside those of the scene.
    pub fn bytes_beside(scene: &Scene) -> u64 {
        let footprint = Footprint::of(scene);
        footprint.peak().saturating_sub(footprint.scene())
    }

    /// Bytes that [`World::build_with`] takes at most, beside those of the scene.
    pub(super) fn bytes_for(scene: &Scene) -> u64 {
        let footprint = Footprint::of(scene);
        let kept = footprint.scene();
        footprint.peak_beside(kept).saturating_sub(kept)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::NamedMaterial;
    use glam::DVec3;

    fn footprint(spheres: u64) -> Footprint {
        Footprint { spheres, ..Footprint::default() }
    }

    #[test]
    fn scene_and_columns_are_there_at_the_same_time() {
        assert_eq!(footprint(1000).scene(), 32_000);
        assert_eq!(footprint(1000).peak(), 52_000);
        let colored = Footprint { colors: ColorColumn::Rows, ..footprint(1000) };
        assert_eq!((colored.scene(), colored.peak()), (44_000, 64_000));
        let coded = Footprint { colors: ColorColumn::Coded, ..footprint(1000) };
        assert_eq!((coded.scene(), coded.peak()), (44_000, 53_000));
        let mixed = Footprint { materials: true, ..colored };
        assert_eq!((mixed.scene(), mixed.peak()), (48_000, 68_000));
    }

    #[test]
    fn only_spheres_that_emit_take_the_room_of_lights() {
        let mut scene = Scene::default();
        let white = Material::Lambertian { color: Rgb::ONE };
        let lamp = Material::Emitter { radiance: Rgb::ONE, albedo: Rgb::ZERO };
        scene.materials = [("white", white), ("lamp", lamp)]
            .map(|(name, material)| NamedMaterial { name: name.into(), material })
            .into();
        for place in 0..1000 {
            scene.spheres.push(DVec3::X * f64::from(place), 0.3, u32::from(place == 7), Rgb::ONE);
        }
        let one = Footprint::of(&scene);
        assert_eq!((one.emitters, one.colors), (1, ColorColumn::None));
        scene.spheres.material.fill(1);
        let all = Footprint::of(&scene);
        assert_eq!(all.emitters, 1000);
        assert!(all.peak() > 3 * one.peak());
    }

    #[test]
    fn few_colors_are_told_from_many() {
        let gray = |row: usize, count: usize| Rgb::splat((row % count) as f32 / count as f32);
        let column = |count| (0..1000).map(|row| gray(row, count)).collect::<Vec<_>>();
        assert_eq!(ColorColumn::of(&[]), ColorColumn::None);
        assert_eq!(ColorColumn::of(&column(256)), ColorColumn::Coded);
        assert_eq!(ColorColumn::of(&column(257)), ColorColumn::Rows);
    }

    #[test]
    fn absurd_counts_do_not_overflow() {
        let all = Footprint {
            spheres: u64::MAX,
            colors: ColorColumn::Rows,
            materials: true,
            emitters: u64::MAX,
            visible: Some(u64::MAX),
        };
        assert_eq!((all.scene(), all.peak(), all.resident()), (u64::MAX, u64::MAX, u64::MAX));
    }
}
