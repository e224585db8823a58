//! Properties of the look of some particles, as options write them: `model=licorice color=gold opacity=0.5`.

use super::types::TypeMaterial;
use super::{Coloring, ColumnColors, ElementColors, Opacity};
use crate::color::{self, Rgb, Spacing};
use crate::scene::particles::{Model, Polyhedra};
use crate::{settings, suggest};
use std::str::FromStr;

/// The properties of the look of some particles. What is not given stays as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Properties {
    /// The way in which the particles and their bonds are drawn.
    pub model: Option<Model>,
    /// Source of colors.
    pub color: Option<Coloring>,
    /// Radius as it is drawn, more than 0, in the scene's unit.
    pub radius: Option<f64>,
    /// Factor on the radius that is drawn, more than 0.
    pub scale: Option<f64>,
    /// True if bonds are drawn, also by a model without them; false if none is drawn that ends at one of the particles.
    pub bonds: Option<bool>,
    /// Radius of the sticks of bonds, more than 0, in the scene's unit.
    pub bond_radius: Option<f64>,
    /// Opacity.
    pub opacity: Option<Opacity>,
    /// Coordination polyhedra of these particles, none if there are no rules, instead of those of all.
    pub polyhedra: Option<Polyhedra>,
    /// Material.
    pub material: Option<TypeMaterial>,
    /// False if the particles are not drawn.
    pub visible: Option<bool>,
}

/// The names of properties in options, with the values that they take.
pub const PROPERTIES: [(&str, &str); 14] = [
    ("model", "space-filling, ball-and-stick or licorice"),
    ("color", "a color, element, or a column or an expression over columns"),
    ("map", "the color map of a column of numbers"),
    ("range", "the ends of the map, LOW,HIGH: numbers, percentiles such as 2%, or auto"),
    ("log", "yes for a logarithmic map"),
    ("radius", "the radius as it is drawn"),
    ("scale", "a factor on the radius"),
    ("bonds", "yes or no"),
    ("bond-radius", "the radius of the sticks of bonds"),
    ("opacity", "0 to 1, or a column or an expression over columns"),
    ("polyhedra", "coordination polyhedra, as in Ti-O or Ti-O<2.5, or none"),
    ("polyhedra-opacity", "0 to 1, of their faces"),
    ("material", "lambertian, plastic, metal, glass, mirror or emitter"),
    ("visible", "yes or no"),
];

/// The words of [`Coloring::Elements`].
const SCHEMES: [(&str, ElementColors); 3] =
    [("element", ElementColors::Jmol), ("jmol", ElementColors::Jmol), ("cpk", ElementColors::Cpk)];

impl Properties {
    /// Returns whether bonds are drawn because of these properties.
    pub(super) fn draws_bonds(&self) -> bool {
        self.visible != Some(false)
            && self.bonds.unwrap_or_else(|| self.model.is_some_and(Model::draws_bonds))
    }

    /// Checks the ranges of numbers; `of` is what the properties are of, in messages.
    ///
    /// # Errors
    ///
    /// A number is out of its range.
    pub fn check(&self, of: &str) -> Result<(), String> {
        let lengths =
            [("radius", self.radius), ("scale", self.scale), ("bond_radius", self.bond_radius)];
        for (name, length) in lengths {
            if let Some(length) = length.filter(|length| !(*length > 0.0 && length.is_finite())) {
                return Err(format!(
                    "`{name}` of {of} is {length}, but must be finite and more than 0"
                ));
            }
        }
        if let Some(Opacity::Number(opacity)) = self.opacity
            && !(0.0..=1.0).contains(&opacity)
        {
            return Err(format!("`opacity` of {of} is {opacity}, but must be 0 to 1"));
        }
        let faces = self.polyhedra.as_ref().and_then(|polyhedra| polyhedra.opacity);
        if let Some(opacity) = faces.filter(|opacity| !(0.0..=1.0).contains(opacity)) {
            return Err(format!("`polyhedra_opacity` of {of} is {opacity}, but must be 0 to 1"));
        }
        let valid = |color: &Rgb| (0..3).all(|channel| (0.0..=1.0).contains(&color[channel]));
        match self.color {
            Some(Coloring::Uniform(color)) if !valid(&color) => {
                Err(format!("`color` of {of} is {color}, but must be 0 to 1"))
            }
            _ => Ok(()),
        }
    }

    /// Sets a property by its name, in the text of an option.
    ///
    /// # Errors
    ///
    /// There is no such property, or no such value of it.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        match name {
            "model" => self.model = Some(model(value)?),
            "color" => self.color = Some(coloring(value)?),
            "map" => {
                self.numbers(name)?.set_map(value)?;
            }
            "range" => self.numbers(name)?.ends = value.parse()?,
            "log" => {
                self.numbers(name)?.spacing =
                    if flag(value)? { Spacing::Logarithmic } else { Spacing::Linear };
            }
            "radius" => self.radius = Some(positive("radius", value)?),
            "scale" => self.scale = Some(positive("scale", value)?),
            "bonds" => self.bonds = Some(flag(value)?),
            "bond-radius" => self.bond_radius = Some(positive("bond radius", value)?),
            "opacity" => self.opacity = Some(value.parse()?),
            "polyhedra" => {
                let none = matches!(value, "none" | "no");
                self.polyhedra = Some(if none { Polyhedra::default() } else { value.parse()? });
            }
            "polyhedra-opacity" => match &mut self.polyhedra {
                Some(polyhedra) => polyhedra.opacity = Some(share(value)?),
                None => {
                    return Err(format!("`{name}` is for polyhedra: write it after polyhedra=A-B"));
                }
            },
            "material" => self.material = Some(TypeMaterial::of_word(value)?),
            "visible" => self.visible = Some(flag(value)?),
            other => {
                let names = PROPERTIES.map(|(name, _)| name);
                let help = suggest::help(other, names.into_iter(), "properties are");
                return Err(format!("`{other}` is no property; {help}"));
            }
        }
        Ok(())
    }

    /// Returns the colors by a column, for a property of maps that comes after them.
    fn numbers(&mut self, name: &str) -> Result<&mut ColumnColors, String> {
        match &mut self.color {
            Some(Coloring::Column(colors)) => Ok(colors),
            _ => Err(format!("`{name}` is for colors by a column: write it after color=COLUMN")),
        }
    }

    /// Sets properties as options write them: `name=value`, with blanks or commas between them. A value ends where the next
    /// name begins, so that it may hold blanks.
    ///
    /// # Errors
    ///
    /// A text that is none of that, or what [`Properties::set`] refuses.
    pub(super) fn set_all(&mut self, text: &str) -> Result<(), String> {
        for (name, value) in entries(text)? {
            self.set(name, value)?;
        }
        Ok(())
    }
}

/// Returns the names and values of `name=value`, separated by blanks or commas.
pub(super) fn entries(text: &str) -> Result<Vec<(&str, &str)>, String> {
    let mut found = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        let Some(length) = name_length(rest) else {
            return Err(format!(
                "expected a property and its value, as in color=gold, before `{rest}`"
            ));
        };
        let (name, after) = (&rest[..length], &rest[length + 1..]);
        let begins = |at: usize| {
            let before = after[..at].ends_with([' ', '\t', ',']);
            before && name_length(&after[at..]).is_some()
        };
        let end = (0..after.len()).find(|&at| after.is_char_boundary(at) && begins(at));
        let (value, next) = after.split_at(end.unwrap_or(after.len()));
        let separators = |letter: char| letter == ',' || letter.is_whitespace();
        let value = value.trim_matches(separators);
        if value.is_empty() {
            return Err(format!("`{name}=` has no value"));
        }
        found.push((name, value));
        rest = next.trim_start();
    }
    Ok(found)
}

/// Returns the length of the name before `=` with which a text begins, if it does; `==` is a comparison.
fn name_length(text: &str) -> Option<usize> {
    let is_letter = |letter: char| letter.is_ascii_alphabetic() || letter == '-' || letter == '_';
    let length = text.find(|letter| !is_letter(letter)).filter(|length| *length > 0)?;
    (text[length..].starts_with('=') && !text[length..].starts_with("==")).then_some(length)
}

fn model(text: &str) -> Result<Model, String> {
    Model::named(text).ok_or_else(|| {
        let names = Model::ALL.map(|(name, _)| name);
        format!("unknown model `{text}`; {}", suggest::help(text, names.into_iter(), "models are"))
    })
}

fn coloring(text: &str) -> Result<Coloring, String> {
    if let Some((_, scheme)) = SCHEMES.iter().find(|(name, _)| *name == text) {
        return Ok(Coloring::Elements(*scheme));
    }
    if text.starts_with('#') || color::parse(text).is_some() {
        return color::of_name(text).map(Coloring::Uniform);
    }
    Ok(Coloring::Column(ColumnColors { column: text.to_owned(), ..ColumnColors::default() }))
}

fn positive(what: &str, text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number| *number > 0.0 && *number < f64::INFINITY);
    number.ok_or_else(|| format!("`{text}` is not a valid {what}: write a number greater than 0"))
}

fn share(text: &str) -> Result<f64, String> {
    let share = settings::share(text).filter(|share| (0.0..=1.0).contains(share));
    share.ok_or_else(|| format!("`{text}` is not an opacity: write a number from 0 to 1"))
}

fn flag(text: &str) -> Result<bool, String> {
    match text {
        "yes" | "true" => Ok(true),
        "no" | "none" | "false" => Ok(false),
        _ => Err(format!("`{text}` is neither yes nor no")),
    }
}

impl FromStr for Properties {
    type Err = String;

    /// Parses properties with their values, as in `model=licorice color=charge map=coolwarm range=-1,1`.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut properties = Self::default();
        properties.set_all(text)?;
        Ok(properties)
    }
}
