//! Sums over the squares around the pixels of a tile: first along rows, then across those that are kept.

use crate::rows::{Row, Rows, STRIDE};

/// Sums over squares of `EDGE` pixels, which is odd, of rows that are asked for from top to bottom.
#[derive(Debug)]
pub(crate) struct BoxSums<const COLUMNS: usize, const EDGE: usize> {
    /// Values of a row.
    values: Box<Row<COLUMNS>>,
    /// Sums along the last rows.
    along: Rows<COLUMNS, EDGE>,
    /// The row after them.
    next: usize,
}

impl<const COLUMNS: usize, const EDGE: usize> BoxSums<COLUMNS, EDGE> {
    /// Distance from the middle of a square to its edge.
    const RADIUS: usize = EDGE / 2;

    /// Forgets all rows, for another tile.
    pub(crate) fn begin(&mut self) {
        self.next = 0;
    }

    /// Computes the sums around the pixels of row `y`, which is not before that of the last call. `values` writes the rows
    /// that are needed and not known. Sums are 0 nearer than the radius to the left and the right.
    pub(crate) fn add(
        &mut self,
        y: usize,
        mut values: impl FnMut(usize, &mut Row<COLUMNS>),
        sums: &mut Row<COLUMNS>,
    ) {
        let (first, end) = (y - Self::RADIUS, y + Self::RADIUS + 1);
        for row in self.next.max(first)..end {
            values(row, &mut self.values);
            for (along, values) in self.along.row_mut(row).iter_mut().zip(&*self.values) {
                add_along::<EDGE>(values, along);
            }
        }
        self.next = end;
        let rows: [_; EDGE] = std::array::from_fn(|row| self.along.row(first + row));
        for (column, sums) in sums.iter_mut().enumerate() {
            for (x, sum) in sums.iter_mut().enumerate() {
                let mut all = rows[0][column][x];
                for row in &rows[1..] {
                    all += row[column][x];
                }
                *sum = all;
            }
        }
    }
}

impl<const COLUMNS: usize, const EDGE: usize> Default for BoxSums<COLUMNS, EDGE> {
    fn default() -> Self {
        Self { values: Box::new([[0.0; STRIDE]; COLUMNS]), along: Rows::default(), next: 0 }
    }
}

/// Computes the sums of `EDGE` values around each. At the ends, where there are fewer, they are 0.
fn add_along<const EDGE: usize>(values: &[f32; STRIDE], sums: &mut [f32; STRIDE]) {
    let (left, rest) = sums.split_at_mut(EDGE / 2);
    let (inner, right) = rest.split_at_mut(STRIDE - (EDGE - 1));
    left.fill(0.0);
    right.fill(0.0);
    for (x, sum) in inner.iter_mut().enumerate() {
        let mut all = values[x];
        for value in &values[x + 1..x + EDGE] {
            all += value;
        }
        *sum = all;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_sums_are_those_of_squares() {
        assert_sums_are_those_of_squares::<1>();
        assert_sums_are_those_of_squares::<3>();
        assert_sums_are_those_of_squares::<7>();
    }

    fn assert_sums_are_those_of_squares<const EDGE: usize>() {
        const RADIUS: usize = 3;
        let radius = EDGE / 2;
        let value = |column: usize, x: usize, y: usize| {
            let i = y * STRIDE + x + 5 * column;
            (i * i % 17) as f32
        };
        let mut boxes = BoxSums::<2, EDGE>::default();
        let mut sums = [[0.0; STRIDE]; 2];
        // Two rows in the middle are left out.
        for y in [RADIUS, RADIUS + 1, RADIUS + 2, RADIUS + 5, RADIUS + 6] {
            let mut write = |y: usize, row: &mut Row<2>| {
                for (column, values) in row.iter_mut().enumerate() {
                    for (x, out) in values.iter_mut().enumerate() {
                        *out = value(column, x, y);
                    }
                }
            };
            boxes.add(y, &mut write, &mut sums);
            for (column, x) in (0..2).flat_map(|column| (0..STRIDE).map(move |x| (column, x))) {
                let window = (y - radius..=y + radius)
                    .flat_map(|v| (x.saturating_sub(radius)..=x + radius).map(move |u| (u, v)));
                let inside = (radius..STRIDE - radius).contains(&x);
                let expected =
                    if inside { window.map(|(u, v)| value(column, u, v)).sum() } else { 0.0_f32 };
                assert_eq!(sums[column][x], expected, "{EDGE} {column} {x} {y}");
            }
        }
    }
}
