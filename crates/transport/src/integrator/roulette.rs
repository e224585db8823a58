//! Russian roulette: paths of low throughput end at random, without bias.

use crate::lanes::Lanes;
use crate::scene::Roulette;
use crate::world::World;

/// Returns the probability with which a path survives bounce `bounce`, from 0, by the greatest channel
/// of its throughput: only paths below `threshold` may end.
///
/// Paths in a white furnace therefore never end at random: their image has no noise at all.
#[inline(always)]
pub(super) fn survival_probability<L: Lanes>(
    roulette: Roulette,
    throughput: L,
    bounce: u32,
    threshold: f32,
) -> L {
    match roulette {
        Roulette::None => L::splat(1.0),
        Roulette::Fixed(p) => L::splat(p as f32),
        Roulette::Throughput if !roulette_active(roulette, bounce) => L::splat(1.0),
        Roulette::Throughput => {
            (throughput / L::splat(threshold)).max(L::splat(0.05)).min(L::splat(1.0))
        }
    }
}

/// Returns whether roulette may end paths at bounce `bounce`.
pub(super) fn roulette_active(roulette: Roulette, bounce: u32) -> bool {
    match roulette {
        Roulette::None => false,
        Roulette::Fixed(_) => true,
        Roulette::Throughput => bounce >= 3,
    }
}

/// Returns the throughput below which paths may end.
///
/// Under a sky nearly every path finds light, and its variance is low: there a quarter is best, by 1.1
/// to 2.5 in variance times time against roulette by throughput itself, over fields, volumes, mirrors
/// and glass, a sun and the last scene of "Ray Tracing in One Weekend". With emitters alone it is a
/// half, by 1.02 to 1.1, over fields with 1 to 1000 emitters and smallpt's box. No roulette at all
/// takes up to 2.8 times the time.
pub(super) fn roulette_threshold(world: &World) -> f32 {
    let sky = world.environment.illuminates && !world.environment.is_black();
    if sky { 0.25 } else { 0.5 }
}
