//! What a run found, as tables for the terminal.

use indicatif::HumanCount;
use spherule::stress::{Form, FormReport, RegimeReport, Report};
use std::fmt::Write;

/// Columns under one heading.
struct Group {
    heading: &'static str,
    /// The first row names the columns.
    columns: Vec<Vec<String>>,
}

/// Forms that are shown, and their names.
const USUAL: &[(Form, &str)] =
    &[(Form::Naive, "naive"), (Form::Good, "good f32"), (Form::Spherule, "Spherule")];

/// The same, and the usual remedy for self-hits.
const SURFACE: &[(Form, &str)] = &[
    (Form::Naive, "naive"),
    (Form::NaiveOffset, "t > 1e-4"),
    (Form::Good, "good f32"),
    (Form::Spherule, "Spherule"),
];

/// The tables.
pub(super) fn text(report: &Report) -> String {
    let regimes = &report.regimes;
    let rays = |of: fn(&RegimeReport) -> u64| {
        let counts = regimes.iter().map(|regime| HumanCount(of(regime)).to_string());
        let columns = vec![["rays".to_owned()].into_iter().chain(counts).collect()];
        Group { heading: "", columns }
    };
    let share = |heading, of: fn(&FormReport) -> u64| {
        group(regimes, heading, USUAL, move |regime, form| percent(of(form), regime.rays))
    };
    let error = |heading, of: fn(&FormReport) -> f64| {
        group(regimes, heading, USUAL, move |_, form| match form.measured {
            0 => "-".to_owned(),
            _ => size(of(form)),
        })
    };
    let surface = |heading, of: fn(&FormReport) -> u64, all: fn(&RegimeReport) -> u64| {
        group(regimes, heading, SURFACE, move |regime, form| percent(of(form), all(regime)))
    };
    let tables = [
        vec![
            names(regimes, "decisions"),
            rays(|regime| regime.rays),
            share("wrong hit or miss", |form| form.wrong_hits),
            share("wrong sphere", |form| form.wrong_spheres),
            bounds(regimes),
        ],
        vec![
            names(regimes, "largest errors"),
            error("distance, 2^-23 t", |form| form.t_error),
            error("distance, natural unit", |form| form.t_error_natural),
            error("normal, 2^-23 rad", |form| form.normal_error),
        ],
        vec![
            names(regimes, "from surfaces"),
            rays(|regime| regime.leaving + regime.entering),
            surface("self-hits", |form| form.self_hits, |regime| regime.leaving),
            surface("missed exits", |form| form.missed_exits, |regime| regime.entering),
        ],
    ];
    tables.iter().map(|table| aligned(table)).collect::<Vec<_>>().join("\n")
}

fn names(regimes: &[RegimeReport], heading: &'static str) -> Group {
    let names = regimes.iter().map(|regime| regime.name.to_owned());
    Group { heading, columns: vec![[String::new()].into_iter().chain(names).collect()] }
}

/// What is wrong about bounds: of this program, which alone is asked.
fn bounds(regimes: &[RegimeReport]) -> Group {
    let wrong =
        |regime: &RegimeReport, form: &FormReport| percent(form.wrong_bounds, regime.bounds);
    group(regimes, "wrong bound", &[(Form::Spherule, "Spherule")], wrong)
}

/// One column for each form.
fn group(
    regimes: &[RegimeReport],
    heading: &'static str,
    forms: &[(Form, &str)],
    cell: impl Fn(&RegimeReport, &FormReport) -> String,
) -> Group {
    let column = |&(form, name): &(Form, &str)| {
        let cells = regimes.iter().map(|regime| cell(regime, regime.form(form)));
        [name.to_owned()].into_iter().chain(cells).collect()
    };
    Group { heading, columns: forms.iter().map(column).collect() }
}

/// Nothing is 0 that is not.
fn percent(part: u64, all: u64) -> String {
    let percent = 100.0 * part as f64 / all.max(1) as f64;
    match part {
        0 => "0".to_owned(),
        _ if percent >= 0.01 => format!("{percent:.2} %"),
        _ => format!("{percent:.0e} %"),
    }
}

fn size(error: f64) -> String {
    if error == 0.0 || (0.1..1e4).contains(&error) {
        format!("{error:.1}")
    } else {
        format!("{error:.0e}")
    }
}

/// The first column to the left, the others to the right, headings above their first column.
fn aligned(groups: &[Group]) -> String {
    let width = |column: &[String]| column.iter().map(|cell| cell.chars().count()).max();
    let mut lines = vec![String::new(); 1 + groups[0].columns[0].len()];
    for (at, group) in groups.iter().enumerate() {
        let (heading, rows) = lines.split_at_mut(1);
        let start = rows[0].chars().count();
        for column in &group.columns {
            let width = width(column).unwrap_or(0);
            for (line, cell) in rows.iter_mut().zip(column) {
                // Writing to a string cannot fail.
                let _ = match at {
                    0 => write!(line, "{cell:<width$}"),
                    _ => write!(line, "  {cell:>width$}"),
                };
            }
        }
        let end = rows[0].chars().count();
        let room = end - start - if at == 0 { 0 } else { 2 };
        let gap = if at == 0 { "" } else { "  " };
        let _ = write!(heading[0], "{gap}{:<room$}", group.heading);
    }
    lines.iter().fold(String::new(), |text, line| text + line.trim_end() + "\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule::stress::{Options, REGIMES, run};

    #[test]
    fn numbers_are_short_and_only_zero_is_zero() {
        assert_eq!(
            [percent(0, 9), percent(1, 3), percent(1, 1_000_000)],
            ["0", "33.33 %", "1e-4 %"]
        );
        assert_eq!(percent(0, 0), "0");
        let sizes = [0.0, 0.25, 1234.5, 1.2e-9, 3e7, f64::INFINITY].map(size);
        assert_eq!(sizes, ["0.0", "0.2", "1234.5", "1e-9", "3e7", "inf"]);
    }

    #[test]
    fn columns_stand_below_their_headings() {
        let regimes = REGIMES.iter().collect();
        let text = text(&run(&Options { rays: 3300, seed: 0, regimes }, &|_| ()));
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 3 * (REGIMES.len() + 2) + 2);
        assert!(lines[0].starts_with("decisions") && lines[2].starts_with("near_unit"));
        let (group, name) = (lines[0].find("wrong sphere"), lines[1].rfind("naive"));
        assert!(group <= name && name < group.map(|at| at + 12), "{text}");
        assert!(lines.iter().all(|line| line.chars().count() <= 120), "{text}");
    }
}
