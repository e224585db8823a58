//! Sending paths through glass, sixteen at a time.

use super::Job;
use super::onward::Segments;
use super::pick::{padded, pick, pick_normals, pick_row};
use super::surface::chord;
use super::workspace::Workspace;
use crate::lanes::{Doubles, F32x16, F64x8, MAX_LANES, Mask, load_doubles, store_rounded, widen};
use crate::ray::MISS;
use crate::scene::Rgb;
use crate::shade::dielectric::{self, Meeting};
use crate::vec3::Vec3;
use crate::world::{Kind, World};

/// Doubles that are worked on together.
const HALF: usize = MAX_LANES / 2;

/// What a row of paths brings to the glass that it has hit.
struct Gathered {
    place: [u32; MAX_LANES],
    hit: [u32; MAX_LANES],
    point: Vec3<F32x16>,
    direction: Vec3<F32x16>,
    normal: [[f64; MAX_LANES]; 3],
    radius: [f32; MAX_LANES],
    /// Indices of refraction, of the spheres and of what is around them, as [`Meeting`] has them.
    index: [[f32; MAX_LANES]; 2],
    choice: [f32; MAX_LANES],
}

/// What glass does to a row of paths.
struct Sent {
    direction: [[f32; MAX_LANES]; 3],
    /// Distance to where paths leave the spheres that they go inside of; infinite for others.
    t: [f64; MAX_LANES],
    /// Lanes that go inside.
    inward: u32,
}

/// Sends every path that has hit glass through it or back.
pub(super) fn pass(job: &Job, work: &mut Workspace, bounce: u32) {
    let rows = std::mem::take(&mut work.bins.kind[Kind::Dielectric as usize]);
    let tinted = is_tinted(job.world);
    for rows in rows.chunks(MAX_LANES) {
        let choice = job.sampler.lobe_row(&work.samples(rows), bounce);
        let mut gathered = gather(job.world, work, rows, choice);
        let nested = work.paths.keeps_inside();
        if nested {
            (0..rows.len()).for_each(|lane| surround(job.world, work, &mut gathered, lane));
        }
        let sent = send(&gathered);
        if nested {
            let inward = (0..rows.len()).filter(|lane| sent.inward >> lane & 1 == 1);
            inward.for_each(|lane| enter(job.world, work, &gathered, lane));
        }
        arrive(job.world, work, tinted, (rows.len(), &gathered));
        go_on(work, rows.len(), &gathered, &sent);
    }
    work.bins.kind[Kind::Dielectric as usize] = rows;
}

/// Whether any glass takes away from what passes.
fn is_tinted(world: &World) -> bool {
    world.features.colors || world.materials.dielectric.iter().any(|glass| glass.color != Rgb::ONE)
}

#[inline(always)]
fn gather(world: &World, work: &Workspace, rows: &[u32], choice: F32x16) -> Gathered {
    let padded = padded(rows);
    let hit = pick(&work.hits.sphere, &padded);
    let mut radius = [0.0; MAX_LANES];
    for (radius, &hit) in radius.iter_mut().zip(&hit) {
        *radius = world.spheres.radius(hit as usize);
    }
    Gathered {
        place: pick(&work.place, &padded),
        hit,
        point: pick_row(&work.surface.point, &padded),
        direction: pick_row(&work.rays.direction, &padded),
        normal: pick_normals(&work.surface.normal, &padded),
        radius,
        index: [indices(world, &hit), [1.0; MAX_LANES]],
        choice: choice.to_array(),
    }
}

/// Indices of refraction of glass spheres.
#[inline(always)]
fn indices(world: &World, rows: &[u32; MAX_LANES]) -> [f32; MAX_LANES] {
    if let [only] = world.materials.dielectric.as_slice() {
        return [only.ior; MAX_LANES];
    }
    let mut indices = [1.0; MAX_LANES];
    for (index, &row) in indices.iter_mut().zip(rows) {
        *index = dielectric::index(world, row);
    }
    indices
}

/// Takes the sphere that a path has hit from what it is in, and finds what glass is around.
fn surround(world: &World, work: &mut Workspace, gathered: &mut Gathered, lane: usize) {
    let inside = work.paths.inside(gathered.place[lane] as usize);
    gathered.index[1][lane] = dielectric::around(world, gathered.hit[lane], inside);
}

/// Adds the sphere that a path has hit to what it is in.
fn enter(world: &World, work: &mut Workspace, gathered: &Gathered, lane: usize) {
    let inside = work.paths.inside(gathered.place[lane] as usize);
    let fits = dielectric::insert(world, inside, gathered.hit[lane]);
    work.counters.nesting_overflows += u64::from(!fits);
}

#[inline(always)]
fn send(gathered: &Gathered) -> Sent {
    let mut sent = Sent { direction: [[0.0; MAX_LANES]; 3], t: [0.0; MAX_LANES], inward: 0 };
    for first in [0, HALF] {
        send_half(gathered, first, &mut sent);
    }
    sent
}

#[inline(always)]
fn send_half(gathered: &Gathered, first: usize, sent: &mut Sent) {
    let lanes = first..first + HALF;
    let singles = |column: &[f32; MAX_LANES]| load_doubles(&column[first..]);
    let doubles =
        |column: &[f64; MAX_LANES]| F64x8::new(*column[first..].first_chunk().expect("half a row"));
    let [x, y, z] = gathered.normal.each_ref().map(doubles);
    let normal = Vec3::new(x, y, z);
    let passage = dielectric::pass(&Meeting {
        direction: gathered.direction.map(|x| widen(x)[first / HALF]),
        normal,
        here: singles(&gathered.index[0]),
        around: singles(&gathered.index[1]),
        choice: singles(&gathered.choice),
    });
    let Vec3 { x, y, z } = passage.direction;
    for (column, x) in sent.direction.iter_mut().zip([x, y, z]) {
        store_rounded(x, &mut column[first..]);
    }
    let [x, y, z] = sent.direction.each_ref().map(singles);
    let t = chord(normal, singles(&gathered.radius), Vec3::new(x, y, z));
    let t = Doubles::select(passage.inward, t, F64x8::splat(f64::INFINITY));
    sent.t[lanes].copy_from_slice(&t.to_array());
    sent.inward |= passage.inward.bits() << first;
}

/// Notes how paths have come through surfaces that are there.
#[inline(always)]
fn arrive(
    world: &World,
    work: &mut Workspace,
    tinted: bool,
    (count, gathered): (usize, &Gathered),
) {
    for lane in 0..count {
        if gathered.index[1][lane] == 0.0 {
            continue;
        }
        let place = gathered.place[lane] as usize;
        let arrival = &mut work.paths.arrival[place];
        (arrival.pdf, arrival.diffuse) = (None, false);
        if tinted {
            let hit = gathered.hit[lane];
            let glass = &world.materials.dielectric[world.material(hit).row()];
            work.paths.throughput[place] *= glass.color * world.color(hit);
        }
    }
}

#[inline(always)]
fn go_on(work: &mut Workspace, count: usize, gathered: &Gathered, sent: &Sent) {
    let mut end = gathered.hit;
    for (lane, end) in end.iter_mut().enumerate() {
        *end = if sent.inward >> lane & 1 == 1 { *end } else { MISS };
    }
    work.onward.append(
        count,
        &Segments {
            origin: [gathered.point.x, gathered.point.y, gathered.point.z],
            direction: sent.direction.map(F32x16::new),
            own: gathered.hit,
            end: (sent.t, end),
            normal: gathered.normal,
            place: gathered.place,
        },
    );
}
