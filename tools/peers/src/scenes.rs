//! The spheres of both systems.

use spherule_measure::workload::{SphereScene, WorkloadError};

/// Spheres in columns, as both systems get them.
#[derive(Debug, Default)]
pub struct Columns {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
    pub radius: Vec<f32>,
}

impl Columns {
    /// Makes the spheres of a scene.
    ///
    /// # Errors
    /// They are more than memory holds.
    pub fn of(scene: SphereScene) -> Result<Self, WorkloadError> {
        let column = |values: Vec<f64>| values.into_iter().map(|value| value as f32).collect();
        let [x, y, z, radius] = scene.columns()?.map(column);
        Ok(Self { x, y, z, radius })
    }

    pub fn len(&self) -> usize {
        self.radius.len()
    }

    pub fn row(&self, i: usize) -> [f32; 4] {
        [self.x[i], self.y[i], self.z[i], self.radius[i]]
    }

    /// The spheres along a Morton curve through the centers.
    pub fn sorted(&self) -> Self {
        let order = self.morton_order();
        let column = |values: &[f32]| order.iter().map(|&row| values[row as usize]).collect();
        let Self { x, y, z, radius } = self;
        Self { x: column(x), y: column(y), z: column(z), radius: column(radius) }
    }

    /// The rows along a Morton curve through the centers.
    pub fn morton_order(&self) -> Vec<u32> {
        let axes = [&self.x, &self.y, &self.z].map(|column| {
            let low = column.iter().copied().fold(f32::INFINITY, f32::min);
            let high = column.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            (column, f64::from(low), f64::from(high - low).max(f64::MIN_POSITIVE))
        });
        let mut keys: Vec<(u64, u32)> = (0..self.len())
            .map(|row| {
                let bits = axes.map(|(column, low, width)| {
                    spread(((f64::from(column[row]) - low) / width * STEPS) as u64)
                });
                (bits[0] | bits[1] << 1 | bits[2] << 2, row as u32)
            })
            .collect();
        keys.sort_unstable();
        keys.into_iter().map(|(_, row)| row).collect()
    }
}

/// Largest coordinate on the curve: 21 bits for each axis.
const STEPS: f64 = ((1_u64 << 21) - 1) as f64;

/// Moves the lower 21 bits apart, two zeros between each.
fn spread(bits: u64) -> u64 {
    (0..21).fold(0, |spread, i| spread | (bits >> i & 1) << (3 * i))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_visits_the_octants_of_a_cube_in_order() {
        let mut columns = Columns::default();
        for corner in [6, 1, 7, 0, 3, 2, 5, 4] {
            columns.x.push((corner & 1) as f32);
            columns.y.push((corner >> 1 & 1) as f32);
            columns.z.push((corner >> 2) as f32);
            columns.radius.push(corner as f32);
        }
        assert_eq!(columns.sorted().radius, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    }
}
