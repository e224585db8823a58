//! Styles of single types of particles.

use super::Properties;
use super::properties::entries;
use crate::color::Rgb;
use crate::scene::particles::{Element, Kind, Particles};
use crate::scene::{ConductorFresnel, FileError, Material, NamedMaterial, Spheres};
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

    /// Returns the material with this name.
    ///
    /// # Errors
    ///
    /// There is none; the names.
    pub fn of_word(name: &str) -> Result<Self, String> {
        let found = Self::ALL.iter().find(|(own, _)| *own == name);
        found.map(|(_, material)| *material).ok_or_else(|| {
            let names = Self::ALL.map(|(name, _)| name);
            let help = suggest::help(name, names.into_iter(), "materials are");
            format!("unknown material `{name}`; {help}")
        })
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

/// The style of a type of particles: a short form of a style of the selection of the type.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TypeStyle {
    /// The type's name, or else the symbol of its element.
    pub name: String,
    /// The properties.
    pub properties: Properties,
    /// The element, by which radii, colors and bonds are found; it must be known as the file is read:
    /// [`ReadOptions::elements`](crate::scene::particles::ReadOptions::elements).
    pub element: Option<Element>,
}

impl Particles {
    /// Returns the material of a row of `material_names`: one that was chosen, or one that the file
    /// names by a word of [`TypeMaterial`].
    pub(in crate::scene) fn own_material(&self, row: u32) -> Option<NamedMaterial> {
        let name = &self.material_names[row as usize];
        let chosen = self.materials.iter().find(|material| material.name == *name);
        chosen.cloned().or_else(|| {
            let spheres = &self.spheres;
            let rows = (0..spheres.len()).filter(|&sphere| spheres.material_of(sphere) == row);
            let color = common_color(spheres, rows);
            let material = TypeMaterial::named(name)?.material(color);
            Some(NamedMaterial { name: name.clone(), material })
        })
    }
}

/// Returns the color that these spheres have in common, or white if they have several.
pub(super) fn common_color(spheres: &Spheres, rows: impl Iterator<Item = usize>) -> Rgb {
    let mut colors = rows.map(|row| spheres.color_of(row));
    let first = colors.next().unwrap_or(Rgb::ONE);
    if colors.all(|color| color == first) { first } else { Rgb::ONE }
}

impl FromStr for TypeStyle {
    type Err = String;

    /// Parses `NAME:radius=R,color=#rrggbb,material=NAME,opacity=A,element=O`: any of the [`Properties`], and the element.
    fn from_str(text: &str) -> Result<Self, String> {
        let usage =
            "expected a type and its style, as in Na:radius=1.2,color=#ab5cf2,material=glass";
        // Names may hold colons; so may opacities of columns.
        let is_end = |at: &usize| entries(&text[at + 1..]).is_ok_and(|found| !found.is_empty());
        let mut colons = text.match_indices(':').map(|(at, _)| at);
        let at = colons.clone().find(is_end).or_else(|| colons.next_back()).ok_or(usage)?;
        let mut style = Self { name: text[..at].to_owned(), ..Self::default() };
        let found = entries(&text[at + 1..]).map_err(|_| usage)?;
        if found.is_empty() {
            return Err(usage.to_owned());
        }
        for (name, value) in found {
            match name {
                "element" => style.element = Some(element(value)?),
                _ => style.properties.set(name, value)?,
            }
        }
        Ok(style)
    }
}

fn element(text: &str) -> Result<Element, String> {
    Element::from_symbol(text)
        .ok_or_else(|| format!("`{text}` is not an element: write its symbol, as in O"))
}

impl TypeStyle {
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
