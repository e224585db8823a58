//! Bilinear densities over the unit square.

use crate::lanes::Lanes;

/// A bilinear function over the unit square, or a row of them, by its values at the corners, 0 or
/// more.
#[derive(Clone, Copy, Debug)]
pub struct Bilinear<L>(
    /// Values by y, then by x.
    pub [[L; 2]; 2],
);

impl<L: Lanes> Bilinear<L> {
    /// Returns the mean over the unit square.
    #[inline(always)]
    pub fn mean(&self) -> L {
        let [[a, b], [c, d]] = self.0;
        ((a + b) + (c + d)) * L::splat(0.25)
    }

    /// Returns the value at a position.
    #[inline(always)]
    pub fn at(&self, [x, y]: [L; 2]) -> L {
        let [low, high] = self.0;
        lerp([lerp(low, x), lerp(high, x)], y)
    }

    /// Samples a position with a density in proportion to the function, from two numbers in [0, 1).
    /// NaN if the function is 0 everywhere.
    ///
    /// Each coordinate increases with its number: y by its marginal density, then x given y.
    #[inline(always)]
    pub fn sample(&self, [u, v]: [L; 2]) -> [L; 2] {
        let [[a, b], [c, d]] = self.0;
        let y = sample_linear([a + b, c + d], v);
        let x = sample_linear([lerp([a, c], y), lerp([b, d], y)], u);
        [x, y]
    }

    /// Returns the density of [`Bilinear::sample`] at a position; NaN if the function is 0 everywhere.
    #[inline(always)]
    pub fn pdf(&self, position: [L; 2]) -> L {
        self.at(position) / self.mean()
    }
}

/// Interpolates linearly between two numbers of 0 or more: no more than rounding off in proportion,
/// even if one is far greater.
#[inline(always)]
fn lerp<L: Lanes>([a, b]: [L; 2], t: L) -> L {
    t.mul_add(b, (L::splat(1.0) - t) * a)
}

/// Samples a number in [0, 1] with a density linear between the values `a` at 0 and `b` at 1.
#[inline(always)]
fn sample_linear<L: Lanes>([a, b]: [L; 2], u: L) -> L {
    let scale = L::splat(1.0) / (a + b);
    let (a, b) = (a * scale, b * scale);
    // The root of the quadratic whose terms are all positive.
    let divisor = a + lerp([a * a, b * b], u).sqrt();
    let zero = L::splat(0.0);
    L::select(divisor.le(zero), zero, u / divisor).min(L::splat(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::F32x16;
    use crate::sampling::ONE_BELOW;
    use crate::sampling::statistics::{assert_chi_squared, random_pairs};

    const CORNERS: [[[f32; 2]; 2]; 7] = [
        [[1.0, 1.0], [1.0, 1.0]],
        [[0.0, 1.0], [2.0, 5.0]],
        [[3.0, 0.0], [0.0, 3.0]],
        [[0.0, 0.0], [0.0, 1.0]],
        [[1e30, 0.0], [1e-30, 0.0]],
        [[1e-25, 2e-25], [0.0, 0.0]],
        [[7.0, 7.0], [0.0, 0.0]],
    ];

    /// Returns the integral over a cell of a grid of `n` x `n` cells, in proportion to all.
    fn probability(corners: [[f32; 2]; 2], n: usize, (column, row): (usize, usize)) -> f64 {
        let [x, y] = [column, row].map(|i| (i as f64 + 0.5) / n as f64);
        let [low, high] = corners.map(|[a, b]| f64::from(a) * (1.0 - x) + f64::from(b) * x);
        let mean: f64 = corners.iter().flatten().map(|&value| f64::from(value)).sum::<f64>() / 4.0;
        (low * (1.0 - y) + high * y) / mean / (n * n) as f64
    }

    #[test]
    fn positions_follow_the_density() {
        const CELLS: usize = 16;
        for (seed, corners) in CORNERS.into_iter().enumerate() {
            let bilinear = Bilinear(corners);
            let mut observed = vec![0_u64; CELLS * CELLS];
            for u in random_pairs(400_000, seed as u64) {
                let [x, y] = bilinear.sample(u).map(|x| (x * CELLS as f32) as usize);
                observed[y.min(CELLS - 1) * CELLS + x.min(CELLS - 1)] += 1;
            }
            let cells = (0..CELLS * CELLS).map(|cell| (cell % CELLS, cell / CELLS));
            let expected: Vec<f64> = cells.map(|cell| probability(corners, CELLS, cell)).collect();
            assert_chi_squared(&observed, &expected);
        }
    }

    #[test]
    fn the_density_is_the_function_over_its_mean() {
        let bilinear = Bilinear([[0.0_f32, 1.0], [2.0, 5.0]]);
        assert_eq!(bilinear.mean(), 2.0);
        assert_eq!(bilinear.pdf([0.5, 0.5]), 1.0);
        assert_eq!(bilinear.pdf([1.0, 1.0]), 2.5);
        assert_eq!(bilinear.at([0.25, 0.5]), 1.5);
    }

    #[test]
    fn extreme_numbers_stay_in_the_square() {
        let extremes = [0.0, f32::EPSILON / 4.0, 0.5, ONE_BELOW];
        for corners in CORNERS {
            for [u, v] in extremes.map(|u| extremes.map(|v| [u, v])).into_iter().flatten() {
                let position = Bilinear(corners).sample([u, v]);
                assert!(position.iter().all(|x| (0.0..=1.0).contains(x)), "{corners:?} {u} {v}");
            }
        }
        assert!(Bilinear([[0.0_f32; 2]; 2]).pdf([0.5; 2]).is_nan());
    }

    #[test]
    fn rows_equal_their_lanes() {
        let numbers: Vec<[f32; 2]> = random_pairs(16, 9).collect();
        let column = |i: usize| F32x16::new(std::array::from_fn(|lane| numbers[lane][i]));
        for corners in CORNERS {
            let row = Bilinear(corners.map(|row| row.map(F32x16::splat)));
            let [x, y] = row.sample([column(0), column(1)]);
            let pdf = row.pdf([x, y]).to_array();
            for (lane, &u) in numbers.iter().enumerate() {
                let position = Bilinear(corners).sample(u);
                assert_eq!(position, [x.to_array()[lane], y.to_array()[lane]]);
                assert_eq!(Bilinear(corners).pdf(position), pdf[lane]);
            }
        }
    }
}
