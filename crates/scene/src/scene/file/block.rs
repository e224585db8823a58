//! Sections of a scene file: a table whose keys are known and have a meaning for the section's kind.

use super::schema::Schema;
use super::value::Value;
use crate::scene::FileError;
use crate::suggest;
use std::ops::Range;
use std::path::Path;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The scene file that is being read.
pub(super) struct Source<'a> {
    /// Path, for messages.
    pub(super) path: &'a Path,
    pub(super) text: &'a str,
    /// Folder to which paths in the scene are relative.
    pub(super) folder: &'a Path,
}

impl Source<'_> {
    /// Returns an error at these bytes.
    pub(super) fn error(&self, span: Range<usize>, message: impl Into<String>) -> FileError {
        FileError::at(self.path, self.text, 1, span, message)
    }
}

/// A table of the file whose keys are all in its schema.
pub(super) struct Block<'a> {
    source: &'a Source<'a>,
    schema: &'static Schema,
    span: Range<usize>,
    table: &'a DeTable<'a>,
}

impl<'a> Block<'a> {
    /// Opens a table and checks that its keys are known.
    pub(super) fn open(
        source: &'a Source<'a>,
        schema: &'static Schema,
        span: Range<usize>,
        table: &'a DeTable<'a>,
    ) -> Result<Self, FileError> {
        let block = Self { source, schema, span, table };
        for key in table.keys() {
            let name = key.get_ref();
            if !schema.names().any(|known| known == name) {
                let message = format!("unknown key `{name}` in {}", schema.section);
                let error = source.error(key.span(), message);
                return Err(error.with_help(suggest::help(name, schema.names(), "known keys")));
            }
        }
        Ok(block)
    }

    /// Returns the section's kind, after checking that every key has a meaning for it.
    pub(super) fn kind(&self) -> Result<&'static str, FileError> {
        let kind = match (self.value(self.schema.selector), self.schema.default_kind) {
            (Some(value), _) => value.choice(self.schema.kinds)?,
            (None, Some(kind)) => kind,
            (None, None) => return Err(self.missing_kind()),
        };
        for &(name, kinds) in self.schema.keys {
            if !kinds.is_empty() && !kinds.contains(&kind) {
                self.forbid(name, &format!("{} = \"{kind}\"", self.schema.selector), || {
                    let values = join(kinds.iter().map(|kind| format!("\"{kind}\"")), " or ");
                    format!("it belongs to {} = {values}: remove it", self.schema.selector)
                })?;
            }
        }
        Ok(kind)
    }

    /// Returns an error if the key exists, which is meaningless together with `reason`.
    pub(super) fn forbid(
        &self,
        name: &str,
        reason: &str,
        help: impl Fn() -> String,
    ) -> Result<(), FileError> {
        let Some((key, _)) = self.entry(name) else { return Ok(()) };
        let message = format!("`{name}` has no meaning with {reason}");
        Err(self.source.error(key.span(), message).with_help(help()))
    }

    /// Returns the value of a key of the schema, if it exists.
    pub(super) fn value(&self, name: &'static str) -> Option<Value<'a>> {
        let (_, item) = self.entry(name)?;
        Some(Value { source: self.source, name, span: item.span(), item: item.get_ref() })
    }

    /// Returns the value of a required key; `help` says what to write.
    pub(super) fn need(&self, name: &'static str, help: &str) -> Result<Value<'a>, FileError> {
        self.value(name).ok_or_else(|| {
            let message = format!("missing key `{name}` in {}", self.schema.section);
            self.error(message).with_help(format!("write {help}"))
        })
    }

    /// Returns an error for the whole section.
    pub(super) fn error(&self, message: impl Into<String>) -> FileError {
        self.source.error(self.span.clone(), message)
    }

    /// Returns whether the key exists.
    pub(super) fn has(&self, name: &str) -> bool {
        self.entry(name).is_some()
    }

    /// Returns the tables under a key that a scene file writes as `[[name]]`.
    pub(super) fn blocks(
        &self,
        name: &'static str,
        schema: &'static Schema,
    ) -> Result<Vec<Self>, FileError> {
        let Some(value) = self.value(name) else { return Ok(Vec::new()) };
        let DeValue::Array(items) = value.item else {
            let error = value.error(format!("`{name}` must be a list of tables"));
            return Err(error.with_help(format!("write [[{name}]] for each")));
        };
        items.iter().map(|item| self.open_item(schema, item.span(), item.get_ref())).collect()
    }

    /// Returns the table under a key that a scene file writes as `[name]`.
    pub(super) fn block(
        &self,
        name: &'static str,
        schema: &'static Schema,
    ) -> Result<Option<Self>, FileError> {
        let Some(value) = self.value(name) else { return Ok(None) };
        self.open_item(schema, value.span.clone(), value.item).map(Some)
    }

    /// Returns the tables under a key that a scene file writes as `[name.OWN]`, with their own names,
    /// in the file's order.
    pub(super) fn named_blocks(
        &self,
        name: &'static str,
        schema: &'static Schema,
    ) -> Result<Vec<(&'a str, Self)>, FileError> {
        let Some(value) = self.value(name) else { return Ok(Vec::new()) };
        let mut entries: Vec<_> = value.table()?.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let open = |(key, item): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
            let name: &'a std::borrow::Cow<'a, str> = key.get_ref();
            Ok((name.as_ref(), self.open_item(schema, key.span(), item.get_ref())?))
        };
        entries.into_iter().map(open).collect()
    }

    fn open_item(
        &self,
        schema: &'static Schema,
        span: Range<usize>,
        item: &'a DeValue<'a>,
    ) -> Result<Self, FileError> {
        let value = Value { source: self.source, name: schema.section, span, item };
        let table = value.table()?;
        Self::open(self.source, schema, value.span, table)
    }

    fn entry(&self, name: &str) -> Option<(&'a Spanned<toml::de::DeString<'a>>, &'a Item<'a>)> {
        self.table.get_key_value(name)
    }

    fn missing_kind(&self) -> FileError {
        let Schema { section, selector, kinds, .. } = self.schema;
        let kinds = join(kinds.iter().map(|kind| format!("\"{kind}\"")), ", ");
        self.error(format!("missing key `{selector}` in {section}"))
            .with_help(format!("write {selector} = one of {kinds}"))
    }
}

type Item<'a> = Spanned<DeValue<'a>>;

fn join(words: impl Iterator<Item = String>, separator: &str) -> String {
    words.collect::<Vec<_>>().join(separator)
}
