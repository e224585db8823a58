//! A census of molecules: chains, residues by their group, and ligands.

use super::vocabulary::{Group, RESIDUE_COLUMNS, RESNAME};
use crate::scene::particles::Particles;
use crate::scene::particles::style::Column;

/// Chains, residues and ligands of particles.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MoleculeCensus {
    /// Names of chains, and their numbers of atoms.
    pub chains: Vec<(String, u64)>,
    /// Number of residues: rows that follow each other and have the same number, name and chain.
    pub residues: u64,
    /// Words of selections, and the numbers of residues that they stand for, if there are any.
    pub groups: Vec<(&'static str, u64)>,
    /// Names of residues in none of these groups, and their numbers.
    pub ligands: Vec<(String, u64)>,
}

/// Groups of residues, with their words.
const GROUPS: [(&str, Group); 5] = [
    ("protein", Group::Protein),
    ("nucleic", Group::Nucleic),
    ("water", Group::Water),
    ("ions", Group::Ions),
    ("lipids", Group::Lipids),
];

impl MoleculeCensus {
    /// Counts the residues of particles; `None` if they have no names of residues.
    pub fn of(particles: &Particles) -> Option<Self> {
        let Some(Column::Texts { names, codes }) = Column::find(particles, RESNAME) else {
            return None;
        };
        let mut census = Self::default();
        let chain = Column::find(particles, "chain");
        if let Some(Column::Texts { names, codes }) = &chain {
            let mut counts = vec![0_u64; names.len()];
            (0..codes.len()).for_each(|row| counts[codes.code(row) as usize] += 1);
            let chains =
                names.iter().zip(counts).filter(|(name, count)| *count > 0 && !name.is_empty());
            census.chains = chains.map(|(name, count)| ((*name).to_owned(), count)).collect();
        }
        let columns: Vec<Column> =
            RESIDUE_COLUMNS.iter().filter_map(|name| Column::find(particles, name)).collect();
        let is_same = |row: usize| {
            columns.iter().all(|column| match column {
                // Missing numbers are the same.
                Column::Numbers(values) => values[row].to_bits() == values[row - 1].to_bits(),
                Column::Texts { codes, .. } => codes.code(row) == codes.code(row - 1),
            })
        };
        let mut counts = vec![0_u64; names.len()];
        for row in (0..codes.len()).filter(|&row| row == 0 || !is_same(row)) {
            counts[codes.code(row) as usize] += 1;
        }
        census.residues = counts.iter().sum();
        let mut of_groups = [0; GROUPS.len()];
        for (name, count) in names.iter().zip(counts).filter(|(_, count)| *count > 0) {
            match GROUPS.iter().position(|(_, group)| group.has_residue(name)) {
                Some(group) => of_groups[group] += count,
                None => census.ligands.push(((*name).to_owned(), count)),
            }
        }
        let groups = GROUPS.iter().zip(of_groups).filter(|(_, count)| *count > 0);
        census.groups = groups.map(|((word, _), count)| (*word, count)).collect();
        Some(census)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Spheres;
    use crate::scene::particles::{Codes, NumberColumn, ParticleFrame, TextColumn};

    fn texts(name: &str, rows: &[&str]) -> TextColumn {
        let mut names: Vec<String> = Vec::new();
        let mut code = |row: &&str| {
            let known = names.iter().position(|own| own == row);
            known.unwrap_or_else(|| {
                names.push((*row).to_owned());
                names.len() - 1
            }) as u8
        };
        let codes = Codes::Bytes(rows.iter().map(&mut code).collect());
        TextColumn { name: name.to_owned(), names, codes }
    }

    #[test]
    fn residues_are_counted_by_group() {
        let mut particles = Particles {
            spheres: Spheres { x: vec![0.0; 7], ..Spheres::default() },
            frame: ParticleFrame::default(),
            ..Particles::default()
        };
        assert_eq!(MoleculeCensus::of(&particles), None);
        let names = ["ALA", "ALA", "ALA", "LIG", "HOH", "HOH", "DG"];
        particles.frame.texts =
            vec![texts("resname", &names), texts("chain", &["A", "A", "A", "A", "W", "W", "B"])];
        let values = vec![1.0, 1.0, 2.0, 3.0, 1.0, 2.0, 1.0];
        particles.frame.numbers = vec![NumberColumn { name: "resid".to_owned(), values }];
        let census = MoleculeCensus::of(&particles).expect("residues");
        let pair = |name: &str, count| (name.to_owned(), count);
        assert_eq!(census.chains, [pair("A", 4), pair("W", 2), pair("B", 1)]);
        assert_eq!(census.groups, [("protein", 2), ("nucleic", 1), ("water", 2)]);
        assert_eq!((census.residues, census.ligands), (6, vec![pair("LIG", 1)]));
    }
}
