//! Selections of particles by conditions on columns, such as `element != H and z > 10`.
//!
//! ```text
//! text -> words -> tree -> columns instead of names -> a pass over all rows
//!         words    grammar bind                        bind
//! ```
//!
//! The language is our own: `evalexpr` has a license that programs cannot pass on freely, and CEL
//! distinguishes integers from floats and has no bare words. It has no loops, so time
//! is proportional to the length of the condition times the number of particles.

mod bind;
mod census;
pub(super) mod expression;
mod functions;
mod grammar;
mod lists;
mod spatial;
mod vocabulary;
mod words;

pub use self::census::MoleculeCensus;
use self::grammar::{Tree, collect};
use super::style::add_numbers;
use super::{AlignBy, ParticleFrame, Particles};
use crate::scene::{FileError, Spheres};
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
/// number      5, 1e-3, column, -number, number + number; also - * / ^ (or **), and functions
/// function    abs(number); also sqrt, exp, log (natural), log10; min(number, number), also max, of two or more;
///             norm(number, number, number), or of the components of a vector, as in norm(velocity)
/// column      a name: letters, digits, and _ . : [ ]; any other name in `backticks`
/// text        a word, or "anything" in quotes
/// ```
///
/// The words of VMD and `MDAnalysis` are conditions too:
///
/// ```text
/// protein                      also backbone, sidechain, calpha, nucleic, nucleicbackbone, nucleicbase,
///                              water, ions, lipids, ligand, hetero, hydrogen, noh, all, none
/// name CA C* "O5'"             a column and the values it may have; `*` ends a beginning of texts
/// resid 5 to 10 12             numbers from 5 to 10, and 12; also 5:10 and 5-10
/// within 5 of resname LIG      with the ligand itself, over the periodic cell; exwithin: without it
/// around 5 resname LIG         the same as exwithin 5 of resname LIG
/// same residue as name ZN      also of any column, as in same chain as; byres name ZN
/// ```
///
/// Distances are in the unit of positions, which GRO files have in nanometers. `within`, `around`, `same` and
/// `byres` bind like `not`: before `and`.
///
/// Precedence, from low to high: `or`, `and`, `not`, comparisons, `+ -`, `* /`, signs, `^`; parentheses as usual. A
/// word that is compared with a column of texts is a text, even if a column has this name. Missing
/// numbers are NaN: every comparison with them is false except `!=`. A column of texts is also one of
/// numbers if its texts are numbers. Columns are those of the file, by its own names or their aliases
/// in other programs, and `x`, `y`, `z`, `radius`, `type`, `element`, `id`, `index`. `coordination` is
/// the number of bonds, and `cluster` the number of the connected component, 1 for the largest;
/// `coordination[3.2]` and `cluster[3.2]` are those of neighbors closer than 3.2 in the file's unit.
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
        let tree =
            words::words(text).and_then(|words| grammar::parse(words, text)).map_err(fault)?;
        Ok(Self { text: text.to_owned(), tree })
    }
}

impl Selection {
    /// Returns the choice of the particles that the condition is true of, by which frames are superposed
    /// ([`ReadOptions::align`](super::ReadOptions::align)).
    pub fn align_by(&self) -> AlignBy {
        let selection = self.clone();
        AlignBy::rows(&self.text, &self.columns(), move |frame| {
            let text = &selection.text;
            selection.rows(frame).map_err(|why| format!("cannot be aligned by `{text}`: {why}"))
        })
    }

    /// Returns for each particle of a frame whether the condition is true of it, or a message.
    fn rows(&self, frame: &ParticleFrame) -> Result<Vec<bool>, String> {
        let (x, y, z) = (frame.x.clone(), frame.y.clone(), frame.z.clone());
        let radius = vec![1.0; frame.len()];
        let mut particles = Particles {
            spheres: Spheres { x, y, z, radius, ..Spheres::default() },
            material_names: vec![String::new()],
            frame: ParticleFrame {
                kinds: frame.kinds.clone(),
                numbers: frame.numbers.clone(),
                texts: frame.texts.clone(),
                cell: frame.cell,
                columns: frame.columns.clone(),
                roles: frame.roles.clone(),
                ..ParticleFrame::default()
            },
            ..Particles::default()
        };
        add_numbers(&mut particles, &self.columns());
        bind::rows(&self.tree, &particles).map_err(|(_, message)| message)
    }

    /// Returns for each particle whether the condition is true of it; columns that are computed are added to them.
    ///
    /// # Errors
    ///
    /// The condition names no column there is, or compares what cannot be compared.
    pub fn matches(&self, particles: &mut Particles) -> Result<Vec<bool>, FileError> {
        add_numbers(particles, &self.columns());
        self.chosen(particles)
    }

    /// All words that may be columns.
    pub fn columns(&self) -> Vec<String> {
        let mut names = Vec::new();
        collect(&self.tree, &mut names);
        names.sort_unstable();
        names.dedup();
        names
    }

    /// Returns whether each particle is selected.
    pub(super) fn chosen(&self, particles: &Particles) -> Result<Vec<bool>, FileError> {
        bind::rows(&self.tree, particles)
            .map_err(|(span, message)| FileError::at(Path::new(NAME), &self.text, 1, span, message))
    }

    /// Returns whether each particle is selected, an error if none is and that is not allowed; `what` happens to the
    /// selected ones, in the message.
    pub(super) fn some(
        &self,
        path: &Path,
        particles: &Particles,
        allow_empty: bool,
        what: &str,
    ) -> Result<Vec<bool>, FileError> {
        let chosen = self.chosen(particles)?;
        if !allow_empty && !chosen.contains(&true) {
            let count = chosen.len();
            let message = match what {
                "selected" => format!("none of its {count} particles is selected"),
                _ => format!("none of its {count} particles is {what}: `{}`", self.text),
            };
            let error = FileError::whole_file(path, message);
            return Err(match bind::absent(&self.tree, particles) {
                Some(help) => error.with_help(help),
                None => error,
            });
        }
        Ok(chosen)
    }

    /// Returns the condition as it was written.
    pub(super) fn text(&self) -> &str {
        &self.text
    }
}

impl Particles {
    /// Returns the rows of the particles that a condition is true of; `what` happens to them, in the message.
    ///
    /// # Errors
    ///
    /// The condition names no column there is, compares what cannot be compared, or is true of no particle although that is
    /// not allowed.
    pub fn selected(
        &self,
        path: &Path,
        selection: &Selection,
        allow_empty: bool,
        what: &str,
    ) -> Result<Vec<usize>, FileError> {
        let chosen = selection.some(path, self, allow_empty, what)?;
        Ok((0..self.spheres.len()).filter(|row| chosen[*row]).collect())
    }
}

#[cfg(test)]
mod tests;
