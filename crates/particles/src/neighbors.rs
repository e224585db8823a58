//! Neighbors within a distance: a cell list over a periodic cell, orthogonal or triclinic (Allen and
//! Tildesley, "Computer Simulation of Liquids", 2nd ed. 2017, section 5.3).
//!
//! The bins divide the edges of the cell evenly, or those of the box of all points along edges that
//! aren't periodic. All periodic images within the distance are found, however small the cell.

use crate::{Cell, ParticleFrame, memory};
use glam::{DMat3, DVec3};
use rayon::prelude::*;

/// Mean number of points per bin that is aimed at.
const PER_BIN: f64 = 3.0;

/// Maximum number of bins along an edge that a neighborhood extends to each side.
const BINS_TO_SIDE: f64 = 3.0;

/// Maximum number of cells that a neighborhood extends to each side.
const CELLS_TO_SIDE: f64 = 64.0;

/// Relative margin for rounding errors of distances between bins.
const MARGIN: f64 = 1e-9;

/// Points as columns of coordinates, of equal lengths.
#[derive(Clone, Copy, Debug)]
pub struct Points<'p> {
    /// Coordinates x, y and z.
    pub axes: [&'p [f64]; 3],
    /// The periodic cell, if there is one.
    pub cell: Option<&'p Cell>,
}

impl<'p> Points<'p> {
    /// Returns the positions of a frame.
    pub fn of(frame: &'p ParticleFrame) -> Self {
        Self { axes: [&frame.x, &frame.y, &frame.z], cell: frame.cell.as_ref() }
    }

    /// Returns the position of a row.
    pub fn position(&self, row: usize) -> DVec3 {
        let [x, y, z] = self.axes;
        DVec3::new(x[row], y[row], z[row])
    }

    /// Returns the mean position of rows.
    pub fn center(&self, rows: &[u32]) -> DVec3 {
        let sum: DVec3 = rows.iter().map(|&row| self.position(row as usize)).sum();
        sum / rows.len() as f64
    }

    /// Returns the number of points.
    pub fn len(&self) -> usize {
        self.axes[0].len()
    }

    /// Returns whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A neighbor of a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Neighbor {
    /// Row of the neighbor.
    pub row: u32,
    /// Number of edges of the cell to add to its position to get its image next to the point.
    pub shift: [i32; 3],
    /// Square of the distance.
    pub distance2: f64,
}

/// Points sorted into bins.
pub struct CellList {
    matrix: DMat3,
    inverse: DMat3,
    origin: DVec3,
    periodic: [bool; 3],
    /// Number of bins along each edge.
    counts: [i64; 3],
    /// Distance between opposite faces of a bin.
    heights: [f64; 3],
    /// Index of the first point of each bin.
    starts: Vec<u32>,
    /// Rows of points, bin by bin, and their positions in the cell.
    rows: Vec<u32>,
    places: Vec<DVec3>,
    /// Number of edges from each position in the cell to the point; empty if all are 0.
    shifts: Vec<[i32; 3]>,
}

/// A point in the cell.
struct Located {
    bin: [i64; 3],
    place: DVec3,
    shift: [i32; 3],
}

impl CellList {
    /// Sorts the points of these rows into bins for distances up to `reach`, which is positive. Points that
    /// are not finite have no neighbors.
    ///
    /// # Errors
    ///
    /// A message: the distance is longer than many cells, or there isn't enough memory.
    pub fn new(points: Points, rows: &[u32], reach: f64) -> Result<Self, String> {
        let bytes = (size_of::<u32>() + size_of::<DVec3>() + 2 * size_of::<u64>()) as u64;
        memory::check(rows.len() as u64 * bytes)
            .map_err(|shortage| format!("its neighbors need {shortage}"))?;
        let mut list = Self::empty(points, rows, reach)?;
        let bins = list.counts.iter().product::<i64>() as usize;
        let bin_of = |row: &u32| {
            let located = list.locate(points.position(*row as usize));
            located.map_or(u32::MAX, |located| list.index(located.bin) as u32)
        };
        let bin_of_row: Vec<u32> = rows.par_iter().map(bin_of).collect();
        let mut starts = vec![0_u32; bins + 2];
        for &bin in bin_of_row.iter().filter(|bin| **bin < u32::MAX) {
            starts[bin as usize + 2] += 1;
        }
        for bin in 2..starts.len() {
            starts[bin] += starts[bin - 1];
        }
        let sorted = &mut list.rows;
        sorted.resize(starts[bins + 1] as usize, 0);
        for (&row, &bin) in rows.iter().zip(&bin_of_row).filter(|(_, bin)| **bin < u32::MAX) {
            let next = &mut starts[bin as usize + 1];
            sorted[*next as usize] = row;
            *next += 1;
        }
        starts.pop();
        list.starts = starts;
        let located = |row: &u32| list.locate(points.position(*row as usize));
        let place = |row: &u32| located(row).map_or(DVec3::NAN, |located| located.place);
        let shift = |row: &u32| located(row).map_or([0; 3], |located| located.shift);
        let places = list.rows.par_iter().map(place).collect();
        let moved = list.rows.par_iter().any(|row| shift(row) != [0; 3]);
        let shifts = if moved { list.rows.par_iter().map(shift).collect() } else { Vec::new() };
        Ok(Self { places, shifts, ..list })
    }

    /// Returns the bins without points.
    fn empty(points: Points, rows: &[u32], reach: f64) -> Result<Self, String> {
        let cell = points.cell.copied().and_then(Cell::checked).unwrap_or(Cell {
            origin: DVec3::ZERO,
            vectors: [DVec3::X, DVec3::Y, DVec3::Z],
            periodic: [false; 3],
        });
        let Cell { mut origin, mut vectors, periodic } = cell;
        let inverse = cell.matrix().inverse();
        if periodic != [true; 3] {
            // Edges that aren't periodic become those of the box of all points.
            let fractional = |row: &u32| inverse * (points.position(*row as usize) - origin);
            let bounds = rows
                .par_iter()
                .map(fractional)
                .filter(|point| point.is_finite())
                .fold(
                    || [DVec3::INFINITY, DVec3::NEG_INFINITY],
                    |[low, high], point| [low.min(point), high.max(point)],
                )
                .reduce(
                    || [DVec3::INFINITY, DVec3::NEG_INFINITY],
                    |[low, high], [lower, higher]| [low.min(lower), high.max(higher)],
                );
            let corner = origin;
            for axis in (0..3).filter(|&axis| !periodic[axis]) {
                let [low, high] = bounds.map(|bound| bound[axis]);
                let extent = if high > low && (high - low).is_finite() { high - low } else { 1.0 };
                let low = if low.is_finite() { low } else { 0.0 };
                origin += cell.vectors[axis] * low;
                vectors[axis] = cell.vectors[axis] * extent;
            }
            if !origin.is_finite() {
                origin = corner;
            }
        }
        let boxed = Cell { origin, vectors, periodic };
        let boxed = boxed.with_volume().unwrap_or(Cell { origin, ..cell });
        let heights = heights(&boxed);
        for axis in 0..3 {
            if periodic[axis] && reach > CELLS_TO_SIDE * heights[axis] {
                return Err(format!(
                    "a distance of {reach} is more than {CELLS_TO_SIDE} times the periodic cell"
                ));
            }
        }
        let counts = counts(heights, rows.len(), reach);
        Ok(Self {
            matrix: boxed.matrix(),
            inverse: boxed.matrix().inverse(),
            origin: boxed.origin,
            periodic,
            counts,
            heights: std::array::from_fn(|axis| heights[axis] / counts[axis] as f64),
            starts: Vec::new(),
            rows: Vec::new(),
            places: Vec::new(),
            shifts: Vec::new(),
        })
    }

    /// Returns the bin of a point and its position in the cell; `None` if it isn't finite.
    fn locate(&self, point: DVec3) -> Option<Located> {
        let fractional = self.inverse * (point - self.origin);
        let edge = |axis: usize| if self.periodic[axis] { fractional[axis].floor() } else { 0.0 };
        let edges = DVec3::new(edge(0), edge(1), edge(2));
        // Far from the cell, positions have no digits left.
        if !(edges.abs().max_element() < 1e6 && fractional.is_finite()) {
            return None;
        }
        let inside = fractional - edges;
        Some(Located {
            bin: std::array::from_fn(|axis| {
                let bin = (inside[axis] * self.counts[axis] as f64).floor();
                (bin as i64).clamp(0, self.counts[axis] - 1)
            }),
            place: point - self.matrix * edges,
            shift: edges.to_array().map(|edge| edge as i32),
        })
    }

    fn index(&self, [a, b, c]: [i64; 3]) -> usize {
        ((c * self.counts[1] + b) * self.counts[0] + a) as usize
    }

    /// Calls a function with each neighbor within `radius` of a point, the point itself included if it is
    /// one of the list's, until the function returns true. Returns whether it did.
    #[inline]
    pub fn any(&self, point: DVec3, radius: f64, mut found: impl FnMut(Neighbor) -> bool) -> bool {
        let Some(Located { bin, place, shift }) = self.locate(point) else { return false };
        let inside = self.inverse * (place - self.origin);
        // The bins around the point, those beyond the faces of the cell included.
        let range = |axis: usize| {
            let count = self.counts[axis] as f64;
            let reach = radius / self.heights[axis] * (1.0 + MARGIN) + MARGIN;
            let center = inside[axis] * count;
            let (low, high) = ((center - reach).floor(), (center + reach).floor());
            if self.periodic[axis] {
                (low as i64, high as i64)
            } else {
                // Points on the upper face are in the last bin.
                (low.clamp(0.0, count - 1.0) as i64, high.clamp(0.0, count - 1.0) as i64)
            }
        };
        let ranges: [(i64, i64); 3] = std::array::from_fn(|axis| {
            let (low, high) = range(axis);
            (low.min(bin[axis]), high.max(bin[axis]))
        });
        let split = |axis: usize, bin: i64| {
            let count = self.counts[axis];
            let image = if (0..count).contains(&bin) { 0 } else { bin.div_euclid(count) };
            (image, bin - image * count)
        };
        let limit = radius * radius;
        for c in ranges[2].0..=ranges[2].1 {
            let (image_c, c) = split(2, c);
            for b in ranges[1].0..=ranges[1].1 {
                let (image_b, b) = split(1, b);
                for a in ranges[0].0..=ranges[0].1 {
                    let (image_a, a) = split(0, a);
                    let image = [image_a, image_b, image_c];
                    let bin = self.index([a, b, c]);
                    let members = self.starts[bin] as usize..self.starts[bin + 1] as usize;
                    if members.is_empty() {
                        continue;
                    }
                    let away = if image == [0; 3] {
                        place
                    } else {
                        place - self.matrix * DVec3::from(image.map(|image| image as f64))
                    };
                    for member in members {
                        let distance2 = (self.places[member] - away).length_squared();
                        if distance2 <= limit {
                            let own = self.shifts.get(member).copied().unwrap_or_default();
                            let shift = std::array::from_fn(|axis| {
                                image[axis] as i32 - own[axis] + shift[axis]
                            });
                            let row = self.rows[member];
                            if found(Neighbor { row, shift, distance2 }) {
                                return true;
                            }
                        }
                    }
                }
            }
        }
        false
    }

    /// Returns an estimate of the number of pairs of points in the same bin.
    pub(crate) fn crowding(&self) -> f64 {
        let counts = self.starts.windows(2).map(|ends| f64::from(ends[1] - ends[0]));
        counts.map(|count| count * count).sum()
    }
}

/// Returns the distances between opposite faces of a cell.
fn heights(cell: &Cell) -> [f64; 3] {
    let [a, b, c] = cell.vectors;
    let volume = a.cross(b).dot(c).abs();
    [b.cross(c), c.cross(a), a.cross(b)].map(|area| volume / area.length())
}

/// Returns the number of bins along each edge.
fn counts(heights: [f64; 3], points: usize, reach: f64) -> [i64; 3] {
    let most = 2.0 * points as f64 + 64.0;
    let volume: f64 = heights.iter().product();
    let even = libm::cbrt(volume * PER_BIN / points.max(1) as f64);
    let mut height = even.max(reach / BINS_TO_SIDE);
    loop {
        let counts = heights.map(|whole| ((whole / height) as i64).clamp(1, 1 << 30));
        let bins: f64 = counts.iter().map(|count| *count as f64).product();
        if bins <= most && bins < f64::from(u32::MAX / 2) {
            return counts;
        }
        height *= 1.25;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Neighbors by testing all pairs, and all images whose fractional coordinates can be within the radius: row and
    /// shift, sorted.
    fn brute(points: Points, point: DVec3, radius: f64) -> Vec<(u32, [i32; 3])> {
        let mut found = Vec::new();
        let matrix = points.cell.map_or(DMat3::IDENTITY, Cell::matrix);
        let inverse = matrix.inverse();
        for row in 0..points.len() {
            let away = (inverse * (point - points.position(row))).to_array();
            let steps = |axis: usize| {
                let periodic = points.cell.is_some_and(|cell| cell.periodic[axis]);
                let reach = radius * inverse.row(axis).length() + 0.5;
                let low = if periodic { (away[axis] - reach).floor() } else { 0.0 };
                let high = if periodic { (away[axis] + reach).ceil() } else { 0.0 };
                low as i32..=high as i32
            };
            for a in steps(0) {
                for b in steps(1) {
                    for c in steps(2) {
                        let shift = [a, b, c];
                        let image =
                            points.position(row) + matrix * DVec3::from(shift.map(f64::from));
                        if image.distance(point) <= radius {
                            found.push((row as u32, shift));
                        }
                    }
                }
            }
        }
        found.sort_unstable();
        found
    }

    fn listed(list: &CellList, point: DVec3, radius: f64) -> Vec<(u32, [i32; 3])> {
        let mut found = Vec::new();
        list.any(point, radius, |neighbor| {
            found.push((neighbor.row, neighbor.shift));
            false
        });
        found.sort_unstable();
        found
    }

    fn columns(points: &[[f64; 3]]) -> [Vec<f64>; 3] {
        std::array::from_fn(|axis| points.iter().map(|point| point[axis]).collect())
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        #[test]
        fn neighbors_are_those_of_all_pairs(
            points in prop::collection::vec([-6.0..9.0, -6.0..9.0, -6.0..9.0], 1..60),
            [x, y, z] in [2.0..7.0_f64, 2.0..7.0, 2.0..7.0],
            [xy, xz, yz] in [-2.0..2.0_f64, -2.0..2.0, -2.0..2.0],
            periodic in any::<[bool; 3]>(),
            has_cell in any::<bool>(),
            (radius, reach) in (0.1..4.0_f64, 0.3..4.0_f64),
        ) {
            let columns = columns(&points);
            let cell = Cell {
                origin: DVec3::new(-1.0, 0.5, 0.25),
                vectors: [DVec3::new(x, 0.0, 0.0), DVec3::new(xy, y, 0.0), DVec3::new(xz, yz, z)],
                periodic,
            };
            let axes = columns.each_ref().map(Vec::as_slice);
            let points = Points { axes, cell: has_cell.then_some(&cell) };
            let rows: Vec<u32> = (0..points.len() as u32).collect();
            let list = CellList::new(points, &rows, reach).expect("a list");
            for row in 0..points.len().min(8) {
                let point = points.position(row) + DVec3::splat(0.01);
                prop_assert_eq!(
                    listed(&list, point, radius),
                    brute(points, point, radius),
                    "{}", row
                );
            }
        }
    }

    #[test]
    fn points_that_are_not_finite_have_no_neighbors() {
        let columns = columns(&[[0.0; 3], [f64::NAN, 0.0, 0.0], [f64::INFINITY; 3], [0.5; 3]]);
        let points = Points { axes: columns.each_ref().map(Vec::as_slice), cell: None };
        let list = CellList::new(points, &[0, 1, 2, 3], 1.0).expect("a list");
        assert_eq!(listed(&list, DVec3::ZERO, 1.0), [(0, [0; 3]), (3, [0; 3])]);
        assert!(listed(&list, DVec3::NAN, 1.0).is_empty());
        let none = CellList::new(points, &[], 1.0).expect("a list");
        assert!(listed(&none, DVec3::ZERO, 1e9).is_empty());
        let huge = self::columns(&[[-1e308; 3], [1e308; 3], [0.0; 3]]);
        let points = Points { axes: huge.each_ref().map(Vec::as_slice), cell: None };
        let list = CellList::new(points, &[0, 1, 2], 1.0).expect("a list");
        assert_eq!(listed(&list, DVec3::ZERO, 1.0), [(2, [0; 3])]);
    }

    #[test]
    fn distances_of_many_cells_are_refused() {
        let columns = columns(&[[0.0; 3]]);
        let vectors = [DVec3::X, DVec3::Y, DVec3::Z];
        let cell = Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] };
        let points = Points { axes: columns.each_ref().map(Vec::as_slice), cell: Some(&cell) };
        assert!(CellList::new(points, &[0], 1000.0).is_err());
        let list = CellList::new(points, &[0], 2.0).expect("a list");
        assert_eq!(listed(&list, DVec3::ZERO, 1.0).len(), 7);
    }
}
