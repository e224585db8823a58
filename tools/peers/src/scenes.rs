//! The seven scenes.

use clap::ValueEnum;
use serde::Serialize;
use spherule::sampling::{mix, stream, unit_pair};
use spherule::scene::generate::{Field, GenerateError, Generator, Lattice, Volume};
use std::f64::consts::TAU;

/// Name of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ValueEnum)]
#[serde(rename_all = "lowercase")]
pub enum SceneName {
    /// 20 x 20 spheres of random size on a plane.
    Paper400,
    /// Random spheres in a cube, ten thousand.
    Volume10k,
    /// Random spheres in a cube, a million.
    Volume1m,
    /// Random spheres in a cube, ten million.
    Volume10m,
    /// 500 x 500 spheres of random size on a plane.
    Layer250k,
    /// A warm crystal of a million touching spheres.
    Fcc1m,
    /// A Gaussian cloud of a million spheres whose radii are log-normal.
    Lognormal1m,
}

/// Spheres in columns, as both systems get them.
#[derive(Debug, Default)]
pub struct Columns {
    pub x: Vec<f32>,
    pub y: Vec<f32>,
    pub z: Vec<f32>,
    pub radius: Vec<f32>,
}

const SEED: u64 = 1;

impl SceneName {
    /// Makes the spheres.
    ///
    /// # Errors
    /// They are more than memory holds.
    pub fn spheres(self) -> Result<Columns, GenerateError> {
        let volume = |count| Generator::Volume(Volume { count, ..Volume::default() });
        let field = |count| Generator::Field(Field { count, colors: false, ..Field::default() });
        let generator = match self {
            Self::Paper400 => field(20),
            Self::Layer250k => field(500),
            Self::Volume10k => volume(10_000),
            Self::Volume1m => volume(1_000_000),
            Self::Volume10m => volume(10_000_000),
            // 63 cells along each edge, four spheres in each.
            Self::Fcc1m => {
                Generator::Lattice(Lattice { count: 63, jitter: 0.03, ..Lattice::default() })
            }
            Self::Lognormal1m => return Ok(cloud(1_000_000)),
        };
        let spheres = generator.generate(SEED)?.spheres;
        let column = |values: &[f64]| values.iter().map(|&value| value as f32).collect();
        Ok(Columns {
            x: column(&spheres.x),
            y: column(&spheres.y),
            z: column(&spheres.z),
            radius: column(&spheres.radius),
        })
    }

    /// Whether the spheres lie on a plane, which is seen from above.
    pub fn is_flat(self) -> bool {
        matches!(self, Self::Paper400 | Self::Layer250k)
    }
}

/// Centers with a standard deviation of 50 on each axis; radii whose logarithms have one of 1.2,
/// about a median of 0.05: in the middle a ray goes about 14 before it hits, and the largest of a
/// million spheres are some 300 times larger than the median.
fn cloud(count: u64) -> Columns {
    let mut columns = Columns::default();
    for row in 0..count {
        let normal = |column: u64| f64::from(normal(4 * row + column));
        columns.x.push((50.0 * normal(0)) as f32);
        columns.y.push((50.0 * normal(1)) as f32);
        columns.z.push((50.0 * normal(2)) as f32);
        columns.radius.push((0.05 * (1.2 * normal(3)).exp()) as f32);
    }
    columns
}

/// Normal number `position` (Box, Muller, "A Note on the Generation of Random Normal Deviates",
/// Annals of Mathematical Statistics 1958).
fn normal(position: u64) -> f32 {
    let [u, v] = unit_pair(stream(mix(SEED), position)).map(f64::from);
    ((-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()) as f32
}

impl Columns {
    pub fn len(&self) -> usize {
        self.radius.len()
    }

    pub fn row(&self, i: usize) -> [f32; 4] {
        [self.x[i], self.y[i], self.z[i], self.radius[i]]
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
        let order = columns.morton_order();
        let corners: Vec<f32> = order.iter().map(|&row| columns.radius[row as usize]).collect();
        assert_eq!(corners, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0]);
    }
}
