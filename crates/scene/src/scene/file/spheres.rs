//! `[[sphere]]`, `[[generate]]` and `[[file]]`: the spheres, in this order.

use super::block::Block;
use super::materials::{self, Materials};
use super::styles;
use super::value::Source;
use crate::memory;
use crate::scene::keys::{FileKeys, GenerateKeys, Schema, SphereKeys, StyleKeys};
use crate::scene::particles::{self, BondSource, Columns, ParticleStyle, Radii, ReadOptions};
use crate::scene::{BodyColumns as _, Ellipsoids, Footprint};
use crate::scene::{FileError, Scene, Spheres};
use std::path::PathBuf;

pub(super) fn read(
    source: &Source,
    root: &Block,
    scene: &mut Scene,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks(Schema::of::<SphereKeys>())? {
        let SphereKeys { center, radius, color, .. } = block.read()?;
        scene.spheres.push(center, radius, materials::row(&block, materials)?, color);
    }
    for block in root.blocks(Schema::of::<GenerateKeys>())? {
        read_generate(&block, &mut scene.spheres, materials)?;
    }
    let style = styles::read(root)?;
    let files = root.blocks(Schema::of::<FileKeys>())?;
    if let (Some(block), true) = (root.blocks(Schema::of::<StyleKeys>())?.first(), files.is_empty())
    {
        return Err(block.error_at(
            "select",
            "`[[style]]` is of the particles of `[[file]]`, and there is none",
        ));
    }
    for block in files {
        read_file(source, &block, &style, scene, materials)?;
    }
    Ok(())
}

fn read_generate(
    block: &Block,
    spheres: &mut Spheres,
    materials: &mut Materials,
) -> Result<(), FileError> {
    let GenerateKeys { generator, seed, .. } = block.read()?;
    let own = block.has("material").then(|| materials::row(block, materials));
    let row = match &own {
        Some(Ok(row)) => *row,
        _ => materials.position(materials::DEFAULT).unwrap_or(materials.rows().len() as u32),
    };
    let mut added = generator.footprint();
    let emits = !added.materials && materials.emits(row);
    added.emitters = if emits { added.spheres } else { 0 };
    added.materials |= row > 0;
    check_capacity(spheres, &added, 0, materials).map_err(|message| {
        block.error_at(if block.has("count") { "count" } else { "level" }, &message)
    })?;
    let group = generator.generate(seed).map_err(|error| {
        let message = format!("`{}` {}", error.parameter, error.message);
        block.error_at(error.parameter, &message)
    })?;
    let rows = match own {
        _ if !group.materials.is_empty() => {
            let add = |own| materials.row_or_add(own);
            group.materials.into_iter().map(add).collect()
        }
        Some(row) => vec![row?],
        None => vec![materials::row(block, materials)?],
    };
    spheres.append(group.spheres, &rows);
    Ok(())
}

fn read_file(
    source: &Source,
    block: &Block,
    style: &ParticleStyle,
    scene: &mut Scene,
    materials: &mut Materials,
) -> Result<(), FileError> {
    let FileKeys { path, format, topology, radius, scale, .. } = block.read()?;
    let topology = topology.map(|file| existing(source, block, "topology", &file)).transpose()?;
    let is_styled = !style.styles.is_empty();
    let columns = Columns { wanted: style.columns(), ..Columns::default() };
    let bonds = if is_styled { style.bond_source() } else { BondSource::default() };
    let options = ReadOptions {
        format,
        topology,
        columns,
        bonds,
        radii: radius.map_or(Radii::Auto, Radii::Missing),
        scale,
        ..ReadOptions::default()
    };
    let path = existing(source, block, "path", &path)?;
    let mut particles = particles::read(&path, &options)?;
    let others = Ellipsoids::default().bytes_each().of(particles.frame.shapes.semi_axes.len());
    let added = Footprint { others, ..Footprint::of_columns(&particles.spheres, &[]) };
    check_capacity(&scene.spheres, &added, added.scene(), materials)
        .map_err(|message| block.error_at("path", &message))?;
    if is_styled {
        return styles::append(block, &path, particles, style, scene, materials);
    }
    let mut rows = Vec::new();
    for name in &particles.material_names {
        rows.push(if name.is_empty() {
            materials::row(block, materials)?
        } else {
            materials.position(name).ok_or_else(|| {
                let message = format!("{} names an unknown material \"{name}\"", path.display());
                block.error_at("path", &message).with_help(materials.known(name))
            })?
        });
    }
    let ellipsoids = particles.take_ellipsoids(materials.rows(), &rows, &path.to_string_lossy());
    scene.ellipsoids.append(ellipsoids, |row| row);
    scene.spheres.append(particles.spheres, &rows);
    scene.warnings.extend(particles.frame.warnings);
    Ok(())
}

/// Returns the path of a file that a key names.
pub(super) fn existing(
    source: &Source,
    block: &Block,
    key: &'static str,
    file: &str,
) -> Result<PathBuf, FileError> {
    let path = source.folder.join(file);
    if path.is_file() {
        return Ok(path);
    }
    let error = block.error_at(key, &format!("file not found: {}", path.display()));
    Err(error.with_help("paths are relative to the folder of the scene file"))
}

/// Checks that a scene can hold more spheres, of which `held` bytes are allocated already; the error
/// says what is missing.
fn check_capacity(
    before: &Spheres,
    added: &Footprint,
    held: u64,
    materials: &Materials,
) -> Result<(), String> {
    let before = Footprint::of_columns(before, materials.rows());
    let (total, added) = (before.with(added), added.spheres);
    if total.spheres <= Spheres::MAX {
        // The columns here, and then the world's: fail before a long wait if memory cannot suffice.
        let need = total.peak().saturating_sub(before.scene()).saturating_sub(held);
        return memory::check(need)
            .map_err(|shortage| format!("asks for {added} spheres, which need {shortage}"));
    }
    let most = Spheres::MAX;
    let amount = if added == u64::MAX { "more than 1e19".to_owned() } else { added.to_string() };
    Err(format!("asks for {amount} spheres; a scene holds at most {most} in total"))
}
