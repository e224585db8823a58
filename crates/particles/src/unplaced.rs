//! Atoms of topologies, which have no positions: those of the frame are NaN.

use crate::naming::{self, Weighing};
use crate::schema::{Schema, Slot};
use crate::{
    Element, ElementSource, Format, Kind, ParticleFrame, ReadOptions, builder::Builder, number,
};
use std::path::Path;
use std::sync::Arc;

/// Columns of texts, even if the texts look like numbers.
const TEXTS: [&str; 6] = ["number", "segment", "residue_number", "residue", "name", "atom_type"];

/// Columns of numbers.
const NUMBERS: [&str; 2] = ["charge", "mass"];

/// Returns the schema of the columns of a file, and of positions after them.
pub(crate) fn schema(
    names: impl IntoIterator<Item = &'static str>,
    options: &ReadOptions,
) -> Result<Arc<Schema>, String> {
    Schema::of_atoms(names.into_iter().chain(["x", "y", "z"]), options)
}

/// A frame of atoms without positions, under construction.
pub(crate) struct UnplacedAtoms {
    pub(crate) builder: Builder,
    weighing: Weighing,
    /// True if the user names the column of types, from which elements do not follow otherwise.
    has_kind: bool,
}

impl UnplacedAtoms {
    pub(crate) fn new(path: &Arc<Path>, format: Format, schema: &Arc<Schema>) -> Self {
        let mut builder = Builder::new(path, format, schema);
        builder.declare(&TEXTS, &NUMBERS);
        let has_kind = schema.slots.contains(&Slot::Kind);
        Self { builder, weighing: Weighing::default(), has_kind }
    }

    /// Appends the type of an atom by its atomic number and its mass, of which each may be blank, its name and its residue.
    pub(crate) fn kind(&mut self, number: &[u8], mass: &[u8], name: &[u8], residue: &[u8]) {
        if !self.has_kind {
            let weighing = &mut self.weighing;
            let key = [number, mass, name, residue].join(&b' ');
            self.builder.kind_of(&key, |key| kind(key, weighing));
        }
    }

    pub(crate) fn finish(self) -> ParticleFrame {
        let mut frame = self.builder.finish();
        self.weighing.warn(&mut frame);
        frame
    }
}

/// Returns the type for the atomic number, mass, name and residue of an atom, separated by blanks.
fn kind(key: &str, weighing: &mut Weighing) -> Kind {
    let mut parts = key.split(' ');
    let mut part = || parts.next().unwrap_or_default();
    let (number, mass, name, residue) = (part(), part(), part(), part());
    let named = naming::of_atom(name, residue);
    match (number.parse(), number::parse(mass.as_bytes())) {
        // Extra points; what AMBER does not know has -1.
        (Ok(0), _) => Kind { element: None, virtual_site: true, ..named },
        (Ok(number), _) => {
            Kind { element: Element::from_number(number), source: ElementSource::Number, ..named }
        }
        (_, Some(mass)) => weighing.weigh(named, name, mass),
        _ => named,
    }
}
