//! Orientation of particles: which direction is up, and the projection that suits them.
//!
//! Files do not say what is up. What the particles and their cell show decides first: a single layer, a
//! slab, a bed on a floor. Then the convention of the format decides.

use super::{Cell, Format, Particles};
use crate::scene::{Axis, Camera, Pose, Projection, Spheres};
use glam::DVec3;
use rayon::prelude::*;
use std::fmt;

/// Maximum number of spheres whose radii are sorted to find the median.
const SAMPLE: usize = 4096;

/// Maximum thickness of a single layer, in median diameters.
const LAYER: f64 = 1.1;

/// Minimum width of a wavy layer, whose centers are within a diameter, in its thicknesses.
const WAVY: f64 = 10.0;

/// Minimum width of a vacuum, as a fraction of the cell's edge and in median radii.
const VACUUM: f64 = 0.25;
const VACUUM_RADII: f64 = 4.0;

/// Number of bins along an edge of the cell, in which gaps are measured.
const BINS: usize = 64;

/// Mean number of spheres in a block of the grid that decides whether a cell is full, maximum number of
/// blocks along an edge, and minimum fraction of blocks with spheres.
const PER_BLOCK: usize = 12;
const MAX_BLOCKS: usize = 16;
const FULL: f64 = 0.85;

/// Minimum number of spheres in a bed.
const BED: usize = 50;

/// Edge of a field of a floor in median diameters, and maximum number of fields along an edge.
const FIELD: f64 = 3.0;
const MAX_FIELDS: usize = 32;

/// Distance from a plane within which a sphere touches it, in median radii.
const TOUCH: f64 = 0.25;

/// Minimum fraction of the fields of a floor that spheres touch, and maximum fraction opposite of it.
const FLOOR: f64 = 0.6;
const SURFACE: f64 = 0.35;

/// The vertical direction of particles, and the projection that suits them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orientation {
    /// The direction that is up.
    pub up: Axis,
    /// The reason for it.
    pub reason: UpReason,
    /// Orthographic for a periodic cell full of particles, or else a long lens.
    pub projection: Projection,
    /// The side of a single layer that is seen; `None` for the usual view from a corner.
    pub front: Option<Axis>,
}

/// A reason why a direction is up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum UpReason {
    /// It was chosen.
    Chosen,
    /// The particles are a single layer, which is seen from the front.
    Layer,
    /// The cell is periodic in the two other directions.
    Slab,
    /// The particles leave a vacuum along it, and none along the two other edges of the cell.
    Vacuum,
    /// The particles rest on a flat floor and have a free surface.
    Bed,
    /// Molecules have no direction that is up.
    Molecule,
    /// The convention of simulations and of tables.
    Convention(Format),
}

impl UpReason {
    /// Returns whether the particles themselves or the user show what is up.
    pub fn is_evident(self) -> bool {
        !matches!(self, Self::Molecule | Self::Convention(_))
    }
}

impl fmt::Display for UpReason {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Chosen => formatter.write_str("as chosen"),
            Self::Layer => formatter.write_str("the particles are a single layer"),
            Self::Slab => formatter.write_str("the cell is periodic in the other two directions"),
            Self::Vacuum => formatter.write_str("the particles leave a vacuum along it"),
            Self::Bed => formatter.write_str("the particles rest on a flat floor"),
            Self::Molecule => formatter.write_str("molecules have no direction of their own"),
            Self::Convention(format) => {
                write!(formatter, "the convention for the format {}", format.name())
            }
        }
    }
}

impl Orientation {
    /// Finds the orientation of particles.
    pub fn of(particles: &Particles) -> Self {
        let (spheres, cell) = (&particles.spheres, particles.frame.cell.as_ref());
        let molecules = particles.frame.format.has_molecules()
            || particles.frame.format == Format::Xyz && cell.is_none();
        let cell = cell.filter(|_| !molecules);
        let radius = median_radius(spheres);
        let gaps = cell.map(|cell| gaps(spheres, cell));
        let front = layer(spheres, radius);
        let found = || {
            let slab = || Some((slab(cell?)?, UpReason::Slab));
            let vacuum = || Some((vacuum(cell?, gaps?, radius)?, UpReason::Vacuum));
            let bed = || Some((bed(spheres, cell, radius)?, UpReason::Bed));
            slab().or_else(vacuum).or_else(bed)
        };
        let (up, reason) = match front {
            Some(Axis::Z) => (Axis::Y, UpReason::Layer),
            Some(_) => (Axis::Z, UpReason::Layer),
            None if molecules => (Axis::Y, UpReason::Molecule),
            None => found().unwrap_or((Axis::Z, UpReason::Convention(particles.frame.format))),
        };
        let full = cell.is_some_and(|cell| is_full(spheres, cell, gaps));
        let projection =
            if full { Projection::Orthographic { height: None } } else { Camera::LONG_LENS };
        Self { up, reason, projection, front }
    }

    /// Returns a camera that frames all particles.
    pub fn camera(&self) -> Camera {
        let side = |front: &Axis| front.vector().dot(self.up.vector()) == 0.0;
        let direction = match self.front.filter(side) {
            Some(front) => -front.vector(),
            None => Camera::fit_direction(self.up),
        };
        Camera {
            projection: self.projection,
            pose: Pose::Fit { direction, margin: Camera::FIT_MARGIN },
            up: self.up.vector(),
            ..Camera::default()
        }
    }

    /// Returns the direction that is up in views along a coordinate axis: molecules have none, so it is z.
    pub fn up_of_sides(&self) -> Axis {
        if self.reason == UpReason::Molecule { Axis::Z } else { self.up }
    }
}

/// Returns the median of the radii, or of a sample of them; 0 without spheres.
fn median_radius(spheres: &Spheres) -> f64 {
    let step = spheres.len().div_ceil(SAMPLE).max(1);
    let mut radii: Vec<f64> = spheres.radius.iter().step_by(step).copied().collect();
    let middle = radii.len() / 2;
    if radii.is_empty() { 0.0 } else { *radii.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

/// Returns the lower and upper corner of the box of all centers.
pub(super) fn bounds_of_centers(spheres: &Spheres) -> [DVec3; 2] {
    let ends = |column: &[f64]| {
        let low = column.par_iter().copied().reduce(|| f64::INFINITY, f64::min);
        [low, column.par_iter().copied().reduce(|| f64::NEG_INFINITY, f64::max)]
    };
    let [x, y, z] = [&spheres.x, &spheres.y, &spheres.z].map(|column| ends(column));
    [DVec3::new(x[0], y[0], z[0]), DVec3::new(x[1], y[1], z[1])]
}

/// Returns the side from which a single layer is seen that is perpendicular to a coordinate axis.
fn layer(spheres: &Spheres, radius: f64) -> Option<Axis> {
    if spheres.len() < 3 {
        return None;
    }
    let [low, high] = bounds_of_centers(spheres);
    let size = high - low;
    let thin = |axis: usize| {
        let width = size[(axis + 1) % 3].min(size[(axis + 2) % 3]);
        let is_wavy = size[axis] < 2.0 * radius && width > WAVY * size[axis];
        size[axis] < 2.0 * (LAYER - 1.0) * radius || is_wavy
    };
    let wide = |axis: usize| size[axis] > 4.0 * radius;
    match [0, 1, 2].map(thin) {
        [false, false, true] if wide(0) && wide(1) => Some(Axis::Z),
        [false, true, false] if wide(0) && wide(2) => Some(Axis::NegY),
        [true, false, false] if wide(1) && wide(2) => Some(Axis::X),
        _ => None,
    }
}

/// Returns the direction across the two periodic edges of a cell that has exactly two.
fn slab(cell: &Cell) -> Option<Axis> {
    let [a, b, c] = cell.vectors;
    match cell.periodic {
        [true, true, false] => Axis::nearest(a.cross(b).abs()),
        [true, false, true] => Axis::nearest(a.cross(c).abs()),
        [false, true, true] => Axis::nearest(b.cross(c).abs()),
        _ => None,
    }
}

/// Returns the direction along which particles leave a vacuum in their cell, if it is only one.
fn vacuum(cell: &Cell, gaps: [f64; 3], radius: f64) -> Option<Axis> {
    let is_vacuum = |edge: usize| {
        let width = gaps[edge] * height(cell, edge);
        gaps[edge] >= VACUUM && width >= VACUUM_RADII * radius
    };
    let [a, b, c] = cell.vectors;
    match [0, 1, 2].map(is_vacuum) {
        [false, false, true] => Axis::nearest(a.cross(b).abs()),
        [false, true, false] => Axis::nearest(a.cross(c).abs()),
        [true, false, false] => Axis::nearest(b.cross(c).abs()),
        _ => None,
    }
}

/// Returns the distance between the two faces of the cell that an edge connects.
fn height(cell: &Cell, edge: usize) -> f64 {
    let across = cell.vectors[(edge + 1) % 3].cross(cell.vectors[(edge + 2) % 3]);
    cell.vectors[edge].dot(across.normalize_or_zero()).abs()
}

/// Calls `each` with the fractional coordinates of every center, moved into the cell.
fn for_each_fraction(spheres: &Spheres, cell: &Cell, mut each: impl FnMut(DVec3)) {
    let inverse = cell.matrix().inverse();
    for row in 0..spheres.len() {
        let fraction = inverse * (spheres.center(row) - cell.origin);
        each(fraction - fraction.floor());
    }
}

/// Returns the index of the part of `0..count` in which a fraction, 0..=1, lies.
fn part(fraction: f64, count: usize) -> usize {
    ((fraction * count as f64) as usize).min(count - 1)
}

/// Returns the largest gap between centers along each edge of a cell, as a fraction of the edge.
fn gaps(spheres: &Spheres, cell: &Cell) -> [f64; 3] {
    let mut taken = [[false; BINS]; 3];
    for_each_fraction(spheres, cell, |fraction| {
        for (edge, taken) in taken.iter_mut().enumerate() {
            taken[part(fraction[edge], BINS)] = true;
        }
    });
    taken.map(|taken| {
        let (mut gap, mut longest) = (0, 0);
        // Twice around, because the cell is periodic.
        for bin in taken.iter().chain(&taken) {
            gap = if *bin { 0 } else { gap + 1 };
            longest = longest.max(gap);
        }
        longest.min(BINS) as f64 / BINS as f64
    })
}

/// Returns whether a cell is periodic along all edges and full of particles.
fn is_full(spheres: &Spheres, cell: &Cell, gaps: Option<[f64; 3]>) -> bool {
    let open = gaps.is_none_or(|gaps| gaps.iter().any(|gap| *gap >= 2.0 * VACUUM));
    if cell.periodic.contains(&false) || spheres.is_empty() || open {
        return false;
    }
    let enough = |count: &usize| count.pow(3) * PER_BLOCK <= spheres.len();
    let count = (1..=MAX_BLOCKS).rev().find(enough).unwrap_or(1);
    let mut taken = vec![false; count.pow(3)];
    for_each_fraction(spheres, cell, |fraction| {
        let [i, j, k] = fraction.to_array().map(|share| part(share, count));
        taken[(i * count + j) * count + k] = true;
    });
    let full = taken.iter().filter(|taken| **taken).count();
    full as f64 >= FULL * taken.len() as f64
}

/// Returns the direction away from the floor of a bed: of the six sides of the box of all spheres, pairs
/// of walls are alike, but a floor is touched everywhere and a free surface is not. A border over which the cell is
/// periodic is no floor.
fn bed(spheres: &Spheres, cell: Option<&Cell>, radius: f64) -> Option<Axis> {
    if spheres.len() < BED {
        return None;
    }
    let walls = [0, 1, 2].map(|axis| touched(spheres, axis, radius));
    let is_floor = |floor: f64, opposite: f64| floor >= FLOOR && opposite <= SURFACE;
    let is_periodic = |axis: Axis| {
        cell.is_some_and(|cell| {
            let mut edges = cell.vectors.iter().zip(cell.periodic);
            edges.any(|(edge, periodic)| periodic && Axis::nearest(edge.abs()) == Some(axis))
        })
    };
    let walls = [Axis::X, Axis::Y, Axis::Z].into_iter().zip(walls);
    let walls = walls.filter(|(axis, _)| !is_periodic(*axis));
    let beds = walls.filter_map(|(axis, ends)| {
        let [low, high] = ends;
        match (is_floor(low, high), is_floor(high, low)) {
            (true, _) => Some(axis),
            (_, true) => Some(axis.opposite()),
            _ => None,
        }
    });
    let beds: Vec<Axis> = beds.collect();
    if let [up] = beds[..] { Some(up) } else { None }
}

/// Returns the fractions of the lower and of the upper side of the box of all spheres that spheres touch,
/// in fields of a few spheres.
fn touched(spheres: &Spheres, axis: usize, radius: f64) -> [f64; 2] {
    let columns = [&spheres.x, &spheres.y, &spheres.z];
    let [across, upward, along] = [0, 1, 2].map(|shift| columns[(axis + 1 + shift) % 3]);
    let ends = |column: &[f64]| {
        let low = column.iter().copied().fold(f64::INFINITY, f64::min);
        [low, column.iter().copied().fold(f64::NEG_INFINITY, f64::max)]
    };
    let (across_ends, upward_ends) = (ends(across), ends(upward));
    let count = |[low, high]: [f64; 2]| {
        let fields = (high - low) / (2.0 * FIELD * radius);
        (fields as usize).clamp(1, MAX_FIELDS)
    };
    let (columns, rows) = (count(across_ends), count(upward_ends));
    let edges = || along.iter().zip(&spheres.radius);
    let lowest = edges().map(|(center, radius)| center - radius).fold(f64::INFINITY, f64::min);
    let highest = edges().map(|(center, radius)| center + radius).fold(f64::NEG_INFINITY, f64::max);
    let mut taken = [vec![false; columns * rows], vec![false; columns * rows]];
    let share = |x: f64, [low, high]: [f64; 2]| (x - low) / (high - low).max(f64::MIN_POSITIVE);
    for (row, (center, own)) in edges().enumerate() {
        let touches =
            [center - own - lowest < TOUCH * radius, highest - center - own < TOUCH * radius];
        for (side, _) in touches.into_iter().enumerate().filter(|(_, touches)| *touches) {
            let column = part(share(across[row], across_ends), columns);
            taken[side][part(share(upward[row], upward_ends), rows) * columns + column] = true;
        }
    }
    taken.map(|taken| taken.iter().filter(|taken| **taken).count() as f64 / taken.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Rgb;

    fn particles(format: Format, centers: impl IntoIterator<Item = DVec3>) -> Particles {
        let mut particles = Particles::default();
        particles.frame.format = format;
        for center in centers {
            particles.spheres.push(center, 0.5, 0, Rgb::ONE);
        }
        particles
    }

    fn cell(size: DVec3, periodic: [bool; 3]) -> Cell {
        let vectors = [DVec3::X * size.x, DVec3::Y * size.y, DVec3::Z * size.z];
        Cell { origin: DVec3::ZERO, vectors, periodic }
    }

    /// Centers of a cubic lattice.
    fn lattice(counts: [i32; 3]) -> impl Iterator<Item = DVec3> {
        let [x, y, z] = counts;
        let point = move |i: i32| DVec3::from([i / (y * z), i / z % y, i % z].map(f64::from));
        (0..x * y * z).map(point)
    }

    /// A bed: a dense lattice on a floor at z = 0, with a few spheres on top.
    fn bed_of_spheres() -> impl Iterator<Item = DVec3> {
        lattice([12, 12, 6]).chain([DVec3::new(5.0, 5.0, 6.0), DVec3::new(2.0, 8.0, 6.0)])
    }

    /// Rotates z to another axis.
    fn turned(up: Axis) -> impl Fn(DVec3) -> DVec3 {
        move |p| match up {
            Axis::X => DVec3::new(p.z, p.x, p.y),
            Axis::NegX => DVec3::new(-p.z, p.x, p.y),
            Axis::Y => DVec3::new(p.x, p.z, p.y),
            Axis::NegY => DVec3::new(p.x, -p.z, p.y),
            Axis::Z => p,
            Axis::NegZ => DVec3::new(p.x, p.y, -p.z),
        }
    }

    fn found(particles: &Particles) -> (Axis, UpReason) {
        let Orientation { up, reason, .. } = Orientation::of(particles);
        (up, reason)
    }

    #[test]
    fn beds_rest_on_their_floor_whatever_the_direction() {
        for (_, up) in Axis::ALL {
            let bed = particles(Format::Csv, bed_of_spheres().map(turned(up)));
            assert_eq!(found(&bed), (up, UpReason::Bed));
        }
        // Over a periodic border there is no floor.
        for (periodic, expected) in [([false; 3], true), ([true; 3], false)] {
            let mut bed = particles(Format::Csv, bed_of_spheres());
            bed.frame.cell = Some(cell(DVec3::new(12.0, 12.0, 7.0), periodic));
            assert_eq!(found(&bed).1 == UpReason::Bed, expected, "{periodic:?}");
        }
        // Both ends of a block are flat.
        let block = particles(Format::Csv, lattice([12, 12, 6]));
        assert_eq!(found(&block), (Axis::Z, UpReason::Convention(Format::Csv)));
    }

    #[test]
    fn formats_have_conventions() {
        let cloud = || lattice([4, 4, 4]).map(|p| p * DVec3::new(1.0, 1.1, 1.2));
        for (_, format) in Format::ALL {
            let expected = match format {
                Format::Pdb
                | Format::MmCif
                | Format::BinaryCif
                | Format::Pqr
                | Format::Sdf
                | Format::Mol2
                | Format::Xyz => (Axis::Y, UpReason::Molecule),
                _ => (Axis::Z, UpReason::Convention(format)),
            };
            assert_eq!(found(&particles(format, cloud())), expected);
            let camera = Orientation::of(&particles(format, cloud())).camera();
            assert_eq!(camera.projection, Camera::LONG_LENS);
        }
        // A molecule is no bed.
        assert_eq!(found(&particles(Format::Pdb, bed_of_spheres())).1, UpReason::Molecule);
    }

    #[test]
    fn slabs_stand_on_their_periodic_plane() {
        let mut slab = particles(Format::Xyz, lattice([6, 3, 6]));
        slab.frame.cell = Some(cell(DVec3::new(6.0, 20.0, 6.0), [true, false, true]));
        assert_eq!(found(&slab), (Axis::Y, UpReason::Slab));
        slab.frame.cell = Some(cell(DVec3::new(6.0, 20.0, 6.0), [true; 3]));
        assert_eq!(found(&slab), (Axis::Y, UpReason::Vacuum));
        assert_eq!(Orientation::of(&slab).projection, Camera::LONG_LENS);
        // Wrapped around the end of the cell, it is the same slab.
        slab.spheres.y.iter_mut().for_each(|y| *y = (*y + 18.5) % 20.0);
        assert_eq!(found(&slab), (Axis::Y, UpReason::Vacuum));
    }

    #[test]
    fn full_periodic_cells_are_seen_in_parallel_projection() {
        let parallel = Projection::Orthographic { height: None };
        let mut crystal = particles(Format::Cif, lattice([6, 6, 6]));
        crystal.frame.cell = Some(cell(DVec3::splat(6.0), [true; 3]));
        let orientation = Orientation::of(&crystal);
        assert_eq!((orientation.up, orientation.projection), (Axis::Z, parallel));
        crystal.frame.cell = Some(cell(DVec3::splat(6.0), [true, false, false]));
        assert_eq!(Orientation::of(&crystal).projection, Camera::LONG_LENS);
        crystal.frame.cell = Some(cell(DVec3::splat(13.0), [true; 3]));
        assert_eq!(Orientation::of(&crystal).projection, Camera::LONG_LENS);
        let mut small = particles(Format::Cif, [DVec3::ZERO, DVec3::splat(0.5)]);
        small.frame.cell = Some(cell(DVec3::ONE, [true; 3]));
        assert_eq!(Orientation::of(&small).projection, parallel);
    }

    #[test]
    fn single_layers_are_seen_from_the_front() {
        for (normal, up) in [(Axis::Z, Axis::Y), (Axis::Y, Axis::Z), (Axis::X, Axis::Z)] {
            let layer = particles(Format::LammpsDump, lattice([9, 9, 1]).map(turned(normal)));
            assert_eq!(found(&layer), (up, UpReason::Layer));
            let Pose::Fit { direction, .. } = Orientation::of(&layer).camera().pose else {
                panic!("it frames the layer")
            };
            let facing = direction.normalize().dot(normal.vector()).abs();
            assert_eq!(facing, 1.0, "{normal:?}");
            // Another direction that is up is that of the image, unless it is the layer's normal.
            for (_, up) in Axis::ALL {
                let chosen = Orientation { up, ..Orientation::of(&layer) };
                let Pose::Fit { direction, .. } = chosen.camera().pose else { panic!("a fit") };
                let is_normal = up == normal || up == normal.opposite();
                assert_eq!(direction == Camera::fit_direction(up), is_normal, "{normal:?} {up:?}");
            }
        }
        let wave = |height: f64| {
            let lift = move |p: DVec3| p + DVec3::Z * (height * (0.7 * p.x).sin());
            found(&particles(Format::Csv, lattice([20, 20, 1]).map(lift))).1
        };
        assert_eq!(wave(0.4), UpReason::Layer);
        assert_ne!(wave(1.0), UpReason::Layer);
        // A flat molecule is one, too.
        assert_eq!(found(&particles(Format::Xyz, lattice([9, 9, 1]))), (Axis::Y, UpReason::Layer));
    }

    #[test]
    fn nothing_and_single_spheres_have_an_orientation() {
        for count in 0..3 {
            let few = particles(Format::Csv, lattice([1, 1, count]));
            assert_eq!(found(&few).0, Axis::Z);
        }
    }
}
