//! Kinds of values of keys: how each is read, written, checked and described.

use super::super::file::value::Value;
use super::super::write::sections::quoted;
use crate::scene::{Background, FileError, Rgb};
use crate::settings::Limits;
use glam::{DQuat, DVec3};
use std::mem::discriminant;
use toml::de::DeValue;

/// Tolerance of a unit vector's squared length.
const UNIT: f64 = 1e-6;

/// Type and range of a key.
pub(in crate::scene) trait Kind: Copy {
    /// The value in a section.
    type Value;

    /// Reads a value of a scene file.
    fn read(self, value: &Value) -> Result<Self::Value, FileError>;

    /// Returns the value as a scene file has it, to the last bit; `None` if the key is left out.
    fn text(self, value: &Self::Value) -> Option<String>;

    /// Returns whether a value that comes from code is valid.
    fn contains(self, _: &Self::Value) -> bool {
        true
    }

    /// Returns the values in words.
    fn words(self) -> Words;

    /// Returns the value in short, for messages and the manual.
    fn brief(self, value: &Self::Value) -> String {
        let Some(text) = self.text(value) else { return "none".to_owned() };
        let text = text.strip_suffix(".0").unwrap_or(&text);
        text.replace(".0,", ",").replace(".0]", "]")
    }
}

/// The values of a kind in words.
pub(in crate::scene) struct Words {
    /// To follow "must be", of a value that comes from code.
    pub(super) range: String,
    /// In scene files, for the manual.
    pub(super) values: String,
    /// The type in Python.
    pub(super) python: String,
}

impl Words {
    fn new(range: impl Into<String>, python: impl Into<String>) -> Self {
        let range = range.into();
        let values = range.trim_start_matches("finite and ").to_owned();
        Self { range, values, python: python.into() }
    }
}

/// A number.
#[derive(Clone, Copy)]
pub(super) struct Number(pub(super) Limits);

impl Kind for Number {
    type Value = f64;

    fn read(self, value: &Value) -> Result<f64, FileError> {
        value.number(self.0)
    }

    fn text(self, value: &f64) -> Option<String> {
        Some(format!("{value:?}"))
    }

    fn contains(self, value: &f64) -> bool {
        self.0.contain(*value)
    }

    fn words(self) -> Words {
        Words::new(self.0.describe(), "float")
    }
}

/// A number of single precision.
#[derive(Clone, Copy)]
pub(super) struct Single(pub(super) Limits);

impl Kind for Single {
    type Value = f32;

    fn read(self, value: &Value) -> Result<f32, FileError> {
        value.single(self.0)
    }

    fn text(self, value: &f32) -> Option<String> {
        Some(format!("{value:?}"))
    }

    fn contains(self, value: &f32) -> bool {
        self.0.contain((*value).into())
    }

    fn words(self) -> Words {
        Number(self.0).words()
    }
}

/// An integer, at least the first and at most the second.
#[derive(Clone, Copy)]
pub(super) struct Whole(pub(super) u64, pub(super) u64);

impl Kind for Whole {
    type Value = u64;

    fn read(self, value: &Value) -> Result<u64, FileError> {
        value.whole(self.0, self.1)
    }

    fn text(self, value: &u64) -> Option<String> {
        Some(value.to_string())
    }

    fn words(self) -> Words {
        Words::new(format!("an integer from {} to {}", self.0, self.1), "int")
    }
}

/// True or false.
#[derive(Clone, Copy)]
pub(super) struct Flag;

impl Kind for Flag {
    type Value = bool;

    fn read(self, value: &Value) -> Result<bool, FileError> {
        value.flag()
    }

    fn text(self, value: &bool) -> Option<String> {
        Some(value.to_string())
    }

    fn words(self) -> Words {
        Words::new("`true`, `false`", "bool")
    }
}

/// A string.
#[derive(Clone, Copy)]
pub(super) enum Str {
    Text,
    /// The path of a file.
    Path,
    /// The name of a material; a section has it in quotes, or as what else is to be written.
    Name,
}

impl Kind for Str {
    type Value = String;

    fn read(self, value: &Value) -> Result<String, FileError> {
        let text = value.text()?;
        Ok(if matches!(self, Self::Name) { quoted(text) } else { text.to_owned() })
    }

    fn text(self, value: &String) -> Option<String> {
        Some(if matches!(self, Self::Name) { value.clone() } else { quoted(value) })
    }

    fn words(self) -> Words {
        match self {
            Self::Text => Words::new("a string", "str"),
            Self::Path => Words::new("a path", "str | PathLike[str]"),
            Self::Name => Words::new("a name", "str"),
        }
    }
}

/// Three coordinates.
#[derive(Clone, Copy)]
pub(super) enum Triple {
    Point,
    /// A vector of any length but 0, which is kept.
    Vector,
    /// A vector of any length but 0 in scene files, and of length 1 in code.
    Direction,
}

impl Kind for Triple {
    type Value = DVec3;

    fn read(self, value: &Value) -> Result<DVec3, FileError> {
        match self {
            Self::Point => value.point(),
            Self::Vector => value.vector(),
            Self::Direction => value.direction(),
        }
    }

    fn text(self, value: &DVec3) -> Option<String> {
        Some(format!("{:?}", value.to_array()))
    }

    fn contains(self, value: &DVec3) -> bool {
        match self {
            Self::Point => value.is_finite(),
            Self::Vector => value.is_finite() && *value != DVec3::ZERO,
            Self::Direction => (value.length_squared() - 1.0).abs() <= UNIT,
        }
    }

    fn words(self) -> Words {
        let (range, values) = match self {
            Self::Point => ("a finite point", "a point"),
            Self::Vector => ("a finite vector other than 0", "a vector"),
            Self::Direction => ("a vector of length 1", "a vector"),
        };
        Words { values: values.to_owned(), ..Words::new(range, "Vector") }
    }
}

/// A color, each value within limits.
#[derive(Clone, Copy)]
pub(super) struct Color(pub(super) Limits);

impl Kind for Color {
    type Value = Rgb;

    fn read(self, value: &Value) -> Result<Rgb, FileError> {
        value.color(self.0)
    }

    fn text(self, value: &Rgb) -> Option<String> {
        Some(format!("{:?}", value.to_array()))
    }

    fn contains(self, value: &Rgb) -> bool {
        value.to_array().into_iter().all(|channel| self.0.contain(channel.into()))
    }

    fn words(self) -> Words {
        let Words { range, values, .. } = Number(self.0).words();
        let values = format!("a color, each value {values}");
        Words { values, ..Words::new(format!("{range} in each channel"), "Color") }
    }

    fn brief(self, value: &Rgb) -> String {
        let gray = *value == Rgb::splat(value.x);
        if gray { value.x.to_string() } else { value.to_string() }
    }
}

/// One of several words, with their values.
pub(super) struct Word<'a, T>(pub(super) &'a [(&'static str, T)]);

impl<T> Clone for Word<'_, T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Word<'_, T> {}

impl<T: Clone + PartialEq> Kind for Word<'_, T> {
    type Value = T;

    fn read(self, value: &Value) -> Result<T, FileError> {
        let words: Vec<_> = self.0.iter().map(|(word, _)| *word).collect();
        let word = value.choice(&words)?;
        let row = self.0.iter().find(|(own, _)| *own == word);
        row.map(|(_, own)| own.clone()).ok_or_else(|| value.error("is no word"))
    }

    fn text(self, value: &T) -> Option<String> {
        self.0.iter().find(|(_, own)| own == value).map(|(word, _)| quoted(word))
    }

    fn words(self) -> Words {
        one_of(self.0.iter().map(|(word, _)| *word))
    }
}

/// Returns the values of a kind that is one of some words.
pub(super) fn one_of(words: impl Iterator<Item = &'static str>) -> Words {
    let words: Vec<_> = words.map(|word| format!("\"{word}\"")).collect();
    let range: Vec<_> = words.iter().map(|word| format!("`{word}`")).collect();
    Words::new(range.join(", "), format!("Literal[{}]", words.join(", ")))
}

/// Returns the name of a value's variant.
pub(super) fn name_of<T>(kinds: &[(&'static str, T)], value: &T) -> &'static str {
    let row = kinds.iter().find(|(_, kind)| discriminant(kind) == discriminant(value));
    row.map_or("", |(name, _)| name)
}

/// So many values.
#[derive(Clone, Copy)]
pub(super) struct List<const N: usize, K>(pub(super) K);

impl<const N: usize, K: Kind> Kind for List<N, K> {
    type Value = [K::Value; N];

    fn read(self, value: &Value) -> Result<Self::Value, FileError> {
        let items: [Value; N] = value.list()?;
        let read: Vec<_> = items.iter().map(|item| self.0.read(item)).collect::<Result<_, _>>()?;
        read.try_into().map_err(|_| value.must_be(self.words().range))
    }

    fn text(self, value: &Self::Value) -> Option<String> {
        let texts: Vec<_> = value.iter().filter_map(|item| self.0.text(item)).collect();
        Some(format!("[{}]", texts.join(", ")))
    }

    fn contains(self, value: &Self::Value) -> bool {
        value.iter().all(|item| self.0.contains(item))
    }

    fn words(self) -> Words {
        let Words { range, values, python } = self.0.words();
        let each = |of: String| format!("a list of {N}, each {of}");
        Words { range: each(range), values: each(values), python: format!("Sequence[{python}]") }
    }
}

/// A value, or none: then there is no key.
#[derive(Clone, Copy)]
pub(super) struct Optional<K>(pub(super) K);

impl<K: Kind> Kind for Optional<K> {
    type Value = Option<K::Value>;

    fn read(self, value: &Value) -> Result<Self::Value, FileError> {
        self.0.read(value).map(Some)
    }

    fn text(self, value: &Self::Value) -> Option<String> {
        value.as_ref().and_then(|value| self.0.text(value))
    }

    fn contains(self, value: &Self::Value) -> bool {
        value.as_ref().is_none_or(|value| self.0.contains(value))
    }

    fn words(self) -> Words {
        self.0.words()
    }
}

/// A quaternion of any length but 0, its real part first.
#[derive(Clone, Copy)]
pub(super) struct Quaternion;

impl Kind for Quaternion {
    type Value = DQuat;

    fn read(self, value: &Value) -> Result<DQuat, FileError> {
        value.quaternion()
    }

    fn text(self, DQuat { x, y, z, w }: &DQuat) -> Option<String> {
        Some(format!("[{w:?}, {x:?}, {y:?}, {z:?}]"))
    }

    fn words(self) -> Words {
        Words::new("a quaternion `[w, x, y, z]` of any length but 0", "Sequence[float]")
    }
}

/// Colors with their names.
#[derive(Clone, Copy)]
pub(super) struct Entries(pub(super) Color);

impl Entries {
    fn entry(self, value: &Value) -> Result<(Rgb, String), FileError> {
        if value.item.as_array().is_none_or(|parts| parts.len() != 2) {
            return Err(value.must_be("a name and a color, as in [\"C\", \"gray\"]"));
        }
        let [name, color] = value.list()?;
        Ok((self.0.read(&color)?, name.text()?.to_owned()))
    }
}

impl Kind for Entries {
    type Value = Vec<(Rgb, String)>;

    fn read(self, value: &Value) -> Result<Self::Value, FileError> {
        let DeValue::Array(items) = value.item else {
            return Err(value.must_be("a list of names and colors, as in [[\"C\", \"gray\"]]"));
        };
        let at = |item: &toml::Spanned<DeValue>| {
            self.entry(&Value { span: item.span(), item: item.get_ref(), ..value.clone() })
        };
        items.iter().map(at).collect()
    }

    fn text(self, value: &Self::Value) -> Option<String> {
        let entry =
            |(color, name): &(Rgb, String)| format!("[{}, {:?}]", quoted(name), color.to_array());
        Some(format!("[{}]", value.iter().map(entry).collect::<Vec<_>>().join(", ")))
    }

    fn words(self) -> Words {
        let colors = self.0.words().values;
        let range = format!("a list of `[\"name\", color]`, with {colors}");
        Words::new(range, "Sequence[Sequence[Color]]")
    }
}

/// A color behind everything, or a word for what is there.
#[derive(Clone, Copy)]
pub(super) struct Backdrop(pub(super) Color);

impl Kind for Backdrop {
    type Value = Background;

    fn read(self, value: &Value) -> Result<Background, FileError> {
        match value.item.as_str() {
            Some("sky") => Ok(Background::Sky),
            Some("transparent") => Ok(Background::Transparent),
            Some(text) if crate::color::parse(text).is_none() => {
                let error = value.must_be("a color, \"sky\" or \"transparent\"");
                let words = ["sky", "transparent"].into_iter().chain(crate::color::names());
                Err(match crate::suggest::nearest(text, words) {
                    Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
                    None => error,
                })
            }
            _ => self.0.read(value).map(Background::Color),
        }
    }

    fn text(self, value: &Background) -> Option<String> {
        match value {
            Background::Sky => Some(quoted("sky")),
            Background::Transparent => Some(quoted("transparent")),
            Background::Color(color) => self.0.text(color),
        }
    }

    fn contains(self, value: &Background) -> bool {
        !matches!(value, Background::Color(color) if !self.0.contains(color))
    }

    fn words(self) -> Words {
        let words = self.0.words();
        let values = format!("`\"sky\"`, `\"transparent\"`, or {}", words.values);
        Words { values, ..words }
    }
}
