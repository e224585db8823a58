//! A scene and its world become a file.

use super::{ColorLengths, FORMAT, Head, Lengths, MAGIC, ORDER, PROGRAM, PrepareError, Sky};
use crate::atomic::write_atomically;
use crate::bvh::builders::Builder;
use crate::bvh::{Bvh, NodeRow};
use crate::scene::write::text_without_columns;
use crate::scene::{EnvironmentMap, Identity, Scene};
use crate::sealed::Sealing;
use crate::world::{Colors, Column, MaterialId, World};
use bytemuck::{Pod, cast_slice};
use std::io::{self, Write};
use std::path::Path;

/// Rows that are turned into bytes at a time.
const ROWS: usize = 1 << 10;

/// Writes a scene with the world that was built of it to a file that [`super::read()`] reads. The
/// spheres of `scene` are not asked for; `identity` is that of the scene with them, and `looks` are names
/// and values that the files of pictures are to list.
///
/// # Errors
/// The scene has what a scene file cannot say, or the file cannot be written: the old file is then
/// untouched.
pub fn write(
    path: &Path,
    scene: &Scene,
    world: &World,
    identity: &Identity,
    looks: &[(String, String)],
    builder: Builder,
) -> Result<(), PrepareError> {
    let head = Head {
        scene: text_without_columns(scene).map_err(PrepareError::Scene)?,
        identity: identity.clone(),
        looks: looks.to_vec(),
        builder,
        frame: world.frame,
        placement: world.placement,
        left_out: world.left_out(),
        lengths: Lengths::of(scene, world),
    };
    let head = postcard::to_stdvec(&(PROGRAM, ORDER.to_ne_bytes(), head));
    let head = head.map_err(io::Error::other)?;
    write_atomically(path, |writer| {
        let mut file = Sealing::new(writer);
        file.write_all(&MAGIC)?;
        file.write_all(&FORMAT.to_le_bytes())?;
        file.write_all(&(head.len() as u64).to_le_bytes())?;
        file.write_all(&head)?;
        write_columns(&mut file, scene, world)?;
        file.seal()
    })?;
    Ok(())
}

impl Lengths {
    fn of(scene: &Scene, world: &World) -> Self {
        let sky = match &scene.environment.map {
            EnvironmentMap::Picture { image, up, rotation, scale } => Some(Sky {
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
            seen: world
                .camera_visible
                .as_ref()
                .map(|seen| (seen.row.len() as u64, seen.bvh.len() as u64)),
            sky,
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
    if let Some(seen) = &world.camera_visible {
        column(file, &seen.row)?;
        nodes(file, &seen.bvh)?;
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
