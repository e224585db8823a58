//! `[[light]]`: lights that are not spheres.

use super::block::Block;
use super::schema;
use super::value::{LIGHT, Limits};
use crate::scene::{FileError, Light};

/// Degrees: the sun's radius seen from the earth.
const SUN: f64 = 0.27;

pub(super) fn read(root: &Block) -> Result<Vec<Light>, FileError> {
    root.blocks("light", &schema::LIGHT)?.iter().map(light).collect()
}

fn light(block: &Block) -> Result<Light, FileError> {
    if block.kind()? == "sun" { sun(block) } else { point(block) }
}

fn sun(block: &Block) -> Result<Light, FileError> {
    let direction = block.need("direction", "direction = [x, y, z], toward the sun")?;
    let irradiance = block.need("irradiance", "irradiance = [r, g, b], or a number for white")?;
    let angular_radius = block.value("angular_radius");
    Ok(Light::Sun {
        direction: direction.direction()?,
        irradiance: irradiance.color(LIGHT)?,
        angular_radius: angular_radius
            .map_or(Ok(SUN), |value| value.number(Limits::Below(0.0, 90.0)))?,
    })
}

fn point(block: &Block) -> Result<Light, FileError> {
    let position = block.need("position", "position = [x, y, z]")?;
    let intensity = block.need("intensity", "intensity = [r, g, b], or a number for white")?;
    let falloff = block.value("falloff");
    let falloff = falloff.map_or(Ok("square"), |value| value.choice(&["square", "none"]))?;
    Ok(Light::Point {
        position: position.point()?,
        intensity: intensity.color(Limits::NotNegative)?,
        falloff: falloff == "square",
    })
}
