//! Hall symbols of space groups: a lattice and generators, from which all symmetry operations follow
//! (S. R. Hall, "Space-group notation with an explicit origin", Acta Crystallographica A37, 1981;
//! International Tables for Crystallography B, section 1.4, appendix A1.4.2).

use super::symmetry::Operation;
use glam::{DMat3, DVec3};

/// Number of operations of the largest space groups, which are cubic with face centering.
pub(super) const MOST: usize = 192;

/// Lattice symbols and their centering translations.
const LATTICES: [(u8, &[[f64; 3]]); 11] = [
    (b'P', &[]),
    (b'A', &[[0.0, 0.5, 0.5]]),
    (b'B', &[[0.5, 0.0, 0.5]]),
    (b'C', &[[0.5, 0.5, 0.0]]),
    (b'I', &[[0.5, 0.5, 0.5]]),
    (b'R', &[[2.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0], [1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0]]),
    (b'S', &[[1.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0], [2.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0]]),
    (b'T', &[[1.0 / 3.0, 2.0 / 3.0, 1.0 / 3.0], [2.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0]]),
    (b'H', &[[2.0 / 3.0, 1.0 / 3.0, 0.0], [1.0 / 3.0, 2.0 / 3.0, 0.0]]),
    (b'F', &[[0.0, 0.5, 0.5], [0.5, 0.0, 0.5], [0.5, 0.5, 0.0]]),
    (b'Q', &[[0.0, 0.0, 0.5]]),
];

/// The direction of a rotation axis.
#[derive(Clone, Copy, PartialEq)]
enum Axis {
    /// A cell edge, by index.
    Edge(usize),
    /// Difference of the two edges perpendicular to the preceding axis, `'`.
    Difference(usize),
    /// Sum of these edges, `"`.
    Sum(usize),
    /// Body diagonal, `*`.
    Diagonal,
}

/// Rotation part of a token.
#[derive(Clone, Copy)]
struct Rotation {
    order: u8,
    axis: Axis,
}

/// Returns all symmetry operations of a Hall symbol, the identity first; `None` if it is invalid.
pub(super) fn operations(symbol: &str) -> Option<Vec<Operation>> {
    let symbol = symbol.replace('_', " ");
    let (symbol, basis) = match symbol.split_once('(') {
        Some((symbol, basis)) => (symbol, Some(basis.trim().strip_suffix(')')?)),
        None => (&symbol[..], None),
    };
    let mut tokens = symbol.split_whitespace();
    let lattice = tokens.next()?.as_bytes();
    let (centric, letter) = match lattice {
        [b'-', letter] => (true, letter),
        [letter] => (false, letter),
        _ => return None,
    };
    let (_, translations) = LATTICES.iter().find(|(own, _)| own.eq_ignore_ascii_case(letter))?;
    let mut generators: Vec<Operation> = translations
        .iter()
        .map(|shift| Operation { shift: DVec3::from_array(*shift), ..Operation::IDENTITY })
        .collect();
    if centric {
        generators.push(Operation { matrix: -DMat3::IDENTITY, shift: DVec3::ZERO });
    }
    let mut before = None;
    for (position, token) in tokens.enumerate() {
        let (operation, rotation) = generator(token.as_bytes(), position, before)?;
        generators.push(operation);
        before = Some(rotation);
    }
    if let Some(basis) = basis {
        let basis = change_of_basis(basis)?;
        let inverse = basis.inverse();
        for generator in &mut generators {
            *generator = basis.after(generator).after(&inverse).rounded();
        }
    }
    group(&generators)
}

/// Returns the operation of a token such as `-4bd`, `21` or `2"c` at index `position` of the symbol.
fn generator(
    token: &[u8],
    position: usize,
    before: Option<Rotation>,
) -> Option<(Operation, Rotation)> {
    let (improper, token) = match token {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, token),
    };
    let (&order @ (b'1' | b'2' | b'3' | b'4' | b'6'), rest) = token.split_first()? else {
        return None;
    };
    let order = order - b'0';
    let mut axis = usual_axis(order, position, before);
    let mut screw = 0;
    let mut shift = DVec3::ZERO;
    for letter in rest {
        let edge = match before {
            Some(Rotation { axis: Axis::Edge(edge), .. }) => edge,
            _ => 2,
        };
        match letter.to_ascii_lowercase() {
            letter @ b'x'..=b'z' => axis = Axis::Edge(usize::from(letter - b'x')),
            b'\'' | b'^' => axis = Axis::Difference(edge),
            b'"' | b'=' => axis = Axis::Sum(edge),
            b'*' => axis = Axis::Diagonal,
            letter @ b'a'..=b'c' => shift[usize::from(letter - b'a')] += 0.5,
            letter @ b'u'..=b'w' => shift[usize::from(letter - b'u')] += 0.25,
            b'n' => shift += DVec3::splat(0.5),
            b'd' => shift += DVec3::splat(0.25),
            digit @ b'1'..=b'5' if digit - b'0' < order => screw = digit - b'0',
            _ => return None,
        }
    }
    if screw > 0 {
        let Axis::Edge(edge) = axis else { return None };
        shift[edge] += f64::from(screw) / f64::from(order);
    }
    let matrix = matrix(order, axis)?;
    let matrix = if improper { -matrix } else { matrix };
    Some((Operation { matrix, shift }.rounded(), Rotation { order, axis }))
}

/// Returns the default axis of a rotation.
fn usual_axis(order: u8, position: usize, before: Option<Rotation>) -> Axis {
    match (order, position, before.map(|rotation| rotation.order)) {
        (2, 1, Some(2 | 4)) => Axis::Edge(0),
        (2, 1, Some(3 | 6)) => Axis::Difference(2),
        (3, 2.., _) => Axis::Diagonal,
        _ => Axis::Edge(2),
    }
}

/// Returns the matrix of a rotation; `None` if the axis isn't valid for its order.
fn matrix(order: u8, axis: Axis) -> Option<DMat3> {
    // First two rows of the matrix for axis z.
    let (edge, [[a, b], [c, d]], along) = match (axis, order) {
        (_, 1) => return Some(DMat3::IDENTITY),
        (Axis::Diagonal, 3) => return Some(DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X)),
        (Axis::Edge(edge), 2) => (edge, [[-1.0, 0.0], [0.0, -1.0]], 1.0),
        (Axis::Edge(edge), 3) => (edge, [[0.0, -1.0], [1.0, -1.0]], 1.0),
        (Axis::Edge(edge), 4) => (edge, [[0.0, -1.0], [1.0, 0.0]], 1.0),
        (Axis::Edge(edge), 6) => (edge, [[1.0, -1.0], [1.0, 0.0]], 1.0),
        (Axis::Difference(edge), 2) => (edge, [[0.0, -1.0], [-1.0, 0.0]], -1.0),
        (Axis::Sum(edge), 2) => (edge, [[0.0, 1.0], [1.0, 0.0]], -1.0),
        _ => return None,
    };
    // The two perpendicular edges follow the axis cyclically.
    let [first, second] = [(edge + 1) % 3, (edge + 2) % 3];
    let mut columns = [DVec3::ZERO; 3];
    columns[first][first] = a;
    columns[second][first] = b;
    columns[first][second] = c;
    columns[second][second] = d;
    columns[edge][edge] = along;
    Some(DMat3::from_cols_array_2d(&columns.map(|column| column.to_array())))
}

/// Parses the change of basis at a symbol's end: a shift in twelfths, `0 0 1`, or an operation,
/// `x-y,x+y,z`.
fn change_of_basis(text: &str) -> Option<Operation> {
    if text.contains(',') {
        return Operation::parse(text);
    }
    let mut shifts = text.split_whitespace().map(|shift| shift.parse::<i8>().ok());
    let [x, y, z] = [shifts.next()??, shifts.next()??, shifts.next()??];
    let shift = DVec3::new(f64::from(x), f64::from(y), f64::from(z)) / 12.0;
    shifts.next().is_none().then_some(Operation { shift, ..Operation::IDENTITY })
}

/// Returns the group that operations generate, the identity first; `None` if it is larger than any
/// space group, as for an invalid symbol.
fn group(generators: &[Operation]) -> Option<Vec<Operation>> {
    let mut group = vec![Operation::IDENTITY];
    let mut next = 0;
    while let Some(&last) = group.get(next) {
        for generator in generators {
            let product = generator.after(&last).rounded();
            if !group.iter().any(|other| other.same(&product)) {
                group.push(product);
            }
            if group.len() > MOST {
                return None;
            }
        }
        next += 1;
    }
    Some(group)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    /// Orders and structure factors of all settings for an atom at [`POSITION`], by gemmi 0.7.5.
    const EXPECTED: &str = include_str!("../../../../tests/data/particles/space_groups.csv");
    const POSITION: DVec3 = DVec3::new(0.0613, 0.1327, 0.2719);

    /// Returns the structure factor of a point of weight 1, which depends on every rotation and
    /// translation.
    fn structure_factor(operations: &[Operation], index: DVec3) -> [f64; 2] {
        let phases = operations
            .iter()
            .map(|operation| TAU * index.dot(operation.matrix * POSITION + operation.shift));
        let factors = phases.map(|phase| [phase.cos(), phase.sin()]);
        factors.fold([0.0; 2], |sum, factor| [sum[0] + factor[0], sum[1] + factor[1]])
    }

    #[test]
    fn groups_of_all_settings_agree_with_another_program() {
        let mut count = 0;
        for line in EXPECTED.lines().skip(1) {
            let columns: Vec<&str> = line.split(';').collect();
            let expected = |column: usize| columns[column].parse::<f64>().expect("a number");
            let operations = operations(columns[1]).expect("a Hall symbol");
            assert_eq!(operations[0], Operation::IDENTITY, "{line}");
            assert_eq!(operations.len() as f64, expected(2), "{line}");
            for (column, index) in [(3, [1.0, 2.0, 3.0]), (5, [4.0, 2.0, 8.0])] {
                let found = structure_factor(&operations, DVec3::from_array(index));
                let wanted = [expected(column), expected(column + 1)];
                let away = (0..2).map(|part| (found[part] - wanted[part]).abs());
                assert!(away.fold(0.0, f64::max) < 1e-3, "{line}: {found:?}");
            }
            count += 1;
        }
        assert_eq!(count, 557);
    }

    #[test]
    fn diagonal_axes_follow_the_preceding_rotation() {
        for (symbol, second) in [
            ("P 2", "-x,-y,z"),
            ("P 2'", "-y,-x,-z"),
            ("P 2^", "-y,-x,-z"),
            ("P 2\"", "y,x,-z"),
            ("P 2=", "y,x,-z"),
            ("P 1x 2'", "-x,-z,-y"),
            ("P 1x 2\"", "-x,z,y"),
            ("P 1y 2\"", "z,-y,x"),
            ("P 1 2'", "-y,-x,-z"),
            ("P 3*", "z,x,y"),
            ("P 2a", "-x+1/2,-y,z"),
            ("P 2uv", "-x+1/4,-y+1/4,z"),
            ("P 2nw", "-x+1/2,-y+1/2,z+3/4"),
            ("P -1d", "-x+1/4,-y+1/4,-z+1/4"),
            ("P 42", "-y,x,z+1/2"),
            ("P 41x", "x+1/4,-z,y"),
            ("P -2x (0 0 1)", "-x,y,z"),
            ("P -1 (1 -2 3)", "-x+1/6,-y-1/3,-z+1/2"),
            ("P 2x (y,z,x)", "-x,-y,z"),
            ("Q 1", "x,y,z+1/2"),
        ] {
            let group = operations(symbol).expect(symbol);
            let second = Operation::parse(second).expect(second);
            assert!(group[1].same(&second), "{symbol}: {:?}", group[1]);
        }
        // The subscript of a screw axis is less than its order.
        for wrong in ["P 22", "P 33", "P 45", "P 31'", "P 4*", "P 2 (1 2)", "P 2 (1 2 3 4)", "PP"] {
            assert_eq!(operations(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn hall_symbols_are_read_in_their_spellings() {
        let order = |symbol: &str| operations(symbol).map(|group| group.len());
        assert_eq!(order("-p_2YBC"), Some(4));
        assert_eq!(order("-P 2ybc (1/4)"), None);
        assert_eq!(operations("P 4 (x-1/4,y,z)"), operations("P 4 (-3 0 0)"));
        assert_ne!(operations("P 4 (x-1/4,y,z)"), operations("P 4 (3 0 0)"));
        for wrong in
            ["", "-", "P", "X 1", "P 5", "P 2q", "P 2(", "P 3x 4y", "P 21*", "P 4' 3", "(x,y,z)"]
        {
            // A lattice symbol alone is valid.
            assert_eq!(order(wrong), if wrong == "P" { Some(1) } else { None }, "{wrong}");
        }
    }
}
