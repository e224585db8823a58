//! Estimates the error of an image, and where more samples reduce it most.
//!
//! # Probes
//!
//! The error of a pixel's mean cannot be estimated from its own samples: these are not independent, and
//! their spread, like the difference of two halves of their sequence, overestimates it several times.
//! But pixels have independent random numbers, so the squared error of an image is the sum of the
//! variances of its pixels' means, and such a sum can be estimated from some of them. [`Probes`] are
//! pixels drawn at random, one per block of neighbors, and rendered twice in addition to the image,
//! each time with as many samples as the image's own: half of the squared difference of two such
//! means is an unbiased estimate of the variance of one, including the gain of the sequence.
//!
//! # Absence of bias
//!
//! The number of samples of a pixel is decided by probes, their rays, and a pilot of all pixels, whose
//! random numbers are independent of the image's. So, given all counts, each pixel is the mean of the
//! first points of its own scrambled sequence, every one of them uniform: its expectation is that of
//! one sample. The image's samples do not influence their number. (With a time limit, the clock does,
//! and samples take time.)
//!
//! Likewise the estimate of the image's squared error is unbiased after any number of rounds: of two
//! sets of probes one steers, and only the other judges. What remains is that the render stops when
//! that estimate is low; the bound that is compared with the target allows for it.
//!
//! # The bound
//!
//! The judging probes' terms are independent and not negative, so the lower tail of their sum is
//! Gaussian or lighter, however heavy the upper one is: the sum lies more than `x` times the root of
//! the sum of their second moments below its expectation with a probability of at most exp(-x^2/2)
//! (Maurer, "A Bound on the Deviation Probability for Sums of Non-Negative Random Variables", JIPAM
//! 2003). Second moments are estimated by the squares of the terms, and third moments are added to the
//! bound, so that it holds for several decisions and for errors that few pixels dominate.
//!
//! # Light found by chance
//!
//! Probes may not find noise of events that are too rare for their samples, such as small lights that
//! paths hit only by chance. That noise is predicted by the rays that narrowly miss a light
//! ([`NearMisses`]); what is predicted beyond that of the hits is added to the estimate.
//!
//! Underestimated are still rare noise of other kinds, such as that of bright spots on diffuse
//! surfaces close to a small light, and noise with an infinite fourth moment (roulette that makes paths
//! ever brighter).
//!
//! [`NearMisses`]: crate::integrator::near_misses::NearMisses
//! [`Probes`]: crate::film::Probes

mod estimate;
mod gain;
mod plan;
mod stop_condition;

pub(crate) use estimate::sum;
pub use estimate::{
    CONFIDENCE, Estimate, Noise, SquaredError, mean_radiance, missing, squared_error,
    squared_error_of,
};
pub use gain::Gain;
pub use plan::{Slope, next_round, steering_variance, work};
pub(crate) use stop_condition::FIRST_SAMPLES;
pub use stop_condition::StopCondition;
