//! Shading of diffuse surfaces, sixteen paths at a time: they are all alike.

use super::Job;
use super::look::Look;
use super::path::{cast_shadow, faint, heuristic, may_end, survival};
use super::workspace::{Arrival, Workspace};
use crate::lanes::{F32x16, Lanes, MAX_LANES};
use crate::sampling::{self, PathRow};
use crate::scene::Rgb;
use crate::shade::Bsdf;
use crate::vec3::Vec3;
use crate::world::MaterialId;
use std::f32::consts::FRAC_1_PI;

/// What a row of paths brings along.
struct Gathered {
    /// On the side that is looked at.
    normal: [[f32; MAX_LANES]; 3],
    inside: [bool; MAX_LANES],
    /// Of the surfaces.
    albedo: [Rgb; MAX_LANES],
    sample: PathRow,
}

/// Samples a light for each of at most sixteen rows, and sends their paths on or ends them.
pub(super) fn shade<B: Bsdf>(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    (rows, bsdf): (&[u32], &impl Fn(MaterialId) -> B),
) {
    let gathered = gather(job, work, (rows, bsdf));
    if job.has_lights() {
        look_for_light(job, work, bounce, (rows, &gathered));
    }
    go_on(job, work, bounce, (rows, &gathered));
}

/// Samples one light for each path.
#[inline(always)]
fn look_for_light(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    (rows, gathered): (&[u32], &Gathered),
) {
    let look = Look::new(job, &gathered.sample, bounce, rows.len());
    for (lane, &row) in rows.iter().enumerate() {
        let row = row as usize;
        let normal = gathered.normal(lane);
        let Some((sample, probability)) = look.sample(job, work, (lane, row), normal) else {
            continue;
        };
        let cosine = normal.dot(sample.direction);
        if cosine <= 0.0 {
            continue;
        }
        let density = FRAC_1_PI * cosine;
        let weight = match sample.pdf {
            Some(pdf) if sample.close => heuristic(Some(pdf * probability), || density),
            _ => 1.0,
        };
        let throughput = work.paths.throughput[work.place[row] as usize];
        let light = throughput * gathered.albedo[lane] * density;
        let light = light * sample.weight * (weight / probability);
        cast_shadow(job, work, row, (&sample, light), gathered.inside[lane]);
    }
}

/// Sends each path on, or ends it. The direction is sampled by the cosine, so the weight is the
/// albedo exactly.
#[inline(always)]
fn go_on(job: &Job, work: &mut Workspace, bounce: u32, (rows, gathered): (&[u32], &Gathered)) {
    // Nothing is drawn for what is certain.
    let roulette = may_end(job.settings.roulette, bounce);
    let faint = faint(job.world);
    let draw = job.sampler.scatter_row(&gathered.sample, bounce, roulette);
    let local = sampling::cosine_hemispheres(draw.direction);
    let direction = to_world(gathered.normal.map(F32x16::new), local);
    let direction = [direction.x, direction.y, direction.z].map(F32x16::to_array);
    let (cosine, roulette) = (local.z.to_array(), draw.roulette.to_array());
    for (lane, &row) in rows.iter().enumerate() {
        let row = row as usize;
        let place = work.place[row] as usize;
        let throughput = work.paths.throughput[place] * gathered.albedo[lane];
        let survival = survival(job.settings.roulette, throughput, bounce, faint);
        if roulette[lane] >= survival || throughput == Rgb::ZERO {
            work.end(row);
            continue;
        }
        work.paths.throughput[place] = throughput / survival;
        work.paths.arrival[place] =
            Arrival { pdf: Some(FRAC_1_PI * cosine[lane]), diffuse: true, unscattered: false };
        if let Some(normal) = work.paths.normal.get_mut(place) {
            *normal = gathered.normal(lane);
        }
        let direction = direction.each_ref().map(|column| column[lane]).into();
        work.go_on(job.world, row, direction, gathered.inside[lane]);
    }
}

#[inline(always)]
fn gather<B: Bsdf>(
    job: &Job,
    work: &Workspace,
    (rows, bsdf): (&[u32], &impl Fn(MaterialId) -> B),
) -> Gathered {
    let mut gathered = Gathered {
        // Lanes without a row look along an axis.
        normal: [[0.0; MAX_LANES], [0.0; MAX_LANES], [1.0; MAX_LANES]],
        inside: [false; MAX_LANES],
        albedo: [Rgb::ZERO; MAX_LANES],
        sample: work.samples(rows),
    };
    for (lane, &row) in rows.iter().enumerate() {
        let row = row as usize;
        let hit = work.hits.sphere[row];
        let outward = work.surface.normal[row];
        let inside = outward.dot(work.rays.direction.row(row).as_dvec3()) > 0.0;
        let normal = if inside { -outward } else { outward }.as_vec3();
        gathered.inside[lane] = inside;
        gathered.albedo[lane] = bsdf(job.world.material(hit)).tinted(job.world.color(hit)).albedo();
        for (column, x) in gathered.normal.iter_mut().zip(normal.to_array()) {
            column[lane] = x;
        }
    }
    gathered
}

impl Gathered {
    fn normal(&self, lane: usize) -> glam::Vec3 {
        self.normal.each_ref().map(|column| column[lane]).into()
    }
}

/// Local directions about their normals in world space, of unit length.
#[inline(always)]
fn to_world([x, y, z]: [F32x16; 3], local: Vec3<F32x16>) -> Vec3<F32x16> {
    let direction = sampling::to_world_about(Vec3::new(x, y, z), local);
    direction * (F32x16::splat(1.0) / Lanes::sqrt(direction.dot(direction)))
}
