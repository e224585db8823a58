//! Particle files as columns.

use crate::errors::{error, of_file};
use crate::first_frame;
use crate::pools::pool;
use crate::watch::Watcher;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use spherule::particles::{
    self as particles, BondSource, Codes, Columns, Element, FileError, Format, FrameChoice,
    ParticleFrame, ReadOptions, TextColumn,
};
use spherule::scene::particles::{FirstFrame, TrajectoryReader, TypeMaterial};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Options for reading a particle file, by the names that the program has for them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ReadTable {
    format: Option<String>,
    /// `x=px,type=species` and so on.
    columns: Option<String>,
    atom_style: Option<String>,
    topology: Option<PathBuf>,
    /// Names of types with the symbols of their elements.
    elements: Vec<(String, String)>,
    /// The source of bonds, as the style has it.
    bonds: Option<String>,
}

impl ReadTable {
    fn options(&self, py: Python<'_>) -> PyResult<ReadOptions> {
        let format = self.format.as_deref().map(|name| {
            let found = Format::ALL.iter().find(|(own, _)| *own == name).map(|(_, format)| *format);
            found.ok_or_else(|| {
                let names = Format::ALL.map(|(name, _)| name).join(", ");
                error(py, &format!("unknown format \"{name}\"; formats are {names}"))
            })
        });
        let columns = self.columns.as_deref().map_or(Ok(Columns::default()), str::parse);
        let columns: Columns = columns.map_err(|why: String| error(py, &why))?;
        let bonds = self.bonds.as_deref().map(str::parse).transpose();
        let bonds: Option<BondSource> = bonds.map_err(|why: String| error(py, &why))?;
        let element = |(name, symbol): &(String, String)| {
            let found = Element::from_symbol(symbol).map(|element| (name.clone(), element));
            found.ok_or_else(|| {
                let message = format!(
                    "elements[\"{name}\"] is \"{symbol}\", but must be a symbol such as \"O\""
                );
                error(py, &message)
            })
        };
        Ok(ReadOptions {
            format: format.transpose()?,
            columns: Columns { rest: Some(usize::MAX), ..columns },
            atom_style: self.atom_style.clone(),
            topology: self.topology.clone(),
            elements: self.elements.iter().map(element).collect::<PyResult<_>>()?,
            bonds: bonds.unwrap_or_default(),
            allow_empty: true,
            ..ReadOptions::default()
        })
    }
}

/// The number of complete frames of a file.
#[pyfunction]
pub(crate) fn count_frames(py: Python<'_>, path: PathBuf, table: ReadTable) -> PyResult<u64> {
    let options = table.options(py)?;
    let work = move |_: &_| particles::count_frames(&path, &options);
    let (count, _) = Watcher::default().run(py, pool(py, None)?, work)?;
    count.map_err(|error| of_file(py, &error))
}

/// A frame of a file, from 0; negative numbers count from the end.
#[pyfunction]
pub(crate) fn read(
    py: Python<'_>,
    path: PathBuf,
    frame: i64,
    table: ReadTable,
) -> PyResult<Bound<'_, PyDict>> {
    let options = table.options(py)?;
    let work = move |_: &_| frame_of(&path, frame, options);
    let (read, _) = Watcher::default().run(py, pool(py, None)?, work)?;
    read.map_err(|error| of_file(py, &error))?.table(py)
}

/// A file of which frames are read one after another: it stays open, and the next frames are read ahead.
#[pyclass(frozen, module = "spherule._spherule")]
pub(crate) struct FrameFile {
    path: PathBuf,
    options: ReadOptions,
    reader: Arc<Mutex<TrajectoryReader>>,
}

#[pymethods]
impl FrameFile {
    #[new]
    fn new(py: Python<'_>, path: PathBuf, table: ReadTable) -> PyResult<Self> {
        Ok(Self { path, options: table.options(py)?, reader: Arc::default() })
    }

    /// The number of complete frames.
    fn count(&self, py: Python<'_>) -> PyResult<u64> {
        let count = lock(&self.reader).counter(&self.path, &self.options);
        let (count, _) = Watcher::default().run(py, pool(py, None)?, move |_: &_| count())?;
        count.map_err(|error| of_file(py, &error))
    }

    /// A frame, from 0, as `read` returns it.
    fn read<'py>(&self, py: Python<'py>, frame: u64) -> PyResult<Bound<'py, PyDict>> {
        let (reader, path) = (Arc::clone(&self.reader), self.path.clone());
        let options = ReadOptions { frame: FrameChoice::Index(frame), ..self.options.clone() };
        let work = move |_: &_| {
            let (frame, first_frame) = lock(&reader).read_alone(&path, &options)?;
            Ok::<_, FileError>(FileFrame { frame, first_frame })
        };
        let (read, _) = Watcher::default().run(py, pool(py, None)?, work)?;
        read.map_err(|error| of_file(py, &error))?.table(py)
    }
}

fn lock(reader: &Mutex<TrajectoryReader>) -> MutexGuard<'_, TrajectoryReader> {
    reader.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A frame, and the choices by the first one, if the file has several.
struct FileFrame {
    frame: ParticleFrame,
    first_frame: Option<FirstFrame>,
}

impl FileFrame {
    fn table(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let table = columns(py, self.frame)?;
        let first_frame = self.first_frame.map(|first| first_frame::table(py, &first));
        table.set_item("first_frame", first_frame.transpose()?)?;
        Ok(table)
    }
}

/// Returns a frame; negative numbers count from the end.
fn frame_of(path: &Path, frame: i64, options: ReadOptions) -> Result<FileFrame, FileError> {
    let frame = match frame {
        -1 => FrameChoice::Last,
        0.. => FrameChoice::Index(frame.unsigned_abs()),
        _ => {
            let count = particles::count_frames(path, &options)?;
            let index = count.checked_sub(frame.unsigned_abs()).ok_or_else(|| {
                let message = format!("has no frame {frame}, only {count}");
                FileError::whole_file(path, message)
            });
            FrameChoice::Index(index?)
        }
    };
    let read = TrajectoryReader::default().read_frame(path, &ReadOptions { frame, ..options })?;
    Ok(FileFrame { frame: read.0, first_frame: read.1 })
}

fn columns(py: Python<'_>, frame: ParticleFrame) -> PyResult<Bound<'_, PyDict>> {
    let table = PyDict::new(py);
    let count = frame.len();
    // One column after the other: the transpose has a row for each particle.
    let mut positions = frame.x;
    positions.reserve_exact(2 * count);
    positions.extend_from_slice(&frame.y);
    positions.extend_from_slice(&frame.z);
    table.set_item("positions", PyArray1::from_vec(py, positions).reshape([3, count])?)?;
    let some = |values: Vec<f64>| (!values.is_empty()).then(|| PyArray1::from_vec(py, values));
    let shapes = frame.shapes;
    let axes = (!shapes.is_empty()).then(|| {
        let of_row = |row: usize| {
            let is_sphere = shapes.is_sphere(row);
            let axes = shapes.semi_axes[row] * if is_sphere { 0.0 } else { frame.radius[row] };
            axes.to_array()
        };
        let rows: Vec<[f64; 3]> = (0..count).map(of_row).collect();
        PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])
    });
    table.set_item("semi_axes", axes.transpose()?)?;
    let turned = (!shapes.orientation.is_empty()).then(|| {
        let of_row = |turn: &glam::DQuat| [turn.w, turn.x, turn.y, turn.z];
        let rows: Vec<[f64; 4]> = shapes.orientation.iter().map(of_row).collect();
        PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 4])
    });
    table.set_item("orientation", turned.transpose()?)?;
    table.set_item("radius", some(frame.radius))?;
    let colors = (!frame.color.is_empty()).then(|| -> PyResult<Bound<'_, PyArray2<f32>>> {
        let rows: Vec<[f32; 3]> = frame.color.iter().map(glam::Vec3::to_array).collect();
        PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3])
    });
    table.set_item("color", colors.transpose()?)?;
    let kinds = frame.kinds;
    let names: Vec<String> = kinds.table.iter().map(|kind| kind.name.clone()).collect();
    let elements: Vec<Option<&str>> =
        kinds.table.iter().map(|kind| kind.element.map(Element::symbol)).collect();
    let coded = (!kinds.codes.is_empty()).then(|| (names, codes(py, &kinds.codes)));
    table.set_item("kinds", coded)?;
    table.set_item("elements", elements)?;
    let sources: Vec<&str> =
        kinds.table.iter().map(|kind| kind.element.map_or("", |_| kind.source.name())).collect();
    table.set_item("element_from", sources)?;
    let virtual_sites: Vec<bool> = kinds.table.iter().map(|kind| kind.virtual_site).collect();
    table.set_item("virtual_sites", virtual_sites)?;
    let bonds = frame.bonds.map(|bonds| -> PyResult<_> {
        let count = bonds.len();
        let ends = bonds.first.iter().zip(&bonds.second);
        let pairs = ends.flat_map(|(&first, &second)| [first, second]).collect();
        let shifts = (!bonds.shift.is_empty())
            .then(|| PyArray1::from_vec(py, bonds.shift.into_flattened()).reshape([count, 3]));
        Ok((PyArray1::from_vec(py, pairs).reshape([count, 2])?, shifts.transpose()?))
    });
    table.set_item("bonds", bonds.transpose()?)?;
    let text = |column: TextColumn| (column.names, codes(py, &column.codes));
    let materials = (!frame.materials.codes.is_empty()).then(|| text(frame.materials));
    table.set_item("materials", materials)?;
    let numbers = PyDict::new(py);
    for column in frame.numbers {
        numbers.set_item(column.name, PyArray1::from_vec(py, column.values))?;
    }
    table.set_item("numbers", numbers)?;
    let texts = PyDict::new(py);
    for column in frame.texts {
        texts.set_item(column.name.clone(), text(column))?;
    }
    table.set_item("texts", texts)?;
    let cell = frame.cell.map(|cell| {
        (cell.origin.to_array(), cell.vectors.map(|vector| vector.to_array()), cell.periodic)
    });
    table.set_item("cell", cell)?;
    table.set_item("title", frame.title)?;
    table.set_item("step", frame.step)?;
    table.set_item("time", frame.time)?;
    table.set_item("unit", frame.unit.name())?;
    table.set_item("format", frame.format.name())?;
    table.set_item("warnings", frame.warnings)?;
    Ok(table)
}

fn codes<'py>(py: Python<'py>, codes: &Codes) -> Bound<'py, PyArray1<u32>> {
    PyArray1::from_vec(py, (0..codes.len()).map(|row| codes.code(row)).collect())
}

/// The symbol of the element that a word is the symbol of, in any case.
#[pyfunction]
pub(crate) fn element_of(word: &str) -> Option<&'static str> {
    Element::from_symbol(word).map(Element::symbol)
}

/// The names of materials that a scene need not define.
#[pyfunction]
pub(crate) fn material_names() -> Vec<&'static str> {
    TypeMaterial::ALL.map(|(name, _)| name).to_vec()
}
