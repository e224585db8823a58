//! Styles of single types of particles.

use crate::color::{self, Rgb};
use crate::scene::particles::spheres::common_color;
use crate::scene::particles::{Element, Kind, Particles};
use crate::scene::{ConductorFresnel, FileError, Material, NamedMaterial};
use crate::suggest;
use std::path::Path;
use std::str::FromStr;

/// Radiance of emitters per unit of their color: bright in front of the white environment of radiance
/// 1.
const EMISSION: f32 = 4.0;

/// Albedo of opaque materials, in addition to the particles' color.
const ALBEDO: f32 = 0.8;

/// A material for a type of particles, tinted by their color.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TypeMaterial {
    /// Ideally diffuse.
    Lambertian,
    /// Diffuse under a smooth coat of index 1.5.
    Plastic,
    /// Brushed metal: GGX of alpha 0.2.
    Metal,
    /// Smooth clear glass of index 1.5.
    Glass,
    /// A smooth mirror.
    Mirror,
    /// Emits light, four times as bright as its color; white if the particles have several colors.
    Emitter,
}

impl TypeMaterial {
    /// All materials, with their names in options.
    pub const ALL: [(&'static str, Self); 6] = [
        ("lambertian", Self::Lambertian),
        ("plastic", Self::Plastic),
        ("metal", Self::Metal),
        ("glass", Self::Glass),
        ("mirror", Self::Mirror),
        ("emitter", Self::Emitter),
    ];

    /// Returns the name in options.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, material)| *material == self).map_or("", |(name, _)| name)
    }

    /// Returns the material with this name, in any case.
    pub(in crate::scene) fn named(name: &str) -> Option<Self> {
        let found = Self::ALL.iter().find(|(own, _)| own.eq_ignore_ascii_case(name));
        found.map(|(_, material)| *material)
    }

    /// Converts to the scene's material; an emitter emits light of this color.
    pub(in crate::scene) fn material(self, color: Rgb) -> Material {
        let albedo = Rgb::splat(ALBEDO);
        match self {
            Self::Lambertian => Material::Lambertian { color: albedo },
            Self::Plastic => Material::Plastic { color: albedo, ior: 1.5 },
            Self::Metal => {
                Material::Conductor { fresnel: ConductorFresnel::Schlick(albedo), roughness: 0.2 }
            }
            Self::Glass => Material::Dielectric { ior: 1.5, color: Rgb::ONE },
            Self::Mirror => {
                Material::Conductor { fresnel: ConductorFresnel::Constant(albedo), roughness: 0.0 }
            }
            Self::Emitter => Material::Emitter { radiance: color * EMISSION, albedo: Rgb::ZERO },
        }
    }
}

/// The style of a type of particles, which overrides all other choices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TypeStyle {
    /// The type's name, or else the symbol of its element.
    pub name: String,
    /// The radius, more than 0, in the scene's unit.
    pub radius: Option<f64>,
    /// The linear color, each channel 0 to 1.
    pub color: Option<Rgb>,
    /// The material.
    pub material: Option<TypeMaterial>,
    /// The opacity, 0 to 1.
    pub opacity: Option<f64>,
    /// The element, by which radii, colors and bonds are found; it must be known as the file is read:
    /// [`ReadOptions::elements`](crate::scene::particles::ReadOptions::elements).
    pub element: Option<Element>,
}

impl FromStr for TypeStyle {
    type Err = String;

    /// Parses `NAME:radius=R,color=#rrggbb,material=NAME,opacity=A,element=O`, in which entries may be missing.
    fn from_str(text: &str) -> Result<Self, String> {
        let usage =
            "expected a type and its style, as in Na:radius=1.2,color=#ab5cf2,material=glass";
        let (name, entries) = text.rsplit_once(':').ok_or(usage)?;
        let mut style = Self { name: name.to_owned(), ..Self::default() };
        for entry in entries.split(',') {
            let (key, value) = entry.split_once('=').ok_or(usage)?;
            match key.trim() {
                "radius" => style.radius = Some(radius(value.trim())?),
                "color" => style.color = Some(color::of_name(value.trim())?),
                "material" => style.material = Some(material(value.trim())?),
                "opacity" => style.opacity = Some(opacity(value.trim())?),
                "element" => style.element = Some(element(value.trim())?),
                other => {
                    let names = ["radius", "color", "material", "opacity", "element"];
                    let near = suggest::question(other, names);
                    return Err(format!(
                        "`{other}` is not radius, color, material, opacity or element{near}"
                    ));
                }
            }
        }
        Ok(style)
    }
}

fn radius(text: &str) -> Result<f64, String> {
    let radius = text.parse().ok().filter(|radius| *radius > 0.0 && *radius < f64::INFINITY);
    radius.ok_or_else(|| format!("`{text}` is not a valid radius: write a number greater than 0"))
}

fn opacity(text: &str) -> Result<f64, String> {
    let opacity = text.parse().ok().filter(|opacity| (0.0..=1.0).contains(opacity));
    opacity.ok_or_else(|| format!("`{text}` is not a valid opacity: write a number from 0 to 1"))
}

fn element(text: &str) -> Result<Element, String> {
    Element::from_symbol(text)
        .ok_or_else(|| format!("`{text}` is not an element: write its symbol, as in O"))
}

fn material(text: &str) -> Result<TypeMaterial, String> {
    let found = TypeMaterial::ALL.iter().find(|(name, _)| *name == text);
    found.map(|(_, material)| *material).ok_or_else(|| {
        let names = TypeMaterial::ALL.map(|(name, _)| name);
        let help = suggest::help(text, names.into_iter(), "materials are");
        format!("unknown material `{text}`; {help}")
    })
}

impl TypeStyle {
    /// Checks that radius and color are in their ranges.
    pub(super) fn check(&self) -> Result<(), String> {
        let Self { name, radius, color, material: _, opacity, element: _ } = self;
        if let Some(opacity) = opacity.filter(|opacity| !(0.0..=1.0).contains(opacity)) {
            return Err(format!("`opacity` of the type `{name}` is {opacity}, but must be 0 to 1"));
        }
        if let Some(radius) = radius.filter(|radius| !(*radius > 0.0 && radius.is_finite())) {
            let must = "but must be finite and more than 0";
            return Err(format!("`radius` of the type `{name}` is {radius}, {must}"));
        }
        let valid = |color: &Rgb| (0..3).all(|channel| (0.0..=1.0).contains(&color[channel]));
        match color.filter(|color| !valid(color)) {
            Some(color) => {
                Err(format!("`color` of the type `{name}` is {color}, but must be 0 to 1"))
            }
            None => Ok(()),
        }
    }

    /// Sets radii and colors of the spheres of this type.
    pub(super) fn apply(&self, path: &Path, particles: &mut Particles) -> Result<(), FileError> {
        let rows = self.rows(path, particles)?;
        let spheres = &mut particles.spheres;
        if let Some(radius) = self.radius {
            for &row in &rows {
                spheres.radius[row] = radius;
            }
        }
        if let Some(color) = self.color {
            let count = spheres.len();
            spheres.color.resize(count, Rgb::ONE);
            for &row in &rows {
                spheres.color[row] = color;
            }
        }
        Ok(())
    }

    /// Sets the material of the spheres of this type, which have their final colors.
    pub(super) fn apply_material(
        &self,
        path: &Path,
        particles: &mut Particles,
    ) -> Result<(), FileError> {
        let Some(material) = self.material else { return Ok(()) };
        let rows = self.rows(path, particles)?;
        let color = common_color(&particles.spheres, rows.iter().copied());
        let name = format!("{}: {}", self.name, material.name());
        let material = material.material(color);
        let known = particles.materials.iter().any(|own| own.name == name);
        let row = particles.material_names.iter().position(|own| known && *own == name);
        let row = row.unwrap_or(particles.material_names.len()) as u32;
        let spheres = &mut particles.spheres;
        let count = spheres.len();
        spheres.material.resize(count, 0);
        for sphere in rows {
            spheres.material[sphere] = row;
        }
        if !known {
            particles.material_names.push(name.clone());
            particles.materials.push(NamedMaterial { name, material });
        }
        Ok(())
    }

    /// Returns the spheres of this type.
    pub(super) fn rows(&self, path: &Path, particles: &Particles) -> Result<Vec<usize>, FileError> {
        let kinds = &particles.frame.kinds;
        self.check_known(path, &kinds.table)?;
        let (chosen, codes) = (self.kinds(&kinds.table), &kinds.codes);
        Ok((0..codes.len()).filter(|&row| chosen[codes.code(row) as usize]).collect())
    }

    /// Checks that the type exists.
    pub(super) fn check_known(&self, path: &Path, table: &[Kind]) -> Result<(), FileError> {
        if self.kinds(table).contains(&true) { Ok(()) } else { Err(self.unknown(path, table)) }
    }

    /// Returns for each type of the table whether this style is for it.
    fn kinds(&self, table: &[Kind]) -> Vec<bool> {
        let named: Vec<bool> = table.iter().map(|kind| kind.name == self.name).collect();
        if named.contains(&true) {
            return named;
        }
        let symbol = |kind: &Kind| kind.element.is_some_and(|own| own.symbol() == self.name);
        table.iter().map(symbol).collect()
    }

    fn unknown(&self, path: &Path, table: &[Kind]) -> FileError {
        if table.is_empty() {
            let message = "cannot style a type: the file has no types";
            let help = "name the column of types, as in type=NAME";
            return FileError::whole_file(path, message).with_help(help);
        }
        let mut names: Vec<&str> = Vec::new();
        for kind in table {
            let symbol = kind.element.map(Element::symbol);
            for name in [kind.name.as_str()].into_iter().chain(symbol) {
                if !names.contains(&name) {
                    names.push(name);
                }
            }
        }
        let near = suggest::nearest(&self.name, names.iter().copied());
        let help = near.map_or_else(
            || format!("there are {}", suggest::list(names.iter().copied())),
            |near| format!("did you mean `{near}`?"),
        );
        let message = format!("no type is called `{}`; {help}", self.name);
        FileError::whole_file(path, message)
    }
}
