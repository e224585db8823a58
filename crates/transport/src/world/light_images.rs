//! Images of small lights in the picture: emissive spheres and suns that the camera sees directly, or by way
//! of one smooth specular sphere.
//!
//! The list says which pixels may see which light, so that more of these pixels is sampled. It need not be
//! complete, but it must not change during a render.

mod find;

use super::caustics::CausticSource;
use crate::ray::MISS;
use glam::Vec2;

/// Greatest distance of a pixel's center from what it sees with more than some percent of its weight.
const FILTER_REACH: f64 = 1.5;

/// Edge of a cell of the grid in pixels.
const CELL: u32 = 16;

/// Images of lights, by cells of the picture.
#[derive(Clone, Debug, Default)]
pub(crate) struct LightImages {
    images: Vec<LightImage>,
    /// Index of each cell's first number in `numbers`, and the end.
    first: Vec<u32>,
    /// Indices of images.
    numbers: Vec<u32>,
    columns: u32,
}

/// An image of a light, in a circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct LightImage {
    pub(crate) light: SeenLight,
    /// In pixels from the picture's top left corner.
    center: Vec2,
    /// With the blur of the lens.
    radius: f32,
    /// True if it is smaller than a pixel, blur apart.
    tiny: bool,
}

/// A light that the camera sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SeenLight {
    pub(crate) source: CausticSource,
    /// Row of the specular sphere; [`MISS`] if the light is seen directly.
    pub(crate) sphere: u32,
    /// True if it is seen through the sphere, false if it is mirrored.
    pub(crate) through: bool,
}

impl LightImage {
    /// Returns whether all images of the same light are smaller than a pixel.
    pub(crate) fn is_tiny(&self) -> bool {
        self.tiny
    }

    /// Returns whether a pixel with a filter of this radius may see the light.
    pub(crate) fn reaches(&self, [x, y]: [u32; 2], filter_radius: f32) -> bool {
        let pixel = Vec2::new(x as f32, y as f32) + 0.5;
        // The tail of a wide filter is so low that it may be left to chance.
        let corner = filter_radius * std::f32::consts::SQRT_2;
        let reach = self.radius + corner.min(FILTER_REACH as f32);
        pixel.distance_squared(self.center) <= reach * reach
    }

    /// Returns the distance in pixels from which on no pixel's center sees the light.
    fn reach(&self) -> f64 {
        f64::from(self.radius) + FILTER_REACH
    }

    /// Returns the cells of a picture whose pixels may see the light.
    fn cells(&self, [width, height]: [u32; 2]) -> impl Iterator<Item = usize> + use<> {
        let (center, reach) = (self.center.as_dvec2(), self.reach());
        let columns = width.div_ceil(CELL);
        let across = cells_between(center.x - reach, center.x + reach, width);
        let rows = cells_between(center.y - reach, center.y + reach, height);
        rows.flat_map(move |row| {
            across.clone().map(move |column| (row * columns + column) as usize)
        })
    }
}

impl SeenLight {
    /// Returns the row of the sphere that camera rays hit on their way to it; `None` for a sun that is seen directly.
    fn first_sphere(&self) -> Option<u32> {
        match (self.sphere, self.source) {
            (MISS, CausticSource::Sphere(row)) => Some(row),
            (MISS, CausticSource::Sun(_)) => None,
            (sphere, _) => Some(sphere),
        }
    }

    /// Returns the number of bounces between camera and light.
    pub(crate) fn bounces(&self) -> u32 {
        match (self.sphere, self.through) {
            (MISS, _) => 0,
            (_, false) => 1,
            (_, true) => 2,
        }
    }
}

impl LightImages {
    /// Returns whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.images.is_empty()
    }

    /// Returns the numbers of the images that pixels from `low` to below `high` may see, and perhaps of
    /// others; some of them more than once.
    pub(crate) fn near(&self, low: [u32; 2], high: [u32; 2]) -> impl Iterator<Item = u32> {
        let cells = |axis: usize| low[axis] / CELL..high[axis].div_ceil(CELL);
        let (columns, rows) = (cells(0), cells(1));
        let places = rows.flat_map(move |row| columns.clone().map(move |column| (row, column)));
        places
            .flat_map(|(row, column)| {
                let cell = (row * self.columns + column) as usize;
                &self.numbers[self.first[cell] as usize..self.first[cell + 1] as usize]
            })
            .copied()
    }

    /// Returns an image.
    pub(crate) fn image(&self, number: u32) -> LightImage {
        self.images[number as usize]
    }
}

/// Returns the cells of an axis, of `size` pixels, that lie between two places.
fn cells_between(low: f64, high: f64, size: u32) -> std::ops::Range<u32> {
    let cell = |place: f64| (place / f64::from(CELL)).max(0.0) as u32;
    if high < 0.0 { 0..0 } else { cell(low)..(cell(high) + 1).min(size.div_ceil(CELL)) }
}

#[cfg(test)]
mod tests;
