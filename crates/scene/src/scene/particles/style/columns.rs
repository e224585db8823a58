//! Columns by name: those of the file, and those that all particles have.

use crate::scene::particles::Particles;
use crate::scene::particles::{Codes, Kind};
use crate::scene::particles::{NumberColumn, Role};
use crate::scene::{FileError, Rgb};
use crate::suggest;
use spherule_particles::internals::aliases;
use spherule_particles::internals::unknown_column;
use std::borrow::Cow;
use std::path::Path;

/// Name of the column of particle numbers: the file's, or else the index, from 0.
const ID: &str = "id";

/// Name of the column of indices in the file, from 0.
const INDEX: &str = "index";

/// Names with a meaning in every file, in addition to [`ID`] and [`ELEMENT`].
const COMMON: [(&str, Role); 5] = [
    ("x", Role::X),
    ("y", Role::Y),
    ("z", Role::Z),
    ("radius", Role::Radius),
    ("type", Role::Kind),
];

/// Name of the length of velocities, and the columns of their components.
const SPEED: (&str, [&str; 3]) = ("speed", ["vx", "vy", "vz"]);

/// Name of the column of elements, or of types that are not elements.
const ELEMENT: &str = "element";

/// The values of a column, one row per sphere.
#[derive(Debug)]
pub(in super::super) enum Column<'p> {
    /// NaN for missing values.
    Numbers(Cow<'p, [f64]>),
    /// Each row is the index of its text in `names`.
    Texts { names: Vec<&'p str>, codes: Cow<'p, Codes> },
}

/// Values of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues {
    /// NaN for missing values.
    Numbers(Vec<f64>),
    /// Texts.
    Texts(Vec<String>),
}

impl Particles {
    /// Returns whether particles can be colored by a column of this name: one that was kept, one
    /// with a role, or one that all particles have.
    pub fn can_color_by(&self, name: &str) -> bool {
        [ID, INDEX].contains(&name)
            || Column::find(self, name).is_some_and(|column| column.has_values())
    }

    /// Returns the center of the first particle with this number in the column of ids; `None` if there is
    /// none, or if ids were not read ([`ParticleStyle::also_read`](super::super::ParticleStyle::also_read)).
    pub fn position_of(&self, id: f64) -> Option<glam::DVec3> {
        let row = match Column::find(self, ID)? {
            Column::Numbers(ids) => ids.iter().position(|own| *own == id)?,
            // Serial numbers of PDB files may have letters.
            Column::Texts { names, codes } => {
                let is_id = |name: &&str| name.trim().parse() == Ok(id);
                let named: Vec<bool> = names.iter().map(is_id).collect();
                (0..codes.len()).find(|&row| named[codes.code(row) as usize])?
            }
        };
        Some(self.spheres.center(row))
    }

    /// Returns the values of a column for these rows; `None` if there is no column of this name that was kept.
    pub fn column_values(&self, name: &str, rows: &[usize]) -> Option<ColumnValues> {
        Some(match Column::find(self, name)?.of_rows(rows) {
            Column::Numbers(values) => ColumnValues::Numbers(values.into_owned()),
            Column::Texts { names, codes } => {
                let text = |row| names.get(codes.code(row) as usize).copied().unwrap_or_default();
                ColumnValues::Texts((0..rows.len()).map(|row| text(row).to_owned()).collect())
            }
        })
    }

    /// Names of the columns that particles can have: those of the file, and those of all particles.
    pub fn column_names(&self) -> Vec<String> {
        let own = [ID, INDEX, ELEMENT].into_iter().chain(COMMON.map(|(name, _)| name));
        let frame = &self.frame;
        let kept = frame.numbers.iter().map(|column| &column.name);
        let kept = kept.chain(frame.texts.iter().map(|column| &column.name));
        let mut names: Vec<String> = frame.columns.iter().chain(kept).cloned().collect();
        names.extend(own.map(str::to_owned));
        names.retain(|name| !name.starts_with('\0'));
        names.sort_unstable();
        names.dedup();
        names
    }
}

impl<'p> Column<'p> {
    /// Finds a column by name: one that was kept, one with a role, or one that all particles have.
    /// Exact names are preferred to names in another case, and these to other names of the same
    /// quantity.
    pub(in super::super) fn find(particles: &'p Particles, name: &str) -> Option<Self> {
        let any_case = |name: &str| Self::of(particles, |own| own.eq_ignore_ascii_case(name));
        Self::of(particles, |own| own == name)
            .or_else(|| any_case(name))
            .or_else(|| aliases::of(name).find_map(any_case))
            .or_else(|| {
                if name.eq_ignore_ascii_case(SPEED.0) { Self::of_speeds(particles) } else { None }
            })
    }

    /// The lengths of velocities whose components the file has.
    fn of_speeds(particles: &'p Particles) -> Option<Self> {
        let [x, y, z] = SPEED.1.map(|name| match Self::find(particles, name) {
            Some(Self::Numbers(values)) => Some(values),
            Some(Self::Texts { .. }) | None => None,
        });
        let (x, y, z) = (x?, y?, z?);
        let speeds = x.iter().zip(&*y).zip(&*z).map(|((x, y), z)| (x * x + y * y + z * z).sqrt());
        Some(Self::Numbers(speeds.collect()))
    }

    fn of(particles: &'p Particles, named: impl Fn(&str) -> bool) -> Option<Self> {
        if let Some(column) = particles.frame.numbers.iter().find(|column| named(&column.name)) {
            return Some(Self::Numbers(Cow::Borrowed(&column.values)));
        }
        if let Some(column) = particles.frame.texts.iter().find(|column| named(&column.name)) {
            let names = column.names.iter().map(String::as_str).collect();
            return Some(Self::Texts { names, codes: Cow::Borrowed(&column.codes) });
        }
        let role =
            particles.frame.roles.iter().find(|(_, name)| named(name)).map(|(role, _)| *role);
        let common = || COMMON.iter().find(|(name, _)| named(name)).map(|(_, role)| *role);
        match role.or_else(common) {
            Some(role) => Self::of_role(particles, role),
            None if named(ELEMENT) => Self::of_kinds(particles, |kind| match kind.element {
                Some(element) => element.symbol(),
                None => &kind.name,
            }),
            None => None,
        }
    }

    fn of_role(particles: &'p Particles, role: Role) -> Option<Self> {
        let spheres = &particles.spheres;
        let column = match role {
            Role::X => &spheres.x,
            Role::Y => &spheres.y,
            Role::Z => &spheres.z,
            Role::Radius => &spheres.radius,
            Role::Diameter => {
                let diameter = spheres.radius.iter().map(|radius| 2.0 * radius);
                return Some(Self::Numbers(diameter.collect()));
            }
            Role::Kind => return Self::of_kinds(particles, |kind| &kind.name),
            Role::Red => return Some(Self::of_channel(particles, |color| color.x)),
            Role::Green => return Some(Self::of_channel(particles, |color| color.y)),
            Role::Blue => return Some(Self::of_channel(particles, |color| color.z)),
            Role::Material => return Some(Self::of_materials(particles)),
        };
        Some(Self::Numbers(Cow::Borrowed(column)))
    }

    fn of_kinds(particles: &'p Particles, name: impl Fn(&'p Kind) -> &'p str) -> Option<Self> {
        let kinds = &particles.frame.kinds;
        let names = kinds.table.iter().map(name).collect();
        let codes = Cow::Borrowed(&kinds.codes);
        (!kinds.codes.is_empty()).then_some(Self::Texts { names, codes })
    }

    fn of_channel(particles: &'p Particles, channel: impl Fn(Rgb) -> f32) -> Self {
        let spheres = &particles.spheres;
        let values = (0..spheres.len()).map(|row| f64::from(channel(spheres.color_of(row))));
        Self::Numbers(values.collect())
    }

    fn of_materials(particles: &'p Particles) -> Self {
        let (spheres, names) = (&particles.spheres, &particles.material_names);
        let codes = (0..spheres.len()).map(|row| spheres.material_of(row)).collect();
        let names = names.iter().map(String::as_str).collect();
        Self::Texts { names, codes: Cow::Owned(Codes::Words(codes)) }
    }

    /// Returns the values of these rows.
    pub(super) fn of_rows(self, rows: &[usize]) -> Self {
        match self {
            Self::Numbers(values) => {
                Self::Numbers(rows.iter().map(|&row| values[row]).collect::<Vec<_>>().into())
            }
            Self::Texts { names, codes } => {
                let codes = Codes::Words(rows.iter().map(|&row| codes.code(row)).collect());
                Self::Texts { names, codes: Cow::Owned(codes) }
            }
        }
    }

    /// Returns whether any row has a value.
    pub(in super::super) fn has_values(&self) -> bool {
        match self {
            Self::Numbers(values) => values.iter().any(|value| value.is_finite()),
            Self::Texts { codes, .. } => !codes.is_empty(),
        }
    }
}

/// Returns the names of all columns.
fn names(particles: &Particles) -> Vec<&str> {
    let mut names: Vec<&str> = particles.frame.columns.iter().map(String::as_str).collect();
    let has_kinds = !particles.frame.kinds.codes.is_empty();
    let common = COMMON.iter().filter(|(_, role)| has_kinds || *role != Role::Kind);
    let common = common.map(|(name, _)| *name).chain([ID, INDEX]);
    for name in common.chain(has_kinds.then_some(ELEMENT)) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// Returns a message that no column has this name, with the names of those that exist.
pub(in super::super) fn unknown(particles: &Particles, name: &str) -> String {
    unknown_column(name, names(particles).into_iter())
}

/// Returns the name of a column that is nearly this one.
pub(in super::super) fn nearest<'p>(particles: &'p Particles, name: &str) -> Option<&'p str> {
    suggest::nearest(name, names(particles))
}

/// Returns the error for a column that does not exist, with the names of those that do.
pub(in super::super) fn missing(path: &Path, particles: &Particles, name: &str) -> FileError {
    FileError::whole_file(path, unknown(particles, name))
}

/// Returns names of columns with those that the same quantities have in other programs, or that they are computed from.
pub(in super::super) fn with_synonyms(mut columns: Vec<String>) -> Vec<String> {
    if columns.iter().any(|name| name.eq_ignore_ascii_case(SPEED.0)) {
        columns.extend(SPEED.1.map(str::to_owned));
    }
    for at in 0..columns.len() {
        let others = aliases::of(&columns[at]).map(str::to_owned).collect::<Vec<_>>();
        columns.extend(others);
    }
    columns
}

/// Adds the columns of ids and indices, if they are asked for and missing, before rows are dropped.
pub(in super::super) fn add_numbers(particles: &mut Particles, names: &[String]) {
    for own in [ID, INDEX] {
        let names_column = |name: &String| {
            name.eq_ignore_ascii_case(own)
                || aliases::of(own).any(|other| other.eq_ignore_ascii_case(name))
        };
        if names.iter().any(names_column) && Column::find(particles, own).is_none() {
            let values = (0..particles.spheres.len()).map(|row| row as f64).collect();
            particles.frame.numbers.push(NumberColumn { name: own.to_owned(), values });
        }
    }
}
