//! Options of readers: format, columns, frame, radii.

use super::progress::ReadProgress;
use crate::suggest;
use std::str::FromStr;

/// Format of a particle file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Format {
    /// A row `x y z` or `x y z radius` for each particle, or either with an id before it, with
    /// blanks, commas or semicolons between the numbers; `#` begins a comment.
    #[default]
    Xyzr,
    /// A header that names columns, and a row for each particle; commas, semicolons or tabs between
    /// them.
    Csv,
    /// XYZ of chemistry: the number of atoms, a comment, and a row `symbol x y z` for each; with
    /// `Lattice` and `Properties` in the comment it is extended XYZ.
    Xyz,
    /// A dump of LAMMPS in text.
    LammpsDump,
    /// A data file of LAMMPS.
    LammpsData,
    /// GRO of GROMACS.
    Gro,
    /// PDB.
    Pdb,
    /// mmCIF of the Protein Data Bank.
    MmCif,
    /// CIF of a crystal: the atoms that differ, in shares of the cell's edges, and its symmetry.
    Cif,
    /// GSD of HOOMD-blue.
    Gsd,
    /// Points of PLY, in text or binary.
    Ply,
    /// An array of NumPy: rows `x y z` or `x y z radius`, or of a structured type.
    Npy,
    /// Arrays of NumPy in an archive: positions, radii, colors.
    Npz,
}

impl Format {
    /// All formats, with the names that scene files and commands have for them.
    pub const ALL: [(&'static str, Self); 13] = [
        ("xyzr", Self::Xyzr),
        ("csv", Self::Csv),
        ("xyz", Self::Xyz),
        ("lammps-dump", Self::LammpsDump),
        ("lammps-data", Self::LammpsData),
        ("gro", Self::Gro),
        ("pdb", Self::Pdb),
        ("mmcif", Self::MmCif),
        ("cif", Self::Cif),
        ("gsd", Self::Gsd),
        ("ply", Self::Ply),
        ("npy", Self::Npy),
        ("npz", Self::Npz),
    ];

    /// The name in scene files and on the command line.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, format)| *format == self).map_or("", |(name, _)| name)
    }
}

/// Choice of a frame in a file with several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameChoice {
    /// This one; the first is 0, as in OVITO.
    Index(u64),
    /// The last.
    Last,
}

impl Default for FrameChoice {
    fn default() -> Self {
        Self::Index(0)
    }
}

impl FromStr for FrameChoice {
    type Err = String;

    /// A number from 0, `first` or `last`.
    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "first" => Ok(Self::Index(0)),
            "last" => Ok(Self::Last),
            number => number.parse().map(Self::Index).map_err(|_| {
                let near = suggest::question(number, ["first", "last"]);
                format!("`{number}` is no frame: write first, last or a number from 0{near}")
            }),
        }
    }
}

/// Source of radii.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Radii {
    /// The file's; where it has none, van der Waals radii of elements; where it has no elements
    /// either, half of the mean spacing.
    #[default]
    Auto,
    /// The file's, and where it has none, this one, more than 0, in the scene's unit.
    Missing(f64),
    /// This one for all, more than 0, in the scene's unit.
    Constant(f64),
    /// Van der Waals radii of elements (Alvarez 2013).
    VanDerWaals,
    /// Covalent radii of elements (Cordero et al. 2008).
    Covalent,
    /// The numbers of a column, in the file's unit of length.
    Column(String),
}

impl FromStr for Radii {
    type Err = String;

    /// `vdw`, `covalent`, `column:NAME` or a number.
    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.strip_prefix("column:")) {
            ("vdw", _) => Ok(Self::VanDerWaals),
            ("covalent", _) => Ok(Self::Covalent),
            (_, Some(name)) if !name.is_empty() => Ok(Self::Column(name.to_owned())),
            (number, _) => {
                let radius =
                    number.parse().ok().filter(|radius| (0.0..f64::INFINITY).contains(radius));
                radius.filter(|&radius| radius > 0.0).map(Self::Constant).ok_or_else(|| {
                    let near = suggest::question(number, ["vdw", "covalent"]);
                    format!(
                        "`{number}` are no radii: write vdw, covalent, column:NAME or a number of \
                         more than 0{near}"
                    )
                })
            }
        }
    }
}

/// The role of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The position's x.
    X,
    /// The position's y.
    Y,
    /// The position's z.
    Z,
    /// The radius.
    Radius,
    /// Twice the radius.
    Diameter,
    /// The type or element.
    Kind,
    /// The color's red.
    Red,
    /// The color's green.
    Green,
    /// The color's blue.
    Blue,
    /// The name of a material.
    Material,
}

impl Role {
    /// All roles, with the names that commands have for them.
    pub const ALL: [(&'static str, Self); 10] = [
        ("x", Self::X),
        ("y", Self::Y),
        ("z", Self::Z),
        ("radius", Self::Radius),
        ("diameter", Self::Diameter),
        ("type", Self::Kind),
        ("red", Self::Red),
        ("green", Self::Green),
        ("blue", Self::Blue),
        ("material", Self::Material),
    ];
}

/// Which columns of a file are read, by their names in it; columns without a name are called by
/// their numbers, from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// Roles of columns that override those of their names.
    pub roles: Vec<(Role, String)>,
    /// Columns to be kept as [`ParticleFrame::numbers`](super::ParticleFrame::numbers) or
    /// [`texts`](super::ParticleFrame::texts).
    pub kept: Vec<String>,
    /// Columns to be kept likewise where the file has them.
    pub wanted: Vec<String>,
    /// Keeps all other columns too, as long as they hold no more than this many values in all.
    /// Those that are neither numbers nor texts throughout are left out.
    pub rest: Option<usize>,
}

impl FromStr for Columns {
    type Err = String;

    /// Entries with commas between them: `role=name`, or a name alone for a column to be kept.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut columns = Self::default();
        for entry in text.split(',').map(str::trim).filter(|entry| !entry.is_empty()) {
            let Some((role, name)) = entry.split_once('=') else {
                columns.kept.push(entry.to_owned());
                continue;
            };
            let found = Role::ALL.iter().find(|(own, _)| own.eq_ignore_ascii_case(role.trim()));
            let &(_, role) = found.ok_or_else(|| {
                let names = Role::ALL.map(|(name, _)| name);
                let help = suggest::help(role.trim(), names.into_iter(), "roles are");
                format!("`{role}` is no role of a column; {help}")
            })?;
            columns.roles.push((role, name.trim().to_owned()));
        }
        Ok(columns)
    }
}

/// Options for reading a particle file.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// `None`: told from the content.
    pub format: Option<Format>,
    /// Roles of columns, and columns to keep.
    pub columns: Columns,
    /// The frame to read.
    pub frame: FrameChoice,
    /// Source of radii.
    pub radii: Radii,
    /// Factor on all radii, more than 0.
    pub radius_scale: f64,
    /// Factor on the file's positions and radii, more than 0.
    pub scale: f64,
    /// The atom style of a LAMMPS data file, such as `full`; `None`: what the file says, or else
    /// what its columns look like.
    pub atom_style: Option<String>,
    /// True if a frame without any sphere is valid, as among the frames of a trajectory, and not an
    /// error.
    pub allow_empty: bool,
    /// Counts the bytes that are read.
    pub progress: ReadProgress,
}

impl ReadOptions {
    /// Checks that every number is in its range.
    ///
    /// # Errors
    /// A message that names the first that is not, and says what it must be.
    pub fn check(&self) -> Result<(), String> {
        let Self {
            format: _,
            columns: _,
            frame: _,
            radii,
            radius_scale,
            scale,
            atom_style: _,
            allow_empty: _,
            progress: _,
        } = self;
        let radius = match radii {
            Radii::Missing(radius) | Radii::Constant(radius) => Some(*radius),
            Radii::Auto | Radii::VanDerWaals | Radii::Covalent | Radii::Column(_) => None,
        };
        let numbers =
            [("radius_scale", Some(*radius_scale)), ("scale", Some(*scale)), ("radii", radius)];
        let mut numbers = numbers.into_iter().filter_map(|(name, number)| Some((name, number?)));
        let wrong = numbers.find(|(_, number)| !(*number > 0.0 && number.is_finite()));
        wrong.map_or(Ok(()), |(name, number)| {
            Err(format!("`{name}` is {number}, but must be finite and more than 0"))
        })
    }
}

impl Default for ReadOptions {
    fn default() -> Self {
        Self {
            format: None,
            columns: Columns::default(),
            frame: FrameChoice::default(),
            radii: Radii::default(),
            radius_scale: 1.0,
            scale: 1.0,
            atom_style: None,
            allow_empty: false,
            progress: ReadProgress::default(),
        }
    }
}

/// Names of the columns of a property or array that has several: `velocity_x`, `_y` and `_z` of
/// three, or else `stress_1`, `stress_2` and so on.
pub(crate) fn component_names(name: &str, count: usize) -> Vec<String> {
    match count {
        1 => vec![name.to_owned()],
        3 => ["x", "y", "z"].map(|axis| format!("{name}_{axis}")).into(),
        _ => (1..=count).map(|column| format!("{name}_{column}")).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn choices_are_read_from_words() {
        assert_eq!("first".parse(), Ok(FrameChoice::Index(0)));
        assert_eq!("7".parse(), Ok(FrameChoice::Index(7)));
        assert_eq!("last".parse(), Ok(FrameChoice::Last));
        assert!("-1".parse::<FrameChoice>().is_err());
        assert_eq!("vdw".parse(), Ok(Radii::VanDerWaals));
        assert_eq!("column:d".parse(), Ok(Radii::Column("d".to_owned())));
        assert_eq!("0.5".parse(), Ok(Radii::Constant(0.5)));
        for text in ["", "0", "-1", "nan", "inf", "column:", "vdw2"] {
            assert!(text.parse::<Radii>().is_err(), "{text}");
        }
        let columns: Columns = "x=px, TYPE = species,q,vx".parse().expect("columns");
        let roles = [(Role::X, "px".to_owned()), (Role::Kind, "species".to_owned())];
        assert_eq!((columns.roles, columns.kept), (roles.into(), vec!["q".into(), "vx".into()]));
        assert!("width=q".parse::<Columns>().is_err());
        for (name, format) in Format::ALL {
            assert_eq!(format.name(), name);
        }
    }
}
