//! Parses numbers in text.

use std::str;

/// Words for a missing value in tables of numbers, among them those of pandas and R; others are numbers: `nan`.
const MISSING: [&[u8]; 13] = [
    b"", b"NA", b"N/A", b"n/a", b"na", b"null", b"NULL", b"Null", b"None", b"none", b"<NA>",
    b"#N/A", b"#NA",
];

/// Returns whether a field is a missing value, not a number.
pub(crate) fn is_missing(field: &[u8]) -> bool {
    MISSING.contains(&field)
}

/// Parses a number, ignoring surrounding blanks; returns `None` if it is invalid. In addition to
/// Rust's syntax, exponents may begin with `d`, as in Fortran, or with `*^`, as in Mathematica; and those of three digits with
/// their sign, as in Fortran.
pub(crate) fn parse(field: &[u8]) -> Option<f64> {
    fast_float2::parse(field).ok().or_else(|| rare(field))
}

fn rare(field: &[u8]) -> Option<f64> {
    let text = str::from_utf8(field).ok()?.trim();
    let parsed = |text: String| fast_float2::parse(text).ok();
    text.parse()
        .ok()
        .or_else(|| parsed(text.replace(['d', 'D'], "e")))
        .or_else(|| parsed(text.replacen("*^", "e", 1)))
        .or_else(|| {
            let (mantissa, exponent) = text.split_at_checked(text.len().checked_sub(4)?)?;
            let is_fortran = mantissa.contains('.') && exponent.starts_with(['+', '-']);
            parsed(format!("{mantissa}e{exponent}")).filter(|_| is_fortran)
        })
}

/// Replaces the decimal comma of a number by a point; returns `None` if it has none.
pub(crate) fn with_point(field: &[u8]) -> Option<Vec<u8>> {
    let comma = memchr::memchr(b',', field)?;
    let is_part = |byte: &u8| byte.is_ascii_digit() || b"+-eEdD".contains(byte);
    let (whole, rest) = (&field[..comma], &field[comma + 1..]);
    if !whole.iter().chain(rest).all(is_part) || !rest.first()?.is_ascii_digit() {
        return None;
    }
    let mut text = field.to_vec();
    text[comma] = b'.';
    parse(&text).map(|_| text)
}

/// Parses a number with a decimal point or a decimal comma.
pub(crate) fn parse_any_point(field: &[u8]) -> Option<f64> {
    parse(field).or_else(|| parse(&with_point(field.trim_ascii())?))
}

/// Parses a whole number without a sign.
pub(crate) fn whole(field: &[u8]) -> Option<u64> {
    str::from_utf8(field.trim_ascii()).ok()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn all_spellings_are_numbers() {
        for (text, number) in [
            ("1", 1.0),
            ("+2", 2.0),
            ("-3.", -3.0),
            (".5", 0.5),
            ("-.25", -0.25),
            ("1e3", 1e3),
            ("1E+03", 1e3),
            ("1.5d-2", 0.015),
            ("2.D+01", 20.0),
            ("1.5*^-3", 0.0015),
            ("-2.*^7", -2e7),
            ("1.5+003", 1500.0),
            ("-.25-101", -0.25e-101),
            (" 1.5+003 ", 1500.0),
            ("007", 7.0),
            ("1e-400", 0.0),
            ("1e400", f64::INFINITY),
            ("-inf", f64::NEG_INFINITY),
            ("Infinity", f64::INFINITY),
            (" 4 ", 4.0),
            ("0.1000000000000000055511151231257827", 0.1),
        ] {
            assert_eq!(parse(text.as_bytes()), Some(number), "{text}");
        }
        assert!(parse(b"NaN").is_some_and(f64::is_nan));
        assert!(parse(b"-nan").is_some_and(f64::is_nan));
    }

    #[test]
    fn other_texts_are_not_numbers() {
        for text in [
            "",
            " ",
            "x",
            "1x",
            "1 2",
            "--1",
            "1e",
            "e5",
            "0x10",
            "1,5",
            "1_000",
            "***",
            "1*^",
            "*^2",
            "2020-01-001",
            "10-101",
            "1.5+03",
            "1.5+0003",
            "1.5e2+003",
            "-61.500-101.250",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text}");
        }
        assert_eq!(parse(&[0xFF]), None);
        assert_eq!((whole(b" 12 "), whole(b"-1"), whole(b"1.5")), (Some(12), None, None));
    }

    #[test]
    fn words_mean_missing_values() {
        for word in ["NA", "N/A", "null", "None", ""] {
            assert!(is_missing(word.as_bytes()) && parse(word.as_bytes()).is_none(), "{word}");
        }
        assert!(!is_missing(b"nan") && !is_missing(b"Na") && !is_missing(b"0"));
    }

    #[test]
    fn decimal_commas_become_points() {
        for (text, expected) in [("1,5", 1.5), ("-0,25e3", -250.0), ("+,5", 0.5), ("1,234", 1.234)]
        {
            let text = with_point(text.as_bytes()).expect("a number");
            assert_eq!(parse(&text), Some(expected));
        }
        for text in ["1", "1,", ",", "1,2,3", "1.234,5", "1,234.5", "a,5", "1,-5", "1, 5"] {
            assert_eq!(with_point(text.as_bytes()), None, "{text}");
        }
        assert_eq!((parse_any_point(b" 1,5"), parse_any_point(b"1.5")), (Some(1.5), Some(1.5)));
    }

    proptest! {
        #[test]
        fn numbers_survive_formatting(bits in any::<u64>()) {
            let number = f64::from_bits(bits);
            prop_assume!(!number.is_nan());
            for text in [format!("{number}"), format!("{number:e}"), format!("{number:E}")] {
                prop_assert_eq!(parse(text.as_bytes()), Some(number));
            }
        }
    }
}
