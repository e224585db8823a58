//! Conventions by which HDF5 files have particles: H5MD (h5md.nongnu.org), snapshots of Gadget, and the
//! variables of Amber, which NetCDF 4 and mdtraj store.

use super::dataset::{Dataset, Datatype, Values};
use super::file::File;
use crate::{Cell, FileError, LengthUnit, netcdf, options::component_names};
use glam::DVec3;
use std::sync::Arc;

/// Maximum number of values per particle in a dataset that is kept as columns.
const WIDEST: u64 = 64;

/// Names of the columns of vectors.
const VECTORS: [(&str, [&str; 3]); 8] = [
    ("position", ["x", "y", "z"]),
    ("Coordinates", ["x", "y", "z"]),
    ("coordinates", ["x", "y", "z"]),
    ("velocity", ["vx", "vy", "vz"]),
    ("Velocities", ["vx", "vy", "vz"]),
    ("velocities", ["vx", "vy", "vz"]),
    ("force", ["fx", "fy", "fz"]),
    ("forces", ["fx", "fy", "fz"]),
];

/// A file's particles and their frames.
#[derive(Default)]
pub(super) struct Trajectory {
    pub(super) parts: Vec<Part>,
    /// Name of the column of the parts' names; none if there is one part alone.
    pub(super) label: Option<&'static str>,
    pub(super) frames: u64,
    pub(super) steps: Axis,
    pub(super) times: Axis,
    pub(super) cell: CellSource,
    pub(super) unit: LengthUnit,
    pub(super) warnings: Vec<String>,
}

/// Particles with the same columns.
pub(super) struct Part {
    pub(super) name: String,
    pub(super) count: u64,
    /// Columns, of which the first has the positions.
    pub(super) columns: Vec<Column>,
}

/// Columns of a dataset.
pub(super) struct Column {
    pub(super) names: Vec<String>,
    pub(super) element: Element,
}

/// A dataset whose rows may belong to steps.
pub(super) struct Element {
    pub(super) dataset: Dataset,
    /// The steps of its rows; none if it is the same in all frames.
    pub(super) steps: Option<Axis>,
    /// Factor on values.
    pub(super) scale: f64,
}

/// Steps or times of rows.
#[derive(Clone, Debug, Default)]
pub(super) enum Axis {
    #[default]
    Unknown,
    Even {
        first: f64,
        by: f64,
    },
    Listed(Arc<Vec<f64>>),
}

/// Source of the cell.
#[derive(Default)]
pub(super) enum CellSource {
    #[default]
    None,
    Fixed(Cell),
    Edges {
        edges: Element,
        offset: Option<Element>,
        periodic: [bool; 3],
    },
    /// Lengths, and angles in degrees.
    Lengths(Element, Option<Element>),
}

impl Axis {
    pub(super) fn at(&self, row: u64) -> Option<f64> {
        match self {
            Self::Unknown => None,
            Self::Even { first, by } => Some(first + row as f64 * by),
            Self::Listed(values) => values.get(usize::try_from(row).ok()?).copied(),
        }
    }
}

impl Element {
    /// Returns the row of a frame, and whether it is of the frame's own step: the last row up to this step if
    /// there are none of the same step. `None` if the element is the same in all frames.
    pub(super) fn row(&self, frame: u64, steps: &Axis) -> Option<(u64, bool)> {
        let own = self.steps.as_ref()?;
        let rows = self.dataset.shape.first().copied().unwrap_or(0);
        let Some(step) = steps.at(frame) else { return Some((frame, true)) };
        if own.at(frame).is_none_or(|own| own == step) && frame < rows {
            return Some((frame, true));
        }
        let (mut low, mut high) = (0, rows);
        while low < high {
            let middle = low + (high - low) / 2;
            if own.at(middle).is_some_and(|own| own <= step) {
                low = middle + 1;
            } else {
                high = middle;
            }
        }
        let row = low.saturating_sub(1);
        Some((row, own.at(row) == Some(step)))
    }

    /// Returns the numbers of a frame.
    pub(super) fn numbers(
        &mut self,
        file: &mut File,
        frame: u64,
        steps: &Axis,
    ) -> Result<Vec<f64>, FileError> {
        let row = self.row(frame, steps).map(|(row, _)| row);
        let Datatype::Number { scalar, order, .. } = self.dataset.datatype else {
            return Ok(Vec::new());
        };
        let bytes = self.dataset.rows(file, row)?;
        Ok(bytes
            .chunks_exact(scalar.size())
            .map(|bytes| self.scale * scalar.read(bytes, order))
            .collect())
    }

    /// Returns the lengths of a row.
    fn lengths(&self) -> &[u64] {
        self.dataset.shape.get(usize::from(self.steps.is_some())..).unwrap_or_default()
    }

    /// Returns the columns of values for `count` particles; none if it has others.
    fn columns(self, name: &str, count: u64) -> Option<Column> {
        let width = match *self.lengths() {
            [rows] if rows == count => 1,
            [rows, width] if rows == count && (1..=WIDEST).contains(&width) => width as usize,
            _ => return None,
        };
        if !matches!(self.dataset.datatype, Datatype::Number { .. }) {
            return None;
        }
        let known = VECTORS.iter().find(|(own, _)| *own == name && width <= 3);
        let names = match known {
            Some((_, axes)) => axes[..width].iter().map(|axis| (*axis).to_owned()).collect(),
            None => component_names(name, width),
        };
        Some(Column { names, element: self })
    }
}

/// Returns the address of the object that a link of this name leads to.
fn linked(links: &[(String, u64)], name: &str) -> Option<u64> {
    links.iter().find(|(own, _)| own == name).map(|&(_, at)| at)
}

/// Returns the particles of a file; `None` if it follows none of the conventions.
pub(super) fn find(file: &mut File) -> Result<Option<Trajectory>, FileError> {
    let links = file.links(file.root)?;
    let find = |name: &str| linked(&links, name);
    if let Some(particles) = find("particles") {
        return h5md(file, particles);
    }
    let parts: Vec<_> = links.iter().filter(|(name, _)| name.starts_with("PartType")).collect();
    if !parts.is_empty() {
        return gadget(file, &parts, find("Header"));
    }
    match find("coordinates") {
        Some(_) => amber(file, &links),
        None => Ok(None),
    }
}

/// Returns an element of H5MD: a dataset, or a group of a dataset with its steps and times.
fn element(file: &mut File, at: u64) -> Result<Option<(Element, Axis)>, FileError> {
    if let Some(dataset) = file.dataset(at)? {
        return Ok(Some((Element { dataset, steps: None, scale: 1.0 }, Axis::Unknown)));
    }
    let links = file.links(at)?;
    let find = |name: &str| linked(&links, name);
    let Some(value) = find("value") else { return Ok(None) };
    let Some(dataset) = file.dataset(value)? else { return Ok(None) };
    let steps = axis(file, find("step"))?;
    let times = axis(file, find("time"))?;
    Ok(Some((Element { dataset, steps: Some(steps), scale: 1.0 }, times)))
}

/// Returns steps or times: a value for each row, or one for the distance of rows, which begin at an offset.
fn axis(file: &mut File, at: Option<u64>) -> Result<Axis, FileError> {
    let Some(at) = at else { return Ok(Axis::Unknown) };
    let Some(mut dataset) = file.dataset(at)? else { return Ok(Axis::Unknown) };
    let first = dataset.attribute("offset").and_then(Values::number).unwrap_or(0.0);
    let is_even = dataset.shape.is_empty();
    Ok(match dataset.all(file)? {
        Some(Values::Numbers(values)) if is_even => {
            Axis::Even { first, by: values.first().copied().unwrap_or(0.0) }
        }
        Some(Values::Numbers(values)) => Axis::Listed(Arc::new(values)),
        _ => Axis::Unknown,
    })
}

/// Finds the groups of particles of H5MD.
fn h5md(file: &mut File, particles: u64) -> Result<Option<Trajectory>, FileError> {
    let mut parts: Vec<Part> = Vec::new();
    let mut found: Option<(u64, Axis, Axis, LengthUnit)> = None;
    let mut cell = CellSource::None;
    for (name, group) in file.links(particles)? {
        let links = file.links(group)?;
        let find = |name: &str| linked(&links, name);
        let Some(position) = find("position") else { continue };
        let Some((position, times)) = element(file, position)? else { continue };
        let [count, 2 | 3] = *position.lengths() else {
            let message = format!("positions of group `{name}` are no table of x, y and z");
            return Err(file.content.fault(message));
        };
        let frames = match position.steps {
            Some(_) => position.dataset.shape[0],
            None => 1,
        };
        let unit = position.dataset.attribute("unit").and_then(Values::text);
        let unit = unit.map_or(LengthUnit::Unknown, netcdf::unit);
        let steps = position.steps.clone().unwrap_or(Axis::Unknown);
        match &found {
            None => found = Some((frames, steps, times, unit)),
            Some((first, ..)) if *first != frames => {
                let message = format!(
                    "its groups of particles `{}` and `{name}` have {first} and {frames} frames",
                    parts.first().map_or("", |part| &part.name)
                );
                let help = "copy one of them to another file: h5copy -p -i FILE -o NEW -s \
                            /particles/NAME -d /particles/NAME";
                return Err(file.content.fault(message).with_help(help));
            }
            Some(_) => (),
        }
        let Some(position) = position.columns("position", count) else {
            return Err(file.unsupported("positions that are no numbers"));
        };
        let mut columns = vec![position];
        for (name, at) in &links {
            if name == "position" || name == "box" {
                continue;
            }
            let Some((element, _)) = element(file, *at)? else { continue };
            columns.extend(element.columns(name, count));
        }
        if let (CellSource::None, Some(at)) = (&cell, find("box")) {
            cell = h5md_box(file, at)?;
        }
        parts.push(Part { name, count, columns });
    }
    Ok(found.map(|(frames, steps, times, unit)| Trajectory {
        label: (parts.len() > 1).then_some("group"),
        parts,
        frames,
        steps,
        times,
        cell,
        unit,
        ..Trajectory::default()
    }))
}

fn h5md_box(file: &mut File, at: u64) -> Result<CellSource, FileError> {
    let periodic = match file.attributes_of(at)?.into_iter().find(|(name, _)| name == "boundary") {
        Some((_, Values::Texts(texts))) => {
            [0, 1, 2].map(|axis| texts.get(axis).is_some_and(|text| text == "periodic"))
        }
        _ => [true; 3],
    };
    let links = file.links(at)?;
    let mut find = |name: &str| match linked(&links, name) {
        Some(at) => Ok(element(file, at)?.map(|(element, _)| element)),
        None => Ok::<_, FileError>(None),
    };
    let (edges, offset) = (find("edges")?, find("offset")?);
    let fits = |edges: &Element| matches!(edges.lengths(), [3] | [3, 3]);
    let edges = edges.filter(fits);
    Ok(edges.map_or(CellSource::None, |edges| CellSource::Edges { edges, offset, periodic }))
}

/// Finds the particles of a snapshot of Gadget, which other codes write too.
fn gadget(
    file: &mut File,
    parts: &[&(String, u64)],
    header: Option<u64>,
) -> Result<Option<Trajectory>, FileError> {
    let attributes = match header {
        Some(header) => file.attributes_of(header)?,
        None => Vec::new(),
    };
    let header = |name: &str| match attributes.iter().find(|(own, _)| own == name) {
        Some((_, Values::Numbers(numbers))) => Some(&numbers[..]),
        _ => None,
    };
    let edges = match header("BoxSize") {
        Some(&[edge]) => Some([edge; 3]),
        Some(&[a, b, c]) => Some([a, b, c]),
        _ => None,
    };
    let cell = edges.and_then(|edges| Cell::of_lengths(edges, [90.0; 3]));
    let mut found = Vec::new();
    for (name, group) in parts {
        let links = file.links(*group)?;
        let Some(at) = linked(&links, "Coordinates") else { continue };
        let Some(dataset) = file.dataset(at)? else { continue };
        let &[count, 3] = &dataset.shape[..] else { continue };
        let element = Element { dataset, steps: None, scale: 1.0 };
        let Some(positions) = element.columns("Coordinates", count) else { continue };
        let mut columns = vec![positions];
        for (name, at) in links.iter().filter(|(name, _)| name != "Coordinates") {
            let Some(dataset) = file.dataset(*at)? else { continue };
            columns.extend(Element { dataset, steps: None, scale: 1.0 }.columns(name, count));
        }
        found.push(Part { name: name.clone(), count, columns });
    }
    if found.is_empty() {
        return Ok(None);
    }
    let mut warnings = Vec::new();
    if let Some(&[files]) = header("NumFilesPerSnapshot")
        && files > 1.0
    {
        warnings.push(format!("is one of {files} files of a snapshot; the others are not drawn"));
    }
    let time = header("Time").and_then(|time| time.first());
    Ok(Some(Trajectory {
        parts: found,
        label: Some("type"),
        frames: 1,
        times: time.map_or(Axis::Unknown, |time| Axis::Listed(Arc::new(vec![*time]))),
        cell: cell.map_or(CellSource::None, CellSource::Fixed),
        warnings,
        ..Trajectory::default()
    }))
}

/// Finds the variables of Amber's conventions: frames of coordinates, velocities and cells.
fn amber(file: &mut File, links: &[(String, u64)]) -> Result<Option<Trajectory>, FileError> {
    let mut read = |name: &str| linked(links, name).map_or(Ok(None), |at| file.dataset(at));
    let timed = |dataset: Dataset| {
        let scale = dataset.attribute("scale_factor").and_then(Values::number).unwrap_or(1.0);
        Element { dataset, steps: Some(Axis::Unknown), scale }
    };
    let Some(coordinates) = read("coordinates")? else { return Ok(None) };
    let &[frames, count, 3] = &coordinates.shape[..] else { return Ok(None) };
    let unit = coordinates.attribute("units").and_then(Values::text);
    let unit = unit.map_or(LengthUnit::Angstrom, netcdf::unit);
    let lengths = read("cell_lengths")?.map(timed);
    let angles = read("cell_angles")?.map(timed);
    let fits = |element: &Element| element.lengths() == [3];
    let cell = match (lengths.filter(fits), angles.filter(fits)) {
        (Some(lengths), angles) => CellSource::Lengths(lengths, angles),
        (None, _) => CellSource::None,
    };
    let mut columns = Vec::from_iter(timed(coordinates).columns("coordinates", count));
    for name in ["velocities", "forces"] {
        columns.extend(read(name)?.map(timed).and_then(|element| element.columns(name, count)));
    }
    let times = match read("time")? {
        Some(mut time) if time.shape.len() == 1 => match time.all(file)? {
            Some(Values::Numbers(times)) => Axis::Listed(Arc::new(times)),
            _ => Axis::Unknown,
        },
        _ => Axis::Unknown,
    };
    if columns.first().is_none_or(|column| column.names != ["x", "y", "z"]) {
        return Ok(None);
    }
    Ok(Some(Trajectory {
        parts: vec![Part { name: String::new(), count, columns }],
        frames,
        times,
        cell,
        unit,
        ..Trajectory::default()
    }))
}

impl CellSource {
    /// Returns the cell of a frame.
    pub(super) fn read(
        &mut self,
        file: &mut File,
        frame: u64,
        steps: &Axis,
    ) -> Result<Option<Cell>, FileError> {
        Ok(match self {
            Self::None => None,
            Self::Fixed(cell) => Some(*cell),
            Self::Edges { edges, offset, periodic } => {
                let vectors = match edges.numbers(file, frame, steps)?[..] {
                    [a, b, c] => [DVec3::X * a, DVec3::Y * b, DVec3::Z * c],
                    [ax, ay, az, bx, by, bz, cx, cy, cz] => {
                        [DVec3::new(ax, ay, az), DVec3::new(bx, by, bz), DVec3::new(cx, cy, cz)]
                    }
                    _ => return Ok(None),
                };
                let origin = match offset {
                    Some(offset) => offset.numbers(file, frame, steps)?,
                    None => Vec::new(),
                };
                let origin = match origin[..] {
                    [x, y, z] => DVec3::new(x, y, z),
                    _ => DVec3::ZERO,
                };
                Cell { origin, vectors, periodic: *periodic }.declared()
            }
            Self::Lengths(lengths, angles) => {
                let lengths = lengths.numbers(file, frame, steps)?;
                let angles = match angles {
                    Some(angles) => angles.numbers(file, frame, steps)?,
                    None => vec![90.0; 3],
                };
                match (<[f64; 3]>::try_from(lengths), <[f64; 3]>::try_from(angles)) {
                    (Ok(lengths), Ok(angles)) => Cell::of_lengths(lengths, angles),
                    _ => None,
                }
            }
        })
    }
}
