//! `[color_bar]`, `[legend]`, `[axes]`, `[scale_bar]`, `[[label]]` and `[lettering]`: annotations of the
//! picture.

use super::block::Block;
use crate::scene::{Annotations, FileError};

/// Reads the annotations of a scene.
pub(super) fn read(root: &Block) -> Result<Annotations, FileError> {
    Ok(Annotations {
        color_bar: root.section("color_bar")?,
        legend: root.section("legend")?,
        axes: root.section("axes")?,
        scale_bar: root.section("scale_bar")?,
        labels: root.sections("label")?,
        lettering: root.section("lettering")?.unwrap_or_default(),
    })
}
