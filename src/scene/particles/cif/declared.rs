//! The symmetry that a block declares, in up to four ways, and the operations to draw with: the
//! listed ones, or else those of the Hall symbol, of the Hermann-Mauguin symbol or of the number.

use super::hall;
use super::space_group::{Setting, Symbol};
use super::symmetry::{Operation, SAME, distance, images};
use crate::scene::particles::frame::Cell;
use glam::{DMat3, DVec3};

/// Difference between a cell and its images under symmetry, relative to its edges, above which the
/// cell does not have the symmetry.
const MISFIT: f64 = 0.03;

/// Differences of this size are rounding of the cell's edges and angles.
const EQUAL_MISFIT: f64 = 1e-3;

/// Distances in angstrom that are equal but for rounding.
const EQUAL_DISTANCE: f64 = 0.01;

/// Number of listed positions that are looked at to tell origins apart.
const POSITIONS: usize = 60;

/// Symmetry as a block declares it.
#[derive(Default)]
pub(super) struct Declared {
    pub(super) operations: Vec<Operation>,
    /// Translations that magnetic CIF lists apart from the operations.
    pub(super) centerings: Vec<Operation>,
    pub(super) hall: Option<String>,
    pub(super) symbols: Vec<String>,
    pub(super) number: Option<u32>,
}

/// The operations to draw with, and what is to be said of them.
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

/// A setting that a symbol or number may stand for.
struct Candidate {
    setting: Setting,
    operations: Vec<Operation>,
    misfit: f64,
}

impl Declared {
    /// The operations of the strongest declaration that is understood. The weaker ones are compared
    /// with it.
    pub(super) fn resolve(&self, contents: Contents) -> Resolved {
        let mut warnings = Vec::new();
        let Some((source, operations)) = self.strongest(contents, &mut warnings) else {
            warnings.push(self.unknown());
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

    /// The source of the operations, and the operations; `None` if nothing is known of them.
    fn strongest(
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
            warnings.push(format!("the Hall symbol `{hall}` is not understood"));
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
            warnings.push(format!("{source} leaves the axes open: those of {name} are taken"));
        }
        Some((source, chosen.operations))
    }

    /// The listed operations with all centerings, the identity first or where it is listed.
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

    /// Declarations that do not go with the operations that are used.
    fn contradictions(&self, used: &[Operation]) -> Vec<String> {
        let hall = self.hall.as_deref().and_then(|hall| {
            let other = hall::operations(hall)?;
            (!are_alike(used, &other)).then(|| hall_source(hall))
        });
        let symbols = self.symbols.iter().filter(|text| {
            let settings = Setting::of_symbol(&Symbol::new(text));
            !settings.is_empty()
                && !settings.iter().any(|setting| are_alike(used, &setting.operations()))
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

    fn unknown(&self) -> String {
        let drawn = "only the listed atoms are drawn";
        let named = self.symbols.first().map(|symbol| unknown_symbol(symbol));
        let numbered = || Some(format!("there is no space group of the number {}", self.number?));
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

/// The setting that fits the cell best and, where the origin is open, keeps atoms farthest apart.
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
    // Axes that the symbol names but the cell does not have are not taken.
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
    // Of equals the last: origins at inversion centers are the second of two.
    let index = wide.rev().min_by_key(|&at| packings[at].atoms)?;
    let chosen = candidates.swap_remove(index);
    if open {
        let name = chosen.setting.name();
        warnings.push(format!(
            "{source} leaves the origin open: {name} is taken, by the distances of atoms"
        ));
    }
    Some(chosen)
}

/// The greatest relative change of the cell's edges and angles by an operation.
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

/// Measure of how the listed positions and their images fill the cell: with the right origin, atoms
/// are farther apart and, as special positions are taken, fewer.
struct Packing {
    /// The least distance in angstrom.
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
                // The images of a site are apart, but for the site itself.
                let away = away.filter(|&(other, away)| other != index || away > SAME);
                packing.spacing = away.fold(packing.spacing, |least, (_, away)| least.min(away));
            }
        }
        packing
    }
}

/// Returns whether two groups have the same rotations and as many translations.
fn are_alike(one: &[Operation], other: &[Operation]) -> bool {
    let has = |group: &[Operation], operation: &Operation| {
        group.iter().any(|own| own.matrix == operation.matrix)
    };
    one.len() == other.len()
        && one.iter().all(|operation| has(other, operation))
        && other.iter().all(|operation| has(one, operation))
}

/// The traces of all rotations of a group, sorted, each once however the cell is centered: they tell
/// crystal classes apart whatever the axes are.
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
