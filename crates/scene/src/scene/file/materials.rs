//! `[material.NAME]` and `[ground]`: materials.

use super::block::Block;
use super::schema;
use super::value::{LIGHT, Limits, Value};
use crate::scene::{ConductorFresnel, FileError, Ground, Material, NamedMaterial, Rgb};
use crate::suggest;
use glam::DVec3;
use std::collections::HashMap;

/// Name of the default material.
pub(super) const DEFAULT: &str = "default";

/// Default reflectance of matte materials.
const GRAY: Rgb = Rgb::splat(0.7);

/// The materials of a scene that is being read, with an index by name.
#[derive(Default)]
pub(super) struct Materials {
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
    for (name, block) in root.named_blocks("material", &schema::MATERIAL)? {
        // CSV cells are trimmed, and an empty cell names no material.
        if name.is_empty() || name.trim() != name {
            let error =
                block.error("a material's name is empty, or has leading or trailing blanks");
            return Err(error.with_help("write [material.NAME] with another name"));
        }
        let mut material = material(&block)?;
        if let Some(value) = block.value("opacity") {
            material = material.with_opacity(value.number(Limits::Share)?);
        }
        materials.row_or_add(NamedMaterial { name: name.to_owned(), material });
    }
    Ok(materials)
}

/// Reads `[ground]`, if it exists.
pub(super) fn read_ground(
    root: &Block,
    materials: &mut Materials,
) -> Result<Option<Ground>, FileError> {
    let Some(block) = root.block("ground", &schema::GROUND)? else { return Ok(None) };
    let normal = block.value("normal").map_or(Ok(DVec3::Y), |value| value.direction())?;
    let height = block.value("height").map_or(Ok(0.0), |value| value.number(Limits::Any))?;
    let material = row(&block, materials)?;
    let unsupported = match materials.rows[material as usize].material {
        Material::Dielectric { .. } => Some("a dielectric"),
        Material::Emitter { .. } => Some("an emitter"),
        Material::Translucent { .. } => Some("translucent"),
        _ => None,
    };
    if let Some(kind) = unsupported {
        let message = format!("the ground cannot be {kind}");
        let error = block.value("material").map(|value| value.error(message.as_str()));
        let error = error.unwrap_or_else(|| block.error(message));
        return Err(error.with_help("name a material of another kind, or use a sphere"));
    }
    Ok(Some(Ground { normal, height, material }))
}

/// Refuses dielectrics and emitters for `body`, which only spheres can be.
pub(super) fn refuse_lights_and_glass(
    block: &Block,
    materials: &Materials,
    row: u32,
    body: &str,
) -> Result<(), FileError> {
    let kind = match materials.rows()[row as usize].material {
        Material::Dielectric { .. } => "a dielectric",
        Material::Emitter { .. } => "an emitter",
        _ => return Ok(()),
    };
    let message = format!("{body} cannot be {kind}");
    let error = block.value("material").map(|value| value.error(message.as_str()));
    let error = error.unwrap_or_else(|| block.error(message));
    Err(error.with_help("name a material of another kind, or use spheres"))
}

/// Returns the row of the material that the section names, or of the default material.
pub(super) fn row(block: &Block, materials: &mut Materials) -> Result<u32, FileError> {
    let Some(value) = block.value("material") else {
        let material = Material::Lambertian { color: GRAY };
        return Ok(materials.row_or_add(NamedMaterial { name: DEFAULT.to_owned(), material }));
    };
    let name = value.text()?;
    materials.position(name).ok_or_else(|| {
        value.error(format!("unknown material \"{name}\"")).with_help(materials.known(name))
    })
}

fn material(block: &Block) -> Result<Material, FileError> {
    let kind = block.kind()?;
    let color =
        |key, usual| block.value(key).map_or(Ok(usual), |value: Value| value.color(Limits::Share));
    Ok(match kind {
        "lambertian" => Material::Lambertian { color: color("color", GRAY)? },
        "conductor" => {
            let roughness = block.value("roughness");
            Material::Conductor {
                fresnel: conductor(block)?,
                roughness: roughness.map_or(Ok(0.0), |value| value.number(Limits::Share))?,
            }
        }
        "dielectric" => Material::Dielectric {
            ior: ior(block, Limits::Positive)?,
            color: color("color", Rgb::ONE)?,
        },
        "plastic" => Material::Plastic {
            color: color("color", GRAY)?,
            ior: ior(block, Limits::AboveTo(1.0, f64::MAX))?,
        },
        "emitter" => {
            let radiance = block.need("radiance", "radiance = [r, g, b], or a number for white")?;
            let radiance = radiance.color(LIGHT)?;
            Material::Emitter { radiance, albedo: color("albedo", Rgb::ZERO)? }
        }
        _ => reflective(block, color("color", GRAY)?)?,
    })
}

fn ior(block: &Block, limits: Limits) -> Result<f64, FileError> {
    block.value("ior").map_or(Ok(1.5), |value| value.number(limits))
}

fn reflective(block: &Block, color: Rgb) -> Result<Material, FileError> {
    let fraction =
        |key| block.value(key).map_or(Ok(0.5), |value: Value| value.number(Limits::Share));
    let (diffuse, mirror) = (fraction("diffuse")?, fraction("mirror")?);
    if diffuse + mirror > 1.0 {
        let message = format!("the sum of `diffuse` and `mirror` is {}", diffuse + mirror);
        let at = block.value("mirror").or_else(|| block.value("diffuse"));
        let error = at.map_or_else(|| block.error(&*message), |value| value.error(&*message));
        return Err(error.with_help("the sum must be at most 1; the default of each is 0.5"));
    }
    Ok(Material::Reflective { color, diffuse, mirror })
}

fn conductor(block: &Block) -> Result<ConductorFresnel, FileError> {
    if !block.has("eta") && !block.has("k") {
        let help = "color = [r, g, b], the reflectance at normal incidence, or eta and k";
        let color = block.need("color", help)?.color(Limits::Share)?;
        let curve = block.value("fresnel");
        let curve = curve.map_or(Ok("schlick"), |value| value.choice(&["schlick", "constant"]))?;
        return Ok(if curve == "schlick" {
            ConductorFresnel::Schlick(color)
        } else {
            ConductorFresnel::Constant(color)
        });
    }
    for key in ["color", "fresnel"] {
        let help = || "write either color, or eta and k".to_owned();
        block.forbid(key, "eta and k", help)?;
    }
    let eta = block.need("eta", "eta = [r, g, b]: the real part of the index of refraction")?;
    let k = block.need("k", "k = [r, g, b]: the imaginary part of the index of refraction")?;
    Ok(ConductorFresnel::Exact { eta: eta.color(Limits::Positive)?, k: k.color(Limits::Positive)? })
}
