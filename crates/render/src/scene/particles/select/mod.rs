//! Selections of particles by conditions on columns, such as `element != H and z > 10`.
//!
//! ```text
//! text -> words -> tree -> columns instead of names -> a pass over all rows
//!         words    grammar bind                        bind
//! ```
//!
//! The language is our own: `evalexpr` has a license that programs cannot pass on freely, and CEL
//! distinguishes integers from floats and has no bare words. It has no loops and no functions, so time
//! is proportional to the length of the condition times the number of particles.

mod bind;
mod grammar;
mod words;

use self::grammar::{Node, Tree};
use super::Particles;
use crate::scene::FileError;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;

/// Replaces the file name in messages, since the condition is not in a file.
const NAME: &str = "selection";

/// A condition on particles.
///
/// ```text
/// condition   comparison, not condition, condition and condition, condition or condition
/// comparison  number == number; also != < <= > >=
///             column == text; also !=
/// number      5, 1e-3, column, -number, number + number; also - * /
/// column      a name: letters, digits, and _ . : [ ]; any other name in `backticks`
/// text        a word, or "anything" in quotes
/// ```
///
/// Precedence, from low to high: `or`, `and`, `not`, comparisons, `+ -`, `* /`; parentheses as usual. A
/// word that is compared with a column of texts is a text, even if a column has this name. Missing
/// numbers are NaN: every comparison with them is false except `!=`. A column of texts is also one of
/// numbers if its texts are numbers. Columns are those of the file, by its own names or their aliases
/// in other programs, and `x`, `y`, `z`, `radius`, `type`, `element`, `id`, `index`.
#[derive(Clone, Debug, PartialEq)]
pub struct Selection {
    text: String,
    tree: Tree,
}

/// An error in a condition, with its position.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", self.diagnostic())]
pub struct Fault {
    /// The error, one sentence without a full stop.
    pub message: String,
    /// The faulty bytes of the condition.
    pub span: Range<usize>,
    /// The condition.
    pub text: String,
}

impl Fault {
    fn new(text: &str, span: Range<usize>, message: impl Into<String>) -> Self {
        Self { message: message.into(), span, text: text.to_owned() }
    }

    /// Returns the message and the condition with its faulty part marked.
    fn diagnostic(&self) -> String {
        let count = |part: Option<&str>| part.unwrap_or_default().chars().count();
        let before = count(self.text.get(..self.span.start));
        let marks = "^".repeat(count(self.text.get(self.span.clone())).max(1));
        let line: String =
            self.text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        format!("{}\n  {line}\n  {}{marks}", self.message, " ".repeat(before))
    }
}

impl FromStr for Selection {
    type Err = Fault;

    fn from_str(text: &str) -> Result<Self, Fault> {
        let fault = |(span, message): (Range<usize>, String)| Fault::new(text, span, message);
        let tree = words::words(text).and_then(grammar::parse).map_err(fault)?;
        Ok(Self { text: text.to_owned(), tree })
    }
}

impl Selection {
    /// All words that may be columns.
    pub fn columns(&self) -> Vec<String> {
        let mut names = Vec::new();
        collect(&self.tree, &mut names);
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Drops the particles that the condition is false of, all of them only if that is allowed.
    ///
    /// # Errors
    ///
    /// The condition names no column there is, compares what cannot be compared, or is true of no
    /// particle.
    pub(super) fn apply(
        &self,
        path: &Path,
        particles: &mut Particles,
        allow_empty: bool,
    ) -> Result<(), FileError> {
        let keep = bind::rows(&self.tree, particles).map_err(|(span, message)| {
            FileError::at(Path::new(NAME), &self.text, 1, span, message)
        })?;
        if !keep.contains(&true) && !allow_empty {
            let message = format!("none of its {} particles is selected", keep.len());
            let error = FileError::whole_file(path, message);
            return Err(match bind::absent(&self.tree, particles) {
                Some(help) => error.with_help(help),
                None => error,
            });
        }
        if keep.contains(&false) {
            particles.retain(&keep);
        }
        Ok(())
    }
}

fn collect(tree: &Tree, names: &mut Vec<String>) {
    match &tree.node {
        Node::Number(_) | Node::Text(_) => (),
        Node::Word(name) | Node::Column(name) => names.push(name.clone()),
        Node::Negative(inner) | Node::Not(inner) => collect(inner, names),
        Node::Compare(_, sides) => sides.iter().for_each(|side| collect(side, names)),
        Node::Arithmetic(first, rest) => {
            collect(first, names);
            for (_, operand) in rest {
                collect(operand, names);
            }
        }
        Node::All(parts) | Node::Any(parts) => parts.iter().for_each(|part| collect(part, names)),
    }
}

#[cfg(test)]
mod tests;
