//! `[[ellipsoid]]`.

use super::block::Block;
use super::materials::{self, Materials};
use super::schema;
use super::value::Limits;
use crate::scene::{Ellipsoids, FileError, Rgb};
use glam::{DQuat, DVec3};

pub(super) fn read(
    root: &Block,
    ellipsoids: &mut Ellipsoids,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks("ellipsoid", &schema::ELLIPSOID)? {
        let center = block.need("center", "center = [x, y, z]")?.point()?;
        let axes = block.need("semi_axes", "semi_axes = three numbers greater than 0")?;
        let semi_axes = DVec3::from(axes.numbers(Limits::Positive)?);
        let ratio = semi_axes.max_element() / semi_axes.min_element();
        if ratio > Ellipsoids::MAX_RATIO {
            let message = format!(
                "the longest semi-axis is {ratio} times the shortest, but at most {} fit",
                Ellipsoids::MAX_RATIO
            );
            return Err(axes.error(message));
        }
        let orientation = orientation(&block)?;
        let color = block.value("color");
        let color = color.map_or(Ok(Rgb::ONE), |value| value.color(Limits::Share))?;
        let material = materials::row(&block, materials)?;
        materials::refuse_lights_and_glass(&block, materials, material, "an ellipsoid")?;
        ellipsoids.push(center, semi_axes, orientation, material, color);
    }
    Ok(())
}

/// Reads a quaternion of any length but 0, its real part first.
fn orientation(block: &Block) -> Result<DQuat, FileError> {
    let Some(value) = block.value("orientation") else { return Ok(DQuat::IDENTITY) };
    let [w, x, y, z] = value.numbers(Limits::Any)?;
    // Scaled first: squares of large and of small numbers have no length.
    let largest = [w, x, y, z].into_iter().map(f64::abs).fold(0.0, f64::max);
    if largest == 0.0 {
        return Err(value.must_be("a quaternion [w, x, y, z] that is not 0"));
    }
    Ok(DQuat::from_xyzw(x / largest, y / largest, z / largest, w / largest).normalize())
}
