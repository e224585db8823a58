//! Random numbers, and what is made of them: directions, lights, places in a pixel.
//!
//! A [`Sampler`] gives every path its numbers: each is a pure function of (seed, pixel, sample
//! index, dimension), so that a picture does not depend on threads, tiles or the order of work. The
//! maps that turn numbers into directions ([`cosine_hemisphere`], [`Cone`], ...), choices
//! ([`Distribution`], [`Distribution2d`]) and places ([`PixelFilter`]) never reject and never tear
//! neighbors apart, so that well-distributed numbers stay well distributed.
//!
//! # Dimensions
//!
//! Dimensions come in sets of four. The first are the best ones of a Sobol sequence; they go to
//! what adds most variance, the first direction and the place in the pixel.
//!
//! | set     | numbers 0, 1                             | numbers 2, 3                      |
//! |---------|------------------------------------------|-----------------------------------|
//! | 0       | direction of scattering 0                | place in the pixel                |
//! | 1       | place on the lens                        | lobe, roulette of scattering 0    |
//! | 1 + 2 k | direction of scattering k                | lobe, roulette of scattering k    |
//! | 2 + 2 k | place on a light, seen from scattering k | which light, and its finer digits |
//!
//! The third row is for k of 1 or more, the last one for all. Events that are sampled several times
//! on one path, such as stratified shadow rays, draw from [`Sampler::split`] instead.

mod cone;
mod distribution;
mod distribution2d;
mod filter;
mod frame;
mod hash;
mod plan;
mod rows;
mod sampler;
mod sobol;
#[cfg(test)]
pub(crate) mod statistics;
mod stratified;
mod warp;

pub use cone::Cone;
pub use distribution::{Choice, Distribution};
pub use distribution2d::Distribution2d;
pub use filter::PixelFilter;
pub use frame::{Frame, Frames};
pub use hash::{ONE_BELOW, mix, stream, unit, unit_pair};
pub use plan::{LightDraw, ScatterDraw};
pub use rows::{Places, SamplerRow, SamplerStates, ScatterRow, StartRow};
pub use sampler::{Sampler, SamplerState, Split};
pub use warp::{
    UNIFORM_SPHERE_PDF, cap, concentric_disk, cosine_hemisphere, cosine_hemisphere_pdf,
    cosine_hemispheres, uniform_sphere,
};
