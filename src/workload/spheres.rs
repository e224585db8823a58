//! Spheres alone, made by generators.

use crate::memory::{self, Shortage};
use crate::sampling::{mix, stream, unit_pair};
use crate::scene::generate::{Field, GenerateError, Generator, Lattice, Volume};
use crate::spheres::Spheres;
use glam::DVec3;
use std::f64::consts::TAU;

/// A scene of spheres alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SphereScene {
    /// What it is called.
    pub name: &'static str,
    /// How many spheres it has.
    pub count: u64,
    /// Whether they lie on a plane, which is seen from above.
    pub flat: bool,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// So many random spheres along each side, on a plane.
    Field(u64),
    /// In a cube.
    Volume,
    /// A warm crystal of so many cells along each edge, each of four touching spheres.
    Crystal(u64),
    /// A Gaussian cloud, radii log-normal.
    Cloud,
}

/// Why spheres to measure on cannot be made.
#[derive(Debug, thiserror::Error)]
pub enum WorkloadError {
    /// A generator refuses.
    #[error("{0}: {1}")]
    Generate(&'static str, GenerateError),
    /// There is not the memory for them.
    #[error("{0} needs {1}; leave it out of --scenes")]
    Memory(&'static str, Shortage),
}

const SEED: u64 = 1;

/// Bytes that a sphere takes while its columns are made and its tree is built, at most.
const BYTES: u64 = 128;

const fn field(name: &'static str, side: u64) -> SphereScene {
    SphereScene { name, count: side * side, flat: true, kind: Kind::Field(side) }
}

const fn volume(name: &'static str, count: u64) -> SphereScene {
    SphereScene { name, count, flat: false, kind: Kind::Volume }
}

impl SphereScene {
    /// 400 spheres on a plane, as the paper had.
    pub const PAPER400: Self = field("paper400", 20);
    /// 2 500 of them.
    pub const PAPER2500: Self = field("paper2500", 50);
    /// A quarter of a million of them.
    pub const LAYER250K: Self = field("layer250k", 500);
    /// Random spheres in a cube, ten thousand.
    pub const VOLUME10K: Self = volume("volume10k", 10_000);
    /// A million.
    pub const VOLUME1M: Self = volume("volume1m", 1_000_000);
    /// Ten million.
    pub const VOLUME10M: Self = volume("volume10m", 10_000_000);
    /// A crystal of a million spheres.
    pub const FCC1M: Self =
        Self { name: "fcc1m", count: 4 * 63 * 63 * 63, flat: false, kind: Kind::Crystal(63) };
    /// A cloud of a million spheres, radii over several decades.
    pub const LOGNORMAL1M: Self =
        Self { name: "lognormal1m", count: 1_000_000, flat: false, kind: Kind::Cloud };

    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::PAPER400,
        Self::PAPER2500,
        Self::VOLUME10K,
        Self::LAYER250K,
        Self::VOLUME1M,
        Self::FCC1M,
        Self::LOGNORMAL1M,
        Self::VOLUME10M,
    ];

    /// The scene of a name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scene| scene.name == name)
    }

    /// Makes the spheres: columns of x, y, z and radius, as the generator has them.
    ///
    /// # Errors
    /// There is not the memory for them.
    pub fn columns(&self) -> Result<[Vec<f64>; 4], WorkloadError> {
        memory::check(self.count * BYTES)
            .map_err(|shortage| WorkloadError::Memory(self.name, shortage))?;
        let generator = match self.kind {
            Kind::Field(count) => {
                Generator::Field(Field { count, colors: false, ..Field::default() })
            }
            Kind::Volume => Generator::Volume(Volume { count: self.count, ..Volume::default() }),
            Kind::Crystal(count) => {
                Generator::Lattice(Lattice { count, jitter: 0.03, ..Lattice::default() })
            }
            Kind::Cloud => return Ok(cloud(self.count)),
        };
        let made = generator.generate(SEED);
        let from = made.map_err(|error| WorkloadError::Generate(self.name, error))?.spheres;
        Ok([from.x, from.y, from.z, from.radius])
    }

    /// The same, moved to the origin and scaled by a power of two to coordinates of about 1, as in a
    /// world.
    ///
    /// # Errors
    /// There is not the memory for them.
    pub fn spheres(&self) -> Result<Spheres, WorkloadError> {
        Ok(near_origin(&self.columns()?))
    }
}

/// Centers with a standard deviation of 50 on each axis; radii whose logarithms have one of 1.2,
/// about a median of 0.05: in the middle a ray goes about 14 before it hits, and the largest of a
/// million spheres are some 300 times larger than the median.
fn cloud(count: u64) -> [Vec<f64>; 4] {
    let column = |i: u64| (0..count).map(move |row| normal(4 * row + i));
    let centers = [0, 1, 2].map(|i| column(i).map(|x| 50.0 * x).collect());
    let [x, y, z] = centers;
    [x, y, z, column(3).map(|x| 0.05 * (1.2 * x).exp()).collect()]
}

/// Normal number `position` (Box, Muller, "A Note on the Generation of Random Normal Deviates",
/// Annals of Mathematical Statistics 1958).
fn normal(position: u64) -> f64 {
    let [u, v] = unit_pair(stream(mix(SEED), position)).map(f64::from);
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}

fn near_origin([x, y, z, radius]: &[Vec<f64>; 4]) -> Spheres {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let centers = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| DVec3::new(x, y, z));
    let [low, high] = centers.fold(none, |[low, high], at| [low.min(at), high.max(at)]);
    let (middle, reach) = ((low + high) / 2.0, ((high - low) / 2.0).max_element());
    let scale = (-reach.log2().ceil()).exp2();
    let column = |values: &[f64], middle: f64| {
        values.iter().map(|value| ((value - middle) * scale) as f32).collect::<Vec<_>>()
    };
    Spheres::from_columns(
        &column(x, middle.x),
        &column(y, middle.y),
        &column(z, middle.z),
        &column(radius, 0.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_have_as_many_spheres_as_they_say() {
        for scene in [SphereScene::PAPER400, SphereScene::PAPER2500, SphereScene::VOLUME10K] {
            let spheres = scene.spheres().unwrap();
            assert_eq!(spheres.len() as u64, scene.count, "{}", scene.name);
            let reach = (0..spheres.len()).map(|i| spheres.center(i).abs().max_element());
            let reach = reach.fold(0.0, f32::max);
            assert!((0.5..=1.0).contains(&reach), "{}: {reach}", scene.name);
            assert_eq!(SphereScene::named(scene.name), Some(scene));
        }
    }

    #[test]
    fn clouds_are_gaussian_and_radii_log_normal() {
        let [x, _, _, radius] = cloud(10_000);
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let variance = mean(&x.iter().map(|x| x * x).collect::<Vec<_>>());
        assert!((variance.sqrt() - 50.0).abs() < 2.0);
        let logarithm = mean(&radius.iter().map(|r| r.ln()).collect::<Vec<_>>());
        assert!((logarithm - 0.05_f64.ln()).abs() < 0.05);
    }
}
