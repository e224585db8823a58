//! Groups of atoms by a word, as in VMD and `MDAnalysis`: the names of their residues and atoms.

use crate::scene::particles::style::Column;
use crate::scene::particles::{Codes, Particles};

/// The word for a whole residue after `same`.
pub(super) const RESIDUE: &str = "residue";

/// Columns that tell residues apart; the first is necessary.
pub(super) const RESIDUE_COLUMNS: [&str; 5] = ["resid", "resname", "chain", "segid", "icode"];

/// Names of residues and of atoms.
pub(super) const RESNAME: &str = "resname";
const NAME: &str = "name";
const ELEMENT: &str = "element";

/// Residues of proteins in the force fields of Amber, CHARMM, GROMOS and OPLS: those of the selection
/// `protein` of `MDAnalysis` 2.
#[rustfmt::skip]
const PROTEIN: [&str; 104] = [
    "ACE", "ALA", "ALAD", "ARG", "ARGN", "ASF", "ASH", "ASN", "ASN1", "ASP", "ASPH", "CALA",
    "CARG", "CASF", "CASN", "CASP", "CCYS", "CCYX", "CGLN", "CGLU", "CGLY", "CHID", "CHIE",
    "CHIP", "CILE", "CLEU", "CLYS", "CME", "CMET", "CPHE", "CPRO", "CSER", "CTHR", "CTRP",
    "CTYR", "CVAL", "CYM", "CYS", "CYS1", "CYS2", "CYSH", "CYX", "DAB", "GLH", "GLN", "GLU",
    "GLUH", "GLY", "HID", "HIE", "HIP", "HIS", "HIS1", "HIS2", "HISA", "HISB", "HISD", "HISE",
    "HISH", "HSD", "HSE", "HSP", "HYP", "ILE", "LEU", "LYN", "LYS", "LYSH", "MET", "MSE",
    "NALA", "NARG", "NASN", "NASP", "NCYS", "NCYX", "NGLN", "NGLU", "NGLY", "NHID", "NHIE",
    "NHIP", "NILE", "NLEU", "NLYS", "NME", "NMET", "NPHE", "NPRO", "NSER", "NTHR", "NTRP",
    "NTYR", "NVAL", "ORN", "PGLU", "PHE", "PRO", "QLN", "SER", "THR", "TRP", "TYR", "VAL",
];

/// Residues of nucleic acids: those of the selection `nucleic` of `MDAnalysis` 2.
#[rustfmt::skip]
const NUCLEIC: [&str; 34] = [
    "A", "ADE", "C", "CYT", "DA", "DA3", "DA5", "DC", "DC3", "DC5", "DG", "DG3", "DG5", "DT",
    "DT3", "DT5", "G", "GUA", "RA", "RA3", "RA5", "RC", "RC3", "RC5", "RG", "RG3", "RG5", "RU",
    "RU3", "RU5", "T", "THY", "U", "URA",
];

/// Residues of water: those of the selection `water` of `MDAnalysis` 2 and of the macro `water` of VMD 1.9, heavy water
/// of the Protein Data Bank, and SPC.
#[rustfmt::skip]
const WATER: [&str; 19] = [
    "DOD", "H2O", "HH0", "HHO", "HOH", "OH2", "OHH", "SOL", "SPC", "SPCE", "T3P", "T4P", "T5P",
    "TIP", "TIP2", "TIP3", "TIP3P", "TIP4", "WAT",
];

/// Residues that are ions: those of the macro `ion` of VMD 1.9, with signs of charges, and lithium.
#[rustfmt::skip]
const IONS: [&str; 44] = [
    "AL", "BA", "CA", "CAL", "CD", "CES", "CL", "CL-", "CLA", "CO", "CS", "CU", "CU1", "CUA",
    "HG", "IN", "IOD", "K", "K+", "LI", "LIT", "MG", "MN3", "MO3", "MO4", "MO5", "MO6", "NA",
    "NA+", "NAW", "OC7", "PB", "POT", "PT", "RB", "RUB", "SOD", "TB", "TL", "WO4", "YB", "ZN",
    "ZN1", "ZN2",
];

/// Residues of lipids: those of the macro `lipid` of VMD 1.9.
#[rustfmt::skip]
const LIPIDS: [&str; 10] = [
    "DLPE", "DMPC", "DPPC", "GPC", "LPPC", "PALM", "PC", "PGCL", "POPC", "POPE",
];

/// Atoms of the backbones of proteins and of nucleic acids, and of bases, as in `MDAnalysis` 2.
const BACKBONE: [&str; 4] = ["N", "CA", "C", "O"];
const NUCLEIC_BACKBONE: [&str; 5] = ["P", "C5'", "C3'", "O3'", "O5'"];
#[rustfmt::skip]
const BASES: [&str; 16] = [
    "C2", "C4", "C5", "C5M", "C6", "C8", "N1", "N2", "N3", "N4", "N6", "N7", "N9", "O2", "O4",
    "O6",
];

/// A group of atoms that a word stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Group {
    All,
    None,
    Protein,
    Nucleic,
    Water,
    Ions,
    Lipids,
    Backbone,
    Sidechain,
    AlphaCarbons,
    NucleicBackbone,
    Bases,
    Hydrogen,
    Heavy,
    Ligand,
    Hetero,
}

/// The way in which the atoms of a group are told.
#[derive(Clone, Copy)]
enum Members {
    /// Everything, or nothing.
    Everything(bool),
    /// Residues of some names: [`Group::has_residue`].
    Residues,
    /// Atoms of some residues with one of these names, or with none of them.
    Atoms { residues: &'static [&'static str], names: &'static [&'static str], are_named: bool },
    /// Hydrogens, or all others.
    Hydrogens(bool),
}

/// Words for groups, in VMD and `MDAnalysis`.
const WORDS: [(&str, Group); 25] = [
    ("all", Group::All),
    ("none", Group::None),
    ("protein", Group::Protein),
    ("nucleic", Group::Nucleic),
    ("water", Group::Water),
    ("waters", Group::Water),
    ("ion", Group::Ions),
    ("ions", Group::Ions),
    ("lipid", Group::Lipids),
    ("lipids", Group::Lipids),
    ("backbone", Group::Backbone),
    ("sidechain", Group::Sidechain),
    ("alpha", Group::AlphaCarbons),
    ("calpha", Group::AlphaCarbons),
    ("nucleicbackbone", Group::NucleicBackbone),
    ("nucleicbase", Group::Bases),
    ("hydrogen", Group::Hydrogen),
    ("hydrogens", Group::Hydrogen),
    ("noh", Group::Heavy),
    ("heavy", Group::Heavy),
    ("nohydrogen", Group::Heavy),
    ("ligand", Group::Ligand),
    ("ligands", Group::Ligand),
    ("hetero", Group::Hetero),
    ("het", Group::Hetero),
];

impl Group {
    /// Returns the words for groups.
    pub(super) fn words() -> impl Iterator<Item = &'static str> + Clone {
        WORDS.iter().map(|(word, _)| *word)
    }

    /// Returns the group of a word, ignoring case.
    pub(super) fn named(word: &str) -> Option<Self> {
        WORDS.iter().find(|(own, _)| own.eq_ignore_ascii_case(word)).map(|(_, group)| *group)
    }

    /// Returns the way in which its atoms are told.
    fn members(self) -> Members {
        let atoms = |residues, names| Members::Atoms { residues, names, are_named: true };
        match self {
            Self::All => Members::Everything(true),
            Self::None => Members::Everything(false),
            Self::Protein
            | Self::Nucleic
            | Self::Water
            | Self::Ions
            | Self::Lipids
            | Self::Ligand
            | Self::Hetero => Members::Residues,
            Self::Backbone => atoms(&PROTEIN, &BACKBONE),
            Self::Sidechain => {
                Members::Atoms { residues: &PROTEIN, names: &BACKBONE, are_named: false }
            }
            Self::AlphaCarbons => atoms(&PROTEIN, &["CA"]),
            Self::NucleicBackbone => atoms(&NUCLEIC, &NUCLEIC_BACKBONE),
            Self::Bases => atoms(&NUCLEIC, &BASES),
            Self::Hydrogen => Members::Hydrogens(true),
            Self::Heavy => Members::Hydrogens(false),
        }
    }

    /// Returns the columns that the group depends on.
    pub(super) fn columns(self) -> &'static [&'static str] {
        match self.members() {
            Members::Everything(_) => &[],
            Members::Residues => &[RESNAME],
            Members::Atoms { .. } => &[RESNAME, NAME],
            Members::Hydrogens(_) => &[ELEMENT, NAME],
        }
    }

    /// Returns whether residues of a name are of the group.
    pub(super) fn has_residue(self, name: &str) -> bool {
        match self {
            Self::Protein => PROTEIN.contains(&name),
            Self::Nucleic => NUCLEIC.contains(&name),
            Self::Water => WATER.contains(&name),
            Self::Ions => IONS.contains(&name),
            Self::Lipids => LIPIDS.contains(&name),
            Self::Hetero => !PROTEIN.contains(&name) && !NUCLEIC.contains(&name),
            Self::Ligand => {
                let others = [Self::Protein, Self::Nucleic, Self::Water, Self::Ions, Self::Lipids];
                !name.is_empty() && !others.iter().any(|group| group.has_residue(name))
            }
            _ => false,
        }
    }

    /// Returns the rows of the group.
    ///
    /// # Errors
    ///
    /// A message: the particles have no names of residues, or of atoms.
    pub(super) fn rows(self, particles: &Particles) -> Result<Vec<bool>, String> {
        let residues = |fits: &dyn Fn(&str) -> bool| has_name(particles, RESNAME, "residues", fits);
        match self.members() {
            Members::Everything(is_of) => Ok(vec![is_of; particles.spheres.len()]),
            Members::Residues => residues(&|name| self.has_residue(name)),
            Members::Atoms { residues: own, names, are_named } => {
                let of_residues = residues(&|name| own.contains(&name))?;
                let named = has_name(particles, NAME, "atoms", &|name| {
                    names.contains(&name) || names.contains(&name.replace('*', "'").as_str())
                })?;
                let both = of_residues.into_iter().zip(named);
                Ok(both.map(|(is_of, is_named)| is_of && is_named == are_named).collect())
            }
            Members::Hydrogens(are) => {
                Ok(hydrogen(particles)?.into_iter().map(|is| is == are).collect())
            }
        }
    }
}

/// Returns the rows whose text in a column fits; `what` is what has the texts.
fn has_name(
    particles: &Particles,
    column: &str,
    what: &str,
    fits: &dyn Fn(&str) -> bool,
) -> Result<Vec<bool>, String> {
    match Column::find(particles, column) {
        Some(Column::Texts { names, codes }) => {
            let fitting: Vec<bool> = names.iter().map(|name| fits(name)).collect();
            Ok((0..codes.len()).map(|row| fitting[codes.code(row) as usize]).collect())
        }
        _ => Err(format!("the file has no names of {what}, which this word stands for")),
    }
}

/// Returns the rows of hydrogens: by element or, if no element is known, by name.
fn hydrogen(particles: &Particles) -> Result<Vec<bool>, String> {
    let kinds = &particles.frame.kinds;
    let is_hydrogen = |element: spherule_particles::Element| element.number() == 1;
    let codes: &Codes = &kinds.codes;
    if !codes.is_empty() && kinds.table.iter().any(|kind| kind.element.is_some()) {
        let of_kind: Vec<bool> =
            kinds.table.iter().map(|kind| kind.element.is_some_and(is_hydrogen)).collect();
        return Ok((0..codes.len()).map(|row| of_kind[codes.code(row) as usize]).collect());
    }
    // As the macro of VMD: an H, after a digit or without one.
    has_name(particles, NAME, "atoms", &|name| {
        name.trim_start_matches(|letter: char| letter.is_ascii_digit()).starts_with('H')
    })
}

/// Returns the columns that identify what particles have in common.
pub(super) fn columns_of(name: &str) -> Vec<String> {
    if name.eq_ignore_ascii_case(RESIDUE) {
        return RESIDUE_COLUMNS.map(str::to_owned).into();
    }
    vec![name.to_owned()]
}
