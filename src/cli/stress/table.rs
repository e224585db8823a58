//! Tables of the results, for the terminal.

use spherule_measure::report::{Cell, Column, Style, Table};
use spherule_measure::stress::{BodyReport, Form, FormReport, RegimeReport, Report};

/// Intersection tests that are shown, and their names.
const USUAL: &[(Form, &str)] =
    &[(Form::Naive, "naive"), (Form::Good, "good f32"), (Form::Spherule, "Spherule")];

/// The same, with the common offset against self-intersection.
const SURFACE: &[(Form, &str)] = &[
    (Form::Naive, "naive"),
    (Form::NaiveOffset, "t > 1e-4"),
    (Form::Good, "good f32"),
    (Form::Spherule, "Spherule"),
];

/// This program, the only one that is tested with maximum distances.
const OWN: &[(Form, &str)] = &[(Form::Spherule, "Spherule")];

/// Formats the tables.
pub(super) fn text(report: &Report) -> String {
    let regimes = &report.regimes;
    let tables = [
        Grid::new("decisions", regimes)
            .rays(|regime| regime.rays)
            .shares("wrong hit or miss", USUAL, |form| form.wrong_hits, |regime| regime.rays)
            .shares("wrong sphere", USUAL, |form| form.wrong_spheres, |regime| regime.rays)
            .shares("wrong bound", OWN, |form| form.wrong_bounds, |regime| regime.bounds),
        Grid::new("largest errors", regimes)
            .errors("distance, 2^-23 t", |form| form.t_error)
            .errors("distance, natural unit", |form| form.t_error_natural)
            .errors("normal, 2^-23 rad", |form| form.normal_error),
        Grid::new("from surfaces", regimes)
            .rays(|regime| regime.leaving + regime.entering)
            .shares("self-hits", SURFACE, |form| form.self_hits, |regime| regime.leaving)
            .shares("missed exits", SURFACE, |form| form.missed_exits, |regime| regime.entering),
    ];
    let mut texts = tables.map(|grid| grid.table.text()).to_vec();
    if !report.bodies.is_empty() {
        texts.push(bodies(&report.bodies).text());
    }
    texts.join("\n")
}

/// A table with a row for each kind of body other than spheres.
fn bodies(bodies: &[BodyReport]) -> Table {
    let heading = "other bodies";
    let columns = [
        ("rays", ""),
        ("hit", ""),
        ("exact", ""),
        ("wrong hit or miss", ""),
        ("wrong body or distance", ""),
    ];
    let names = [Column::new("", "").group(heading)].into_iter();
    let columns = names.chain(columns.map(|(name, unit)| Column::new(name, unit).group("")));
    let mut table = Table::new(heading, heading, columns.collect());
    for body in bodies {
        let counts = [
            body.rays,
            body.hits,
            body.exact,
            body.wrong_hits,
            body.wrong_bodies + body.wrong_distances,
        ];
        table.push([body.name.into()].into_iter().chain(counts.map(Cell::Count)));
    }
    table
}

/// A table with a row for each regime.
struct Grid<'a> {
    table: Table,
    regimes: &'a [RegimeReport],
}

impl<'a> Grid<'a> {
    fn new(heading: &str, regimes: &'a [RegimeReport]) -> Self {
        let mut table = Table::new(heading, heading, vec![Column::new("", "").group(heading)]);
        for regime in regimes {
            table.push([regime.name.into()]);
        }
        Self { table, regimes }
    }

    fn column(mut self, column: Column, cell: impl Fn(&RegimeReport) -> Cell) -> Self {
        self.table.columns.push(column);
        for (row, regime) in self.table.rows.iter_mut().zip(self.regimes) {
            row.push(cell(regime));
        }
        self
    }

    fn rays(self, count: fn(&RegimeReport) -> u64) -> Self {
        self.column(Column::new("rays", ""), |regime| Cell::Count(count(regime)))
    }

    /// Adds a column for each intersection test: the fraction that is wrong.
    fn shares(
        self,
        group: &str,
        forms: &[(Form, &str)],
        part: fn(&FormReport) -> u64,
        all: fn(&RegimeReport) -> u64,
    ) -> Self {
        forms.iter().zip(headings(group)).fold(self, |grid, (&(form, name), group)| {
            let column = Column::new(name, "").group(group).style(Style::Percent);
            grid.column(column, |regime| {
                (part(regime.form(form)) as f64 / all(regime).max(1) as f64).into()
            })
        })
    }

    /// Adds a column for each intersection test: the size of the error.
    fn errors(self, group: &str, error: fn(&FormReport) -> f64) -> Self {
        USUAL.iter().zip(headings(group)).fold(self, |grid, (&(form, name), group)| {
            let column = Column::new(name, "").group(group).style(Style::Size);
            grid.column(column, |regime| {
                let form = regime.form(form);
                (form.measured > 0).then(|| error(form)).into()
            })
        })
    }
}

/// Returns the heading once, then empty headings.
fn headings(group: &str) -> impl Iterator<Item = &str> {
    [group].into_iter().chain(std::iter::repeat(""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_measure::stress::{Options, REGIMES, run};

    #[test]
    fn columns_are_aligned_with_their_headings() {
        let regimes = REGIMES.iter().collect();
        let text = text(&run(&Options { rays: 3300, seed: 0, regimes }, &|_| ()));
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len(), 3 * (REGIMES.len() + 2) + 2 + 1 + 4 + 2);
        assert!(lines[0].starts_with("decisions") && lines[2].starts_with("near_unit"));
        let (group, name) = (lines[0].find("wrong sphere"), lines[1].rfind("naive"));
        assert!(group <= name && name < group.map(|at| at + 12), "{text}");
        assert!(lines.iter().all(|line| line.chars().count() <= 120), "{text}");
    }
}
