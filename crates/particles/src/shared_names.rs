//! Common tables of types and texts for all frames of a file.

use crate::{Codes, Kind, Kinds, ParticleFrame};
use std::collections::HashMap;
use std::hash::Hash;

/// Types and texts of several frames of a file, in order of first occurrence.
///
/// A frame lists its names in the order of its rows, which may differ between frames, and category
/// colors follow that order. A common table gives the same name the same color in all frames.
#[derive(Clone, Debug, Default)]
pub struct SharedNames {
    kinds: Table<Kind>,
    /// Types with an element, by name.
    elements: HashMap<String, Kind>,
    materials: Table<String>,
    /// Tables of text columns, by column name.
    texts: HashMap<String, Table<String>>,
}

impl SharedNames {
    /// Adds the names of a frame, and replaces the frame's tables by the common ones.
    pub fn intern(&mut self, frame: &mut ParticleFrame) {
        self.unify_elements(&mut frame.kinds);
        self.kinds.intern(&mut frame.kinds.table, &mut frame.kinds.codes);
        self.materials.intern(&mut frame.materials.names, &mut frame.materials.codes);
        for column in &mut frame.texts {
            let table = self.texts.entry(column.name.clone()).or_default();
            table.intern(&mut column.names, &mut column.codes);
        }
    }

    /// Returns the types of all frames so far.
    pub fn kinds(&self) -> &[Kind] {
        &self.kinds.names
    }

    /// Sets elements of types that have one in another frame: whether names are read as elements depends
    /// on all names of a frame.
    fn unify_elements(&mut self, kinds: &mut Kinds) {
        for kind in &mut kinds.table {
            if kind.element.is_some() {
                self.elements.entry(kind.name.clone()).or_insert_with(|| kind.clone());
            } else if let Some(known) = self.elements.get(&kind.name) {
                *kind = known.clone();
            }
        }
    }
}

/// Names in order of index, and indices by name.
#[derive(Clone, Debug)]
struct Table<T> {
    names: Vec<T>,
    places: HashMap<T, u32>,
}

impl<T> Default for Table<T> {
    fn default() -> Self {
        Self { names: Vec::new(), places: HashMap::new() }
    }
}

impl<T: Clone + Eq + Hash> Table<T> {
    /// Adds a frame's names, and replaces them by those of the table.
    fn intern(&mut self, own: &mut Vec<T>, codes: &mut Codes) {
        if codes.is_empty() {
            return;
        }
        let places: Vec<u32> = own.iter().map(|name| self.place(name)).collect();
        if !(0..).zip(&places).all(|(row, &place)| row == place) {
            codes.renumber(&places);
        }
        own.clone_from(&self.names);
    }

    fn place(&mut self, name: &T) -> u32 {
        if let Some(&place) = self.places.get(name) {
            return place;
        }
        let place = self.names.len() as u32;
        self.names.push(name.clone());
        self.places.insert(name.clone(), place);
        place
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::categories::TextColumn;
    use crate::element::Element;

    fn frame(kinds: &[(&str, Option<&str>)], texts: &[&str]) -> ParticleFrame {
        let mut frame = ParticleFrame::default();
        for (row, (name, element)) in kinds.iter().enumerate() {
            let element = element.and_then(Element::from_label);
            let name = (*name).to_owned();
            frame.kinds.table.push(Kind { name, element, ..Kind::default() });
            frame.kinds.codes.push(row as u32);
        }
        let mut column = TextColumn { name: "chain".to_owned(), ..TextColumn::default() };
        for (row, name) in texts.iter().enumerate() {
            column.names.push((*name).to_owned());
            column.codes.push(row as u32);
        }
        frame.texts.push(column);
        frame
    }

    #[test]
    fn names_are_in_order_of_first_occurrence() {
        let mut names = SharedNames::default();
        let mut first = frame(&[("A", None), ("B", None)], &["x"]);
        let before = first.clone();
        names.intern(&mut first);
        assert_eq!(first, before);
        let mut second = frame(&[("C", None), ("B", None)], &["y", "x"]);
        names.intern(&mut second);
        let listed: Vec<&str> = second.kinds.table.iter().map(|kind| kind.name.as_str()).collect();
        assert_eq!(listed, ["A", "B", "C"]);
        assert_eq!(second.kinds.codes, Codes::Bytes(vec![2, 1]));
        assert_eq!(second.texts[0].names, ["x", "y"]);
        assert_eq!(second.texts[0].codes, Codes::Bytes(vec![1, 0]));
        // Frames without particles have no types.
        let mut empty = frame(&[], &[]);
        names.intern(&mut empty);
        assert!(empty.kinds.table.is_empty() && empty.texts[0].names.is_empty());
    }

    #[test]
    fn elements_are_those_of_any_frame() {
        let mut names = SharedNames::default();
        names.intern(&mut frame(&[("X", None), ("C", None)], &[]));
        names.intern(&mut frame(&[("C", Some("C"))], &[]));
        let mut again = frame(&[("X", None), ("C", None)], &[]);
        names.intern(&mut again);
        let kind = |row: usize| again.kinds.kind(row).expect("a type");
        assert_eq!((kind(0).name.as_str(), kind(0).element), ("X", None));
        assert_eq!((kind(1).name.as_str(), kind(1).element), ("C", Element::from_label("C")));
    }
}
