//! Kinds of values of keys: how each is read, written, checked and described.

use super::super::file::value::Value;
use crate::color::Map;
use crate::scene::{Background, FileError, LetterSize, Rgb};
use crate::settings::Limits;
use glam::{DQuat, DVec3};
use std::fmt::Debug;
use std::mem::discriminant;
use toml::de::DeValue;

/// Tolerance of a unit vector's squared length.
const UNIT: f64 = 1e-6;

/// Range of a key whose values are of a type.
pub(in crate::scene) trait Kind<T: Debug> {
    /// Reads a value of a scene file.
    fn read(&self, value: &Value) -> Result<T, FileError>;

    /// Returns the value as a scene file has it, to the last bit; `None` if the key is left out.
    fn text(&self, value: &T) -> Option<String> {
        Some(format!("{value:?}"))
    }

    /// Returns whether a value that comes from code is valid.
    fn contains(&self, _: &T) -> bool {
        true
    }

    /// Returns the values in words.
    fn words(&self) -> Words;

    /// Returns the value in short, for messages and the manual.
    fn brief(&self, value: &T) -> String {
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

/// A number of a key, which is read in its own precision, so that it survives writing and reading.
pub(in crate::scene) trait Number: Copy + Debug + Into<f64> {
    fn read(value: &Value, limits: Limits) -> Result<Self, FileError>;
}

impl Number for f64 {
    fn read(value: &Value, limits: Limits) -> Result<Self, FileError> {
        value.number(limits)
    }
}

impl Number for f32 {
    fn read(value: &Value, limits: Limits) -> Result<Self, FileError> {
        value.single(limits)
    }
}

impl<T: Number> Kind<T> for Limits {
    fn read(&self, value: &Value) -> Result<T, FileError> {
        T::read(value, *self)
    }

    fn contains(&self, value: &T) -> bool {
        self.contain((*value).into())
    }

    fn words(&self) -> Words {
        Words::new(self.describe(), "float")
    }
}

/// The limits are those of each channel.
impl Kind<Rgb> for Limits {
    fn read(&self, value: &Value) -> Result<Rgb, FileError> {
        value.color(*self)
    }

    fn text(&self, value: &Rgb) -> Option<String> {
        Some(format!("{:?}", value.to_array()))
    }

    fn contains(&self, value: &Rgb) -> bool {
        value.to_array().into_iter().all(|channel| self.contain(channel.into()))
    }

    fn words(&self) -> Words {
        let Words { range, values, .. } = Kind::<f64>::words(self);
        let values = format!("a color, each value {values}");
        Words { values, ..Words::new(format!("{range} in each channel"), "Color") }
    }

    fn brief(&self, value: &Rgb) -> String {
        let gray = *value == Rgb::splat(value.x);
        if gray { value.x.to_string() } else { value.to_string() }
    }
}

/// An integer, at least the first and at most the second.
#[derive(Clone, Copy)]
pub(super) struct Whole(pub(super) u64, pub(super) u64);

impl Kind<u64> for Whole {
    fn read(&self, value: &Value) -> Result<u64, FileError> {
        value.whole(self.0, self.1)
    }

    fn words(&self) -> Words {
        Words::new(format!("an integer from {} to {}", self.0, self.1), "int")
    }
}

/// True or false.
pub(super) struct Flag;

impl Kind<bool> for Flag {
    fn read(&self, value: &Value) -> Result<bool, FileError> {
        value.flag()
    }

    fn words(&self) -> Words {
        Words::new("`true`, `false`", "bool")
    }
}

/// A string.
pub(in crate::scene) enum Str {
    Text,
    /// The path of a file.
    Path,
    /// The name of a material; a section has it in quotes, or as what else is to be written.
    Name,
}

impl Kind<String> for Str {
    fn read(&self, value: &Value) -> Result<String, FileError> {
        let text = value.text()?;
        Ok(if matches!(self, Self::Name) { quoted(text) } else { text.to_owned() })
    }

    fn text(&self, value: &String) -> Option<String> {
        Some(if matches!(self, Self::Name) { value.clone() } else { quoted(value) })
    }

    fn words(&self) -> Words {
        match self {
            Self::Text => Words::new("a string", "str"),
            Self::Path => Words::new("a path", "str | PathLike[str]"),
            Self::Name => Words::new("a name", "str"),
        }
    }
}

/// Three coordinates.
pub(in crate::scene) enum Triple {
    Point,
    /// A vector of any length but 0, which is kept.
    Vector,
    /// A vector of any length but 0 in scene files, and of length 1 in code.
    Direction,
}

impl Kind<DVec3> for Triple {
    fn read(&self, value: &Value) -> Result<DVec3, FileError> {
        let vector: [f64; 3] = List(Limits::Any).read(value)?;
        match (self, DVec3::from_array(vector)) {
            (Self::Vector | Self::Direction, DVec3::ZERO) => Err(value.must_be("a nonzero vector")),
            (Self::Direction, vector) => Ok(unit(vector)),
            (_, vector) => Ok(vector),
        }
    }

    fn text(&self, value: &DVec3) -> Option<String> {
        Some(format!("{:?}", value.to_array()))
    }

    fn contains(&self, value: &DVec3) -> bool {
        match self {
            Self::Point => value.is_finite(),
            Self::Vector => value.is_finite() && *value != DVec3::ZERO,
            Self::Direction => (value.length_squared() - 1.0).abs() <= UNIT,
        }
    }

    fn words(&self) -> Words {
        let (range, values) = match self {
            Self::Point => ("a finite point", "a point"),
            Self::Vector => ("a finite vector other than 0", "a vector"),
            Self::Direction => ("a vector of length 1", "a vector"),
        };
        Words { values: values.to_owned(), ..Words::new(range, "Vector") }
    }
}

/// Normalizes a vector that is finite and not zero. One of length 1 up to rounding stays as it is, so
/// that writing and reading a scene changes nothing.
fn unit(vector: DVec3) -> DVec3 {
    if (vector.length_squared() - 1.0).abs() <= 4.0 * f64::EPSILON {
        return vector;
    }
    // Squares of components could overflow or vanish.
    (vector / vector.abs().max_element()).normalize()
}

/// A quaternion of any length but 0, its real part first.
pub(in crate::scene) struct Quaternion;

impl Kind<DQuat> for Quaternion {
    fn read(&self, value: &Value) -> Result<DQuat, FileError> {
        let [w, x, y, z] = List(Limits::Any).read(value)?;
        // Scaled first: squares of large and of small numbers have no length.
        let largest = [w, x, y, z].into_iter().map(f64::abs).fold(0.0, f64::max);
        if largest == 0.0 {
            return Err(value.must_be("a quaternion [w, x, y, z] that is not 0"));
        }
        Ok(DQuat::from_xyzw(x / largest, y / largest, z / largest, w / largest).normalize())
    }

    fn text(&self, DQuat { x, y, z, w }: &DQuat) -> Option<String> {
        Some(format!("[{w:?}, {x:?}, {y:?}, {z:?}]"))
    }

    fn words(&self) -> Words {
        Words::new("a quaternion `[w, x, y, z]` of any length but 0", "Sequence[float]")
    }
}

/// One of several words, with their values.
pub(super) struct Word<'a, T>(pub(super) &'a [(&'static str, T)]);

impl<T: Clone + Debug + PartialEq> Kind<T> for Word<'_, T> {
    fn read(&self, value: &Value) -> Result<T, FileError> {
        let words: Vec<_> = self.0.iter().map(|(word, _)| *word).collect();
        let word = value.choice(&words)?;
        let row = self.0.iter().find(|(own, _)| *own == word);
        row.map(|(_, own)| own.clone()).ok_or_else(|| value.error("is no word"))
    }

    fn text(&self, value: &T) -> Option<String> {
        self.0.iter().find(|(_, own)| own == value).map(|(word, _)| quoted(word))
    }

    fn words(&self) -> Words {
        one_of(self.0.iter().map(|(word, _)| *word))
    }
}

/// A color map: its name, or colors.
pub(super) struct MapName;

impl Kind<Map> for MapName {
    fn read(&self, value: &Value) -> Result<Map, FileError> {
        value.text()?.parse().map_err(|why: String| value.error(why))
    }

    fn text(&self, value: &Map) -> Option<String> {
        Some(quoted(value.name()))
    }

    fn words(&self) -> Words {
        let Words { range, python, .. } = one_of(Map::ALL.into_iter().map(Map::name));
        Words::new(
            format!("{range}, or colors as in `\"navy,white,firebrick\"`"),
            format!("{python} | str"),
        )
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

/// Several values of a kind.
pub(in crate::scene) struct List<K>(pub(in crate::scene) K);

impl<T: Debug, const N: usize, K: Kind<T>> Kind<[T; N]> for List<K> {
    fn read(&self, value: &Value) -> Result<[T; N], FileError> {
        let items: [Value; N] = value.list()?;
        let read: Vec<_> = items.iter().map(|item| self.0.read(item)).collect::<Result<_, _>>()?;
        read.try_into().map_err(|_| value.error("has another length"))
    }

    fn text(&self, value: &[T; N]) -> Option<String> {
        let texts: Vec<_> = value.iter().filter_map(|item| self.0.text(item)).collect();
        Some(format!("[{}]", texts.join(", ")))
    }

    fn contains(&self, value: &[T; N]) -> bool {
        value.iter().all(|item| self.0.contains(item))
    }

    fn words(&self) -> Words {
        let Words { range, values, python } = self.0.words();
        let each = |of: String| format!("a list of {N}, each {of}");
        Words { range: each(range), values: each(values), python: format!("Sequence[{python}]") }
    }
}

/// A value, or none: then there is no key.
pub(in crate::scene) struct Optional<K>(pub(in crate::scene) K);

impl<T: Debug, K: Kind<T>> Kind<Option<T>> for Optional<K> {
    fn read(&self, value: &Value) -> Result<Option<T>, FileError> {
        self.0.read(value).map(Some)
    }

    fn text(&self, value: &Option<T>) -> Option<String> {
        value.as_ref().and_then(|value| self.0.text(value))
    }

    fn contains(&self, value: &Option<T>) -> bool {
        value.as_ref().is_none_or(|value| self.0.contains(value))
    }

    fn words(&self) -> Words {
        self.0.words()
    }
}

/// The size of letters.
pub(super) struct Letters;

impl Kind<LetterSize> for Letters {
    fn read(&self, value: &Value) -> Result<LetterSize, FileError> {
        let size = match value.item {
            DeValue::String(text) => text.parse().ok(),
            _ => value.number(Limits::Any).ok().map(LetterSize::Share),
        };
        size.filter(|size| size.is_valid()).ok_or_else(|| value.must_be(LetterSize::WORDS))
    }

    fn text(&self, value: &LetterSize) -> Option<String> {
        Some(match value {
            LetterSize::Share(share) => format!("{share:?}"),
            LetterSize::Length(length) => quoted(&length.to_string()),
        })
    }

    fn contains(&self, value: &LetterSize) -> bool {
        value.is_valid()
    }

    fn words(&self) -> Words {
        Words::new(LetterSize::WORDS, "float | str")
    }
}

/// Colors with their names; the limits are those of each channel.
pub(super) struct Entries(pub(super) Limits);

impl Kind<Vec<(Rgb, String)>> for Entries {
    fn read(&self, value: &Value) -> Result<Vec<(Rgb, String)>, FileError> {
        let DeValue::Array(items) = value.item else {
            return Err(value.must_be("a list of names and colors, as in [[\"C\", \"gray\"]]"));
        };
        let entry = |item: &toml::Spanned<DeValue>| {
            let entry = Value { span: item.span(), item: item.get_ref(), ..value.clone() };
            if entry.item.as_array().is_none_or(|parts| parts.len() != 2) {
                return Err(entry.must_be("a name and a color, as in [\"C\", \"gray\"]"));
            }
            let [name, color] = entry.list()?;
            Ok((color.color(self.0)?, name.text()?.to_owned()))
        };
        items.iter().map(entry).collect()
    }

    fn text(&self, value: &Vec<(Rgb, String)>) -> Option<String> {
        let entry =
            |(color, name): &(Rgb, String)| format!("[{}, {:?}]", quoted(name), color.to_array());
        Some(format!("[{}]", value.iter().map(entry).collect::<Vec<_>>().join(", ")))
    }

    fn words(&self) -> Words {
        let colors = Kind::<Rgb>::words(&self.0).values;
        let range = format!("a list of `[\"name\", color]`, with {colors}");
        Words::new(range, "Sequence[Sequence[Color]]")
    }
}

/// A number of points, at least the first and at most the second.
pub(super) struct Points(pub(super) usize, pub(super) usize);

impl Kind<Vec<DVec3>> for Points {
    fn read(&self, value: &Value) -> Result<Vec<DVec3>, FileError> {
        let items = value.item.as_array().filter(|items| (self.0..=self.1).contains(&items.len()));
        let Some(items) = items else {
            return Err(
                value.must_be(format!("a list of {} to {} points [x, y, z]", self.0, self.1))
            );
        };
        let point = |item: &toml::Spanned<DeValue>| {
            let item = Value { span: item.span(), item: item.get_ref(), ..value.clone() };
            Triple::Point.read(&item)
        };
        items.iter().map(point).collect()
    }

    fn text(&self, value: &Vec<DVec3>) -> Option<String> {
        let points: Vec<_> = value.iter().filter_map(|point| Triple::Point.text(point)).collect();
        Some(format!("[{}]", points.join(", ")))
    }

    fn contains(&self, value: &Vec<DVec3>) -> bool {
        (self.0..=self.1).contains(&value.len()) && value.iter().all(|point| point.is_finite())
    }

    fn words(&self) -> Words {
        Words::new(format!("a list of {} to {} points", self.0, self.1), "Sequence[Vector]")
    }
}

/// A color behind everything, or a word for what is there.
pub(super) struct Backdrop(pub(super) Limits);

impl Kind<Background> for Backdrop {
    fn read(&self, value: &Value) -> Result<Background, FileError> {
        match value.item.as_str() {
            Some("sky") => Ok(Background::Sky),
            Some("transparent") => Ok(Background::Transparent),
            Some(text) if crate::color::parse(text).is_none() => {
                let expected = "a color, \"sky\" or \"transparent\"";
                Err(value.must_be_color(expected, text, &["sky", "transparent"]))
            }
            _ => value.color(self.0).map(Background::Color),
        }
    }

    fn text(&self, value: &Background) -> Option<String> {
        match value {
            Background::Sky => Some(quoted("sky")),
            Background::Transparent => Some(quoted("transparent")),
            Background::Color(color) => self.0.text(color),
        }
    }

    fn contains(&self, value: &Background) -> bool {
        !matches!(value, Background::Color(color) if !self.0.contains(color))
    }

    fn words(&self) -> Words {
        let words = Kind::<Rgb>::words(&self.0);
        let values = format!("`\"sky\"`, `\"transparent\"`, or {}", words.values);
        Words { values, ..words }
    }
}

/// A text as a basic string of TOML, which serves as a key too: `toml` itself would write some
/// texts in several lines, which no key may have.
pub(in crate::scene) fn quoted(text: &str) -> String {
    let escape = |letter: char| match letter {
        '"' | '\\' => format!("\\{letter}"),
        _ if letter.is_control() => format!("\\u{:04X}", u32::from(letter)),
        _ => letter.to_string(),
    };
    format!("\"{}\"", text.chars().map(escape).collect::<String>())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unit_vectors_are_fixed_points_at_any_scale() {
        for vector in
            [DVec3::new(1e-300, 2e-300, 0.0), DVec3::new(-1e300, 3e299, 1e300), DVec3::ONE]
        {
            let once = unit(vector);
            assert!((once.length() - 1.0).abs() < 1e-15, "{vector}");
            assert_eq!(unit(once), once);
        }
    }
}
