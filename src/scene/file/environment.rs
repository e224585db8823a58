//! `[environment]`: what rays see that leave the scene.

use super::block::{Block, Source};
use super::value::{Limits, Value};
use crate::image::Image;
use crate::scene::{Environment, EnvironmentMap, Rgb, SceneError};
use glam::DVec3;
use std::sync::Arc;

pub(super) fn read(source: &Source, block: &Block) -> Result<Environment, SceneError> {
    let color = |key, usual| {
        block.value(key).map_or(Ok(usual), |value: Value| value.color(Limits::NotNegative))
    };
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
            EnvironmentMap::Picture {
                image: Arc::new(picture(source, &file)?),
                up: up()?,
                rotation: rotation.map_or(Ok(0.0), |value| value.number(Limits::Any))?,
                scale: scale.map_or(Ok(1.0), |value| value.single(Limits::NotNegative))?,
            }
        }
        _ => EnvironmentMap::Constant(color("color", Rgb::ONE)?),
    };
    let illuminates = block.value("illuminates").map_or(Ok(true), |value| value.flag())?;
    Ok(Environment { map, illuminates })
}

fn picture(source: &Source, file: &Value) -> Result<Image, SceneError> {
    let path = source.folder.join(file.text()?);
    let image = Image::read(&path).map_err(|error| file.error(error.to_string()))?;
    let sound = |value: &f32| value.is_finite() && *value >= 0.0;
    if image.pixels.iter().flatten().all(sound) {
        Ok(image)
    } else {
        let message = format!("{} holds radiances that are negative or not finite", path.display());
        Err(file.error(message).with_help("a picture of the sky holds finite values of 0 or more"))
    }
}
