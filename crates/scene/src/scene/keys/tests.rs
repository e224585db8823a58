use super::schema::{Entry, Schema};
use super::table::SECTIONS;
use crate::settings;
use std::collections::{BTreeMap, BTreeSet};

const MANUAL: &str = include_str!("../../../../../scenes/README.md");
const PYTHON: &str = include_str!("../../../../../python/spherule/sections.py");

/// Joins what is said of a key for each of its kinds; what is the same for all is said once.
fn joined<'a>(schema: &Schema, said: impl Iterator<Item = (&'a str, String)>) -> String {
    let mut groups: Vec<(String, Vec<&str>)> = Vec::new();
    for (kind, words) in said {
        match groups.iter_mut().find(|(own, _)| *own == words) {
            Some((_, kinds)) if kinds.contains(&kind) => (),
            Some((_, kinds)) => kinds.push(kind),
            None => groups.push((words, vec![kind])),
        }
    }
    let one = groups.len() == 1 || schema.kinds.is_empty();
    let group = |(words, kinds): (String, Vec<&str>)| match words.as_str() {
        _ if one => words,
        "" => String::new(),
        _ => format!("{}: {words}", quoted(&kinds)),
    };
    let groups: Vec<_> = groups.into_iter().map(group).filter(|words| !words.is_empty()).collect();
    groups.join("; ")
}

/// Joins names of kinds, as in "`"a"`, `"b"` and `"c"`".
fn quoted(kinds: &[&str]) -> String {
    let names: Vec<_> = kinds.iter().map(|kind| format!("`\"{kind}\"`")).collect();
    match &names[..] {
        [first @ .., last] if !first.is_empty() => format!("{} and {last}", first.join(", ")),
        _ => names.concat(),
    }
}

fn row(schema: &Schema, entry: &Entry) -> String {
    let kinds = schema.kinds_of(entry);
    let others: Vec<_> =
        schema.kinds.iter().copied().filter(|kind| !kinds.contains(kind)).collect();
    let help = joined(schema, entry.said.iter().map(|(kind, said)| (*kind, said.help.to_owned())));
    let required = entry.said.iter().all(|(_, said)| said.default.is_none());
    let scope = match (kinds.len(), others.len()) {
        // What is said differs by kind, and says which.
        _ if help.starts_with("`\"")
            && kinds.iter().any(|kind| help.contains(&format!("`\"{kind}\"`:"))) =>
        {
            String::new()
        }
        (0, _) => String::new(),
        (1, _) => format!("{} only", quoted(&kinds)),
        (own, rest) if rest < own => format!("not for {}", quoted(&others)),
        _ => quoted(&kinds),
    };
    let required = if required { "*required*" } else { "" };
    let before: Vec<_> =
        [&scope[..], required].into_iter().filter(|words| !words.is_empty()).collect();
    let before = before.join(", ");
    let meaning = if before.is_empty() { help } else { format!("{before}: {help}") };
    let values = joined(schema, entry.said.iter().map(|(kind, said)| (*kind, said.values.clone())));
    let default = |(kind, said): &(&'static str, super::schema::Description)| {
        (*kind, said.default.clone().unwrap_or_default())
    };
    let default = joined(schema, entry.said.iter().map(default));
    let space = if default.is_empty() { "" } else { " " };
    format!("| `{}` | {meaning} | {values} |{space}{default} |\n", entry.name)
}

/// Returns the table of a section in the manual.
fn table(schema: &Schema) -> String {
    let rows: String = schema.keys.iter().map(|entry| row(schema, entry)).collect();
    format!("| key | meaning | values | default |\n|---|---|---|---|\n{rows}")
}

#[test]
fn the_manual_has_the_tables() {
    let mut missing = String::new();
    for (name, schema) in SECTIONS {
        let schema = schema();
        let heading = format!("\n## `{}`\n", schema.section);
        let (_, rest) = MANUAL.split_once(&heading).unwrap_or_else(|| panic!("{heading}"));
        let section = rest.split_once("\n## ").map_or(rest, |(section, _)| section);
        let table = if name == "render" { settings::manual() } else { table(&schema) };
        if !section.contains(&table) {
            missing.extend([&heading, "\n", &table]);
        }
        assert!(MANUAL.contains(&format!("[`{}`](#", schema.section)), "{name}");
    }
    assert!(missing.is_empty(), "the tables in scenes/README.md must be:\n{missing}");
}

/// Replaces the names of types that `sections.py` defines.
fn resolved(python: &str) -> BTreeSet<String> {
    let alias = |name: &str| {
        let start = format!("\n{name} = ");
        let (_, rest) = PYTHON.split_once(&start)?;
        rest.lines().next().filter(|line| line.starts_with("Literal") || line.starts_with("Seq"))
    };
    let mut text = python.replace("Vector", "Sequence[float]");
    if let Some(line) = alias(&text) {
        text = line.to_owned();
    }
    text.split(" | ").map(str::to_owned).collect()
}

/// Returns the keys of a class of `sections.py`, with their types.
fn class(name: &str) -> Option<BTreeMap<String, BTreeSet<String>>> {
    let (_, rest) = PYTHON.split_once(&format!("\nclass {name}("))?;
    let body = rest.split_once("\n\n\n").map_or(rest, |(body, _)| body);
    let is_key =
        |key: &str| key.bytes().all(|letter| letter.is_ascii_lowercase() || letter == b'_');
    let keys = body.lines().filter_map(|line| line.strip_prefix("    ")?.split_once(": "));
    let keys = keys.filter(|(key, _)| is_key(key));
    Some(keys.map(|(key, python)| (key.to_owned(), resolved(python))).collect())
}

#[test]
fn python_has_every_key_with_its_type() {
    for (name, schema) in SECTIONS {
        let schema = schema();
        let title = |word: &str| word[..1].to_uppercase() + &word[1..];
        let name: String = name.split('_').map(title).collect();
        let required = class(&format!("_{name}")).unwrap_or_default();
        let optional = class(&name).unwrap_or_default();
        let all: BTreeSet<_> = required.keys().chain(optional.keys()).map(String::as_str).collect();
        // A keyword of Python, `from` cannot be a key of a class.
        let expected: BTreeSet<_> = schema.names().filter(|key| *key != "from").collect();
        assert_eq!(all, expected, "the keys of the class {name} in sections.py");
        for entry in schema.keys.iter().filter(|entry| entry.name != "from") {
            let types = entry.said.iter().flat_map(|(_, said)| resolved(&said.python)).collect();
            let needed = entry.said.iter().all(|(_, said)| said.default.is_none());
            let needed = needed && schema.kinds_of(entry).is_empty();
            let keys = if needed { &required } else { &optional };
            // Formats have too many names.
            let types =
                if entry.name == "format" { BTreeSet::from(["str".to_owned()]) } else { types };
            assert_eq!(keys.get(entry.name), Some(&types), "`{}` of the class {name}", entry.name);
        }
    }
}
