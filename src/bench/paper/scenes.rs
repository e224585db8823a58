//! The paper's scenes, from the files in `scenes/`.

use crate::bench::BenchError;
use crate::scene::generate::{Generator, Grid};
use crate::scene::{Material, Rgb, Scene, Settings, Spheres};
use std::path::Path;

/// A scene of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PaperScene {
    /// What it is called.
    pub name: &'static str,
    /// The scene file.
    text: &'static str,
}

/// Samples toward each light at each hit, in the paper.
pub(crate) const SHADOW_SAMPLES: u32 = 50;

/// Pixels along each side, and samples in each pixel, in the paper.
pub(crate) const FULL: (u32, u32) = (512, 16);

/// Along each side of the square that grids fill, in the scene's unit.
const SIDE: f64 = 20.0;

impl PaperScene {
    /// Two spheres that mirror each other.
    pub const TWO: Self =
        Self { name: "two-spheres", text: include_str!("../../../scenes/paper-two-spheres.toml") };
    /// A grid of 20 x 20 spheres.
    pub const GRID: Self =
        Self { name: "grid", text: include_str!("../../../scenes/paper-grid-20.toml") };
    /// 20 x 20 spheres of random size at random places.
    pub const FIELD: Self =
        Self { name: "field", text: include_str!("../../../scenes/paper-field-20.toml") };

    /// All of them.
    pub const ALL: [Self; 3] = [Self::TWO, Self::GRID, Self::FIELD];

    /// The scene as a square picture of `size` x `size` pixels with `spp` samples in each; all else
    /// is as in the file.
    pub(crate) fn scene(&self, (size, spp): (u32, u32)) -> Result<Scene, BenchError> {
        let mut scene = Scene::parse(self.text, self.name, Path::new(""))?;
        scene.settings = Settings { width: size, height: size, spp, ..scene.settings };
        Ok(scene)
    }

    /// The grid's square, light and camera with `count` x `count` spheres, which are as much
    /// smaller as they are more.
    pub(crate) fn grid(count: u64, scale: (u32, u32)) -> Result<Scene, BenchError> {
        let mut scene = Self::GRID.scene(scale)?;
        let emits = |row: &u32| {
            let named = scene.materials.get(*row as usize);
            named.is_some_and(|named| matches!(named.material, Material::Emitter { .. }))
        };
        let (mut spheres, mut shiny) = (Spheres::default(), 0);
        for row in 0..scene.spheres.len() {
            let material = scene.spheres.material_of(row);
            if emits(&material) {
                let (center, radius) = (scene.spheres.center(row), scene.spheres.radius[row]);
                spheres.push(center, radius, material, Rgb::ONE);
            } else {
                shiny = material;
            }
        }
        let spacing = SIDE / count as f64;
        let grid = Grid { count, spacing, radius: 0.4 * spacing };
        let made = Generator::Grid(grid).generate(0);
        let made =
            made.map_err(|error| BenchError::Generate(format!("{count} x {count}"), error))?;
        spheres.append(made.spheres, &[shiny]);
        scene.spheres = spheres;
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_of_twenty_is_the_files_own() {
        let file = PaperScene::GRID.scene((512, 16)).unwrap();
        let made = PaperScene::grid(20, (512, 16)).unwrap();
        assert_eq!((file.spheres, file.settings), (made.spheres, made.settings));
    }

    #[test]
    fn finer_grids_fill_the_same_square() {
        let scene = PaperScene::grid(50, (8, 1)).unwrap();
        assert_eq!((scene.spheres.len(), scene.settings.width), (1 + 2500, 8));
        let reach = scene.spheres.x[1..].iter().copied().fold(0.0, f64::max);
        assert!((reach + scene.spheres.radius[1] / 0.8 - SIDE / 2.0).abs() < 1e-9, "{reach}");
    }
}
