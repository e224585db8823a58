//! Balls that cast the light of lamps: smooth mirrors, coats and glass, few of them, and few lamps.
//!
//! What a diffuse surface gets from a lamp by such a ball is what its own sampling finds least well.
//! But the way there is known in closed form ([`ball`]), so a point of the lamp can be chosen and
//! then the direction in which it is seen, as light samples choose one. After "Manifold Next Event
//! Estimation" (Hanika, Droske and Fascione, Computer Graphics Forum 2015), with all solutions at
//! hand instead of a walk to one of them. Whatever both ways of sampling find is weighted by the
//! density of each, so nothing has to be left to either alone.

mod ball;
mod choice;
mod link;
mod sample;

#[cfg(test)]
mod tests;

pub(crate) use link::Way;
pub(crate) use sample::{Found, Looking, Sent};

use super::World;
use super::environment::luminance;
use super::materials::Kind;
use crate::sampling::Cone;
use crate::scene::Rgb;
use choice::Guess;
use glam::DVec3;
use rayon::prelude::*;

/// Balls, and lamps, of which more are left to chance: each pair takes its time at every surface.
const MOST: usize = 4;

/// Sine of the angle that a lamp's radius fills from a ball, from which on chance finds the caustic as
/// well: at 0.37 variance times time is 0.91 of what it is by chance, at 0.55 it is 1.12.
const LARGEST: f64 = 0.4;

/// Spheres that are nearer than this share of their reach touch, but do not cut one another.
const TOUCH: f64 = 1e-6;

/// Every ball that casts the light of a lamp.
#[derive(Clone, Debug, Default)]
pub struct Casters {
    pairs: Vec<Pair>,
}

/// A ball that casts the light of a lamp.
#[derive(Clone, Debug)]
pub(crate) struct Pair {
    /// Rows of the spheres.
    pub(crate) ball: u32,
    pub(crate) lamp: u32,
    center: DVec3,
    radius: f64,
    /// Index of refraction outside over that inside; 0 for a mirror.
    index: f64,
    /// Whether light passes through.
    clear: bool,
    /// From the ball's center to the lamp's.
    offset: DVec3,
    lamp_radius: f64,
    /// The lamp as it is seen from the ball's center.
    cone: Cone,
    pub(crate) radiance: Rgb,
    guess: Guess,
}

impl Pair {
    /// The ways of light from the lamp by the ball.
    #[inline(always)]
    fn ways(&self) -> &'static [Way] {
        if self.clear { &Way::ALL } else { &Way::ALL[..1] }
    }
}

impl Casters {
    /// Of a world that is complete but for these.
    pub(super) fn find(world: &World) -> Self {
        let lamps = &world.lights.emitters;
        let kinds = few_kinds(world);
        let few = (1..=MOST).contains(&lamps.len()) && !kinds.is_empty();
        if !few || !world.cut.is_empty() || world.features.nested_glass {
            return Self::default();
        }
        let lamps: Vec<u32> = lamps.iter().copied().filter(|&row| is_whole(world, row)).collect();
        let rows = (0..world.spheres.len() as u32).into_par_iter();
        let mut balls: Vec<u32> = rows.filter(|&row| casts(world, kinds, row)).collect();
        balls.sort_unstable_by_key(|&row| world.spheres.id[row as usize]);
        let pairs = balls.iter().map(|&ball| pairs(world, ball, &lamps));
        Self { pairs: shared(pairs.collect()) }
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.pairs.is_empty()
    }

    /// Whether a sphere is one of them.
    pub(crate) fn has(&self, row: u32) -> bool {
        self.pairs.iter().any(|pair| pair.ball == row)
    }
}

/// The kinds of which there are few spheres, all together; without coats, which mirror least, if so
/// there are.
fn few_kinds(world: &World) -> &'static [Kind] {
    const KINDS: [Kind; 3] = [Kind::Conductor, Kind::Dielectric, Kind::Plastic];
    let count = |kinds: &&[Kind]| {
        let each = kinds.iter().map(|&kind| world.features.spheres_by_kind[kind as usize]);
        (1..=MOST as u64).contains(&each.sum())
    };
    [&KINDS[..], &KINDS[..2]].into_iter().find(count).unwrap_or_default()
}

/// Whether a sphere is of these kinds and a smooth mirror, coated, or glass of which nothing is in the
/// way inside.
fn casts(world: &World, kinds: &[Kind], row: u32) -> bool {
    let id = world.appearance.material.row(row as usize);
    let casts = match id.kind() {
        Kind::Conductor => world.materials.conductor[id.row()].roughness == 0.0,
        Kind::Dielectric => world.materials.dielectric[id.row()].ior > 1.0,
        Kind::Plastic => world.materials.plastic[id.row()].ior > 1.0,
        _ => false,
    };
    casts && kinds.contains(&id.kind()) && (id.kind() != Kind::Dielectric || is_whole(world, row))
}

/// Whether neither another sphere nor the ground cuts into a sphere.
fn is_whole(world: &World, row: u32) -> bool {
    let (center, radius) = world.spheres.exact(row as usize);
    let cuts = |other: usize| {
        let (at, reach) = world.spheres.exact(other);
        let distance = center.distance(at);
        other != row as usize
            && distance < (radius + reach) * (1.0 - TOUCH)
            && distance + radius > reach * (1.0 - TOUCH)
    };
    let grounded = world.ground.as_ref().is_some_and(|ground| {
        (ground.normal.dot(center) - ground.height).abs() < radius * (1.0 - TOUCH)
    });
    !grounded && !(0..world.spheres.len()).into_par_iter().any(cuts)
}

/// What a ball casts of the light of each small lamp.
fn pairs(world: &World, ball: u32, lamps: &[u32]) -> Vec<Pair> {
    let (center, radius) = world.spheres.exact(ball as usize);
    let material = world.material(ball);
    let index = match material.kind() {
        Kind::Dielectric => 1.0 / f64::from(world.materials.dielectric[material.row()].ior),
        Kind::Plastic => 1.0 / f64::from(world.materials.plastic[material.row()].ior),
        _ => 0.0,
    };
    let clear = material.kind() == Kind::Dielectric;
    let pair = |&lamp: &u32| {
        let (at, lamp_radius) = world.spheres.exact(lamp as usize);
        let offset = at - center;
        let small = lamp_radius < offset.length() * LARGEST;
        let apart = offset.length() > (radius + lamp_radius) * (1.0 + TOUCH);
        let cone = Cone::toward_sphere(offset.length_squared(), lamp_radius)?;
        let radiance = world.materials.emitter[world.material(lamp).row()].radiance;
        let guess = Guess::default();
        (small && apart).then_some(Pair {
            ball,
            lamp,
            center,
            radius,
            index,
            clear,
            offset,
            lamp_radius,
            cone,
            radiance,
            guess,
        })
    };
    lamps.iter().filter_map(pair).collect()
}

/// Shares what each ball is worth among its lamps, by the light that reaches it from them.
fn shared(balls: Vec<Vec<Pair>>) -> Vec<Pair> {
    let ways = |pairs: &Vec<Pair>| pairs.first().map_or(0, |pair| pair.ways().len());
    let ways: usize = balls.iter().map(ways).sum();
    let light = |pair: &Pair| f64::from(luminance(pair.radiance) / pair.cone.pdf());
    let share = |pairs: Vec<Pair>| {
        let all: f64 = pairs.iter().map(light).sum();
        pairs.into_iter().map(move |pair| {
            let share = light(&pair) / all;
            pair.guessing(share, ways)
        })
    };
    balls.into_iter().flat_map(share).collect()
}
