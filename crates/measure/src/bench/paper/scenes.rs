//! The paper's scenes, from the files in `scenes/`.

use crate::bench::BenchError;
use spherule_render::scene::generate::{Generator, Grid};
use spherule_render::scene::{Material, Rgb, Scene, Settings, Spheres};
use std::path::Path;

/// A scene of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PaperScene {
    /// The name.
    pub name: &'static str,
    /// Content of the scene file.
    text: &'static str,
}

/// Shadow samples for each light at each hit, in the paper.
pub(crate) const SHADOW_SAMPLES: u32 = 50;

/// Width and height in pixels, and samples per pixel, in the paper.
pub(crate) const FULL: (u32, u32) = (512, 16);

/// Side of the square that grids fill, in the scene's unit.
const SIDE: f64 = 20.0;

impl PaperScene {
    /// Two mirrors that reflect each other.
    pub const TWO: Self =
        Self { name: "two-spheres", text: include_str!("../../../scenes/paper-two-spheres.toml") };
    /// A grid of 20 x 20 spheres.
    pub const GRID: Self =
        Self { name: "grid", text: include_str!("../../../scenes/paper-grid-20.toml") };
    /// 20 x 20 spheres with random radii and positions.
    pub const FIELD: Self =
        Self { name: "field", text: include_str!("../../../scenes/paper-field-20.toml") };

    /// All scenes.
    pub const ALL: [Self; 3] = [Self::TWO, Self::GRID, Self::FIELD];

    /// Returns the scene of the file with `size` x `size` pixels and `spp` samples per pixel.
    pub(crate) fn scene(&self, size: u32, spp: u32) -> Result<Scene, BenchError> {
        let mut scene = Scene::parse(self.text, self.name, Path::new(""))?;
        scene.settings = Settings { width: size, height: size, spp, ..scene.settings };
        Ok(scene)
    }

    /// Returns the grid with `count` x `count` spheres, scaled to fill the same square; `size` and
    /// `spp` are those of [`PaperScene::scene`].
    pub(crate) fn grid(count: u64, size: u32, spp: u32) -> Result<Scene, BenchError> {
        let mut scene = Self::GRID.scene(size, spp)?;
        let is_emitter = |row: &u32| {
            let named = scene.materials.get(*row as usize);
            named.is_some_and(|named| matches!(named.material, Material::Emitter { .. }))
        };
        let (mut spheres, mut shiny) = (Spheres::default(), 0);
        for row in 0..scene.spheres.len() {
            let material = scene.spheres.material_of(row);
            if is_emitter(&material) {
                let (center, radius) = (scene.spheres.center(row), scene.spheres.radius[row]);
                spheres.push(center, radius, material, Rgb::ONE);
            } else {
                shiny = material;
            }
        }
        let spacing = SIDE / count as f64;
        let grid = Grid { count, spacing, radius: 0.4 * spacing };
        let generated = Generator::Grid(grid).generate(0);
        let generated =
            generated.map_err(|error| BenchError::Generate(format!("{count} x {count}"), error))?;
        spheres.append(generated.spheres, &[shiny]);
        scene.spheres = spheres;
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_of_twenty_is_the_files_own() {
        let file = PaperScene::GRID.scene(512, 16).unwrap();
        let generated = PaperScene::grid(20, 512, 16).unwrap();
        assert_eq!((file.spheres, file.settings), (generated.spheres, generated.settings));
    }

    #[test]
    fn finer_grids_fill_the_same_square() {
        let scene = PaperScene::grid(50, 8, 1).unwrap();
        assert_eq!((scene.spheres.len(), scene.settings.width), (1 + 2500, 8));
        let extent = scene.spheres.x[1..].iter().copied().fold(0.0, f64::max);
        assert!((extent + scene.spheres.radius[1] / 0.8 - SIDE / 2.0).abs() < 1e-9, "{extent}");
    }
}
