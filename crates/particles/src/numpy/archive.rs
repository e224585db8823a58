//! Reads NPZ: several arrays in a ZIP archive, as `numpy.savez` writes them. A leading dimension may be that of frames.

use super::array::{Array, Transpose};
use super::schema;
use crate::builder::{Builder, clamp_channel, is_color, warn_of_colors};
use crate::categories::{Codebook, add};
use crate::{
    FileError, Format, Kind, NumberColumn, ParticleFrame, Radii, ReadOptions, Rgb, Role,
    TextColumn, aliases, frame_reader::FrameReader, options::component_names, place::Place,
    progress::CountedFile, schema::Schema, source::Source,
};
use std::collections::HashMap;
use std::fs::File;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::Arc;
use zip::read::{ZipFile, ZipFileSeek};
use zip::result::ZipError;
use zip::{CompressionMethod, ZipArchive};

/// Names of arrays of positions, in order of precedence.
const POSITIONS: [&str; 9] =
    ["position", "positions", "pos", "xyz", "points", "coordinates", "coords", "centers", "arr_0"];
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
    /// The next frame.
    frame: u64,
    /// Number of frames, once it is known.
    frames: Option<u64>,
    /// Decompressed arrays, in which frames are found.
    unpacked: HashMap<String, File>,
}

/// The arrays of positions.
enum Positions {
    Rows(String),
    Axes([String; 3]),
}

/// The bytes of an array.
enum Entry<'a> {
    /// From their beginning on.
    First(ZipFile<'a, BufReader<CountedFile>>),
    Stored(ZipFileSeek<'a, BufReader<CountedFile>>),
    Unpacked(&'a File),
}

impl Read for Entry<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::First(file) => file.read(buffer),
            Self::Stored(file) => file.read(buffer),
            Self::Unpacked(file) => file.read(buffer),
        }
    }
}

impl Seek for Entry<'_> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        match self {
            Self::First(_) => Err(io::ErrorKind::Unsupported.into()),
            Self::Stored(file) => file.seek(to),
            Self::Unpacked(file) => file.seek(to),
        }
    }
}

impl Npz {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let path = source.path.clone();
        let is_idle =
            |(role, _): &&(Role, String)| matches!(role, Role::Green | Role::Blue | Role::Material);
        if let Some((role, name)) = options.columns.roles.iter().find(is_idle) {
            let message = format!("`{}={name}` has no effect on arrays", role.name());
            let help = "colors are one array of three columns, as in --columns red=NAME";
            return Err(FileError::whole_file(&path, message).with_help(help));
        }
        let file = BufReader::new(source.into_file()?);
        let archive = ZipArchive::new(file).map_err(|error| {
            let error =
                FileError::whole_file(&path, format!("is not a complete ZIP archive: {error}"));
            error.with_help("the file is cut off")
        })?;
        let (options, unpacked) = (options.clone(), HashMap::new());
        Ok(Self { path, archive, options, frame: 0, frames: None, unpacked })
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

    /// Opens an array at the current frame.
    fn open(&mut self, name: &str, transpose: Transpose) -> Result<Array<Entry<'_>>, FileError> {
        let path = self.path.clone();
        let names = self.names().join(", ");
        let frame = self.frame;
        let entry = self.entry(&format!("{name}.npy")).map_err(|error| {
            let message = format!("the array `{name}` cannot be read ({error}); there are {names}");
            FileError::whole_file(&path, message)
        })?;
        let array = Array::open(entry, transpose);
        let mut array = array.map_err(|message| fault(&path, name, &message))?;
        let moved = array.move_to(frame);
        moved
            .map_err(|error| fault(&path, name, &format!("ends before frame {frame}: {error}")))?;
        Ok(array)
    }

    /// Returns the bytes of a file of the archive, in which frames after the first one can be found.
    fn entry(&mut self, name: &str) -> Result<Entry<'_>, ZipError> {
        if self.frame == 0 {
            return self.archive.by_name(name).map(Entry::First);
        }
        if self.archive.by_name(name)?.compression() == CompressionMethod::Stored {
            return self.archive.by_name_seek(name).map(Entry::Stored);
        }
        if !self.unpacked.contains_key(name) {
            let mut file = tempfile::tempfile()?;
            io::copy(&mut self.archive.by_name(name)?, &mut file)?;
            self.unpacked.insert(name.to_owned(), file);
        }
        let mut file = self.unpacked.get(name).ok_or(ZipError::FileNotFound)?;
        file.rewind()?;
        Ok(Entry::Unpacked(file))
    }

    /// Returns how arrays with a row for each particle are read.
    pub(super) fn to_rows(&self, count: usize) -> Transpose {
        Transpose::ToRows { count: count as u64, frames: self.frames.unwrap_or(1) }
    }

    /// Returns the number of frames: that of positions.
    fn count_frames(&mut self) -> Result<u64, FileError> {
        if let Some(frames) = self.frames {
            return Ok(frames);
        }
        let frames = match self.position_arrays()? {
            Positions::Rows(name) => self.open(&name, Transpose::ToPositions)?.frames().max(1),
            Positions::Axes(_) => 1,
        };
        Ok(*self.frames.insert(frames))
    }

    /// Returns the names of the arrays of positions.
    fn position_arrays(&self) -> Result<Positions, FileError> {
        let names = self.names();
        let roles = &self.options.columns.roles;
        let has_axes = roles.iter().any(|(role, _)| matches!(role, Role::Y | Role::Z));
        let whole = self.find(Role::X, &POSITIONS).filter(|_| !has_axes);
        let axes = [Role::X, Role::Y, Role::Z].map(|role| self.find(role, aliases::usual(role)));
        let only = if names.len() == 1 { names.first().cloned() } else { None };
        match (whole, axes, only) {
            (None, [Some(x), Some(y), Some(z)], _) => Ok(Positions::Axes([x, y, z])),
            (Some(name), ..) | (None, _, Some(name)) => Ok(Positions::Rows(name)),
            (None, _, None) if names.is_empty() => {
                let error =
                    FileError::whole_file(&self.path, "is a ZIP archive without arrays of NumPy");
                Err(error.with_help(
                    "unpack one of its files: unzip -p FILE NAME | spherule render - -o picture.png",
                ))
            }
            (None, _, None) => {
                let message =
                    format!("no array is named `position`; there are {}", names.join(", "));
                Err(FileError::whole_file(&self.path, message).with_help(
                    "name one of rows `x y z`, as in --columns x=NAME, or one for each axis, as in \
                     --columns x=NAME,y=NAME,z=NAME",
                ))
            }
        }
    }

    /// Reads positions, and returns the name of their array.
    fn positions(&mut self) -> Result<(Builder, String), FileError> {
        let name = match self.position_arrays()? {
            Positions::Rows(name) => name,
            Positions::Axes(names) => return self.axes(names),
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
            let Ok(open) = self.open(&array, self.to_rows(count)) else { continue };
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
        // Rows of several columns are not those of frames.
        let to_rows = self.to_rows(count);
        let single = Transpose::ToRows { count: count as u64, frames: 1 };
        let mut array = self.open(name, if columns == 1 { to_rows } else { single })?;
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
        let mut array = self.open(name, self.to_rows(count))?;
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
                    ..Kind::default()
                });
            }
        }
        Ok(())
    }

    /// Returns the rows and columns of an array; `None` if it has more dimensions or cannot be read.
    pub(super) fn shape(&mut self, name: &str, transpose: Transpose) -> Option<[u64; 2]> {
        let frames = self.frames;
        let array = self.open(name, transpose).ok()?;
        (array.frames() <= 1 || Some(array.frames()) == frames)
            .then(|| [array.count(), array.columns() as u64])
    }

    /// Returns whether an array of cells has a row for each frame, and is no matrix or pair of corners.
    pub(super) fn has_row_for_each_frame(&self, [rows, columns]: [u64; 2]) -> bool {
        self.frames.is_some_and(|frames| frames > 1 && frames == rows)
            && [3, 6, 9].contains(&columns)
            && rows.saturating_mul(columns) > 9
    }

    /// Returns the number of the current frame.
    pub(super) fn frame_number(&self) -> usize {
        self.frame as usize
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
        if self.frame >= self.count_frames()? {
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
            let beyond = values.iter().filter(|value| !is_color(**value)).count();
            warn_of_colors(&mut frame, beyond as u64);
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
        self.frame += 1;
        Ok(Some(frame))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let there = self.more()?;
        self.frame += u64::from(there);
        Ok(there)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.frame < self.count_frames()?)
    }

    fn place(&self) -> Option<Place> {
        Some(Place::new(0, self.frame))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.frame = place.number;
        Ok(true)
    }
}
