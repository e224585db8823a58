//! Straight lines in the scene.

use super::{Overlay, blend};
use crate::image::Image;
use crate::layers::Features;
use crate::world::Camera;
use glam::{DVec2, DVec3};

/// In perspective, a line is clipped where its depth is less than this fraction of that of its farther
/// end, so that its pixels stay finite.
const MIN_DEPTH_RATIO: f64 = 1e-4;

/// A straight line between two points of the scene.
pub type Line = [DVec3; 2];

/// Style of lines.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pen {
    /// Color, linear RGB.
    pub color: [f32; 3],
    /// Width in pixels, more than 0; lines thinner than 1 are fainter.
    pub width: f64,
}

/// The visible part of a line: its ends in the camera's axes, and in pixels.
struct Projected {
    seen: [DVec3; 2],
    pixel: [DVec2; 2],
}

impl Overlay<'_> {
    /// Draws lines, hidden behind nearer objects. Where several lines meet, only the strongest counts.
    pub fn draw_lines(&self, image: &mut Image, lines: &[Line], pen: Pen) {
        let mut coverage = vec![0.0; image.pixels.len()];
        for line in lines {
            if let Some(line) = self.project(line) {
                self.add_line(&mut coverage, &line, pen.width);
            }
        }
        blend(image, &coverage, pen.color);
    }

    fn project(&self, line: &Line) -> Option<Projected> {
        let (camera, transform) = (&self.world.camera, &self.world.transform);
        let seen = clipped(camera, line.map(|point| camera.view(transform.point(point))))?;
        Some(Projected { seen, pixel: seen.map(|end| camera.pixel(end)) })
    }

    /// Raises the coverage of pixels to that of this line.
    fn add_line(&self, coverage: &mut [f32], line: &Projected, width: f64) {
        let corner = DVec2::new(f64::from(self.region.x), f64::from(self.region.y));
        let size = DVec2::new(f64::from(self.region.width), f64::from(self.region.height));
        let [a, b] = line.pixel.map(|pixel| pixel - corner);
        let reach = width / 2.0 + 1.0;
        let low = (a.min(b) - reach).clamp(DVec2::ZERO, size).floor();
        let high = (a.max(b) + reach).clamp(DVec2::ZERO, size).ceil();
        for y in low.y as usize..high.y as usize {
            for x in low.x as usize..high.x as usize {
                let middle = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                let (along, distance) = nearest(a, b, middle);
                // A ramp as wide as a pixel.
                let covered = (width / 2.0 + 0.5 - distance).clamp(0.0, width.min(1.0));
                if covered > 0.0 {
                    let row = y * self.region.width as usize + x;
                    let depth = self.distance(line, along);
                    let visible = covered as f32 * visible(depth, &self.layers.pixels[row]);
                    coverage[row] = coverage[row].max(visible);
                }
            }
        }
    }

    /// Returns the distance from the camera at a fraction of the line in the image, in the scene's
    /// unit, as in the depth layer.
    fn distance(&self, line: &Projected, along: f64) -> f64 {
        let [a, b] = line.seen;
        let scale = self.world.transform.scale;
        if self.world.camera.is_orthographic() {
            return (a.z + (b.z - a.z) * along) / scale;
        }
        // 1/z is linear in the image.
        let part = along * a.z / ((1.0 - along) * b.z + along * a.z);
        (a + (b - a) * part).length() / scale
    }
}

/// Returns the part of a line, in the camera's axes, in front of the camera.
pub(super) fn clipped(camera: &Camera, [a, b]: [DVec3; 2]) -> Option<[DVec3; 2]> {
    let farthest = a.z.max(b.z);
    let least = if camera.is_orthographic() { 0.0 } else { MIN_DEPTH_RATIO * farthest };
    let least = camera.near().max(least);
    let inside = if camera.is_orthographic() { farthest >= least } else { farthest > least };
    let cut = |from: DVec3, to: DVec3| {
        if from.z >= least { from } else { to + (from - to) * ((to.z - least) / (to.z - from.z)) }
    };
    inside.then(|| [cut(a, b), cut(b, a)])
}

/// Returns the point of the line from `a` to `b` nearest to a point, as a fraction 0 to 1, and its
/// distance.
fn nearest(a: DVec2, b: DVec2, point: DVec2) -> (f64, f64) {
    let way = b - a;
    let length = way.length_squared();
    let along = if length > 0.0 { ((point - a).dot(way) / length).clamp(0.0, 1.0) } else { 0.0 };
    (along, (a + way * along).distance(point))
}

/// Returns the fraction of a pixel in which nothing is nearer than this distance.
fn visible(distance: f64, pixel: &Features) -> f32 {
    if distance <= f64::from(pixel.depth) { 1.0 } else { 1.0 - pixel.coverage }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::Region;
    use crate::layers::{Layer, layers};
    use crate::render::Options;
    use crate::scene::particles::Particles;
    use crate::scene::{Pose, Projection, Rgb, Scene};
    use crate::world::World;

    const SIZE: u32 = 40;

    /// A sphere of radius 1, and a camera at a distance of 5.
    fn world(projection: Projection) -> (World, Scene) {
        let mut scene = Scene::default();
        scene.spheres.push(DVec3::ZERO, 1.0, 0, Rgb::ONE);
        scene.materials = Scene::of_particles(Particles::default(), "").materials;
        scene.camera.projection = projection;
        scene.camera.pose = Pose::LookAt { eye: DVec3::Z * 5.0, target: DVec3::ZERO };
        (scene.settings.width, scene.settings.height) = (SIZE, SIZE);
        (World::build(&scene).unwrap(), scene)
    }

    /// An image of a white line on black, in a region.
    fn drawn(projection: Projection, line: Line, region: Region) -> Image {
        let (world, scene) = world(projection);
        let options = Options { region: Some(region), ..Options::default() };
        let layers = layers(&world, &scene.settings, &options, &[Layer::Depth]).unwrap();
        let mut image = Image::filled(region.width, region.height, [0.0; 3]).unwrap();
        let overlay = Overlay { world: &world, region, layers: &layers, depths: None };
        overlay.draw_lines(&mut image, &[line], Pen { color: [1.0; 3], width: 2.0 });
        image
    }

    const WHOLE: Region = Region { x: 0, y: 0, width: SIZE, height: SIZE };
    const PARALLEL: Projection = Projection::Orthographic { height: Some(4.0) };
    const CENTRAL: Projection = Projection::Perspective { fov: 53.13 };

    fn across(z: f64) -> Line {
        [DVec3::new(-1.5, 0.0, z), DVec3::new(1.5, 0.0, z)]
    }

    #[test]
    fn a_line_has_its_length_and_width_where_nothing_hides_it() {
        let image = drawn(PARALLEL, across(2.0), WHOLE);
        // 3 of 4 units of 40 pixels, 2 pixels wide, and half a disk at each end.
        let area: f32 = image.pixels.iter().map(|pixel| pixel[0]).sum();
        assert!((area - 62.0).abs() < 2.5, "{area}");
        assert_eq!(image.pixel(20, 19), Some([1.0; 3]));
        assert_eq!(image.pixel(20, 16), Some([0.0; 3]));
    }

    #[test]
    fn spheres_hide_what_is_behind_or_inside_them() {
        for (projection, beside) in [(PARALLEL, 7), (CENTRAL, 10)] {
            for z in [0.0, -0.5] {
                let image = drawn(projection, across(z), WHOLE);
                assert_eq!(image.pixel(20, 19), Some([0.0; 3]), "{projection:?} {z}");
                assert!(image.pixel(beside, 19).unwrap()[0] > 0.9, "{projection:?} {z}");
            }
            let front = drawn(projection, across(1.2), WHOLE);
            assert_eq!(front.pixel(20, 19), Some([1.0; 3]));
        }
    }

    #[test]
    fn lines_along_the_view_get_hidden_where_they_enter() {
        // From beside the eye, through the sphere's front.
        let line = [DVec3::new(0.0, 0.9, 4.0), DVec3::new(0.0, -0.2, -3.0)];
        let image = drawn(CENTRAL, line, WHOLE);
        let lit = |y: u32| image.pixel(20, y).unwrap()[0] + image.pixel(19, y).unwrap()[0];
        assert!(lit(2) > 1.5 && lit(19) == 0.0, "{} {}", lit(2), lit(19));
    }

    #[test]
    fn a_region_is_a_part_of_the_whole_and_points_behind_the_eye_are_hidden() {
        let whole = drawn(CENTRAL, across(1.5), WHOLE);
        let region = Region { x: 11, y: 15, width: 12, height: 9 };
        let part = drawn(CENTRAL, across(1.5), region);
        for y in 0..region.height {
            for x in 0..region.width {
                assert_eq!(part.pixel(x, y), whole.pixel(x + region.x, y + region.y));
            }
        }
        for projection in [CENTRAL, PARALLEL] {
            let behind = drawn(projection, across(6.0), WHOLE);
            assert!(behind.pixels.iter().all(|pixel| *pixel == [0.0; 3]));
        }
        let through = [DVec3::new(0.0, 0.1, 20.0), DVec3::new(0.0, 2.0, 0.0)];
        assert!(drawn(CENTRAL, through, WHOLE).pixels.iter().flatten().all(|x| x.is_finite()));
    }

    #[test]
    fn lines_are_visible_in_uncovered_parts_of_pixels() {
        let pixel = Features { depth: 1.0, coverage: 0.25, ..Features::NONE };
        assert_eq!([0.5, 1.0, 2.0].map(|distance| visible(distance, &pixel)), [1.0, 1.0, 0.75]);
    }

    #[test]
    fn the_middle_of_a_line_in_the_picture_is_nearer_than_the_middle_of_the_line() {
        for (projection, middle) in [(CENTRAL, 1.5), (PARALLEL, 2.0)] {
            let (world, scene) = world(projection);
            let layers = layers(&world, &scene.settings, &Options::default(), &[]).unwrap();
            let overlay = Overlay { world: &world, region: WHOLE, layers: &layers, depths: None };
            let seen = [1.0, 3.0].map(|depth| DVec3::Z * depth * world.transform.scale);
            let line = Projected { seen, pixel: [DVec2::ZERO; 2] };
            // In perspective the harmonic mean.
            assert!((overlay.distance(&line, 0.5) - middle).abs() < 1e-12, "{projection:?}");
            let ends = [0.0, 1.0].map(|along| overlay.distance(&line, along));
            assert_eq!(ends, [1.0, 3.0], "{projection:?}");
        }
    }
}
