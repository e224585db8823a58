//! Roles of a file's columns.

use crate::{LengthUnit, Radii, ReadOptions, Role, aliases, suggest, units};
use std::collections::HashSet;
use std::sync::Arc;

/// The use of a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Slot {
    /// Unused.
    Skip,
    /// Coordinate x, y or z, as index 0, 1 or 2.
    Position(usize),
    /// A length, with the factor that converts it to a radius.
    Radius(f64),
    Kind,
    /// Channel red, green or blue, as index 0, 1 or 2.
    Color(usize),
    Material,
    /// One of [`Schema::extras`].
    Extra(usize),
}

/// Rule for converting type names to elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Naming {
    /// Element symbols or atomic numbers.
    Symbols,
    /// Element symbols if all names are; numbers are not elements.
    Types,
    /// Element symbols, or symbols of groups such as `OH2`, as in CIF.
    Groups,
    /// Atom names in molecules.
    Names,
}

/// The uses of all columns of a file.
#[derive(Clone, Debug)]
pub(crate) struct Schema {
    /// Uses of the columns, up to the last used one.
    pub(crate) slots: Vec<Slot>,
    pub(crate) names: Vec<String>,
    /// Names of extra columns to keep.
    pub(crate) extras: Vec<String>,
    /// Number of extra columns that were requested by name. They come first; the others may be dropped.
    pub(crate) asked: usize,
    /// Maximum number of values in extra columns that were not requested by name.
    pub(crate) rest: usize,
    pub(crate) naming: Naming,
    pub(crate) has_color: bool,
    /// Names of the unused columns.
    pub(crate) unused: Vec<String>,
    /// Roles with the names of their columns.
    pub(crate) roles: Vec<(Role, String)>,
    /// The unit of positions, if their names contain it.
    pub(crate) unit: LengthUnit,
}

impl Schema {
    /// Returns the [schema](Self::new) of a file whose types are names of atoms in molecules.
    pub(crate) fn of_atoms(
        names: impl IntoIterator<Item = &'static str>,
        options: &ReadOptions,
    ) -> Result<Arc<Self>, String> {
        let schema = Self::new(names.into_iter().map(str::to_owned).collect(), options)?;
        Ok(Arc::new(Self { naming: Naming::Names, ..schema }))
    }

    /// Assigns roles to columns by their names, ignoring case; the options take precedence.
    ///
    /// # Errors
    ///
    /// A message that names the missing columns.
    pub(crate) fn new(names: Vec<String>, options: &ReadOptions) -> Result<Self, String> {
        Self::with_roles(names, options, &[])
    }

    /// Assigns roles to columns without names, which are then their numbers from 1: the options' roles, or else those
    /// of x, y, z and a radius after `ids` columns.
    pub(crate) fn unnamed(
        columns: usize,
        ids: usize,
        options: &ReadOptions,
    ) -> Result<Self, String> {
        let names: Vec<String> = (1..=columns).map(|column| column.to_string()).collect();
        if !options.columns.roles.is_empty() {
            return Self::new(names, options);
        }
        let roles = [Role::X, Role::Y, Role::Z, Role::Radius].into_iter();
        let known: Vec<_> = roles.zip(names[ids..].iter().map(String::as_str)).collect();
        Self::with_roles(names.clone(), options, &known)
    }

    /// Assigns roles as [`Schema::new`] does, with additional names that the format defines.
    pub(crate) fn with_roles(
        names: Vec<String>,
        options: &ReadOptions,
        known: &[(Role, &str)],
    ) -> Result<Self, String> {
        let choice = Choice { names: &names, options, known };
        let mut slots = vec![Slot::Skip; names.len()];
        let axes = choice.axes()?;
        for (axis, column) in axes.into_iter().enumerate() {
            slots[column] = Slot::Position(axis);
        }
        let [x, y, z] = axes.map(|column| names[column].as_str());
        for axis in [y, z] {
            if units::factor(axis, x)? != 1.0 {
                return Err(format!("`{x}` and `{axis}` are in different units"));
            }
        }
        let unit = units::length(x);
        let mut take = |column: Option<usize>, slot| {
            column.filter(|&at| slots[at] == Slot::Skip).map(|at| slots[at] = slot).is_some()
        };
        for (channel, column) in choice.colors()?.into_iter().flatten().enumerate() {
            take(Some(column), Slot::Color(channel));
        }
        let length = |column: Option<usize>, factor: f64| match column {
            Some(column) => Ok(Slot::Radius(factor * units::factor(&names[column], x)?)),
            None => Ok::<_, String>(Slot::Radius(factor)),
        };
        let radius = choice.find(Role::Radius)?;
        let has_radius = take(radius, length(radius, 1.0)?);
        // `r` together with `g` and `b` is red.
        let radius = choice.position("r");
        let has_radius = has_radius || take(radius, length(radius, 1.0)?);
        let diameter = choice.find(Role::Diameter)?.filter(|_| !has_radius);
        take(diameter, length(diameter, 0.5)?);
        let kind = choice.find(Role::Kind)?;
        take(kind, Slot::Kind);
        take(choice.find(Role::Material)?, Slot::Material);
        let naming = Naming::of(kind.map_or("", |column| &names[column]));
        let mut extras = choice.asked(&mut slots)?;
        let asked = extras.len();
        if options.columns.rest.is_some() {
            choice.add_rest(&mut slots, &mut extras);
        }
        let rest = options.columns.rest.unwrap_or(0);
        let unused = unused(&names, &slots);
        let roles = roles(&names, &slots, if has_radius { Role::Radius } else { Role::Diameter });
        choice.check_roles(&roles)?;
        while slots.last() == Some(&Slot::Skip) {
            slots.pop();
        }
        let has_color = slots.contains(&Slot::Color(0));
        Ok(Self { slots, names, extras, asked, rest, naming, has_color, unused, roles, unit })
    }

    /// Returns the columns with a use other than position, with their indices.
    pub(crate) fn used_columns(&self) -> impl Iterator<Item = (usize, Slot)> {
        let slots = self.slots.iter().copied().enumerate();
        slots.filter(|(_, slot)| !matches!(slot, Slot::Skip | Slot::Position(_)))
    }

    /// Returns the names by which columns can be requested: unique and not empty.
    pub(crate) fn listed(&self) -> Vec<String> {
        let mut listed = HashSet::new();
        let names = self.names.iter().filter(|name| !name.is_empty() && listed.insert(*name));
        names.cloned().collect()
    }

    /// Returns the number of columns that every row must have.
    pub(crate) fn needed_columns(&self) -> usize {
        let needed = |slot: &Slot| match slot {
            Slot::Skip => false,
            Slot::Extra(extra) => *extra < self.asked,
            _ => true,
        };
        self.slots.iter().rposition(needed).map_or(0, |last| last + 1)
    }

    /// Returns whether rows have colors.
    pub(crate) fn has_color(&self) -> bool {
        self.has_color
    }
}

/// Returns the message for a missing column, with the nearest name or a list of all columns.
pub fn unknown_column<'n>(name: &str, columns: impl Iterator<Item = &'n str> + Clone) -> String {
    let mut typed = aliases::typed(columns.clone());
    typed.retain(|other| !other.eq_ignore_ascii_case(name));
    match suggest::nearest(name, typed) {
        Some(near) => format!("no column is named `{name}`; did you mean `{near}`?"),
        None => format!("no column is named `{name}`; there are {}", suggest::list(columns)),
    }
}

impl Naming {
    fn of(column: &str) -> Self {
        let types = ["typelabel", "type", "typeid", "particle type"]
            .iter()
            .any(|name| name.eq_ignore_ascii_case(column));
        if types { Self::Types } else { Self::Symbols }
    }
}

fn unused(names: &[String], slots: &[Slot]) -> Vec<String> {
    let is_unused = |(name, slot): &(&String, &Slot)| **slot == Slot::Skip && !name.is_empty();
    names.iter().zip(slots).filter(is_unused).map(|(name, _)| name.clone()).collect()
}

/// Returns the roles of columns; `size` is the role of a column with radii or diameters.
fn roles(names: &[String], slots: &[Slot], size: Role) -> Vec<(Role, String)> {
    let role = |slot: &Slot| match *slot {
        Slot::Position(axis) => Some([Role::X, Role::Y, Role::Z][axis]),
        Slot::Radius(_) => Some(size),
        Slot::Kind => Some(Role::Kind),
        Slot::Color(channel) => Some([Role::Red, Role::Green, Role::Blue][channel]),
        Slot::Material => Some(Role::Material),
        Slot::Skip | Slot::Extra(_) => None,
    };
    let columns = names.iter().zip(slots);
    columns.filter_map(|(name, slot)| Some((role(slot)?, name.clone()))).collect()
}

/// Assignment of roles to the columns of a file.
struct Choice<'c> {
    names: &'c [String],
    options: &'c ReadOptions,
    known: &'c [(Role, &'c str)],
}

impl Choice<'_> {
    /// Returns the column with a name: an exact match, a match ignoring case, or else the only column
    /// with this name before a unit.
    fn position(&self, wanted: &str) -> Option<usize> {
        let same = self.names.iter().position(|name| name == wanted);
        let any_case = || self.names.iter().position(|name| name.eq_ignore_ascii_case(wanted));
        let with_unit = || {
            let bare = |name: &String| units::split(name).0.eq_ignore_ascii_case(wanted);
            let mut columns = self.names.iter().enumerate().filter(|(_, name)| bare(name));
            columns.next().map(|(column, _)| column).filter(|_| columns.next().is_none())
        };
        same.or_else(any_case).or_else(with_unit)
    }

    /// Returns the column with a name that the user typed, or with a synonym of it.
    fn need(&self, wanted: &str) -> Result<usize, String> {
        let other = || aliases::of(wanted).find_map(|name| self.position(name));
        self.position(wanted).or_else(other).ok_or_else(|| self.missing(wanted))
    }

    fn missing(&self, wanted: &str) -> String {
        unknown_column(wanted, self.names.iter().map(String::as_str))
    }

    /// Returns the column of a role: from the options, the format or the usual names, in this order.
    fn find(&self, role: Role) -> Result<Option<usize>, String> {
        if let (Role::Radius, Radii::Column(name)) = (role, &self.options.radii) {
            return self.need(name).map(Some);
        }
        if let Some((_, name)) = self.options.columns.roles.iter().find(|(own, _)| *own == role) {
            return self.need(name).map(Some);
        }
        let known = self.known.iter().find(|(own, _)| *own == role);
        if let Some(column) = known.and_then(|(_, name)| self.position(name)) {
            return Ok(Some(column));
        }
        Ok(aliases::usual(role).iter().find_map(|name| self.position(name)))
    }

    /// Returns the columns of positions.
    fn axes(&self) -> Result<[usize; 3], String> {
        let axes = [Role::X, Role::Y, Role::Z];
        let is_axis = |(role, _): &(Role, String)| axes.contains(role);
        if self.find(Role::X)?.is_none() && !self.options.columns.roles.iter().any(is_axis) {
            let column = |name: &String| self.position(name);
            let found = aliases::numbered_from_one()
                .find_map(|[x, y, z]| Some([column(&x)?, column(&y)?, column(&z)?]));
            if let Some(found) = found {
                return Ok(found);
            }
        }
        let mut columns = [0; 3];
        for (axis, column) in columns.iter_mut().enumerate() {
            let missing = || self.missing(aliases::USUAL[axis].1[0]);
            *column = self.find(axes[axis])?.ok_or_else(missing)?;
        }
        Ok(columns)
    }

    /// Checks that the columns that the options name have their roles.
    fn check_roles(&self, roles: &[(Role, String)]) -> Result<(), String> {
        let radii = match &self.options.radii {
            Radii::Column(name) => Some((Role::Radius, name.clone())),
            _ => None,
        };
        for (role, typed) in radii.iter().chain(&self.options.columns.roles) {
            let name = &self.names[self.need(typed)?];
            let role_name = role.name();
            let taken = roles.iter().filter(|(_, own)| own == name).map(|(own, _)| *own);
            let others = roles.iter().filter(|(own, _)| own == role).map(|(_, own)| own);
            let lengths = [Role::Radius, Role::Diameter];
            return Err(match (taken.clone().next(), others.clone().next()) {
                _ if taken.clone().any(|own| own == *role) => continue,
                (Some(own), _) => {
                    format!("the column `{name}` cannot be {role_name}, since it is {}", own.name())
                }
                (None, Some(other)) => {
                    format!("{role_name} is the column `{other}`, and cannot be `{name}`, too")
                }
                (None, None) if lengths.contains(role) => {
                    "radius and diameter are given, of which one is enough".to_owned()
                }
                (None, None) => {
                    "colors need the columns of all three of red, green and blue".to_owned()
                }
            });
        }
        Ok(())
    }

    /// Returns the color columns, if all three exist.
    fn colors(&self) -> Result<Option<[usize; 3]>, String> {
        let [red, green, blue] =
            [self.find(Role::Red)?, self.find(Role::Green)?, self.find(Role::Blue)?];
        let long = red.zip(green).zip(blue).map(|((red, green), blue)| [red, green, blue]);
        let short = || {
            let [red, green, blue] = ["r", "g", "b"].map(|name| self.position(name));
            Some([red?, green?, blue?])
        };
        Ok(long.or_else(short))
    }

    /// Returns the names of the requested extra columns and assigns their slots; columns with a role
    /// keep it.
    fn asked(&self, slots: &mut [Slot]) -> Result<Vec<String>, String> {
        let mut extras = Vec::new();
        let columns = &self.options.columns;
        let kept =
            columns.kept.iter().map(|name| self.need(name)).collect::<Result<Vec<_>, _>>()?;
        let wanted = columns.wanted.iter().filter_map(|name| self.position(name));
        for column in kept.into_iter().chain(wanted) {
            if slots[column] == Slot::Skip {
                slots[column] = Slot::Extra(extras.len());
                extras.push(self.names[column].clone());
            }
        }
        Ok(extras)
    }

    /// Adds all other columns with a unique name.
    fn add_rest(&self, slots: &mut [Slot], extras: &mut Vec<String>) {
        let mut listed = HashSet::new();
        for (column, name) in self.names.iter().enumerate() {
            let is_first = !name.is_empty() && listed.insert(name);
            if is_first && slots[column] == Slot::Skip {
                slots[column] = Slot::Extra(extras.len());
                extras.push(name.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::options::Columns;

    fn schema(names: &str, columns: &str) -> Result<Schema, String> {
        let columns = columns.parse()?;
        let options = ReadOptions { columns, ..ReadOptions::default() };
        Schema::new(names.split(',').map(str::to_owned).collect(), &options)
    }

    fn slots(names: &str, columns: &str) -> Vec<Slot> {
        schema(names, columns).expect("columns").slots
    }

    #[test]
    fn names_determine_columns() {
        use Slot::{Color, Extra, Kind, Material, Position, Radius, Skip};
        let [x, y, z] = [0, 1, 2].map(Position);
        let [red, green, blue] = [0, 1, 2].map(Color);
        assert_eq!(slots("Z,y,X,R,id", ""), [z, y, x, Radius(1.0)]);
        assert_eq!(slots("x,y,z,r,g,b,diameter", ""), [x, y, z, red, green, blue, Radius(0.5)]);
        assert_eq!(slots("x,y,z,r,b,radius", ""), [x, y, z, Skip, Skip, Radius(1.0)]);
        assert_eq!(slots("x,y,z,red,green,blue,r", "")[6], Radius(1.0));
        assert_eq!(slots("x,y,z,diameter,radius", ""), [x, y, z, Skip, Radius(1.0)]);
        assert_eq!(slots("id,type,element,x,y,z", ""), [Skip, Skip, Kind, x, y, z]);
        assert_eq!(slots("x,y,z,material", "")[3], Material);
        assert_eq!(slots("px,py,pz,q,w", "x=px,y=py,z=pz,w,q"), [x, y, z, Extra(1), Extra(0)]);
    }

    #[test]
    fn missing_columns_are_reported() {
        let missing = schema("x,y", "").expect_err("no z");
        assert_eq!(missing, "no column is named `z`; there are x, y");
        assert!(schema("x,y,z", "q").is_err());
        assert!(schema("x,y,z", "type=q").is_err());
        assert_eq!(schema("x,y,z,id", "").map(|schema| schema.unused), Ok(vec!["id".to_owned()]));
    }

    #[test]
    fn rows_may_lack_columns_that_are_not_needed() {
        let needed = |names: &str, columns: &str, rest| {
            let columns = columns.parse().expect("columns");
            let options =
                ReadOptions { columns: Columns { rest, ..columns }, ..ReadOptions::default() };
            let names = names.split(',').map(str::to_owned).collect();
            Schema::new(names, &options).expect("columns").needed_columns()
        };
        for (names, columns, rest, expected) in [
            ("x,y,z,q,a,b", "q", Some(100), 4),
            ("x,y,z,a,q,b", "q", Some(100), 5),
            ("x,y,z,,a", "", Some(100), 3),
            ("x,y,z,a,radius", "", None, 5),
            ("x,y,z,a,b", "", None, 3),
        ] {
            assert_eq!(needed(names, columns, rest), expected, "{names}");
        }
    }

    #[test]
    fn numbers_of_types_are_not_elements() {
        let naming = |names| schema(names, "").map(|schema| schema.naming);
        assert_eq!(naming("x,y,z,type"), Ok(Naming::Types));
        assert_eq!(naming("x,y,z,species"), Ok(Naming::Symbols));
    }
}
