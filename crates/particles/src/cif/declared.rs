//! Symmetry operations of a crystal from its declared symmetry. A block may declare symmetry in four
//! ways; in order of precedence: listed operations, Hall symbol, Hermann-Mauguin symbol, number.

use super::hall;
use super::space_group::{Setting, Symbol};
use super::symmetry::{Operation, SAME, distance, images};
use crate::cell::Cell;
use glam::{DMat3, DVec3};

/// Maximum difference between a cell with a symmetry and its images under it, relative to its edges.
const MISFIT: f64 = 0.03;

/// Differences of misfit up to this are due to rounding of the cell's edges and angles.
const EQUAL_MISFIT: f64 = 1e-3;

/// Difference between equal distances due to rounding, in angstrom.
const EQUAL_DISTANCE: f64 = 0.01;

/// Maximum number of listed positions that are used to distinguish origins.
const POSITIONS: usize = 60;

/// Symmetry declarations of a block.
#[derive(Default)]
pub(super) struct Declared {
    pub(super) operations: Vec<Operation>,
    /// Centering translations, which magnetic CIF lists separately.
    pub(super) centerings: Vec<Operation>,
    pub(super) hall: Option<String>,
    pub(super) symbols: Vec<String>,
    pub(super) number: Option<u32>,
}

/// Symmetry operations to apply, with warnings about them.
pub(super) struct Resolved {
    pub(super) operations: Vec<Operation>,
    pub(super) warnings: Vec<String>,
}

/// The cell and the listed positions, in fractional coordinates.
#[derive(Clone, Copy)]
pub(super) struct Contents<'c> {
    pub(super) cell: &'c Cell,
    pub(super) positions: &'c [DVec3],
}

/// A setting that a symbol or number may mean.
struct Candidate {
    setting: Setting,
    operations: Vec<Operation>,
    misfit: f64,
}

impl Declared {
    /// Returns the operations of the valid declaration with the highest precedence, and compares the
    /// others with it.
    pub(super) fn resolve(&self, contents: Contents) -> Resolved {
        let mut warnings = Vec::new();
        let Some((source, operations)) = self.preferred(contents, &mut warnings) else {
            warnings.push(self.unknown_text());
            return Resolved { operations: Vec::new(), warnings };
        };
        if misfit(&operations, contents.cell) > MISFIT {
            warnings.push(format!("the cell does not have the symmetry of {source}"));
        }
        let contradictions = self.contradictions(&operations).into_iter();
        warnings.extend(
            contradictions.map(|other| format!("{other} contradicts {source}, which is used")),
        );
        Resolved { operations, warnings }
    }

    /// Returns the source of the operations and the operations; `None` if there is no valid declaration.
    fn preferred(
        &self,
        contents: Contents,
        warnings: &mut Vec<String>,
    ) -> Option<(String, Vec<Operation>)> {
        let listed = self.listed();
        if !listed.is_empty() {
            return Some(("the listed symmetry operations".to_owned(), listed));
        }
        if let Some(hall) = &self.hall {
            if let Some(operations) = hall::operations(hall) {
                return Some((hall_source(hall), operations));
            }
            warnings.push(format!("the Hall symbol `{hall}` is invalid"));
        }
        for text in &self.symbols {
            let symbol = Symbol::new(text);
            let settings = Setting::of_symbol(&symbol);
            if !settings.is_empty() {
                let source = symbol_source(text);
                let choice = symbol.choice.as_deref();
                let chosen = choose(&source, &settings, choice, contents, warnings)?;
                return Some((source, chosen.operations));
            }
        }
        let number = self.number?;
        let settings = Setting::of_number(number);
        let source = number_source(number);
        let chosen = choose(&source, &settings, None, contents, warnings)?;
        let name = chosen.setting.axes_name();
        warnings.extend(self.symbols.first().map(|symbol| unknown_symbol(symbol)));
        if settings.iter().any(|other| other.axes_name() != name) {
            warnings
                .push(format!("{source} does not determine the axes: those of {name} are used"));
        }
        Some((source, chosen.operations))
    }

    /// Returns the listed operations with all centerings; adds the identity first if it isn't listed.
    fn listed(&self) -> Vec<Operation> {
        let mut group: Vec<Operation> = Vec::new();
        let mut add = |operation: Operation| {
            if !group.iter().any(|other| other.same(&operation)) {
                group.push(operation);
            }
        };
        let any = !self.operations.is_empty() || !self.centerings.is_empty();
        if any && !self.operations.iter().any(|operation| operation.same(&Operation::IDENTITY)) {
            add(Operation::IDENTITY);
        }
        self.operations.iter().copied().for_each(&mut add);
        for centering in &self.centerings {
            let operations = [Operation::IDENTITY].iter().chain(&self.operations);
            operations.for_each(|operation| add(centering.after(operation)));
        }
        group
    }

    /// Returns the declarations that contradict the operations in use.
    fn contradictions(&self, used: &[Operation]) -> Vec<String> {
        let hall = self.hall.as_deref().and_then(|hall| {
            let other = hall::operations(hall)?;
            (!have_same_rotations(used, &other)).then(|| hall_source(hall))
        });
        let symbols = self.symbols.iter().filter(|text| {
            let settings = Setting::of_symbol(&Symbol::new(text));
            !settings.is_empty()
                && !settings.iter().any(|setting| have_same_rotations(used, &setting.operations()))
        });
        let number = self.number.filter(|&number| {
            let settings = Setting::of_number(number);
            let class = class(used);
            !settings.is_empty()
                && !settings.iter().any(|setting| self::class(&setting.operations()) == class)
        });
        let symbols = symbols.map(|text| symbol_source(text));
        hall.into_iter().chain(symbols).chain(number.map(number_source)).collect()
    }

    fn unknown_text(&self) -> String {
        let drawn = "only the listed atoms are drawn";
        let named = self.symbols.first().map(|symbol| unknown_symbol(symbol));
        let numbered = || Some(format!("there is no space group number {}", self.number?));
        let hall = || self.hall.as_ref().map(|_| "names no other symmetry".to_owned());
        let nothing = || "names no space group and lists no symmetry operations".to_owned();
        format!("{}: {drawn}", named.or_else(numbered).or_else(hall).unwrap_or_else(nothing))
    }
}

fn hall_source(hall: &str) -> String {
    format!("the Hall symbol `{hall}`")
}

fn symbol_source(symbol: &str) -> String {
    format!("the space group's symbol `{symbol}`")
}

fn number_source(number: u32) -> String {
    format!("the space group's number {number}")
}

fn unknown_symbol(symbol: &str) -> String {
    format!("the space group `{symbol}` is not known, and its operations are not listed")
}

/// Returns the setting that fits the cell best; if the origin is ambiguous, the setting with the
/// greatest distance between atoms.
fn choose(
    source: &str,
    settings: &[Setting],
    choice: Option<&str>,
    contents: Contents,
    warnings: &mut Vec<String>,
) -> Option<Candidate> {
    let candidate = |setting: &Setting| {
        let operations = setting.operations();
        Candidate { misfit: misfit(&operations, contents.cell), setting: *setting, operations }
    };
    let mut candidates: Vec<Candidate> = settings.iter().map(candidate).collect();
    let least = |candidates: &[Candidate], choice: Option<&str>| {
        let named =
            candidates.iter().filter(|one| choice.is_none_or(|own| own == one.setting.choice));
        named.map(|one| one.misfit).reduce(f64::min)
    };
    // The cell overrides the axes in the symbol.
    let chosen = choice.filter(|choice| {
        let named = least(&candidates, Some(choice));
        named.is_some_and(|named| {
            named < MISFIT || least(&candidates, None).is_none_or(|best| best > MISFIT)
        })
    });
    let best = least(&candidates, chosen)?;
    candidates.retain(|one| {
        chosen.is_none_or(|own| own == one.setting.choice) && one.misfit <= best + EQUAL_MISFIT
    });
    let axes = candidates.first()?.setting.axes_name();
    candidates.retain(|one| one.setting.axes_name() == axes);
    let open = candidates.len() > 1;
    let packings: Vec<Packing> =
        candidates.iter().map(|one| Packing::new(&one.operations, contents)).collect();
    let widest = packings.iter().map(|one| one.spacing).fold(0.0, f64::max);
    let wide = (0..packings.len()).filter(|&at| packings[at].spacing >= widest - EQUAL_DISTANCE);
    // The last wins ties: origins at inversion centers are the second choice.
    let index = wide.rev().min_by_key(|&at| packings[at].atoms)?;
    let chosen = candidates.swap_remove(index);
    if open {
        let name = chosen.setting.name();
        warnings.push(format!(
            "{source} does not determine the origin: {name} is used, by the distances of atoms"
        ));
    }
    Some(chosen)
}

/// Returns the maximum relative change of the cell's edges and angles by an operation.
fn misfit(operations: &[Operation], cell: &Cell) -> f64 {
    let [a, b, c] = cell.vectors;
    let edges = DMat3::from_cols(a, b, c);
    let metric = edges.transpose() * edges;
    let lengths = [a.length(), b.length(), c.length()];
    let mut misfit: f64 = 0.0;
    for operation in operations {
        let image = operation.matrix.transpose() * metric * operation.matrix;
        for row in 0..3 {
            for column in 0..3 {
                let change = (image.col(column)[row] - metric.col(column)[row]).abs();
                misfit = misfit.max(change / (lengths[row] * lengths[column]));
            }
        }
    }
    misfit
}

/// Distance and number of atoms for a choice of origin. With the right origin, atoms are farther
/// apart, and fewer because they are at special positions.
struct Packing {
    /// Minimum distance in angstrom.
    spacing: f64,
    atoms: usize,
}

impl Packing {
    fn new(operations: &[Operation], contents: Contents) -> Self {
        let Contents { cell, positions } = contents;
        let mut sites: Vec<DVec3> = Vec::new();
        for position in positions.iter().take(POSITIONS) {
            if sites.iter().all(|site| distance(*site, *position, cell) > SAME) {
                sites.push(*position);
            }
        }
        let mut packing = Self { spacing: f64::INFINITY, atoms: 0 };
        for (index, site) in sites.iter().enumerate() {
            for image in images(*site, operations, cell) {
                packing.atoms += 1;
                let others = sites.iter().enumerate();
                let away = others.map(|(other, place)| (other, distance(image, *place, cell)));
                // Images of a site are distinct from each other, so only the site itself is skipped.
                let away = away.filter(|&(other, away)| other != index || away > SAME);
                packing.spacing = away.fold(packing.spacing, |least, (_, away)| least.min(away));
            }
        }
        packing
    }
}

/// Returns whether two groups have the same rotations and equally many translations.
fn have_same_rotations(one: &[Operation], other: &[Operation]) -> bool {
    let has = |group: &[Operation], operation: &Operation| {
        group.iter().any(|own| own.matrix == operation.matrix)
    };
    one.len() == other.len()
        && one.iter().all(|operation| has(other, operation))
        && other.iter().all(|operation| has(one, operation))
}

/// Returns the sorted traces of a group's rotations, each once regardless of centering. They
/// distinguish crystal classes for any choice of axes.
fn class(group: &[Operation]) -> Vec<i32> {
    let mut matrices: Vec<DMat3> = Vec::new();
    for operation in group {
        if !matrices.contains(&operation.matrix) {
            matrices.push(operation.matrix);
        }
    }
    let trace = |matrix: &DMat3| matrix.x_axis.x + matrix.y_axis.y + matrix.z_axis.z;
    let sign = |matrix: &DMat3| 10.0 * matrix.determinant().signum();
    let mut traces: Vec<i32> =
        matrices.iter().map(|matrix| (trace(matrix) + sign(matrix)).round() as i32).collect();
    traces.sort_unstable();
    traces
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cell(lengths: [f64; 3], angles: [f64; 3]) -> Cell {
        Cell::of_lengths(lengths, angles).expect("a cell")
    }

    fn cube(edge: f64) -> Cell {
        cell([edge; 3], [90.0; 3])
    }

    fn group(hall: &str) -> Vec<Operation> {
        hall::operations(hall).expect("a Hall symbol")
    }

    fn of_symbol(symbol: &str) -> Declared {
        Declared { symbols: vec![symbol.to_owned()], ..Declared::default() }
    }

    fn of_number(number: u32) -> Declared {
        Declared { number: Some(number), ..Declared::default() }
    }

    /// Returns the number of operations and the warnings.
    fn resolved(declared: &Declared, cell: &Cell, positions: &[DVec3]) -> (usize, String) {
        let resolved = declared.resolve(Contents { cell, positions });
        (resolved.operations.len(), resolved.warnings.join("; "))
    }

    #[test]
    fn misfits_of_cells_are_relative_changes_by_symmetry() {
        let box_shaped = cell([4.0, 5.0, 6.0], [90.0; 3]);
        let sheared = cell([4.0, 5.0, 6.0], [90.0, 90.0, 100.0]);
        let hexagonal = cell([4.0, 4.0, 6.0], [90.0, 90.0, 120.0]);
        for (hall, cell, expected) in [
            ("P 2", &box_shaped, 0.0),
            // Squares of the edges a and b are 9 apart.
            ("P 4", &box_shaped, 9.0 / 16.0),
            ("P 4x", &box_shaped, 11.0 / 25.0),
            ("P 2", &sheared, 0.0),
            ("P 2y", &sheared, 2.0 * 80_f64.to_radians().cos()),
            ("P 6", &hexagonal, 0.0),
        ] {
            assert!((misfit(&group(hall), cell) - expected).abs() < 1e-12, "{hall}");
        }
    }

    #[test]
    fn packings_have_the_shortest_distance_and_the_number_of_atoms() {
        let first = DVec3::new(0.1, 0.2, 0.3);
        let near = DVec3::new(0.005, 0.0, 0.0);
        for (hall, positions, spacing, atoms) in [
            ("P 1", &[first][..], f64::INFINITY, 1),
            ("-P 1", &[DVec3::ZERO], f64::INFINITY, 1),
            // To the image at 0.9, 0.8 and 0.7.
            ("-P 1", &[first], 8.0 * 0.6, 2),
            ("P 1", &[DVec3::ZERO, DVec3::X * 0.5], 4.0, 2),
            // Positions that differ only by rounding are merged.
            ("P 1", &[DVec3::ZERO, near], f64::INFINITY, 1),
            // The image of one is beside the other.
            ("-P 1", &[first, near - first], 0.04, 4),
        ] {
            let contents = Contents { cell: &cube(8.0), positions };
            let packing = Packing::new(&group(hall), contents);
            let same = packing.spacing == spacing || (packing.spacing - spacing).abs() < 1e-12;
            assert!(same, "{hall} {positions:?}: {}", packing.spacing);
            assert_eq!(packing.atoms, atoms, "{hall} {positions:?}");
        }
    }

    #[test]
    fn groups_are_compared_by_rotations_and_centering() {
        for (one, other, expected) in [
            ("P 1", "P 1", true),
            ("P 2", "P 2ac", true),
            ("P 2", "P -2", false),
            ("P 2", "P 2x", false),
            ("C 1", "P 1", false),
            ("P 2", "P 1", false),
            ("C 1", "P 2", false),
        ] {
            assert_eq!(have_same_rotations(&group(one), &group(other)), expected, "{one} {other}");
            assert_eq!(have_same_rotations(&group(other), &group(one)), expected, "{other} {one}");
        }
    }

    #[test]
    fn crystal_classes_follow_from_rotations() {
        for (hall, expected) in [
            ("C 1", &[13][..]),
            ("-P 1", &[-13, 13]),
            ("P 2x", &[9, 13]),
            ("P -2y", &[-9, 13]),
            ("I 4", &[9, 11, 11, 13]),
            ("P 3", &[10, 10, 13]),
            ("P 3*", &[10, 10, 13]),
        ] {
            assert_eq!(class(&group(hall)), expected, "{hall}");
        }
    }

    #[test]
    fn ambiguous_origins_are_chosen_by_distances() {
        let diamond = of_symbol("F d -3 m");
        for (places, choice) in [
            (&[DVec3::ZERO][..], "F d -3 m:1"),
            (&[DVec3::splat(0.125)], "F d -3 m:2"),
            // The last wins ties.
            (&[], "F d -3 m:2"),
        ] {
            let (count, warning) = resolved(&diamond, &cube(5.43), places);
            let expected = format!(
                "the space group's symbol `F d -3 m` does not determine the origin: {choice} is used, by \
                 the distances of atoms"
            );
            assert_eq!((count, warning), (192, expected));
        }
        // A named origin is not ambiguous, wherever atoms are.
        let named = resolved(&of_symbol("F d -3 m :1"), &cube(5.43), &[DVec3::splat(0.125)]);
        assert_eq!(named, (192, String::new()));
        let first =
            of_symbol("F d -3 m :1").resolve(Contents { cell: &cube(5.43), positions: &[] });
        assert_eq!(first.operations, group("F 4d 2 3 -1d"));
    }

    #[test]
    fn axes_must_fit_the_cell() {
        let hexagonal = cell([4.0, 4.0, 10.0], [90.0, 90.0, 120.0]);
        let rhombohedral = cell([5.0; 3], [70.0; 3]);
        // Roughly hexagonal, and far from rhombohedral.
        let neither = cell([4.0, 4.5, 10.0], [90.0, 90.0, 120.0]);
        let misfit = |symbol: &str| {
            format!("the cell does not have the symmetry of the space group's symbol `{symbol}`")
        };
        for (symbol, cell, count, warning) in [
            ("R -3 m", &hexagonal, 36, String::new()),
            ("R -3 m", &rhombohedral, 12, String::new()),
            ("R -3 m :H", &hexagonal, 36, String::new()),
            ("R -3 m :R", &hexagonal, 36, String::new()),
            ("R -3 m :H", &rhombohedral, 12, String::new()),
            ("R -3 m", &neither, 36, misfit("R -3 m")),
            ("R -3 m :R", &neither, 12, misfit("R -3 m :R")),
            ("P m -3 m :2", &cube(8.0), 48, String::new()),
            // Edges are measured.
            ("P m -3 m", &cell([8.0, 8.02, 8.0], [90.0; 3]), 48, String::new()),
        ] {
            assert_eq!(resolved(&of_symbol(symbol), cell, &[]), (count, warning), "{symbol}");
        }
    }

    #[test]
    fn numbers_of_groups_may_leave_the_axes_ambiguous() {
        let monoclinic = cell([4.0, 5.0, 6.0], [90.0, 100.0, 90.0]);
        let (count, warning) = resolved(&of_number(14), &monoclinic, &[]);
        let expected = "the space group's number 14 does not determine the axes: those of P 1 21/c 1 are \
                        used";
        assert_eq!((count, warning.as_str()), (4, expected));
        assert_eq!(resolved(&of_number(2), &monoclinic, &[]), (2, String::new()));
        let both = Declared { number: Some(2), ..of_symbol("P 7 q") };
        let warning = resolved(&both, &monoclinic, &[]).1;
        let expected = "the space group `P 7 q` is not known, and its operations are not listed";
        assert_eq!(warning, expected);
    }

    #[test]
    fn listed_operations_begin_with_the_identity_unless_it_is_listed() {
        let parse = |texts: &[&str]| -> Vec<Operation> {
            texts.iter().map(|text| Operation::parse(text).expect("an operation")).collect()
        };
        let (none, inversion): (&[&str], _) = (&[], "-x,-y,-z");
        for (operations, centerings, expected) in [
            (none, none, none),
            (&[inversion], none, &["x,y,z", inversion]),
            (&[inversion, "x,y,z"], none, &[inversion, "x,y,z"]),
            (&["x,y,z", "x,y,z+1", "x,y,z"], none, &["x,y,z"]),
            (none, &["x+1/2,y+1/2,z"], &["x,y,z", "x+1/2,y+1/2,z"]),
            (
                &[inversion],
                &["x,y,z", "x+1/2,y,z"],
                &["x,y,z", inversion, "x+1/2,y,z", "1/2-x,-y,-z"],
            ),
        ] {
            let [operations, centerings] = [operations, centerings].map(parse);
            let declared = Declared { operations, centerings, ..Declared::default() };
            assert_eq!(declared.listed(), parse(expected));
        }
    }

    #[test]
    fn contradictions_and_unknown_groups_are_reported() {
        let nothing = "only the listed atoms are drawn";
        let listed = |others: Declared| Declared { operations: group("P 2"), ..others };
        let hall = |hall: &str| Declared { hall: Some(hall.to_owned()), ..Declared::default() };
        for (declared, count, warning) in [
            (
                Declared::default(),
                0,
                format!("names no space group and lists no symmetry operations: {nothing}"),
            ),
            (of_number(231), 0, format!("there is no space group number 231: {nothing}")),
            (
                of_symbol("P 7 q"),
                0,
                format!("the space group `P 7 q` is not known, and its operations are not listed: {nothing}"),
            ),
            (
                hall("P 9"),
                0,
                format!("the Hall symbol `P 9` is invalid; names no other symmetry: {nothing}"),
            ),
            (hall("P 2y"), 2, String::new()),
            // A number needs only the same crystal class, and an unknown symbol contradicts nothing.
            (listed(of_number(4)), 2, String::new()),
            (listed(of_number(231)), 2, String::new()),
            (listed(of_symbol("P 7 q")), 2, String::new()),
            (listed(hall("P 9")), 2, String::new()),
            (listed(hall("P 2c")), 2, String::new()),
            (
                listed(hall("P -2")),
                2,
                "the Hall symbol `P -2` contradicts the listed symmetry operations, which is used".to_owned(),
            ),
            (
                listed(of_number(6)),
                2,
                "the space group's number 6 contradicts the listed symmetry operations, which is used"
                    .to_owned(),
            ),
            (
                listed(of_symbol("P 1 m 1")),
                2,
                "the space group's symbol `P 1 m 1` contradicts the listed symmetry operations, which is used"
                    .to_owned(),
            ),
        ] {
            assert_eq!(resolved(&declared, &cube(8.0), &[]), (count, warning));
        }
    }
}
