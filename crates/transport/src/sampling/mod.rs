//! Random numbers and sampling: directions, lights, positions in a pixel.
//!
//! A [`Sampler`] gives every path its numbers: each is a pure function of (seed, pixel, sample index,
//! dimension), so that a picture does not depend on threads, tiles or the order of work. The maps from
//! numbers to directions ([`cosine_hemisphere`], [`Cone`], ...), choices ([`Distribution`],
//! [`Distribution2d`]) and positions ([`Bilinear`], [`PixelFilter`]) never reject a sample and keep neighbors
//! together, so that well-distributed numbers stay well distributed.
//!
//! # Dimensions
//!
//! Dimensions come in sets of four. The first are the best ones of a Sobol sequence; they are used for
//! the greatest sources of variance, the first direction and the position in the pixel.
//!
//! | set     | numbers 0, 1                          | numbers 2, 3                      |
//! |---------|---------------------------------------|-----------------------------------|
//! | 0       | direction of bounce 0                 | position in the pixel             |
//! | 1       | position on the lens                  | lobe, roulette of bounce 0        |
//! | 1 + 2 k | direction of bounce k                 | lobe, roulette of bounce k        |
//! | 2 + 2 k | point on a light, sampled at bounce k | choice of the light, in two parts |
//!
//! The third row is for k of 1 or more, the last one for all. Caustics have numbers of their own in the
//! place of those for lights, and lights in view in that of the position in the pixel. Events that are sampled several times on
//! one path, such as stratified shadow rays, use [`Sampler::split`] instead.

mod angles;
mod basis;
mod bilinear;
mod cone;
mod distribution;
mod distribution2d;
mod filter;
mod hash;
mod heuristic;
mod plan;
mod rows;
mod sampler;
mod sobol;
#[cfg(test)]
pub(crate) mod statistics;
mod stratified;
mod warp;

pub use angles::{sine_cosine, turns};
pub use basis::{Bases, Basis};
pub use bilinear::Bilinear;
pub use cone::Cone;
pub use distribution::{Choice, Distribution};
pub use distribution2d::{CellRow, Distribution2d};
pub use filter::PixelFilter;
pub use hash::{ONE_BELOW, mix, stream, unit, unit_pair};
pub use heuristic::power_heuristic;
pub use plan::{LightDraw, ScatterDraw};
pub use rows::{SampleRow, SamplerRow, SamplerStates, ScatterRow, SobolPositions, StartRow};
pub use sampler::{Sampler, SamplerState, Split};
pub use warp::{
    UNIFORM_SPHERE_PDF, cap, concentric_disk, cosine_hemisphere, cosine_hemisphere_pdf,
    cosine_hemispheres, next_in_square, uniform_sphere,
};
