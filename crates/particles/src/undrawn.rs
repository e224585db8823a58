//! Warnings about contents of a file that are not drawn as spheres, one for each kind.

use crate::{ParticleFrame, error::listed};

/// A kind of content that is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Undrawn {
    Bonds,
    Faces,
    Edges,
    /// Polyhedra, rods and other shapes of particles.
    Shapes,
    Orientations,
    /// Ellipsoids of thermal displacement.
    Displacements,
}

/// Names of columns of shapes and of orientations, without prefixes and axes.
const SHAPES: [&str; 2] = ["shape", "aspherical_shape"];
const ORIENTATIONS: [&str; 6] =
    ["quat", "quaternion", "quaternions", "orient", "orientation", "orientations"];

/// Prefixes that LAMMPS writes before the names of computes, fixes, variables and properties.
const PREFIXES: [&str; 7] = ["c_", "f_", "v_", "i_", "d_", "i2_", "d2_"];

impl Undrawn {
    fn text(self, count: u64) -> String {
        let (one, many, rest) = match self {
            Self::Bonds => ("bond is", "bonds are", "not drawn"),
            Self::Faces => ("face is", "faces are", "not drawn: only the vertices are"),
            Self::Edges => ("edge is", "edges are", "not drawn: only the vertices are"),
            Self::Shapes => (
                "particle that may have another shape is",
                "particles that may have other shapes are",
                "drawn as spheres",
            ),
            Self::Orientations => ("orientation is", "orientations are", "not drawn"),
            Self::Displacements => {
                ("displacement ellipsoid is", "displacement ellipsoids are", "not drawn")
            }
        };
        format!("{count} {} {rest}", if count == 1 { one } else { many })
    }
}

impl ParticleFrame {
    /// Adds a warning that contents of the file are not drawn, if there are any.
    pub(crate) fn add_undrawn(&mut self, kind: Undrawn, count: u64) {
        if count > 0 {
            let text = kind.text(count);
            if !self.warnings.contains(&text) {
                self.warnings.push(text);
            }
        }
    }

    /// Adds a warning that lists the unused arrays of the file.
    pub(crate) fn add_unused_arrays(&mut self, names: &[&str]) {
        if !names.is_empty() {
            self.warnings.push(listed("arrays that are not used", names));
        }
    }

    /// Adds a warning about columns of shapes and orientations that are not drawn.
    pub(crate) fn add_undrawn_columns(&mut self) {
        let count = self.len() as u64;
        for (kind, names) in
            [(Undrawn::Shapes, &SHAPES[..]), (Undrawn::Orientations, &ORIENTATIONS[..])]
        {
            if self.columns.iter().any(|column| is_axis_of(column, names)) {
                self.add_undrawn(kind, count);
            }
        }
    }
}

/// Returns whether a column is one of those names, or an axis of it as in `quatw`, `shape_x` or
/// `c_q[1]`.
fn is_axis_of(column: &str, names: &[&str]) -> bool {
    let column = column.to_ascii_lowercase();
    let own = PREFIXES.iter().find_map(|prefix| column.strip_prefix(prefix)).unwrap_or(&column);
    if let Some((name, _)) = own.split_once('[') {
        // Charges have no index.
        return names.contains(&name) || name == "q" && names.contains(&"quat");
    }
    let axis = own.strip_suffix(|letter: char| "wxyzijk1234".contains(letter));
    let name = axis.map_or(own, |name| name.trim_end_matches(['_', '.', ':']));
    names.contains(&own) || names.contains(&name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_and_orientations_are_recognized_by_columns() {
        for (columns, shapes, orientations) in [
            (&["id", "type", "x", "y", "z", "q", "shear", "qx"][..], false, false),
            (&["shapex", "shapey", "shapez"], true, false),
            (&["quatw", "quati"], false, true),
            (&["c_q[1]", "c_q[2]"], false, true),
            (&["c_orient[4]", "c_shape[1]"], true, true),
            (&["orientation_1", "aspherical_shape_x"], true, true),
            (&["orientation"], false, true),
            (&["quality", "shapes_of_things", "oriented"], false, false),
        ] {
            let is = |names: &[&str]| columns.iter().any(|column| is_axis_of(column, names));
            assert_eq!((is(&SHAPES), is(&ORIENTATIONS)), (shapes, orientations), "{columns:?}");
        }
    }

    #[test]
    fn each_kind_is_reported_once() {
        let mut frame = ParticleFrame::default();
        frame.add_undrawn(Undrawn::Bonds, 0);
        assert!(frame.warnings.is_empty());
        frame.add_undrawn(Undrawn::Bonds, 1);
        frame.add_undrawn(Undrawn::Bonds, 1);
        frame.add_undrawn(Undrawn::Faces, 2);
        assert_eq!(frame.warnings.len(), 2, "{:?}", frame.warnings);
        assert!(frame.warnings[1].starts_with("2 faces"));
    }
}
