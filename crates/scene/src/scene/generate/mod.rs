//! Generators of scenes: the paper's grids and fields, random volumes, crystals, and the field's
//! standard scenes. The same parameters and seed give the same spheres.

mod field;
mod grid;
mod group;
mod lattice;
mod random;
mod show;
mod sphereflake;
mod volume;
mod weekend;

pub use field::Field;
pub use grid::Grid;
pub use group::{GenerateError, Group};
pub use lattice::Lattice;
pub use show::{DEFAULT_MIX, default_scene};
pub use sphereflake::Sphereflake;
pub use volume::Volume;
pub use weekend::Weekend;

use crate::memory;
use crate::scene::{ColorColumn, Footprint, Spheres};
use group::require;

/// A generator with its parameters.
#[derive(Clone, Debug, PartialEq)]
pub enum Generator {
    /// Equal spheres in rows on a plane: the paper's.
    Grid(Grid),
    /// Random spheres that rest on a plane: the paper's.
    Field(Field),
    /// Random spheres in a cube.
    Volume(Volume),
    /// A crystal of touching spheres.
    Lattice(Lattice),
    /// Haines' sphereflake.
    Sphereflake(Sphereflake),
    /// The last scene of "Ray Tracing in One Weekend".
    Weekend(Weekend),
}

impl Generator {
    /// Returns the number of spheres, saturating; for [`Weekend`] an upper bound.
    pub fn count(&self) -> u64 {
        match self {
            Self::Grid(grid) => grid.len(),
            Self::Field(field) => field.len(),
            Self::Volume(volume) => volume.count,
            Self::Lattice(lattice) => lattice.len(),
            Self::Sphereflake(flake) => flake.len(),
            Self::Weekend(_) => Weekend::MAX_COUNT,
        }
    }

    /// Makes the spheres. Generators without randomness ignore the seed.
    ///
    /// # Errors
    ///
    /// A parameter is out of range, or the spheres are more than [`Spheres::MAX`] or than memory holds;
    /// this is checked first. Or some spheres are out of the range of double precision.
    pub fn generate(&self, seed: u64) -> Result<Group, GenerateError> {
        self.check_memory()?;
        let group = match self {
            Self::Grid(grid) => grid.generate(),
            Self::Field(field) => field.generate(seed),
            Self::Volume(volume) => volume.generate(seed),
            Self::Lattice(lattice) => lattice.generate(seed),
            Self::Sphereflake(flake) => flake.generate(),
            Self::Weekend(Weekend) => Ok(Weekend::generate(seed)),
        }?;
        let spheres = &group.spheres;
        let valid = |row| spheres.center(row).is_finite() && spheres.radius[row] > 0.0;
        let message = "is too large or too small: double precision does not hold all spheres";
        require((0..spheres.len()).all(valid), self.scale_parameter(), message)?;
        Ok(group)
    }

    /// Refuses more spheres than memory holds; counts above [`Spheres::MAX`] are refused later.
    fn check_memory(&self) -> Result<(), GenerateError> {
        let count = self.count();
        if count > Spheres::MAX {
            return Ok(());
        }
        memory::check(self.footprint().scene()).or_else(|shortage| {
            let parameter = if matches!(self, Self::Sphereflake(_)) { "level" } else { "count" };
            require(false, parameter, format!("asks for {count} spheres: {shortage}"))
        })
    }

    /// Returns the counts that decide how much memory the spheres take.
    pub fn footprint(&self) -> Footprint {
        let (colors, materials) = match self {
            Self::Field(field) => (field.colors, field.mix.is_some()),
            Self::Volume(volume) => (volume.colors, false),
            Self::Weekend(_) => (true, true),
            Self::Grid(_) | Self::Lattice(_) | Self::Sphereflake(_) => (false, false),
        };
        let colors = if colors { ColorColumn::Rows } else { ColorColumn::None };
        Footprint { spheres: self.count(), colors, materials, ..Footprint::default() }
    }

    /// Returns the parameter that scales the spheres.
    fn scale_parameter(&self) -> &'static str {
        match self {
            Self::Grid(_) => "spacing",
            Self::Volume(_) => "size",
            Self::Field(_) | Self::Lattice(_) | Self::Sphereflake(_) | Self::Weekend(_) => "radius",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn small() -> [Generator; 6] {
        [
            Generator::Grid(Grid { count: 7, ..Grid::default() }),
            Generator::Field(Field { count: 7, ..Field::default() }),
            Generator::Volume(Volume { count: 300, colors: true, ..Volume::default() }),
            Generator::Lattice(Lattice { count: 4, jitter: 0.03, ..Lattice::default() }),
            Generator::Sphereflake(Sphereflake { level: 3, ..Sphereflake::default() }),
            Generator::Weekend(Weekend),
        ]
    }

    #[test]
    fn counts_are_exact_and_rows_are_valid() {
        for generator in small() {
            let Group { spheres, materials } = generator.generate(1).unwrap_or_default();
            let count = spheres.len() as u64;
            match generator {
                Generator::Weekend(_) => assert!((400..=Weekend::MAX_COUNT).contains(&count)),
                _ => assert_eq!(count, generator.count(), "{generator:?}"),
            }
            for row in 0..spheres.len() {
                assert!(spheres.center(row).is_finite() && spheres.radius[row] > 0.0);
                assert!((spheres.material_of(row) as usize) < materials.len().max(1));
                let color = spheres.color_of(row);
                assert!(color.min_element() >= 0.0 && color.max_element() <= 1.0);
            }
            assert!(spheres.material.is_empty() || spheres.material.len() == spheres.len());
            assert!(spheres.color.is_empty() || spheres.color.len() == spheres.len());
        }
    }

    #[test]
    fn only_seeds_decide() {
        for generator in small() {
            let same = generator.generate(5) == generator.generate(5);
            let other = generator.generate(5) == generator.generate(6);
            let random = !matches!(generator, Generator::Grid(_) | Generator::Sphereflake(_));
            assert!(same && other != random, "{generator:?}");
        }
    }

    #[test]
    fn impossible_counts_are_refused_at_once() {
        let huge = [
            Generator::Grid(Grid { count: 1_000_000, ..Grid::default() }),
            Generator::Field(Field { count: u64::MAX, ..Field::default() }),
            Generator::Volume(Volume { count: 1_000_000_000_000, ..Volume::default() }),
            Generator::Lattice(Lattice { count: 1 << 40, ..Lattice::default() }),
        ];
        for generator in huge {
            assert!(generator.generate(0).is_err_and(|error| error.parameter == "count"));
        }
        for level in [11, 60, u32::MAX] {
            let flake = Generator::Sphereflake(Sphereflake { level, ..Sphereflake::default() });
            assert!(flake.generate(0).is_err_and(|error| error.parameter == "level"));
        }
        let none = Generator::Volume(Volume { count: 0, ..Volume::default() });
        assert!(none.generate(0).is_err());
    }

    #[test]
    fn parameters_out_of_range_are_named() {
        let bad = [
            (Generator::Grid(Grid { radius: 0.0, ..Grid::default() }), "radius"),
            (Generator::Grid(Grid { spacing: f64::NAN, ..Grid::default() }), "spacing"),
            (Generator::Field(Field { radius: [0.2, 0.6], ..Field::default() }), "radius"),
            (Generator::Field(Field { radius: [0.3, 0.2], ..Field::default() }), "radius"),
            (Generator::Field(Field { mix: Some([0.0; 3]), ..Field::default() }), "mix"),
            (Generator::Field(Field { mix: Some([2.0, -1.0, 0.0]), ..Field::default() }), "mix"),
            (Generator::Volume(Volume { size: Some(-1.0), ..Volume::default() }), "size"),
            (Generator::Volume(Volume { radius: Some([0.0, 1.0]), ..Volume::default() }), "radius"),
            (Generator::Lattice(Lattice { jitter: -0.1, ..Lattice::default() }), "jitter"),
            (Generator::Lattice(Lattice { radius: -1.0, ..Lattice::default() }), "radius"),
            (Generator::Lattice(Lattice { radius: 1e308, ..Lattice::default() }), "radius"),
            (Generator::Grid(Grid { spacing: 1e308, ..Grid::default() }), "spacing"),
            (Generator::Sphereflake(Sphereflake { radius: 1e308, level: 4 }), "radius"),
            (Generator::Sphereflake(Sphereflake { radius: 5e-324, level: 4 }), "radius"),
        ];
        for (generator, parameter) in bad {
            let error = generator.generate(0);
            assert!(error.is_err_and(|error| error.parameter == parameter), "{generator:?}");
        }
    }
}
