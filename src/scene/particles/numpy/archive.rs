//! Several arrays in a ZIP archive, as `numpy.savez` writes them.

use super::array::Array;
use super::schema;
use crate::scene::particles::builder::{Builder, add, share};
use crate::scene::particles::categories::{Codebook, Kind, TextColumn};
use crate::scene::particles::frame::{NumberColumn, ParticleFrame};
use crate::scene::particles::options::{Format, Radii, ReadOptions, Role};
use crate::scene::particles::reader::FrameReader;
use crate::scene::particles::source::Source;
use crate::scene::{Rgb, SceneError};
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use std::sync::Arc;
use zip::ZipArchive;
use zip::read::ZipFile;

/// Names of arrays of positions, those that go first in front; radii and diameters; colors.
const POSITIONS: [&str; 9] =
    ["position", "positions", "pos", "xyz", "points", "coordinates", "coords", "centers", "arr_0"];
const RADII: [&str; 3] = ["radius", "radii", "r"];
const DIAMETERS: [&str; 2] = ["diameter", "diameters"];
const COLORS: [&str; 2] = ["color", "colors"];
const TYPES: [&str; 7] = ["typeid", "type", "types", "element", "elements", "species", "symbols"];

/// Reads positions, radii and colors from arrays of one archive.
pub(in super::super) struct Npz {
    path: Arc<Path>,
    archive: ZipArchive<BufReader<File>>,
    options: ReadOptions,
    done: bool,
}

impl Npz {
    pub(in super::super) fn new(source: Source, options: &ReadOptions) -> Result<Self, SceneError> {
        let path = source.path.clone();
        let file = BufReader::new(source.into_file()?);
        let archive = ZipArchive::new(file).map_err(|error| {
            let error = SceneError::whole_file(&path, format!("is no whole ZIP archive: {error}"));
            error.with_help("the file is cut off")
        })?;
        Ok(Self { path, archive, options: options.clone(), done: false })
    }

    /// Names of the arrays.
    fn names(&self) -> Vec<String> {
        let names = self.archive.file_names();
        names.filter_map(|name| name.ok()?.strip_suffix(".npy").map(str::to_owned)).collect()
    }

    /// The array of a role, or the first of the usual names that is there.
    fn find(&self, role: Role, usual: &[&str]) -> Option<String> {
        let names = self.names();
        let role = self.options.columns.roles.iter().find(|(own, _)| *own == role);
        if let Some((_, name)) = role {
            return Some(name.clone());
        }
        let same = |wanted: &&str| names.iter().find(|name| name.eq_ignore_ascii_case(wanted));
        usual.iter().find_map(same).cloned()
    }

    fn open(&mut self, name: &str) -> Result<Array<ZipFile<'_, BufReader<File>>>, SceneError> {
        let names = self.names().join(", ");
        let file = self.archive.by_name(&format!("{name}.npy")).map_err(|error| {
            let message = format!("the array `{name}` cannot be read ({error}); there are {names}");
            SceneError::whole_file(&self.path, message)
        })?;
        Array::open(file).map_err(|message| {
            SceneError::whole_file(&self.path, format!("the array `{name}` {message}"))
        })
    }

    fn positions(&mut self) -> Result<Builder, SceneError> {
        let names = self.names();
        let only = if names.len() == 1 { names.first().cloned() } else { None };
        let name = self.find(Role::X, &POSITIONS).or(only).ok_or_else(|| {
            let message = format!("no array is named `position`; there are {}", names.join(", "));
            SceneError::whole_file(&self.path, message).with_help("name one, as in x=NAME")
        })?;
        let path = self.path.clone();
        let mut array = self.open(&name)?;
        let schema = schema(&array, &ReadOptions::default()).map_err(|message| {
            SceneError::whole_file(&path, format!("the array `{name}` {message}"))
        })?;
        let schema = Arc::new(schema);
        let mut builder = Builder::new(&path, Format::Npz, &schema);
        array.rows(&path, |row| {
            for (slot, &value) in schema.slots.iter().zip(row.numbers) {
                builder.put_number(*slot, value);
            }
            builder.end_row()
        })?;
        builder.frame.columns = names;
        Ok(builder)
    }

    /// An array with as many rows as there are particles, of so many numbers each.
    fn rows(&mut self, name: &str, columns: usize, count: usize) -> Result<Vec<f64>, SceneError> {
        let path = self.path.clone();
        let mut array = self.open(name)?;
        let fault = |found: &str| number_of(&path, name, found, count);
        if array.is_text(0) {
            let message = format!("the array `{name}` holds texts, but numbers are needed");
            return Err(SceneError::whole_file(&path, message));
        }
        let mut values = Vec::new();
        array.rows(&path, |row| {
            values.extend_from_slice(row.numbers);
            if values.len() > count * columns { Err(fault("more rows")) } else { Ok(()) }
        })?;
        if values.len() == count * columns {
            Ok(values)
        } else {
            Err(fault(&format!("{} numbers", values.len())))
        }
    }
}

impl Npz {
    /// An array of as many texts as there are particles; `None` if it holds numbers.
    fn texts(&mut self, name: &str, count: usize) -> Result<Option<TextColumn>, SceneError> {
        let path = self.path.clone();
        let mut array = self.open(name)?;
        if !array.is_text(0) {
            return Ok(None);
        }
        let (mut book, mut rows) = (Codebook::default(), 0);
        let mut column = TextColumn { name: name.to_owned(), ..TextColumn::default() };
        array.rows(&path, |row| {
            let names = &mut column.names;
            let text = row.text(0).unwrap_or_default();
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

    /// Gives particles the types of an array.
    fn kinds(&mut self, builder: &mut Builder) -> Result<(), SceneError> {
        let count = builder.frame.len();
        let Some(name) = self.find(Role::Kind, &TYPES) else { return Ok(()) };
        if let Some(texts) = self.texts(&name, count)? {
            (0..count).for_each(|row| builder.kind(texts.text(row).as_bytes()));
        } else {
            // Numbers of types are no elements.
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
}

/// That an array has not as many rows as there are particles.
fn number_of(path: &Path, name: &str, found: &str, count: usize) -> SceneError {
    let message = format!("the array `{name}` has {found}, but there are {count} particles");
    SceneError::whole_file(path, message)
}

impl FrameReader for Npz {
    fn next(&mut self) -> Result<Option<ParticleFrame>, SceneError> {
        if std::mem::replace(&mut self.done, true) {
            return Ok(None);
        }
        let mut builder = self.positions()?;
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
        }
        if let Some(name) = self.find(Role::Red, &COLORS) {
            let values = self.rows(&name, 3, count)?;
            let color = |row: &[f64]| Rgb::new(share(row[0]), share(row[1]), share(row[2]));
            frame.color = values.chunks_exact(3).map(color).collect();
        }
        let (columns, there) = (&self.options.columns, self.names());
        let wanted = columns.wanted.iter().filter(|name| there.contains(name));
        let names: Vec<String> = columns.kept.iter().chain(wanted).cloned().collect();
        for name in names {
            if let Some(texts) = self.texts(&name, count)? {
                frame.texts.push(texts);
            } else {
                let values = self.rows(&name, 1, count)?;
                frame.numbers.push(NumberColumn { name, values });
            }
        }
        Ok(Some(frame))
    }
}
