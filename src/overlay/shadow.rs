//! The shadow on the ground, by itself: how much of its light spheres take.

use crate::image::Image;
use crate::render::{Options, render};
use crate::scene::Settings;
use crate::world::{Seen, World};

/// The ground without the spheres that are before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Ground {
    /// What is seen of it, in the light that spheres leave; the sky where it is not seen.
    pub lit: Image,
    /// The share of each pixel's light that spheres keep from it, row by row: 0 where nothing
    /// changes, 1 in the dark.
    pub shadow: Vec<f32>,
}

/// Finds out how spheres change the ground's light; `None` if there is no ground.
///
/// Two pictures tell it, of the ground alone: with the spheres there but hidden from the camera, and
/// without them. Both take the same random numbers, so that light which nothing is in the way of
/// cancels. The light of spheres that glow counts as what they keep, with its sign: more light is no
/// shadow.
///
/// `settings` say how many samples there are; only the tracer and the region of `options` count.
/// The world is the same afterwards.
pub fn ground(world: &mut World, settings: &Settings, options: &Options) -> Option<Ground> {
    world.ground?;
    let settings = Settings { until_error: None, time: None, ..settings.clone() };
    let options = Options { tracer: options.tracer, region: options.region, ..Options::default() };
    let seen = world.seen.replace(Seen::default());
    let lit = render(world, &settings, &options).image;
    world.seen = seen;
    let bare = render(&world.without_spheres(), &settings, &options).image;
    let shadow = kept(&lit, &bare);
    Some(Ground { lit, shadow })
}

/// What is missing in one picture beside another, as a share.
fn kept(lit: &Image, bare: &Image) -> Vec<f32> {
    let light = |pixel: &[f32; 3]| pixel.iter().sum::<f32>();
    let share = |(lit, bare): (&[f32; 3], &[f32; 3])| {
        let (lit, bare) = (light(lit), light(bare));
        if bare > 0.0 { (1.0 - lit / bare).clamp(0.0, 1.0) } else { 0.0 }
    };
    lit.pixels.iter().zip(&bare.pixels).map(share).collect()
}
