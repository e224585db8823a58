//! What a render takes of memory, before it takes it.

use crate::cli::contents::spheres;
use crate::cli::failure::Failure;
use spherule::World;
use spherule::film::{Film, Region};
use spherule::layers::Layers;
use spherule::memory::{self, Shortage, Size};
use spherule::scene::Scene;
use std::fmt;

/// What a render takes of memory, at most.
#[derive(Clone, Debug)]
pub(crate) struct Estimate {
    region: Region,
    spheres: u64,
    /// Bytes of the spheres as kernels read them, with what it takes to build the tree.
    world: u64,
    /// Bytes of the sums, and of the picture.
    film: u64,
    /// Bytes of the layers; 0 if there are none.
    layers: u64,
}

impl Estimate {
    /// Of a scene that is loaded, what comes on top; `squared` sums tell how samples spread.
    pub(super) fn new(scene: &Scene, region: Region, squared: bool, layered: bool) -> Self {
        let spheres = scene.spheres.len() as u64;
        Self {
            region,
            spheres,
            world: World::bytes_beside(scene),
            film: Film::bytes(region, squared),
            layers: if layered { Layers::bytes(region) } else { 0 },
        }
    }

    /// The same of so many of the region's tiles.
    pub(super) fn of_tiles(self, tiles: usize) -> Self {
        let part = |bytes: u64| {
            let share = u128::from(bytes) * tiles as u128;
            (share / u128::from(Film::tile_count(self.region)).max(1)) as u64
        };
        Self { film: part(self.film), layers: part(self.layers), ..self }
    }

    /// Refuses a render that there is no memory for.
    pub(super) fn check(self) -> Result<(), Failure> {
        let Self { world, film, layers, .. } = self;
        let need = world.saturating_add(film).saturating_add(layers);
        memory::check(need).map_err(|shortage| Failure::Memory(self, shortage))
    }

    /// The whole story, for people.
    pub(crate) fn message(&self, shortage: &Shortage) -> String {
        let mend = if self.world > self.film + self.layers {
            "render fewer spheres, or where there is more memory"
        } else {
            "give --size or --region smaller numbers"
        };
        format!("{self} need {shortage}; {mend}")
    }
}

impl fmt::Display for Estimate {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (Region { width, height, .. }, film) = (self.region, Size(self.film));
        if self.spheres > 0 {
            write!(formatter, "{} ({}) and ", spheres(self.spheres), Size(self.world))?;
        }
        write!(formatter, "{width} x {height} pixels ({film}")?;
        if self.layers > 0 {
            write!(formatter, ", their layers {}", Size(self.layers))?;
        }
        formatter.write_str(")")
    }
}
