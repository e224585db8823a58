//! Table of space group settings (choices of axes and origin) by Hermann-Mauguin symbol or number
//! (International Tables for Crystallography A).

use super::hall;
use super::symmetry::Operation;

/// Settings of International Tables in numerical order, then, after a blank line, other common ones.
/// Each line has the number with a choice of origin (1 or 2) or of hexagonal or rhombohedral axes (H or
/// R), the Hall symbol, and Hermann-Mauguin symbols. The crate `moyo` has them too, but depends on
/// `nalgebra` and 25 other crates to detect symmetry in atoms, which is not needed.
const TABLE: &str = include_str!("space_groups.txt");

/// A setting of a space group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Setting {
    pub(super) number: u32,
    /// Choice of origin or axes: `1`, `2`, `H`, `R` or empty.
    pub(super) choice: &'static str,
    hall: &'static str,
    names: &'static str,
}

/// A Hermann-Mauguin symbol in normalized spelling.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Symbol {
    key: String,
    /// Choice of origin or axes in the symbol, in upper case.
    pub(super) choice: Option<String>,
}

impl Setting {
    /// Returns all settings, the standard one of each group first.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        Self::parse(TABLE)
    }

    fn parse(table: &'static str) -> impl Iterator<Item = Self> {
        table.lines().filter_map(|line| {
            let mut columns = line.split('\t');
            let number = columns.next()?;
            let (number, choice) = number.split_once(':').unwrap_or((number, ""));
            let (hall, names) = (columns.next()?, columns.next()?);
            Some(Self { number: number.parse().ok()?, choice, hall, names })
        })
    }

    /// Returns the settings of a group in International Tables, by its number.
    pub(super) fn of_number(number: u32) -> Vec<Self> {
        let usual = TABLE.split("\n\n").next().unwrap_or(TABLE);
        Self::parse(usual).filter(|setting| setting.number == number).collect()
    }

    /// Returns the settings that a symbol may mean, ignoring its choice of origin or axes.
    pub(super) fn of_symbol(symbol: &Symbol) -> Vec<Self> {
        Self::all().filter(|setting| setting.is_named(&symbol.key)).collect()
    }

    /// Returns the symbol without the choice of origin or axes.
    pub(super) fn axes_name(&self) -> &'static str {
        self.names.split(", ").next().unwrap_or(self.names)
    }

    /// Returns the symbol with the choice of origin or axes, as in `R -3 c:H`.
    pub(super) fn name(&self) -> String {
        let colon = if self.choice.is_empty() { "" } else { ":" };
        format!("{}{colon}{}", self.axes_name(), self.choice)
    }

    /// Returns its symmetry operations, the identity first.
    pub(super) fn operations(&self) -> Vec<Operation> {
        hall::operations(self.hall).unwrap_or_default()
    }

    fn is_named(&self, key: &str) -> bool {
        self.names.split(", ").any(|name| {
            let full = normalized(name);
            let axes = name.split(' ').filter(|axis| *axis != "1");
            full == key
                // Short monoclinic symbols without the axes that have no symmetry: P 21/c.
                || (3..=15).contains(&self.number) && normalized(&axes.collect::<String>()) == key
                // Cubic symbols before 1935: F d 3 m.
                || self.number >= 195 && full.replace("-3", "3") == key
        })
    }
}

impl Symbol {
    /// Parses a symbol such as `R -3 c :H`, `Fd-3m (origin choice 2)`, `P2(1)/c` or `F d -3 m Z`.
    pub(super) fn new(text: &str) -> Self {
        let text = text.to_ascii_lowercase();
        if let Some((name, choice)) = text.split_once(':') {
            let choice = choice.trim().get(..1).filter(|choice| "12hr".contains(choice));
            return Self::of(name, choice);
        }
        for (word, choice) in [("hexagonal", "h"), ("rhombohedral", "r")] {
            if let Some((name, _)) = text.split_once(word) {
                return Self::of(name, Some(choice));
            }
        }
        if let Some((name, origin)) = text.split_once("origin") {
            let choice = ["1", "2"].into_iter().find(|choice| origin.contains(choice));
            return Self::of(name, choice);
        }
        // Suffixes of databases; no symbol has them itself.
        let key = normalized(&text);
        let endings = [("hr", "h"), ("h", "h"), ("r", "r"), ("o1", "1"), ("o2", "2"), ("s", "1")];
        for (ending, choice) in endings.into_iter().chain([("z", "2")]) {
            if let Some(name) = key.strip_suffix(ending).filter(|name| name.len() > 1) {
                return Self::of(name, Some(choice));
            }
        }
        Self::of(&key, None)
    }

    fn of(name: &str, choice: Option<&str>) -> Self {
        Self { key: normalized(name), choice: choice.map(str::to_ascii_uppercase) }
    }
}

/// Removes blanks, underscores and parentheses from a symbol, and makes it lower case.
fn normalized(symbol: &str) -> String {
    let kept = symbol.chars().filter(|letter| !letter.is_whitespace() && !"_()".contains(*letter));
    kept.map(|letter| letter.to_ascii_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(text: &str) -> Vec<String> {
        let symbol = Symbol::new(text);
        let settings = Setting::of_symbol(&symbol).into_iter();
        let chosen = |setting: &Setting| {
            symbol.choice.as_deref().is_none_or(|choice| choice == setting.choice)
        };
        settings.filter(chosen).map(|setting| setting.name()).collect()
    }

    #[test]
    fn symbols_are_found_in_all_their_spellings() {
        for (texts, names) in [
            (&["P 1 21/c 1", "P121/c1", "P 1 2_1/c 1", "P 1 2(1)/c 1"][..], &["P 1 21/c 1"][..]),
            (&["P 21/c", "P2(1)/C", "P_2_1_/_c"], &["P 1 21/c 1", "P 21/c 1 1"]),
            (&["B 2/b"], &["B 1 1 2/b", "B 2/b 1 1"]),
            (
                &["R -3 c :H", "R-3c:h", "R -3 c H", "H -3 c", "R -3 2/c (hexagonal axes)"],
                &["R -3 c:H"],
            ),
            (&["R -3 c :R", "R -3 c r"], &["R -3 c:R"]),
            (&["R -3 c", "R -3 2/c"], &["R -3 c:H", "R -3 c:R"]),
            (&["F d -3 m", "F d 3 m", "Fd3m", "F 41/d -3 2/m"], &["F d -3 m:1", "F d -3 m:2"]),
            (&["F d -3 m Z", "Fd-3m:2", "F d 3 m (origin choice 2)", "Fd-3m O2"], &["F d -3 m:2"]),
            (&["F d -3 m S", "F d 3 m :1"], &["F d -3 m:1"]),
            (&["C m c e", "C m c a", "Cmca", "C 2/m 2/c 21/e"], &["C m c a"]),
            (&["P 21 21 21", "P2(1)2(1)2(1)", "p212121"], &["P 21 21 21"]),
            (&["P b n m", "P 21/b 21/n 21/m"], &["P b n m"]),
            (&["C -1"], &["C -1"]),
            (&["P 7", "", "?", "Q m", ":1", "h"], &[]),
        ] {
            for text in texts {
                assert_eq!(found(text), names, "{text}");
            }
        }
    }

    #[test]
    fn symbols_of_settings_are_unique() {
        for setting in Setting::all() {
            for name in setting.names.split(", ") {
                let same = Setting::of_symbol(&Symbol::new(name));
                assert!(same.contains(&setting), "{name}");
                assert!(same.iter().all(|same| same.number == setting.number), "{name}: {same:?}");
            }
        }
        let numbers: std::collections::BTreeSet<u32> =
            Setting::all().map(|setting| setting.number).collect();
        assert_eq!(numbers, (1..=230).collect());
    }
}
