//! Scattering of paths at glass, sixteen at a time.

use super::Job;
use super::columns::LaneRows;
use super::interior;
use super::material_queues::MaterialQueue;
use super::mirrored_light::{MirrorRow, sample_mirrored_light};
use super::next_rays::RayRow;
use super::path_state::PathStateRow;
use super::path_state::PreviousBounce;
use super::surface::chord_length;
use super::workspace::{Paths, Workspace};
use crate::lanes::{
    Doubles, F32x16, F64x8, Lanes, MAX_LANES, Mask, Packing, load_doubles, narrow, set_bits,
    store_rounded, widen,
};
use crate::ray::MISS;
use crate::scene::Rgb;
use crate::shade::MaterialKind;
use crate::shade::dielectric::{self, Interface};
use crate::shade::fresnel;
use crate::vec3::Vec3;
use crate::world::World;
use glam::DVec3;

/// Doubles that are computed at once.
const HALF: usize = MAX_LANES / 2;

/// A row of hits on glass, with the states of the paths.
struct GlassHits {
    state: PathStateRow,
    hit: [u32; MAX_LANES],
    point: Vec3<F32x16>,
    direction: Vec3<F32x16>,
    normal: [[f64; MAX_LANES]; 3],
    radius: [f32; MAX_LANES],
    /// Indices of refraction inside the spheres and outside of them, as in [`Interface`].
    index: [[f32; MAX_LANES]; 2],
    choice: [f32; MAX_LANES],
}

/// Rays that glass reflects or refracts.
struct GlassRays {
    direction: [[f32; MAX_LANES]; 3],
    /// Distance to where a ray leaves the sphere that it enters; infinite for others.
    t: [f64; MAX_LANES],
    /// Lanes whose rays go on inside the sphere.
    inward: u32,
}

/// Reflects or refracts every path that has hit glass, by chance.
pub(super) fn scatter(job: &Job, work: &mut Workspace, bounce: u32) {
    let choice = |paths: &Paths, state: &PathStateRow| {
        job.sampler.lobe_row(&paths.sampler_row(state), bounce)
    };
    scatter_by(job, work, bounce, choice);
}

/// Reflects every path that has hit glass where the reflectance is more than its `choice`, and refracts it elsewhere.
#[inline(always)]
pub(super) fn scatter_by(
    job: &Job,
    work: &mut Workspace,
    bounce: u32,
    choice: impl Fn(&Paths, &PathStateRow) -> F32x16,
) {
    let Some(queue) = work.queues.take(MaterialKind::Dielectric) else { return };
    let (tinted, nested) = (is_tinted(job.world), work.paths.tracks_interiors());
    for rows in queue.rows() {
        let LaneRows { first, lanes } = rows;
        let state = queue.state_row(first);
        let choice = choice(&work.paths, &state);
        let mut hits = gather_hits(job.world, work, &queue, first, state, choice);
        if nested {
            set_bits(lanes).for_each(|lane| find_outside_ior(job.world, work, &mut hits, lane));
        }
        let mut simple = 0;
        if job.samples_mirrored_light() {
            simple = simple_lanes(job, &hits, lanes);
            add_mirrored_light(job, work, &queue, rows, &hits);
            if bounce + 2 <= job.depth() {
                let rows = LaneRows { first, lanes: simple };
                add_internally_mirrored_light(job, work, &queue, rows, &hits);
            }
        }
        let rays = reflect_or_refract(&hits);
        if nested {
            set_bits(lanes & rays.inward)
                .for_each(|lane| enter_sphere(job.world, work, &hits, lane));
        }
        let mut state = update_states(job.world, tinted, &hits);
        if job.samples_mirrored_light() {
            let before = hits.state.previous.mirrored_light_sampled().bits();
            let mirrored = outside(&hits) & !rays.inward;
            let inside = simple & (rays.inward | before);
            state.previous = state.previous.with_mirrored_light(F32x16::lanes(mirrored | inside));
        }
        spawn_rays(work, lanes, &hits, &state, &rays);
    }
    work.queues.put(MaterialKind::Dielectric, queue);
}

/// Returns the lanes whose rays hit a real interface from outside.
#[inline(always)]
fn outside(hits: &GlassHits) -> u32 {
    let real = Lanes::lt(F32x16::splat(0.0), F32x16::new(hits.index[1]));
    let [x, y, z] = hits.normal;
    let entering = |lane: usize| {
        let normal = DVec3::new(x[lane], y[lane], z[lane]);
        let direction: glam::Vec3 = hits.direction.map(|row| row.to_array()[lane]).into();
        normal.dot(direction.as_dvec3()) < 0.0
    };
    (0..MAX_LANES).filter(|&lane| entering(lane)).fold(0, |lanes, lane| lanes | 1 << lane)
        & real.bits()
}

/// Returns the lanes whose rays are inside glass that stands alone.
fn simple_lanes(job: &Job, hits: &GlassHits, lanes: u32) -> u32 {
    let inside = set_bits(lanes & !outside(hits));
    inside
        .filter(|&lane| job.world.caustic_casters.has(hits.hit[lane]))
        .fold(0, |lanes, lane| lanes | 1 << lane)
}

/// Adds the light of suns and emitters that glass mirrors on the outside.
fn add_mirrored_light(
    job: &Job,
    work: &mut Workspace,
    queue: &MaterialQueue,
    rows: LaneRows,
    hits: &GlassHits,
) {
    let LaneRows { first, lanes } = rows;
    let [x, y, z] = hits.normal.map(|column| F32x16::new(column.map(|x| x as f32)));
    let normal = Vec3::new(x, y, z);
    let cosine = -hits.direction.dot(normal);
    let direction = (hits.direction + normal * (cosine + cosine)).normalize();
    let row = MirrorRow {
        rays: queue.ray_row(first),
        own: &hits.hit,
        path: hits.state.path,
        previous: hits.state.previous,
        point: hits.point,
        direction,
    };
    let factor = || {
        let cosine = cosine.to_array();
        let reflectance = F32x16::new(std::array::from_fn(|lane| {
            let eta = f64::from(hits.index[1][lane]) / f64::from(hits.index[0][lane]);
            fresnel::dielectric(f64::from(cosine[lane]).clamp(0.0, 1.0), eta).0 as f32
        }));
        tint(job.world, lanes, hits) * reflectance
    };
    sample_mirrored_light(job, work, &row, lanes & outside(hits), factor);
}

/// Rays inside a sphere that is hit, mirrored there, and refracted where they leave the sphere next.
struct InnerMirror {
    point: [Vec3<F64x8>; 2],
    direction: [Vec3<F64x8>; 2],
    /// Fraction of light that both interfaces keep.
    kept: [F64x8; 2],
}

/// Adds the light of suns and emitters that glass mirrors once on the inside, and lets out at the next
/// interface. The incidence is the same at both.
fn add_internally_mirrored_light(
    job: &Job,
    work: &mut Workspace,
    queue: &MaterialQueue,
    rows: LaneRows,
    hits: &GlassHits,
) {
    let LaneRows { first, lanes } = rows;
    if lanes == 0 {
        return;
    }
    let InnerMirror { point, direction, kept } = mirror_inside(hits);
    let row = MirrorRow {
        rays: queue.ray_row(first),
        own: &hits.hit,
        path: hits.state.path,
        // Caustic samples do not find this light.
        previous: PreviousBounce::camera(),
        point: Vec3::narrow(point),
        direction: Vec3::narrow(direction).normalize(),
    };
    let factor = || {
        let color = colors(job.world, lanes, hits);
        tint(job.world, lanes, hits).times(color) * narrow(kept)
    };
    sample_mirrored_light(job, work, &row, lanes, factor);
}

#[inline(always)]
fn mirror_inside(hits: &GlassHits) -> InnerMirror {
    let halves = [0, HALF].map(|first| {
        let doubles = |column: &[f64; MAX_LANES]| F64x8::from(&column[first..first + HALF]);
        let singles = |column: &[f32; MAX_LANES]| load_doubles(&column[first..]);
        let [x, y, z] = hits.normal.each_ref().map(doubles);
        let normal = Vec3::new(x, y, z);
        let part = |row: Vec3<F32x16>| row.map(|x| widen(x)[first / HALF]);
        let direction = part(hits.direction);
        let direction = direction * direction.inverse_length();
        let two = F64x8::splat(2.0);
        let cosine = direction.dot_unfused(normal);
        let mirrored = direction - normal * (two * cosine);
        let across = mirrored * (two * cosine);
        let eta = singles(&hits.index[0]) / singles(&hits.index[1]);
        let (reflected, refracted) = fresnel::dielectric(cosine, eta);
        let leaving = mirrored * eta + (normal + across) * (refracted - eta * cosine);
        let kept = reflected * (F64x8::splat(1.0) - reflected);
        (part(hits.point) + across * singles(&hits.radius), leaving, kept)
    });
    let [(p, d, k), (q, e, l)] = halves;
    InnerMirror { point: [p, q], direction: [d, e], kept: [k, l] }
}

/// Returns whether any glass absorbs light.
fn is_tinted(world: &World) -> bool {
    world.features.colors || world.materials.dielectric.iter().any(|glass| glass.color != Rgb::ONE)
}

#[inline(always)]
fn gather_hits(
    world: &World,
    work: &Workspace,
    queue: &MaterialQueue,
    first: usize,
    state: PathStateRow,
    choice: F32x16,
) -> GlassHits {
    let hit = queue.hit_row(first).to_array();
    let mut radius = [0.0; MAX_LANES];
    for (radius, &hit) in radius.iter_mut().zip(&hit) {
        *radius = world.spheres.radius(hit as usize);
    }
    GlassHits {
        state,
        hit,
        point: queue.point_row(first),
        direction: queue.direction_row(first),
        normal: work.surface.normal.pick(&queue.ray_row(first).to_array()),
        radius,
        index: [indices(world, &hit), [1.0; MAX_LANES]],
        choice: choice.to_array(),
    }
}

/// Returns the indices of refraction of glass spheres.
#[inline(always)]
fn indices(world: &World, rows: &[u32; MAX_LANES]) -> [f32; MAX_LANES] {
    if let [only] = world.materials.dielectric.as_slice() {
        return [only.ior; MAX_LANES];
    }
    let mut indices = [1.0; MAX_LANES];
    for (index, &row) in indices.iter_mut().zip(rows) {
        *index = interior::ior(world, row);
    }
    indices
}

/// Removes the sphere that a path has hit from its interior list, and finds the index of refraction
/// outside.
fn find_outside_ior(world: &World, work: &mut Workspace, hits: &mut GlassHits, lane: usize) {
    let inside = work.paths.interior_list(hits.state.path.to_array()[lane] as usize);
    hits.index[1][lane] = interior::outside_ior(world, hits.hit[lane], inside);
}

/// Adds the sphere that a path has hit to its interior list.
fn enter_sphere(world: &World, work: &mut Workspace, hits: &GlassHits, lane: usize) {
    let inside = work.paths.interior_list(hits.state.path.to_array()[lane] as usize);
    let fits = interior::insert(world, inside, hits.hit[lane]);
    work.counters.nesting_overflows += u64::from(!fits);
}

#[inline(always)]
fn reflect_or_refract(hits: &GlassHits) -> GlassRays {
    let mut rays = GlassRays { direction: [[0.0; MAX_LANES]; 3], t: [0.0; MAX_LANES], inward: 0 };
    for first in [0, HALF] {
        reflect_or_refract_half(hits, first, &mut rays);
    }
    rays
}

#[inline(always)]
fn reflect_or_refract_half(hits: &GlassHits, first: usize, rays: &mut GlassRays) {
    let lanes = first..first + HALF;
    let singles = |column: &[f32; MAX_LANES]| load_doubles(&column[first..]);
    let doubles =
        |column: &[f64; MAX_LANES]| F64x8::new(*column[first..].first_chunk().expect("half a row"));
    let [x, y, z] = hits.normal.each_ref().map(doubles);
    let normal = Vec3::new(x, y, z);
    let passage = dielectric::scatter(&Interface {
        direction: hits.direction.map(|x| widen(x)[first / HALF]),
        normal,
        ior_inside: singles(&hits.index[0]),
        ior_outside: singles(&hits.index[1]),
        choice: singles(&hits.choice),
    });
    let Vec3 { x, y, z } = passage.direction;
    for (column, x) in rays.direction.iter_mut().zip([x, y, z]) {
        store_rounded(x, &mut column[first..]);
    }
    let [x, y, z] = rays.direction.each_ref().map(singles);
    let t = chord_length(normal, singles(&hits.radius), Vec3::new(x, y, z));
    let t = Doubles::select(passage.inward, t, F64x8::splat(f64::INFINITY));
    rays.t[lanes].copy_from_slice(&t.to_array());
    rays.inward |= passage.inward.bits() << first;
}

/// Returns the next states. Surfaces inside of other glass, which are no interfaces, do not color the light; but they stop
/// shadow rays as all glass does, so that light behind is found by these paths alone.
#[inline(always)]
fn update_states(world: &World, tinted: bool, hits: &GlassHits) -> PathStateRow {
    let real = Lanes::lt(F32x16::splat(0.0), F32x16::new(hits.index[1]));
    let state = hits.state;
    let previous = state.previous.next(F32x16::splat(0.0), false);
    let throughput = if tinted { tint(world, real.bits(), hits) } else { state.throughput };
    PathStateRow { throughput, previous, ..state }
}

/// Multiplies the throughput of the paths in `lanes` by the color of the glass.
fn tint(world: &World, lanes: u32, hits: &GlassHits) -> Vec3<F32x16> {
    hits.state.throughput.times(colors(world, lanes, hits))
}

/// Returns the colors of the glass in `lanes`.
fn colors(world: &World, lanes: u32, hits: &GlassHits) -> Vec3<F32x16> {
    let mut color = [[1.0; MAX_LANES]; 3];
    for lane in set_bits(lanes) {
        let hit = hits.hit[lane];
        let glass = &world.materials.dielectric[world.material(hit).row()];
        let Rgb { x, y, z } = glass.color * world.color(hit);
        (color[0][lane], color[1][lane], color[2][lane]) = (x, y, z);
    }
    let [x, y, z] = color;
    Vec3::new(F32x16::new(x), F32x16::new(y), F32x16::new(z))
}

#[inline(always)]
fn spawn_rays(
    work: &mut Workspace,
    lanes: u32,
    hits: &GlassHits,
    state: &PathStateRow,
    rays: &GlassRays,
) {
    let [x, y, z] = rays.direction;
    let direction = Vec3::new(F32x16::new(x), F32x16::new(y), F32x16::new(z));
    let ray_row = RayRow { origin: hits.point, direction, own: &hits.hit, state };
    let next_rays = &mut work.next_rays;
    let first = next_rays.push(&Packing::new(lanes), &ray_row);
    let ends = next_rays.hits.sphere[first..].iter_mut().zip(hits.hit);
    for (lane, (end, hit)) in ends.enumerate() {
        *end = if rays.inward >> lane & 1 == 1 { hit } else { MISS };
    }
    next_rays.hits.t[first..first + MAX_LANES].copy_from_slice(&rays.t);
    next_rays.entry.copy(first, &hits.normal);
}
