//! Atoms that exclude each other: several elements on one site, and disorder groups. The one with the
//! greatest occupancy is drawn; the first in the list wins ties.

use super::crystal::strip_uncertainty;
use super::rows::Rows;
use super::symmetry::{SAME, distance};
use crate::{Cell, number};
use glam::DVec3;
use std::collections::HashMap;

/// Distance in angstrom below which two atoms share a site if their occupancies add up to 1 at most:
/// distinct atoms are never this close.
const SPLIT: f64 = 0.5;

/// Maximum sum of the occupancies of a site, including rounding.
const FULL: f64 = 1.02;

/// Value for an unknown occupancy: less than any known one.
const UNKNOWN: f64 = -1.0;

/// Columns of occupancies and disorder.
const COLUMNS: [&str; 3] = ["occupancy", "disorder_assembly", "disorder_group"];

/// Occupancies and disorder groups of the listed atoms.
pub(super) struct Occupancies {
    columns: [Option<usize>; 3],
    values: Vec<f64>,
    groups: Vec<Group>,
}

/// Disorder group of an atom; both fields are empty if it has none.
#[derive(Clone, Default, PartialEq, Eq)]
struct Group {
    assembly: String,
    name: String,
}

/// Positions in fractional coordinates, with the rows of their listed atoms.
#[derive(Clone, Copy)]
pub(super) struct Positions<'p> {
    pub(super) rows: &'p [u32],
    pub(super) places: &'p [DVec3],
    pub(super) cell: &'p Cell,
}

/// Selection of one position for each shared site.
pub(super) struct Shared {
    pub(super) keep: Vec<bool>,
    /// Number of sites that several positions share.
    pub(super) sites: usize,
}

impl Occupancies {
    pub(super) fn new(names: &[String]) -> Self {
        let columns = COLUMNS.map(|column| names.iter().position(|name| name == column));
        Self { columns, values: Vec::new(), groups: Vec::new() }
    }

    /// Reads the row of an atom.
    pub(super) fn read(&mut self, rows: &Rows) {
        let [occupancy, assembly, group] =
            self.columns.map(|column| column.map(|at| rows.field(at)));
        self.values.push(match occupancy {
            // A point means the default value.
            None | Some(b".") => 1.0,
            Some(field) => number::parse(strip_uncertainty(field)).unwrap_or(UNKNOWN),
        });
        let text = |field: Option<&[u8]>| match field {
            None | Some(b"." | b"?") => String::new(),
            Some(field) => String::from_utf8_lossy(field).into_owned(),
        };
        let name = text(group);
        let assembly = if name.is_empty() { String::new() } else { text(assembly) };
        self.groups.push(Group { assembly, name });
    }

    /// Returns for each listed atom whether its site is occupied, or may be.
    pub(super) fn occupied(&self) -> Vec<bool> {
        self.values.iter().map(|value| *value != 0.0).collect()
    }

    /// Removes the atoms that are not kept.
    pub(super) fn retain(&mut self, keep: &[bool]) {
        let mut kept = keep.iter();
        self.values.retain(|_| *kept.next().unwrap_or(&true));
        let mut kept = keep.iter();
        self.groups.retain(|_| *kept.next().unwrap_or(&true));
    }

    /// Returns the number of atoms that are disordered about a symmetry element, and so overlap their
    /// images.
    pub(super) fn about_symmetry(&self) -> usize {
        self.groups.iter().filter(|group| group.name.starts_with('-')).count()
    }

    /// Returns for each listed atom whether it belongs to the main group of its disorder assembly,
    /// or to none.
    pub(super) fn main_groups(&self) -> Vec<bool> {
        let mut keep = vec![true; self.values.len()];
        let mut assemblies: Vec<(&str, Vec<usize>)> = Vec::new();
        for (row, Group { assembly, name }) in self.groups.iter().enumerate() {
            if name.is_empty() {
                continue;
            }
            match assemblies.iter_mut().find(|(own, _)| own == assembly) {
                Some((_, rows)) => rows.push(row),
                None => assemblies.push((assembly, vec![row])),
            }
        }
        for (_, rows) in assemblies {
            for independent in self.independent(&rows) {
                let main = self.main_group(&independent);
                for row in independent {
                    keep[row] = self.groups[row].name == main;
                }
            }
        }
        keep
    }

    /// Splits the atoms of an assembly into independent disorders of two groups each, whose occupancies
    /// add up to 1.
    fn independent(&self, rows: &[usize]) -> Vec<Vec<usize>> {
        let mut pairs: HashMap<i64, Vec<usize>> = HashMap::new();
        for &row in rows {
            let lesser = self.values[row].min(1.0 - self.values[row]);
            pairs.entry((lesser * 1e4).round() as i64).or_default().push(row);
        }
        let is_pair = |rows: &[usize]| {
            let first = &self.groups[rows[0]].name;
            rows.iter().any(|&row| self.groups[row].name != *first)
        };
        let (mut pairs, rest): (Vec<_>, Vec<_>) =
            pairs.into_values().partition(|rows| is_pair(rows));
        let mut rest: Vec<usize> = rest.into_iter().flatten().collect();
        rest.sort_unstable();
        pairs.push(rest);
        pairs
    }

    /// Returns the name of the group with the greatest mean occupancy.
    fn main_group(&self, rows: &[usize]) -> String {
        let mut groups: Vec<(&str, f64, f64)> = Vec::new();
        for &row in rows {
            let (name, value) = (&self.groups[row].name, self.values[row]);
            match groups.iter_mut().find(|(own, ..)| own == name) {
                Some((_, sum, count)) => (*sum, *count) = (*sum + value, *count + 1.0),
                None => groups.push((name, value, 1.0)),
            }
        }
        let means = groups.iter().map(|(name, sum, count)| (*name, sum / count));
        let main = means.reduce(|best, next| if next.1 > best.1 + 1e-6 { next } else { best });
        main.map_or(String::new(), |(name, _)| name.to_owned())
    }

    /// Selects the atom with the greatest occupancy on each shared site.
    pub(super) fn select_on_sites(&self, positions: Positions) -> Shared {
        let count = positions.places.len();
        let value = |index: u32| self.values[positions.rows[index as usize] as usize];
        let mut order: Vec<u32> = (0..count as u32).collect();
        // A stable sort: the first in the list wins ties.
        order.sort_by(|one, other| value(*other).total_cmp(&value(*one)));
        let mut grid = Grid::new(positions.cell);
        let mut keep = vec![false; count];
        let mut stands_for_others = vec![false; count];
        for index in order {
            let place = positions.places[index as usize];
            let own = value(index).abs();
            let same = |other: u32| {
                let away = distance(place, positions.places[other as usize], positions.cell);
                let reach = if own + value(other).abs() <= FULL { SPLIT } else { SAME };
                away < reach
            };
            let drawn = grid.near(place).find(|&other| same(other));
            if let Some(drawn) = drawn {
                stands_for_others[drawn as usize] = true;
            } else {
                keep[index as usize] = true;
                grid.add(place, index);
            }
        }
        Shared { keep, sites: stands_for_others.iter().filter(|shared| **shared).count() }
    }
}

/// Uniform grid of positions in a periodic cell; boxes are at least [`SPLIT`] wide unless the cell is
/// narrower.
struct Grid {
    counts: [i64; 3],
    boxes: HashMap<[i64; 3], Vec<u32>>,
}

impl Grid {
    fn new(cell: &Cell) -> Self {
        let [a, b, c] = cell.vectors;
        let volume = a.cross(b).dot(c).abs();
        let heights = [b.cross(c), c.cross(a), a.cross(b)].map(|area| volume / area.length());
        let counts = heights.map(|height| ((height / SPLIT) as i64).clamp(1, 1 << 20));
        Self { counts, boxes: HashMap::new() }
    }

    fn key(&self, place: DVec3) -> [i64; 3] {
        std::array::from_fn(|axis| {
            let share = place[axis] - place[axis].floor();
            ((share * self.counts[axis] as f64) as i64).rem_euclid(self.counts[axis])
        })
    }

    fn add(&mut self, place: DVec3, index: u32) {
        self.boxes.entry(self.key(place)).or_default().push(index);
    }

    /// Returns the positions in the box around `place` and in adjacent boxes.
    fn near(&self, place: DVec3) -> impl Iterator<Item = u32> {
        let key = self.key(place);
        let around = |axis: usize| {
            let mut boxes = [-1, 0, 1].map(|step| (key[axis] + step).rem_euclid(self.counts[axis]));
            boxes.sort_unstable();
            let mut boxes = boxes.to_vec();
            boxes.dedup();
            boxes
        };
        let [first, second, third] = [around(0), around(1), around(2)];
        let mut keys = Vec::with_capacity(27);
        for x in first {
            for y in &second {
                keys.extend(third.iter().map(|z| [x, *y, *z]));
            }
        }
        keys.into_iter().filter_map(|key| self.boxes.get(&key)).flatten().copied()
    }
}
