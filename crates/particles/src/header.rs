//! Header lines of tables: names of columns before rows of numbers.

use crate::{ReadOptions, fields::Fields, number, record};

/// Number of rows from which columns without names are detected.
pub(crate) const ROWS: usize = 200;

/// The warning about rows that have one column more than the header.
pub(crate) const UNNAMED: &str = "the first column has no name, and is read as that of the rows";

/// Returns the names in a header, separated by commas, semicolons, tabs or blanks, without quotes. A unit in brackets
/// belongs to the name before it.
pub(crate) fn names(line: &[u8]) -> Vec<String> {
    if is_separated(line) {
        return record::header_names(line);
    }
    let mut names: Vec<String> = Vec::new();
    let mut is_open = false;
    for field in Fields::blanks(line) {
        let field = String::from_utf8_lossy(unquoted(field));
        let is_unit = is_open || field.starts_with(['(', '[']);
        is_open = is_unit && !field.ends_with([')', ']']);
        match names.last_mut().filter(|_| is_unit) {
            Some(last) => *last = format!("{last} {field}"),
            None => names.push(field.into_owned()),
        }
    }
    names
}

/// Returns whether the names have separators other than blanks.
pub(crate) fn is_separated(line: &[u8]) -> bool {
    line.iter().any(|byte| b",;\t".contains(byte))
}

/// Returns whether a line is the header of a table: three names or more, and no number. Pandas leaves the name of row numbers empty.
pub(crate) fn is_header(names: &[String]) -> bool {
    let names = if names.first().is_some_and(String::is_empty) { &names[1..] } else { names };
    let is_name = |name: &String| !name.is_empty() && number::parse(name.as_bytes()).is_none();
    names.len() >= 3 && names.iter().all(is_name)
}

/// Returns a field without the quotes around it.
fn unquoted(field: &[u8]) -> &[u8] {
    field.strip_prefix(b"\"").and_then(|field| field.strip_suffix(b"\"")).unwrap_or(field)
}

/// Returns whether the first column of rows numbers or names them, as R and pandas write it without a name: its fields differ from
/// each other and are whole numbers or texts, while those of other columns aren't all whole.
pub(crate) fn has_index(rows: &[Vec<Vec<u8>>]) -> bool {
    let mut first: Vec<&[u8]> =
        rows.iter().filter_map(|row| row.first()).map(|field| unquoted(field)).collect();
    let is_whole = |field: &&[u8]| number::whole(field).is_some();
    let is_text = |field: &&[u8]| number::parse_any_point(field).is_none();
    let is_plain = first.iter().all(is_whole) || first.iter().all(is_text);
    first.sort_unstable();
    first.dedup();
    let all_whole = |row: &Vec<Vec<u8>>| row.iter().skip(1).all(|field| is_whole(&&field[..]));
    rows.len() > 1 && first.len() == rows.len() && is_plain && !rows.iter().any(all_whole)
}

/// Returns whether a row fits a header: it has the same number of fields, or one before them that has no name; and three numbers
/// or more.
pub(crate) fn is_row(names: &[String], separated: bool, row: &[u8]) -> bool {
    let fields: Vec<Vec<u8>> = if separated {
        record::header_names(row).into_iter().map(String::into_bytes).collect()
    } else {
        Fields::blanks(row).map(<[u8]>::to_vec).collect()
    };
    let numbers = fields.iter().filter(|field| number::parse_any_point(field).is_some());
    [names.len(), names.len() + 1].contains(&fields.len()) && numbers.count() >= 3
}

/// Returns the help for columns with unusual names: an option to type.
pub(crate) fn columns_help(names: &[String], options: &ReadOptions) -> String {
    let typed = |name: &String| !name.contains([',', '=']) && !name.is_empty();
    let taken = |name: &&String| !options.columns.roles.iter().any(|(_, own)| own == *name);
    let three: Vec<&str> =
        names.iter().filter(taken).filter(|name| typed(name)).take(3).map(String::as_str).collect();
    let [x, y, z] = three[..] else {
        return "name the columns, as in --columns x=NAME,y=NAME,z=NAME,radius=NAME".to_owned();
    };
    let columns = format!("x={x},y={y},z={z}");
    let is_plain = |letter: char| letter.is_ascii_alphanumeric() || "_=,.:-".contains(letter);
    let columns = if columns.chars().all(is_plain) { columns } else { format!("'{columns}'") };
    format!(
        "assign roles to the columns, as in --columns {columns}; roles are x, y, z, radius, diameter, type and others"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_split_into_names() {
        for (line, expected) in [
            ("x y z radius", &["x", "y", "z", "radius"][..]),
            ("x (m) y [um] z (a b)", &["x (m)", "y [um]", "z (a b)"]),
            ("x (m);y (m);\"z, height\"", &["x (m)", "y (m)", "z, height"]),
            ("a,b", &["a", "b"]),
        ] {
            assert_eq!(names(line.as_bytes()), expected, "{line}");
        }
        let header = |line: &str| is_header(&names(line.as_bytes()));
        assert!(header(",a,b,c") && !header(",a,b"));
        assert!(header("a b c") && !header("a b") && !header("a b 3") && !header("a,b,"));
        let below = |row: &str| is_row(&names(b"\"a\" b c d"), false, row.as_bytes());
        assert!(below("C 1,5 2 3") && !below("C 1 2 x") && !below("1 2 3"));
        assert!(below("7 C 1 2 3.5") && !below("7 7 C 1 2 3.5"));
    }

    #[test]
    fn columns_of_rows_are_numbers_or_names() {
        let rows = |text: &str| -> Vec<Vec<Vec<u8>>> {
            let fields = |row: &str| row.split(' ').map(Vec::from).collect();
            text.split('/').map(fields).collect()
        };
        for text in ["1 0.5/2 1.5", "\"a\" 0.5/\"b\" 0.5", "\"2\" 0.5/\"1\" 0.5"] {
            assert!(has_index(&rows(text)), "{text}");
        }
        for text in ["1 0.5/1 1.5", "1 2/2 3", "1 0.5", "0.5 0.5/0.6 0.5", "a 0.5/1 0.5"] {
            assert!(!has_index(&rows(text)), "{text}");
        }
    }

    #[test]
    fn help_can_be_typed() {
        let help = |names: &[&str]| {
            let names: Vec<String> = names.iter().map(|name| (*name).to_owned()).collect();
            columns_help(&names, &ReadOptions::default())
        };
        assert!(help(&["px", "py", "pz", "q"]).contains("--columns x=px,y=py,z=pz;"));
        assert!(help(&["a b", "py", "pz"]).contains("--columns 'x=a b,y=py,z=pz';"));
        assert!(help(&["px", "py"]).contains("--columns x=NAME"));
    }

    #[test]
    fn help_suggests_unused_columns_with_plain_names() {
        let names = ["a,b", "", "c=d", "px", "py", "pz", "q"].map(str::to_owned);
        let help = |roles: &str| {
            let columns = roles.parse().expect("columns");
            columns_help(&names, &ReadOptions { columns, ..ReadOptions::default() })
        };
        assert!(help("").contains("--columns x=px,y=py,z=pz;"), "{}", help(""));
        assert!(help("radius=px").contains("--columns x=py,y=pz,z=q;"), "{}", help("radius=px"));
    }
}
