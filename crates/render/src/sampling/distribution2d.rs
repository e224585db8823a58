//! Sampling of positions in a picture by brightness: a row by its sum, then a position in the row.

use super::distribution::{Choice, Distribution};
use super::hash::ONE_BELOW;

/// A density over the unit square that is constant in each cell of a grid.
///
/// Built in f64 and stored in f32. The density is positive wherever the weight is (in pictures of at
/// most 2^23 pixels per side), so that dividing by it is safe wherever there is light.
#[derive(Clone, Debug)]
pub struct Distribution2d {
    rows: Distribution,
    /// One for every row; uniform for black rows, which are never chosen.
    columns: Vec<Distribution>,
}

impl Distribution2d {
    /// Creates a density proportional to `weight(column, row)` over `width` x `height` cells; `weight`
    /// is called row by row. A weight that is not finite and more than 0 counts as 0; `None` if this is
    /// so for all.
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

    /// Samples a position (x, y) in [0, 1)^2; also returns its density over the unit square, more than
    /// 0.
    ///
    /// `u[0]` decides x within a row and `u[1]` decides y; both increase with their draw.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> ([f32; 2], f32) {
        let Choice { index, pmf, remainder } = self.rows.sample(u[1]);
        let height = self.rows.count() as f32;
        let y = ((index as f32 + remainder) / height).min(ONE_BELOW);
        let (x, across) = self.columns[index].sample_position(u[0]);
        ([x, y], pmf * height * across)
    }

    /// Returns the density at (x, y) in [0, 1)^2.
    #[inline]
    pub fn pdf(&self, [x, y]: [f32; 2]) -> f32 {
        let row = self.rows.cell(y);
        self.rows.pmf(row) * self.rows.count() as f32 * self.columns[row].pdf(x)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::statistics::{assert_chi_squared, random_pairs};

    const WIDTH: usize = 13;
    const HEIGHT: usize = 9;

    /// A picture with a bright pixel, black pixels and a black row.
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
    fn positions_follow_the_picture() {
        let distribution = distribution();
        let mut observed = vec![0_u64; WIDTH * HEIGHT];
        for u in random_pairs(1_000_000, 12) {
            let ([x, y], pdf) = distribution.sample(u);
            assert!((0.0..1.0).contains(&x) && (0.0..1.0).contains(&y));
            assert_eq!(pdf, distribution.pdf([x, y]));
            observed[(y * HEIGHT as f32) as usize * WIDTH + (x * WIDTH as f32) as usize] += 1;
        }
        let probabilities: Vec<f64> =
            (0..WIDTH * HEIGHT).map(|cell| probability(cell % WIDTH, cell / WIDTH)).collect();
        assert_chi_squared(&observed, &probabilities);
    }

    #[test]
    fn density_is_the_picture_and_integrates_to_one() {
        let distribution = distribution();
        let mut integral = 0.0;
        for row in 0..HEIGHT {
            for column in 0..WIDTH {
                let x = (column as f32 + 0.5) / WIDTH as f32;
                let y = (row as f32 + 0.5) / HEIGHT as f32;
                let density = f64::from(distribution.pdf([x, y])) / (WIDTH * HEIGHT) as f64;
                assert!((density - probability(column, row)).abs() < 2e-6, "{column} {row}");
                integral += density;
            }
        }
        assert!((integral - 1.0).abs() < 1e-6);
    }

    #[test]
    fn black_and_empty_pictures() {
        assert!(Distribution2d::new(4, 4, |_, _| 0.0).is_none());
        assert!(Distribution2d::new(4, 4, |_, _| f64::NAN).is_none());
        assert!(Distribution2d::new(0, 4, |_, _| 1.0).is_none());
        assert!(Distribution2d::new(4, 0, |_, _| 1.0).is_none());
    }

    #[test]
    fn a_single_pixel_is_the_unit_square() {
        let distribution = Distribution2d::new(1, 1, |_, _| 3.0).expect("not black");
        assert_eq!(distribution.sample([0.25, 0.75]), ([0.25, 0.75], 1.0));
    }
}
