//! The list of a section's keys: for unknown keys, the manual and the types of Python.

use super::kinds::{self, Kind, Words};
use super::{Key, Section, Visitor};
use crate::settings::{self, INTEGRATORS, SETTINGS, Scope};
use std::fmt::Debug;

/// A section, its keys, and the kinds each key has a meaning for.
#[derive(Default)]
pub(in crate::scene) struct Schema {
    /// As a scene file writes it.
    pub(in crate::scene) section: &'static str,
    /// The key that chooses among `kinds`; empty if the section has no kinds.
    pub(in crate::scene) selector: &'static str,
    /// The values of the selector.
    pub(in crate::scene) kinds: Vec<&'static str>,
    /// True if the section must have a selector; without one it is of the first kind.
    pub(in crate::scene) needs_kind: bool,
    /// Every key, in the order of the manual.
    pub(in crate::scene) keys: Vec<Entry>,
}

/// A key of a section, and what is said of it.
pub(in crate::scene) struct Entry {
    pub(in crate::scene) name: &'static str,
    /// For each kind that the key has a meaning for.
    pub(super) said: Vec<(&'static str, Description)>,
}

/// The description of a key for one of the section's kinds.
#[derive(Clone, PartialEq)]
pub(super) struct Description {
    pub(super) help: &'static str,
    pub(super) values: String,
    /// `None` of a required key.
    pub(super) default: Option<String>,
    pub(super) python: String,
}

impl Schema {
    /// Returns the schema of a section.
    pub(in crate::scene) fn of<T: Section>() -> Self {
        let mut schema = Self { section: T::NAME, ..Self::default() };
        let (mut run, mut runs) = (0, 1);
        while run < runs {
            let mut lister = Lister { schema, keys: Vec::new(), kind: "", rest: run, runs: 1 };
            (T::EMPTY)().visit(&mut lister);
            // Only some kinds have forms.
            runs = runs.max(lister.runs);
            run += 1;
            schema = lister.merged();
        }
        schema
    }

    /// Returns a schema of names alone.
    pub(in crate::scene) fn plain(
        section: &'static str,
        names: impl Iterator<Item = &'static str>,
    ) -> Self {
        let keys = names.map(|name| Entry { name, said: Vec::new() }).collect();
        Self { section, keys, ..Self::default() }
    }

    /// Returns the schema of `[render]`, which is that of the table of settings.
    pub(in crate::scene) fn render() -> Self {
        let kinds: Vec<_> = INTEGRATORS.list().into_iter().map(|(name, _)| name).collect();
        let entry = |setting: &settings::Setting| {
            let python = python_of(&setting.kind);
            let of = match setting.scope {
                Scope::ParameterOf(integrators) => integrators,
                Scope::All | Scope::Only(_) => &kinds[..],
            };
            let default = Some(String::new());
            let said = Description { help: setting.help, values: String::new(), default, python };
            let said = of.iter().map(|kind| (*kind, said.clone())).collect();
            Entry { name: setting.name, said }
        };
        let keys = SETTINGS.iter().map(entry).collect();
        Self { section: "[render]", selector: "integrator", kinds, needs_kind: false, keys }
    }

    /// The section's name as a key of the scene.
    pub(in crate::scene) fn name(&self) -> &'static str {
        let name = self.section.trim_matches(['[', ']']);
        name.split_once('.').map_or(name, |(name, _)| name)
    }

    /// Every key of the section.
    pub(in crate::scene) fn names(&self) -> impl Iterator<Item = &'static str> + Clone {
        self.keys.iter().map(|entry| entry.name)
    }

    /// Returns the kinds that a key has a meaning for; none if it has one for all.
    pub(in crate::scene) fn kinds_of(&self, entry: &Entry) -> Vec<&'static str> {
        let has = |kind: &&&str| entry.said.iter().any(|(own, _)| own == *kind);
        let kinds: Vec<_> = self.kinds.iter().filter(has).copied().collect();
        if kinds.len() == self.kinds.len() || entry.said.is_empty() { Vec::new() } else { kinds }
    }
}

/// Returns the type of a setting in Python.
fn python_of(kind: &settings::Kind) -> String {
    let or = |usual: &str, words: &'static [&str]| match words {
        [] => usual.to_owned(),
        _ => format!("{usual} | {}", kinds::one_of(words.iter().copied()).python),
    };
    match *kind {
        settings::Kind::Size => "Sequence[int] | str".to_owned(),
        settings::Kind::Whole { words, .. } => or("int", words),
        settings::Kind::Number { words, .. } => or("float", words),
        settings::Kind::Error | settings::Kind::Time => "float".to_owned(),
        settings::Kind::Flag => "bool".to_owned(),
        settings::Kind::Choice(list) => {
            kinds::one_of(list().into_iter().map(|(name, _)| name)).python
        }
    }
}

/// Lists the keys of a section, which is visited once in each combination of its kinds and forms.
struct Lister {
    schema: Schema,
    /// The keys of this run.
    keys: Vec<(&'static str, Description)>,
    /// The kind in this run.
    kind: &'static str,
    /// The number of this run, without the digits that chose kinds and forms, in bases of how many there
    /// are.
    rest: usize,
    /// The number of combinations.
    runs: usize,
}

impl Lister {
    /// Returns which of several forms to take in this run.
    fn pick(&mut self, forms: usize) -> usize {
        let index = self.rest % forms;
        self.rest /= forms;
        self.runs *= forms;
        index
    }

    /// Adds a key to this run; `usual` is its default, unless it has another or is required.
    fn add(&mut self, key: Key, Words { values, python, .. }: Words, usual: String) {
        let usual = key.example.is_none().then_some(usual);
        let default = key.default.map(str::to_owned).or(usual);
        self.keys.push((key.name, Description { help: key.help, values, default, python }));
    }

    /// Adds the keys of this run to the schema, new ones before the next that is known.
    fn merged(self) -> Schema {
        let Self { mut schema, keys, kind, .. } = self;
        let place = |schema: &Schema, name| schema.keys.iter().position(|own| own.name == name);
        for (row, (name, description)) in keys.iter().enumerate() {
            let at = place(&schema, *name).unwrap_or_else(|| {
                let next = keys[row..].iter().find_map(|(later, _)| place(&schema, *later));
                let at = next.unwrap_or(schema.keys.len());
                schema.keys.insert(at, Entry { name, said: Vec::new() });
                at
            });
            let said = (kind, description.clone());
            if !schema.keys[at].said.contains(&said) {
                schema.keys[at].said.push(said);
            }
        }
        schema
    }
}

impl Visitor for Lister {
    fn visit<T: Debug>(&mut self, key: Key, kind: impl Kind<T>, value: &mut T) {
        let usual = match kind.brief(value).as_str() {
            "\"\"" => "empty".to_owned(),
            "none" => "none".to_owned(),
            value => format!("`{value}`"),
        };
        self.add(key, kind.words(), usual);
    }

    fn choose<T: Clone>(&mut self, key: Key, kinds: &[(&'static str, T)], value: &mut T) {
        let names: Vec<_> = kinds.iter().map(|(name, _)| *name).collect();
        let index = self.pick(kinds.len());
        self.kind = names[index];
        *value = kinds[index].1.clone();
        self.add(key, kinds::one_of(names.iter().copied()), format!("`\"{}\"`", names[0]));
        let schema = &mut self.schema;
        (schema.selector, schema.kinds) = (key.name, names);
        schema.needs_kind = key.example.is_some();
    }

    fn form<T: Clone>(&mut self, forms: &[(&[&str], T)], value: &mut T) {
        *value = forms[self.pick(forms.len())].1.clone();
    }
}
