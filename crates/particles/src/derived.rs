//! Columns that follow from neighbors: `coordination`, the number of bonds or of neighbors, and `cluster`, the
//! connected component, numbered by size.

use crate::{
    BondRules, BondSource, Bonds, NumberColumn, ParticleFrame, ReadOptions, bonds::from_distance,
};

/// Names of the columns.
const NAMES: [&str; 2] = ["coordination", "cluster"];

/// A column that was asked for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Derived {
    /// The name as it was asked for, such as `cluster` or `coordination[3.2]`.
    name: String,
    is_cluster: bool,
    /// Distance below which particles are neighbors; `None`: bonded ones are.
    within: Option<f64>,
}

impl Derived {
    /// Returns the column of a name, if it is one.
    fn named(name: &str) -> Option<Self> {
        let (start, within) = match name.strip_suffix(']').and_then(|name| name.split_once('[')) {
            Some((start, length)) => {
                let length = length.parse().ok().filter(|length| (0.0..f64::MAX).contains(length));
                (start, Some(length?))
            }
            None => (name, None),
        };
        let which = NAMES.iter().position(|own| own.eq_ignore_ascii_case(start))?;
        Some(Self { name: name.to_owned(), is_cluster: which == 1, within })
    }

    /// Returns the columns that are asked for, and the options for the reader, which keep a column of the file
    /// with such a name.
    pub(crate) fn take(options: &ReadOptions) -> (Vec<Self>, ReadOptions) {
        let mut options = options.clone();
        let columns = &mut options.columns;
        let (derived, kept) = std::mem::take(&mut columns.kept)
            .into_iter()
            .partition(|name| Self::named(name).is_some());
        columns.kept = kept;
        columns.wanted.extend::<Vec<String>>(derived);
        let mut derived: Vec<Self> =
            columns.wanted.iter().filter_map(|name| Self::named(name)).collect();
        derived.dedup();
        let needs_bonds = derived.iter().any(|column| column.within.is_none());
        if needs_bonds {
            options.bonds = options.bonds.for_all();
        }
        (derived, options)
    }

    /// Adds the column to a frame, unless the file has it.
    pub(crate) fn add(&self, frame: &mut ParticleFrame) -> Result<(), String> {
        let Self { name, is_cluster, within } = self;
        let numbers = frame.numbers.iter().map(|column| &column.name);
        let mut names = numbers.chain(frame.texts.iter().map(|column| &column.name));
        if names.any(|own| own.eq_ignore_ascii_case(name)) || frame.is_empty() {
            return Ok(());
        }
        let found: Bonds;
        let bonds = match (within, &frame.bonds) {
            (Some(length), _) => {
                found = from_distance(frame, &BondRules::within(*length))?;
                &found
            }
            (None, Some(bonds)) => bonds,
            (None, None) => {
                return Err(format!(
                    "has neither bonds nor elements for the column `{name}`; write `{name}[3.2]` for \
                     neighbors closer than 3.2"
                ));
            }
        };
        let count = frame.len();
        let values = if *is_cluster { bonds.clusters(count) } else { bonds.degrees(count) };
        let values = values.into_iter().map(f64::from).collect();
        frame.numbers.push(NumberColumn { name: name.clone(), values });
        Ok(())
    }
}

impl ParticleFrame {
    /// Adds those of the named columns that follow from neighbors, `coordination` and `cluster`, as reading a file with
    /// [`Columns::wanted`](super::Columns::wanted) does. Bonds that they need come from `source`, or from
    /// [`BondSource::Auto`] where that finds none.
    ///
    /// # Errors
    ///
    /// A message, as for [`find_bonds`](Self::find_bonds); or there are neither bonds nor elements to find them by.
    pub fn add_derived_columns(
        &mut self,
        names: &[String],
        source: &BondSource,
    ) -> Result<(), String> {
        let derived: Vec<Derived> = names.iter().filter_map(|name| Derived::named(name)).collect();
        if derived.iter().any(|column| column.within.is_none()) {
            self.find_bonds(&source.for_all())?;
        }
        derived.iter().try_for_each(|column| column.add(self))
    }
}
