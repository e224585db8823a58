//! Preview: direct light without noise, for pictures of a moving camera.
//!
//! Nothing is random: rays go through the middles of pixels, shadow rays to the middles of lights; the environment lights
//! surfaces as if nothing hid it; mirrors and glass continue a path in one direction. So there is no noise, shadows are
//! hard, and light from other surfaces is missing. Where bodies are translucent, the colors of all on a ray are seen, lit as the
//! one that the ray chooses.

use super::Job;
use super::glass;
use super::material_table::{MaterialsOfKind, gather_bsdfs};
use super::path_state::PathStateRow;
use super::shading_row::{ShadingRow, SurfaceLanes};
use super::shadow_queue::enqueue_shadow_rays;
use super::stages;
use super::whitted;
use super::workspace::Workspace;
use crate::lanes::{F32x16, Lanes, Mask, bits};
use crate::ray::GROUND;
use crate::shade::{Bsdf, KindVisitor, Material, MaterialId, MaterialKind, mirror};
use crate::vec3::Vec3;
use crate::world::{Irradiance, MAX_MIDDLES};
use std::f32::consts::{FRAC_1_PI, PI};

/// Maximum number of bounces at mirrors and glass.
const DEPTH: u32 = 6;

/// Throughput below which mirrored light is left out.
const MIN_THROUGHPUT: f32 = 0.01;

/// Fraction of the environment that is taken as visible from the edge of a sphere; more is toward its middle. Without
/// it, spheres under even light would look flat.
const EDGE: f32 = 0.4;

/// About the mean light of surfaces, as a part of what they get where nothing hides the environment.
const MEAN: f32 = 0.8;

/// The light of a preview.
pub struct Lighting {
    /// Irradiance by the environment.
    pub irradiance: Irradiance,
    /// True if lights other than the environment are on.
    pub lights: bool,
    /// True if they cast shadows.
    pub shadows: bool,
    /// True if surfaces show their color alone.
    pub flat: bool,
}

/// Follows all paths to their ends.
pub fn integrate(job: &Job, work: &mut Workspace, lighting: &Lighting) {
    work.composite_colors();
    for bounce in 0..=DEPTH.min(job.depth()) {
        stages::intersect(job, work);
        whitted::add_environment(job, work, bounce);
        whitted::add_emitted(job, work);
        glass::scatter_by(job, work, bounce, |_, _| F32x16::splat(0.5));
        job.world.materials.for_each_kind(&mut Shade { job, work, lighting });
        if bounce == 0 {
            let visible = if lighting.flat { 1.0 } else { MEAN };
            work.add_missing_colors(visible * FRAC_1_PI * lighting.irradiance.mean());
        }
        if !stages::end_bounce(job, work) {
            return;
        }
    }
}

/// A visitor that shades the queues of one bounce.
struct Shade<'a> {
    job: &'a Job<'a>,
    work: &'a mut Workspace,
    lighting: &'a Lighting,
}

impl KindVisitor for Shade<'_> {
    fn visit<M: Material>(&mut self, kind: MaterialKind, table: impl Fn(MaterialId) -> M) {
        let Some(queue) = self.work.queues.take(kind) else { return };
        let materials = MaterialsOfKind { kind, table };
        for rows in queue.rows() {
            let surface_row = SurfaceLanes::load(&queue, rows.first);
            let shading = ShadingRow::new(&queue, rows, &surface_row);
            self.shade(&shading, &materials);
        }
        self.work.queues.put(kind, queue);
    }
}

impl Shade<'_> {
    /// Lights at most sixteen hits, and spawns mirrored rays.
    fn shade<M: Material>(
        &mut self,
        shading: &ShadingRow,
        materials: &MaterialsOfKind<impl Fn(MaterialId) -> M>,
    ) {
        let (world, lookup) = (self.job.world, self.work.material_table.as_ref());
        let bsdf: M::Bsdf<F32x16> =
            gather_bsdfs(world, lookup, materials, &shading.surface_row.at.own);
        let lanes = shading.lanes & !bsdf.is_delta().bits();
        if lanes != 0 {
            self.add_environment::<M>(shading, &bsdf, lanes);
            if self.lighting.lights {
                self.add_lights::<M>(shading, &bsdf, lanes);
            }
        }
        self.spawn_mirrored::<M>(shading, &bsdf);
    }

    /// Adds the light of the environment, as if it came from above.
    #[inline(always)]
    fn add_environment<M: Material>(
        &mut self,
        shading: &ShadingRow,
        bsdf: &M::Bsdf<F32x16>,
        lanes: u32,
    ) {
        let SurfaceLanes { at, state, .. } = shading.surface_row;
        let above = bsdf.eval(shading.outgoing, Vec3::splat(0.0, 0.0, 1.0));
        let edge = if self.lighting.flat { 1.0 } else { EDGE };
        let facing = F32x16::splat(edge) + F32x16::splat(1.0 - edge) * shading.outgoing.z;
        let own = F32x16::new(at.own.map(f32::from_bits));
        let on_ground = own.has_bits_of(bits::<F32x16>(GROUND));
        let visible = Lanes::select(on_ground, F32x16::splat(1.0), facing);
        let share = above.map(|response| brightened(visible, response * F32x16::splat(PI)));
        let light = above.times(self.lighting.irradiance.at(at.normal)).times(share);
        self.work.paths.add(state.path, state.throughput.times(light), lanes);
    }

    /// Adds the light of the middles of lights.
    #[inline(always)]
    fn add_lights<M: Material>(
        &mut self,
        shading: &ShadingRow,
        bsdf: &M::Bsdf<F32x16>,
        lanes: u32,
    ) {
        let (world, surface_row) = (self.job.world, shading.surface_row);
        let lights = &world.lights;
        for index in 0..lights.count_without_sky().min(MAX_MIDDLES) {
            let samples = world.middle_light_row(&surface_row.at, index, lanes);
            let incoming = shading.bases.to_local(samples.direction);
            let response = bsdf.eval(shading.outgoing, incoming);
            let light = surface_row.state.throughput.times(response).times(samples.weight);
            let lit = samples.lanes & Lanes::lt(F32x16::splat(0.0), incoming.z).bits();
            if self.lighting.shadows {
                enqueue_shadow_rays(self.job, self.work, surface_row, &samples, lit, light);
            } else {
                self.work.paths.add(surface_row.state.path, light, lit);
            }
        }
    }

    /// Spawns rays in mirrored directions, whatever the roughness.
    #[inline(always)]
    fn spawn_mirrored<M: Material>(&mut self, shading: &ShadingRow, bsdf: &M::Bsdf<F32x16>) {
        let state = &shading.surface_row.state;
        let weight = if M::HAS_DIFFUSE_BASE {
            bsdf.mirrored(shading.outgoing)
        } else {
            shading.surface_row.albedo(self.job.world)
        };
        let throughput = state.throughput.times(weight);
        let bright = Lanes::lt(F32x16::splat(MIN_THROUGHPUT), throughput.max_element());
        let lanes = shading.lanes & bright.bits();
        if lanes == 0 {
            return;
        }
        let previous = state.previous.next(F32x16::splat(0.0), M::DIFFUSE);
        let normal = shading.surface_row.at.normal;
        let next = PathStateRow { throughput, previous, normal, ..*state };
        let direction = shading.to_world(mirror(shading.outgoing));
        self.work.spawn_rays(self.job.world, shading.surface_row, lanes, direction, &next);
    }
}

/// Returns the fraction of light that arrives where a fraction of the environment is visible, and all around has the
/// same albedo: a fit of path-traced values.
///
/// Jimenez, Wu, Pesce and Jarabo, "Practical Real-Time Strategies for Accurate Indirect Occlusion", 2016, equation 10.
#[inline(always)]
fn brightened<L: Lanes>(visible: L, albedo: L) -> L {
    let linear = |slope, constant| L::splat(slope).mul_add(albedo, L::splat(constant));
    let [a, b, c] = [linear(2.0404, -0.3324), linear(-4.7951, 0.6417), linear(2.7552, 0.6903)];
    let fitted = a.mul_add(visible, b).mul_add(visible, c) * visible;
    Lanes::max(visible, fitted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bright_surroundings_give_light() {
        for visible in [0.4_f32, 0.7, 1.0] {
            let light = |albedo: f32| brightened(visible, albedo);
            assert!(light(0.0) <= visible + 0.01 && light(0.9) <= 1.02);
            assert!(light(0.9) >= light(0.5) && light(0.5) >= visible);
        }
    }
}
