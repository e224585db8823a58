//! The contents of a particle file as spheres, with what they have in common in all frames.

use super::arrows::{ArrowSizes, Arrows};
use super::{Orientation, ParticleFrame};
use crate::scene::{NamedMaterial, Spheres};
use glam::DVec3;
use spherule_particles::internals::pairs;

/// The contents of a particle file, as spheres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Particles {
    /// The spheres; materials are rows of `material_names`.
    pub spheres: Spheres,
    /// The frame, without what `spheres` has: positions, radii, colors and materials, whose columns are empty. Other
    /// columns have a row for each sphere. The cell and trails are scaled like positions, the radius of an ellipsoid is that
    /// of the sphere around it, and each warning begins with the name of the file.
    pub frame: ParticleFrame,
    /// Names of materials in the file; an empty name means none.
    pub material_names: Vec<String>,
    /// Opacities by row of `material_names`, 0 to 1; `None`, or no row, for that of the material.
    pub opacities: Vec<Option<f64>>,
    /// Radius of the sticks that are drawn for bonds ([`Model`](super::Model)); 0: none are drawn.
    pub stick_radius: f64,
    /// Radius of the sticks at each particle, if they differ; 0 where none are drawn.
    pub stick_radii: Vec<f64>,
    /// Row of the polyhedra of each particle among those of the style ([`ParticleStyle::find_polyhedra`](super::ParticleStyle::find_polyhedra));
    /// empty if all have the same.
    pub polyhedra: Vec<u32>,
    /// Arrows for vectors, if they were asked for ([`ParticleStyle::arrows`](super::ParticleStyle::arrows)).
    pub arrows: Arrows,
    /// Chosen materials, by names in `material_names`; the others are defined by the scene.
    pub materials: Vec<NamedMaterial>,
    /// The radius of all before scaling, if it is guessed.
    pub guessed_radius: Option<f64>,
    /// The choices that all frames of the file have in common, if it has several.
    pub first_frame: Option<FirstFrame>,
    /// The orientation of all particles, before a style dropped some or changed their radii.
    pub orientation: Option<Orientation>,
    /// True if the cell of the file is that of a small crystal ([`ParticleFrame::has_crystal_cell`]).
    pub has_crystal_cell: bool,
    /// True if the file is that of a crystal ([`ParticleFrame::is_crystal`]).
    pub is_crystal: bool,
    /// Bodies that the boundary of the cell and polyhedra add, made when all rows are final ([`Particles::draw_boundary`]).
    pub added: AddedBodies,
}

impl Particles {
    /// Returns the `key=value` pairs of the title, as extended XYZ has them.
    pub fn header_values(&self) -> Vec<(String, String)> {
        pairs(&self.frame.title)
    }

    /// Keeps the rows for which `keep` is true.
    pub(super) fn retain(&mut self, keep: &[bool]) {
        self.spheres.retain(keep);
        self.frame.retain(keep);
        self.arrows.retain(keep);
    }
}

/// Bodies that the boundary of the cell and polyhedra add to those of particles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AddedBodies {
    /// Halves of bonds that leave what is drawn.
    pub(super) stubs: Vec<Stub>,
    pub(super) polyhedra: Vec<Polyhedron>,
}

/// The half of a bond that leaves what is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stub {
    /// The particle at its end.
    pub(super) row: u32,
    /// The vector from there to the middle of the bond.
    pub(super) half: DVec3,
}

/// A polyhedron that is drawn, by rows of spheres.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polyhedron {
    pub(super) center: u32,
    pub(super) triangles: Vec<[u32; 3]>,
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) opacity: f64,
}

/// The choices that all frames of a file with several have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstFrame {
    /// The orientation of the first frame.
    pub orientation: Orientation,
    /// Half of the mean spacing in the first frame, if radii are guessed by it.
    pub guessed_radius: Option<f64>,
    /// Number of particles in the first frame, on which the number of samples depends.
    pub spheres: usize,
    /// The sizes of arrows in the first frame; `None` if none are asked for, or if it has no vectors.
    pub arrow_sizes: Option<ArrowSizes>,
    /// The length from which arrows may be shortened; `None` as the sizes.
    pub arrow_limit: Option<f64>,
}
