//! What a run found, in numbers.

use super::forms::Form;
use super::regimes::Regime;
use serde::Serialize;
use std::io::Write;

/// What a run found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Report {
    /// Seed of all random numbers.
    pub seed: u64,
    /// Rays of all regimes.
    pub rays: u64,
    /// Regime by regime.
    pub regimes: Vec<RegimeReport>,
}

/// What a run found in one regime.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RegimeReport {
    /// Name of the regime.
    pub name: &'static str,
    /// What it is.
    pub about: &'static str,
    /// Rays tried.
    pub rays: u64,
    /// Rays that hit.
    pub hits: u64,
    /// Rays that the reference needed whole numbers for.
    pub close: u64,
    /// Decisions that Spherule needed arithmetic without rounding for.
    pub exact: u64,
    /// Bounds about the distances of hits: seven for each of one ray in 16 that hits. About each it is
    /// asked whether anything is nearer.
    pub bounds: u64,
    /// Further rays that start on a surface and go outward.
    pub leaving: u64,
    /// Further rays that start on a surface and go inward.
    pub entering: u64,
    /// Form by form, in the order of [`Form::ALL`].
    pub forms: [FormReport; Form::ALL.len()],
}

/// How one form did in one regime.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FormReport {
    /// Name of the form.
    pub form: &'static str,
    /// Rays that it says hit something and do not, or the other way round.
    pub wrong_hits: u64,
    /// Rays that hit another sphere than it says.
    pub wrong_spheres: u64,
    /// Bounds than which it says something is nearer and nothing is, or the other way round. 0 for the
    /// forms of single precision: most of these bounds are no numbers of theirs, so they are not asked.
    pub wrong_bounds: u64,
    /// Rays whose distance and normal were compared with the reference's: of those measured, the ones
    /// whose sphere is right. If there is none, the errors are 0.
    pub measured: u64,
    /// Largest error of the distance, relative, in units of 2^-23.
    pub t_error: f64,
    /// Largest error of the distance in its natural unit
    /// ([`t_unit`](super::reference::Solution::t_unit)).
    pub t_error_natural: f64,
    /// Largest angle between its normal and the true one, in units of 2^-23 radians.
    pub normal_error: f64,
    /// Rays that leave a surface outward and hit the sphere that they leave.
    pub self_hits: u64,
    /// Rays that go inward from a surface and do not find the far side: nothing, or what is at
    /// less than half or more than twice the distance.
    pub missed_exits: u64,
}

impl FormReport {
    /// Nothing wrong yet.
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

    /// Wrong decisions of every kind.
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
    /// No ray yet.
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

    /// Both together. Sums and maxima: the order does not matter.
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

    /// How one form did.
    pub fn form(&self, form: Form) -> &FormReport {
        &self.forms[form as usize]
    }

    pub(super) fn form_mut(&mut self, form: Form) -> &mut FormReport {
        &mut self.forms[form as usize]
    }

    /// Part of the rays, 0 to 1, for which a form finds no hit where there is one, one where there
    /// is none, or another sphere.
    pub fn wrong_share(&self, form: Form) -> f64 {
        let form = self.form(form);
        (form.wrong_hits + form.wrong_spheres) as f64 / self.rays.max(1) as f64
    }
}

impl Report {
    /// Wrong decisions of one form, of every kind, in all regimes.
    pub fn wrong(&self, form: Form) -> u64 {
        self.regimes.iter().map(|regime| regime.form(form).wrong()).sum()
    }

    /// Further rays that start on a surface.
    pub fn surface_rays(&self) -> u64 {
        self.regimes.iter().map(|regime| regime.leaving + regime.entering).sum()
    }

    /// Bounds about the distances of hits.
    pub fn bounds(&self) -> u64 {
        self.regimes.iter().map(|regime| regime.bounds).sum()
    }

    /// Writes CSV: a header, then a row for each regime and form.
    ///
    /// # Errors
    /// What the writer says.
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
        Report { seed: 3, rays: 10, regimes: vec![regime] }
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
        assert_eq!(both.wrong_share(Form::Naive), 0.2);
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
