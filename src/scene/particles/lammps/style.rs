//! What the columns of `Atoms` are in a LAMMPS data file (<https://docs.lammps.org/read_data.html>).

use crate::scene::particles::number;

/// Atom styles and their columns.
pub(super) const STYLES: [(&str, &str); 29] = [
    ("angle", "id mol type x y z"),
    ("atomic", "id type x y z"),
    ("body", "id type bodyflag mass x y z"),
    ("bond", "id mol type x y z"),
    ("bpm/sphere", "id mol type diameter density x y z"),
    ("charge", "id type q x y z"),
    ("dielectric", "id type q x y z mux muy muz area ed em epsilon curvature"),
    ("dipole", "id type q x y z mux muy muz"),
    ("dpd", "id type theta x y z"),
    ("edpd", "id type edpd_temp edpd_cv x y z"),
    ("electron", "id type q espin eradius x y z"),
    ("ellipsoid", "id type ellipsoidflag density x y z"),
    ("full", "id mol type q x y z"),
    ("hybrid", "id type x y z"),
    ("line", "id mol type lineflag density x y z"),
    ("mdpd", "id type rho x y z"),
    ("mesont", "id mol type bond_nt mass mradius mlength buckling x y z"),
    ("molecular", "id mol type x y z"),
    ("peri", "id type volume density x y z"),
    ("rheo", "id type status rho x y z"),
    ("rheo/thermal", "id type status rho energy x y z"),
    ("smd", "id type mol volume mass kradius radius x0 y0 z0 x y z"),
    ("sph", "id type rho esph cv x y z"),
    ("sphere", "id type diameter density x y z"),
    ("spin", "id type x y z spx spy spz sp"),
    ("tdpd", "id type x y z"),
    ("template", "id type mol template_index template_atom x y z"),
    ("tri", "id mol type triangleflag density x y z"),
    ("wavepacket", "id type q espin eradius etag cs_re cs_im x y z"),
];

/// Styles that are guessed.
const GUESSED: [&str; 5] = ["atomic", "charge", "molecular", "full", "sphere"];

/// Names of the columns of a style; `None` if there is no such style.
pub(super) fn columns(style: &str) -> Option<Vec<String>> {
    let (_, columns) = STYLES.iter().find(|(name, _)| *name == style)?;
    Some(columns.split(' ').map(str::to_owned).collect())
}

/// The styles that some rows may be of; `types` is how many types of atoms there are.
pub(super) fn guess(rows: &[Vec<Vec<u8>>], types: u64) -> Vec<&'static str> {
    let fits = |style: &&&str| {
        let columns = columns(style).unwrap_or_default();
        !rows.is_empty() && may_be(rows, &columns, types)
    };
    let fitting: Vec<&str> = GUESSED.iter().filter(fits).copied().collect();
    // What may be a number of a molecule is one: charges that are all whole, positive and no
    // greater than the number of types are not found in files.
    if fitting.contains(&"molecular") { vec!["molecular"] } else { fitting }
}

fn may_be(rows: &[Vec<Vec<u8>>], columns: &[String], types: u64) -> bool {
    let whole = |field: &Vec<u8>| number::whole(field);
    let image = |row: &[Vec<u8>]| {
        row.iter().all(|field| number::parse(field).is_some_and(|value| value.fract() == 0.0))
    };
    let widths = rows.iter().all(|row| {
        let more = row.get(columns.len()..);
        more.is_some_and(|more| more.is_empty() || more.len() == 3 && image(more))
    });
    widths
        && columns.iter().enumerate().all(|(at, column)| {
            let mut fields = rows.iter().map(|row| &row[at]);
            let mut numbers = fields.clone().map(|field| number::parse(field).unwrap_or(f64::NAN));
            match column.as_str() {
                "id" | "mol" => fields.all(|field| whole(field).is_some()),
                "type" => fields.all(|field| {
                    whole(field).is_some_and(|kind| (1..=types.max(1)).contains(&kind))
                }),
                "diameter" => numbers.all(|value| value >= 0.0),
                "density" => numbers.all(|value| value > 0.0),
                // Positions are not all whole.
                "x" | "y" | "z" => {
                    numbers.all(f64::is_finite)
                        && (rows.len() < 3
                            || column != "x"
                            || fields.any(|field| whole(field).is_none()))
                }
                _ => numbers.all(f64::is_finite),
            }
        })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guess_of(rows: &[&str], types: u64) -> Vec<&'static str> {
        let fields = |row: &&str| row.split(' ').map(|field| field.as_bytes().to_vec()).collect();
        guess(&rows.iter().map(fields).collect::<Vec<_>>(), types)
    }

    #[test]
    fn columns_tell_styles() {
        assert_eq!(guess_of(&["1 1 0.5 1.5 2.5", "2 2 3 4 5.5"], 2), ["atomic"]);
        assert_eq!(guess_of(&["1 1 0.5 1.5 2.5 0 0 -1"], 1), ["atomic"]);
        assert_eq!(guess_of(&["1 1 -0.8 0.5 1.5 2.5", "2 2 0.4 3 4 5.5"], 2), ["charge"]);
        assert_eq!(guess_of(&["1 1 1 0.5 1.5 2.5", "2 1 2 3 4 5.5"], 2), ["molecular"]);
        assert_eq!(guess_of(&["1 1 1 -0.8 0.5 1.5 2.5", "2 1 2 0.4 3 4 5.5"], 2), ["full"]);
        assert_eq!(
            guess_of(&["1 1 27.01 1 21.5 19.8 0 0 0 0", "2 1 1.2 1 4.5 2.0 0 0 0 0"], 1),
            ["sphere"]
        );
        assert_eq!(
            guess_of(&["1 1 1 1.0 0.5 1.5 2.5", "2 1 1 1.0 3 4 5.5"], 1),
            ["full", "sphere"]
        );
        assert!(guess_of(&["1 1 0.5"], 1).is_empty());
        assert!(guess_of(&["1 1 a b c"], 1).is_empty());
    }
}
