//! Options of readers: columns, frame, radii.

use crate::{AlignBy, BondSource, Element, Format, ReadProgress, Role, suggest};
use std::path::PathBuf;
use std::str::FromStr;

/// Choice of a frame in a file with several.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FrameChoice {
    /// Frame with this index; the first is 0, as in OVITO.
    Index(u64),
    /// The last frame.
    Last,
}

impl Default for FrameChoice {
    fn default() -> Self {
        Self::Index(0)
    }
}

impl FromStr for FrameChoice {
    type Err = String;

    /// Parses an index from 0, `first` or `last`.
    fn from_str(text: &str) -> Result<Self, String> {
        match text {
            "first" => Ok(Self::Index(0)),
            "last" => Ok(Self::Last),
            number => number.parse().map(Self::Index).map_err(|_| {
                let near = suggest::question(number, ["first", "last"]);
                format!("invalid frame `{number}`: expected first, last or a number from 0{near}")
            }),
        }
    }
}

/// Source of radii.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Radii {
    /// Radii in the file; without them, van der Waals radii of elements; without elements, half of
    /// the mean spacing.
    #[default]
    Auto,
    /// Radii in the file; without them, this positive radius in the scene's unit.
    Missing(f64),
    /// This positive radius for all particles, in the scene's unit.
    Constant(f64),
    /// Van der Waals radii of elements (Alvarez 2013).
    VanDerWaals,
    /// Covalent radii of elements (Cordero et al. 2008).
    Covalent,
    /// Effective ionic radii of elements at a coordination of 6 in their commonest states of oxidation (Shannon 1976);
    /// covalent radii of elements without one.
    Ionic,
    /// Values of a column, in the file's unit of length.
    Column(String),
    /// Values of an expression over columns, in the file's unit of length, which the conversion to spheres evaluates;
    /// frames have the radii of the file.
    Expression(String),
}

impl FromStr for Radii {
    type Err = String;

    /// Parses `vdw`, `covalent`, `ionic`, `column:NAME` or a number.
    fn from_str(text: &str) -> Result<Self, String> {
        match (text, text.strip_prefix("column:")) {
            ("vdw", _) => Ok(Self::VanDerWaals),
            ("covalent", _) => Ok(Self::Covalent),
            ("ionic", _) => Ok(Self::Ionic),
            (_, Some(name)) if !name.is_empty() => Ok(Self::Column(name.to_owned())),
            (number, _) => {
                let radius =
                    number.parse().ok().filter(|radius| (0.0..f64::INFINITY).contains(radius));
                radius.filter(|&radius| radius > 0.0).map(Self::Constant).ok_or_else(|| {
                    let near = suggest::question(number, ["vdw", "covalent", "ionic"]);
                    format!(
                        "invalid radii `{number}`: expected vdw, covalent, ionic, column:NAME or \
                         a positive number{near}"
                    )
                })
            }
        }
    }
}

/// Selection of the columns to read, by their names in the file. Unnamed columns are numbered from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Columns {
    /// Roles of columns, which override those that their names imply.
    pub roles: Vec<(Role, String)>,
    /// Columns to keep as [`ParticleFrame::numbers`](super::ParticleFrame::numbers) or
    /// [`texts`](super::ParticleFrame::texts). A missing one is an error.
    pub kept: Vec<String>,
    /// Columns to keep if the file has them.
    pub wanted: Vec<String>,
    /// If set, keeps all other columns too, as long as they hold at most this many values in total.
    /// Columns that mix numbers and texts are dropped.
    pub rest: Option<usize>,
}

impl FromStr for Columns {
    type Err = String;

    /// Parses comma-separated entries: `role=name`, or just a name for a column to keep.
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
                format!("unknown column role `{role}`; {help}")
            })?;
            columns.roles.push((role, name.trim().to_owned()));
        }
        Ok(columns)
    }
}

/// Options for reading a particle file.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    /// Format of the file; `None`: detected from the content.
    pub format: Option<Format>,
    /// Roles of columns, and columns to keep.
    pub columns: Columns,
    /// The frame to read.
    pub frame: FrameChoice,
    /// Source of radii.
    pub radii: Radii,
    /// Positive factor on all radii.
    pub radius_scale: f64,
    /// Positive factor on positions and radii of the file.
    pub scale: f64,
    /// The atom style of a LAMMPS data file, such as `full`; `None`: as the file declares it, or else
    /// inferred from the columns.
    pub atom_style: Option<String>,
    /// The file that says what the particles of a trajectory are: all that its first frame has but
    /// positions, velocities, forces and the cell.
    pub topology: Option<PathBuf>,
    /// Elements of types, by their names, instead of those of the file.
    pub elements: Vec<(String, Element)>,
    /// Source of bonds; they are read or found only if they are asked for.
    pub bonds: BondSource,
    /// True if molecules are made whole: no bond crosses the periodic cell.
    pub whole: bool,
    /// Number of frames before and after each one whose positions are averaged.
    pub smooth: u32,
    /// Number of frames before each one whose positions it has as [`Trails`](crate::Trails).
    pub trail: u32,
    /// The particles by which each frame is superposed on the first one; `None`: frames stay where they are.
    pub align: Option<AlignBy>,
    /// True if a frame without spheres is valid, as in a trajectory, and not an error.
    pub allow_empty: bool,
    /// Counter of the bytes read.
    pub progress: ReadProgress,
}

impl ReadOptions {
    /// Returns whether bonds that the file lists are read.
    pub(crate) fn reads_bonds(&self) -> bool {
        self.bonds.reads_file()
    }

    /// Checks that every number is in range.
    ///
    /// # Errors
    /// A message that names the first number out of range and the valid range.
    pub fn check(&self) -> Result<(), String> {
        let Self {
            format: _,
            columns: _,
            frame: _,
            radii,
            radius_scale,
            scale,
            atom_style: _,
            topology: _,
            elements: _,
            bonds: _,
            whole: _,
            smooth: _,
            trail: _,
            align: _,
            allow_empty: _,
            progress: _,
        } = self;
        let radius = match radii {
            Radii::Missing(radius) | Radii::Constant(radius) => Some(*radius),
            Radii::Auto
            | Radii::VanDerWaals
            | Radii::Covalent
            | Radii::Ionic
            | Radii::Column(_)
            | Radii::Expression(_) => None,
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
            topology: None,
            elements: Vec::new(),
            bonds: BondSource::None,
            whole: false,
            smooth: 0,
            trail: 0,
            align: None,
            allow_empty: false,
            progress: ReadProgress::default(),
        }
    }
}

/// Returns the column names of a property or array with several components: `velocity_x`, `_y` and
/// `_z` for three components, otherwise `stress_1`, `stress_2` and so on.
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
        assert_eq!("ionic".parse(), Ok(Radii::Ionic));
        assert_eq!("column:d".parse(), Ok(Radii::Column("d".to_owned())));
        assert_eq!("0.5".parse(), Ok(Radii::Constant(0.5)));
        for text in ["", "0", "-1", "nan", "inf", "column:", "vdw2"] {
            assert!(text.parse::<Radii>().is_err(), "{text}");
        }
        let columns: Columns = "x=px, TYPE = species,q,vx".parse().expect("columns");
        let roles = [(Role::X, "px".to_owned()), (Role::Kind, "species".to_owned())];
        assert_eq!((columns.roles, columns.kept), (roles.into(), vec!["q".into(), "vx".into()]));
        assert!("width=q".parse::<Columns>().is_err());
    }
}
