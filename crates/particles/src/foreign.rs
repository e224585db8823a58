//! Detects unsupported formats, and suggests a command that converts them to a supported one.

use super::{fields::Fields, number};
use std::path::Path;

/// An unsupported format, with advice.
#[derive(Debug, PartialEq)]
pub(crate) struct Foreign {
    /// Name with an article, to follow "is".
    pub(crate) name: &'static str,
    /// A command to type.
    pub(crate) help: String,
}

/// The sign by which a format is detected.
enum Sign {
    /// A binary file has one of these at this offset.
    Bytes(usize, &'static [&'static [u8]]),
    /// A test of the head of a binary file.
    Binary(fn(&[u8]) -> bool),
    /// A text begins with one of these, in any case.
    Words(&'static [&'static str]),
    /// A test of a text.
    Text(fn(&Head) -> bool),
}
use Sign::{Binary, Bytes, Text, Words};

/// The head of a text.
struct Head<'a> {
    bytes: &'a [u8],
    /// The first line that is not blank, without the blanks around it.
    first: &'a [u8],
    lines: Vec<&'a [u8]>,
}

/// Conversions to supported formats; `{file}` is replaced by the file, `{stem}` by its name without
/// extension.
const TRAJECTORY: &str = "convert it: gmx trjconv -f {file} -s topol.tpr -o {stem}.gro; or, without the file that names \
     its atoms: python3 -c \"import MDAnalysis; MDAnalysis.Universe('{file}', '{file}', \
     topology_format='MINIMAL').atoms.write('{stem}.xyz', frames='all')\", which needs pytng";
const TRZ: &str = "convert it together with the file that names its atoms: python3 -c \"import MDAnalysis; \
     MDAnalysis.Universe('TOPOLOGY', '{file}').atoms.write('{stem}.xyz', frames='all')\"";
const WITH_TOPOLOGY: &str = "convert it together with the file that names its atoms: python3 -c \"import MDAnalysis; \
     MDAnalysis.Universe('TOPOLOGY', '{file}', format='TRJ').atoms.write('{stem}.xyz', frames='all')\"";
const ATOMS: &str = "convert it: python3 -c \"import MDAnalysis; MDAnalysis.Universe('{file}').atoms.write('{stem}.xyz')\"";
const MOLECULES: &str = "convert it: obabel {file} -O {stem}.xyz";
const HDF5: &str = "write one of its arrays: python3 -c \"import h5py, numpy; numpy.save('{stem}.npy', \
     h5py.File('{file}')['NAME'][:])\"; h5ls -r {file} lists them";
const MESH: &str = "write its points: python3 -c \"import meshio, numpy; numpy.save('{stem}.npy', \
                    meshio.read('{file}').points)\"";
const OBJ: &str =
    "write its points: awk '$1==\"v\" {print $2, $3, $4}' {file} | spherule render - -o {stem}.png";
const TACHYON: &str = "write its spheres: awk '$1==\"SPHERE\" {print $3, $4, $5, $7}' {file} | spherule render - -o {stem}.png";
const GADGET: &str = "write its positions: python3 -c \"import pynbody, numpy; numpy.save('{stem}.npy', \
     pynbody.load('{file}')['pos'])\"";
const SHEET: &str = "write its first sheet: libreoffice --headless --convert-to csv {file}";
const MATLAB: &str = "write one of its arrays: python3 -c \"import scipy.io, numpy; numpy.save('{stem}.npy', \
     scipy.io.loadmat('{file}')['NAME'])\"";
const PARQUET: &str = "write it as CSV: python3 -c \"import pandas; pandas.read_parquet('{file}').to_csv('{stem}.csv', index=False)\"";
const FEATHER: &str = "write it as CSV: python3 -c \"import pandas; pandas.read_feather('{file}').to_csv('{stem}.csv', index=False)\"";
const XML: &str = "write its positions as CSV: python3 -c \"import pandas; pandas.read_xml('{file}').to_csv('{stem}.csv', index=False)\"";
const JSON: &str = "write its positions as CSV: python3 -c \"import pandas; pandas.read_json('{file}').to_csv('{stem}.csv')\"";
const RESTART: &str = "have LAMMPS write it as text: lmp -restart2data {file} {stem}.data";
const DUMP: &str = "have LAMMPS' tool write it as text: binary2txt {file}";
const CLOUD: &str = "write it as PLY: pdal translate {file} {stem}.ply";
const BIOSYM: &str = "convert it: obabel -i car {file} -O {stem}.xyz";
const NO_ATOMS: &str = "its positions are in the file of coordinates beside it: obabel -i car {stem}.car -O {stem}.xyz";
const GROMACS: &str = "render the file of coordinates, such as conf.gro; for a --topology with charges and bonds, convert it: \
     python3 -c \"import parmed; parmed.load_file('{file}').save('{stem}.psf')\"";
const PART: &str = "render the file of coordinates, such as conf.gro";
const CUBE: &str = "convert it: ase convert -i cube -o extxyz {file} {stem}.xyz";
const MOLDEN: &str = "convert it: obabel -i molden {file} -O {stem}.xyz";
const TINKER: &str = "convert it: obabel -i txyz {file} -O {stem}.sdf";
const MAESTRO: &str = "convert it: python3 -c \"from rdkit import Chem; \
     Chem.MolToXYZFile(next(Chem.MaeMolSupplier('{file}', removeHs=False)), '{stem}.xyz')\"";
const MMTF: &str = "convert it: python3 -c \"from Bio.PDB import mmcifio, mmtf; w = mmcifio.MMCIFIO(); \
     w.set_structure(mmtf.MMTFParser.get_structure('{file}')); w.save('{stem}.cif')\"; it needs biopython and mmtf-python";
const AIMS: &str = "convert it: ase convert -i aims -o extxyz {file} {stem}.xyz";
const CASTEP: &str = "convert it: ase convert -i castep-cell -o extxyz {file} {stem}.xyz";
const GROMOS: &str = "convert it: gmx editconf -f {file} -o {stem}.gro";
const PREPARED: &str =
    "render it: spherule render {file} -o {stem}.png; or name the file that it was made of";
const CHECKPOINT: &str =
    "resume it: spherule render --resume {file}; or merge parts: spherule merge";
const SKY: &str =
    "a picture can light a scene, as in environment = { kind = \"picture\", file = \"{file}\" }";
const NONE: &str = "name a file of particles or a scene";
const SEVEN_ZIP: &str =
    "unpack one of its files: 7z x -so {file} NAME | spherule render - -o {stem}.png";
const RAR: &str =
    "unpack one of its files: unrar p -inul {file} NAME | spherule render - -o {stem}.png";
const TAR: &str = "read one of its files: tar -xOf {file} NAME | spherule render - -o {stem}.png; tar -tf {file} lists them";
const PAGE: &str = "a download went wrong: fetch the file itself, as in curl -LO URL";
const LFS: &str = "fetch the file: git lfs pull";

/// The formats, each with its name and conversion. The first whose sign is found is meant.
const FORMATS: &[(Sign, &str, &str)] = &[
    (Bytes(0, &[b"# vtk DataFile"]), "a VTK file", MESH),
    (Bytes(0, &[b"LammpS RestartT"]), "a binary restart file of LAMMPS", RESTART),
    (Bytes(8, &[b"DUMPATOM", b"DUMPCUSTOM"]), "a binary dump of LAMMPS", DUMP),
    (Bytes(0, &[b"#!TDV"]), "a binary Tecplot file", MESH),
    (Bytes(0, &[b"\xD0\xCF\x11\xE0\xA1\xB1\x1A\xE1"]), "a workbook of Excel (XLS)", SHEET),
    (Bytes(0, &[b"MATLAB 5.0 MAT-file"]), "a MATLAB file", MATLAB),
    (Bytes(0, &[b"PAR1"]), "a Parquet file", PARQUET),
    (Bytes(0, &[b"ARROW1"]), "a Feather file", FEATHER),
    (Bytes(0, &[b"LASF"]), "a LAS point cloud", CLOUD),
    (Bytes(0, &[b"ASTM-E57"]), "an E57 point cloud", CLOUD),
    (Bytes(0, &[b"# .PCD"]), "a PCD point cloud", CLOUD),
    (Bytes(0, &[b"spherule-prepared\n"]), "a prepared scene", PREPARED),
    (
        Bytes(0, &[b"spherule-checkpoint\n"]),
        "a checkpoint or a part of a render, not a scene",
        CHECKPOINT,
    ),
    (Bytes(0, &[b"\x89PNG\r\n"]), "a picture (PNG)", SKY),
    (Bytes(0, &[b"\xFF\xD8\xFF"]), "a picture (JPEG)", NONE),
    (Bytes(0, &[b"\x76\x2F\x31\x01"]), "a picture (EXR)", SKY),
    (Bytes(0, &[b"%PDF"]), "a PDF document", NONE),
    (Bytes(0, &[b"7z\xBC\xAF\x27\x1C"]), "a 7-Zip archive", SEVEN_ZIP),
    (Bytes(0, &[b"Rar!\x1A\x07"]), "a RAR archive", RAR),
    (Bytes(257, &[b"ustar"]), "a tar archive", TAR),
    (Binary(is_spreadsheet), "a workbook of a spreadsheet", SHEET),
    (Binary(is_gadget), "a snapshot of Gadget", GADGET),
    (Bytes(40, &[b"GENERAL INFO\0"]), "a TNG trajectory of GROMACS", TRAJECTORY),
    (Binary(is_trz), "a TRZ trajectory", TRZ),
    (Bytes(8, &[b"VERSION "]), "a run input file of GROMACS (TPR)", ATOMS),
    (Binary(is_mmtf), "an MMTF file", MMTF),
    (Bytes(0, &[b"SQLite format 3\0"]), "a database, as DMS of Desmond is", ATOMS),
    (Words(&["title =", "title=", "variables =", "variables="]), "a Tecplot file", MESH),
    (Words(&["<!doctype html", "<html"]), "a web page (HTML)", PAGE),
    (Words(&["version https://git-lfs"]), "a pointer to a file that Git LFS keeps", LFS),
    (Words(&["[molden format]"]), "a Molden file", MOLDEN),
    (Words(&["!biosym archive"]), "a file of Biosym (CAR or ARC)", BIOSYM),
    (Words(&["!biosym molecular_data"]), "a topology of Biosym (MDF), without positions", NO_ATOMS),
    (
        Text(|t| is_gromacs(t.bytes) && has_section(t.bytes, &["system"])),
        "a topology of GROMACS, without positions",
        GROMACS,
    ),
    (Text(|t| is_gromacs(t.bytes)), "a part of a topology of GROMACS, without positions", PART),
    (
        Text(|t| t.first.starts_with(b"{") && has(t.bytes, "_m2io_version")),
        "a Maestro file",
        MAESTRO,
    ),
    (Words(&["{", "["]), "a JSON file", JSON),
    (Text(|t| t.first.eq_ignore_ascii_case(b"begin_scene")), "a scene of Tachyon", TACHYON),
    (Text(|t| t.is_markup(&["<VTKFile"])), "a VTK file (XML)", MESH),
    (Text(|t| t.is_markup(&["<cml", "xml-cml", "<atomArray"])), "a CML file", MOLECULES),
    (Words(&["<"]), "an XML file", XML),
    (Text(|text| is_cube(&text.lines)), "a cube file of Gaussian", CUBE),
    (Text(|text| is_mdcrd(&text.lines)), "a trajectory of Amber in text (mdcrd)", WITH_TOPOLOGY),
    (Text(|text| is_tinker(&text.lines)), "an XYZ file of Tinker", TINKER),
    (Text(|text| is_aims(&text.lines)), "a geometry of FHI-aims", AIMS),
    (Text(|text| is_castep(&text.lines)), "a cell file of CASTEP", CASTEP),
    (Text(|text| is_charmm(&text.lines)), "a coordinate file of CHARMM (CRD)", ATOMS),
    (Text(|t| t.first == b"TITLE" && has_line(t.bytes, b"END")), "a GROMOS file (G96)", GROMOS),
    (Text(|t| t.first.starts_with(b"ZONE ") || t.first == b"ZONE"), "a Tecplot file", MESH),
    (Text(|t| t.first.starts_with(b"solid") && has_line(t.bytes, b"facet")), "an STL mesh", MESH),
    (Text(|text| is_mesh(text.first)), "a Wavefront OBJ mesh", OBJ),
];

/// The head of ZIP archives, among them those of NumPy, which are read.
const ZIP: &[u8] = b"PK\x03\x04";

/// Sections of topologies of GROMACS, of which each file of them has one.
const SECTIONS: [&str; 10] = [
    "defaults",
    "atomtypes",
    "moleculetype",
    "atoms",
    "bonds",
    "bondtypes",
    "pairtypes",
    "nonbond_params",
    "position_restraints",
    "system",
];

/// Number of lines from which text formats are detected.
const LINES: usize = 64;

/// Inserts the file's name into a command.
fn fill_in(command: &str, path: &Path) -> String {
    let is_plain = |name: &str| {
        name.chars().all(|letter| letter.is_ascii_alphanumeric() || "._/+-".contains(letter))
    };
    let file = path.to_str().filter(|name| is_plain(name) && *name != "-").unwrap_or("FILE");
    let stem = Path::new(file).file_stem().and_then(|stem| stem.to_str()).unwrap_or("FILE");
    command.replace("{file}", file).replace("{stem}", stem)
}

/// Returns advice on an HDF5 file whose particles are not found.
pub(crate) fn hdf5_help(path: &Path) -> String {
    fill_in(HDF5, path)
}

/// Returns the first format whose sign a file has.
fn find(path: &Path, has: impl Fn(&Sign) -> bool) -> Option<Foreign> {
    let (_, name, conversion) = FORMATS.iter().find(|(sign, ..)| has(sign))?;
    Some(Foreign { name, help: fill_in(conversion, path) })
}

/// Returns the format of a binary file with this head, if it is known.
pub(crate) fn binary(head: &[u8], path: &Path) -> Option<Foreign> {
    find(path, |sign| match sign {
        Bytes(offset, any) => any.iter().any(|bytes| has_at(head, *offset, bytes)),
        Binary(test) => test(head),
        Words(_) | Text(_) => false,
    })
}

/// Returns the format of a text file with this head, if it is known.
pub(crate) fn text(head: &[u8], path: &Path) -> Option<Foreign> {
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head);
    let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii_end).take(LINES).collect();
    let content = head.trim_ascii_start();
    let first = content.split(|&byte| byte == b'\n').next()?.trim_ascii_end();
    let starts_with = |words: &&str| {
        let start = content.get(..words.len()).unwrap_or_default();
        start.eq_ignore_ascii_case(words.as_bytes())
    };
    let text = Head { bytes: head, first, lines };
    find(path, |sign| match sign {
        Words(any) => any.iter().any(starts_with),
        Text(test) => test(&text),
        Bytes(..) | Binary(_) => false,
    })
}

impl Head<'_> {
    /// Returns whether this is XML with one of these texts.
    fn is_markup(&self, any: &[&str]) -> bool {
        self.first.starts_with(b"<") && any.iter().any(|text| has(self.bytes, text))
    }
}

fn has(head: &[u8], text: &str) -> bool {
    memchr::memmem::find(head, text.as_bytes()).is_some()
}

fn has_at(head: &[u8], offset: usize, bytes: &[u8]) -> bool {
    head.get(offset..).is_some_and(|rest| rest.starts_with(bytes))
}

/// Returns whether a file is a ZIP archive that is a document.
fn is_spreadsheet(head: &[u8]) -> bool {
    let is_document = has(head, "[Content_Types].xml") || has(head, "opendocument.spreadsheet");
    head.starts_with(ZIP) && is_document
}

fn is_gadget(head: &[u8]) -> bool {
    let word = |offset: usize| head.get(offset..offset + 4)?.try_into().ok();
    [u32::from_be_bytes, u32::from_le_bytes].into_iter().any(|order: fn([u8; 4]) -> u32| {
        let word = |offset: usize| word(offset).map_or(0, order);
        word(0) == 256 && word(260) == 256
            || word(0) == 8 && has_at(head, 4, b"HEAD") && word(12) == 8
    })
}

/// Returns whether a file has records of Fortran of a title of 80 letters and of a number of 32 bits.
fn is_trz(head: &[u8]) -> bool {
    has_at(head, 0, &[80, 0, 0, 0]) && has_at(head, 84, &[80, 0, 0, 0, 4, 0, 0, 0])
}

/// Returns the lines of a topology of GROMACS that are no comments.
fn gromacs_lines(head: &[u8]) -> impl Iterator<Item = &[u8]> {
    let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    lines.filter(|line| !line.is_empty() && !line.starts_with(b";"))
}

/// Returns whether the head of a topology of GROMACS has a section of any of these names.
fn has_section(head: &[u8], names: &[&str]) -> bool {
    gromacs_lines(head).any(|line| {
        let section =
            line.strip_prefix(b"[").and_then(|line| line.split(|&byte| byte == b']').next());
        section.is_some_and(|own| names.iter().any(|name| own.trim_ascii() == name.as_bytes()))
    })
}

/// Returns whether a text is a topology of GROMACS or a part of one: its first line that is no comment is for the preprocessor or
/// begins a section, and there is a section of it, or files are included of its name's end.
fn is_gromacs(head: &[u8]) -> bool {
    let first = gromacs_lines(head).next().unwrap_or_default();
    let starts = [&b"["[..], b"#include", b"#define", b"#if"];
    starts.iter().any(|start| first.starts_with(start))
        && (has_section(head, &SECTIONS) || has(head, ".itp\""))
}

/// Returns whether a file is a map of `MessagePack` with keys of MMTF.
fn is_mmtf(head: &[u8]) -> bool {
    let is_map = matches!(head.first(), Some(0x80..=0x8F | 0xDE | 0xDF));
    is_map
        && ["mmtfVersion", "mmtfProducer", "groupTypeList", "xCoordList"]
            .into_iter()
            .any(|key| has(head, key))
}

/// Returns whether lines are the number of atoms and a title, and rows of a number, a name, a position, a type and bonds.
fn is_tinker(lines: &[&[u8]]) -> bool {
    let is_whole = |field: Option<&[u8]>| field.is_some_and(|field| number::whole(field).is_some());
    let first = lines.first().copied().unwrap_or_default();
    // The cell may be in the second line.
    let rows = lines
        .iter()
        .skip(1)
        .skip_while(|row| numbers(row).is_some_and(|numbers| numbers.len() == 6));
    let mut rows = rows.take(2).filter(|row| !row.is_empty()).peekable();
    is_whole(Fields::blanks(first).next())
        && rows.peek().is_some()
        && rows.enumerate().all(|(at, row)| {
            let fields: Vec<&[u8]> = Fields::blanks(row).collect();
            fields.len() >= 6
                && number::whole(fields[0]) == Some(at as u64 + 1)
                && number::parse(fields[1]).is_none()
                && fields[2..5]
                    .iter()
                    .all(|field| field.contains(&b'.') && number::parse(field).is_some())
                && fields[5..].iter().all(|field| is_whole(Some(*field)))
        })
}

/// Returns whether the first line that is no comment is an atom or a lattice vector of FHI-aims.
fn is_aims(lines: &[&[u8]]) -> bool {
    let first = lines.iter().find(|line| !line.is_empty() && !line.starts_with(b"#"));
    let fields: Vec<&[u8]> = Fields::blanks(first.copied().unwrap_or_default()).collect();
    let is_place = fields
        .get(1..4)
        .is_some_and(|place| place.iter().all(|field| number::parse(field).is_some()));
    is_place
        && match fields[0] {
            b"lattice_vector" => fields.len() == 4,
            b"atom" | b"atom_frac" => fields.len() == 5 && number::parse(fields[4]).is_none(),
            _ => false,
        }
}

/// Returns whether a line begins a block of a lattice or of positions.
fn is_castep(lines: &[&[u8]]) -> bool {
    lines.iter().any(|line| {
        let line = line.to_ascii_lowercase();
        line.starts_with(b"%block lattice_") || line.starts_with(b"%block positions_")
    })
}

/// Returns whether any line starts with this text.
fn has_line(head: &[u8], start: &[u8]) -> bool {
    head.starts_with(start)
        || memchr::memmem::find_iter(head, start).any(|at| head[at - 1] == b'\n')
}

/// Returns the fields of a line, if all are numbers.
fn numbers(line: &[u8]) -> Option<Vec<f64>> {
    Fields::blanks(line).map(number::parse).collect()
}

/// Returns whether lines are two comments, the number of atoms and the origin, three axes of the grid with
/// their numbers of points, and an atom. The line of the origin may end with another number. Rows of a
/// table with five numbers each do not match.
fn is_cube(lines: &[&[u8]]) -> bool {
    let is_axis = |line: &[u8], max_fields: usize| {
        let fields: Vec<&[u8]> = Fields::blanks(line).collect();
        let count = fields.first().map(|count| count.strip_prefix(b"-").unwrap_or(count));
        (4..=max_fields).contains(&fields.len())
            && count.is_some_and(|count| number::whole(count).is_some())
            && fields[1..].iter().all(|field| number::parse(field).is_some())
    };
    let is_atom = |line: &&[u8]| numbers(line).is_some_and(|numbers| numbers.len() == 5);
    // The first line of an XYZ file is a number.
    lines.len() > 6
        && number::whole(lines[0]).is_none()
        && is_axis(lines[2], 5)
        && lines[3..6].iter().all(|line| is_axis(line, 4))
        && is_atom(&lines[6])
}

/// Returns whether lines are a title and rows of ten numbers, which are eight characters wide and have three decimals.
fn is_mdcrd(lines: &[&[u8]]) -> bool {
    let is_number = |field: &[u8]| {
        field.len() == 8 && field[4] == b'.' && number::parse(field.trim_ascii()).is_some()
    };
    let is_row = |row: &&[u8]| row.len() == 80 && row.chunks(8).all(is_number);
    lines.len() > 2 && lines[1..3].iter().all(is_row)
}

/// Returns whether lines are a title, whose lines begin with `*`, the number of atoms, and rows of ten
/// columns, of which the last may be missing.
fn is_charmm(lines: &[&[u8]]) -> bool {
    let mut rest = lines.iter().skip_while(|line| line.starts_with(b"*"));
    let count = rest.next().and_then(|line| Fields::blanks(line).next());
    lines.first().is_some_and(|line| line.starts_with(b"*"))
        && count.is_some_and(|count| number::whole(count).is_some())
        && rest.next().is_some_and(|row| Fields::blanks(row).count() >= 9)
}

/// Returns whether the first line of a Wavefront OBJ file is a vertex or names a material library.
fn is_mesh(first: &[u8]) -> bool {
    let vertex = first.strip_prefix(b"v ").and_then(numbers);
    vertex.is_some_and(|numbers| numbers.len() >= 3) || first.starts_with(b"mtllib ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(content: &[u8], name: &str) -> String {
        let path = Path::new(name);
        let found = binary(content, path).or_else(|| text(content, path));
        found.map_or_else(String::new, |found| format!("{}: {}", found.name, found.help))
    }

    #[test]
    fn binary_formats_are_named_with_a_command() {
        let gadget = [&256_u32.to_le_bytes()[..], &[0; 256], &256_u32.to_le_bytes()].concat();
        let zip = |name: &[u8]| [b"PK\x03\x04", &[0; 26][..], name, &[0; 9]].concat();
        for (content, words) in [
            (gadget, ["Gadget", "pynbody.load('run.bin')"]),
            (zip(b"[Content_Types].xml"), ["spreadsheet", "--convert-to csv run.bin"]),
            (
                zip(b"mimetypeapplication/vnd.oasis.opendocument.spreadsheet"),
                ["spreadsheet", "csv"],
            ),
            (
                b"# vtk DataFile Version 5.1\nx\nBINARY\n\0\0".to_vec(),
                ["VTK", "meshio.read('run.bin')"],
            ),
            ([&[0; 40][..], b"GENERAL INFO\0", &[0; 60]].concat(), ["TNG", "trjconv -f run.bin"]),
            (b"\xDE\0\x26\xADgroupTypeList\0".to_vec(), ["MMTF", "get_structure('run.bin')"]),
            (
                [&[80, 0, 0, 0][..], &[b'a'; 80], &[80, 0, 0, 0, 4, 0, 0, 0, 10, 0, 0, 0]].concat(),
                ["TRZ", "Universe('TOPOLOGY', 'run.bin')"],
            ),
            (b"\0\0\0\x0c\0\0\0\x0bVERSION 4.0\0".to_vec(), ["TPR", "Universe('run.bin')"]),
            (b"SQLite format 3\0".to_vec(), ["Desmond", "Universe('run.bin')"]),
            (b"PAR1\0\0".to_vec(), ["Parquet", "read_parquet('run.bin')"]),
            (b"spherule-prepared\n\0".to_vec(), ["prepared", "render run.bin -o run.png"]),
            (b"spherule-checkpoint\n\0".to_vec(), ["a checkpoint", "--resume run.bin"]),
        ] {
            let found = named(&content, "data/run.bin").replace("data/", "");
            assert!(words.iter().all(|word| found.contains(word)), "{words:?}: {found}");
        }
        assert_eq!(binary(&zip(b"position.npy"), Path::new("a.npz")), None);
        assert_eq!(binary(&[0; 300], Path::new("a")), None);
        for path in ["-", "a b.h5"] {
            assert!(hdf5_help(Path::new(path)).contains("'FILE'"), "{path}");
        }
    }

    #[test]
    fn text_formats_are_named_with_a_command() {
        let cube =
            "title\ncomment\n 2 0.0 0.0 0.0\n 10 0.5 0 0\n 10 0 0.5 0\n 10 0 0 0.5\n 8 8.0 0 0 0\n";
        let charmm = "* TITLE\n*\n    1\n    1    1 ALA  N     1.0 2.0 3.0 PEP  1  0.0\n";
        for (content, words) in [
            (cube, ["cube", "-i cube"]),
            (charmm, ["CRD", "MDAnalysis"]),
            ("# vtk DataFile Version 3.0\nx\nASCII\n", ["VTK", "meshio.read('in.txt').points"]),
            ("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">\n", ["VTK", "meshio"]),
            ("<VTKFile type=\"PolyData\">\n", ["VTK", "meshio"]),
            ("TITLE = \"a\"\nVARIABLES = \"x\"\n", ["Tecplot", "meshio"]),
            ("TITLE\nwater\nEND\nPOSITION\n", ["G96", "gmx editconf -f in.txt"]),
            ("mtllib a\nv 1 2 3\n", ["OBJ", "awk"]),
            ("[Molden Format]\n[Atoms] Angs\n", ["Molden", "-i molden in.txt"]),
            ("{\n  s_m_m2io_version\n  :::\n  2.0.0\n}\n", ["Maestro", "rdkit"]),
            ("{ \"x\": [1] }\n", ["JSON", "pandas"]),
            (" 1 water\n 1 O 0.0 0.0 0.1 6\n", ["Tinker", "-i txyz"]),
            (
                "2\n 5.0 5.0 5.0 90.0 90.0 90.0\n1 O 0.0 0.0 0.1 6 2\n2 H 0.0 0.0 1.1 21 1\n",
                ["Tinker", "txyz"],
            ),
            ("# made up\nlattice_vector 5 0 0\n", ["aims", "-i aims"]),
            ("atom 0 0 0.1 O\n", ["aims", "-i aims"]),
            ("# x\n\n%BLOCK LATTICE_CART\n5 0 0\n", ["CASTEP", "-i castep-cell"]),
            (&format!("title\n{0}\n{0}\n", "   1.000-100.000".repeat(5)), ["mdcrd", "TOPOLOGY"]),
            ("<html>", ["web page", "curl"]),
            ("!BIOSYM archive 3\nPBC=OFF\n", ["CAR", "-i car in.txt"]),
            ("!BIOSYM molecular_data 4\n", ["MDF", "-i car in.car"]),
            ("; made up\n[ defaults ]\n1 2\n[ system ]\nwater\n", ["topology", "save('in.psf')"]),
            ("#include \"amber99.ff/forcefield.itp\"\n", ["GROMACS", "conf.gro"]),
            ("[ moleculetype ]\nSOL 2\n", ["part of a topology", "conf.gro"]),
            ("<molecule id=\"m1\">\n<atomArray>\n", ["CML", "obabel in.txt"]),
        ] {
            let found = named(content.as_bytes(), "in.txt");
            assert!(words.iter().all(|word| found.contains(word)), "{words:?}: {found}");
        }
    }

    #[test]
    fn supported_formats_are_not_foreign() {
        let pdb =
            "ATOM      1  N   ALA A   1      11.104   6.134  -6.504  1.00  0.00           N\n";
        let no_element = "ATOM      1  N   ALA     1      11.104   6.134  -6.504  1.00  0.00\n";
        for content in [
            pdb,
            no_element,
            "ATOM      1  N   ALA A   1      11.104   6.134  -6.504\n",
            "TITLE     a protein\n",
            "ITEM: TIMESTEP\n0\n",
            "# LAMMPS\n\n2 atoms\n",
            "8\n1.0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n2 2 2\n3 3 3\n",
            "5\n1\n2 1.0 2.0 3.0\n3 1 1 1\n4 1 1 1\n5 1 1 1\n6 1 2 3 4\n",
            "data_x\n_cell_length_a 4\n",
            "x y z\n1 2 3\n",
            "molecules,x,y,z\n1,2,3,4\n",
            "atoms x y z\nC 0 0 0\n",
            "2\n\nC 0.0 0.0 0.0\nO 1.2 0.0 0.0\n",
            "1\n1 C 0.0 0.0 0.0\n1 2.0 3.0 4.0\n",
            "atom 0 0 0 1\n",
            "% a comment\n1 2 3\n",
        ] {
            assert_eq!(named(content.as_bytes(), "a.txt"), "", "{content}");
        }
    }

    #[test]
    fn tables_are_not_foreign() {
        for columns in 3..=10 {
            for (comments, first) in
                (0..5).flat_map(|comments| (0..3).map(move |id| (comments, id)))
            {
                let numbers = " 1.0000000".repeat(columns - 1);
                let rows = (first..first + 20).map(|id| format!("{id}{numbers}\n"));
                let table = "# a comment\n".repeat(comments) + &rows.collect::<String>();
                assert_eq!(named(table.as_bytes(), "a.txt"), "", "{table}");
            }
        }
    }

    #[test]
    fn similar_binary_files_are_not_named() {
        let words = |words: &[u32], order: fn(u32) -> [u8; 4]| -> Vec<u8> {
            words.iter().flat_map(|word| order(*word)).chain([0; 300]).collect()
        };
        let head = u32::from_le_bytes(*b"HEAD");
        let other = u32::from_le_bytes(*b"POS ");
        let gadget = words(&[8, head, 264, 8, 256], u32::to_le_bytes);
        assert!(named(&gadget, "a").contains("Gadget"));
        for content in [
            words(&[1995, 0], u32::to_be_bytes),
            words(&[1993, 12], u32::to_be_bytes),
            words(&[7, 13], u32::to_be_bytes),
            [&85_u32.to_le_bytes()[..], b"CORD", &[0; 90]].concat(),
            words(&[84, 1], u32::to_le_bytes),
            words(&[256], u32::to_le_bytes),
            [&[0; 260][..], &256_u32.to_le_bytes(), &[0; 40]].concat(),
            words(&[8, head, 264, 9], u32::to_le_bytes),
            words(&[8, other, 264, 8], u32::to_le_bytes),
            words(&[9, head, 264, 8], u32::to_le_bytes),
        ] {
            assert_eq!(binary(&content, Path::new("a")), None, "{:?}", &content[..20]);
        }
    }

    #[test]
    fn variants_of_text_formats_are_named() {
        for (content, word) in [
            ("ZONE T=\"a\"\n1 2 3\n".to_owned(), "Tecplot"),
            ("ZONE\n1 2 3\n".to_owned(), "Tecplot"),
            ("solid part\n facet normal 0 0 1\nfacet normal 0 0 1\n".to_owned(), "STL"),
            ("<?xml version=\"1.0\"?>\n<cml>\n".to_owned(), "CML"),
            ("<molecule xmlns=\"http://www.xml-cml.org/schema\">\n".to_owned(), "CML"),
            ("<?xml version=\"1.0\"?>\n<atoms>\n".to_owned(), "XML"),
            ("v 1 2 3\nv 1 2 4\n".to_owned(), "OBJ"),
        ] {
            let found = named(content.as_bytes(), "in.txt");
            assert!(found.contains(word), "{word}: {found}: {content}");
        }
    }

    #[test]
    fn similar_text_files_are_not_named() {
        for content in [
            "solid x y z\n1 2 3 4\n",
            "x y z name\n1 2 3 facet\nfacet 1 2 3\n",
            "PSF x y z\n1 2 3 4\n",
            "PSF CMAP\n1 2 3\n",
            "x y z name\n1 2 3 !N\n",
            "a\nb\nc\nxx yy V2000\n",
            "x y z r\n1 2 3 4\n5 6 7 8\n123 1 2 3\n",
            "8\n1.0\n1 0 0\n0 1 0\n0 0 1\nO 1 1 2\nC 1 1 1\n",
            "a\n1.0\nx\ny\nz\n1 2\nC 1 2 3\n",
            "a\n1 2 3 4\n1 2 3\n1 2 3\n1 2 3\n2\nC 1 2 3\n",
            "a\nb\n0.5 1 2 3\n0.5 1 2 3\n0.5 1 2 3\n0.5 1 2 3\n1 2 3 4 5\n",
            "a\nb\n1 2 3 4\n1 2 3 4\n1 2 3 4\n1 2 3 4",
            "ANIMSTEPS x y\n1 2 3\n",
            "; x y z\n1 2 3\n",
            "#define a\n1 2 3\n",
            "v 1\nv 2\n",
        ] {
            assert_eq!(named(content.as_bytes(), "a.txt"), "", "{content}");
        }
    }
}
