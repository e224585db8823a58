//! Coordination polyhedra: the convex hulls of the neighbors of particles, as triangles with edges.

mod hull;

use self::hull::{Hull, MOST};
use super::contents::Polyhedron;
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
    hull: Hull,
    /// Opacity of its faces.
    opacity: f64,
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
}

/// Finds the neighbors of all centers, over the periodic cell, in the order of the centers: those of each particle by the rules
/// of its row in `all`. A warning counts centers without a polyhedron.
///
/// # Errors
/// A rule names no type of the file unless `allow_empty`, there are no bonds although a rule has no distance, or a center has
/// too many neighbors.
pub(super) fn find(
    all: &[&Polyhedra],
    path: &Path,
    particles: &mut Particles,
    allow_empty: bool,
) -> Result<Vec<Coordination>, FileError> {
    if all.iter().all(|own| own.is_empty()) || particles.spheres.is_empty() {
        return Ok(Vec::new());
    }
    let fault = |message: String| FileError::whole_file(path, clipped(message));
    let count = particles.spheres.len();
    let mut neighbors: Vec<Vec<(u32, [i32; 3])>> = vec![Vec::new(); count];
    let mut is_center = vec![false; count];
    let own_of = |of_rows: &[u32], row: u32| of_rows.get(row as usize).copied().unwrap_or(0);
    let rules = (0..).zip(all).flat_map(|(of, own)| own.rules.iter().map(move |rule| (of, rule)));
    for (of, rule) in rules {
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
        let is_own = |row: u32| has(&centers, row) && own_of(&particles.polyhedra, row) == of;
        let own_rows: Vec<u32> = (0..count as u32).filter(|&row| is_own(row)).collect();
        for &row in &own_rows {
            is_center[row as usize] = true;
        }
        if let Some(length) = rule.length {
            let corners = rows(&corners);
            let list = CellList::new(particles.points(), &corners, length).map_err(fault)?;
            let found = own_rows.into_par_iter().map(|row| {
                let mut near = Vec::new();
                list.any(particles.points().position(row as usize), length, |neighbor| {
                    let is_near = neighbor.distance2 > 0.0 && neighbor.distance2 < length * length;
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
                if is_own(center) && has(&corners, corner) {
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
            Some(hull) => {
                let own = all.get(own_of(&particles.polyhedra, center) as usize);
                let opacity = own.and_then(|own| own.opacity).unwrap_or(OPACITY);
                found.push(Coordination { center, neighbors, hull, opacity });
            }
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

impl Coordination {
    /// Returns the neighbors of the image of the center with this shift.
    pub(super) fn corners(&self, shift: [i32; 3]) -> impl Iterator<Item = (u32, [i32; 3])> {
        let moved = move |own: [i32; 3]| [0, 1, 2].map(|edge| own[edge] + shift[edge]);
        self.neighbors.iter().map(move |&(row, own)| (row, moved(own)))
    }
}

impl Polyhedron {
    /// Creates the polyhedron of a center, by the rows of its corners.
    pub(super) fn new(center: u32, corners: &[u32], own: &Coordination) -> Self {
        let Coordination { hull, opacity, .. } = own;
        let row = |corner: u8| corners[usize::from(corner)];
        Self {
            center,
            triangles: hull.triangles.iter().map(|corners| corners.map(row)).collect(),
            edges: hull.edges.iter().map(|ends| ends.map(row)).collect(),
            opacity: *opacity,
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
        // Rows of the materials of faces, by those of their centers and the opacity.
        let mut faces: Vec<((u32, f64), u32)> = Vec::new();
        for polyhedron in &self.added.polyhedra {
            let center = polyhedron.center as usize;
            let (own, color) =
                (self.solid_material(center, materials, rows), self.spheres.color_of(center));
            let key = (own, polyhedron.opacity);
            let known = faces.iter().find(|(of, _)| *of == key).map(|(_, face)| *face);
            let face = known.unwrap_or_else(|| {
                let face = face_material(own, polyhedron.opacity, materials);
                faces.push((key, face));
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
}

/// Returns the row of the material of faces of an opacity whose centers have another one.
fn face_material(own: u32, opacity: f64, materials: &mut Vec<NamedMaterial>) -> u32 {
    let Some(named) = materials.get(own as usize) else { return own };
    let material = named.material.with_opacity(named.material.opacity().min(opacity));
    if material == named.material {
        return own;
    }
    let mut name = format!("{} of polyhedra", named.name);
    if materials.iter().any(|own| own.name == name) {
        name = format!("{name}, opacity {opacity}");
    }
    materials.push(NamedMaterial { name, material });
    materials.len() as u32 - 1
}

#[cfg(test)]
mod tests;
