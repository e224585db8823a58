//! Sections of a scene file: a table whose keys are known and have a meaning for the section's kind.

use super::value::{Source, Value};
use crate::scene::FileError;
use crate::scene::keys::{Key, Kind, Schema, Section, Visitor};
use crate::suggest;
use std::fmt::Debug;
use std::ops::Range;
use std::rc::Rc;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A table of the file whose keys are all in its schema.
pub(in crate::scene) struct Block<'a> {
    source: &'a Source<'a>,
    schema: Rc<Schema>,
    span: Range<usize>,
    table: &'a DeTable<'a>,
}

impl<'a> Block<'a> {
    /// Opens a table and checks that its keys are known.
    pub(in crate::scene) fn open(
        source: &'a Source<'a>,
        schema: Rc<Schema>,
        span: Range<usize>,
        table: &'a DeTable<'a>,
    ) -> Result<Self, FileError> {
        let block = Self { source, schema, span, table };
        let schema = &block.schema;
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

    /// Reads the section; its keys must be those of the block's schema.
    pub(in crate::scene) fn read<T: Section>(&self) -> Result<T, FileError> {
        let mut section = (T::EMPTY)();
        let mut reader = Reader { block: self, result: Ok(()) };
        section.visit(&mut reader);
        reader.result.map(|()| section)
    }

    /// Reads the section, if it exists, that a scene file writes as `[name]`.
    pub(in crate::scene) fn section<T: Section>(&self) -> Result<Option<T>, FileError> {
        let block = self.block(Schema::of::<T>())?;
        block.map(|block| block.read()).transpose()
    }

    /// Reads all sections that a scene file writes as `[[name]]`.
    pub(in crate::scene) fn sections<T: Section>(&self) -> Result<Vec<T>, FileError> {
        self.blocks(Schema::of::<T>())?.iter().map(Self::read).collect()
    }

    /// Returns the section's kind, after checking that every key has a meaning for it.
    pub(in crate::scene) fn kind(&self) -> Result<&'static str, FileError> {
        let Schema { selector, kinds, needs_kind, .. } = &*self.schema;
        let kind = match self.value(selector) {
            Some(value) => value.choice(kinds)?,
            None if *needs_kind => {
                let kinds = join(kinds.iter().map(|kind| format!("\"{kind}\"")), ", ");
                return Err(self.missing(selector, &format!("{selector} = one of {kinds}")));
            }
            None => kinds[0],
        };
        for entry in &self.schema.keys {
            let kinds = self.schema.kinds_of(entry);
            if !kinds.is_empty() && !kinds.contains(&kind) {
                self.forbid(entry.name, &format!("{selector} = \"{kind}\""), || {
                    let values = join(kinds.iter().map(|kind| format!("\"{kind}\"")), " or ");
                    format!("it belongs to {selector} = {values}: remove it")
                })?;
            }
        }
        Ok(kind)
    }

    /// Returns an error if the key exists, which is meaningless together with `reason`.
    pub(in crate::scene) fn forbid(
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
    pub(in crate::scene) fn value(&self, name: &'static str) -> Option<Value<'a>> {
        let (_, item) = self.entry(name)?;
        Some(Value { source: self.source, name, span: item.span(), item: item.get_ref() })
    }

    /// Returns an error for the whole section.
    pub(in crate::scene) fn error(&self, message: impl Into<String>) -> FileError {
        self.source.error(self.span.clone(), message)
    }

    /// Returns an error at the value of a key, or for the whole section without it.
    pub(in crate::scene) fn error_at(&self, name: &'static str, message: &str) -> FileError {
        self.value(name).map_or_else(|| self.error(message), |value| value.error(message))
    }

    /// Returns whether the key exists.
    pub(in crate::scene) fn has(&self, name: &str) -> bool {
        self.entry(name).is_some()
    }

    /// Returns the tables that a scene file writes as `[[name]]`.
    pub(in crate::scene) fn blocks(&self, schema: Schema) -> Result<Vec<Self>, FileError> {
        let name = schema.name();
        let Some(value) = self.value(name) else { return Ok(Vec::new()) };
        let DeValue::Array(items) = value.item else {
            let error = value.error(format!("`{name}` must be a list of tables"));
            return Err(error.with_help(format!("write [[{name}]] for each")));
        };
        let schema = Rc::new(schema);
        items
            .iter()
            .map(|item| self.open_item(schema.clone(), item.span(), item.get_ref()))
            .collect()
    }

    /// Returns the table that a scene file writes as `[name]`.
    pub(in crate::scene) fn block(&self, schema: Schema) -> Result<Option<Self>, FileError> {
        let Some(value) = self.value(schema.name()) else { return Ok(None) };
        self.open_item(Rc::new(schema), value.span.clone(), value.item).map(Some)
    }

    /// Returns the tables that a scene file writes as `[name.OWN]`, with their own names, in the file's
    /// order.
    pub(in crate::scene) fn named_blocks(
        &self,
        schema: Schema,
    ) -> Result<Vec<(&'a str, Self)>, FileError> {
        let Some(value) = self.value(schema.name()) else { return Ok(Vec::new()) };
        let mut entries: Vec<_> = value.table()?.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        let schema = Rc::new(schema);
        let open = |(key, item): (&'a Spanned<_>, &'a Spanned<DeValue<'a>>)| {
            let name: &'a std::borrow::Cow<'a, str> = key.get_ref();
            Ok((name.as_ref(), self.open_item(schema.clone(), key.span(), item.get_ref())?))
        };
        entries.into_iter().map(open).collect()
    }

    fn open_item(
        &self,
        schema: Rc<Schema>,
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

    /// Returns the error of a required key that is not there; `example` is what to write.
    fn missing(&self, name: &str, example: &str) -> FileError {
        let message = format!("missing key `{name}` in {}", self.schema.section);
        self.error(message).with_help(format!("write {example}"))
    }
}

/// Reads the keys of a section, up to the first error.
struct Reader<'b, 'a> {
    block: &'b Block<'a>,
    result: Result<(), FileError>,
}

impl Reader<'_, '_> {
    fn read(&mut self, read: impl FnOnce(&Block) -> Result<(), FileError>) {
        if self.result.is_ok() {
            self.result = read(self.block);
        }
    }
}

impl Visitor for Reader<'_, '_> {
    fn visit<T: Debug>(&mut self, key: Key, kind: impl Kind<T>, value: &mut T) {
        self.read(|block| {
            match (block.value(key.name), key.example) {
                (Some(found), _) => *value = kind.read(&found)?,
                (None, Some(example)) => return Err(block.missing(key.name, example)),
                (None, None) => (),
            }
            Ok(())
        });
    }

    fn choose<T: Clone>(&mut self, _: Key, kinds: &[(&'static str, T)], value: &mut T) {
        self.read(|block| {
            let kind = block.kind()?;
            if let Some((_, of)) = kinds.iter().find(|(name, _)| *name == kind) {
                value.clone_from(of);
            }
            Ok(())
        });
    }

    fn form<T: Clone>(&mut self, forms: &[(&[&str], T)], value: &mut T) {
        let given = |keys: &[&str]| keys.iter().any(|key| self.block.has(key));
        if let Some((_, form)) = forms.iter().find(|(keys, _)| given(keys)) {
            value.clone_from(form);
        }
    }

    fn forbid(&mut self, names: &[&str], reason: &str, help: &str) {
        self.read(|block| {
            names.iter().try_for_each(|name| block.forbid(name, reason, || help.to_owned()))
        });
    }

    fn refuse(&mut self, at: &[&'static str], message: &str, help: Option<&str>) {
        self.read(|block| {
            let at = at.iter().find(|name| block.has(name)).unwrap_or(&at[0]);
            let error = block.error_at(at, message);
            Err(FileError { help: help.map(str::to_owned), ..error })
        });
    }
}

type Item<'a> = Spanned<DeValue<'a>>;

fn join(words: impl Iterator<Item = String>, separator: &str) -> String {
    words.collect::<Vec<_>>().join(separator)
}
