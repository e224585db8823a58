//! `[[style]]`: the looks of selections of the particles of all `[[file]]`s.

use super::block::Block;
use super::materials::{self, Materials};
use crate::scene::keys::{Schema, StyleKeys};
use crate::scene::particles::{
    Boundary, ColorEnds, Coloring, Model, Opacity, ParticleStyle, Particles, Properties,
    SelectedStyle,
};
use crate::scene::{FileError, NamedMaterial, Scene};
use std::path::Path;

/// Returns the style of the particles of files.
pub(super) fn read(root: &Block) -> Result<ParticleStyle, FileError> {
    let blocks = root.blocks(Schema::of::<StyleKeys>())?;
    let styles = blocks.iter().map(read_style).collect::<Result<_, _>>()?;
    // Without a style, particles of files have no bonds, also those of crystals.
    let model = Some(Model::SpaceFilling);
    Ok(ParticleStyle { styles, model, allow_empty: true, ..ParticleStyle::default() })
}

fn read_style(block: &Block) -> Result<SelectedStyle, FileError> {
    let keys: StyleKeys = block.read()?;
    let selection = keys.select.parse();
    let selection = selection.map_err(|fault: crate::scene::particles::Fault| {
        block.error_at("select", &fault.to_string())
    })?;
    let mut style = SelectedStyle { selection, properties: Properties::default() };
    let own = &mut style.properties;
    (own.model, own.material) = (keys.model, keys.material);
    (own.radius, own.scale) = (keys.radius, keys.scale);
    (own.bonds, own.bond_radius) = (keys.bonds, keys.bond_radius);
    own.opacity = keys.opacity.map(Opacity::Number);
    if let Some(text) = keys.polyhedra {
        own.set("polyhedra", &text).map_err(|message| block.error_at("polyhedra", &message))?;
    }
    match (&mut own.polyhedra, keys.polyhedra_opacity) {
        (Some(polyhedra), opacity) => polyhedra.opacity = opacity,
        (None, None) => {}
        (None, Some(_)) => {
            return Err(
                block.error_at("polyhedra_opacity", "`polyhedra_opacity` needs `polyhedra`")
            );
        }
    }
    own.visible = (!keys.visible).then_some(false);
    let log = keys.log.then(|| "yes".to_owned());
    for (name, text) in [("color", keys.color), ("map", keys.map), ("log", log)] {
        let Some(text) = text else { continue };
        own.set(name, &text).map_err(|message| block.error_at(name, &message))?;
    }
    match (&mut own.color, keys.range) {
        (Some(Coloring::Column(colors)), Some([low, high])) if low <= high => {
            colors.ends = ColorEnds::numbers(low, high);
        }
        (_, None) => {}
        (Some(Coloring::Column(_)), Some(_)) => {
            return Err(block.error_at("range", "the lower number comes first"));
        }
        _ => return Err(block.error_at("range", "`range` is for colors by a column")),
    }
    Ok(style)
}

/// Appends particles, and their bonds, in this style. `block` names the file, and the material of those without one.
pub(super) fn append(
    block: &Block,
    path: &Path,
    mut particles: Particles,
    style: &ParticleStyle,
    scene: &mut Scene,
    materials: &mut Materials,
) -> Result<(), FileError> {
    style.apply(path, &mut particles)?;
    let polyhedra = style.find_polyhedra(path, &mut particles)?;
    if !polyhedra.is_empty() {
        let boundary = Boundary { complete: Some(false), outside: None };
        let drawn = particles.draw_boundary(boundary, &polyhedra);
        drawn.map_err(|error| FileError::whole_file(path, error.to_string()))?;
    }
    for name in particles.material_names.iter().filter(|name| !name.is_empty()) {
        if let Some(row) = materials.position(name)
            && particles.materials.iter().all(|own| own.name != *name)
        {
            particles.materials.push(materials.rows()[row as usize].clone());
        }
    }
    let usual = materials::row(block, materials)?;
    let usual = materials.rows()[usual as usize].clone();
    let own = Scene::of_particles_with(particles, &path.to_string_lossy(), &usual.material);
    let mut rows = Vec::new();
    for (row, own) in own.materials.iter().enumerate() {
        let name = if row == 0 { usual.name.clone() } else { own.name.clone() };
        rows.push(materials.row_or_add(NamedMaterial { name, material: own.material.clone() }));
    }
    scene.append_bodies(&own, |row| rows[row as usize]);
    scene.spheres.append(own.spheres, &rows);
    scene.warnings.extend(own.warnings);
    Ok(())
}
