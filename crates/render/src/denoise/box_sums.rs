//! Sums over the squares around each pixel of a tile: first along rows, then across those that are kept.

/// Rows that sums are made from.
#[derive(Debug, Default)]
pub(super) struct BoxSums {
    /// Values of a row.
    values: Vec<f32>,
    /// Sums along the last rows, as many as a square has.
    kept: Vec<f32>,
}

impl BoxSums {
    /// Computes the sums over squares of `2 radius + 1` pixels, of rows of `stride` pixels. They are 0 nearer than `radius`
    /// to a side.
    pub(super) fn add(
        &mut self,
        values: &[f32],
        stride: usize,
        radius: usize,
        sums: &mut Vec<f32>,
    ) {
        sums.resize(values.len(), 0.0);
        let copy =
            |row: usize, out: &mut [f32]| out.copy_from_slice(&values[row * stride..][..stride]);
        self.add_rows(copy, stride, radius, sums, |_| ());
    }

    /// Does the same with rows that `values` writes, and calls `finish` with each row of sums.
    pub(super) fn add_rows(
        &mut self,
        mut values: impl FnMut(usize, &mut [f32]),
        stride: usize,
        radius: usize,
        sums: &mut [f32],
        mut finish: impl FnMut(&mut [f32]),
    ) {
        let window = 2 * radius + 1;
        self.values.resize(stride, 0.0);
        self.kept.resize(window * stride, 0.0);
        let rows = sums.len() / stride;
        for row in 0..rows {
            values(row, &mut self.values);
            let along = &mut self.kept[row % window * stride..][..stride];
            add_shifted(&self.values, radius, along);
            let Some(first) = row.checked_sub(2 * radius) else { continue };
            let out = &mut sums[(first + radius) * stride..][..stride];
            for (count, of) in (first..=row).enumerate() {
                let along = &self.kept[of % window * stride..][..stride];
                if count == 0 {
                    out.copy_from_slice(along);
                } else {
                    out.iter_mut().zip(along).for_each(|(sum, value)| *sum += value);
                }
            }
            finish(out);
        }
        let side = radius.min(rows) * stride;
        sums[..side].fill(0.0);
        let end = sums.len() - side;
        sums[end..].fill(0.0);
    }
}

/// Computes the sums of `2 radius + 1` values around each. At the ends, where there are fewer, they are 0.
fn add_shifted(values: &[f32], radius: usize, sums: &mut [f32]) {
    sums.fill(0.0);
    let Some(count) = values.len().checked_sub(2 * radius) else { return };
    let inner = &mut sums[radius..][..count];
    inner.copy_from_slice(&values[..count]);
    for shift in 1..=2 * radius {
        inner.iter_mut().zip(&values[shift..]).for_each(|(sum, value)| *sum += value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn box_sums_are_those_of_squares() {
        let (stride, rows) = (90, 24);
        let values: Vec<f32> = (0..stride * rows).map(|i| (i * i % 17) as f32).collect();
        let (mut sums, mut boxes) = (Vec::new(), BoxSums::default());
        for radius in [0, 1, 3] {
            boxes.add(&values, stride, radius, &mut sums);
            for (y, x) in (0..rows).flat_map(|y| (0..stride).map(move |x| (y, x))) {
                let inside =
                    (radius..rows - radius).contains(&y) && (radius..stride - radius).contains(&x);
                let window = (y.saturating_sub(radius)..=y + radius).flat_map(|v| {
                    values[v * stride..].iter().take(x + radius + 1).skip(x.saturating_sub(radius))
                });
                let expected = if inside { window.sum::<f32>() } else { 0.0 };
                assert_eq!(sums[y * stride + x], expected, "{radius} {x} {y}");
            }
        }
    }
}
