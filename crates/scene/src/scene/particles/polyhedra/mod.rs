//! Coordination polyhedra: the convex hulls of the neighbors of particles, as triangles with edges.

mod hull;

use self::hull::{Hull, MOST};
use super::{Kind, Particles};
use crate::scene::{FileError, NamedMaterial, Sticks, Triangles};
use glam::DVec3;
use rayon::prelude::*;
use spherule_particles::internals::{PairRule, clipped};
use spherule_particles::neighbors::CellList;
use std::collections::HashSet;
use std::path::Path;
use std::str::FromStr;

/// Opacity of the faces, if none is given.
const OPACITY: f64 = 0.7;

/// Radius of the edges, relative to their mean length.
const EDGE: f64 = 0.008;

/// Brightness of the edges, relative to that of the faces.
const EDGE_COLOR: f32 = 0.5;

/// The coordination polyhedra that are drawn.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polyhedra {
    rules: Vec<PairRule>,
    /// Opacity of the faces, 0 to 1; `None` for 0.7.
    pub opacity: Option<f64>,
}

/// The neighbors of a particle, of which a polyhedron is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordination {
    /// Row of the particle.
    pub(super) center: u32,
    /// Rows of the neighbors, and the number of edges of the cell from each to its image next to the particle.
    neighbors: Vec<(u32, [i32; 3])>,
    /// Their hull.
    pub(super) hull: Hull,
}

/// A polyhedron that is drawn, by rows of spheres.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Polyhedron {
    center: u32,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
}

impl FromStr for Polyhedra {
    type Err = String;

    /// Parses comma-separated pairs of types or elements, center and corner, with or without a distance, as in
    /// `Ti-O<2.5,Si-O`. Without one, corners are bonded to the center.
    fn from_str(text: &str) -> Result<Self, String> {
        let rules = text.split(',').map(str::trim).map(|text| {
            let wrong = |why: String| format!("invalid polyhedra `{text}`: {why}, as in Ti-O<2.5");
            let rule = text.parse::<PairRule>().map_err(wrong)?;
            match rule.length {
                Some(0.0) => Err(wrong("`0` is not a length".to_owned())),
                _ => Ok(rule),
            }
        });
        Ok(Self { rules: rules.collect::<Result<_, _>>()?, opacity: None })
    }
}

impl Polyhedra {
    /// Returns whether there are none.
    pub fn is_empty(&self) -> bool {
        self.rules.is_empty()
    }

    /// Adds other ones.
    pub fn extend(&mut self, other: Self) {
        self.rules.extend(other.rules);
    }

    /// Returns whether bonds say which particles are neighbors.
    pub fn need_bonds(&self) -> bool {
        self.rules.iter().any(|rule| rule.length.is_none())
    }

    /// Finds the neighbors of all centers, over the periodic cell, in the order of the centers. A warning counts centers without a
    /// polyhedron.
    ///
    /// # Errors
    /// A rule names no type of the file unless `allow_empty`, there are no bonds although a rule has no distance, or a center has
    /// too many neighbors.
    pub fn find(
        &self,
        path: &Path,
        particles: &mut Particles,
        allow_empty: bool,
    ) -> Result<Vec<Coordination>, FileError> {
        if self.is_empty() || particles.spheres.is_empty() {
            return Ok(Vec::new());
        }
        particles.added.face_opacity = self.opacity;
        let fault = |message: String| FileError::whole_file(path, clipped(message));
        let count = particles.spheres.len();
        let mut neighbors: Vec<Vec<(u32, [i32; 3])>> = vec![Vec::new(); count];
        let mut is_center = vec![false; count];
        for rule in &self.rules {
            let kinds = &particles.frame.kinds;
            let none = Kind::default();
            let no_types = std::slice::from_ref(&none);
            let table = if kinds.codes.is_empty() { no_types } else { &kinds.table };
            let [centers, corners] = match rule.kinds(table, "polyhedra") {
                Ok(found) => found,
                Err(_) if allow_empty => continue,
                Err(message) => return Err(fault(message)),
            };
            let has = |table: &[bool], row: u32| {
                let code = if kinds.codes.is_empty() { 0 } else { kinds.codes.code(row as usize) };
                table[code as usize]
            };
            let rows = |table: &[bool]| -> Vec<u32> {
                (0..count as u32).filter(|&row| has(table, row)).collect()
            };
            for row in rows(&centers) {
                is_center[row as usize] = true;
            }
            if let Some(length) = rule.length {
                let corners = rows(&corners);
                let list = CellList::new(particles.points(), &corners, length).map_err(fault)?;
                let found = rows(&centers).into_par_iter().map(|row| {
                    let mut near = Vec::new();
                    list.any(particles.points().position(row as usize), length, |neighbor| {
                        let is_near =
                            neighbor.distance2 > 0.0 && neighbor.distance2 < length * length;
                        if is_near {
                            near.push((neighbor.row, neighbor.shift));
                        }
                        near.len() > MOST
                    });
                    (row, near)
                });
                for (row, near) in found.collect::<Vec<_>>() {
                    neighbors[row as usize].extend(near);
                }
                continue;
            }
            let Some(bonds) = &particles.frame.bonds else {
                let message = "has neither bonds nor elements for polyhedra";
                return Err(fault(message.to_owned()).with_help("give a distance, as in Ti-O<2.5"));
            };
            for bond in 0..bonds.len() {
                let (first, second) = (bonds.first[bond], bonds.second[bond]);
                let shift = bonds.shift_of(bond).map(i32::from);
                let back = shift.map(|edge| -edge);
                for (center, corner, shift) in [(first, second, shift), (second, first, back)] {
                    if has(&centers, center) && has(&corners, corner) {
                        neighbors[center as usize].push((corner, shift));
                    }
                }
            }
        }
        let points = particles.points();
        let matrix = particles.frame.cell.map_or(glam::DMat3::IDENTITY, |cell| cell.matrix());
        let mut found = Vec::new();
        let mut without = 0_u64;
        for (center, mut neighbors) in (0..).zip(neighbors) {
            neighbors.sort_unstable();
            neighbors.dedup();
            if neighbors.len() > MOST {
                let message =
                    format!("particle {center} has more than {MOST} neighbors for a polyhedron");
                return Err(fault(message).with_help("give a shorter distance, as in Ti-O<2.5"));
            }
            let place = |(row, shift): &(u32, [i32; 3])| {
                points.position(*row as usize) + matrix * DVec3::from(shift.map(f64::from))
            };
            let places: Vec<DVec3> = neighbors.iter().map(place).collect();
            match Hull::of(&places) {
                Some(hull) => found.push(Coordination { center, neighbors, hull }),
                None => without += u64::from(is_center[center as usize]),
            }
        }
        if without > 0 {
            let centers = is_center.iter().filter(|is_center| **is_center).count();
            let path = path.display();
            particles.frame.warnings.push(format!(
                "{path}: {without} of {centers} centers have no polyhedron, as they have fewer than 4 neighbors, or all in a plane"
            ));
        }
        Ok(found)
    }
}

impl Coordination {
    /// Returns the neighbors of the image of the center with this shift.
    pub(super) fn corners(&self, shift: [i32; 3]) -> impl Iterator<Item = (u32, [i32; 3])> {
        let moved = move |own: [i32; 3]| [0, 1, 2].map(|edge| own[edge] + shift[edge]);
        self.neighbors.iter().map(move |&(row, own)| (row, moved(own)))
    }
}

impl Polyhedron {
    pub(super) fn new(center: u32, corners: &[u32], hull: &Hull) -> Self {
        let row = |corner: u8| corners[usize::from(corner)];
        Self {
            center,
            triangles: hull.triangles.iter().map(|corners| corners.map(row)).collect(),
            edges: hull.edges.iter().map(|ends| ends.map(row)).collect(),
        }
    }
}

impl Particles {
    /// Returns the faces of polyhedra in the color of their centers, and appends their edges to the sticks; an edge that several
    /// polyhedra share has the color of the first. `materials` are those of the scene, to which those of the faces are
    /// added, and `rows` the row there of each material of the particles.
    pub(in crate::scene) fn append_polyhedra(
        &self,
        materials: &mut Vec<NamedMaterial>,
        rows: &[u32],
        sticks: &mut Sticks,
    ) -> Triangles {
        let mut triangles = Triangles::default();
        let at = |row: u32| self.spheres.center(row as usize);
        let edges = || self.added.polyhedra.iter().flat_map(|own| &own.edges);
        let lengths: f64 = edges().map(|[from, to]| at(*from).distance(at(*to))).sum();
        let radius = EDGE * lengths / edges().count().max(1) as f64;
        let mut drawn = HashSet::new();
        // Rows of the materials of faces, by those of their centers.
        let mut faces: Vec<(u32, u32)> = Vec::new();
        for polyhedron in &self.added.polyhedra {
            let center = polyhedron.center as usize;
            let (own, color) =
                (self.solid_material(center, materials, rows), self.spheres.color_of(center));
            let known = faces.iter().find(|(row, _)| *row == own).map(|(_, face)| *face);
            let face = known.unwrap_or_else(|| {
                let face = self.face_material(own, materials);
                faces.push((own, face));
                face
            });
            for corners in &polyhedron.triangles {
                let corners = corners.map(at);
                if !Triangles::are_on_a_line(corners) {
                    triangles.push(corners, face, color);
                }
            }
            for ends in &polyhedron.edges {
                let [from, to] = *ends;
                if drawn.insert([from.min(to), from.max(to)]) {
                    sticks.push(ends.map(at), radius, own, [color * EDGE_COLOR; 2]);
                }
            }
        }
        triangles
    }

    /// Returns the row of the material of faces whose centers have another one.
    fn face_material(&self, own: u32, materials: &mut Vec<NamedMaterial>) -> u32 {
        let Some(named) = materials.get(own as usize) else { return own };
        let opacity = named.material.opacity().min(self.added.face_opacity.unwrap_or(OPACITY));
        let material = named.material.with_opacity(opacity);
        if material == named.material {
            return own;
        }
        let name = format!("{} of polyhedra", named.name);
        materials.push(NamedMaterial { name, material });
        materials.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests;
