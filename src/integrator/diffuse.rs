//! Scattering by diffuse surfaces, sixteen paths at a time: they are all alike.

use super::Job;
use super::path::{faint, may_end, survival};
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
    sample: PathRow,
}

/// Sends the paths of at most sixteen rows on, or ends them. The direction is sampled by the cosine, so
/// the weight is the albedo exactly.
pub(super) fn go_on<B: Bsdf>(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    (rows, bsdf): (&[u32], &impl Fn(MaterialId) -> B),
) {
    let gathered = gather(work, rows);
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
        let hit = work.hits.sphere[row];
        let albedo = bsdf(job.world.material(hit)).tinted(job.world.color(hit)).albedo();
        let throughput = work.paths.throughput[place] * albedo;
        let survival = survival(job.settings.roulette, throughput, bounce, faint);
        if roulette[lane] >= survival || throughput == Rgb::ZERO {
            work.end(row);
            continue;
        }
        work.paths.throughput[place] = throughput / survival;
        work.paths.arrival[place] =
            Arrival { pdf: Some(FRAC_1_PI * cosine[lane]), diffuse: true, unscattered: false };
        let vector = |columns: &[[f32; MAX_LANES]; 3]| glam::Vec3::from(columns.map(|x| x[lane]));
        if let Some(normal) = work.paths.normal.get_mut(place) {
            *normal = vector(&gathered.normal);
        }
        work.go_on(job.world, row, vector(&direction), gathered.inside[lane]);
    }
}

#[inline(always)]
fn gather(work: &Workspace, rows: &[u32]) -> Gathered {
    let first = work.place[rows[0] as usize] as usize;
    let mut gathered = Gathered {
        // Lanes without a row look along an axis.
        normal: [[0.0; MAX_LANES], [0.0; MAX_LANES], [1.0; MAX_LANES]],
        inside: [false; MAX_LANES],
        sample: [work.paths.sample[first]; MAX_LANES],
    };
    for (lane, &row) in rows.iter().enumerate() {
        let row = row as usize;
        let outward = work.surface.normal[row];
        let inside = outward.dot(work.rays.direction.row(row).as_dvec3()) > 0.0;
        let normal = if inside { -outward } else { outward }.as_vec3();
        gathered.inside[lane] = inside;
        gathered.sample[lane] = work.paths.sample[work.place[row] as usize];
        for (column, x) in gathered.normal.iter_mut().zip(normal.to_array()) {
            column[lane] = x;
        }
    }
    gathered
}

/// Local directions about their normals in world space, of unit length.
#[inline(always)]
fn to_world([x, y, z]: [F32x16; 3], local: Vec3<F32x16>) -> Vec3<F32x16> {
    let direction = sampling::to_world_about(Vec3::new(x, y, z), local);
    direction * (F32x16::splat(1.0) / Lanes::sqrt(direction.dot(direction)))
}
