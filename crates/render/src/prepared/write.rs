//! Writing of prepared scenes.

use super::{
    ColorLengths, EnvironmentPicture, FORMAT, Header, Lengths, MAGIC, ORDER, PROGRAM, PrepareError,
};
use crate::atomic::write_atomically;
use crate::bvh::builders::Builder;
use crate::bvh::{Bvh, NodeRow};
use crate::scene::text_without_columns;
use crate::scene::{EnvironmentMap, Identity, Scene};
use crate::sealed::HashingWriter;
use crate::shade::MaterialId;
use crate::world::{Colors, Column, World};
use bytemuck::{Pod, cast_slice};
use std::io::{self, Write};
use std::path::Path;

/// Number of rows that are converted to bytes at a time.
const ROWS: usize = 1 << 10;

/// Writes a scene with its world to a file for [`super::read()`]. The spheres of `scene` are not used;
/// `identity` is that of the scene with them, and `metadata` are names and values for the metadata of
/// images.
///
/// # Errors
/// The scene has data that scene files do not support, or the file cannot be written: the old file is
/// then unchanged.
pub fn write(
    path: &Path,
    scene: &Scene,
    world: &World,
    identity: &Identity,
    metadata: &[(String, String)],
    builder: Builder,
) -> Result<(), PrepareError> {
    let head = Header {
        scene: text_without_columns(scene).map_err(PrepareError::Scene)?,
        identity: identity.clone(),
        metadata: metadata.to_vec(),
        builder,
        transform: world.transform,
        placement: world.placement,
        omitted: world.omitted(),
        lengths: Lengths::of(scene, world),
    };
    let head = postcard::to_stdvec(&(PROGRAM, ORDER.to_ne_bytes(), head));
    let head = head.map_err(io::Error::other)?;
    write_atomically(path, |writer| {
        let mut file = HashingWriter::begin(writer, &MAGIC, FORMAT, &head)?;
        write_columns(&mut file, scene, world)?;
        file.finish()
    })?;
    Ok(())
}

impl Lengths {
    fn of(scene: &Scene, world: &World) -> Self {
        let picture = match &scene.environment.map {
            EnvironmentMap::Picture { image, up, rotation, scale } => Some(EnvironmentPicture {
                width: image.width,
                height: image.height,
                up: *up,
                rotation: *rotation,
                scale: *scale,
            }),
            _ => None,
        };
        Self {
            spheres: world.spheres.len() as u64,
            nodes: world.bvh.len() as u64,
            material: match &world.appearance.material {
                Column::Uniform(id) if !world.spheres.is_empty() => Some(id.bits()),
                Column::Uniform(_) | Column::Rows(_) => None,
            },
            colors: match &world.appearance.color {
                None => ColorLengths::None,
                Some(Colors::Rows(_)) => ColorLengths::Rows,
                Some(Colors::Coded { table, .. }) => {
                    ColorLengths::Coded(table.iter().map(glam::Vec3::to_array).collect())
                }
            },
            visible: world
                .camera_visible
                .as_ref()
                .map(|visible| (visible.row.len() as u64, visible.bvh.len() as u64)),
            picture,
        }
    }
}

fn write_columns(file: &mut impl Write, scene: &Scene, world: &World) -> io::Result<()> {
    column(file, world.spheres.blocks())?;
    column(file, &world.spheres.id)?;
    nodes(file, &world.bvh)?;
    if let Column::Rows(materials) = &world.appearance.material {
        for rows in materials.chunks(ROWS) {
            column(file, &rows.iter().map(|id: &MaterialId| id.bits()).collect::<Vec<u32>>())?;
        }
    }
    match &world.appearance.color {
        None => (),
        Some(Colors::Rows(rows)) => column(file, rows)?,
        Some(Colors::Coded { codes, .. }) => column(file, codes)?,
    }
    if let Some(visible) = &world.camera_visible {
        column(file, &visible.row)?;
        nodes(file, &visible.bvh)?;
    }
    if let EnvironmentMap::Picture { image, .. } = &scene.environment.map {
        column(file, &image.pixels)?;
    }
    Ok(())
}

fn nodes(file: &mut impl Write, bvh: &Bvh) -> io::Result<()> {
    let mut rows = bvh.rows();
    loop {
        let some: Vec<NodeRow> = rows.by_ref().take(ROWS).collect();
        if some.is_empty() {
            return Ok(());
        }
        column(file, &some)?;
    }
}

fn column(file: &mut impl Write, rows: &[impl Pod]) -> io::Result<()> {
    file.write_all(cast_slice(rows))
}
