//! Weights of samples that more than one technique finds: multiple importance sampling.

use crate::lanes::Lanes;

/// Returns the power heuristic: weights of samples with density `found`, more than 0, that another
/// technique finds with density `other`.
#[inline(always)]
pub fn power_heuristic<L: Lanes>(found: L, other: L) -> L {
    // The ratio's square may overflow, to the right limit.
    let ratio = other / found;
    L::splat(1.0) / ratio.mul_add(ratio, L::splat(1.0))
}
