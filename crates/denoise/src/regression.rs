//! Weighted linear regression in square windows: a row of lanes is a row of pixels.

use crate::columns::Columns;
use crate::observations::{FEATURES, ID, IRRADIANCE, Observed, WEIGHT};
use spherule_transport::lanes::Lanes;

/// Number of regressors: a constant, the normal and the coverage.
const REGRESSORS: usize = 1 + FEATURES;

/// Radii of the windows of pixels.
pub(crate) const RADII: [usize; 2] = [1, 2];

/// Edge of the squares of pixels of which the widest window consists, and its radius in squares.
pub(crate) const SQUARE: usize = 3;
pub(crate) const SQUARES_RADIUS: usize = 3;

/// Distance from a pixel to the middle of the outermost squares.
pub(crate) const REACH: usize = SQUARE * SQUARES_RADIUS;

/// Number of windows: those of pixels, and the one of squares.
pub(crate) const WINDOWS: usize = RADII.len() + 1;

/// Weight of a neighbor of another sphere.
const OTHER_SPHERE: f32 = 0.5;

/// Variance of a regressor in the window, below which its slope is taken as 0.
const RIDGE: f32 = 1e-3;

/// The prediction of a window for the pixel in its middle.
#[derive(Clone, Copy)]
pub(crate) struct Prediction<L> {
    /// Irradiance, by channel.
    pub(crate) irradiance: [L; 3],
    /// Derivative of the prediction by the pixel's own irradiance, which is the weight of its own noise.
    pub(crate) leverage: L,
}

/// Number of observations in the largest window.
const LARGEST: usize = pixels(SQUARES_RADIUS);

/// Offsets of a window's pixels, from the middle outward.
pub(crate) static OFFSETS: [[isize; 2]; LARGEST] = {
    let mut offsets = [[0; 2]; LARGEST];
    let (mut count, mut radius) = (0, 0);
    while count < LARGEST {
        let mut at = 0;
        while at < (2 * radius + 1) * (2 * radius + 1) {
            let (x, y): (isize, isize) =
                (at % (2 * radius + 1) - radius, at / (2 * radius + 1) - radius);
            if x.abs() == radius || y.abs() == radius {
                offsets[count] = [x, y];
                count += 1;
            }
            at += 1;
        }
        radius += 1;
    }
    offsets
};

/// Fits the windows of pixels around those of row `y` from `x` on, one in each lane.
#[inline(always)]
pub(crate) fn predict<L: Lanes>(
    columns: &Columns,
    y: usize,
    x: usize,
) -> [Prediction<L>; RADII.len()] {
    const RADIUS: usize = RADII[RADII.len() - 1];
    let pixels: [_; 2 * RADIUS + 1] =
        std::array::from_fn(|row| columns.pixels.row(y + row - RADIUS));
    let similarities = columns.similarities.around(y);
    let observed = |[dx, dy]: [isize; 2]| {
        Observed::at(pixels[RADIUS.wrapping_add_signed(dy)], x.wrapping_add_signed(dx))
    };
    let similarity = |index, offset| similarities.load(index, x, offset);
    fit(observed([0, 0]), observed, similarity, RADII)
}

/// Fits the window of squares, which must be known, around the pixels of row `y` from `x` on, one in each lane.
#[inline(always)]
pub(crate) fn predict_by_squares<L: Lanes>(columns: &Columns, y: usize, x: usize) -> Prediction<L> {
    const RADIUS: usize = SQUARES_RADIUS;
    let squares: [_; 2 * RADIUS + 1] =
        std::array::from_fn(|row| columns.squares.row(y + row * SQUARE - REACH));
    let observed = |[dx, dy]: [isize; 2]| {
        let x = x.wrapping_add_signed(dx * SQUARE as isize);
        Observed::at(squares[RADIUS.wrapping_add_signed(dy)], x)
    };
    let (middle, one) = (Observed::at(columns.pixels.row(y), x), L::splat(1.0));
    let [Prediction { irradiance, leverage }] = fit(middle, observed, |_, _| one, [RADIUS]);
    let own: L = middle.column(WEIGHT);
    let all = L::splat((SQUARE * SQUARE) as f32) * observed([0, 0]).column(WEIGHT);
    let share = own / Lanes::max(all, L::splat(f32::MIN_POSITIVE));
    Prediction { irradiance, leverage: leverage * share }
}

/// Fits windows of ascending radii around some pixels, one in each lane. `observed` returns the observations at an offset,
/// and `similarity` the similarity of a neighbor, by its index in [`OFFSETS`] and its offset. Leverages are the
/// derivatives by the observation in the middle.
///
/// The first pass over a window adds up its normal equations, which give the coefficient of each neighbor's irradiance;
/// the second applies them. So the sums of a pass stay in registers.
#[inline(always)]
fn fit<'a, const WINDOWS: usize, L: Lanes>(
    middle: Observed,
    observed: impl Fn([isize; 2]) -> Observed<'a>,
    similarity: impl Fn(usize, [isize; 2]) -> L,
    radii: [usize; WINDOWS],
) -> [Prediction<L>; WINDOWS] {
    let zero = L::splat(0.0);
    let id = middle.column(ID);
    let middle = middle.columns(0);
    let mut products = [[zero; REGRESSORS]; REGRESSORS];
    let mut weights = [zero; LARGEST];
    let mut solutions = [[zero; REGRESSORS]; WINDOWS];
    let mut first = 0;
    for (radius, solution) in radii.iter().zip(&mut solutions) {
        let end = pixels(*radius);
        let neighbors = weights[first..end].iter_mut().zip(&OFFSETS[first..end]);
        for (index, (weight, &offset)) in (first..).zip(neighbors) {
            let neighbor = observed(offset);
            let differences = differences(neighbor, &middle);
            let same = neighbor.column::<L>(ID).has_bits_of(id);
            let own = neighbor.column(WEIGHT);
            *weight = closeness(&differences, same) * similarity(index, offset) * own;
            add_products(&mut products, &differences, *weight);
        }
        *solution = solve(&products);
        first = end;
    }
    let mut sums = [[zero; 3]; WINDOWS];
    let fitted = Fitted { middle, solutions };
    // The last `end` is that of all.
    let (inner, outer) = weights[..first].split_at(pixels(radii[0]));
    let (near, far) = OFFSETS[..first].split_at(inner.len());
    for (&weight, &offset) in inner.iter().zip(near) {
        fitted.apply::<0>(observed(offset), weight, &mut sums);
    }
    for (&weight, &offset) in outer.iter().zip(far) {
        fitted.apply::<1>(observed(offset), weight, &mut sums);
    }
    let mut predictions = [Prediction { irradiance: [zero; 3], leverage: zero }; WINDOWS];
    for ((prediction, irradiance), solution) in
        predictions.iter_mut().zip(sums).zip(&fitted.solutions)
    {
        *prediction = Prediction { irradiance, leverage: solution[0] * weights[0] };
    }
    predictions
}

/// Regressions of windows around the same pixels.
struct Fitted<const WINDOWS: usize, L> {
    middle: [L; FEATURES],
    solutions: [[L; REGRESSORS]; WINDOWS],
}

impl<const WINDOWS: usize, L: Lanes> Fitted<WINDOWS, L> {
    /// Adds the irradiance of a neighbor to the predictions of the windows from the `FIRST` on, times the neighbor's
    /// coefficients.
    #[inline(always)]
    fn apply<const FIRST: usize>(
        &self,
        neighbor: Observed,
        weight: L,
        sums: &mut [[L; 3]; WINDOWS],
    ) {
        let differences = differences(neighbor, &self.middle);
        let light: [L; 3] = neighbor.columns(IRRADIANCE);
        for (sums, solution) in sums.iter_mut().zip(&self.solutions).skip(FIRST) {
            let [constant, slopes @ ..] = solution;
            let mut coefficient = *constant;
            for (slope, difference) in slopes.iter().zip(&differences) {
                coefficient = slope.mul_add(*difference, coefficient);
            }
            coefficient = coefficient * weight;
            for (sum, light) in sums.iter_mut().zip(&light) {
                *sum = coefficient.mul_add(*light, *sum);
            }
        }
    }
}

/// Returns the number of pixels of a window.
pub(crate) const fn pixels(radius: usize) -> usize {
    (2 * radius + 1).pow(2)
}

/// Returns the differences of a neighbor's features from those of the middle.
#[inline(always)]
fn differences<L: Lanes>(neighbor: Observed, middle: &[L; FEATURES]) -> [L; FEATURES] {
    let mut differences: [L; FEATURES] = neighbor.columns(0);
    for (difference, &middle) in differences.iter_mut().zip(middle) {
        *difference = *difference - middle;
    }
    differences
}

/// Returns the factor of a neighbor's weight that falls with the distance of its features; `same` selects neighbors of the same
/// sphere.
#[inline(always)]
fn closeness<L: Lanes>(differences: &[L; FEATURES], same: L::Mask) -> L {
    let one = L::splat(1.0);
    let mut closeness = one;
    for &difference in differences {
        closeness = (-difference).mul_add(difference, closeness);
    }
    let closeness = Lanes::max(closeness, L::splat(0.0));
    closeness * closeness * L::select(same, one, L::splat(OTHER_SPHERE))
}

/// Adds a neighbor to the upper triangle of the normal equations.
#[inline(always)]
fn add_products<L: Lanes>(
    products: &mut [[L; REGRESSORS]; REGRESSORS],
    differences: &[L; FEATURES],
    weight: L,
) {
    products[0][0] = products[0][0] + weight;
    for row in 1..REGRESSORS {
        let weighted = weight * differences[row - 1];
        products[0][row] = products[0][row] + weighted;
        for column in row..REGRESSORS {
            let sum = &mut products[row][column];
            *sum = weighted.mul_add(differences[column - 1], *sum);
        }
    }
}

/// Returns the first row of the inverse of the normal equations: the prediction where all differences are 0 has these
/// coefficients.
///
/// By a decomposition into triangles and a diagonal (Golub and Van Loan, "Matrix Computations", 4.1).
#[inline(always)]
fn solve<L: Lanes>(products: &[[L; REGRESSORS]; REGRESSORS]) -> [L; REGRESSORS] {
    let (zero, one, least) = (L::splat(0.0), L::splat(1.0), L::splat(f32::MIN_POSITIVE));
    let ridge = products[0][0] * L::splat(RIDGE);
    let mut lower = [[zero; REGRESSORS]; REGRESSORS];
    let (mut diagonal, mut inverse) = ([zero; REGRESSORS], [one; REGRESSORS]);
    for row in 0..REGRESSORS {
        let mut pivot = products[row][row];
        if row > 0 {
            pivot = pivot + ridge;
        }
        for k in 0..row {
            pivot = (-lower[row][k] * lower[row][k]).mul_add(diagonal[k], pivot);
        }
        diagonal[row] = Lanes::max(pivot, least);
        inverse[row] = one / diagonal[row];
        for below in row + 1..REGRESSORS {
            let mut sum = products[row][below];
            for k in 0..row {
                sum = (-lower[below][k] * lower[row][k]).mul_add(diagonal[k], sum);
            }
            lower[below][row] = sum * inverse[row];
        }
    }
    let mut solution = [zero; REGRESSORS];
    solution[0] = one;
    for row in 1..REGRESSORS {
        for k in 0..row {
            solution[row] = (-lower[row][k]).mul_add(solution[k], solution[row]);
        }
    }
    for row in (0..REGRESSORS).rev() {
        solution[row] = solution[row] * inverse[row];
        for k in row + 1..REGRESSORS {
            solution[row] = (-lower[k][row]).mul_add(solution[k], solution[row]);
        }
    }
    solution
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offsets_go_from_the_middle_outward() {
        for (radius, count) in [(0, 1), (1, 9), (2, 25), (3, 49)] {
            let near = |offset: &&[isize; 2]| offset.iter().all(|x| x.abs() <= radius);
            assert_eq!(OFFSETS[..count].iter().filter(near).count(), count);
        }
        let mut all = OFFSETS;
        all.sort_unstable();
        assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
    }

    #[test]
    fn solutions_are_the_first_row_of_the_inverse() {
        // Sums over some neighbors whose regressors are independent.
        let mut products = [[0.0_f32; REGRESSORS]; REGRESSORS];
        let random = |i: u32| (i.wrapping_mul(2_654_435_761) >> 8) as f32 / 4096.0 % 1.0 - 0.5;
        for i in 0..40 {
            let differences = std::array::from_fn(|k| random(7 * i + k as u32));
            add_products(&mut products, &differences, 1.0 + random(i));
        }
        let solution = solve(&products);
        let ridge = products[0][0] * RIDGE;
        for row in 0..REGRESSORS {
            let sum: f32 = (0..REGRESSORS)
                .map(|k| {
                    let product = products[row.min(k)][row.max(k)];
                    let product = if row == k && k > 0 { product + ridge } else { product };
                    product * solution[k]
                })
                .sum();
            assert!((sum - f32::from(u8::from(row == 0))).abs() < 1e-4, "{row} {sum}");
        }
    }
}
