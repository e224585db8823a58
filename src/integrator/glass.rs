//! Sending paths through glass, sixteen at a time.

use super::Job;
use super::arrival::Arrival;
use super::bins::Bin;
use super::carried::CarriedRow;
use super::onward::Segments;
use super::surface::chord;
use super::workspace::Workspace;
use crate::lanes::{
    Doubles, F32x16, F64x8, Lanes, MAX_LANES, Mask, Packing, load_doubles, set_bits, store_rounded,
    widen,
};
use crate::ray::MISS;
use crate::scene::Rgb;
use crate::shade::dielectric::{self, Meeting};
use crate::vec3::Vec3;
use crate::world::{Kind, World};

/// Doubles that are worked on together.
const HALF: usize = MAX_LANES / 2;

/// What a row of paths brings to the glass that it has hit.
struct Gathered {
    carried: CarriedRow,
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
    let Some(bin) = work.bins.take(Kind::Dielectric) else { return };
    let (tinted, nested) = (is_tinted(job.world), work.paths.keeps_inside());
    for (first, lanes) in bin.rows() {
        let carried = bin.carried_row(first);
        let choice = job.sampler.lobe_row(&work.paths.numbers(&carried), bounce);
        let mut gathered = gather(job.world, work, (&bin, first), (carried, choice));
        if nested {
            set_bits(lanes).for_each(|lane| surround(job.world, work, &mut gathered, lane));
        }
        let sent = send(&gathered);
        if nested {
            set_bits(lanes & sent.inward).for_each(|lane| enter(job.world, work, &gathered, lane));
        }
        let carried = arrive(job.world, tinted, &gathered);
        go_on(work, lanes, (&gathered, &carried), &sent);
    }
    work.bins.put(Kind::Dielectric, bin);
}

/// Whether any glass takes away from what passes.
fn is_tinted(world: &World) -> bool {
    world.features.colors || world.materials.dielectric.iter().any(|glass| glass.color != Rgb::ONE)
}

#[inline(always)]
fn gather(
    world: &World,
    work: &Workspace,
    (bin, first): (&Bin, usize),
    (carried, choice): (CarriedRow, F32x16),
) -> Gathered {
    let hit = bin.hit_row(first).to_array();
    let mut radius = [0.0; MAX_LANES];
    for (radius, &hit) in radius.iter_mut().zip(&hit) {
        *radius = world.spheres.radius(hit as usize);
    }
    Gathered {
        carried,
        hit,
        point: bin.point_row(first),
        direction: bin.direction_row(first),
        normal: work.surface.normal.pick(&bin.ray_row(first).to_array()),
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
    let inside = work.paths.inside(gathered.carried.place.to_array()[lane] as usize);
    gathered.index[1][lane] = dielectric::around(world, gathered.hit[lane], inside);
}

/// Adds the sphere that a path has hit to what it is in.
fn enter(world: &World, work: &mut Workspace, gathered: &Gathered, lane: usize) {
    let inside = work.paths.inside(gathered.carried.place.to_array()[lane] as usize);
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

/// What paths take along from surfaces that are there; from others, what they brought.
#[inline(always)]
fn arrive(world: &World, tinted: bool, gathered: &Gathered) -> CarriedRow {
    let real = Lanes::lt(F32x16::splat(0.0), F32x16::new(gathered.index[1]));
    let carried = gathered.carried;
    let arrival = carried.arrival.onward(F32x16::splat(0.0), false);
    let arrival = Arrival(Lanes::select(real, arrival.0, carried.arrival.0));
    let throughput = if tinted { tint(world, real.bits(), gathered) } else { carried.throughput };
    CarriedRow { throughput, arrival, ..carried }
}

/// What is left of the throughput of the paths in `lanes` after glass has taken its share.
fn tint(world: &World, lanes: u32, gathered: &Gathered) -> Vec3<F32x16> {
    let mut color = [[1.0; MAX_LANES]; 3];
    for lane in set_bits(lanes) {
        let hit = gathered.hit[lane];
        let glass = &world.materials.dielectric[world.material(hit).row()];
        let Rgb { x, y, z } = glass.color * world.color(hit);
        (color[0][lane], color[1][lane], color[2][lane]) = (x, y, z);
    }
    let [x, y, z] = color;
    let color = Vec3::new(F32x16::new(x), F32x16::new(y), F32x16::new(z));
    gathered.carried.throughput.times(color)
}

#[inline(always)]
fn go_on(
    work: &mut Workspace,
    lanes: u32,
    (gathered, carried): (&Gathered, &CarriedRow),
    sent: &Sent,
) {
    let [x, y, z] = sent.direction;
    let direction = Vec3::new(F32x16::new(x), F32x16::new(y), F32x16::new(z));
    let segments = Segments { origin: gathered.point, direction, own: &gathered.hit, carried };
    let onward = &mut work.onward;
    let first = onward.append(&Packing::new(lanes), &segments);
    let ends = onward.hits.sphere[first..].iter_mut().zip(gathered.hit);
    for (lane, (end, hit)) in ends.enumerate() {
        *end = if sent.inward >> lane & 1 == 1 { hit } else { MISS };
    }
    onward.hits.t[first..first + MAX_LANES].copy_from_slice(&sent.t);
    onward.entry.copy(first, &gathered.normal);
}
