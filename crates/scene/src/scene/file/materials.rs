//! `[material.NAME]` and `[ground]`: materials.

use super::block::Block;
use crate::scene::keys::{Schema, Section};
use crate::scene::{FileError, Material, NamedMaterial};
use crate::suggest;
use std::collections::HashMap;

/// Name of the default material.
pub(super) const DEFAULT: &str = "default";

/// The materials of a scene that is being read, with an index by name.
#[derive(Default)]
pub(in crate::scene) struct Materials {
    rows: Vec<NamedMaterial>,
    row_of: HashMap<String, u32>,
}

impl Materials {
    /// Returns the row of the material of this name.
    pub(super) fn position(&self, name: &str) -> Option<u32> {
        self.row_of.get(name).copied()
    }

    /// Returns the row of the scene's material with this name; adds the material if there is none.
    pub(super) fn row_or_add(&mut self, material: NamedMaterial) -> u32 {
        self.position(&material.name).unwrap_or_else(|| {
            let row = self.rows.len() as u32;
            self.row_of.insert(material.name.clone(), row);
            self.rows.push(material);
            row
        })
    }

    /// Returns the help for a name that no material has.
    pub(super) fn known(&self, name: &str) -> String {
        if self.rows.is_empty() {
            return format!("write a section [material.{name}]");
        }
        suggest::help(name, self.rows.iter().map(|row| row.name.as_str()), "the scene's materials")
    }

    /// Returns whether the material of a row emits light; one that is not added yet does not.
    pub(super) fn emits(&self, row: u32) -> bool {
        let named = self.rows.get(row as usize).map(|named| &named.material);
        matches!(named, Some(Material::Emitter { .. }))
    }

    /// Returns all rows.
    pub(super) fn rows(&self) -> &[NamedMaterial] {
        &self.rows
    }

    /// Returns all rows, for the scene.
    pub(super) fn into_rows(self) -> Vec<NamedMaterial> {
        self.rows
    }
}

pub(super) fn read(root: &Block) -> Result<Materials, FileError> {
    let mut materials = Materials::default();
    for (name, block) in root.named_blocks(Schema::of::<Material>())? {
        // CSV cells are trimmed, and an empty cell names no material.
        if name.is_empty() || name.trim() != name {
            let error =
                block.error("a material's name is empty, or has leading or trailing blanks");
            return Err(error.with_help("write [material.NAME] with another name"));
        }
        let material = block.read()?;
        materials.row_or_add(NamedMaterial { name: name.to_owned(), material });
    }
    Ok(materials)
}

/// Returns the row of the material that the section of `body` names, neither glass nor an emitter,
/// which only spheres can be.
pub(in crate::scene) fn solid_row(
    block: &Block,
    materials: &mut Materials,
    body: &str,
) -> Result<u32, FileError> {
    row_but(block, materials, &["a dielectric", "an emitter"], [body, "spheres"])
}

/// Returns the row of the material that the section of a body names; some it cannot have, and others can.
pub(super) fn row_but(
    block: &Block,
    materials: &mut Materials,
    refused: &[&str],
    [body, others]: [&str; 2],
) -> Result<u32, FileError> {
    let row = row(block, materials)?;
    let kind = match materials.rows[row as usize].material {
        Material::Dielectric { .. } => "a dielectric",
        Material::Emitter { .. } => "an emitter",
        Material::Translucent { .. } => "translucent",
        _ => return Ok(row),
    };
    if !refused.contains(&kind) {
        return Ok(row);
    }
    let error = block.error_at("material", &format!("{body} cannot be {kind}"));
    Err(error.with_help(format!("name a material of another kind, or use {others}")))
}

/// Returns the row of the material that the section names, or of the default material.
pub(super) fn row(block: &Block, materials: &mut Materials) -> Result<u32, FileError> {
    let Some(value) = block.value("material") else {
        let default = NamedMaterial { name: DEFAULT.to_owned(), material: (Material::EMPTY)() };
        return Ok(materials.row_or_add(default));
    };
    let name = value.text()?;
    materials.position(name).ok_or_else(|| {
        value.error(format!("unknown material \"{name}\"")).with_help(materials.known(name))
    })
}
