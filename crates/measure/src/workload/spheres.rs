//! Generated sets of spheres.

use glam::DVec3;
use spherule_render::elementary::{ceil_log2, cos, exp, ln, power_of_two};
use spherule_render::memory::{self, Shortage};
use spherule_render::sampling::{mix, stream, unit_pair};
use spherule_render::scene::generate::{Field, GenerateError, Generator, Lattice, Volume};
use spherule_render::spheres::Spheres;
use std::f64::consts::TAU;

/// A set of spheres.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SphereScene {
    /// The name.
    pub name: &'static str,
    /// Number of spheres.
    pub count: u64,
    /// True if they lie on a plane, seen from above.
    pub flat: bool,
    kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// Random spheres on a plane, with a number along each side.
    Field(u64),
    /// Random spheres in a cube.
    Volume,
    /// An fcc crystal with thermal displacements, with a number of cells along each edge.
    Crystal(u64),
    /// A Gaussian cloud with log-normal radii.
    Cloud,
}

/// An error in the generation of spheres.
#[derive(Debug, thiserror::Error)]
pub enum WorkloadError {
    /// The generator failed.
    #[error("{0}: {1}")]
    Generate(&'static str, GenerateError),
    /// There is not enough memory.
    #[error("{0} needs {1}; remove it from --scenes")]
    Memory(&'static str, Shortage),
}

const SEED: u64 = 1;

/// Maximum memory per sphere in bytes, for generation and construction of the BVH.
const BYTES: u64 = 128;

const fn field(name: &'static str, side: u64) -> SphereScene {
    SphereScene { name, count: side * side, flat: true, kind: Kind::Field(side) }
}

const fn volume(name: &'static str, count: u64) -> SphereScene {
    SphereScene { name, count, flat: false, kind: Kind::Volume }
}

impl SphereScene {
    /// 400 spheres on a plane, as in the paper.
    pub const PAPER400: Self = field("paper400", 20);
    /// 2 500 spheres on a plane.
    pub const PAPER2500: Self = field("paper2500", 50);
    /// 250 000 spheres on a plane.
    pub const LAYER250K: Self = field("layer250k", 500);
    /// 10 000 random spheres in a cube.
    pub const VOLUME10K: Self = volume("volume10k", 10_000);
    /// A million random spheres in a cube.
    pub const VOLUME1M: Self = volume("volume1m", 1_000_000);
    /// Ten million random spheres in a cube.
    pub const VOLUME10M: Self = volume("volume10m", 10_000_000);
    /// A crystal of a million spheres.
    pub const FCC1M: Self =
        Self { name: "fcc1m", count: 4 * 63 * 63 * 63, flat: false, kind: Kind::Crystal(63) };
    /// A cloud of a million spheres with radii over several decades.
    pub const LOGNORMAL1M: Self =
        Self { name: "lognormal1m", count: 1_000_000, flat: false, kind: Kind::Cloud };

    /// All sets.
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

    /// Returns the set with this name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|scene| scene.name == name)
    }

    /// Generates the spheres, as columns of x, y, z and radius.
    ///
    /// # Errors
    /// There is not enough memory.
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
        let generated = generator.generate(SEED);
        let spheres = generated.map_err(|error| WorkloadError::Generate(self.name, error))?.spheres;
        Ok([spheres.x, spheres.y, spheres.z, spheres.radius])
    }

    /// Generates the spheres, moved to the origin and scaled by a power of two to coordinates of about 1,
    /// as in a world.
    ///
    /// # Errors
    /// There is not enough memory.
    pub fn spheres(&self) -> Result<Spheres, WorkloadError> {
        Ok(near_origin(&self.columns()?))
    }
}

/// Generates centers with a standard deviation of 50 on each axis, and radii with a median of 0.05 whose
/// logarithms have a standard deviation of 1.2. The mean free path in the center is about 14, and the
/// largest of a million spheres are about 300 times larger than the median.
fn cloud(count: u64) -> [Vec<f64>; 4] {
    let column = |i: u64| (0..count).map(move |row| normal(4 * row + i));
    let centers = [0, 1, 2].map(|i| column(i).map(|x| 50.0 * x).collect());
    let [x, y, z] = centers;
    [x, y, z, column(3).map(|x| 0.05 * exp(1.2 * x)).collect()]
}

/// Returns normally distributed number `position` of a sequence (Box, Muller, "A Note on the Generation
/// of Random Normal Deviates", Annals of Mathematical Statistics 1958).
fn normal(position: u64) -> f64 {
    let [u, v] = unit_pair(stream(mix(SEED), position)).map(f64::from);
    (-2.0 * ln(1.0 - u)).sqrt() * cos(TAU * v)
}

fn near_origin([x, y, z, radius]: &[Vec<f64>; 4]) -> Spheres {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let centers = x.iter().zip(y).zip(z).map(|((&x, &y), &z)| DVec3::new(x, y, z));
    let [low, high] = centers.fold(none, |[low, high], at| [low.min(at), high.max(at)]);
    let (middle, extent) = ((low + high) / 2.0, ((high - low) / 2.0).max_element());
    let scale = power_of_two(-ceil_log2(extent));
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
            let extent = (0..spheres.len()).map(|i| spheres.center(i).abs().max_element());
            let extent = extent.fold(0.0, f32::max);
            assert!((0.5..=1.0).contains(&extent), "{}: {extent}", scene.name);
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
