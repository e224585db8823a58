//! Values of a scene file: checks of type and range, used by every section.

use crate::scene::{FileError, Rgb};
use crate::settings::Limits;
use crate::{color, suggest};
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;
use toml::de::{DeTable, DeValue};

/// The scene file that is being read.
pub(in crate::scene) struct Source<'a> {
    /// Path, for messages.
    pub(in crate::scene) path: &'a Path,
    pub(in crate::scene) text: &'a str,
    /// Folder to which paths in the scene are relative.
    pub(in crate::scene) folder: &'a Path,
}

impl Source<'_> {
    /// Returns an error at these bytes.
    pub(in crate::scene) fn error(
        &self,
        span: Range<usize>,
        message: impl Into<String>,
    ) -> FileError {
        FileError::at(self.path, self.text, 1, span, message)
    }
}

/// A value, its key and its position.
#[derive(Clone)]
pub(in crate::scene) struct Value<'a> {
    pub(in crate::scene) source: &'a Source<'a>,
    pub(in crate::scene) name: &'static str,
    pub(in crate::scene) span: Range<usize>,
    pub(in crate::scene) item: &'a DeValue<'a>,
}

impl<'a> Value<'a> {
    /// Returns an error at this value.
    pub(in crate::scene) fn error(&self, message: impl Into<String>) -> FileError {
        self.source.error(self.span.clone(), message)
    }

    /// Returns an error that says what the value must be.
    pub(in crate::scene) fn must_be(&self, expected: impl AsRef<str>) -> FileError {
        let given = self.source.text.get(self.span.clone()).unwrap_or_default();
        let given = match self.item {
            DeValue::Table(_) => "a table".to_owned(),
            _ if given.len() > 40 || given.contains('\n') => format!("a {}", self.item.type_str()),
            _ => given.to_owned(),
        };
        self.error(format!("`{}` is {given}, but must be {}", self.name, expected.as_ref()))
    }

    /// Returns a number within limits.
    pub(in crate::scene) fn number(&self, limits: Limits) -> Result<f64, FileError> {
        let number: f64 = self.parse().ok_or_else(|| self.must_be("a number"))?;
        if limits.contain(number) { Ok(number) } else { Err(self.must_be(limits.describe())) }
    }

    /// Returns an integer within a range.
    pub(in crate::scene) fn whole(&self, low: u64, high: u64) -> Result<u64, FileError> {
        let expected = || format!("an integer from {low} to {high}");
        let DeValue::Integer(integer) = self.item else { return Err(self.must_be(expected())) };
        u64::from_str_radix(integer.as_str(), integer.radix())
            .ok()
            .filter(|number| (low..=high).contains(number))
            .ok_or_else(|| self.must_be(expected()))
    }

    /// Returns true or false.
    pub(in crate::scene) fn flag(&self) -> Result<bool, FileError> {
        self.item.as_bool().ok_or_else(|| self.must_be("true or false"))
    }

    /// Returns a string.
    pub(in crate::scene) fn text(&self) -> Result<&'a str, FileError> {
        self.item.as_str().ok_or_else(|| self.must_be("a string in quotes"))
    }

    /// Returns one of several words.
    pub(in crate::scene) fn choice(
        &self,
        words: &[&'static str],
    ) -> Result<&'static str, FileError> {
        let text = self.text()?;
        words.iter().copied().find(|&word| word == text).ok_or_else(|| {
            let help = suggest::help(text, words.iter().copied(), "possible values");
            self.error(format!("unknown {} \"{text}\"", self.name)).with_help(help)
        })
    }

    /// Returns `N` values.
    pub(in crate::scene) fn list<const N: usize>(&self) -> Result<[Self; N], FileError> {
        let items = self.item.as_array().filter(|items| items.len() == N);
        let items = items.ok_or_else(|| self.must_be(format!("a list of {N} numbers")))?;
        let entry = |index: usize| {
            let item: &'a toml::Spanned<DeValue<'a>> = &items[index];
            Self { span: item.span(), item: item.get_ref(), ..self.clone() }
        };
        Ok(std::array::from_fn(entry))
    }

    /// Returns a color: three linear values, one for gray, or `"#rrggbb"` or a CSS name in sRGB; each
    /// value within limits.
    pub(in crate::scene) fn color(&self, limits: Limits) -> Result<Rgb, FileError> {
        match self.item {
            DeValue::Array(_) => {
                let [red, green, blue] = self.list()?;
                Ok(Rgb::new(red.single(limits)?, green.single(limits)?, blue.single(limits)?))
            }
            DeValue::String(text) => color::parse(text).ok_or_else(|| {
                let expected = "\"#rrggbb\" or the name of a CSS color if it is a string";
                self.must_be_color(expected, text, &[])
            }),
            DeValue::Integer(_) | DeValue::Float(_) => self.single(limits).map(Rgb::splat),
            _ => {
                Err(self
                    .must_be("[red, green, blue], one number for gray, \"#rrggbb\" or a CSS color"))
            }
        }
    }

    /// Returns an error for a text that is neither a color nor one of these words.
    pub(in crate::scene) fn must_be_color(
        &self,
        expected: &str,
        text: &str,
        words: &[&'static str],
    ) -> FileError {
        let error = self.must_be(expected);
        match suggest::nearest(text, words.iter().copied().chain(color::names())) {
            Some(near) => error.with_help(format!("did you mean \"{near}\"?")),
            None => error,
        }
    }

    /// Returns a number that is parsed in single precision, so that an `f32` survives writing and
    /// reading.
    pub(in crate::scene) fn single(&self, limits: Limits) -> Result<f32, FileError> {
        self.number(limits)?;
        let number: f32 = self.parse().ok_or_else(|| self.must_be("a number"))?;
        if limits.contain(f64::from(number)) {
            Ok(number)
        } else {
            Err(self.must_be(format!("{} in single precision", limits.describe())))
        }
    }

    /// Returns a table.
    pub(in crate::scene) fn table(&self) -> Result<&'a DeTable<'a>, FileError> {
        self.item.as_table().ok_or_else(|| self.must_be("a table"))
    }

    fn parse<T: FromStr>(&self) -> Option<T> {
        match self.item {
            DeValue::Float(float) => float.as_str().parse().ok(),
            DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
            _ => None,
        }
    }
}
