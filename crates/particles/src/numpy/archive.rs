//! Reads NPZ: several arrays in a ZIP archive, as `numpy.savez` writes them.

use super::array::{Array, Transpose};
use super::schema;
use crate::builder::{Builder, clamp_channel};
use crate::categories::{Codebook, add};
use crate::{
    FileError, Format, Kind, NumberColumn, ParticleFrame, Radii, ReadOptions, Rgb, Role,
    TextColumn, frame_reader::FrameReader, options::component_names, progress::CountedFile,
    schema::Schema, source::Source,
};
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;
use zip::ZipArchive;
use zip::read::ZipFile;

/// Names of arrays of positions, in order of precedence.
const POSITIONS: [&str; 9] =
    ["position", "positions", "pos", "xyz", "points", "coordinates", "coords", "centers", "arr_0"];
/// Names of arrays of one coordinate, by axis.
const AXES: [(Role, [&str; 3]); 3] = [
    (Role::X, ["x", "pos_x", "position_x"]),
    (Role::Y, ["y", "pos_y", "position_y"]),
    (Role::Z, ["z", "pos_z", "position_z"]),
];
/// Names of arrays of radii.
const RADII: [&str; 3] = ["radius", "radii", "r"];
/// Names of arrays of diameters.
const DIAMETERS: [&str; 2] = ["diameter", "diameters"];
/// Names of arrays of colors.
const COLORS: [&str; 2] = ["color", "colors"];
/// Names of arrays of types.
const TYPES: [&str; 7] = ["typeid", "type", "types", "element", "elements", "species", "symbols"];

/// Maximum number of columns of an array that are kept as columns of particles.
const WIDEST: usize = 64;

/// A column of an array.
#[derive(Clone)]
struct ArrayColumn {
    name: String,
    array: String,
    /// Index in a row.
    at: usize,
    /// Number of columns of the array.
    width: usize,
}

/// Reader of the arrays of an archive.
pub(in super::super) struct Npz {
    path: Arc<Path>,
    archive: ZipArchive<BufReader<CountedFile>>,
    options: ReadOptions,
    done: bool,
}

impl Npz {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let path = source.path.clone();
        let file = BufReader::new(source.into_file()?);
        let archive = ZipArchive::new(file).map_err(|error| {
            let error =
                FileError::whole_file(&path, format!("is not a complete ZIP archive: {error}"));
            error.with_help("the file is cut off")
        })?;
        Ok(Self { path, archive, options: options.clone(), done: false })
    }

    /// Returns the names of the arrays.
    pub(super) fn names(&self) -> Vec<String> {
        let names = self.archive.file_names();
        names.filter_map(|name| name.ok()?.strip_suffix(".npy").map(str::to_owned)).collect()
    }

    /// Returns the array of a role, or the first array with one of the usual names.
    fn find(&self, role: Role, usual: &[&str]) -> Option<String> {
        let names = self.names();
        let role = self.options.columns.roles.iter().find(|(own, _)| *own == role);
        if let Some((_, name)) = role {
            return Some(name.clone());
        }
        let same = |wanted: &&str| names.iter().find(|name| name.eq_ignore_ascii_case(wanted));
        usual.iter().find_map(same).cloned()
    }

    fn open(
        &mut self,
        name: &str,
        transpose: Transpose,
    ) -> Result<Array<ZipFile<'_, BufReader<CountedFile>>>, FileError> {
        let names = self.names().join(", ");
        let file = self.archive.by_name(&format!("{name}.npy")).map_err(|error| {
            let message = format!("the array `{name}` cannot be read ({error}); there are {names}");
            FileError::whole_file(&self.path, message)
        })?;
        Array::open(file, transpose).map_err(|message| fault(&self.path, name, &message))
    }

    /// Reads positions, and returns the name of their array.
    fn positions(&mut self) -> Result<(Builder, String), FileError> {
        let names = self.names();
        let roles = &self.options.columns.roles;
        let has_axes = roles.iter().any(|(role, _)| matches!(role, Role::Y | Role::Z));
        let whole = self.find(Role::X, &POSITIONS).filter(|_| !has_axes);
        let axes = AXES.map(|(role, usual)| self.find(role, &usual));
        let only = if names.len() == 1 { names.first().cloned() } else { None };
        let name = match (whole, axes, only) {
            (None, [Some(x), Some(y), Some(z)], _) => return self.axes([x, y, z]),
            (Some(name), ..) | (None, _, Some(name)) => name,
            (None, _, None) if names.is_empty() => {
                let error =
                    FileError::whole_file(&self.path, "is a ZIP archive without arrays of NumPy");
                return Err(error.with_help(
                    "unpack one of its files: unzip -p FILE NAME | spherule render - -o picture.png",
                ));
            }
            (None, _, None) => {
                let message =
                    format!("no array is named `position`; there are {}", names.join(", "));
                return Err(FileError::whole_file(&self.path, message).with_help(
                    "name one of rows `x y z`, as in --columns x=NAME, or one for each axis, as in \
                     --columns x=NAME,y=NAME,z=NAME",
                ));
            }
        };
        let path = self.path.clone();
        let mut array = self.open(&name, Transpose::ToPositions)?;
        let schema = schema(&array, &ReadOptions::default());
        let schema = Arc::new(schema.map_err(|message| fault(&path, &name, &message))?);
        let mut builder = Builder::new(&path, Format::Npz, &schema);
        let warning = array.warning().map(|warning| format!("the array `{name}`: {warning}"));
        builder.frame.warnings.extend(warning);
        array.rows(&path, |row| {
            for (slot, &value) in schema.slots.iter().zip(row.numbers) {
                builder.put_number(*slot, value);
            }
            builder.end_row()
        })?;
        let width = array.columns();
        let plain = array.names().is_none();
        drop(array);
        if plain {
            let names = component_names(&name, width);
            for (_, column) in &mut builder.frame.roles {
                let place = column.parse().unwrap_or(0_usize).wrapping_sub(1);
                names.get(place).unwrap_or(&name).clone_into(column);
            }
        }
        Ok((builder, name))
    }

    /// Returns the columns of all arrays that have a row for each particle.
    fn parts(&mut self, count: usize) -> Vec<ArrayColumn> {
        let mut parts = Vec::new();
        for array in self.names() {
            // An archive may hold other files.
            let Ok(open) = self.open(&array, Transpose::ToRows(count as u64)) else { continue };
            let width = open.columns();
            let fits = open.count() == count as u64 && (1..=WIDEST).contains(&width);
            if fits && open.names().is_none() {
                let names = component_names(&array, width).into_iter().enumerate();
                drop(open);
                let part = |(at, name)| ArrayColumn { name, array: array.clone(), at, width };
                parts.extend(names.map(part));
            }
        }
        parts
    }

    /// Reads the columns that the options request; `used` are the arrays that have a role.
    fn keep(&mut self, frame: &mut ParticleFrame, used: &[String]) -> Result<(), FileError> {
        let parts = self.parts(frame.len());
        let columns = &self.options.columns;
        let find = |name: &String| {
            let same = parts.iter().find(|part| part.name == *name);
            same.or_else(|| parts.iter().find(|part| part.name.eq_ignore_ascii_case(name))).cloned()
        };
        // Reading an array that does not fit returns the reason.
        let whole = |name: &String| {
            let (name, array) = (name.clone(), name.clone());
            ArrayColumn { name, array, at: 0, width: 1 }
        };
        let mut asked = Vec::new();
        for name in &columns.kept {
            if let Some(part) = parts.iter().find(|part| part.array == *name && part.width > 1) {
                let (width, first) = (part.width, &part.name);
                let error = fault(&self.path, name, &format!("has {width} columns"));
                return Err(error.with_help(format!("name one of them, as in {first}")));
            }
            asked.push(find(name).unwrap_or_else(|| whole(name)));
        }
        asked.extend(columns.wanted.iter().filter_map(find));
        let mut rest = parts.clone();
        rest.retain(|part| {
            !used.contains(&part.array) && asked.iter().all(|other| other.name != part.name)
        });
        let has_room = |most| rest.len().saturating_mul(frame.len()) <= most;
        if columns.rest.is_some_and(has_room) {
            for part in rest {
                // Not requested by name, so a damaged one is no error.
                let _ = self.read_part(frame, part);
            }
        }
        asked.into_iter().try_for_each(|part| self.read_part(frame, part))?;
        frame.columns = parts.into_iter().map(|part| part.name).collect();
        Ok(())
    }

    fn read_part(&mut self, frame: &mut ParticleFrame, part: ArrayColumn) -> Result<(), FileError> {
        let ArrayColumn { name, array, at, width } = part;
        if let Some(texts) = self.texts(&array, at, frame.len())? {
            frame.texts.push(TextColumn { name, ..texts });
            return Ok(());
        }
        let mut values = self.rows(&array, width, frame.len())?;
        if width > 1 {
            values = values.chunks_exact(width).map(|row| row[at]).collect();
        }
        frame.numbers.push(NumberColumn { name, values });
        Ok(())
    }

    /// Reads positions from one array for each axis.
    fn axes(&mut self, names: [String; 3]) -> Result<(Builder, String), FileError> {
        let schema =
            Schema::new(["x", "y", "z"].map(str::to_owned).into(), &ReadOptions::default())
                .map_err(|message| FileError::whole_file(&self.path, message))?;
        let mut builder = Builder::new(&self.path, Format::Npz, &Arc::new(schema));
        let [x, y, z] = &names;
        self.coordinates(x, |value| builder.push([value, 0.0, 0.0]))?;
        let count = builder.frame.len();
        builder.frame.y = self.rows(y, 1, count)?;
        builder.frame.z = self.rows(z, 1, count)?;
        builder.frame.roles = [Role::X, Role::Y, Role::Z].into_iter().zip(names.clone()).collect();
        let [x, ..] = names;
        Ok((builder, x))
    }

    /// Calls `take` with each number of a one-column array.
    fn coordinates(
        &mut self,
        name: &str,
        mut take: impl FnMut(f64) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        let path = self.path.clone();
        let mut array = self.open(name, Transpose::Never)?;
        let found = if array.is_text(0) {
            "holds texts".to_owned()
        } else if array.columns() != 1 {
            format!("has {} columns", array.columns())
        } else {
            return array.rows(&path, |row| take(row.numbers[0]));
        };
        let message = format!("{found}, but x, y and z have one number in each row");
        Err(fault(&path, name, &message))
    }

    /// Returns the numbers of an array that has a row of `columns` numbers for each particle.
    fn rows(&mut self, name: &str, columns: usize, count: usize) -> Result<Vec<f64>, FileError> {
        let path = self.path.clone();
        let mut array = self.open(name, Transpose::ToRows(count as u64))?;
        if array.is_text(0) {
            return Err(fault(&path, name, "holds texts, but numbers are needed"));
        }
        let width = array.columns();
        if columns > 1 && width != columns {
            let message = format!("has rows of {width} numbers, but {columns} are needed");
            return Err(fault(&path, name, &message));
        }
        let wrong = |found: &str| number_of(&path, name, found, count);
        let mut values = Vec::new();
        array.rows(&path, |row| {
            values.extend_from_slice(row.numbers);
            if values.len() > count * columns { Err(wrong("more rows")) } else { Ok(()) }
        })?;
        if values.len() == count * columns {
            Ok(values)
        } else {
            Err(wrong(&format!("{} numbers", values.len())))
        }
    }

    /// Returns a column of an array of texts, one for each particle; `None` if the array holds numbers.
    fn texts(
        &mut self,
        name: &str,
        at: usize,
        count: usize,
    ) -> Result<Option<TextColumn>, FileError> {
        let path = self.path.clone();
        let mut array = self.open(name, Transpose::Never)?;
        if !array.is_text(0) {
            return Ok(None);
        }
        let (mut book, mut rows) = (Codebook::default(), 0);
        let mut column = TextColumn { name: name.to_owned(), ..TextColumn::default() };
        array.rows(&path, |row| {
            let names = &mut column.names;
            let text = row.text(at).unwrap_or_default();
            column.codes.push(book.code(text.as_bytes(), |text| add(names, text)));
            rows += 1;
            if rows > count { Err(number_of(&path, name, "more texts", count)) } else { Ok(()) }
        })?;
        if rows == count {
            Ok(Some(column))
        } else {
            Err(number_of(&path, name, &format!("{rows} texts"), count))
        }
    }

    /// Sets the types of particles from an array.
    fn kinds(&mut self, builder: &mut Builder) -> Result<(), FileError> {
        let count = builder.frame.len();
        let Some(name) = self.find(Role::Kind, &TYPES) else { return Ok(()) };
        builder.frame.roles.push((Role::Kind, name.clone()));
        if let Some(texts) = self.texts(&name, 0, count)? {
            (0..count).for_each(|row| builder.kind(texts.text(row).as_bytes()));
        } else {
            // Type numbers are not elements.
            for kind in self.rows(&name, 1, count)? {
                builder.kind_of(kind.to_string().as_bytes(), |name| Kind {
                    name: name.to_owned(),
                    element: None,
                    virtual_site: false,
                });
            }
        }
        Ok(())
    }

    /// Returns the rows and columns of an array; `None` if it has more dimensions or cannot be read.
    pub(super) fn shape(&mut self, name: &str, transpose: Transpose) -> Option<[u64; 2]> {
        let array = self.open(name, transpose).ok()?;
        (array.frames() <= 1).then(|| [array.count(), array.columns() as u64])
    }

    /// Returns all numbers of an array.
    pub(super) fn numbers(&mut self, name: &str) -> Result<Vec<f64>, FileError> {
        let path = self.path.clone();
        let mut values = Vec::new();
        self.open(name, Transpose::Never)?.rows(&path, |row| {
            values.extend_from_slice(row.numbers);
            Ok(())
        })?;
        Ok(values)
    }
}

/// Returns an error about an array.
fn fault(path: &Path, name: &str, message: &str) -> FileError {
    FileError::whole_file(path, format!("the array `{name}` {message}"))
}

/// Returns the error for an array that does not have a row for each particle.
fn number_of(path: &Path, name: &str, found: &str, count: usize) -> FileError {
    fault(path, name, &format!("has {found}, but there are {count} particles"))
}

impl FrameReader for Npz {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if std::mem::replace(&mut self.done, true) {
            return Ok(None);
        }
        let (mut builder, positions) = self.positions()?;
        let mut used = vec![positions];
        let count = builder.frame.len();
        self.kinds(&mut builder)?;
        let mut frame = builder.finish();
        let radius = match &self.options.radii {
            Radii::Column(name) => Some((name.clone(), 1.0)),
            _ => self.find(Role::Radius, &RADII).map(|name| (name, 1.0)),
        };
        let radius =
            radius.or_else(|| self.find(Role::Diameter, &DIAMETERS).map(|name| (name, 0.5)));
        if let Some((name, factor)) = radius {
            frame.radius = self.rows(&name, 1, count)?;
            frame.radius.iter_mut().for_each(|radius| *radius *= factor);
            frame.roles.retain(|(role, _)| !matches!(role, Role::Radius | Role::Diameter));
            let role = if factor == 1.0 { Role::Radius } else { Role::Diameter };
            frame.roles.push((role, name));
        }
        if let Some(name) = self.find(Role::Red, &COLORS) {
            let values = self.rows(&name, 3, count)?;
            let color = |row: &[f64]| {
                Rgb::new(clamp_channel(row[0]), clamp_channel(row[1]), clamp_channel(row[2]))
            };
            frame.color = values.chunks_exact(3).map(color).collect();
            let roles = [Role::Red, Role::Green, Role::Blue];
            frame.roles.extend(roles.into_iter().zip(component_names(&name, 3)));
            used.push(name);
        }
        used.extend(frame.roles.iter().map(|(_, name)| name.clone()));
        self.keep(&mut frame, &used)?;
        self.read_rest(&mut frame, &used)?;
        Ok(Some(frame))
    }
}
