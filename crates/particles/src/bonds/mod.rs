//! Bonds between the particles of a frame: those of the file, or those found by distance.

mod bridges;
mod components;
mod distance;
mod images;
mod listed;
mod rules;

pub use crate::frame::Bonds;
pub(crate) use crate::frame::{Bond, ordered};
pub(crate) use components::Adjacency;
pub use components::Molecule;
pub use distance::from_distance;
pub use images::nearest_image;
pub(crate) use listed::{End, Listed, Numbering, row_from_one};
pub use rules::{BondRules, BondSource, PairRule};

use crate::frame::ParticleFrame;

impl ParticleFrame {
    /// Finds the bonds that a source asks for: those of the file stay as they are, others are found by
    /// distance. Bonds of the file get their shifts by the nearest images, and a warning counts those that end at no
    /// particle, or at one of several.
    ///
    /// # Errors
    ///
    /// A message: the file has no bonds although only those are asked for, a rule names no type of the frame,
    /// or there are too many neighbors.
    pub fn find_bonds(&mut self, source: &BondSource) -> Result<(), String> {
        if let Some(bonds) = &mut self.bonds
            && bonds.shift.is_empty()
            && let Some(cell) = &self.cell
        {
            let far = bonds.find_images([&self.x, &self.y, &self.z], cell);
            if far > 0 {
                self.warnings.push(format!("{far} bonds of more than 127 cells are left out"));
            }
        }
        match source {
            BondSource::None => self.bonds = None,
            BondSource::OfCrystals if !self.is_crystal() => self.bonds = None,
            BondSource::File if self.bonds.is_none() && !self.is_empty() => {
                return Err("has no bonds in it; `auto` finds them by distance".to_owned());
            }
            BondSource::File => (),
            BondSource::Rules(rules) => self.bonds = Some(from_distance(self, rules)?),
            BondSource::Auto | BondSource::OfCrystals => {
                let has_elements = self.kinds.table.iter().any(|kind| kind.element.is_some());
                let needs =
                    self.bonds.as_ref().is_none_or(|bonds| bonds.partial || bonds.is_empty());
                if needs && has_elements {
                    let by_distance = from_distance(self, &BondRules::covalent())?;
                    match &mut self.bonds {
                        Some(bonds) => bonds.add(&by_distance),
                        None => self.bonds = Some(by_distance),
                    }
                }
            }
        }
        let Some(bonds) = &mut self.bonds else { return Ok(()) };
        let [dangling, ambiguous] = [&mut bonds.dangling, &mut bonds.ambiguous].map(std::mem::take);
        let to = "whose number or name other atoms have, too";
        let texts = [
            match dangling {
                0 => None,
                1 => Some("1 bond ends at no atom of the file, and is left out".to_owned()),
                _ => Some(format!("{dangling} bonds end at no atom of the file, and are left out")),
            },
            match ambiguous {
                0 => None,
                1 => Some(format!("1 bond ends at an atom {to}, and is left out")),
                _ => Some(format!("{ambiguous} bonds end at atoms {to}, and are left out")),
            },
        ];
        self.warnings.extend(texts.into_iter().flatten());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bonds(rows: &[Bond]) -> Bonds {
        Bonds::sorted(rows.iter().copied().map(ordered).collect())
    }

    fn rows(bonds: &Bonds) -> Vec<Bond> {
        (0..bonds.len()).map(|bond| bonds.bond(bond)).collect()
    }

    #[test]
    fn bonds_are_listed_once_from_their_lesser_end() {
        let same =
            bonds(&[(3, 1, [1, 0, -2]), (1, 3, [-1, 0, 2]), (0, 0, [0, -1, 0]), (0, 0, [0, 1, 0])]);
        assert_eq!(rows(&same), [(0, 0, [0, -1, 0]), (1, 3, [-1, 0, 2])]);
        assert_eq!(same.degrees(4), [2, 1, 0, 1]);
        assert!(bonds(&[(0, 1, [0; 3])]).shift.is_empty());
    }

    #[test]
    fn bonds_follow_the_rows_of_their_particles() {
        let mut kept = bonds(&[(0, 1, [0; 3]), (1, 3, [1, 0, 0]), (2, 3, [0; 3])]);
        kept.kinds.names = vec!["a".to_owned(), "b".to_owned()];
        kept.kinds.codes = crate::Codes::Bytes(vec![0, 1, 0]);
        let mut reordered = kept.clone();
        kept.retain(&[false, true, true, true]);
        assert_eq!(rows(&kept), [(0, 2, [1, 0, 0]), (1, 2, [0; 3])]);
        assert_eq!([kept.kinds.text(0), kept.kinds.text(1)], ["b", "a"]);
        reordered.pick(&[3, 2, 1, 0]);
        assert_eq!(rows(&reordered), [(0, 1, [0; 3]), (0, 2, [-1, 0, 0]), (2, 3, [0; 3])]);
        assert_eq!([0, 1, 2].map(|bond| reordered.kinds.text(bond)), ["a", "b", "a"]);
    }

    #[test]
    fn added_bonds_are_not_doubled() {
        let mut one = bonds(&[(0, 1, [0; 3])]);
        one.kinds.names = vec!["2".to_owned()];
        one.kinds.codes.push(0);
        one.add(&bonds(&[(0, 1, [0; 3]), (0, 2, [1, 0, 0])]));
        assert_eq!(rows(&one), [(0, 1, [0; 3]), (0, 2, [1, 0, 0])]);
        assert_eq!([one.kinds.text(0), one.kinds.text(1)], ["2", ""]);
    }
}
