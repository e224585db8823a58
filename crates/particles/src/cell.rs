//! The periodic cell, its edges and corners, and fractional coordinates.

use glam::{DMat3, DVec3};

/// The periodic cell of a simulation: a parallelepiped, orthogonal or triclinic.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// The corner at which the edges a, b and c begin.
    pub origin: DVec3,
    /// The edges a, b and c.
    pub vectors: [DVec3; 3],
    /// True for each edge along which the simulation is periodic.
    pub periodic: [bool; 3],
}

impl Cell {
    /// Returns the Cartesian coordinates of a point in fractional coordinates.
    pub fn cartesian(&self, fractional: [f64; 3]) -> DVec3 {
        let [a, b, c] = self.vectors;
        self.origin + a * fractional[0] + b * fractional[1] + c * fractional[2]
    }

    /// Returns a cell with edges of these lengths and angles in degrees, in the crystallographic
    /// convention: the first edge along x, the second in the x-y plane. `None` if numbers are missing or no edge has a length; where
    /// no cell has such angles, edges are NaN.
    pub(crate) fn of_lengths(lengths: [f64; 3], angles: [f64; 3]) -> Option<Self> {
        if lengths == [0.0; 3] || !lengths.iter().chain(&angles).all(|number| number.is_finite()) {
            return None;
        }
        let [a, b, c] = lengths;
        // Right angles are exact, and those of an edge without length mean nothing.
        let cosine = |angle: usize| {
            let [next, last] = [lengths[(angle + 1) % 3], lengths[(angle + 2) % 3]];
            let is_right = angles[angle] == 90.0 || next == 0.0 || last == 0.0;
            if is_right { 0.0 } else { libm::cos(angles[angle].to_radians()) }
        };
        let [alpha, beta, gamma] = [cosine(0), cosine(1), cosine(2)];
        let sine = (1.0 - gamma * gamma).sqrt();
        let tilt = (alpha - beta * gamma) / sine;
        let height = (1.0 - beta * beta - tilt * tilt).sqrt();
        let vectors = [
            DVec3::new(a, 0.0, 0.0),
            DVec3::new(b * gamma, b * sine, 0.0),
            DVec3::new(c * beta, c * tilt, c * height),
        ];
        Some(Self { origin: DVec3::ZERO, vectors, periodic: [true; 3] }.thickened())
    }

    /// Returns the cell that a file declares, [thickened](Self::thickened); `None` if a number is missing or no edge has a length. It
    /// may lack a volume: [`reader`](crate::reader) tells.
    pub(crate) fn declared(self) -> Option<Self> {
        let [a, b, c] = self.vectors;
        let finite = [a, b, c, self.origin].iter().all(|vector| vector.is_finite());
        (finite && self.vectors != [DVec3::ZERO; 3]).then(|| self.thickened())
    }

    /// Returns the cell, [thickened](Self::thickened), if it is finite and then has a volume.
    pub(crate) fn checked(self) -> Option<Self> {
        self.thickened().with_volume()
    }

    /// Returns the cell if it is finite and has a volume, as cells of crystals have.
    pub(crate) fn with_volume(self) -> Option<Self> {
        let [a, b, c] = self.vectors;
        let finite = [a, b, c, self.origin].iter().all(|vector| vector.is_finite());
        (finite && a.cross(b).dot(c) != 0.0).then_some(self)
    }

    /// Makes edges of length 0, as of simulations in two dimensions, normals of length 1 with the others at their middle, along which
    /// the cell is not periodic. Cells without any edge stay.
    fn thickened(mut self) -> Self {
        if self.vectors == [DVec3::ZERO; 3] {
            return self;
        }
        for edge in 0..3 {
            if self.vectors[edge] != DVec3::ZERO {
                continue;
            }
            let [next, last] = [(edge + 1) % 3, (edge + 2) % 3].map(|other| self.vectors[other]);
            let normal = match (next == DVec3::ZERO, last == DVec3::ZERO) {
                (false, false) => next.cross(last),
                (false, true) => next.any_orthogonal_vector(),
                _ => last.any_orthogonal_vector(),
            };
            self.vectors[edge] = normal.normalize_or_zero();
            self.origin -= self.vectors[edge] * 0.5;
            self.periodic[edge] = false;
        }
        self
    }

    /// Returns the fractional coordinates of a point: the inverse of [`Cell::cartesian`].
    pub fn fractional(&self, point: DVec3) -> DVec3 {
        self.matrix().inverse() * (point - self.origin)
    }

    /// Returns the eight corners; bit `i` of a corner's number says whether it is at the end of edge `i`.
    pub fn corners(&self) -> [DVec3; 8] {
        let coordinate = |corner: usize, edge: usize| f64::from(u8::from(corner >> edge & 1 == 1));
        std::array::from_fn(|corner| self.cartesian([0, 1, 2].map(|edge| coordinate(corner, edge))))
    }

    /// Returns the box of the corners: the lower and the upper one.
    pub fn bounds(&self) -> [DVec3; 2] {
        let [first, rest @ ..] = self.corners();
        rest.iter().fold([first; 2], |[low, high], corner| [low.min(*corner), high.max(*corner)])
    }

    /// Returns the twelve edges, each from one corner to another.
    pub fn edges(&self) -> [[DVec3; 2]; 12] {
        let corners = self.corners();
        let starts = |edge: usize| (0..8).filter(move |corner| corner >> edge & 1 == 0);
        let mut edges = (0..3).flat_map(|edge| starts(edge).map(move |at| [at, at | 1 << edge]));
        std::array::from_fn(|_| edges.next().unwrap_or_default().map(|corner| corners[corner]))
    }

    /// Returns the matrix from fractional to Cartesian coordinates, without the origin.
    pub fn matrix(&self) -> DMat3 {
        let [a, b, c] = self.vectors;
        DMat3::from_cols(a, b, c)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flat_cells_are_as_thick_as_1_and_not_periodic_there() {
        let cell = |vectors: [[f64; 3]; 3]| {
            let vectors = vectors.map(DVec3::from_array);
            Cell { origin: DVec3::ZERO, vectors, periodic: [true; 3] }.checked()
        };
        let flat = cell([[6.0, 0.0, 0.0], [1.5, 5.0, 0.0], [0.0; 3]]).expect("a cell");
        assert_eq!(flat.vectors, [DVec3::X * 6.0, DVec3::new(1.5, 5.0, 0.0), DVec3::Z]);
        assert_eq!((flat.origin, flat.periodic), (DVec3::Z * -0.5, [true, true, false]));
        let line = cell([[0.0; 3], [0.0, 3.0, 0.0], [0.0; 3]]).expect("a cell");
        assert_eq!((line.periodic, line.vectors[1]), ([false, true, false], DVec3::Y * 3.0));
        assert!((line.matrix().determinant().abs() - 3.0).abs() < 1e-12, "{line:?}");
        for none in [[[0.0; 3]; 3], [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0; 3]]] {
            assert_eq!(cell(none), None);
        }
    }

    #[test]
    fn cells_have_the_given_lengths_and_angles() {
        let cell = Cell::of_lengths([2.0, 3.0, 4.0], [80.0, 95.0, 120.0]).expect("a cell");
        let [a, b, c] = cell.vectors;
        for (first, second, angle) in [(b, c, 80.0_f64), (a, c, 95.0), (a, b, 120.0)] {
            assert!((first.angle_between(second).to_degrees() - angle).abs() < 1e-12, "{angle}");
        }
        assert!((b.length() - 3.0).abs() < 1e-14 && (c.length() - 4.0).abs() < 1e-14);
        let box_shaped = Cell::of_lengths([2.0, 3.0, 4.0], [90.0; 3]).expect("a cell");
        assert_eq!(box_shaped.vectors, [DVec3::X * 2.0, DVec3::Y * 3.0, DVec3::Z * 4.0]);
        assert_eq!(box_shaped.cartesian([0.5, 1.0, 0.25]), DVec3::new(1.0, 3.0, 1.0));
        for (lengths, angles) in [([0.0; 3], [90.0; 3]), ([f64::NAN, 1.0, 1.0], [90.0; 3])] {
            assert_eq!(Cell::of_lengths(lengths, angles), None, "{lengths:?} {angles:?}");
        }
        for angles in [[0.0; 3], [150.0; 3]] {
            let cell = Cell::of_lengths([1.0; 3], angles).expect("a declared cell");
            assert_eq!(cell.with_volume(), None, "{angles:?}");
        }
        for angles in [[90.0; 3], [0.0, 0.0, 90.0]] {
            let layer = Cell::of_lengths([2.0, 3.0, 0.0], angles).expect("a cell");
            assert_eq!(layer.vectors, [DVec3::X * 2.0, DVec3::Y * 3.0, DVec3::Z]);
            assert_eq!((layer.periodic, layer.origin.z), ([true, true, false], -0.5));
        }
    }
}
