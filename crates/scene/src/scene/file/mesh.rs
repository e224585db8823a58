//! `[[mesh]]`: triangles of PLY files.

use super::block::Block;
use super::materials::{Materials, solid_row};
use super::spheres::existing;
use super::value::Source;
use crate::memory;
use crate::scene::bodies::MeshKeys;
use crate::scene::keys::Schema;
use crate::scene::{BodyColumns as _, FileError, Scene, Triangles};
use spherule_particles::internals::{Mesh, read_mesh};

/// Appends the triangles of all meshes. Those without area are left out, with a warning.
pub(super) fn read(
    source: &Source,
    root: &Block,
    scene: &mut Scene,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks(Schema::of::<MeshKeys>())? {
        let MeshKeys { path, color, scale, .. } = block.read()?;
        let path = existing(source, &block, "path", &path)?;
        let material = solid_row(&block, materials, "a mesh")?;
        let Mesh { vertices, triangles } = read_mesh(&path)?;
        let bytes = Triangles::default().bytes_each().of(triangles.len());
        memory::check(bytes.columns.saturating_add(bytes.building)).map_err(|shortage| {
            let count = triangles.len();
            block.error_at("path", &format!("asks for {count} triangles, which need {shortage}"))
        })?;
        let before = scene.triangles.len();
        for (row, corners) in triangles.iter().enumerate() {
            let corners = corners.map(|corner| vertices[corner as usize] * scale);
            if !corners.iter().all(|corner| corner.is_finite()) {
                let message = format!("triangle {row} has a corner that is not finite");
                return Err(FileError::whole_file(&path, message));
            }
            if !Triangles::are_on_a_line(corners) {
                scene.triangles.push(corners, material, color);
            }
        }
        let flat = before + triangles.len() - scene.triangles.len();
        if flat > 0 {
            let (path, all) = (path.display(), triangles.len());
            let warning =
                format!("{path}: {flat} of {all} triangles have no area, and are left out");
            scene.warnings.push(warning);
        }
    }
    Ok(())
}
