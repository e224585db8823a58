//! The images of a world's lights.

use super::{CELL, FILTER_REACH, LightImage, LightImages, SeenLight};
use crate::elementary::sincos;
use crate::ray::MISS;
use crate::world::World;
use crate::world::caustics::{CausticPath, CausticSource};
use glam::{DVec2, DVec3, Vec2};
use rayon::prelude::*;

/// Most images that are searched for, so that the start stays short.
const MAX_IMAGES: usize = 1 << 14;

/// Largest radius of an image in pixels: most pixels of larger ones are even.
const MAX_RADIUS: f64 = 64.0;

/// Radius of a tiny image in pixels.
const TINY: f64 = 1.0;

/// Most images that a pixel may see, on the average of a cell. Each takes some 40 ns of a sample. With 100 lamps among 100 mirrors
/// (`spherule render --size 60x34`, this number 0 and infinite: 150 images to a pixel) tiny ones were worth it; thousands in a
/// thumbnail would take it for longer than the picture.
const CROWD: f64 = 512.0;

impl LightImages {
    /// Finds the images of a world, which is complete otherwise: none without specular spheres, and none in
    /// parallel projection or with a near plane, where rays do not start on the lens.
    pub(crate) fn find(world: &World) -> Self {
        let camera = &world.camera;
        let specular = !world.caustic_casters.is_empty();
        if camera.is_orthographic() || camera.near() > 0.0 || !specular {
            return Self::default();
        }
        let mut images = direct_images(world);
        images.extend(mirrored_images(world));
        if let Some(visible) = &world.camera_visible {
            let is_seen = |row| visible.row_of(row).is_some();
            images.retain(|image| image.light.first_sphere().is_none_or(is_seen));
        }
        let picture = [camera.width, camera.height];
        let images = without_crowds(images, picture);
        let columns = camera.width.div_ceil(CELL);
        let mut cells = vec![Vec::new(); (columns * camera.height.div_ceil(CELL)) as usize];
        for (image, number) in images.iter().zip(0..) {
            image.cells(picture).for_each(|cell| cells[cell].push(number));
        }
        let mut first = vec![0];
        let mut numbers = Vec::new();
        for cell in cells {
            numbers.extend(cell);
            first.push(numbers.len() as u32);
        }
        Self { images, first, numbers, columns }
    }
}

/// Returns images without those of lights that are seen in a crowded cell of a picture.
fn without_crowds(images: Vec<LightImage>, picture: [u32; 2]) -> Vec<LightImage> {
    let cells = picture.map(|size| size.div_ceil(CELL) as usize);
    let mut per_pixel = vec![0.0; cells[0] * cells[1]];
    for image in &images {
        let area = std::f64::consts::PI * image.reach() * image.reach();
        let share = (area / f64::from(CELL * CELL)).min(1.0);
        image.cells(picture).for_each(|cell| per_pixel[cell] += share);
    }
    if per_pixel.iter().all(|&images| images <= CROWD) {
        return images;
    }
    let crowded = |image: &LightImage| image.cells(picture).any(|cell| per_pixel[cell] > CROWD);
    let of_lights = images.chunk_by(|a, b| a.light == b.light);
    of_lights.filter(|images| !images.iter().any(crowded)).flatten().copied().collect()
}

/// Returns the images of lights that the camera sees directly.
fn direct_images(world: &World) -> Vec<LightImage> {
    let (lights, eye) = (&world.lights, world.camera.eye);
    let emitters = lights.emitters.iter().take(MAX_IMAGES).filter_map(|&row| {
        let (center, radius) = world.spheres.exact(row as usize);
        let distance = center.distance(eye);
        let image = circle(world, rim(center - eye, radius / distance).map(|rim| eye + rim));
        Some((CausticSource::Sphere(row), image.filter(|_| distance > radius)?))
    });
    // A background hides suns.
    let suns = if world.environment.background.is_none() { &lights.suns[..] } else { &[] };
    let suns = suns.iter().enumerate().filter_map(|(index, sun)| {
        let height = f64::from(sun.disc?.height());
        let sine = (height * (2.0 - height)).sqrt();
        // So far away that a lens does not matter more than for a sun.
        let far = FAR_SUN * lights.unit.max(1.0);
        let direction = sun.direction.as_dvec3() * far;
        let rim = rim(direction, sine).map(|rim| eye + rim);
        Some((CausticSource::Sun(index), circle(world, rim)?))
    });
    let light = |source| SeenLight { source, sphere: MISS, through: false };
    let image = |(source, circle): (_, Circle)| circle.image_of(light(source), circle.radius);
    emitters.chain(suns).map(image).collect()
}

/// Distance that stands for that of a sun, in units of the scene's extent.
const FAR_SUN: f64 = 1e6;

/// Returns points on the rim of a disc in the direction of a vector, with this ratio of radius to distance.
fn rim(toward: DVec3, sine: f64) -> [DVec3; 8] {
    let side = toward.any_orthonormal_vector();
    let other = toward.normalize().cross(side);
    let radius = toward.length() * sine;
    std::array::from_fn(|i| {
        let (sine, cosine) = sincos(i as f64 * std::f64::consts::FRAC_PI_4);
        toward + (side * cosine + other * sine) * radius
    })
}

/// A circle about images of points, in pixels.
struct Circle {
    center: Vec2,
    radius: f32,
    /// Added by the lens.
    blur: f32,
}

impl Circle {
    /// Returns the image of a light, within this radius without blur.
    fn image_of(&self, light: SeenLight, radius: f32) -> LightImage {
        LightImage {
            light,
            center: self.center,
            radius: radius + self.blur,
            tiny: f64::from(radius) < TINY,
        }
    }
}

/// Returns a circle about the images of points; `None` if some are behind the camera, or the circle is large
/// or outside of the picture.
fn circle(world: &World, points: impl IntoIterator<Item = DVec3>) -> Option<Circle> {
    let camera = &world.camera;
    let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
    let mut blur = 0.0;
    for point in points {
        let seen = camera.view(point);
        if seen.z <= 0.0 {
            return None;
        }
        let pixel = camera.pixel(seen);
        (low, high) = (low.min(pixel), high.max(pixel));
        blur = f64::max(blur, camera.blur(seen.z));
    }
    let (center, radius) = ((low + high) / 2.0, (high - low).length() / 2.0);
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    let reach = radius + blur + FILTER_REACH;
    let inside = (center + reach).cmpge(DVec2::ZERO).all() && (center - reach).cmple(size).all();
    let circle = Circle { center: center.as_vec2(), radius: radius as f32, blur: blur as f32 };
    (radius + blur <= MAX_RADIUS && inside).then_some(circle)
}

/// Returns the images of lights in the specular spheres that the camera may see.
fn mirrored_images(world: &World) -> Vec<LightImage> {
    let (camera, casters) = (&world.camera, &world.caustic_casters);
    let size = DVec2::new(f64::from(camera.width), f64::from(camera.height));
    let (low, high) = (DVec2::splat(-FILTER_REACH), size + FILTER_REACH);
    let visible: Vec<usize> = (0..casters.len())
        .filter(|&caster| camera.coverage(casters.sphere(caster), low, high) > 0.0)
        .take(MAX_IMAGES / casters.emitter_count().max(1))
        .collect();
    let images = visible.into_par_iter().flat_map_iter(|caster| {
        (0..casters.emitter_count()).flat_map(move |emitter| {
            CausticPath::ALL.into_iter().filter_map(move |path| {
                let (light, points) = casters.image_in(caster, emitter, path, camera.eye)?;
                let circle = circle(world, points)?;
                // The rim lies between the points.
                Some(circle.image_of(light, circle.radius * 1.25 + 0.1))
            })
        })
    });
    let mut images: Vec<LightImage> = images.collect();
    // Those of one light are neighbors.
    for images in images.chunk_by_mut(|a, b| a.light == b.light) {
        let tiny = images.iter().all(LightImage::is_tiny);
        for image in images {
            image.tiny = tiny;
        }
    }
    images
}
