//! The keys of scene files, each described once: name, type, range, default and help.
//!
//! A `Section` shows its keys, one after the other, to a `Visitor`; `table.rs` has all sections. One
//! visitor reads a section from a file (`file/block.rs`), others write it, check one that was built in
//! code, and list its keys (`schema.rs`), for messages, the manual and the types of Python.

mod check;
mod kinds;
mod schema;
mod shared;
mod table;

pub use check::{check_camera, check_sections};
pub(in crate::scene) use kinds::Str::Path;
pub(in crate::scene) use kinds::Triple::Point;
pub(in crate::scene) use kinds::{Kind, List, Optional, Quaternion, quoted};
pub(in crate::scene) use schema::Schema;
pub(in crate::scene) use shared::{RADIUS, color, solid};
pub(in crate::scene) use table::{
    EnvironmentKeys, FileKeys, GenerateKeys, GroundKeys, SECTIONS, SphereKeys, StyleKeys,
};

use std::fmt::Debug;

/// A section of a scene file.
pub(in crate::scene) trait Section: Clone {
    /// As a scene file writes it.
    const NAME: &'static str;

    /// Makes the section without keys. Required ones have any value.
    const EMPTY: fn() -> Self;

    /// Shows all keys that have a meaning for the section's kind, in the order in which they are written.
    fn visit<V: Visitor>(&mut self, keys: &mut V);
}

/// A key of a section.
#[derive(Clone, Copy)]
pub(in crate::scene) struct Key {
    pub(in crate::scene) name: &'static str,
    /// For the manual.
    pub(in crate::scene) help: &'static str,
    /// Only of a required key: what to write if it is missing.
    pub(in crate::scene) example: Option<&'static str>,
    /// The default in words, where it is not the value of an empty section, or when a key is required.
    pub(in crate::scene) default: Option<&'static str>,
}

/// Returns an optional key.
pub(in crate::scene) const fn key(name: &'static str, help: &'static str) -> Key {
    Key { name, help, example: None, default: None }
}

impl Key {
    /// Makes the key a required one; `example` is what to write if it is missing.
    pub(in crate::scene) const fn required(self, example: &'static str) -> Self {
        Self { example: Some(example), ..self }
    }

    /// Says the default in words.
    pub(in crate::scene) const fn or(self, default: &'static str) -> Self {
        Self { default: Some(default), ..self }
    }
}

/// A reader, writer, checker or lister of keys. The first error counts.
pub(in crate::scene) trait Visitor: Sized {
    /// Visits a key and its value.
    fn visit<T: Debug>(&mut self, key: Key, kind: impl Kind<T>, value: &mut T);

    /// Visits the key that chooses the section's kind, and so its other keys. Without it, unless it is
    /// required, the kind is the first.
    fn choose<T: Clone>(&mut self, _key: Key, _kinds: &[(&'static str, T)], _value: &mut T) {}

    /// Visits a value whose form decides on keys, too: a form is chosen by any of its keys.
    fn form<T: Clone>(&mut self, _forms: &[(&[&str], T)], _value: &mut T) {}

    /// Refuses keys of a scene file that are meaningless together with `reason`.
    fn forbid(&mut self, _names: &[&str], _reason: &str, _help: &str) {}

    /// Refuses values of a scene file that contradict each other, at the first of the keys that it has.
    fn refuse(&mut self, _at: &[&'static str], _message: &str, _help: Option<&str>) {}

    /// Checks a value that comes from code and is no key's.
    fn check<T: Debug>(&mut self, _name: &str, _kind: impl Kind<T>, _value: &T) {}
}

/// Writes a section's keys.
struct Writer(String);

impl Visitor for Writer {
    fn visit<T: Debug>(&mut self, key: Key, kind: impl Kind<T>, value: &mut T) {
        if let Some(text) = kind.text(value) {
            self.0.extend([key.name, " = ", &text, "\n"]);
        }
    }

    fn choose<T: Clone>(&mut self, key: Key, kinds: &[(&'static str, T)], value: &mut T) {
        self.0.extend([key.name, " = ", &quoted(kinds::name_of(kinds, value)), "\n"]);
    }
}

/// Returns the keys of a section as text, without the section's name.
pub(in crate::scene) fn text(section: &impl Section) -> String {
    let mut writer = Writer(String::new());
    section.clone().visit(&mut writer);
    writer.0
}

/// Returns a section as text.
pub(in crate::scene) fn section_text<T: Section>(section: &T) -> String {
    format!("{}\n{}\n", T::NAME, text(section))
}

#[cfg(test)]
mod tests;
