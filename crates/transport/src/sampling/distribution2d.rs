//! Choice of a cell of a grid by weight: a row by its sum, then a cell of the row.

use super::distribution::Distribution;
use super::hash::ONE_BELOW;
use crate::lanes::{Lanes, MAX_LANES, set_bits};

/// Half of the distance between two draws.
const HALF_STEP: f32 = f32::EPSILON / 4.0;

/// A discrete distribution over the cells of a grid.
///
/// Built in f64 and stored in f32. The probability is positive wherever the weight is (in grids of at
/// most 2^23 cells per side), so that dividing by it is safe wherever there is light.
#[derive(Clone, Debug)]
pub struct Distribution2d {
    rows: Distribution,
    /// One for every row; uniform for black rows, which are never chosen.
    columns: Vec<Distribution>,
}

/// A row of cells that pairs of draws have chosen.
#[derive(Clone, Copy, Debug)]
pub struct CellRow<L> {
    /// Columns of the cells.
    pub column: [u32; MAX_LANES],
    /// Rows of the cells.
    pub row: [u32; MAX_LANES],
    /// Probabilities of the cells, more than 0.
    pub pmf: L,
    /// Positions of the draws within the cells' intervals, in (0, 1): numbers to choose positions by.
    pub remainder: [L; 2],
}

impl Distribution2d {
    /// Creates probabilities proportional to `weight(column, row)` over `width` x `height` cells;
    /// `weight` is called row by row. A weight that is not finite and more than 0 counts as 0; `None`
    /// if this is so for all.
    pub fn new(
        width: usize,
        height: usize,
        mut weight: impl FnMut(usize, usize) -> f64,
    ) -> Option<Self> {
        let mut sums = Vec::with_capacity(height);
        let mut columns = Vec::with_capacity(height);
        let mut cells = vec![0.0; width];
        for row in 0..height {
            for (column, cell) in cells.iter_mut().enumerate() {
                let value = weight(column, row);
                *cell = if value.is_finite() { value.max(0.0) } else { 0.0 };
            }
            sums.push(cells.iter().sum());
            columns.push(Distribution::new(&cells).or_else(|| Distribution::uniform(width))?);
        }
        Some(Self { rows: Distribution::new(&sums)?, columns })
    }

    /// Cumulative probabilities of the rows, and of the cells in each.
    pub(crate) fn cumulative(&self) -> (&[f32], impl Iterator<Item = &[f32]>) {
        (self.rows.cumulative(), self.columns.iter().map(Distribution::cumulative))
    }

    /// Chooses a cell in each of `lanes` by two draws in [0, 1); in the other lanes, the first.
    ///
    /// `u[0]` decides the column and `u[1]` the row; both increase with their draw.
    #[inline(always)]
    pub fn choose<L: Lanes>(&self, u: [L; 2], lanes: u32) -> CellRow<L> {
        let mut draws = [[0.0; MAX_LANES]; 2];
        u.iter().zip(&mut draws).for_each(|(u, draws)| u.store(draws));
        let (mut column, mut row) = ([0; MAX_LANES], [0; MAX_LANES]);
        let (mut start, mut pmf) = ([[0.0; MAX_LANES]; 2], [[1.0; MAX_LANES]; 2]);
        for lane in set_bits(lanes) {
            let y = self.rows.find(draws[1][lane]);
            let columns = &self.columns[y];
            let x = columns.find(draws[0][lane]);
            (start[1][lane], pmf[1][lane]) = self.rows.interval(y);
            (start[0][lane], pmf[0][lane]) = columns.interval(x);
            (column[lane], row[lane]) = (x as u32, y as u32);
        }
        let [x, y] = [L::load(&start[0]), L::load(&start[1])];
        let [across, along] = [L::load(&pmf[0]), L::load(&pmf[1])];
        // In the middle between two draws: the shares of improbable cells have few of them.
        let remainder = |u: L, start: L, pmf: L| {
            ((u - start + L::splat(HALF_STEP)) / pmf).min(L::splat(ONE_BELOW))
        };
        CellRow {
            column,
            row,
            pmf: across * along,
            remainder: [remainder(u[0], x, across), remainder(u[1], y, along)],
        }
    }

    /// Returns the probability of a cell.
    #[inline]
    pub fn pmf(&self, column: usize, row: usize) -> f32 {
        self.columns[row].pmf(column) * self.rows.pmf(row)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::F32x16;
    use crate::sampling::statistics::{assert_chi_squared, random_pairs};

    const WIDTH: usize = 13;
    const HEIGHT: usize = 9;

    /// A grid with a heavy cell, cells of no weight and a row of no weight.
    fn weight(column: usize, row: usize) -> f64 {
        match (column, row) {
            (_, 4) | (0..4, _) => 0.0,
            (7, 2) => 100.0,
            _ => 1.0 + column as f64 * 0.3 + row as f64,
        }
    }

    fn distribution() -> Distribution2d {
        Distribution2d::new(WIDTH, HEIGHT, weight).expect("not all is black")
    }

    fn probability(column: usize, row: usize) -> f64 {
        let cells = (0..HEIGHT).flat_map(|row| (0..WIDTH).map(move |column| (column, row)));
        weight(column, row) / cells.map(|(column, row)| weight(column, row)).sum::<f64>()
    }

    #[test]
    fn cells_follow_the_weights() {
        let distribution = distribution();
        let mut observed = vec![0_u64; WIDTH * HEIGHT];
        // The parts of a cell that the remainders fall in.
        let mut parts = [0_u64; 16];
        for u in random_pairs(1_000_000, 12) {
            let CellRow { column: [column, ..], row: [row, ..], pmf, remainder: [x, y] } =
                distribution.choose(u, 1);
            assert!(0.0 < x && x < 1.0 && 0.0 < y && y < 1.0);
            let (column, row) = (column as usize, row as usize);
            assert_eq!(pmf, distribution.pmf(column, row));
            observed[row * WIDTH + column] += 1;
            parts[(x * 4.0) as usize * 4 + (y * 4.0) as usize] += 1;
        }
        let probabilities: Vec<f64> =
            (0..WIDTH * HEIGHT).map(|cell| probability(cell % WIDTH, cell / WIDTH)).collect();
        assert_chi_squared(&observed, &probabilities);
        assert_chi_squared(&parts, &[1.0 / 16.0; 16]);
    }

    #[test]
    fn probabilities_are_proportional_and_sum_to_one() {
        let distribution = distribution();
        let mut sum = 0.0;
        for row in 0..HEIGHT {
            for column in 0..WIDTH {
                let pmf = f64::from(distribution.pmf(column, row));
                assert!((pmf - probability(column, row)).abs() < 2e-6, "{column} {row}");
                sum += pmf;
            }
        }
        assert!((sum - 1.0).abs() < 1e-6);
    }

    #[test]
    fn black_and_empty_grids() {
        assert!(Distribution2d::new(4, 4, |_, _| 0.0).is_none());
        assert!(Distribution2d::new(4, 4, |_, _| f64::NAN).is_none());
        assert!(Distribution2d::new(0, 4, |_, _| 1.0).is_none());
        assert!(Distribution2d::new(4, 0, |_, _| 1.0).is_none());
    }

    #[test]
    fn a_single_cell_passes_the_draws_on() {
        let distribution = Distribution2d::new(1, 1, |_, _| 3.0).expect("not black");
        let CellRow { pmf, remainder, .. } = distribution.choose([0.25, 0.125], 1);
        assert_eq!((pmf, remainder), (1.0, [0.25 + HALF_STEP, 0.125 + HALF_STEP]));
    }

    #[test]
    fn the_remainders_of_improbable_cells_are_centered() {
        let distribution = Distribution2d::new(2, 1, |column, _| [1e-30, 1.0][column]);
        let cell = distribution.expect("not black").choose([0.0, 0.0], 1);
        assert_eq!((cell.column[0], cell.pmf), (0, f32::EPSILON / 2.0));
        assert_eq!(cell.remainder[0], 0.5);
    }

    #[test]
    fn rows_equal_their_lanes() {
        let numbers: Vec<[f32; 2]> = random_pairs(16, 9).collect();
        let draws = [0, 1].map(|i| F32x16::new(std::array::from_fn(|lane| numbers[lane][i])));
        let row = distribution().choose(draws, 0xa5ff);
        for lane in set_bits(0xa5ff_u32) {
            let one = distribution().choose(numbers[lane], 1);
            assert_eq!((row.column[lane], row.row[lane]), (one.column[0], one.row[0]));
            assert_eq!(row.pmf.to_array()[lane], one.pmf);
            assert_eq!(row.remainder.map(|rest| rest.to_array()[lane]), one.remainder);
        }
    }
}
