//! `[environment]`: radiance of rays that leave the scene.

use super::block::{Block, Source};
use super::value::{LIGHT, Limits, Value};
use crate::image::Image;
use crate::scene::{BRIGHTEST, Environment, EnvironmentMap, FileError, Rgb, is_radiance};
use glam::DVec3;
use std::sync::Arc;

pub(super) fn read(source: &Source, block: &Block) -> Result<Environment, FileError> {
    let color = |key, usual| block.value(key).map_or(Ok(usual), |value: Value| value.color(LIGHT));
    let up = || block.value("up").map_or(Ok(DVec3::Y), |value| value.direction());
    let map = match block.kind()? {
        "gradient" => EnvironmentMap::Gradient {
            bottom: color("bottom", Rgb::ONE)?,
            top: color("top", Rgb::new(0.5, 0.7, 1.0))?,
            up: up()?,
        },
        "picture" => {
            let file = block.need("file", "file = \"sky.hdr\": a latitude-longitude picture")?;
            let rotation = block.value("rotation");
            let scale = block.value("scale");
            let scale = scale.map_or(Ok(1.0), |value| value.single(Limits::NotNegative))?;
            EnvironmentMap::Picture {
                image: Arc::new(picture(source, &file, scale)?),
                up: up()?,
                rotation: rotation.map_or(Ok(0.0), |value| value.number(Limits::Any))?,
                scale,
            }
        }
        _ => EnvironmentMap::Constant(color("color", Rgb::ONE)?),
    };
    let illuminates = block.value("illuminates").map_or(Ok(true), |value| value.flag())?;
    Ok(Environment { map, illuminates })
}

fn picture(source: &Source, file: &Value, scale: f32) -> Result<Image, FileError> {
    let path = source.folder.join(file.text()?);
    let image = Image::read(&path).map_err(|error| file.error(error.to_string()))?;
    let valid = |value: &f32| is_radiance(*value, scale);
    if image.pixels.iter().flatten().all(valid) {
        return Ok(image);
    }
    let most = format!("{BRIGHTEST:e}");
    let message = format!("{} has radiances that are negative or more than {most}", path.display());
    let help = format!("all values of the picture, times `scale`, must be 0 to {most}");
    Err(file.error(message).with_help(help))
}
