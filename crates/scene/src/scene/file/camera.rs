//! `[camera]`: what its keys must be together.

use super::block::Block;
use crate::scene::keys::EYE;
use crate::scene::{Camera, FileError, Insets, Pose};

pub(super) fn read(block: &Block) -> Result<Camera, FileError> {
    let placed = block.has("eye") || block.has("target");
    let fit = block.value("fit").map_or(Ok(!placed), |value| value.flag())?;
    if fit {
        for key in ["eye", "target"] {
            block.forbid(key, "fit = true", || {
                "write either fit = true with a direction, or eye and target".to_owned()
            })?;
        }
    } else {
        for key in ["direction", "margin", "insets"] {
            block.forbid(key, "eye and target", || {
                "remove it, or write fit = true instead of eye and target".to_owned()
            })?;
        }
        // The key that is missing if neither is there.
        block.need("eye", EYE)?;
    }
    if !block.has("aperture") {
        block.forbid("focus", "a pinhole", || {
            "write aperture = the diameter of the lens, or remove focus".to_owned()
        })?;
    }
    let camera: Camera = block.read()?;
    match camera.pose {
        Pose::LookAt { eye, target } if eye == target => {
            let error = block.error_at("target", "`target` is the same point as `eye`");
            Err(error.with_help("write the point that is in the middle of the picture"))
        }
        Pose::Fit { margin, .. } if is_full(&camera.insets, margin) => {
            let error =
                block.error_at("insets", "`insets` and the margin leave no room for the spheres");
            Err(error.with_help("write smaller fractions of the width and the height"))
        }
        _ => Ok(camera),
    }
}

/// Returns whether insets and margin leave nothing of the picture.
fn is_full(insets: &Insets, margin: f64) -> bool {
    let Insets { left, right, bottom, top } = insets;
    let full = |sum: f64| *insets != Insets::default() && sum + margin >= 1.0;
    full(left + right) || full(bottom + top)
}
