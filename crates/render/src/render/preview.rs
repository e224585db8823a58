//! Previews: images without noise, fast enough for a moving camera.

use super::pass::{uniform_radiance, view};
use super::{Options, RenderError, check};
use crate::film::{Film, Region, TILE, View};
use crate::image::Image;
use crate::integrator::Job;
use crate::integrator::columns::BATCH_PATHS;
use crate::integrator::generate::{dither_thresholds, generate_centers};
use crate::integrator::preview::{self, Lighting};
use crate::integrator::workspace::Workspace;
use crate::scene::{Filter, Integrator, Rgb, Settings};
use crate::world::{Irradiance, World};
use rayon::prelude::*;
use std::f32::consts::PI;
use std::sync::atomic::Ordering;
use std::sync::{Mutex, PoisonError};

/// Tiles whose paths fill a batch.
const TILES: usize = BATCH_PATHS / (TILE * TILE) as usize;

/// Renders an image without noise: one ray per pixel, through its middle, direct light from the middles of lights, and
/// unhidden light of the environment. `shadows` is true if lights cast them, which takes a tenth to a third more time.
///
/// Mirrors and glass show one direction each; light from surface to surface is missing. Of the integrator, ambient
/// occlusion has its colors alone; the sampler, the filter and the number of samples have no effect. Of the
/// options, the region, the tracer and the flag that cancels are used: `None` if it was set.
///
/// The image has the same bytes for any number of threads and any tracer.
///
/// # Errors
/// Those of [`render()`](super::render()).
pub fn preview(
    world: &World,
    settings: &Settings,
    options: &Options,
    shadows: bool,
) -> Result<Option<Image>, RenderError> {
    let region = check(world, settings, options)?;
    // The glint of a light in glass is left to the mirrored ray, and rays through the middles of pixels need no table of a
    // filter, which would take a millisecond.
    let chosen = Settings { caustics: false, filter: Filter::Box, ..settings.clone() };
    let job = Job::new(world, &chosen, 1, options.tracer, options.elisions);
    let occlusion = matches!(settings.integrator, Integrator::Ao { .. });
    let irradiance = if occlusion {
        Irradiance::constant(Rgb::splat(PI))
    } else {
        Irradiance::of(&world.environment)
    };
    let flat = settings.integrator == Integrator::Ao { distance: 0.0 };
    let lighting = Lighting { irradiance, lights: !occlusion, shadows, flat };
    let (width, height) = (region.width as usize, region.height as usize);
    let mut pixels = vec![[0.0; 3]; width * height];
    let tiles: Vec<Region> = Film::tile_regions(region).collect();
    let rows = pixels.par_chunks_mut(width * TILE as usize);
    let rows = rows.zip(tiles.par_chunks(width.div_ceil(TILE as usize)));
    let cancelled = || options.cancel.is_some_and(|flag| flag.load(Ordering::Relaxed));
    // One for each thread, not for each part of the rows: to clear one takes as long as thousands of rays.
    let spare = Mutex::new(Vec::new());
    let spare = || spare.lock().unwrap_or_else(PoisonError::into_inner);
    rows.for_each(|(pixels, tiles)| {
        if !cancelled() {
            let own = spare().pop();
            let mut work = own.unwrap_or_else(|| Workspace::new(world, options.elisions));
            render_row(&job, &lighting, tiles, width, pixels, &mut work);
            spare().push(work);
        }
    });
    Ok((!cancelled()).then_some(Image { width: region.width, height: region.height, pixels }))
}

/// Renders a row of tiles to their pixels, `width` in a row.
fn render_row(
    job: &Job,
    lighting: &Lighting,
    tiles: &[Region],
    width: usize,
    pixels: &mut [[f32; 3]],
    work: &mut Workspace,
) {
    let Some(&Region { x: left, y: top, .. }) = tiles.first() else { return };
    let index = |(x, y): (u32, u32)| (y - top) as usize * width + (x - left) as usize;
    for which in [View::Anything, View::Background] {
        let tiles: Vec<Region> =
            tiles.iter().copied().filter(|&tile| view(job, tile) == which).collect();
        for tiles in tiles.chunks(TILES) {
            let places = || tiles.iter().flat_map(|tile| tile.morton());
            if let Some(radiance) = uniform_radiance(job.world, which) {
                places().for_each(|place| pixels[index(place)] = radiance.to_array());
                continue;
            }
            work.view = which;
            generate_centers(job, places(), work);
            dither_thresholds(places(), work);
            preview::integrate(job, work, lighting);
            for (place, radiance) in places().zip(&work.paths.radiance) {
                pixels[index(place)] = radiance.to_array();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Region;
    use crate::render::render;
    use crate::scene::generate::default_scene;
    use crate::scene::{Environment, EnvironmentMap, Light, Material, Scene};
    use crate::trace::{Tracer, Traversal};
    use std::sync::atomic::AtomicBool;

    fn field() -> Scene {
        let mut scene = default_scene(4);
        (scene.settings.width, scene.settings.height) = (96, 54);
        scene
    }

    fn preview_of(scene: &Scene, options: &Options, shadows: bool) -> Image {
        let world = World::build(scene).unwrap();
        preview(&world, &scene.settings, options, shadows).unwrap().unwrap()
    }

    #[test]
    fn previews_show_direct_light() {
        let mut scene = field();
        for row in &mut scene.materials {
            row.material = Material::Lambertian { color: Rgb::new(0.2, 0.5, 0.7) };
        }
        let map = EnvironmentMap::Constant(Rgb::ZERO);
        scene.environment = Environment { map, illuminates: true };
        for light in &mut scene.lights {
            if let Light::Sun { angular_radius, .. } = light {
                *angular_radius = 0.0;
            }
        }
        // Paths of one bounce have direct light alone.
        (scene.settings.depth, scene.settings.spp) = (Some(1), 64);
        (scene.settings.width, scene.settings.height) = (192, 108);
        let world = World::build(&scene).unwrap();
        let truth = render(&world, &scene.settings, &Options::default()).unwrap().image;
        let image = preview_of(&scene, &Options::default(), true);
        let differences = image.pixels.iter().flatten().zip(truth.pixels.iter().flatten());
        // Others are at edges of spheres and of shadows.
        let equal = differences.filter(|(a, b)| (*a - *b).abs() < 0.02).count();
        let share = equal as f64 / (3 * image.pixels.len()) as f64;
        assert!(share > 0.75, "{share}");
        let mean = |image: &Image| image.pixels.iter().flatten().sum::<f32>();
        assert!((mean(&image) / mean(&truth) - 1.0).abs() < 0.03);
        let bright = preview_of(&scene, &Options::default(), false);
        assert!(mean(&bright) > 1.1 * mean(&truth));
    }

    #[test]
    fn previews_are_the_same_for_any_seed_and_tracer_and_in_regions() {
        let mut scene = field();
        let whole = preview_of(&scene, &Options::default(), true);
        scene.settings.seed = 7;
        let tracer = Tracer { traversal: Traversal::Brute, ..Tracer::default() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let brute = Options { tracer, ..Options::default() };
        assert!(pool.install(|| preview_of(&scene, &brute, true)) == whole);
        let region = Region { x: 37, y: 11, width: 40, height: 21 };
        let part = Options { region: Some(region), ..Options::default() };
        let part = preview_of(&scene, &part, true);
        for (x, y) in [(0, 0), (39, 0), (17, 13), (39, 20)] {
            assert_eq!(part.pixel(x, y), whole.pixel(x + region.x, y + region.y));
        }
        let flag = AtomicBool::new(true);
        let cancelled = Options { cancel: Some(&flag), ..Options::default() };
        let world = World::build(&scene).unwrap();
        assert!(preview(&world, &scene.settings, &cancelled, true).unwrap().is_none());
    }
}
