//! Materials: one table for each kind, and ids that say kind and row.

use super::conductor::Conductor;
use super::dielectric::Dielectric;
use super::fresnel;
use super::lambertian::{Emitter, Lambertian};
use super::plastic::Plastic;
use super::reflective::Reflective;
use crate::elementary::power_of_two;
use crate::scene::{Material, NamedMaterial, Rgb};
use crate::translucency::OpticalDepth;

/// The kinds of material, in the order in which they are shaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum MaterialKind {
    /// Ideally diffuse.
    Lambertian,
    /// Metal.
    Conductor,
    /// Clear glass.
    Dielectric,
    /// Diffuse under a coat.
    Plastic,
    /// A diffuse and a mirror share.
    Reflective,
    /// Emits light.
    Emitter,
}

impl MaterialKind {
    /// Number of kinds.
    pub const COUNT: usize = 6;

    /// All of them, in order.
    pub const ALL: [Self; Self::COUNT] = [
        Self::Lambertian,
        Self::Conductor,
        Self::Dielectric,
        Self::Plastic,
        Self::Reflective,
        Self::Emitter,
    ];

    /// The kind of a scene's material.
    pub fn of(material: &Material) -> Self {
        match material {
            Material::Translucent { surface, .. } => Self::of(surface),
            Material::Lambertian { .. } => Self::Lambertian,
            Material::Conductor { .. } => Self::Conductor,
            Material::Dielectric { .. } => Self::Dielectric,
            Material::Plastic { .. } => Self::Plastic,
            Material::Reflective { .. } => Self::Reflective,
            Material::Emitter { .. } => Self::Emitter,
        }
    }

    /// The name that scene files use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lambertian => "lambertian",
            Self::Conductor => "conductor",
            Self::Dielectric => "dielectric",
            Self::Plastic => "plastic",
            Self::Reflective => "reflective",
            Self::Emitter => "emitter",
        }
    }
}

/// A material: its kind in the upper bits, and its row in the kind's table in the lower ones.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct MaterialId(u32);

impl MaterialId {
    /// Number of a material, for files.
    pub fn bits(self) -> u32 {
        self.0
    }

    const ROW_BITS: u32 = 29;

    fn new(kind: MaterialKind, row: usize) -> Self {
        Self((kind as u32) << Self::ROW_BITS | row as u32)
    }

    /// Returns the kind, which has a table of its own.
    #[inline(always)]
    pub fn kind(self) -> MaterialKind {
        MaterialKind::ALL[(self.0 >> Self::ROW_BITS) as usize]
    }

    /// Returns the row of the table.
    #[inline(always)]
    pub fn row(self) -> usize {
        (self.0 & ((1 << Self::ROW_BITS) - 1)) as usize
    }
}

/// One table for each kind of material.
#[derive(Clone, Debug, Default)]
pub struct Materials {
    /// Diffuse ones.
    pub lambertian: Vec<Lambertian>,
    /// Metals.
    pub conductor: Vec<Conductor>,
    /// Glasses.
    pub dielectric: Vec<Dielectric>,
    /// Coated ones.
    pub plastic: Vec<Plastic>,
    /// The paper's.
    pub reflective: Vec<Reflective>,
    /// Emitters.
    pub emitter: Vec<Emitter>,
    /// From the scene's rows.
    ids: Vec<MaterialId>,
    /// Optical depths, by kind and row.
    optical_depth: [Vec<OpticalDepth>; MaterialKind::COUNT],
}

impl Materials {
    /// Returns the tables of a scene's materials.
    pub fn build(scene: &[NamedMaterial]) -> Self {
        let mut tables = Self::default();
        for named in scene {
            let id = tables.add(named.material.surface());
            tables.ids.push(id);
            let depth = OpticalDepth::of_opacity(named.material.opacity());
            tables.optical_depth[id.kind() as usize].push(depth);
        }
        tables
    }

    /// The color that distinguishes a material from others, each channel 0..=1: the diffuse color, a
    /// metal's reflectance from above, what glass lets through, an emitter's radiance up to 1.
    pub fn albedo(&self, id: MaterialId) -> Rgb {
        match id.kind() {
            MaterialKind::Lambertian => self.lambertian[id.row()].color,
            MaterialKind::Conductor => self.conductor[id.row()].color(),
            MaterialKind::Dielectric => self.dielectric[id.row()].color,
            MaterialKind::Plastic => self.plastic[id.row()].color,
            MaterialKind::Reflective => self.reflective[id.row()].color,
            MaterialKind::Emitter => self.emitter[id.row()].radiance.min(Rgb::ONE),
        }
    }

    /// Returns whether any material is translucent.
    pub(crate) fn has_translucent(&self) -> bool {
        self.optical_depth.iter().flatten().any(|depth| !depth.is_opaque())
    }

    /// The optical depth of a body of this material.
    #[inline(always)]
    pub(crate) fn optical_depth(&self, id: MaterialId) -> OpticalDepth {
        self.optical_depth[id.kind() as usize][id.row()]
    }

    /// The material of a number that [`MaterialId::bits`] gave; `None` if there is none.
    pub fn find(&self, bits: u32) -> Option<MaterialId> {
        let kind = *MaterialKind::ALL.get((bits >> MaterialId::ROW_BITS) as usize)?;
        let id = MaterialId(bits);
        let rows = match kind {
            MaterialKind::Lambertian => self.lambertian.len(),
            MaterialKind::Conductor => self.conductor.len(),
            MaterialKind::Dielectric => self.dielectric.len(),
            MaterialKind::Plastic => self.plastic.len(),
            MaterialKind::Reflective => self.reflective.len(),
            MaterialKind::Emitter => self.emitter.len(),
        };
        (id.row() < rows).then_some(id)
    }

    /// The material in row `row` of the scene's list.
    pub fn id(&self, row: u32) -> MaterialId {
        self.ids.get(row as usize).copied().unwrap_or_default()
    }

    /// Calls a visitor for every kind of material except glass.
    pub fn for_each_kind(&self, visitor: &mut impl KindVisitor) {
        visitor.visit(MaterialKind::Lambertian, |id| self.lambertian[id.row()]);
        visitor.visit(MaterialKind::Conductor, |id| self.conductor[id.row()]);
        visitor.visit(MaterialKind::Plastic, |id| self.plastic[id.row()]);
        visitor.visit(MaterialKind::Reflective, |id| self.reflective[id.row()]);
        visitor.visit(MaterialKind::Emitter, |id| self.emitter[id.row()].surface());
    }

    fn add(&mut self, material: &Material) -> MaterialId {
        match *material {
            Material::Lambertian { color } => {
                push(&mut self.lambertian, MaterialKind::Lambertian, Lambertian { color })
            }
            Material::Conductor { fresnel, roughness } => push(
                &mut self.conductor,
                MaterialKind::Conductor,
                Conductor { fresnel, tint: Rgb::ONE, roughness: smooth_below(roughness) },
            ),
            Material::Dielectric { ior, color } => push(
                &mut self.dielectric,
                MaterialKind::Dielectric,
                Dielectric { ior: ior as f32, color },
            ),
            Material::Plastic { color, ior } => push(
                &mut self.plastic,
                MaterialKind::Plastic,
                Plastic {
                    color,
                    ior: ior as f32,
                    internal_reflectance: fresnel::internal_diffuse_reflectance(ior) as f32,
                },
            ),
            Material::Reflective { color, diffuse, mirror } => push(
                &mut self.reflective,
                MaterialKind::Reflective,
                Reflective { color, diffuse: diffuse as f32, mirror: mirror as f32 },
            ),
            Material::Emitter { radiance, albedo } => {
                push(&mut self.emitter, MaterialKind::Emitter, Emitter { radiance, albedo })
            }
            Material::Translucent { ref surface, .. } => self.add(surface),
        }
    }
}

/// A visitor of the kinds of materials.
pub trait KindVisitor {
    /// Visits one kind, whose materials `table` returns.
    fn visit<M: super::Material>(&mut self, kind: MaterialKind, table: impl Fn(MaterialId) -> M);
}

/// A mirror, where the density of its facets would overflow single precision.
fn smooth_below(roughness: f64) -> f32 {
    if roughness < power_of_two(-60) { 0.0 } else { roughness as f32 }
}

fn push<T>(table: &mut Vec<T>, kind: MaterialKind, row: T) -> MaterialId {
    table.push(row);
    MaterialId::new(kind, table.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_hold_kind_and_row() {
        for kind in MaterialKind::ALL {
            for row in [0, 1, (1 << 29) - 1] {
                let id = MaterialId::new(kind, row);
                assert_eq!((id.kind(), id.row()), (kind, row));
            }
        }
    }
}
