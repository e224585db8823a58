//! The specular spheres and emitters of a world whose caustics are sampled.

use super::bounds::SampleBounds;
use super::estimate::EmitterView;
use super::isolation::Neighborhoods;
use super::tree::CasterTree;
use super::{Caster, CausticCasters, CausticEmitter, CausticSource};
use crate::scene::LightChoice;
use crate::shade::MaterialKind;
use crate::world::World;
use crate::world::environment::luminance;
use crate::world::lights::{LightSampler, Lights};
use rayon::prelude::*;

/// Most specular spheres whose caustics are sampled: their tree takes time and memory.
const MAX_CASTERS: u64 = 1 << 16;

/// Distance of suns, in units of the scene's extent: light that leaves a sphere toward a sun is parallel
/// to that from its center, to the last bit.
const FAR: f64 = 1e30;

impl CausticCasters {
    /// Finds the specular spheres and emitters of a world, which is complete otherwise.
    pub fn find(world: &World) -> Self {
        let emitters = emitters(world);
        let kinds = sampled_kinds(world);
        if emitters.is_empty() || kinds.is_empty() || !world.cut.is_empty() {
            return Self::default();
        }
        let casters = casters(world, kinds);
        if casters.is_empty() {
            return Self::default();
        }
        let bounds = world.lights.light_bounds(&world.spheres, &world.environment);
        let bounds: Vec<_> = emitter_indices(&world.lights).map(|index| bounds[index]).collect();
        let emitter_sampler = LightSampler::new(&bounds, LightChoice::Tree, world.lights.unit);
        let indices = casters.iter().zip(0..);
        let mut rows: Vec<_> = indices.map(|(caster, index)| [caster.row, index]).collect();
        rows.sort_unstable();
        let mut found = Self {
            tree: CasterTree::build(&casters),
            casters,
            rows,
            emitters,
            emitter_sampler,
            bounds: SampleBounds::default(),
            mirrored_light: world.lights.samples_mirrored_light(),
        };
        found.bounds = SampleBounds::build(&found, world.bvh.bounds(), world.ground.as_ref());
        found
    }
}

/// Returns the indices of emissive spheres and suns with discs among the lights.
fn emitter_indices(lights: &Lights) -> impl Iterator<Item = usize> {
    let first = lights.emitters.len() + lights.points.len();
    let suns = (0..lights.suns.len()).filter(|&sun| lights.suns[sun].disc.is_some());
    (0..lights.emitters.len()).chain(suns.map(move |sun| first + sun))
}

/// Returns the emitters, in the order of [`emitter_indices`].
fn emitters(world: &World) -> Vec<CausticEmitter> {
    let lights = &world.lights;
    let spheres = lights.emitters.iter().zip(&lights.radiance).map(|(&row, &radiance)| {
        let (center, radius) = world.spheres.exact(row as usize);
        let near = center.as_vec3();
        let view =
            EmitterView::Near { center: near, radius2: (radius as f32).powi(2), distance2: 0.0 };
        CausticEmitter { source: CausticSource::Sphere(row), radiance, center, radius, view }
    });
    let suns = lights.suns.iter().enumerate().filter_map(|(index, sun)| {
        let height = f64::from(sun.disc?.height());
        let sine2 = height * (2.0 - height);
        let far = FAR * lights.unit;
        let direction = sun.direction.as_dvec3().normalize();
        Some(CausticEmitter {
            source: CausticSource::Sun(index),
            radiance: sun.radiance,
            center: direction * far,
            radius: far * sine2.sqrt(),
            view: EmitterView::Far { direction: sun.direction, sine2: sine2 as f32 },
        })
    });
    spheres.chain(suns).collect()
}

/// Returns the kinds of specular materials whose caustics are sampled: all, if there are not too many
/// spheres of them, or those without coats, which reflect least.
fn sampled_kinds(world: &World) -> &'static [MaterialKind] {
    const KINDS: [MaterialKind; 3] =
        [MaterialKind::Conductor, MaterialKind::Dielectric, MaterialKind::Plastic];
    let count = |kinds: &&[MaterialKind]| {
        let each = kinds.iter().map(|&kind| world.features.spheres_of(kind));
        (1..=MAX_CASTERS).contains(&each.sum())
    };
    [&KINDS[..], &KINDS[..2]].into_iter().find(count).unwrap_or_default()
}

/// Returns the spheres of these kinds that are smooth mirrors, coated, or glass that stands alone, and not translucent.
fn casters(world: &World, kinds: &[MaterialKind]) -> Vec<Caster> {
    let rows = (0..world.spheres.len() as u32).into_par_iter();
    let smooth = |&row: &u32| {
        let id = world.appearance.material.row(row as usize);
        kinds.contains(&id.kind())
            && world.materials.optical_depth(id).is_opaque()
            && match id.kind() {
                MaterialKind::Conductor => world.materials.conductor[id.row()].roughness == 0.0,
                MaterialKind::Dielectric => world.materials.dielectric[id.row()].ior > 1.0,
                _ => world.materials.plastic[id.row()].ior > 1.0,
            }
    };
    let rows: Vec<u32> = rows.filter(smooth).collect();
    let mut rows = world.spheres.first_of_equals(rows.into_iter());
    rows.retain(smooth);
    if world.features.spheres_of(MaterialKind::Dielectric) > 0 {
        let neighborhoods = Neighborhoods::build(world);
        let stands_alone = |row: &u32| {
            world.material(*row).kind() != MaterialKind::Dielectric
                || neighborhoods.is_isolated(world, *row)
        };
        rows = rows.into_par_iter().filter(stands_alone).collect();
    }
    // In the user's order, the tree does not depend on that of the spheres.
    rows.sort_unstable_by_key(|&row| world.spheres.id[row as usize]);
    rows.into_iter().map(|row| caster(world, row)).collect()
}

fn caster(world: &World, row: u32) -> Caster {
    let (center, radius) = world.spheres.exact(row as usize);
    let id = world.material(row);
    let ior = match id.kind() {
        MaterialKind::Dielectric => Some(world.materials.dielectric[id.row()].ior),
        MaterialKind::Plastic => Some(world.materials.plastic[id.row()].ior),
        _ => None,
    };
    let index = ior.map_or(0.0, |ior| 1.0 / f64::from(ior));
    let normal_reflectance = if ior.is_some() {
        ((1.0 - index) / (1.0 + index)).powi(2)
    } else {
        let metal = world.materials.conductor[id.row()].color() * world.color(row);
        f64::from(luminance(metal)).max(1e-3)
    };
    let clear = id.kind() == MaterialKind::Dielectric;
    Caster { row, center, radius, index, clear, normal_reflectance }
}
