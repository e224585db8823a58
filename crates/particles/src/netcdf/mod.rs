//! Reads NetCDF of the classic formats by the conventions of Amber (ambermd.org/netcdf/nctraj.xhtml), which
//! `dump netcdf` of LAMMPS follows too: trajectories, and restart files with one frame.

mod header;

use self::header::{Header, Variable, text};
use crate::arrays::{RowLayout, UsedArrays};
use crate::binary::{BinaryFile, Numbers};
use crate::scalar::{Order, Scalar};
use crate::{
    Cell, FileError, Format, LengthUnit, ParticleFrame, ReadOptions, builder::Builder,
    frame_reader::FrameReader, options::component_names, place::Place, schema::Schema,
    source::Source,
};
use glam::DVec3;
use std::sync::Arc;

/// Beginnings of files: the version follows three letters.
const MAGICS: [&[u8]; 3] = [b"CDF\x01", b"CDF\x02", b"CDF\x05"];

/// Variables with three values per atom, and the names of their columns.
const VECTORS: [(&str, [&str; 3]); 3] = [
    ("coordinates", ["x", "y", "z"]),
    ("velocities", ["vx", "vy", "vz"]),
    ("forces", ["fx", "fy", "fz"]),
];

/// Variables of the cell.
const CELL: [&str; 3] = ["cell_lengths", "cell_angles", "cell_origin"];

/// Maximum number of values per atom in a variable that is kept as columns.
const WIDEST: u64 = 64;

/// Returns whether a file with this head is NetCDF of a classic format.
pub(crate) fn is_netcdf(head: &[u8]) -> bool {
    MAGICS.iter().any(|magic| head.starts_with(magic))
}

/// Returns the unit of length of this name.
pub(crate) fn unit(name: &str) -> LengthUnit {
    match name.to_ascii_lowercase().trim_end_matches('s') {
        "angstrom" => LengthUnit::Angstrom,
        "nanometer" | "nm" => LengthUnit::Nanometer,
        "bohr" => LengthUnit::Bohr,
        "micrometer" => LengthUnit::Micrometer,
        "centimeter" | "cm" => LengthUnit::Centimeter,
        "meter" | "m" => LengthUnit::Meter,
        _ => LengthUnit::Unknown,
    }
}

/// Values of a variable for each frame.
#[derive(Clone, Copy)]
struct Slab {
    scalar: Scalar,
    scale: f64,
    /// Offset of the first frame, and distance between frames.
    begin: u64,
    stride: u64,
    /// Number of values per frame.
    values: u64,
}

/// A variable with values for each atom.
struct Column {
    slab: Slab,
    /// Number of values per atom.
    width: usize,
}

/// Reader of the frames of a NetCDF file.
pub(crate) struct NetCdf {
    file: BinaryFile,
    schema: Arc<Schema>,
    title: String,
    unit: LengthUnit,
    atoms: u64,
    frames: u64,
    next: u64,
    /// Variables with values for each atom, in the order of the schema's names.
    columns: Vec<Column>,
    time: Option<Slab>,
    /// Lengths, angles and the origin.
    cell: [Option<Slab>; 3],
}

impl NetCdf {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Result<Self, FileError> {
        let mut file = BinaryFile::open(source)?;
        let header = Header::read(&mut file)?;
        let layout = Layout::new(&file, &header);
        let find = |name: &str| header.variables.iter().find(|variable| variable.name == name);
        let coordinates = find("coordinates").and_then(|own| Some((own, layout.atoms(own)?)));
        let Some((coordinates, atoms)) = coordinates else {
            let error = file.fault("is a NetCDF file, but has no `coordinates` of atoms");
            return Err(error.with_help(
                "NetCDF is read by the conventions of Amber; others: python3 -c \"import xarray; \
                 xarray.open_dataset('FILE').to_dataframe().to_csv('FILE.csv')\"",
            ));
        };
        let (mut columns, mut names) = (Vec::new(), Vec::new());
        for variable in &header.variables {
            let Some((column, width)) = layout.column(variable, atoms) else { continue };
            let known = VECTORS.iter().find(|(name, _)| *name == variable.name && width == 3);
            match known {
                Some((_, axes)) => names.extend(axes.map(str::to_owned)),
                None => names.extend(component_names(&variable.name, width)),
            }
            columns.push(column);
        }
        let schema = Schema::new(names, options).map_err(|message| file.fault(message))?;
        let slab = |name: &str, values: u64| {
            find(name)
                .and_then(|variable| layout.slab(variable))
                .filter(|slab| slab.values == values)
        };
        let cell = CELL.map(|name| slab(name, 3));
        Ok(Self {
            schema: Arc::new(schema),
            title: text(&header.attributes, "title").unwrap_or_default().trim().to_owned(),
            unit: coordinates.text("units").map_or(LengthUnit::Angstrom, unit),
            atoms,
            frames: match (atoms, layout.has_frames(coordinates)) {
                (0, _) => 0,
                (_, true) => layout.frames,
                (_, false) => 1,
            },
            next: 0,
            columns,
            time: slab("time", 1),
            cell,
            file,
        })
    }

    /// Returns the values of a variable in the next frame.
    fn values<const COUNT: usize>(
        &mut self,
        slab: Option<Slab>,
    ) -> Result<Option<[f64; COUNT]>, FileError> {
        let Some(slab) = slab else { return Ok(None) };
        let bytes = self.file.bytes(slab.at(self.next), slab.bytes())?;
        let values = Numbers::new(&bytes, Order::Big).array(slab.scalar);
        Ok(values.map(|values| values.map(|value| value * slab.scale)))
    }

    fn cell(&mut self) -> Result<Option<Cell>, FileError> {
        let [lengths, angles, origin] = self.cell;
        let (lengths, angles) = (self.values(lengths)?, self.values(angles)?);
        let origin = self.values(origin)?.map_or(DVec3::ZERO, DVec3::from_array);
        let cell =
            lengths.and_then(|lengths| Cell::of_lengths(lengths, angles.unwrap_or([90.0; 3])));
        Ok(cell.map(|cell| Cell { origin: cell.origin + origin, ..cell }))
    }

    /// Returns whether the coordinates of the next frame are in the file.
    fn is_whole(&self) -> bool {
        let all =
            |column: &Column| self.file.has_range(column.slab.at(self.next), column.slab.bytes());
        self.next < self.frames && self.columns.iter().all(all)
    }
}

impl FrameReader for NetCdf {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        if self.next >= self.frames {
            return Ok(None);
        }
        let schema = self.schema.clone();
        let mut arrays = UsedArrays::new(&schema.slots);
        for &Column { slab, width } in &self.columns {
            let Slab { scalar, scale, .. } = slab;
            let layout = RowLayout { scalar, order: Order::Big, width, scale };
            arrays.add(layout, || self.file.bytes(slab.at(self.next), slab.bytes()))?;
        }
        let mut builder = Builder::new(self.file.path(), Format::NetCdf, &schema);
        for atom in 0..self.atoms as usize {
            arrays.put_row(&mut builder, atom);
            builder.end_row()?;
        }
        let cell = self.cell()?;
        let time = self.values::<1>(self.time)?.map(|[time]| time);
        self.next += 1;
        let frame = builder.finish();
        Ok(Some(ParticleFrame { cell, time, title: self.title.clone(), unit: self.unit, ..frame }))
    }

    fn skip(&mut self) -> Result<bool, FileError> {
        let there = self.is_whole();
        self.next += u64::from(there);
        Ok(there)
    }

    fn more(&mut self) -> Result<bool, FileError> {
        Ok(self.is_whole())
    }

    fn place(&self) -> Option<Place> {
        Some(Place::new(0, self.next))
    }

    fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        self.next = place.number;
        Ok(true)
    }
}

impl Slab {
    /// Returns the offset of a frame.
    fn at(&self, frame: u64) -> u64 {
        self.begin.saturating_add(self.stride.saturating_mul(frame))
    }

    /// Returns the number of bytes per frame.
    fn bytes(&self) -> u64 {
        self.values.saturating_mul(self.scalar.size() as u64)
    }
}

/// Where the values of variables are.
struct Layout<'h> {
    header: &'h Header,
    /// Length of a record of all variables.
    record: u64,
    frames: u64,
}

impl<'h> Layout<'h> {
    fn new(file: &BinaryFile, header: &'h Header) -> Self {
        let mut layout = Self { header, record: 0, frames: 1 };
        let variables: Vec<&Variable> =
            header.variables.iter().filter(|own| layout.is_record(own)).collect();
        let sizes: Vec<u64> = variables.iter().map(|own| layout.bytes(own)).collect();
        // A single variable isn't padded.
        let padded = |size: &u64| size.saturating_add(3) / 4 * 4;
        layout.record = match sizes[..] {
            [size] => size,
            _ => sizes.iter().map(padded).fold(0, u64::saturating_add),
        };
        let begin = variables.iter().map(|own| own.begin).min();
        let held = begin.map(|begin| {
            file.length().saturating_sub(begin).checked_div(layout.record).unwrap_or(0)
        });
        let fixed = header.dimensions.iter().find(|own| own.name == "frame" && own.length > 0);
        layout.frames = match (held, fixed) {
            (Some(held), None) => header.records.unwrap_or(held),
            (_, Some(frames)) => frames.length,
            (None, None) => 1,
        };
        layout
    }

    /// Returns whether a variable has values in each record.
    fn is_record(&self, variable: &Variable) -> bool {
        variable.dimensions.first().is_some_and(|&first| self.header.dimensions[first].length == 0)
    }

    /// Returns whether a variable has values for each frame.
    fn has_frames(&self, variable: &Variable) -> bool {
        variable.dimensions.first().is_some_and(|&first| {
            let dimension = &self.header.dimensions[first];
            dimension.length == 0 || dimension.name == "frame"
        })
    }

    /// Returns the lengths of a variable's dimensions within a frame.
    fn lengths(&self, variable: &Variable) -> impl Iterator<Item = u64> {
        let within = variable.dimensions.iter().skip(usize::from(self.has_frames(variable)));
        within.map(|&dimension| self.header.dimensions[dimension].length)
    }

    /// Returns the number of bytes of a variable in a frame.
    fn bytes(&self, variable: &Variable) -> u64 {
        let size = variable.scalar.map_or(1, Scalar::size) as u64;
        self.lengths(variable).fold(size, u64::saturating_mul)
    }

    /// Returns the values of a variable of numbers.
    fn slab(&self, variable: &Variable) -> Option<Slab> {
        let bytes = self.bytes(variable);
        let stride = match (self.is_record(variable), self.has_frames(variable)) {
            (true, _) => self.record,
            (false, true) => bytes,
            (false, false) => 0,
        };
        let scalar = variable.scalar?;
        let values = self.lengths(variable).fold(1, u64::saturating_mul);
        Some(Slab { scalar, scale: variable.scale(), begin: variable.begin, stride, values })
    }

    /// Returns the number of atoms of a variable with positions.
    fn atoms(&self, variable: &Variable) -> Option<u64> {
        let lengths: Vec<u64> = self.lengths(variable).collect();
        variable.scalar?;
        match lengths[..] {
            [atoms, 3] => Some(atoms),
            _ => None,
        }
    }

    /// Returns the values of a variable with as many rows as atoms, and the number of values per row.
    fn column(&self, variable: &Variable, atoms: u64) -> Option<(Column, usize)> {
        let mut lengths = self.lengths(variable);
        let (rows, width) = (lengths.next()?, lengths.next().unwrap_or(1));
        let is_cell = CELL.contains(&variable.name.as_str());
        let fits =
            !is_cell && rows == atoms && (1..=WIDEST).contains(&width) && lengths.next().is_none();
        let width = width as usize;
        let slab = if fits { self.slab(variable)? } else { return None };
        Some((Column { slab, width }, width))
    }
}
