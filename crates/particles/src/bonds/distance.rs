//! Bonds by distance: pairs of particles closer than a length that depends on their types.

use super::rules::{BondRules, Cutoffs};
use super::{Bond, Bonds};
use super::{bridges, images};
use crate::ParticleFrame;
use crate::neighbors::{CellList, Points};
use rayon::prelude::*;

/// Number of particles whose bonds are found at once.
const BATCH: usize = 1 << 12;

/// Maximum mean number of bonds per particle, and the number that is always accepted.
const MOST_PER_PARTICLE: u64 = 32;
const ALWAYS: u64 = 1 << 20;

/// Maximum number of pairs per particle to test.
const MOST_TESTS: f64 = 2e4;

/// Finds the bonds of a frame by distance, over the periodic cell too. Bonds of zero length don't exist.
/// Time is proportional to the number of particles if their density is limited.
///
/// # Errors
///
/// A message: a rule names a type that the frame doesn't have, or the particles have too many neighbors.
pub fn from_distance(frame: &ParticleFrame, rules: &BondRules) -> Result<Bonds, String> {
    let cutoffs = rules.cutoffs(frame)?;
    let reach = cutoffs.reach.iter().copied().fold(0.0, f64::max);
    let codes = &frame.kinds.codes;
    let class = |row: u32| {
        let kind = if codes.is_empty() { 0 } else { codes.code(row as usize) as usize };
        cutoffs.class[kind]
    };
    let bonded = |row: &u32| cutoffs.reach[class(*row)] > 0.0;
    let rows: Vec<u32> = (0..frame.len() as u32).filter(bonded).collect();
    if reach <= 0.0 || rows.is_empty() {
        return Ok(Bonds::default());
    }
    let points = Points::of(frame);
    let list = CellList::new(points, &rows, reach)?;
    let too_many = || {
        format!(
            "has more than {MOST_PER_PARTICLE} neighbors per particle within the length of bonds: \
             give shorter lengths, or no bonds"
        )
    };
    if list.crowding() > MOST_TESTS * rows.len() as f64 + 1e8 {
        return Err(too_many());
    }
    let most = (rows.len() as u64 * MOST_PER_PARTICLE).max(ALWAYS);
    let mut bonds: Vec<Bond> = Vec::new();
    // In groups of batches, so that bonds can be counted while they are found.
    for group in rows.chunks(BATCH << 8) {
        let batch = |rows: &[u32]| {
            let mut found = Vec::new();
            for &row in rows {
                let start = found.len();
                add_bonds(
                    &mut found,
                    row,
                    &Search { points, list: &list, cutoffs: &cutoffs },
                    &class,
                );
                found[start..].sort_unstable();
            }
            found
        };
        let batches: Vec<Vec<Bond>> = group.par_chunks(BATCH).map(batch).collect();
        bonds.extend(batches.into_iter().flatten());
        if bonds.len() as u64 > most {
            return Err(too_many());
        }
    }
    let mut bonds = Bonds::of_sorted(&bonds);
    if rules.are_covalent() {
        bridges::remove_bridged(&mut bonds, frame);
    }
    Ok(bonds)
}

/// The points to search, and the lengths of bonds.
struct Search<'s> {
    points: Points<'s>,
    list: &'s CellList,
    cutoffs: &'s Cutoffs,
}

/// Adds the bonds of a particle to those that follow it, and to its own images.
fn add_bonds(found: &mut Vec<Bond>, row: u32, search: &Search, class: &impl Fn(u32) -> usize) {
    let Search { points, list, cutoffs } = search;
    let own = class(row);
    let squares = &cutoffs.squares[own * cutoffs.count..(own + 1) * cutoffs.count];
    list.any(points.position(row as usize), cutoffs.reach[own], |neighbor| {
        let later = neighbor.row > row || neighbor.row == row && neighbor.shift < [0; 3];
        if later
            && neighbor.distance2 > cutoffs.least
            && neighbor.distance2 <= squares[class(neighbor.row)]
        {
            let shift = neighbor.shift.map(i64::from);
            found.extend(images::narrow(shift).map(|shift| (row, neighbor.row, shift)));
        }
        false
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::categories::Kind;
    use crate::cell::Cell;
    use crate::element::Element;
    use crate::frame::LengthUnit;
    use glam::DVec3;
    use proptest::prelude::*;

    fn frame(points: &[([f64; 3], &str)]) -> ParticleFrame {
        let mut frame = ParticleFrame::default();
        for ([x, y, z], name) in points {
            frame.x.push(*x);
            frame.y.push(*y);
            frame.z.push(*z);
            let code = frame.kinds.table.iter().position(|kind| kind.name == *name);
            let code = code.unwrap_or_else(|| {
                let element = Element::from_symbol(name);
                let name = (*name).to_owned();
                frame.kinds.table.push(Kind { name, element, ..Kind::default() });
                frame.kinds.table.len() - 1
            });
            frame.kinds.codes.push(code as u32);
        }
        frame
    }

    fn rows(bonds: &Bonds) -> Vec<Bond> {
        (0..bonds.len()).map(|bond| bonds.bond(bond)).collect()
    }

    fn found(points: &[([f64; 3], &str)], rules: &str) -> Vec<Bond> {
        let rules =
            if rules.is_empty() { BondRules::covalent() } else { rules.parse().expect(rules) };
        rows(&from_distance(&frame(points), &rules).expect("bonds"))
    }

    const WATER: [([f64; 3], &str); 3] =
        [([0.0; 3], "O"), ([0.96, 0.0, 0.0], "H"), ([-0.24, 0.93, 0.0], "H")];

    #[test]
    fn covalent_radii_bond_molecules() {
        let none = [0; 3];
        assert_eq!(found(&WATER, ""), [(0, 1, none), (0, 2, none)]);
        // The longest bond of two carbons, and atoms at one place.
        for (distance, count) in [(1.96, 1), (1.98, 0), (0.39, 0), (0.41, 1)] {
            let pair = [([0.0; 3], "C"), ([0.0, 0.0, distance], "C")];
            assert_eq!(found(&pair, "").len(), count, "{distance}");
        }
        let mut nanometers = frame(&WATER);
        for axis in [&mut nanometers.x, &mut nanometers.y] {
            *axis = axis.iter().map(|value| value / 10.0).collect();
        }
        nanometers.unit = LengthUnit::Nanometer;
        let bonds = from_distance(&nanometers, &BondRules::covalent()).expect("bonds");
        assert_eq!(bonds.len(), 2);
    }

    #[test]
    fn the_last_rule_for_two_types_applies() {
        let none = [0; 3];
        assert_eq!(found(&WATER, "O-H<1"), [(0, 1, none), (0, 2, none)]);
        assert_eq!(found(&WATER, "*-*<2").len(), 3);
        assert_eq!(found(&WATER, "*-*<2,H-H<0").len(), 2);
        assert_eq!(found(&WATER, "H-H<0,*-*<2").len(), 3);
        // Less than the length, and not equal to it.
        assert_eq!(found(&WATER, "O-H<0.96").len(), 0);
        let unknown = from_distance(&frame(&WATER), &"C-C<2".parse().expect("a rule"));
        assert!(unknown.is_err_and(|message| message.contains("no type `C`")));
    }

    #[test]
    fn particles_may_be_bonded_to_their_own_images() {
        let mut chain = frame(&[([0.5; 3], "A")]);
        let vectors = [DVec3::X, DVec3::Y * 5.0, DVec3::Z * 5.0];
        chain.cell = Some(Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] });
        let bonds = from_distance(&chain, &"*-*<2.5".parse().expect("a rule")).expect("bonds");
        assert_eq!(rows(&bonds), [(0, 0, [-2, 0, 0]), (0, 0, [-1, 0, 0])]);
    }

    #[test]
    fn crowds_are_refused() {
        let points = vec![([0.0; 3], "C"); 200_000];
        let error = from_distance(&frame(&points), &BondRules::within(1.0)).expect_err("a crowd");
        assert!(error.contains("more than 32 neighbors"), "{error}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(100))]

        #[test]
        fn bonds_are_those_of_all_pairs_and_images(
            points in prop::collection::vec([-4.0..9.0, -4.0..9.0, -4.0..9.0], 1..25),
            [x, y, z] in [1.5..7.0_f64, 1.5..7.0, 1.5..7.0],
            [xy, xz, yz] in [-1.5..1.5_f64, -1.5..1.5, -1.5..1.5],
            periodic in any::<[bool; 3]>(),
        ) {
            let names = ["C", "Ar", "Na"];
            let points: Vec<_> =
                points.iter().zip(names.into_iter().cycle()).map(|(place, name)| (*place, name)).collect();
            let mut frame = frame(&points);
            let vectors = [DVec3::new(x, 0.0, 0.0), DVec3::new(xy, y, 0.0), DVec3::new(xz, yz, z)];
            let cell = Cell { origin: DVec3::ZERO, vectors, periodic };
            frame.cell = Some(cell);
            let bonds = from_distance(&frame, &BondRules::covalent()).expect("bonds");
            let radius = |row: usize| {
                let element = Element::from_symbol(points[row].1).expect("an element");
                element.covalent_radius().expect("a radius")
            };
            let steps = |axis: usize| if periodic[axis] { -16..=16 } else { 0..=0_i8 };
            let mut images = Vec::new();
            for i in steps(0) {
                for j in steps(1) {
                    for k in steps(2) {
                        let image = cell.matrix() * DVec3::new(i.into(), j.into(), k.into());
                        images.push(([i, j, k], image));
                    }
                }
            }
            // Those that no bond reaches from one corner of the points to another.
            images.retain(|(_, image)| image.length() < 13.0 * 3.0_f64.sqrt() + 5.0);
            let mut expected = Vec::new();
            for first in 0..points.len() {
                for second in first..points.len() {
                    let most = radius(first) + radius(second) + 0.45;
                    let between = frame.position(second) - frame.position(first);
                    for &(shift, image) in &images {
                        let away = between + image;
                        let own = first == second && shift >= [0; 3];
                        if away.length() > 0.4 && away.length() <= most && !own {
                            expected.push((first as u32, second as u32, shift));
                        }
                    }
                }
            }
            prop_assert_eq!(rows(&bonds), expected);
        }
    }
}
