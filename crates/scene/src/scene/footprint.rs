//! Memory of a world, while it is built and afterwards.
//!
//! The columns of a scene are large, and so are those of its world: the peak memory of a render depends
//! on which of them exist at the same time. The numbers here are bytes per sphere and follow
//! `World::build_taking` step by step.

use super::{BodyBytes, Material, NamedMaterial, Rgb, Scene, SliceMode, Spheres};
use std::collections::HashSet;

/// Center and radius in single precision, and the id.
const COLUMNS: u64 = 20;

/// Nodes of the tree: between 4.6, if all are full, and 8.
const TREE: u64 = 6;

/// Rows from which the tree is built, their copy and keys during the sort, and the nodes of the binary
/// tree.
const BUILDING: u64 = 48;

/// An emissive sphere in the light tree during its construction.
const EMITTER: u64 = 220;

/// A flag, such as for spheres that slices hide from the camera.
const FLAG: u64 = 1;

/// Number of spheres that are sampled to find whether there are few distinct colors.
const SAMPLED: usize = 4096;

/// Number of distinct colors that a byte can encode.
const CODED: usize = 256;

/// Storage of colors of single spheres, in ascending order of memory.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum ColorColumn {
    /// Every sphere has the color of its material.
    #[default]
    None,
    /// At most 256 distinct colors: the world keeps a byte per sphere.
    Coded,
    /// The world keeps three numbers per sphere.
    Rows,
}

/// Counts of a scene that decide how much memory its world takes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Footprint {
    /// Spheres of the scene.
    pub spheres: u64,
    /// Storage of colors of single spheres.
    pub colors: ColorColumn,
    /// True if spheres have different materials.
    pub materials: bool,
    /// Spheres that emit light.
    pub emitters: u64,
    /// Memory of all other bodies.
    pub others: BodyBytes,
    /// Spheres that the camera sees, if slices hide others.
    pub visible: Option<u64>,
}

impl Footprint {
    /// Counts a scene.
    pub fn of(scene: &Scene) -> Self {
        let spheres = &scene.spheres;
        let columns = Self::of_columns(spheres, &scene.materials);
        let hiding: Vec<_> =
            scene.slices.iter().filter(|slice| slice.mode == SliceMode::Hide).collect();
        let hidden = |row: &usize| hiding.iter().any(|slice| slice.hides(spheres.center(*row)));
        let visible = || (0..spheres.len()).filter(|row| !hidden(row)).count() as u64;
        Self {
            visible: (!hiding.is_empty()).then(visible),
            others: scene.other_bodies().into_iter().fold(BodyBytes::default(), |all, bodies| {
                all.plus(bodies.bytes_each().of(bodies.len()))
            }),
            ..columns
        }
    }

    /// Counts spheres in their columns.
    pub fn of_columns(spheres: &Spheres, materials: &[NamedMaterial]) -> Self {
        Self {
            spheres: spheres.len() as u64,
            colors: ColorColumn::of(&spheres.color),
            materials: !spheres.material.is_empty(),
            emitters: emitters(spheres, materials),
            others: BodyBytes::default(),
            visible: None,
        }
    }

    /// Returns the counts of both in one scene.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            spheres: self.spheres.saturating_add(other.spheres),
            colors: self.colors.max(other.colors),
            materials: self.materials || other.materials,
            emitters: self.emitters.saturating_add(other.emitters),
            others: self.others.plus(other.others),
            visible: None,
        }
    }

    /// Returns the bytes of the scene's own columns.
    pub fn scene(&self) -> u64 {
        let colors = if self.colors == ColorColumn::None { 0 } else { size_of::<Rgb>() as u64 };
        let each = Spheres::POSITION_BYTES + colors + self.material_bytes();
        self.spheres.saturating_mul(each).saturating_add(self.others.columns)
    }

    /// Returns the peak memory in bytes of scene and world, while
    /// `World::build_taking` builds the world.
    pub fn peak(&self) -> u64 {
        self.peak_keeping(0)
    }

    /// Returns the bytes of the world after its construction.
    pub fn resident(&self) -> u64 {
        self.spheres.saturating_mul(COLUMNS + TREE + self.appearance_bytes())
    }

    /// Returns the peak memory in bytes of construction, if `kept` bytes of the scene's columns are not
    /// freed.
    pub fn peak_keeping(&self, kept: u64) -> u64 {
        let each = |bytes: u64| self.spheres.saturating_mul(bytes);
        let coded = if self.colors == ColorColumn::Coded { FLAG } else { 0 };
        let flags = if self.visible.is_some() { FLAG } else { 0 };
        let encoding = self.scene().saturating_add(each(coded));
        let positions = if kept > 0 { 0 } else { each(Spheres::POSITION_BYTES) };
        let placing = positions
            .saturating_add(each(COLUMNS + self.appearance_bytes() + flags))
            .saturating_add(kept);
        let building = each(BUILDING + self.appearance_bytes() + flags).saturating_add(kept);
        // Each has its row, and they have a tree of their own.
        let visible = self.visible.unwrap_or(0);
        let hiding = visible.saturating_mul(size_of::<usize>() as u64 + COLUMNS + BUILDING);
        let world = self.resident().saturating_add(kept);
        let hiding = world.saturating_add(each(flags)).saturating_add(hiding);
        let lighting = world.saturating_add(self.emitters.saturating_mul(EMITTER));
        let columns = if kept > 0 { 0 } else { self.others.columns };
        let spheres = encoding.max(placing).max(building).max(hiding).max(lighting);
        spheres.saturating_add(columns).saturating_add(self.others.building)
    }

    fn material_bytes(&self) -> u64 {
        if self.materials { size_of::<u32>() as u64 } else { 0 }
    }

    /// Returns the bytes of a sphere's color and material in the world.
    fn appearance_bytes(&self) -> u64 {
        let colors = match self.colors {
            ColorColumn::None => 0,
            ColorColumn::Coded => FLAG,
            ColorColumn::Rows => size_of::<Rgb>() as u64,
        };
        colors + self.material_bytes()
    }
}

impl ColorColumn {
    /// Returns the storage, judged by the first colors.
    fn of(colors: &[Rgb]) -> Self {
        if colors.is_empty() {
            return Self::None;
        }
        let sample = colors.iter().take(SAMPLED).map(|color| color.to_array().map(f32::to_bits));
        let different: HashSet<_> = sample.collect();
        if different.len() > CODED { Self::Rows } else { Self::Coded }
    }
}

/// Counts the spheres whose material emits light.
fn emitters(spheres: &Spheres, materials: &[NamedMaterial]) -> u64 {
    let emits: Vec<bool> =
        materials.iter().map(|row| matches!(row.material, Material::Emitter { .. })).collect();
    let emits = |row: u32| emits.get(row as usize).copied().unwrap_or(false);
    if spheres.material.is_empty() {
        return if emits(0) { spheres.len() as u64 } else { 0 };
    }
    spheres.material.iter().filter(|&&row| emits(row)).count() as u64
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn footprint(spheres: u64) -> Footprint {
        Footprint { spheres, ..Footprint::default() }
    }

    #[test]
    fn scene_and_columns_exist_at_the_same_time() {
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
    fn only_emissive_spheres_take_the_memory_of_lights() {
        let mut scene = Scene::default();
        let white = Material::Lambertian { color: Rgb::ONE };
        let emitter = Material::Emitter { radiance: Rgb::ONE, albedo: Rgb::ZERO };
        scene.materials = [("white", white), ("emitter", emitter)]
            .map(|(name, material)| NamedMaterial { name: name.into(), material })
            .into();
        for index in 0..1000 {
            scene.spheres.push(DVec3::X * f64::from(index), 0.3, u32::from(index == 7), Rgb::ONE);
        }
        let one = Footprint::of(&scene);
        assert_eq!((one.emitters, one.colors), (1, ColorColumn::None));
        scene.spheres.material.fill(1);
        let all = Footprint::of(&scene);
        assert_eq!(all.emitters, 1000);
        assert!(all.peak() > 3 * one.peak());
    }

    #[test]
    fn few_colors_are_distinguished_from_many() {
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
            others: BodyBytes { columns: u64::MAX, building: u64::MAX },
            visible: Some(u64::MAX),
        };
        assert_eq!((all.scene(), all.peak(), all.resident()), (u64::MAX, u64::MAX, u64::MAX));
    }
}
