//! Rules for bonds: where they come from, and how far bonded particles may be apart.

use super::bridges;
use crate::{Format, Kind, ParticleFrame, error::clipped, suggest};
use std::str::FromStr;

/// Tolerance of the sum of two covalent radii in angstrom, and the least length of a bond, as in Open
/// Babel (O'Boyle et al., "Open Babel: An open chemical toolbox", Journal of Cheminformatics 2011, and
/// its documentation of `ConnectTheDots`).
pub(super) const TOLERANCE: f64 = 0.45;
const LEAST: f64 = 0.4;

/// The excess over that of bonds of hydrogen to alkali metals, of which it is an anion and larger: from `LiH` to `CsH`,
/// half of the edge of the cell is up to 0.06 angstrom longer than the rule allows (Wyckoff, Crystal Structures, 1963).
const HYDRIDE: f64 = 0.1;

/// Name that stands for every type.
const ANY: &str = "*";

/// Source of bonds.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum BondSource {
    /// Bonds of the file; without any, bonds by distance if elements are known. Both together for PDB and
    /// mmCIF, which list only the bonds that residues don't imply.
    Auto,
    /// Bonds of the file only; an error if its format has none.
    File,
    /// [`BondSource::Auto`] for crystals ([`ParticleFrame::is_crystal`]), no bonds for others.
    OfCrystals,
    /// No bonds.
    #[default]
    None,
    /// Bonds by distance, by these rules.
    Rules(BondRules),
}

/// Rules for bonds by distance.
#[derive(Clone, Debug, PartialEq)]
pub struct BondRules {
    /// Rules for types; `None`: covalent radii.
    rules: Option<Vec<Rule>>,
}

/// A rule: particles of these types are bonded if they are less than a length apart.
#[derive(Clone, Debug, PartialEq)]
struct Rule {
    names: [String; 2],
    length: f64,
}

/// Greatest lengths of bonds between classes of types.
pub(super) struct Cutoffs {
    /// Class of each type.
    pub(super) class: Vec<usize>,
    /// Number of classes.
    pub(super) count: usize,
    /// Squares of the lengths for each pair of classes; negative if they have no bonds.
    pub(super) squares: Vec<f64>,
    /// Greatest length for each class.
    pub(super) reach: Vec<f64>,
    /// Square of the least length of a bond.
    pub(super) least: f64,
}

impl BondRules {
    /// Returns the rule of covalent radii (Cordero et al. 2008): two atoms are bonded if they are more than
    /// 0.4 angstrom apart, and at most the sum of their covalent radii and 0.45 angstrom. A metal is not bonded across an
    /// anion: neither to a metal to which an anion is bonded, too, nor, as far as it is, to an atom with a more
    /// electronegative one between them.
    pub fn covalent() -> Self {
        Self { rules: None }
    }

    pub(super) fn are_covalent(&self) -> bool {
        self.rules.is_none()
    }

    /// Returns the rule that all particles closer than a length are bonded.
    pub fn within(length: f64) -> Self {
        let names = [ANY.to_owned(), ANY.to_owned()];
        Self { rules: Some(vec![Rule { names, length }]) }
    }

    /// Returns the cutoffs for the types of a frame.
    ///
    /// # Errors
    ///
    /// A message: a rule names a type that the frame doesn't have.
    pub(super) fn cutoffs(&self, frame: &ParticleFrame) -> Result<Cutoffs, String> {
        let none = Kind::default();
        let has_types = !frame.kinds.codes.is_empty();
        let table = if has_types { &frame.kinds.table[..] } else { std::slice::from_ref(&none) };
        let Some(rules) = &self.rules else {
            return Ok(covalent(table, frame.unit.per_angstrom()));
        };
        if !frame.is_empty() {
            let names = rules.iter().flat_map(|rule| &rule.names);
            names.into_iter().try_for_each(|name| check_name(name, table, "bonds"))?;
        }
        // Types that the same names match are one class.
        let mut classes: Vec<Vec<[bool; 2]>> = Vec::new();
        let class = table.iter().map(|kind| {
            let matched =
                rules.iter().map(|rule| rule.names.each_ref().map(|name| is_named(kind, name)));
            let matched: Vec<[bool; 2]> = matched.collect();
            classes.iter().position(|own| *own == matched).unwrap_or_else(|| {
                classes.push(matched);
                classes.len() - 1
            })
        });
        let class = class.collect();
        let length = |one: usize, other: usize| {
            let (one, other) = (&classes[one], &classes[other]);
            let applies =
                |rule: &usize| one[*rule][0] && other[*rule][1] || one[*rule][1] && other[*rule][0];
            // The last rule that applies.
            let rule = (0..rules.len()).rev().find(applies);
            rule.map_or(-1.0, |rule| rules[rule].length)
        };
        let reach = |length: f64| length.next_down();
        Ok(Cutoffs::new(class, classes.len(), |one, other| reach(length(one, other)), 0.0))
    }
}

/// Returns the cutoffs of covalent radii; particles without an element have no bonds.
fn covalent(table: &[Kind], per_angstrom: f64) -> Cutoffs {
    let own = |kind: &Kind| {
        let element = kind.element.filter(|_| !kind.virtual_site)?;
        let role = (element.symbol() == "H", bridges::is_alkali(element));
        element.covalent_radius().map(|radius| (radius, role))
    };
    let mut radii: Vec<Option<(f64, (bool, bool))>> = Vec::new();
    let class = table.iter().map(|kind| {
        let own = own(kind);
        radii.iter().position(|known| *known == own).unwrap_or_else(|| {
            radii.push(own);
            radii.len() - 1
        })
    });
    let class = class.collect();
    let length = |one: usize, other: usize| match (radii[one], radii[other]) {
        (Some((one, roles)), Some((other, others))) => {
            let is_hydride = roles.0 && others.1 || roles.1 && others.0;
            let excess = if is_hydride { HYDRIDE } else { 0.0 };
            (one + other + TOLERANCE + excess) * per_angstrom
        }
        _ => -1.0,
    };
    Cutoffs::new(class, radii.len(), length, LEAST * per_angstrom)
}

impl Cutoffs {
    fn new(
        class: Vec<usize>,
        count: usize,
        length: impl Fn(usize, usize) -> f64,
        least: f64,
    ) -> Self {
        let pairs = || (0..count).flat_map(|one| (0..count).map(move |other| (one, other)));
        let square = |length: f64| if length > 0.0 { length * length } else { -1.0 };
        let squares = pairs().map(|(one, other)| square(length(one, other))).collect();
        let longest = |one: usize| (0..count).map(|other| length(one, other)).fold(0.0, f64::max);
        let reach = (0..count).map(longest).collect();
        Self { class, count, squares, reach, least: least * least }
    }
}

impl BondSource {
    /// Returns whether bonds that a file lists are read.
    pub(crate) fn reads_file(&self) -> bool {
        matches!(self, Self::Auto | Self::File | Self::OfCrystals)
    }

    /// Returns the source for files of a format: bonds of crystals are not read from others.
    pub(crate) fn for_format(&self, format: Format) -> Self {
        match self {
            Self::OfCrystals if !format.is_of_crystals() => Self::None,
            source => source.clone(),
        }
    }

    /// Returns a source that also finds the bonds of particles that have none by this one.
    pub(crate) fn for_all(&self) -> Self {
        match self {
            Self::None | Self::OfCrystals => Self::Auto,
            Self::Auto | Self::File | Self::Rules(_) => self.clone(),
        }
    }
}

impl FromStr for BondSource {
    type Err = String;

    /// Parses `auto`, `file`, `none`, or comma-separated rules such as `C-C<1.7,*-H<1.2`.
    fn from_str(text: &str) -> Result<Self, String> {
        match text.trim() {
            "auto" => Ok(Self::Auto),
            "file" => Ok(Self::File),
            "none" => Ok(Self::None),
            rules if rules.contains('<') => rules.parse().map(Self::Rules),
            other => {
                let near = suggest::question(other, ["auto", "file", "none"]);
                Err(format!(
                    "invalid bonds `{other}`: expected auto, file, none or rules such as \
                     C-C<1.7,*-H<1.2{near}"
                ))
            }
        }
    }
}

impl FromStr for BondRules {
    type Err = String;

    /// Parses comma-separated rules `A-B<LENGTH`: particles of the types or elements `A` and `B` are bonded
    /// if they are less than `LENGTH` apart, in the file's unit. `*` is any type. The last rule for two
    /// types applies.
    fn from_str(text: &str) -> Result<Self, String> {
        let rules = text.split(',').map(rule).collect::<Result<Vec<_>, String>>()?;
        Ok(Self { rules: Some(rules) })
    }
}

fn rule(text: &str) -> Result<Rule, String> {
    let text = text.trim();
    let wrong = |why: String| format!("invalid rule `{text}` for bonds: {why}, as in C-C<1.7");
    let PairRule { names, length } = text.parse().map_err(wrong)?;
    let length = length.ok_or_else(|| wrong("expected A-B<LENGTH".to_owned()))?;
    Ok(Rule { names, length })
}

/// Two types or elements, and perhaps the length within which particles of them are meant.
#[derive(Clone, Debug, PartialEq)]
pub struct PairRule {
    /// The names; `*` is any type.
    pub names: [String; 2],
    /// The length, 0 or more, in the file's unit.
    pub length: Option<f64>,
}

impl FromStr for PairRule {
    type Err = String;

    /// Parses `A-B` or `A-B<LENGTH`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (pair, length) = match text.split_once('<') {
            None => (text, None),
            Some((pair, length)) => (pair, Some(length.trim_start_matches('=').trim())),
        };
        let length = length.map(|length| {
            let number = length.parse().ok();
            let number = number.filter(|number: &f64| number.is_finite() && *number >= 0.0);
            number.ok_or_else(|| format!("`{length}` is not a length"))
        });
        let length = length.transpose()?;
        // Names may end with the sign of a charge, as in `O2--H`.
        let names =
            pair.match_indices('-').map(|(at, _)| [pair[..at].trim(), pair[at + 1..].trim()]);
        let complete = |names: &[&str; 2]| names.iter().all(|name| !name.is_empty());
        let mut names = { names }.filter(complete);
        let first = names.next().ok_or("expected two types with a `-` between them")?;
        let chosen = names.find(|names| names[0].ends_with('-') && !names[1].starts_with('-'));
        Ok(Self { names: chosen.unwrap_or(first).map(str::to_owned), length })
    }
}

impl PairRule {
    /// Returns the types that each of the names stands for, by rows of their table; `what` is what the rule is for.
    ///
    /// # Errors
    ///
    /// A message: there is no such type.
    pub fn kinds(&self, table: &[Kind], what: &str) -> Result<[Vec<bool>; 2], String> {
        self.names.iter().try_for_each(|name| check_name(name, table, what))?;
        let named = |name: &String| table.iter().map(|kind| is_named(kind, name)).collect();
        Ok(self.names.each_ref().map(named))
    }
}

/// Returns whether a rule's name is that of a type or of its element, or stands for all types.
fn is_named(kind: &Kind, name: &str) -> bool {
    let element = || kind.element.is_some_and(|element| element.symbol() == name);
    name == ANY || kind.name == *name || element()
}

fn check_name(name: &str, table: &[Kind], what: &str) -> Result<(), String> {
    if name == ANY || table.iter().any(|kind| is_named(kind, name)) {
        return Ok(());
    }
    let mut names: Vec<&str> = table.iter().map(|kind| kind.name.as_str()).collect();
    names.extend(table.iter().filter_map(|kind| Some(kind.element?.symbol())));
    names.sort_unstable();
    names.dedup();
    let help = suggest::help(name, names.into_iter(), "there are");
    Err(clipped(format!("has no type `{name}` for a rule of {what}; {help}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Vec<(String, String, f64)>, String> {
        match text.parse()? {
            BondSource::Rules(BondRules { rules }) => Ok(rules
                .expect("rules")
                .into_iter()
                .map(|Rule { names: [one, other], length }| (one, other, length))
                .collect()),
            other => Err(format!("{other:?}")),
        }
    }

    #[test]
    fn sources_are_words_or_rules() {
        assert_eq!("auto".parse(), Ok(BondSource::Auto));
        assert_eq!(" file".parse(), Ok(BondSource::File));
        assert_eq!("none".parse(), Ok(BondSource::None));
        let rule = |one: &str, other: &str, length| (one.to_owned(), other.to_owned(), length);
        assert_eq!(parse("C-C<1.7, *-H < 1.2"), Ok(vec![rule("C", "C", 1.7), rule("*", "H", 1.2)]));
        assert_eq!(parse("1-2<=1e0"), Ok(vec![rule("1", "2", 1.0)]));
        assert_eq!(parse("O2--Fe3+<2"), Ok(vec![rule("O2-", "Fe3+", 2.0)]));
    }

    #[test]
    fn invalid_rules_are_named() {
        for (text, part) in [
            ("", "invalid bonds ``"),
            ("fiel", "did you mean `file`"),
            ("C-C", "invalid bonds `C-C`"),
            ("C<1", "invalid rule `C<1`"),
            ("-C<1", "two types"),
            ("C-<1", "two types"),
            ("C-C<x", "`x` is not a length"),
            ("C-C<-1", "`-1` is not a length"),
            ("C-C<nan", "`nan` is not a length"),
            ("C-C<1,", "invalid rule ``"),
        ] {
            let error = text.parse::<BondSource>().expect_err(text);
            assert!(error.contains(part), "{text}: {error}");
        }
    }
}
