//! Reads GSD of HOOMD-blue, schema `hoomd` (gsd.readthedocs.io): lengths are in reduced units, and
//! every particle has a diameter.
//!
//! The crate `hoomd-gsd` isn't used: it requires a newer compiler.

mod file;

pub(super) use file::MAGIC;

use self::file::File;
use crate::{
    Bonds, Cell, FileError, Format, Kind, NumberColumn, ParticleFrame, Radii, ReadOptions, Role,
    aliases,
    binary::BinaryFile,
    bonds::{End, Listed},
    frame_reader::FrameReader,
    options::component_names,
    place::Place,
    schema::unknown_column,
    shapes::SEMI_AXES,
    source::Source,
    undrawn::Undrawn,
};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;

/// Chunks of particles that are not columns of numbers, or are in [`COLUMNS`] under other names.
const KNOWN: [&str; 8] =
    ["N", "types", "typeid", "type_shapes", "position", "velocity", "diameter", "mass"];

/// Chunk of the diameters, which HOOMD-blue leaves out if all are 1.
const DIAMETER: &str = "particles/diameter";

/// Names of columns that always exist.
const COLUMNS: [&str; 10] = ["x", "y", "z", "diameter", "type", "mass", "charge", "vx", "vy", "vz"];

/// Maximum number of values per particle in a chunk that is kept as columns.
const WIDEST: u64 = 64;

/// A column of a chunk.
struct ChunkColumn {
    name: String,
    chunk: String,
    /// Index in a row, and number of values per row.
    at: usize,
    width: u64,
}

/// Reader of the frames of a GSD file.
pub(super) struct Gsd {
    path: Arc<Path>,
    file: File,
    options: ReadOptions,
    next: u64,
}

impl Gsd {
    pub(super) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let path = source.path.clone();
        let content = BinaryFile::open(source)?;
        let is_size = |role: Role| matches!(role, Role::Radius | Role::Diameter);
        let is_other = |(role, name): &&(Role, String)| !is_size(*role) && name != role.name();
        if let Some((role, name)) = options.columns.roles.iter().find(is_other) {
            let role = role.name();
            let error =
                content.fault(format!("`{role}={name}` has no effect: GSD has its own {role}"));
            return Err(error.with_help("assign radius or diameter, as in --columns radius=NAME"));
        }
        let file = File::open(content)?;
        Ok(Self { path, file, options: options.clone(), next: 0 })
    }

    /// Returns columns of a chunk with one row of `width` numbers per particle, selected by index; `None`
    /// if neither the frame nor the first one has the chunk.
    fn particles(
        &mut self,
        name: &str,
        count: u64,
        width: u64,
        places: &[usize],
    ) -> Result<Option<Vec<Vec<f64>>>, FileError> {
        let own = self.file.size(self.next, name).map(|size| (self.next, size));
        // Constant chunks are only in the first frame.
        let first = || self.file.size(0, name).filter(|size| size.0 == count).map(|size| (0, size));
        let Some((frame, size)) = own.or_else(first) else { return Ok(None) };
        if size != (count, width) {
            let message = format!(
                "{name} of frame {} is {} x {}, but there are {count} particles",
                self.next, size.0, size.1
            );
            return Err(self.fault(message));
        }
        self.file.columns(frame, name, places)
    }

    /// Reads a chunk with one number per particle.
    fn values(&mut self, name: &str, count: u64) -> Result<Option<Vec<f64>>, FileError> {
        Ok(self.particles(name, count, 1, &[0])?.and_then(|mut columns| columns.pop()))
    }

    /// Returns numbers of the whole frame, which may be only in the first frame.
    fn whole(&mut self, name: &str) -> Result<Option<Vec<f64>>, FileError> {
        Ok(match self.file.numbers(self.next, name)? {
            None => self.file.numbers(0, name)?,
            own => own,
        })
    }

    /// Returns the first number of a chunk of the whole frame.
    fn number(&mut self, name: &str) -> Result<Option<f64>, FileError> {
        Ok(self.whole(name)?.and_then(|values| values.first().copied()))
    }

    /// Returns texts of the whole frame, which may be only in the first frame.
    fn texts(&mut self, name: &str) -> Result<Option<Vec<String>>, FileError> {
        Ok(match self.file.texts(self.next, name)? {
            None => self.file.texts(0, name)?,
            own => own,
        })
    }

    /// Returns a column by its name: one of [`COLUMNS`], or a chunk with one number per particle.
    fn column(&mut self, name: &str, count: u64) -> Result<Vec<f64>, FileError> {
        let usual = match name {
            "diameter" | "mass" => Some(1.0),
            "charge" => Some(0.0),
            _ => None,
        };
        if let Some(axis) = ["vx", "vy", "vz"].iter().position(|own| *own == name) {
            let velocity = self.particles("particles/velocity", count, 3, &[axis])?;
            let velocity = velocity.and_then(|mut columns| columns.pop());
            return Ok(velocity.unwrap_or_else(|| vec![0.0; count as usize]));
        }
        let known = self.file.names().any(|own| own == name);
        let chunk = if known { name.to_owned() } else { format!("particles/{name}") };
        match (self.values(&chunk, count)?, usual) {
            (Some(values), _) => Ok(values),
            (None, Some(value)) => Ok(vec![value; count as usize]),
            (None, None) => {
                let more = self.more_columns(count).into_iter().map(|part| part.name);
                let names: Vec<String> =
                    COLUMNS.map(str::to_owned).into_iter().chain(more).collect();
                Err(self.fault(unknown_column(name, names.iter().map(String::as_str))))
            }
        }
    }

    /// Returns the columns of other chunks with one row per particle, by name.
    fn more_columns(&self, count: u64) -> Vec<ChunkColumn> {
        let mut parts = Vec::new();
        for chunk in self.file.names() {
            let known = |name: &str| KNOWN.contains(&name) || COLUMNS.contains(&name);
            let name = match chunk.strip_prefix("particles/") {
                Some(name) if known(name) => continue,
                Some(name) => name,
                None if chunk.starts_with("log/particles/") => chunk,
                None => continue,
            };
            let shape = self.file.shape(self.next, chunk).or_else(|| self.file.shape(0, chunk));
            let Some((_, width)) = shape.filter(|&(rows, width)| rows == count && width <= WIDEST)
            else {
                continue;
            };
            for (at, name) in component_names(name, width as usize).into_iter().enumerate() {
                parts.push(ChunkColumn { name, chunk: chunk.to_owned(), at, width });
            }
        }
        parts.sort_by(|a, b| (&a.chunk, a.at).cmp(&(&b.chunk, b.at)));
        parts
    }

    /// Returns the columns that the options request.
    fn kept(&mut self, count: u64, parts: &[ChunkColumn]) -> Result<Vec<NumberColumn>, FileError> {
        let part = |name: &String| parts.iter().find(|part| part.name == *name);
        let of_role = |name: &String| ["x", "y", "z", "type"].contains(&name.as_str());
        let is_there = |name: &&String| {
            let chunk = format!("particles/{name}");
            let own = |own: &str| own == name.as_str() || own == chunk;
            let plain = COLUMNS.contains(&name.as_str()) || self.file.names().any(own);
            !of_role(name) && (plain || part(name).is_some())
        };
        let columns = &self.options.columns;
        // Positions and types keep their role.
        let aliased = columns.kept.iter().map(|name| {
            let others = || aliases::of(name).map(str::to_owned);
            let other = || others().find(|other| is_there(&other)).unwrap_or_else(|| name.clone());
            if is_there(&name) || of_role(name) { name.clone() } else { other() }
        });
        let kept = aliased.filter(|name| !of_role(name));
        let names: Vec<String> =
            kept.chain(columns.wanted.iter().filter(is_there).cloned()).collect();
        let all = COLUMNS.map(str::to_owned).into_iter();
        let mut rest: Vec<String> = all.chain(parts.iter().map(|part| part.name.clone())).collect();
        rest.retain(|name| !of_role(name) && !names.contains(name));
        if columns.rest.is_none_or(|most| rest.len() as u64 * count > most as u64) {
            rest.clear();
        }
        let mut column = |name: String| {
            let values = match part(&name).filter(|part| part.width > 1) {
                Some(ChunkColumn { chunk, at, width, .. }) => {
                    let columns = self.particles(chunk, count, *width, &[*at])?;
                    columns.and_then(|mut columns| columns.pop()).unwrap_or_default()
                }
                None => self.column(&name, count)?,
            };
            Ok(NumberColumn { name, values })
        };
        let mut kept = names.into_iter().map(&mut column).collect::<Result<Vec<_>, FileError>>()?;
        // Not requested by name, so a damaged one is no error.
        kept.extend(rest.into_iter().filter_map(|name| column(name).ok()));
        Ok(kept)
    }

    fn kinds(&mut self, frame: &mut ParticleFrame) -> Result<(), FileError> {
        let types = self.texts("particles/types")?.unwrap_or_else(|| vec!["A".to_owned()]);
        let count = frame.len() as u64;
        let codes = self.values("particles/typeid", count)?;
        let unknown = types.len() as f64;
        // Type names are not elements: `C` is the third type.
        let kind = |name| Kind { name, ..Kind::default() };
        frame.kinds.table = types.into_iter().map(kind).collect();
        for row in 0..frame.len() {
            let code = codes.as_ref().map_or(0.0, |codes| codes[row]);
            if code >= unknown {
                let message = format!("particle {row} is of type {code}, but there are {unknown}");
                return Err(self.fault(message));
            }
            frame.kinds.codes.push(code as u32);
        }
        Ok(())
    }

    /// Returns whether particles have sizes of their own: the file has diameters, or the options say which column has
    /// radii.
    fn has_sizes(&self) -> bool {
        let is_size = |(role, _): &(Role, String)| matches!(role, Role::Radius | Role::Diameter);
        matches!(self.options.radii, Radii::Column(_))
            || self.options.columns.roles.iter().any(is_size)
            || [self.next, 0].iter().any(|&frame| self.file.size(frame, DIAMETER).is_some())
    }

    fn radius(&mut self, count: u64) -> Result<Vec<f64>, FileError> {
        let mut role = self.options.columns.roles.iter();
        let role = role.find(|(role, _)| matches!(role, Role::Radius | Role::Diameter)).cloned();
        let (name, factor) = match (&self.options.radii, role) {
            (Radii::Column(name), _) => (name.clone(), 1.0),
            (_, Some((Role::Radius, name))) => (name, 1.0),
            (_, Some((_, name))) => (name, 0.5),
            _ => ("diameter".to_owned(), 0.5),
        };
        let mut radius = self.column(&name, count)?;
        for radius in &mut radius {
            *radius *= factor;
        }
        Ok(radius)
    }

    fn fault(&self, message: impl Into<String>) -> FileError {
        FileError::whole_file(&self.path, message)
    }

    /// Reads the bonds: rows of both particles, and types.
    fn bonds(&mut self, particles: usize) -> Result<Bonds, FileError> {
        let types = self.texts("bonds/types")?.unwrap_or_default();
        let groups = self.whole("bonds/group")?.unwrap_or_default();
        let kinds = self.whole("bonds/typeid")?.unwrap_or_default();
        let mut bonds = Listed::default();
        for (bond, ends) in groups.chunks(2).enumerate() {
            let row = |end: usize| {
                let row =
                    ends.get(end).copied().filter(|row| (0.0..particles as f64).contains(row));
                End::from(row.map(|row| row as u32))
            };
            let Some([first, second]) = bonds.ends([row(0), row(1)]) else { continue };
            let kind = kinds.get(bond).copied().unwrap_or(0.0) as usize;
            let name = types.get(kind).map_or("", String::as_str);
            bonds.push_named(&self.path, (first, second, [0; 3]), name.as_bytes())?;
        }
        Ok(bonds.finish())
    }

    /// Reads the bonds and the shapes, and adds warnings about those that are not drawn.
    fn bonds_and_shapes(&mut self, frame: &mut ParticleFrame) -> Result<(), FileError> {
        if self.options.reads_bonds() {
            frame.bonds = Some(self.bonds(frame.len())?);
        }
        let shapes = self.texts("particles/type_shapes")?.unwrap_or_default();
        let shapes: Vec<TypeShape> = shapes.iter().map(|shape| TypeShape::of(shape)).collect();
        let codes = &frame.kinds.codes;
        let shape = |row| shapes.get(codes.code(row) as usize).copied().unwrap_or_default();
        let rows = 0..codes.len();
        let others = rows.clone().filter(|&row| shape(row) == TypeShape::Other).count();
        if !self.has_sizes() {
            for (row, radius) in frame.radius.iter_mut().enumerate() {
                if let TypeShape::Sphere(own) = shape(row) {
                    *radius = own;
                }
            }
        }
        let is_ellipsoid = |shape: &TypeShape| matches!(shape, TypeShape::Ellipsoid(_));
        let mut semi_axes = Vec::new();
        if shapes.iter().any(is_ellipsoid) {
            // As columns, they become shapes like those of other formats.
            for (axis, name) in SEMI_AXES.into_iter().enumerate() {
                let value = |row| match shape(row) {
                    TypeShape::Ellipsoid(axes) => axes[axis],
                    _ => 0.0,
                };
                let values = rows.clone().map(value).collect();
                semi_axes.push(NumberColumn { name: name.to_owned(), values });
            }
        }
        frame.add_undrawn(Undrawn::Shapes, others as u64);
        if !semi_axes.is_empty() {
            frame.numbers.extend(semi_axes);
            return Ok(());
        }
        let turned = |frame| self.file.size(frame, "particles/orientation").is_some();
        if turned(self.next) || turned(0) {
            frame.add_undrawn(Undrawn::Orientations, frame.len() as u64);
        }
        Ok(())
    }

    fn frame(&mut self) -> Result<ParticleFrame, FileError> {
        let mut frame = ParticleFrame { format: Format::Gsd, ..ParticleFrame::default() };
        let count = self.number("particles/N")?.unwrap_or(0.0) as u64;
        if count == 0 {
            return Ok(frame);
        }
        let position = self.particles("particles/position", count, 3, &[0, 1, 2])?;
        let Some(Ok([x, y, z])) = position.map(<[Vec<f64>; 3]>::try_from) else {
            return Err(self.fault(format!("frame {} has no positions", self.next)));
        };
        (frame.x, frame.y, frame.z) = (x, y, z);
        self.kinds(&mut frame)?;
        frame.radius = self.radius(count)?;
        let parts = self.more_columns(count);
        frame.numbers = self.kept(count, &parts)?;
        frame.step = Some(self.number("configuration/step")?.unwrap_or(0.0) as i64);
        frame.cell = self.whole("configuration/box")?.and_then(|edges| cell(&edges));
        self.bonds_and_shapes(&mut frame)?;
        frame.columns = COLUMNS.map(str::to_owned).into();
        frame.columns.extend(parts.into_iter().map(|part| part.name));
        Ok(frame)
    }
}

/// The shape of a type of particles.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum TypeShape {
    /// Nothing that the file tells: a sphere with the diameter of the particle.
    #[default]
    Unknown,
    /// A sphere with this radius.
    Sphere(f64),
    /// An ellipsoid with these semi-axes.
    Ellipsoid(DVec3),
    /// A polyhedron, a rod or the like, or an ellipsoid without its semi-axes.
    Other,
}

impl TypeShape {
    /// Reads the shape of a type, a flat object in JSON
    /// (<https://gsd.readthedocs.io/en/stable/shapes.html>).
    fn of(text: &str) -> Self {
        let value = |key: &str| {
            let (_, rest) = text.split_once(&format!("\"{key}\""))?;
            let rest = rest.trim_start().strip_prefix(':')?.trim_start();
            Some(rest[..rest.find([',', '}'])?].trim_end())
        };
        let axis = |key: &str| value(key)?.parse().ok().filter(|axis: &f64| *axis > 0.0);
        match value("type") {
            None => Self::Unknown,
            Some("\"Sphere\"") => {
                let radius = axis("diameter").map(|diameter| diameter * 0.5);
                let rounding = axis("rounding_radius");
                let radius =
                    radius.into_iter().chain(rounding).reduce(|radius, more| radius + more);
                radius.map_or(Self::Unknown, Self::Sphere)
            }
            Some("\"Ellipsoid\"") => match (axis("a"), axis("b"), axis("c")) {
                (Some(a), Some(b), Some(c)) => Self::Ellipsoid(DVec3::new(a, b, c)),
                _ => Self::Other,
            },
            Some(_) => Self::Other,
        }
    }
}

/// Returns the cell of a HOOMD-blue box, centered at the origin: lengths along the axes, and tilt
/// factors.
pub(super) fn cell(edges: &[f64]) -> Option<Cell> {
    let &[x, y, z, xy, xz, yz] = edges else { return None };
    let a = DVec3::new(x, 0.0, 0.0);
    let b = DVec3::new(xy * y, y, 0.0);
    let c = DVec3::new(xz * z, yz * z, z);
    Cell { origin: (a + b + c) * -0.5, vectors: [a, b, c], periodic: [true; 3] }.declared()
}

impl FrameReader for Gsd {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if self.next >= self.file.frames() {
            return Ok(None);
        }
        let frame = self.frame()?;
        self.next += 1;
        Ok(Some(frame))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let there = self.next < self.file.frames();
        self.next += 1;
        Ok(there)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.next < self.file.frames())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::new(0, self.next))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.next = place.number;
        Ok(true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_of_types_have_their_sizes() {
        for (text, expected) in [
            ("", TypeShape::Unknown),
            ("{\"type\": \"Sphere\"}", TypeShape::Unknown),
            ("{\"type\": \"Sphere\", \"diameter\": 3}", TypeShape::Sphere(1.5)),
            (
                "{\"diameter\":2.0,\"rounding_radius\":0.25,\"type\":\"Sphere\"}",
                TypeShape::Sphere(1.25),
            ),
            ("{\"type\":\"Sphere\",\"rounding_radius\":0.25}", TypeShape::Sphere(0.25)),
            (
                "{\"type\":\"Ellipsoid\",\"a\":1,\"b\":2,\"c\":3}",
                TypeShape::Ellipsoid(DVec3::new(1.0, 2.0, 3.0)),
            ),
            ("{\"type\":\"Polygon\",\"rounding_radius\":1}", TypeShape::Other),
        ] {
            assert_eq!(TypeShape::of(text), expected, "{text}");
        }
    }

    #[test]
    fn boxes_lie_around_the_origin() {
        let cell = cell(&[2.0, 4.0, 8.0, 0.5, 0.25, -0.5]).expect("a box");
        assert_eq!(cell.vectors[1], DVec3::new(2.0, 4.0, 0.0));
        assert_eq!(cell.vectors[2], DVec3::new(2.0, -4.0, 8.0));
        assert_eq!(cell.cartesian([0.5; 3]), DVec3::ZERO);
        assert_eq!(super::cell(&[1.0; 5]), None);
        let flat = super::cell(&[6.0, 5.0, 0.0, 0.3, 0.0, 0.0]).expect("a box of two dimensions");
        assert_eq!(flat.vectors, [DVec3::X * 6.0, DVec3::new(1.5, 5.0, 0.0), DVec3::Z]);
        assert_eq!((flat.periodic, flat.cartesian([0.5; 3])), ([true, true, false], DVec3::ZERO));
    }
}
