//! `[camera]`: projection, pose and lens.

use super::block::Block;
use super::value::Limits;
use crate::scene::{Camera, FileError, Insets, Lens, Pose, Projection};
use glam::DVec3;

pub(super) fn read(block: &Block) -> Result<Camera, FileError> {
    Ok(Camera {
        projection: projection(block)?,
        pose: pose(block)?,
        up: block.value("up").map_or(Ok(DVec3::Y), |value| value.vector())?,
        lens: lens(block)?,
        near: block.value("near").map_or(Ok(0.0), |value| value.number(Limits::NotNegative))?,
        insets: insets(block)?,
    })
}

fn projection(block: &Block) -> Result<Projection, FileError> {
    if block.kind()? == "orthographic" {
        let height = block.value("height").map(|value| value.number(Limits::Positive));
        return Ok(Projection::Orthographic { height: height.transpose()? });
    }
    let fov = block.value("fov");
    let fov = fov.map_or(Ok(40.0), |value| value.number(Limits::Between(0.0, 180.0)))?;
    Ok(Projection::Perspective { fov })
}

fn pose(block: &Block) -> Result<Pose, FileError> {
    let placed = block.has("eye") || block.has("target");
    let fit = block.value("fit").map_or(Ok(!placed), |value| value.flag())?;
    if fit { read_fit(block) } else { read_look_at(block) }
}

fn read_fit(block: &Block) -> Result<Pose, FileError> {
    for key in ["eye", "target"] {
        block.forbid(key, "fit = true", || {
            "write either fit = true with a direction, or eye and target".to_owned()
        })?;
    }
    let direction = block.value("direction");
    let margin = block.value("margin");
    Ok(Pose::Fit {
        direction: direction.map_or(Ok(Camera::FIT_DIRECTION), |value| value.vector())?,
        margin: margin
            .map_or(Ok(Camera::FIT_MARGIN), |value| value.number(Limits::Below(0.0, 1.0)))?,
    })
}

fn insets(block: &Block) -> Result<Insets, FileError> {
    let Some(value) = block.value("insets") else { return Ok(Insets::default()) };
    let [left, right, bottom, top] = value.numbers(Limits::Below(0.0, 1.0))?;
    let margin = block
        .value("margin")
        .map_or(Ok(Camera::FIT_MARGIN), |value| value.number(Limits::Below(0.0, 1.0)))?;
    if left + right + margin >= 1.0 || bottom + top + margin >= 1.0 {
        let error = value.error("`insets` and the margin leave no room for the spheres");
        return Err(error.with_help("write smaller fractions of the width and the height"));
    }
    Ok(Insets { left, right, bottom, top })
}

fn read_look_at(block: &Block) -> Result<Pose, FileError> {
    for key in ["direction", "margin", "insets"] {
        block.forbid(key, "eye and target", || {
            "remove it, or write fit = true instead of eye and target".to_owned()
        })?;
    }
    let eye =
        block.need("eye", "eye = [x, y, z] and target = [x, y, z], or fit = true")?.point()?;
    let target =
        block.need("target", "target = [x, y, z]: the point in the middle of the picture")?;
    let point = target.point()?;
    if point == eye {
        let error = target.error("`target` is the same point as `eye`");
        return Err(error.with_help("write the point that is in the middle of the picture"));
    }
    Ok(Pose::LookAt { eye, target: point })
}

fn lens(block: &Block) -> Result<Option<Lens>, FileError> {
    let Some(aperture) = block.value("aperture") else {
        block.forbid("focus", "a pinhole", || {
            "write aperture = the diameter of the lens, or remove focus".to_owned()
        })?;
        return Ok(None);
    };
    let focus = block.value("focus").map(|value| value.number(Limits::Positive)).transpose()?;
    Ok(Some(Lens { aperture: aperture.number(Limits::NotNegative)?, focus }))
}
