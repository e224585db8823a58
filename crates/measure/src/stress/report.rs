//! Reports of runs.

use super::bodies::BodyReport;
use super::forms::Form;
use super::regimes::Regime;
use serde::Serialize;
use std::io::Write;

/// The report of a run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Number of rays in all regimes.
    pub rays: u64,
    /// Report of each regime.
    pub regimes: Vec<RegimeReport>,
    /// Report of each kind of body other than spheres; empty if only some regimes were tested.
    pub bodies: Vec<BodyReport>,
}

/// The report of a regime.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegimeReport {
    /// Name of the regime.
    pub name: &'static str,
    /// Description of the regime.
    pub about: &'static str,
    /// Number of rays.
    pub rays: u64,
    /// Number of rays that hit.
    pub hits: u64,
    /// Number of rays for which the reference needed integer arithmetic.
    pub close: u64,
    /// Number of decisions for which Spherule needed exact arithmetic.
    pub exact: u64,
    /// Number of any-hit queries with a maximum distance near that of the hit: nine for one in 16 rays
    /// that hit.
    pub bounds: u64,
    /// Number of further rays that start on a surface and point outward.
    pub leaving: u64,
    /// Number of further rays that start on a surface and point inward.
    pub entering: u64,
    /// Report of each test, in the order of [`Form::ALL`].
    pub forms: [FormReport; Form::ALL.len()],
}

/// The report of an intersection test in a regime.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FormReport {
    /// Name of the test.
    pub form: &'static str,
    /// Number of rays with a false hit or a false miss.
    pub wrong_hits: u64,
    /// Number of rays with a hit of the wrong sphere.
    pub wrong_spheres: u64,
    /// Number of wrong answers to queries with a maximum distance. 0 for the single-precision tests, to
    /// which they do not apply: most of these distances are not single-precision numbers.
    pub wrong_bounds: u64,
    /// Number of rays whose distance and normal were compared with the reference's. Only rays with the
    /// right sphere are compared; if there are none, the errors are 0.
    pub measured: u64,
    /// Maximum relative error of the distance, in units of 2^-23.
    pub t_error: f64,
    /// Maximum error of the distance in its natural unit
    /// ([`t_unit`](super::reference::Solution::t_unit)).
    pub t_error_natural: f64,
    /// Maximum angle between the computed and the true normal, in units of 2^-23 radians.
    pub normal_error: f64,
    /// Number of rays that start outward from a surface and hit their own sphere.
    pub self_hits: u64,
    /// Number of rays that start inward from a surface and miss the far side: no hit, or one at less than
    /// half or more than twice the distance.
    pub missed_exits: u64,
}

impl FormReport {
    /// Returns a report without rays.
    fn new(form: Form) -> Self {
        Self {
            form: form.name(),
            wrong_hits: 0,
            wrong_spheres: 0,
            wrong_bounds: 0,
            measured: 0,
            t_error: 0.0,
            t_error_natural: 0.0,
            normal_error: 0.0,
            self_hits: 0,
            missed_exits: 0,
        }
    }

    /// Returns the number of wrong decisions of all kinds.
    pub fn wrong(&self) -> u64 {
        let decisions = self.wrong_hits + self.wrong_spheres + self.wrong_bounds;
        decisions + self.self_hits + self.missed_exits
    }

    fn add(&mut self, other: &Self) {
        self.wrong_hits += other.wrong_hits;
        self.wrong_spheres += other.wrong_spheres;
        self.wrong_bounds += other.wrong_bounds;
        self.measured += other.measured;
        self.t_error = self.t_error.max(other.t_error);
        self.t_error_natural = self.t_error_natural.max(other.t_error_natural);
        self.normal_error = self.normal_error.max(other.normal_error);
        self.self_hits += other.self_hits;
        self.missed_exits += other.missed_exits;
    }
}

impl RegimeReport {
    /// Returns a report without rays.
    pub(super) fn new(regime: &Regime) -> Self {
        Self {
            name: regime.name,
            about: regime.about,
            rays: 0,
            hits: 0,
            close: 0,
            exact: 0,
            bounds: 0,
            leaving: 0,
            entering: 0,
            forms: Form::ALL.map(FormReport::new),
        }
    }

    /// Adds another report. Sums and maxima do not depend on the order.
    pub(super) fn merged(mut self, other: &Self) -> Self {
        self.rays += other.rays;
        self.hits += other.hits;
        self.close += other.close;
        self.exact += other.exact;
        self.bounds += other.bounds;
        self.leaving += other.leaving;
        self.entering += other.entering;
        for (form, other) in self.forms.iter_mut().zip(&other.forms) {
            form.add(other);
        }
        self
    }

    /// Returns the report of a test.
    pub fn form(&self, form: Form) -> &FormReport {
        &self.forms[form as usize]
    }

    pub(super) fn form_mut(&mut self, form: Form) -> &mut FormReport {
        &mut self.forms[form as usize]
    }

    /// Returns the fraction of rays with a false hit, a false miss or the wrong sphere.
    pub fn wrong_fraction(&self, form: Form) -> f64 {
        let form = self.form(form);
        (form.wrong_hits + form.wrong_spheres) as f64 / self.rays.max(1) as f64
    }
}

impl Report {
    /// Returns the number of wrong decisions of a test in all regimes.
    pub fn wrong(&self, form: Form) -> u64 {
        self.regimes.iter().map(|regime| regime.form(form).wrong()).sum()
    }

    /// Returns the number of wrong answers of Spherule of all kinds, for spheres and for other bodies.
    pub fn all_wrong(&self) -> u64 {
        let of_bodies = self.bodies.iter().map(BodyReport::wrong).sum::<u64>();
        self.wrong(Form::Spherule) + of_bodies
    }

    /// Returns the number of rays among bodies other than spheres.
    pub fn body_rays(&self) -> u64 {
        self.bodies.iter().map(|report| report.rays).sum()
    }

    /// Returns the number of rays that start on a surface.
    pub fn surface_rays(&self) -> u64 {
        self.regimes.iter().map(|regime| regime.leaving + regime.entering).sum()
    }

    /// Returns the number of queries with a maximum distance.
    pub fn bounds(&self) -> u64 {
        self.regimes.iter().map(|regime| regime.bounds).sum()
    }

    /// Writes CSV: a header, then a row for each regime and test.
    ///
    /// # Errors
    /// The writer fails.
    pub fn write_csv(&self, writer: impl Write) -> Result<(), csv::Error> {
        let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(writer);
        writer.write_record(COLUMNS)?;
        for regime in &self.regimes {
            for form in &regime.forms {
                let counts = [
                    regime.rays,
                    regime.hits,
                    regime.close,
                    regime.exact,
                    regime.bounds,
                    regime.leaving,
                    regime.entering,
                ];
                writer.serialize((regime.name, counts, form))?;
            }
        }
        writer.flush()?;
        Ok(())
    }
}

/// The columns of [`Report::write_csv`].
const COLUMNS: [&str; 18] = [
    "regime",
    "rays",
    "hits",
    "close",
    "exact",
    "bounds",
    "leaving",
    "entering",
    "form",
    "wrong_hits",
    "wrong_spheres",
    "wrong_bounds",
    "measured",
    "t_error",
    "t_error_natural",
    "normal_error",
    "self_hits",
    "missed_exits",
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stress::REGIMES;

    fn report() -> Report {
        let mut regime = RegimeReport::new(&REGIMES[0]);
        regime.rays = 10;
        regime.form_mut(Form::Naive).wrong_hits = 2;
        regime.form_mut(Form::Naive).self_hits = 4;
        regime.form_mut(Form::Good).t_error = 1.5;
        regime.bounds = 7;
        Report { seed: 3, rays: 10, regimes: vec![regime], bodies: Vec::new() }
    }

    #[test]
    fn counts_add_up_and_errors_are_the_largest() {
        let one = report().regimes.remove(0);
        let mut other = one.clone();
        other.form_mut(Form::Good).t_error = 7.0;
        other.form_mut(Form::Spherule).wrong_bounds = 3;
        let both = one.merged(&other);
        assert_eq!((both.rays, both.form(Form::Naive).wrong_hits), (20, 4));
        assert_eq!(both.form(Form::Good).t_error, 7.0);
        assert_eq!(both.form(Form::Naive).wrong(), 12);
        assert_eq!((both.form(Form::Spherule).wrong(), both.bounds), (3, 14));
        assert_eq!(both.wrong_fraction(Form::Naive), 0.2);
    }

    #[test]
    fn csv_has_a_row_for_each_form() {
        let mut text = Vec::new();
        report().write_csv(&mut text).unwrap();
        let mut rows = csv::Reader::from_reader(&text[..]);
        assert_eq!(rows.headers().unwrap(), &COLUMNS[..]);
        let rows: Vec<_> = rows.records().map(Result::unwrap).collect();
        let forms: Vec<_> = rows.iter().map(|row| row[8].to_owned()).collect();
        assert_eq!(forms, Form::ALL.map(Form::name));
        assert_eq!((&rows[0][0], &rows[0][9], &rows[2][13]), ("near_unit", "2", "1.5"));
    }
}
