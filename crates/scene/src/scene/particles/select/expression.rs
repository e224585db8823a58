//! Columns by expressions: wherever a column is named, arithmetic over columns may stand.

use super::bind;
use super::grammar::{self, Node, Tree, collect};
use super::words::{self, SpannedError};
use crate::scene::FileError;
use crate::scene::particles::Particles;
use crate::scene::particles::style::{Column, missing, nearest, unknown};
use std::borrow::Cow;
use std::path::Path;

/// Replaces the file name in messages, since the expression is not in a file.
const NAME: &str = "expression";

fn parse(text: &str) -> Result<Tree, SpannedError> {
    words::words(text).and_then(|words| grammar::parse_number(words, text))
}

/// Returns whether a text is arithmetic, and not only a name.
pub(in super::super) fn is_arithmetic(text: &str) -> bool {
    parse(text).is_ok_and(|tree| !matches!(tree.node, Node::Word(_) | Node::Column(_)))
}

/// Returns the names of the columns that a name or an expression may need: all of it, and the names in it.
pub(in super::super) fn columns(text: &str) -> Vec<String> {
    let mut names = vec![text.to_owned()];
    if let Ok(tree) = parse(text) {
        collect(&tree, &mut names);
    }
    names.dedup();
    names
}

/// Returns the column with a name, which may be in backticks, or the numbers of an expression.
///
/// # Errors
///
/// There is no such column, or the text is no valid expression.
pub(in super::super) fn evaluate<'p>(
    path: &Path,
    particles: &'p Particles,
    text: &str,
) -> Result<Column<'p>, FileError> {
    if let Some(column) = Column::find(particles, text) {
        return Ok(column);
    }
    let fault = |(span, message): SpannedError| {
        let error = FileError::at(Path::new(NAME), text, 1, span, message);
        match nearest(particles, text) {
            Some(_) => error.with_help(unknown(particles, text)),
            None => error,
        }
    };
    let tree = match parse(text) {
        Ok(tree) => tree,
        Err(_) if !text.contains(ARITHMETIC) => return Err(missing(path, particles, text)),
        Err(error) => return Err(fault(error)),
    };
    if let Node::Word(name) | Node::Column(name) = &tree.node {
        return Column::find(particles, name).ok_or_else(|| missing(path, particles, name));
    }
    let mut names = Vec::new();
    collect(&tree, &mut names);
    if names.is_empty() {
        return Err(missing(path, particles, text));
    }
    let numbers = bind::numbers(&tree, particles).map_err(fault)?;
    Ok(Column::Numbers(Cow::Owned(numbers)))
}

/// Returns the numbers of a column or of an expression; `purpose` names what they are for, in the plural.
///
/// # Errors
///
/// There is no such column, it has texts, or the expression is invalid.
pub(in super::super) fn numbers<'p>(
    path: &Path,
    particles: &'p Particles,
    text: &str,
    purpose: &str,
) -> Result<Cow<'p, [f64]>, FileError> {
    match evaluate(path, particles, text)? {
        Column::Numbers(numbers) => Ok(numbers),
        Column::Texts { .. } => {
            let message = format!("the column `{text}` has texts, but {purpose} are numbers");
            Err(FileError::whole_file(path, message).with_help("name a column of numbers"))
        }
    }
}

/// Characters that only expressions have, besides those of odd names.
const ARITHMETIC: [char; 13] = ['+', '-', '*', '/', '^', '(', ')', ',', '`', '=', '<', '>', '!'];
