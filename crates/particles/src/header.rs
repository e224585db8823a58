//! Header lines of tables: names of columns before rows of numbers.

use crate::{ReadOptions, fields::Fields, number, record};

/// Returns the names in a header, separated by commas, semicolons, tabs or blanks. A unit in brackets
/// belongs to the name before it.
pub(crate) fn names(line: &[u8]) -> Vec<String> {
    if is_separated(line) {
        return record::header_names(line);
    }
    let mut names: Vec<String> = Vec::new();
    let mut is_open = false;
    for field in Fields::blanks(line) {
        let field = String::from_utf8_lossy(field);
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

/// Returns whether a row fits a header: it has the same number of fields, and three numbers or more.
pub(crate) fn is_row(names: &[String], separated: bool, row: &[u8]) -> bool {
    let fields: Vec<Vec<u8>> = if separated {
        record::header_names(row).into_iter().map(String::into_bytes).collect()
    } else {
        Fields::blanks(row).map(<[u8]>::to_vec).collect()
    };
    let numbers = fields.iter().filter(|field| number::parse_any_point(field).is_some());
    fields.len() == names.len() && numbers.count() >= 3
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
        let below = |row: &str| is_row(&names(b"a b c d"), false, row.as_bytes());
        assert!(below("C 1,5 2 3") && !below("C 1 2 x") && !below("1 2 3"));
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
