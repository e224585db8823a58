//! Atom styles: the columns of the section `Atoms` of a LAMMPS data file
//! (<https://docs.lammps.org/read_data.html>).

use crate::{Cell, number};
use glam::{DMat3, DVec3};
use std::collections::{HashMap, HashSet};

/// Atom styles and their columns, the most common first. A style is listed twice if LAMMPS reads and
/// writes other columns than its manual documents: those that it reads come first.
const STYLES: [(&str, &str); 36] = [
    ("atomic", "id type x y z"),
    ("full", "id mol type q x y z"),
    ("molecular", "id mol type x y z"),
    ("bond", "id mol type x y z"),
    ("angle", "id mol type x y z"),
    // Precedes styles that fit any nine numbers, because it fits only unit vectors.
    ("spin", "id type x y z spx spy spz sp"),
    ("charge", "id type q x y z"),
    ("sphere", "id type diameter density x y z"),
    ("dipole", "id type q x y z mux muy muz"),
    ("ellipsoid", "id type ellipsoidflag density x y z"),
    ("bpm/sphere", "id mol type diameter density x y z"),
    ("line", "id mol type lineflag density x y z"),
    ("tri", "id mol type triangleflag density x y z"),
    ("body", "id type bodyflag mass x y z"),
    ("electron", "id type q espin eradius x y z"),
    ("template", "id mol template_index template_atom type x y z"),
    ("template", "id type mol template_index template_atom x y z"),
    ("peri", "id type volume density x y z"),
    ("edpd", "id type edpd_temp edpd_cv x y z"),
    ("mdpd", "id type rho x y z"),
    ("dpd", "id type theta x y z"),
    ("sph", "id type rho esph cv x y z"),
    ("meso", "id type rho esph cv x y z"),
    ("smd", "id type mol volume mass kradius radius x0 y0 z0 x y z"),
    ("rheo", "id type status rho x y z"),
    ("rheo/thermal", "id type status rho energy x y z"),
    ("dielectric", "id mol type q x y z mux muy muz area ed em epsilon curvature"),
    ("dielectric", "id type q x y z mux muy muz area ed em epsilon curvature"),
    ("amoeba", "id mol type q x y z"),
    ("mesont", "id mol type bond_nt_1 bond_nt_2 mass mradius mlength buckling x y z"),
    ("mesont", "id mol type bond_nt mass mradius mlength buckling x y z"),
    ("wavepacket", "id type q espin eradius etag cs_re cs_im x y z"),
    ("apip", "id type x y z"),
    ("oxdna", "id type x y z"),
    // Any number of concentrations follows.
    ("tdpd", "id type x y z"),
    // The columns of its sub-styles follow.
    ("hybrid", "id type x y z"),
];

/// Columns of every style; `hybrid` begins with them.
const COMMON: [&str; 5] = ["id", "type", "x", "y", "z"];

/// Synonymous columns, which `hybrid` lists once; the first name is that of the property in LAMMPS.
const SYNONYMS: [&[&str]; 3] = [
    &["rmass", "density", "mass"],
    &["radius", "diameter", "kradius", "mradius"],
    &["esph", "energy"],
];

/// Objects that a header counts, with the styles that have them.
const OWNERS: [(&str, &[&str]); 8] = [
    (
        "bonds",
        &["full", "molecular", "bond", "angle", "bpm/sphere", "dielectric", "amoeba", "oxdna"],
    ),
    ("angles", &["full", "molecular", "angle", "dielectric", "amoeba"]),
    ("dihedrals", &["full", "molecular", "dielectric", "amoeba"]),
    ("impropers", &["full", "molecular", "dielectric", "amoeba"]),
    ("ellipsoids", &["ellipsoid"]),
    ("lines", &["line"]),
    ("triangles", &["tri"]),
    ("bodies", &["body"]),
];

/// Number of image flags, which may follow the columns of any style.
const IMAGES: usize = 3;

/// Maximum number of styles in a message.
const LISTED: usize = 5;

/// Returns the names of all atom styles in alphabetical order.
pub(super) fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = STYLES.map(|(name, _)| name).into();
    names.sort_unstable();
    names.dedup();
    names
}

/// Possible columns of the section `Atoms`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    /// The atom style.
    pub(super) style: String,
    /// Names of the columns.
    pub(super) columns: Vec<String>,
    /// True if an unknown number of other columns follows.
    open: bool,
}

impl Layout {
    fn new(style: &str, columns: &str) -> Self {
        let columns = columns.split(' ').map(str::to_owned).collect();
        Self { style: style.to_owned(), columns, open: ["tdpd", "hybrid"].contains(&style) }
    }

    /// Returns the possible layouts of an atom style, the most likely first; none if the style is
    /// unknown. `hybrid` is followed by its sub-styles.
    pub(super) fn of_style(style: &str) -> Vec<Self> {
        let style = style.to_ascii_lowercase();
        let mut words = style.split_whitespace().map(without_accelerator);
        match words.next() {
            Some("hybrid") => hybrid(&words.collect::<Vec<_>>()),
            first => table(first.unwrap_or_default()).collect(),
        }
    }

    fn position(&self, name: &str) -> Option<usize> {
        self.columns.iter().position(|own| own == name)
    }
}

fn table(style: &str) -> impl Iterator<Item = Layout> {
    let own = STYLES.iter().filter(move |(name, _)| *name == style);
    own.map(|(name, columns)| Layout::new(name, columns))
}

/// Strips the suffix of an accelerator package from a style.
fn without_accelerator(style: &str) -> &str {
    let suffixes = ["/kk", "/omp", "/intel", "/gpu", "/cuda"];
    suffixes.iter().find_map(|suffix| style.strip_suffix(suffix)).unwrap_or(style)
}

/// Returns the layouts of a hybrid style: LAMMPS lists a property of several sub-styles once; before
/// 2020, it listed the property for each of them.
fn hybrid(words: &[&str]) -> Vec<Layout> {
    let subs: Vec<Layout> = words.iter().filter_map(|word| table(word).next()).collect();
    let style = ["hybrid"].into_iter().chain(subs.iter().map(|sub| &sub.style[..]));
    let style = style.collect::<Vec<_>>().join(" ");
    // An unknown word may be an argument of a style, or an unsupported style.
    let open = subs.len() < words.len() || subs.is_empty() || subs.iter().any(|sub| sub.open);
    let layout = |repeats: bool| {
        let mut layout =
            Layout { style: style.clone(), columns: COMMON.map(str::to_owned).into(), open };
        let mut there: HashSet<&str> = HashSet::new();
        for sub in &subs {
            for column in sub.columns.iter().filter(|column| !COMMON.contains(&column.as_str())) {
                let is_new = there.insert(property(column));
                if is_new {
                    layout.columns.push(column.clone());
                } else if repeats {
                    let name = format!("{column}_{}", layout.columns.len() + 1);
                    layout.columns.push(name);
                }
            }
            if sub.open {
                break;
            }
        }
        layout
    };
    let (once, each) = (layout(false), layout(true));
    if once == each { vec![once] } else { vec![once, each] }
}

/// Returns the name in LAMMPS of the property in a column.
fn property(column: &str) -> &str {
    SYNONYMS.iter().find(|names| names.contains(&column)).map_or(column, |names| names[0])
}

/// Properties of the rows, as declared in the header.
#[derive(Default)]
pub(super) struct Facts<'h> {
    /// Number of atom types; 0 if the header has none.
    pub(super) types: u64,
    /// Names of the types.
    pub(super) labels: HashSet<&'h str>,
    /// Counts of bonds, ellipsoids and the like, by their names in the header.
    pub(super) counts: HashMap<&'static str, u64>,
    pub(super) cell: Option<Cell>,
}

/// Returns the names of the objects that a header counts.
pub(super) fn counted() -> impl Iterator<Item = &'static str> {
    OWNERS.iter().map(|(name, _)| *name)
}

/// Sample of the rows of `Atoms`, with a summary of each column.
pub(super) struct Sample {
    rows: Vec<Vec<String>>,
    columns: Vec<Summary>,
}

/// Common properties of all values of a column.
#[derive(Clone, Copy)]
struct Summary {
    finite: bool,
    integral: bool,
    least: f64,
    greatest: f64,
}

impl Summary {
    fn of<'v>(values: impl Iterator<Item = &'v String>) -> Self {
        let mut summary =
            Self { finite: true, integral: true, least: f64::MAX, greatest: f64::MIN };
        for value in values {
            let value = number::parse(value.as_bytes()).unwrap_or(f64::NAN);
            summary.finite &= value.is_finite();
            summary.integral &= value.fract() == 0.0;
            summary.least = summary.least.min(value);
            summary.greatest = summary.greatest.max(value);
        }
        summary
    }

    /// Returns whether all values are whole numbers of at least `least`.
    fn is_whole(self, least: f64) -> bool {
        self.integral && self.least >= least
    }
}

impl Sample {
    pub(super) fn new(rows: Vec<Vec<String>>) -> Self {
        let width = rows.iter().map(Vec::len).min().unwrap_or(0);
        let column = |at: usize| Summary::of(rows.iter().map(move |row| &row[at]));
        let columns = (0..width).map(column).collect();
        Self { rows, columns }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Returns the number of columns of every row.
    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    fn is_even(&self) -> bool {
        self.rows.iter().all(|row| row.len() == self.width())
    }

    /// Returns whether columns 6 to 8 are unit vectors, or zero for some rows.
    fn has_spins(&self) -> bool {
        let length = |row: &Vec<String>| {
            let value = |text: &String| number::parse(text.as_bytes()).unwrap_or(f64::NAN);
            row[5..8].iter().map(|text| value(text).powi(2)).sum::<f64>()
        };
        let is_unit = |length: f64| (0.98..1.02).contains(&length);
        self.rows.iter().map(length).all(|length| length == 0.0 || is_unit(length))
            && self.rows.iter().map(length).any(is_unit)
    }

    fn same(&self, first: usize, second: usize) -> bool {
        first == second || self.rows.iter().all(|row| row[first] == row[second])
    }
}

/// The chosen layout, with reasons why it may be wrong.
pub(super) struct Chosen {
    pub(super) layout: Layout,
    /// A reason against a layout that was named.
    pub(super) misfit: Option<String>,
    /// Other styles that fit equally well but would place different spheres.
    pub(super) others: Vec<&'static str>,
}

impl Chosen {
    /// Returns a warning that the layout is a guess.
    pub(super) fn warning(&self) -> String {
        let style = &self.layout.style;
        if self.others.is_empty() {
            return format!(
                "names no atom style; its columns look like `{style}`, and --atom-style names another"
            );
        }
        format!(
            "names no atom style, and is read as `{style}`, though its columns may also be those of {}; \
             name the style with --atom-style",
            self.others.join(", ")
        )
    }
}

impl Facts<'_> {
    /// Returns the best layout of a style; `None` if the style is unknown.
    pub(super) fn named(&self, style: &str, sample: &Sample) -> Option<Chosen> {
        let layouts = Layout::of_style(style);
        let fits = |layout: &&Layout| self.misfit(layout, sample, true).is_none();
        let layout = layouts.iter().find(fits).or(layouts.first())?.clone();
        let misfit = self.misfit(&layout, sample, true);
        Some(Chosen { layout, misfit, others: Vec::new() })
    }

    /// Returns the most common of the styles that fit best, if any fits.
    pub(super) fn guess(&self, sample: &Sample) -> Option<Chosen> {
        let all = STYLES.iter().map(|(style, columns)| (*style, Layout::new(style, columns)));
        let fits = |layout: &Layout| self.misfit(layout, sample, false).is_none();
        let fitting: Vec<(&str, Layout)> =
            all.filter(|(_, layout)| !layout.open && fits(layout)).collect();
        let likelihood = |layout: &Layout| self.likelihood(layout, sample);
        let Some(best) = fitting.iter().map(|(_, layout)| likelihood(layout)).max() else {
            let layout = Layout::of_style("hybrid").pop()?;
            let inside = self.cell.is_some() && self.likelihood(&layout, sample) == (10, true);
            let chosen = Chosen { layout, misfit: None, others: Vec::new() };
            return Some(chosen).filter(|chosen| inside && fits(&chosen.layout));
        };
        let mut best = fitting.into_iter().filter(|(_, layout)| likelihood(layout) == best);
        let (_, layout) = best.next()?;
        let mut others: Vec<&str> = best
            .filter(|(_, other)| !place_same_spheres(&layout, other, sample))
            .map(|(name, _)| name)
            .collect();
        others.dedup();
        others.truncate(LISTED);
        Some(Chosen { layout, misfit: None, others })
    }

    /// Returns a reason why rows cannot have a layout, if there is one. A `named` layout need only
    /// meet the requirements of LAMMPS.
    fn misfit(&self, layout: &Layout, sample: &Sample, named: bool) -> Option<String> {
        let (width, columns) = (sample.width(), layout.columns.len());
        let images = || sample.columns[columns..].iter().all(|column| column.integral);
        let fits = match width.checked_sub(columns) {
            Some(0) => true,
            Some(IMAGES) => layout.open || images(),
            Some(_) => layout.open,
            None => false,
        };
        if sample.is_empty() {
            return None;
        }
        if !(sample.is_even() || named && width >= columns) {
            return Some("its rows have different numbers of columns".to_owned());
        }
        if !fits && sample.is_even() {
            let least = if layout.open { "at least " } else { "" };
            return Some(format!("it has {least}{columns} columns, and the rows have {width}"));
        }
        let mut columns = layout.columns.iter().zip(&sample.columns).enumerate();
        let fault = columns.find_map(|(at, (name, column))| match name.as_str() {
            "type" => self.type_fault(at, sample, named),
            name if named && !COMMON.contains(&name) => None,
            name if self.may_be(name, *column) => None,
            name => Some(format!("column {} cannot be `{name}`", at + 1)),
        });
        let owners = || {
            let mut there = OWNERS.iter().filter(|(thing, _)| self.count(thing) > 0);
            there.find(|(_, owners)| {
                !named && !layout.open && !owners.contains(&layout.style.as_str())
            })
        };
        let spins = || {
            let is_spin = layout.style == "spin" && !named && !sample.has_spins();
            is_spin.then(|| "its spins would not be unit vectors".to_owned())
        };
        fault.or_else(|| Some(format!("it has no {}", owners()?.0))).or_else(spins)
    }

    fn count(&self, thing: &str) -> u64 {
        self.counts.get(thing).copied().unwrap_or(0)
    }

    /// Returns whether values are valid in the column `name`, which is not that of types.
    fn may_be(&self, name: &str, column: Summary) -> bool {
        let flag =
            |things: &str| column.is_whole(0.0) && column.greatest <= 1.0 && self.count(things) > 0;
        match name {
            "id" | "mol" | "template_index" | "template_atom" | "etag" | "status" => {
                column.is_whole(0.0)
            }
            "ellipsoidflag" => flag("ellipsoids"),
            "lineflag" => flag("lines"),
            "triangleflag" => flag("triangles"),
            "bodyflag" => flag("bodies"),
            "espin" => column.is_whole(-1.0) && column.greatest <= 3.0,
            "bond_nt" | "bond_nt_1" | "bond_nt_2" | "buckling" => column.is_whole(-1.0),
            "diameter" | "radius" | "kradius" | "eradius" | "mradius" | "theta" => {
                column.finite && column.least >= 0.0
            }
            "density" | "mass" | "volume" | "mlength" | "edpd_cv" | "cv" => {
                column.finite && column.least > 0.0
            }
            _ => column.finite,
        }
    }

    /// Returns the message for a value that is not a type in the header, if there is one.
    fn type_fault(&self, at: usize, sample: &Sample, named: bool) -> Option<String> {
        let is_type = |value: &&String| {
            let number = number::whole(value.as_bytes());
            number.is_some_and(|number| self.has_type(number))
                || self.labels.contains(value.as_str())
                // Labels may be defined in the simulation's input script.
                || named && self.labels.is_empty() && value.starts_with(|first: char| first.is_alphabetic())
        };
        let value = sample.rows.iter().map(|row| &row[at]).find(|value| !is_type(value))?;
        let types = self.types;
        Some(format!("a type would be {value}, but the header has {types} atom types"))
    }

    /// Returns whether a number is a valid type.
    pub(super) fn has_type(&self, number: u64) -> bool {
        (1..=if self.types > 0 { self.types } else { u64::MAX }).contains(&number)
    }

    /// Returns the fraction of positions in the box, in tenths, and whether most are not whole numbers,
    /// as positions usually are.
    fn likelihood(&self, layout: &Layout, sample: &Sample) -> (usize, bool) {
        let Some(x) = layout.position("x") else { return (0, false) };
        let Some(columns) = sample.columns.get(x..x + 3) else { return (0, false) };
        let not_whole = sample.rows.len() < 3 || !columns[..2].iter().all(|column| column.integral);
        let Some(cell) = self.cell else { return (0, not_whole) };
        let [a, b, c] = cell.vectors;
        let inverse = DMat3::from_cols(a, b, c).inverse();
        let is_inside = |row: &&Vec<String>| {
            let value = |at: usize| number::parse(row[at].as_bytes()).unwrap_or(f64::NAN);
            let point = DVec3::new(value(x), value(x + 1), value(x + 2));
            let fractional = inverse * (point - cell.origin);
            fractional.to_array().iter().all(|share| (-0.01..=1.01).contains(share))
        };
        let inside = sample.rows.iter().filter(is_inside).count();
        (inside * 10 / sample.rows.len().max(1), not_whole)
    }
}

/// Returns whether two layouts give the same positions and types.
fn place_same_spheres(first: &Layout, second: &Layout, sample: &Sample) -> bool {
    let same_column = |name: &str| match (first.position(name), second.position(name)) {
        (Some(first), Some(second)) => sample.same(first, second),
        (first, second) => first == second,
    };
    ["type", "x", "y", "z", "radius", "diameter"].into_iter().all(same_column)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(rows: &[&str]) -> Sample {
        Sample::new(rows.iter().map(|row| row.split(' ').map(str::to_owned).collect()).collect())
    }

    fn of_types(types: u64) -> Facts<'static> {
        Facts { types, ..Facts::default() }
    }

    fn guess(facts: &Facts, rows: &[&str]) -> Vec<String> {
        let Some(chosen) = facts.guess(&sample(rows)) else { return Vec::new() };
        [chosen.layout.style]
            .into_iter()
            .chain(chosen.others.iter().map(|other| (*other).to_owned()))
            .collect()
    }

    #[test]
    fn columns_determine_styles() {
        for (rows, types, expected) in [
            (&["1 1 0.5 1.5 2.5", "2 2 3 4 5.5"][..], 2, &["atomic"][..]),
            (&["1 1 0.5 1.5 2.5 0 0 -1"], 1, &["atomic"]),
            (&["1 1 -0.8 0.5 1.5 2.5", "2 2 0.4 3 4 5.5"], 2, &["charge"]),
            (&["1 7 1 0.5 1.5 2.5", "2 8 2 3 4 5.5"], 2, &["molecular"]),
            (&["1 1 1 0.5 1.5 2.5", "2 1 2 3 4 5.5"], 2, &["molecular", "charge", "mdpd", "dpd"]),
            (&["1 7 1 -0.8 0.5 1.5 2.5", "2 7 2 0.4 3 4 5.5"], 2, &["full"]),
            (
                &["1 1 27.01 1 21.5 19.8 0 0 0 0", "2 1 1.2 1 4.5 2.0 0 0 0 0"],
                1,
                &["sphere", "peri", "edpd"],
            ),
            (&["1 1 1 1.0 0.5 1.5 2.5", "2 1 1 1.0 3 4 5.5"], 1, &["full", "sphere"]),
            (&["1 7 3 2 2 0.5 1.5 2.5", "2 7 3 4 1 3 4 5.5"], 2, &["template"]),
            (&["1 1 0.5"], 1, &[]),
            (&["1 1 a b c"], 1, &[]),
            (&["1 3 0.5 1.5 2.5"], 2, &[]),
        ] {
            let found = guess(&of_types(types), rows);
            assert_eq!(found[..expected.len().min(found.len())], *expected, "{rows:?}: {found:?}");
            assert_eq!(found.is_empty(), expected.is_empty(), "{rows:?}");
        }
    }

    #[test]
    fn boxes_and_counts_of_the_header_determine_styles() {
        let vectors = [DVec3::X * 10.0, DVec3::Y * 10.0, DVec3::Z * 10.0];
        let cell = Some(Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] });
        let rows = ["1 1 1 1 50 0.5 1.5 2.5", "2 1 1 2 60 3.5 4 5.5"];
        let in_box = Facts { types: 2, cell, ..Facts::default() };
        assert_eq!(guess(&in_box, &rows)[0], "bpm/sphere");
        let rows = ["1 1 1 50 0.5 1.5 2.5", "2 1 0 60 3.5 4 5.5"];
        let ellipsoids = Facts { counts: [("ellipsoids", 1)].into(), types: 1, ..Facts::default() };
        assert_eq!(guess(&ellipsoids, &rows), ["ellipsoid"]);
        let bonds = Facts { counts: [("bonds", 1)].into(), types: 1, ..Facts::default() };
        assert_eq!(guess(&bonds, &["1 1 1 1 0.5 1.5 2.5", "2 1 1 1 3.5 4 5.5"]), ["full"]);
        // A unit vector and its length, or a charge before a position with image flags.
        assert_eq!(guess(&in_box, &["1 2 0.5 1.5 2.5 0 0 -1 2.2"])[0], "spin");
        assert_eq!(guess(&in_box, &["1 2 0.5 1.5 2.5 9.5 0 0 -1"]), ["charge"]);
        // Rows that fit no style: only positions are read, if they are in the box.
        let unknown = [
            "1 1 0.5 1.5 2.5 7.5 0 0 0 0 0 0 0 0 0 0.5",
            "2 2 3.5 4.5 5.5 8 0 0 0 0 0 0 0 0 0 0.5",
        ];
        assert_eq!(guess(&in_box, &unknown), ["hybrid"]);
        assert!(guess(&of_types(2), &unknown).is_empty());
    }

    #[test]
    fn hybrid_styles_list_a_property_once_or_for_each() {
        let columns = |style: &str| -> Vec<String> {
            let layouts = Layout::of_style(style);
            layouts.iter().map(|layout| layout.columns[5..].join(" ")).collect()
        };
        assert_eq!(columns("hybrid charge sphere"), ["q diameter density"]);
        assert_eq!(columns("hybrid dipole full"), ["q mux muy muz mol", "q mux muy muz mol q_11"]);
        assert_eq!(
            columns("Hybrid sphere ellipsoid/kk"),
            ["diameter density ellipsoidflag", "diameter density ellipsoidflag density_9"]
        );
        assert_eq!(
            columns("hybrid body nparticle 2 5 sphere"),
            ["bodyflag mass diameter", "bodyflag mass diameter density_9"]
        );
        assert_eq!(columns("hybrid"), [""]);
        assert!(columns("granite").is_empty() && columns("").is_empty());
    }

    /// Returns why rows don't fit a style that the file names; empty if they do.
    fn misfit(facts: &Facts, style: &str, rows: &[&str]) -> String {
        facts.named(style, &sample(rows)).expect("a style").misfit.unwrap_or_default()
    }

    fn summary(values: &str) -> Summary {
        let values: Vec<String> = values.split(' ').map(str::to_owned).collect();
        Summary::of(values.iter())
    }

    #[test]
    fn named_styles_need_only_ids_types_and_positions() {
        let bonds = Facts { counts: [("bonds", 1)].into(), types: 1, ..Facts::default() };
        for (style, rows, expected) in [
            ("atomic", &["1 1 0.5 1.5 2.5"][..], ""),
            ("atomic", &[], ""),
            ("sphere", &["1 1 -1 -1 0.5 1.5 2.5"], ""),
            ("spin", &["1 1 0.5 1.5 2.5 9 9 9 9"], ""),
            ("atomic", &["1 1 0.5 1.5 2.5 0 0 0.5"], "it has 5 columns, and the rows have 8"),
            ("atomic", &["1 1 0.5 1.5"], "it has 5 columns, and the rows have 4"),
            ("tdpd", &["1 1 0.5 1.5"], "it has at least 5 columns, and the rows have 4"),
            ("tdpd", &["1 1 0.5 1.5 2.5 0 0 0.5"], ""),
            ("atomic", &["1 1 0.5 far 2.5"], "column 4 cannot be `y`"),
            ("atomic", &["1.5 1 0.5 1.5 2.5"], "column 1 cannot be `id`"),
            // Some rows may have surplus columns.
            ("atomic", &["1 1 0.5 1.5 2.5 7", "2 1 3 4 5.5 7 8 9"], ""),
            (
                "atomic",
                &["1 1 0.5 1.5", "2 1 3 4 5.5"],
                "its rows have different numbers of columns",
            ),
        ] {
            assert_eq!(misfit(&bonds, style, rows), expected, "{style} {rows:?}");
        }
        let uneven = ["1 1 0.5 1.5 2.5", "2 1 3 4 5.5 0 0 0"];
        assert!(guess(&of_types(1), &uneven).is_empty());
    }

    #[test]
    fn names_of_columns_constrain_their_values() {
        let things = ["ellipsoids", "lines", "triangles", "bodies"];
        let facts = Facts { counts: things.map(|thing| (thing, 1)).into(), ..Facts::default() };
        for (names, good, bad) in [
            (
                "id mol template_index template_atom etag status",
                "0 7",
                &["-1 7", "0 0.5", "0 x"][..],
            ),
            ("ellipsoidflag lineflag triangleflag bodyflag", "0 1", &["0 2", "-1 1", "0 0.5"]),
            ("espin", "-1 3", &["-2 3", "-1 4", "0 0.5"]),
            ("bond_nt bond_nt_1 bond_nt_2 buckling", "-1 9", &["-2 9", "0 0.5"]),
            ("diameter radius kradius eradius mradius theta", "0 2.5", &["-0.5 2.5", "0 inf"]),
            ("density mass volume mlength edpd_cv cv", "0.5 2.5", &["0 2.5", "-1 2.5", "1 inf"]),
            ("x q mux", "-0.5 7", &["0 inf", "0 nan", "x 0"]),
        ] {
            for name in names.split(' ') {
                assert!(facts.may_be(name, summary(good)), "{name}: {good}");
                for bad in bad {
                    assert!(!facts.may_be(name, summary(bad)), "{name}: {bad}");
                }
            }
        }
        // No atom is an ellipsoid if the header counts none.
        assert!(!Facts::default().may_be("ellipsoidflag", summary("0 1")));
    }

    #[test]
    fn columns_are_summarized() {
        for (values, finite, integral, range) in [
            ("1 2.5 -3", true, false, (-3.0, 2.5)),
            ("2.5 1", true, false, (1.0, 2.5)),
            ("1 -2 4", true, true, (-2.0, 4.0)),
            ("1 2 inf", false, false, (1.0, f64::INFINITY)),
            ("x 1 2", false, false, (1.0, 2.0)),
        ] {
            let found = summary(values);
            assert_eq!((found.finite, found.integral), (finite, integral), "{values}");
            assert_eq!((found.least, found.greatest), range, "{values}");
        }
    }

    #[test]
    fn types_are_numbers_or_labels_of_the_header() {
        for (label, named, value, is_type) in [
            ("", false, "2", true),
            ("", true, "2", true),
            ("", true, "3", false),
            ("", true, "0", false),
            ("O", false, "O", true),
            ("O", true, "wax", false),
            ("", true, "wax", true),
            ("", false, "wax", false),
            ("", true, "+x", false),
        ] {
            let labels = label.split_whitespace().collect();
            let facts = Facts { types: 2, labels, ..Facts::default() };
            let row = format!("1 {value}");
            let fault = facts.type_fault(1, &sample(&[&row]), named);
            assert_eq!(fault.is_none(), is_type, "{label} {named} {value}");
        }
        let known = |types: u64| [0, 1, 2, 3].map(|number| of_types(types).has_type(number));
        assert_eq!(known(2), [false, true, true, false]);
        assert_eq!(known(0), [false, true, true, true]);
    }

    #[test]
    fn positions_are_in_the_box_and_mostly_no_whole_numbers() {
        let vectors = [DVec3::X * 10.0, DVec3::Y * 20.0, DVec3::Z * 40.0];
        let cell = Cell { origin: DVec3::new(1.0, 2.0, 3.0), vectors, periodic: [true; 3] };
        let in_box = Facts { cell: Some(cell), ..Facts::default() };
        let charge = Layout::of_style("charge").pop().expect("a style");
        let likelihood = |facts: &Facts, places: &[&str]| {
            let rows: Vec<String> = places.iter().map(|place| format!("1 1 0.5 {place}")).collect();
            let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
            facts.likelihood(&charge, &sample(&rows))
        };
        // Two corners and a point inside; the last is outside along y.
        let places = ["1 2 3", "11 22 43", "5.5 21 42", "1 23 4"];
        assert_eq!(likelihood(&in_box, &places), (7, true));
        assert_eq!(likelihood(&Facts::default(), &places), (0, true));
        for (places, not_whole) in [
            (&["2 3 4", "3 4 5"][..], true),
            (&["2 3 4", "3 4 5", "4 5 6.5"], false),
            (&["2 3 4", "3 4.5 5", "4 5 6"], true),
            (&["2 3 4", "3 4 5", "4 5 6", "5 6 7"], false),
        ] {
            assert_eq!(likelihood(&in_box, places), (10, not_whole), "{places:?}");
        }
    }

    #[test]
    fn spins_are_unit_vectors_or_none() {
        for (spins, expected) in [
            (&["0 0.6 0.8"][..], true),
            (&["0 0.6 0.8", "0 0 0"], true),
            (&["0 0 0"], false),
            (&["0 0.6 0.8", "0 3 4"], false),
            (&["0 3 4"], false),
        ] {
            let rows: Vec<String> =
                spins.iter().map(|spin| format!("1 1 1 2 3 {spin} 1")).collect();
            let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
            assert_eq!(sample(&rows).has_spins(), expected, "{spins:?}");
        }
    }

    #[test]
    fn styles_with_equal_pictures_are_not_ambiguous() {
        // The molecule of one is the type of the other, and they are the same.
        assert_eq!(guess(&of_types(1), &["1 1 1 0.5 1.5 2.5"]), ["molecular"]);
    }

    #[test]
    fn only_positions_are_read_from_rows_of_no_style() {
        let vectors = [DVec3::X * 10.0, DVec3::Y * 10.0, DVec3::Z * 10.0];
        let cell = Some(Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] });
        let in_box = Facts { types: 2, cell, counts: [("bonds", 1)].into(), ..Facts::default() };
        let guess = |start: &str| {
            let row = format!("{start} 7.5 0 0 0 0 0 0 0 0 0 0.5");
            guess(&in_box, &[&row])
        };
        assert_eq!(guess("1 2 0.5 1.5 2.5"), ["hybrid"]);
        for start in ["1 2 0.5 11.5 2.5", "1.5 2 0.5 1.5 2.5", "1 3 0.5 1.5 2.5"] {
            assert!(guess(start).is_empty(), "{start}");
        }
    }

    #[test]
    fn hybrid_styles_with_unknown_words_are_open() {
        let open = |style: &str| Layout::of_style(style).iter().all(|layout| layout.open);
        for style in ["hybrid", "hybrid tdpd 2 charge", "hybrid tdpd", "hybrid body nparticle 2 5"]
        {
            assert!(open(style), "{style}");
        }
        assert!(!open("hybrid charge sphere") && !open("hybrid sphere ellipsoid"));
    }

    #[test]
    fn styles_have_positions_and_types() {
        for (style, columns) in STYLES {
            let columns: Vec<&str> = columns.split(' ').collect();
            assert!(COMMON.iter().all(|name| columns.contains(name)), "{style}");
            let x = columns.iter().position(|name| *name == "x").expect("x");
            assert_eq!(columns[x..x + 3], ["x", "y", "z"], "{style}");
            assert!(
                columns.iter().enumerate().all(|(at, name)| !columns[..at].contains(name)),
                "{style}"
            );
        }
    }
}
