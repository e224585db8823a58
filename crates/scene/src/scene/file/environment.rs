//! `[environment]`: radiance of rays that leave the scene.

use super::block::Block;
use super::value::Source;
use super::value::Value;
use crate::image::Image;
use crate::scene::keys::EnvironmentKeys;
use crate::scene::{BRIGHTEST, Environment, EnvironmentMap, FileError, is_radiance};
use std::sync::Arc;

pub(super) fn read(source: &Source, block: &Block) -> Result<Environment, FileError> {
    let EnvironmentKeys { mut environment, .. } = block.read()?;
    if let EnvironmentMap::Picture { image, scale, .. } = &mut environment.map
        && let Some(file) = block.value("file")
    {
        *image = Arc::new(picture(source, &file, *scale)?);
    }
    Ok(environment)
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
