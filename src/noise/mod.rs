//! Estimates the error of an image, and where more samples reduce it most.
//!
//! # Why probes
//!
//! The error of a pixel's mean is not told by its own samples: these are not independent, and their
//! spread, like the difference of two halves of their sequence, says several times too much. But
//! pixels have independent numbers, so the squared error of a picture is the sum of the variances
//! of its pixels' means, and such a sum can be had from a part of them. [`Probes`] are pixels drawn
//! at random, one of a block of neighbors, and rendered twice beside the picture, each time with as
//! many samples as the picture's own: half of the squared difference of two such means is an
//! estimate of the variance of one, without bias, and with all that the sequence gains.
//!
//! # Why nothing is biased
//!
//! How many samples a pixel gets is decided by probes, their rays, and a pilot of all pixels, whose
//! random numbers are independent of the picture's. So, given all counts, each pixel is the mean of
//! as many first points of its own scrambled sequence as its count says, every one of them uniform:
//! its expectation is that of one sample. No sample of the picture has a say in how many there are.
//! (With a time limit, the clock has one, and samples take time.)
//!
//! Likewise the estimate of the picture's squared error is without bias after any number of rounds:
//! of two sets of probes one steers, and only the other judges. What is left is that the render
//! stops when that estimate is low; the bound that is compared with the target allows for it.
//!
//! # The bound
//!
//! The judging probes' terms are independent and not negative, so the lower tail of their sum is
//! Gaussian or lighter, however heavy the upper one is: it lies more than `x` times the root of the
//! sum of their second moments below its expectation with a probability of at most exp(-x^2/2)
//! (Maurer, "A Bound on the Deviation Probability for Sums of Non-Negative Random Variables", JIPAM
//! 2003). Second moments are estimated by the squares of the terms, and third moments add to the
//! bound, so that it holds at several looks and for errors that a few pixels dominate. What no
//! probe has seen it cannot know: noise that is all from events too rare for the probes' samples, or
//! whose fourth moment is infinite (roulette that makes paths ever brighter), is underestimated.
//!
//! [`Probes`]: crate::film::Probes

mod estimate;
mod plan;

pub use estimate::{CONFIDENCE, Estimate, Noise, gain, mean_radiance, squared_error};
pub use plan::{Goal, Slope, next_round, steering_variance, work};
