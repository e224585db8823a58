//! Descriptions of spheres: what a pointer that rests on one is told.

use super::{Labels, ROWS, digits};
use crate::graphics::Figure;
use crate::layers::{Layer, layers};
use crate::render::{Options, RenderError};
use crate::scene::{Scene, Settings};
use crate::world::World;
use glam::DVec3;
use std::collections::HashMap;
use std::fmt::Write;

/// Returns half the diagonal of the bounding box of all spheres, ellipsoids and cones of a scene; 1 if it has none.
pub fn extent(scene: &Scene) -> f64 {
    let extent = scene.bounds().map_or(0.0, |[low, high]| (high - low).length() / 2.0);
    if extent.is_finite() && extent > 0.0 { extent } else { 1.0 }
}

/// Describes the spheres of a scene.
#[derive(Clone, Debug)]
pub struct Descriptions<'l> {
    labels: &'l Labels,
    /// Differences between the maximum and the minimum of the columns of numbers.
    ranges: Vec<f64>,
    /// Size of the scene, half the diagonal of its bounding box.
    extent: f64,
}

impl<'l> Descriptions<'l> {
    /// Prepares to describe the spheres that have these labels, in a scene of this size, as of [`extent`].
    pub fn new(labels: &'l Labels, extent: f64) -> Self {
        let ranges = labels.numbers.iter().map(|column| digits::range(&column.values)).collect();
        Self { labels, ranges, extent }
    }

    /// Returns the number of the text of each pixel in a figure: that of the sphere in its middle.
    ///
    /// # Errors
    /// The camera sees nothing.
    pub fn numbers(
        &self,
        world: &World,
        settings: &Settings,
        options: &Options,
        figure: &mut Figure,
    ) -> Result<Vec<u32>, RenderError> {
        let settings = Settings { spp: 1, ..settings.clone() };
        let found = layers(world, &settings, options, &[Layer::Id])?;
        let mut numbers: HashMap<u32, u32> =
            found.pixels.iter().map(|pixel| (pixel.id, 0)).collect();
        for (row, id) in world.spheres.id.iter().enumerate() {
            if let Some(number) = numbers.get_mut(id) {
                let (center, radius) = world.sphere(row);
                *number = figure.number(&self.text(*id as usize, center, radius));
            }
        }
        Ok(found.pixels.iter().map(|pixel| numbers[&pixel.id]).collect())
    }

    /// Returns number, type, position, radius and columns of a sphere by its row.
    pub fn text(&self, row: usize, center: DVec3, radius: f64) -> String {
        let Self { labels, ranges, extent } = self;
        let [a, b, c] = center.to_array().map(|value| digits::length(value, *extent));
        let length = digits::value(radius, *extent);
        let named = labels.kind(row).map_or(String::new(), |kind| format!("type {kind}, "));
        let number = labels.id(row).unwrap_or(row as f64);
        let mut text = format!("sphere {number}: {named}at {a} {b} {c}, radius {length}");
        for (column, range) in labels.numbers.iter().zip(ranges) {
            let told = !["id", ROWS].contains(&column.name.as_str());
            if let Some(value) = column.values.get(row).filter(|_| told) {
                let value = digits::value(*value, *range);
                // Writing to a string does not fail.
                let _ = write!(text, ", {} = {value}", column.name);
            }
        }
        for column in labels.texts.iter().filter(|column| row < column.codes.len()) {
            let _ = write!(text, ", {} = {}", column.name, column.text(row));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::NumberColumn;

    #[test]
    fn columns_follow_number_place_and_radius() {
        let column =
            |name: &str, values: &[f64]| NumberColumn { name: name.into(), values: values.into() };
        let numbers = vec![column("id", &[7.0, 9.0]), column("q", &[0.5, -0.25])];
        let labels = Labels { numbers, ..Labels::default() };
        let text = Descriptions::new(&labels, 10.0).text(1, DVec3::new(1.0, 2.5, 0.0), 1.5);
        assert_eq!(text, "sphere 9: at 1 2.5 0, radius 1.5, q = -0.25");
    }
}
