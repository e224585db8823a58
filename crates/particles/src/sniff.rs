//! Detects the format of a file from its first bytes and lines, or else from its name.

use crate::foreign::{self, Foreign};
use crate::formats::{ROWS, Row, Sign, row};
use crate::{
    FileError, Format, ReadOptions, Role, aliases, cif, fields::Fields, gro, header, line, number,
    pdb, pqr, source::Source, units, utf16,
};
use std::path::Path;

/// Help that lists the formats that can be detected.
const KNOWN: &str = "files of particles are rows of `x y z [radius]`, tables with a header that \
                     names x, y and z, XYZ, dumps and data files of LAMMPS, GRO, PDB, mmCIF, CIF \
                     of crystals, BinaryCIF, GSD, PLY, arrays of NumPy, DCD, XTC, TRR, NetCDF, restart files \
                     and topologies of Amber, trajectories of ASE, PQR, POSCAR, SDF, MOL2, XSF, CFG, PSF, coordinates of NAMD and H5MD; of others, name the format, as in --format xyz, \
                     or the columns, as in --format csv --columns x=NAME,y=NAME,z=NAME";

/// Maximum number of lines before the number of atoms in a LAMMPS data file.
const DATA_HEADER: usize = 40;

/// Suffixes of compressed files.
const COMPRESSED: [&str; 6] = ["gz", "bgz", "bz2", "xz", "zst", "zstd"];

/// The message for files without content.
const EMPTY: &str = "holds no particles";

/// Returns the format in the options, or else the detected one. Lines of the head of a text then end with newlines.
pub(crate) fn format(source: &mut Source, options: &ReadOptions) -> Result<Format, FileError> {
    let path = source.path.clone();
    let fault = |message: String| FileError::whole_file(&path, message);
    let refuse = |Foreign { name, help }: Foreign| {
        fault(format!("is {name}, which is not supported")).with_help(help)
    };
    let head = &source.head[..];
    if let Some(foreign) = foreign::binary(head, &path) {
        return Err(refuse(foreign));
    }
    if let Some(format) = binary(head) {
        return match options.format {
            Some(asked) if asked != format => {
                let message = format!("is {}, not {}", format.name(), asked.name());
                Err(fault(message)
                    .with_help(format!("leave --format out, or give {}", format.name())))
            }
            _ => Ok(format),
        };
    }
    if let Some(asked) =
        options.format.filter(|&format| matches!(row(format).sign, Sign::Signature(_)))
    {
        let help = "leave --format out: the content tells the format";
        return Err(fault(format!("is not {}", asked.name())).with_help(help));
    }
    if head.contains(&0) {
        return Err(match utf16::unmarked(head) {
            Some(encoding) => {
                let help = format!(
                    "make it UTF-8: iconv -f {encoding} -t UTF-8 FILE | spherule render - -o picture.png"
                );
                fault(format!("is text in {encoding}")).with_help(help)
            }
            None => fault("is not a text file: it holds zero bytes".to_owned()).with_help(KNOWN),
        });
    }
    line::end_lines(&mut source.head);
    if let Some(format) = options.format {
        return Ok(format);
    }
    let mut detected = detect(&source.head, options);
    if detected.is_err()
        && source.extend().map_err(|error| fault(format!("cannot be read: {error}")))?
    {
        detected = detect(&source.head, options);
    }
    let head = &source.head[..];
    // Titles of these files may be any text, also signatures of other formats.
    let is_titled = |format: &Format| {
        matches!(format, Format::Gro | Format::LammpsData | Format::Poscar | Format::Sdf)
    };
    if let Some(&format) = detected.as_ref().ok().filter(|format| is_titled(format)) {
        return Ok(format);
    }
    if let Some(foreign) = foreign::text(head, &path) {
        return Err(refuse(foreign));
    }
    // Rows of PQR look like those of PDB.
    let may_be_pqr = matches!(detected, Err(_) | Ok(Format::Pdb));
    if may_be_pqr && pqr::is_pqr(head, &path) {
        return Ok(Format::Pqr);
    }
    detected.or_else(|message| {
        let named = if message == EMPTY { None } else { named(&path, head) };
        named.ok_or_else(|| fault(message).with_help(KNOWN))
    })
}

/// Returns the format that the name of a file tells, before any suffix of a compression.
fn named(path: &Path, head: &[u8]) -> Option<Format> {
    let name = path.file_name()?.to_str()?.to_ascii_lowercase();
    let mut parts = name.rsplit('.').skip_while(|part| COMPRESSED.contains(part));
    let part = parts.next()?;
    let found = ROWS.iter().find(|row| row.suffixes.contains(&part))?.format;
    Some(if found == Format::Cif && !cif::is_crystal(head) { Format::MmCif } else { found })
}

/// Returns the format of a text whose first lines have a structure of their own, after any title.
fn structured(head: &[u8]) -> Option<Format> {
    // Those with the plainest signs are last in the table.
    let fits = |row: &&Row| matches!(row.sign, Sign::Structure(is) if is(head));
    ROWS.iter().rev().find(fits).map(|row| row.format)
}

fn binary(head: &[u8]) -> Option<Format> {
    let fits = |row: &&Row| matches!(row.sign, Sign::Signature(is) if is(head));
    ROWS.iter().find(fits).map(|row| row.format)
}

fn detect(head: &[u8], options: &ReadOptions) -> Result<Format, String> {
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head);
    let mut raw = head.split(|&byte| byte == b'\n').skip(1);
    if let (Some(second), Some(third)) = (raw.next(), raw.next())
        && gro::is_gro(second, third)
    {
        return Ok(Format::Gro);
    }
    if let Some(format) = structured(head) {
        return Ok(format);
    }
    let lines = head.split(|&byte| byte == b'\n').map(<[u8]>::trim_ascii);
    let mut lines = lines.filter(|line| !line.is_empty() && !line::is_comment(line));
    let Some(first) = lines.next() else { return Err(EMPTY.to_owned()) };
    // The first line that Excel writes into some CSV files.
    let is_excel = first.starts_with(b"sep=");
    let first = if is_excel { lines.next().unwrap_or_default() } else { first };
    let second = lines.clone().next();
    let crystal = |format: Format| {
        if format == Format::MmCif && cif::is_crystal(head) { Format::Cif } else { format }
    };
    if let Some(format) = detect_keyword(first, lines.clone()) {
        return Ok(crystal(format));
    }
    if number::whole(first).is_some() {
        return Ok(Format::Xyz);
    }
    // Two numbers, because a title may begin with one.
    if Fields::marks(first).take(2).all(|field| number::parse(field).is_some()) {
        return Ok(Format::Xyzr);
    }
    if let Some(format) = lines.take(line::FIRST).find_map(detect_record) {
        return Ok(crystal(format));
    }
    let x = options.columns.roles.iter().find(|(role, _)| *role == Role::X);
    let usual = aliases::usual(Role::X).iter().copied();
    let usual: Vec<&str> = usual.chain(x.map(|(_, name)| name.as_str())).collect();
    let names = header::names(first);
    let separated = header::is_separated(first);
    let is_x = |name: &String| {
        let bare = units::split(name).0;
        usual.iter().any(|own| own.eq_ignore_ascii_case(name) || own.eq_ignore_ascii_case(bare))
    };
    let is_above = |row: &[u8]| header::is_header(&names) && header::is_row(&names, separated, row);
    let is_even = |row: &[u8]| {
        separated
            || Fields::blanks(row).count() == names.len()
            || header::is_row(&names, separated, row)
    };
    let has_x = names.len() > 1 && names.iter().any(is_x) && second.is_none_or(is_even);
    if has_x || second.is_some_and(is_above) {
        return Ok(if separated { Format::Csv } else { Format::Xyzr });
    }
    let shown: String = String::from_utf8_lossy(first).chars().take(40).collect();
    Err(format!("has an unknown format: it begins with `{}`", shown.escape_debug()))
}

/// Returns the format of a file that begins with a format's keyword.
fn detect_keyword<'l>(first: &[u8], mut lines: impl Iterator<Item = &'l [u8]>) -> Option<Format> {
    let has_frame = |line: &[u8]| line.starts_with(b"creator: LAMMPS");
    if first.starts_with(b"ITEM:")
        || has_frame(first)
        || first == b"---" && lines.next().is_some_and(has_frame)
    {
        return Some(Format::LammpsDump);
    }
    if first.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"data_")) {
        return Some(Format::MmCif);
    }
    if pdb::is_pdb(first) {
        return Some(Format::Pdb);
    }
    let is_count = |line: &[u8]| {
        let mut words = Fields::blanks(line);
        words.next().is_some_and(|count| number::whole(count).is_some())
            && words.next() == Some(b"atoms")
    };
    // The first line of a data file may be any text.
    let data = is_count(first) || { lines }.take(DATA_HEADER).any(is_count);
    data.then_some(Format::LammpsData)
}

/// Returns the format that a line tells wherever it is, such as an atom of PDB after other records.
fn detect_record(line: &[u8]) -> Option<Format> {
    let number = |columns: [usize; 2]| {
        let field = line.get(columns[0]..columns[1]).unwrap_or_default().trim_ascii();
        field.contains(&b'.') && number::parse(field).is_some()
    };
    let is_atom = line.starts_with(b"ATOM  ") || line.starts_with(b"HETATM");
    if is_atom && [[30, 38], [38, 46], [46, 54]].into_iter().all(number) {
        return Some(Format::Pdb);
    }
    let mut words = Fields::blanks(line);
    let is_block = line.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"data_"));
    if is_block && words.clone().count() == 1 {
        return Some(Format::MmCif);
    }
    let is_count = words.next().is_some_and(|count| number::whole(count).is_some())
        && words.next() == Some(b"atoms")
        && words.next().is_none();
    match line {
        b"ITEM: TIMESTEP" => Some(Format::LammpsDump),
        b"@<TRIPOS>MOLECULE" => Some(Format::Mol2),
        _ => is_count.then_some(Format::LammpsData),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn detect(head: &str) -> Result<Format, String> {
        super::detect(head.as_bytes(), &ReadOptions::default())
    }

    #[test]
    fn structures_of_lines_tell_the_format() {
        let mol =
            |counts: &str, end: &str| format!("241\n  b\n\n{counts}\n    2.0 0.0 0.0 C\n{end}");
        let molfiles = [
            mol(" 12 12  0     0  0  0  0  0  0999 V2000", "M  END\n"),
            mol("  0  0  0     0  0            999 V3000", ""),
            mol(" 12 12", "M  END\n"),
        ];
        for molfile in molfiles {
            assert_eq!(detect(&molfile), Ok(Format::Sdf), "{molfile}");
        }
        for mol2 in ["@<TRIPOS>MOLECULE\nx\n", "# made by x\n@<TRIPOS>MOLECULE\n"] {
            assert_eq!(detect(mol2), Ok(Format::Mol2), "{mol2}");
        }
        let poscar =
            "Si2\n1.0\n0 2.7 2.7\n2.7 0 2.7\n2.7 2.7 0\nSi\n2\nDirect\n0 0 0\n0.25 0.25 0.25\n";
        let old = "8\n5.43\n1 0 0\n0 1 0\n0 0 1\n2 6\nSelective dynamics\nCartesian\n0 0 0 T T F\n";
        for poscar in [poscar, old] {
            assert_eq!(detect(poscar), Ok(Format::Poscar), "{poscar}");
        }
        for xsf in
            ["CRYSTAL\nPRIMVEC\n", "ATOMS\n8 0 0 0\n", "# x\nANIMSTEPS 5\nCRYSTAL\nPRIMVEC\n"]
        {
            assert_eq!(detect(xsf), Ok(Format::Xsf), "{xsf}");
        }
        assert_eq!(detect("CRYSTAL\n1 atoms\n\nAtoms # atomic\n"), Ok(Format::LammpsData));
        assert_eq!(detect("Number of particles = 8\nA = 1.0\n"), Ok(Format::Cfg));
        assert_eq!(detect("PSF CMAP\n\n  1 !NTITLE\n"), Ok(Format::Psf));
        let table = "8\n1.0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n2 2 2\n3 3 3\n";
        for other in [table, "PSF x y z\n1 2 3 4\n", "x y z\n1 2 3\na\nxx yy V2000\n"] {
            assert!(
                !matches!(detect(other), Ok(Format::Poscar | Format::Psf | Format::Sdf)),
                "{other}"
            );
        }
    }

    #[test]
    fn any_of_the_first_lines_tells_the_format() {
        let atom =
            "ATOM      1  N   ALA A   1       0.000   0.000  -1.000  1.00  0.00           N\n";
        let user = "USER  MOD a b c d e f g h i j k\n";
        for lines in [1, 2, 900] {
            assert_eq!(detect(&(user.repeat(lines) + atom)), Ok(Format::Pdb), "{lines}");
        }
        assert!(detect(&(user.repeat(line::FIRST + 1) + atom)).is_err());
        for (text, expected) in [
            ("written by hand\nITEM: TIMESTEP\n0\n", Format::LammpsDump),
            ("a b\ndata_x\nloop_\n_atom_site.Cartn_x\n", Format::MmCif),
            ("a b\ndata_x\n_cell_length_a 4\n", Format::Cif),
            ("a b\n@<TRIPOS>MOLECULE\n", Format::Mol2),
            (" CRYSTAL # of silicon\n PRIMVEC\n", Format::Xsf),
            ("\tMOLECULE\n# of carbon\n\tATOMS # all\n", Format::Xsf),
            ("BEGIN_INFO\nEND_INFO\nCRYSTAL\nPRIMVEC\nPRIMCOORD 1\n", Format::Xsf),
            ("made by x\nNumber of particles = 8\n", Format::Cfg),
            ("t\n 2\n   -3HIS      N    1   0.305   0.837   1.095\n", Format::Gro),
            ("Points_0,Points_1,Points_2\n", Format::Csv),
            (",x_coord,y_coord,z_coord\n0,1,2,3\n", Format::Csv),
            (",px,py,pz\n0,1,2,3\n", Format::Csv),
        ] {
            assert_eq!(detect(text), Ok(expected), "{text}");
        }
        for other in ["id name note\n1 ATOMS 3\n", "a b\ndata_x and more\n", "CRYSTAL PRIMVEC\n"] {
            assert!(detect(other).is_err(), "{other}");
        }
    }

    #[test]
    fn names_tell_the_format_if_the_content_does_not() {
        let of = |name: &str| named(Path::new(name), b"_cell_length_a 4\n");
        for (name, expected) in [
            ("a/b.PDB", Some(Format::Pdb)),
            ("b.ent.gz", Some(Format::Pdb)),
            ("CONTCAR", Some(Format::Poscar)),
            ("b.lammpstrj.zst", Some(Format::LammpsDump)),
            ("b.cif", Some(Format::Cif)),
            ("b.txt", None),
            ("data.txt", None),
            ("b.gsd", None),
            ("-", None),
        ] {
            assert_eq!(of(name), expected, "{name}");
        }
        assert_eq!(named(Path::new("b.cif"), b""), Some(Format::MmCif));
    }

    #[test]
    fn content_tells_the_format() {
        assert_eq!(detect("60\nfullerene\nC 0 0 0\n"), Ok(Format::Xyz));
        assert_eq!(detect("# rows\n\n1 2 3 .5\n"), Ok(Format::Xyzr));
        assert_eq!(detect("\u{FEFF}-1,2e5;nan\r\n"), Ok(Format::Xyzr));
        assert_eq!(detect("id,X,Y,Z\n1,2,3,4\n"), Ok(Format::Csv));
        assert_eq!(detect("\"x\";\"y\";\"z\"\n"), Ok(Format::Csv));
        assert_eq!(detect("x\ty\tz\n"), Ok(Format::Csv));
        assert_eq!(detect("sep=;\nx;y;z\n1;2;3\n"), Ok(Format::Csv));
        assert_eq!(detect("X (m), Y (m), Z (m)\n"), Ok(Format::Csv));
        assert_eq!(detect("x y z radius\n1 2 3 4\n"), Ok(Format::Xyzr));
        assert_eq!(detect("px py pz\n1 2,5 3\n"), Ok(Format::Xyzr));
        assert_eq!(detect("px;py;pz;name\n1;2,5;3;a\n"), Ok(Format::Csv));
        assert!(detect("four words of text\n1 2 3\n").is_err());
        assert!(detect(" \n# nothing\n").is_err_and(|message| message == "holds no particles"));
        assert_eq!(detect("ITEM: TIMESTEP\n0\n"), Ok(Format::LammpsDump));
        assert_eq!(detect("# LAMMPS\n\n 17 atoms\n"), Ok(Format::LammpsData));
        assert_eq!(
            detect("LAMMPS data file\n\n17 atoms\n\n1 atom types\n"),
            Ok(Format::LammpsData)
        );
        let atom = "    1MET      N    1   5.202   4.356   3.155\n";
        assert_eq!(detect(&format!("12\n1\n{atom}")), Ok(Format::Gro));
        assert_eq!(detect(&format!("\n 1\n{atom}")), Ok(Format::Gro));
        assert_eq!(detect("12\n1\nC 1.0 2.0 3.0\n"), Ok(Format::Xyz));
        assert_eq!(detect("REMARK  made by hand\n"), Ok(Format::Pdb));
        assert_eq!(detect("ATOM      1  N   MET"), Ok(Format::Pdb));
        assert_eq!(detect("# comment\ndata_3KPR\n"), Ok(Format::MmCif));
        assert_eq!(detect("data_x\n_cell_length_a 4\n"), Ok(Format::Cif));
        assert!(detect("BEGIN_SCENE\n").is_err());
        assert!(detect("50 pct water\n").is_err());
    }
}
