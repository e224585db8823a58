//! Depth cue, and the environment that the camera sees.

use super::{Matte, Overlay, PIXELS};
use crate::film::Region;
use crate::image::Image;
use crate::render::Render;
use crate::world::World;
use rayon::prelude::*;

/// Returns the environment's radiance at the center of a pixel of the picture.
fn sky(world: &World, x: u32, y: u32) -> [f32; 3] {
    let position = [x, y].map(|place| f64::from(place) + 0.5);
    let (_, direction) = world.camera.rays::<f64>(position, None);
    let toward = glam::DVec3::new(direction.x, direction.y, direction.z).as_vec3();
    world.environment.radiance(toward).to_array()
}

/// Gives the pixels of a render that have no sample the background that the camera sees. `region` is that of the image.
pub(super) fn fill_unsampled(world: &World, region: Region, render: &mut Render) {
    let background = world.environment.background.map(|color| color.to_array());
    let Render { image, unsampled, .. } = render;
    for (x, y) in unsampled.iter().flat_map(|tile| tile.morton()) {
        image.pixels[row_of(region, x, y)] = background.unwrap_or_else(|| sky(world, x, y));
    }
}

/// Makes the pixels of a picture that have no sample transparent.
pub(super) fn clear_unsampled(region: Region, render: &mut Render, matte: &mut Matte) {
    let Render { image, unsampled, .. } = render;
    for (x, y) in unsampled.iter().flat_map(|tile| tile.morton()) {
        let at = row_of(region, x, y);
        (image.pixels[at], matte.coverage[at]) = ([0.0; 3], 0.0);
        if let Some(shadow) = matte.shadow.get_mut(at) {
            *shadow = 0.0;
        }
    }
}

/// Returns the row of a pixel of the picture among those of a region.
fn row_of(region: Region, x: u32, y: u32) -> usize {
    (y - region.y) as usize * region.width as usize + (x - region.x) as usize
}

impl Overlay<'_> {
    /// Returns the environment's radiance at the center of a pixel of the region.
    pub(super) fn sky(&self, x: usize, y: usize) -> [f32; 3] {
        sky(self.world, self.region.x + x as u32, self.region.y + y as u32)
    }

    /// Blends distant objects with a color: from 0 at the nearest sphere to `most` (0..=1) at the end
    /// of the farthest.
    pub fn fade(&self, image: &mut Image, color: [f32; 3], most: f32) {
        let [near, far] = self.depths();
        let pixels = image.pixels.par_iter_mut().zip(&self.layers.pixels);
        pixels.with_min_len(PIXELS).for_each(|(pixel, seen)| {
            if seen.coverage > 0.0 && far > near {
                let depth = ((f64::from(seen.depth) - near) / (far - near)).clamp(0.0, 1.0);
                // Quadratic, so that near objects keep their colors.
                let opacity = (depth * depth) as f32 * most;
                *pixel = std::array::from_fn(|i| pixel[i] + opacity * (color[i] - pixel[i]));
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layers::{Features, Layer, Layers, layers};
    use crate::overlay::depths;
    use crate::render::{Options, render};
    use crate::scene::particles::Particles;
    use crate::scene::{EnvironmentMap, Pose, Projection, Rgb, Scene};
    use crate::world::World;
    use glam::DVec3;

    const SIZE: u32 = 24;
    const WHOLE: Region = Region { x: 0, y: 0, width: SIZE, height: SIZE };

    /// Two spheres apart, one behind and beside the other, under a white environment.
    fn scene() -> Scene {
        let mut scene = Scene::of_particles(Particles::default(), "");
        scene.spheres.push(DVec3::new(-1.0, 0.0, 0.0), 0.8, 0, Rgb::ONE);
        scene.spheres.push(DVec3::new(1.0, 0.0, -8.0), 0.8, 0, Rgb::ONE);
        scene.camera.projection = Projection::Orthographic { height: Some(4.0) };
        scene.camera.pose = Pose::LookAt { eye: DVec3::Z * 5.0, target: DVec3::ZERO };
        (scene.settings.width, scene.settings.height) = (SIZE, SIZE);
        scene
    }

    /// The image before and after drawing.
    fn drawn(draw: impl Fn(&Overlay, &mut Image)) -> [Image; 2] {
        let scene = scene();
        let world = World::build(&scene).unwrap();
        let before = render(&world, &scene.settings, &Options::default()).unwrap().image;
        let layers = layers(&world, &scene.settings, &Options::default(), &[Layer::Depth]).unwrap();
        let mut after = before.clone();
        draw(&Overlay { world: &world, region: WHOLE, layers: &layers, depths: None }, &mut after);
        [before, after]
    }

    #[test]
    fn distant_spheres_fade() {
        let [before, after] = drawn(|overlay, image| overlay.fade(image, [0.0; 3], 0.5));
        let kept = |x: u32| after.pixel(x, 12).unwrap()[1] / before.pixel(x, 12).unwrap()[1];
        assert!(kept(6) > 0.99 && (0.55..0.75).contains(&kept(18)), "{} {}", kept(6), kept(18));
        assert_eq!(after.pixel(0, 0), before.pixel(0, 0));
    }

    #[test]
    fn contours_are_only_on_edges() {
        let [before, after] = drawn(|overlay, image| overlay.draw_contours(image, [0.0; 3]));
        assert_eq!(after.pixel(6, 12), before.pixel(6, 12));
        assert_eq!(after.pixel(0, 0), before.pixel(0, 0));
        // The first sphere is 9.6 pixels wide, from column 1.2 on.
        let edge = (1..=3).map(|x| after.pixel(x, 12).unwrap()[1]).fold(1.0, f32::min);
        assert!(edge < 0.3, "{edge}");
        assert_eq!(depths(&World::build(&scene()).unwrap()).map(f64::round), [4.0, 14.0]);
    }

    /// Returns a white image of 6 x 5 pixels after drawing; its left half is at depth 10 and its
    /// right half is `other`, in a scene of depths from 0 to 100.
    fn halves(other: Features, draw: impl Fn(&Overlay, &mut Image)) -> Image {
        let up = [0.0, 0.0, 1.0];
        let left = Features { normal: up, depth: 10.0, coverage: 1.0, id: 1, ..Features::NONE };
        let pixels = (0..30).map(|row| if row % 6 < 3 { left } else { other }).collect();
        let layers = Layers { width: 6, height: 5, pixels, statistics: None };
        let world = World::build(&scene()).unwrap();
        let region = Region { x: 0, y: 0, width: 6, height: 5 };
        let mut image = Image::filled(6, 5, [1.0; 3]).unwrap();
        let depths = Some([0.0, 100.0]);
        draw(&Overlay { world: &world, region, layers: &layers, depths }, &mut image);
        image
    }

    #[test]
    fn contours_are_as_strong_as_jumps_and_creases() {
        let row = |depth: f32, cosine: f32| {
            let normal = [(1.0 - cosine * cosine).sqrt(), 0.0, cosine];
            let other = Features { normal, depth, coverage: 1.0, id: 2, ..Features::NONE };
            let image = halves(other, |overlay, image| overlay.draw_contours(image, [0.0; 3]));
            [1, 2, 3].map(|x| image.pixel(x, 2).unwrap()[1])
        };
        let close = |found: [f32; 3], strength: f32| {
            // Smoothed, the nearer pixel has 0.9 of the strength, and its neighbors half of that.
            let expected = [0.45, 0.9, 0.45].map(|opacity| 1.0 - opacity * strength);
            let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5);
            assert!(near, "{found:?} {expected:?}");
        };
        // A jump is more than 2 % of the depth range.
        close(row(13.0, 1.0), 1.0);
        close(row(11.0, 1.0), 0.0);
        // A crease of 60 degrees.
        close(row(11.0, 0.5), 0.7 * (0.5 - 0.1) / 0.7);
    }

    #[test]
    fn fog_grows_with_the_square_of_the_depth() {
        let other = Features { depth: 75.0, coverage: 1.0, id: 2, ..Features::NONE };
        let image = halves(other, |overlay, image| overlay.fade(image, [0.0; 3], 0.5));
        for (x, opacity) in [(0, 0.01), (5, 0.5625)] {
            let left = image.pixel(x, 0).unwrap()[1];
            assert!((left - (1.0 - 0.5 * opacity)).abs() < 1e-6, "{x} {left}");
        }
    }

    #[test]
    fn a_region_sees_its_part_of_the_sky() {
        let mut scene = scene();
        scene.camera.projection = Projection::Perspective { fov: 60.0 };
        let (bottom, top) = (Rgb::ZERO, Rgb::ONE);
        let up = DVec3::new(0.6, 0.8, 0.0);
        scene.environment.map = EnvironmentMap::Gradient { bottom, top, up };
        let world = World::build(&scene).unwrap();
        let layers = Layers { width: 0, height: 0, pixels: Vec::new(), statistics: None };
        let overlay = |region| Overlay { world: &world, region, layers: &layers, depths: None };
        let part = overlay(Region { x: 11, y: 5, width: 4, height: 3 });
        assert_eq!(part.sky(2, 1), overlay(WHOLE).sky(13, 6));
        assert_ne!(part.sky(2, 1), overlay(WHOLE).sky(2, 6));
        assert_ne!(part.sky(2, 1), overlay(WHOLE).sky(13, 1));
    }
}
