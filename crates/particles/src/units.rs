//! Units in column names, as in `x (m)`, `radius [nm]` and `z / um`.

use super::frame::LengthUnit;

/// Units of length, in meters.
const LENGTHS: [(&str, f64); 19] = [
    ("pm", 1e-12),
    ("A", 1e-10),
    ("\u{c5}", 1e-10),
    ("\u{212b}", 1e-10),
    ("ang", 1e-10),
    ("angstrom", 1e-10),
    ("Angstrom", 1e-10),
    ("nm", 1e-9),
    ("um", 1e-6),
    ("\u{b5}m", 1e-6),
    ("\u{3bc}m", 1e-6),
    ("micron", 1e-6),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("m", 1.0),
    ("km", 1e3),
    ("pc", 3.085_677_581_491_367e16),
    ("kpc", 3.085_677_581_491_367e19),
    ("Mpc", 3.085_677_581_491_367e22),
];

/// Splits a column name into the bare name and the unit.
pub(crate) fn split(name: &str) -> (&str, Option<&str>) {
    for (open, close) in [('(', ')'), ('[', ']')] {
        let inner = name.strip_suffix(close).and_then(|name| name.rsplit_once(open));
        if let Some((bare, unit)) = inner.filter(|(bare, _)| !bare.trim().is_empty()) {
            return (bare.trim(), Some(unit.trim()));
        }
    }
    match name.rsplit_once('/') {
        Some((bare, unit)) if !bare.trim().is_empty() && meters(unit.trim()).is_some() => {
            (bare.trim(), Some(unit.trim()))
        }
        _ => (name, None),
    }
}

fn meters(unit: &str) -> Option<f64> {
    LENGTHS.iter().find(|(own, _)| *own == unit).map(|(_, meters)| *meters)
}

/// Returns the conversion factor from lengths of the first column to those of the second, by the units
/// in their names; 1 if one has none.
pub(crate) fn factor(name: &str, other: &str) -> Result<f64, String> {
    let ((_, Some(unit)), (_, Some(wanted))) = (split(name), split(other)) else { return Ok(1.0) };
    if unit == wanted {
        return Ok(1.0);
    }
    let factor = meters(unit).zip(meters(wanted)).map(|(unit, wanted)| unit / wanted);
    factor.ok_or_else(|| {
        format!(
            "`{name}` and `{other}` are in different units; give both columns the same unit, or \
             read others, as in --columns x=NAME,y=NAME,z=NAME,radius=NAME"
        )
    })
}

/// Returns the unit of length in a column's name.
pub(crate) fn length(name: &str) -> LengthUnit {
    let meters = split(name).1.and_then(meters).unwrap_or(0.0);
    let known = [
        (1e-10, LengthUnit::Angstrom),
        (1e-9, LengthUnit::Nanometer),
        (1e-6, LengthUnit::Micrometer),
        (1e-2, LengthUnit::Centimeter),
        (1.0, LengthUnit::Meter),
    ];
    known.iter().find(|(own, _)| *own == meters).map_or(LengthUnit::Unknown, |(_, unit)| *unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_end_in_units() {
        for (name, expected) in [
            ("x (m)", ("x", Some("m"))),
            ("radius[nm]", ("radius", Some("nm"))),
            ("z / um", ("z", Some("um"))),
            ("E (kJ/mol)", ("E", Some("kJ/mol"))),
            ("a/b", ("a/b", None)),
            ("x", ("x", None)),
            ("(m)", ("(m)", None)),
            ("", ("", None)),
        ] {
            assert_eq!(split(name), expected, "{name}");
        }
    }

    #[test]
    fn lengths_of_known_units_are_converted() {
        let near = |found: Result<f64, String>, expected: f64| {
            assert!(found.is_ok_and(|found| (found / expected - 1.0).abs() < 1e-12), "{expected}");
        };
        near(factor("radius (mm)", "x (m)"), 1e-3);
        near(factor("r [\u{c5}]", "x (nm)"), 0.1);
        near(factor("radius", "x (m)"), 1.0);
        near(factor("radius (px)", "x (px)"), 1.0);
        assert!(factor("radius (px)", "x (m)").is_err());
        assert_eq!(length("x (nm)"), LengthUnit::Nanometer);
        assert_eq!((length("x (km)"), length("x")), (LengthUnit::Unknown, LengthUnit::Unknown));
    }
}
