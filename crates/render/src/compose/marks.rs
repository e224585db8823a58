//! Labels and measures of particles: the texts, and the points that they belong to.

use super::template::{Template, Value};
use super::{Fault, Request};
use crate::scene::particles::{ColumnValues, Particles};
use crate::scene::{Measure, Slice};
use glam::DVec3;
use std::path::Path;
use std::str::FromStr;

/// Maximum number of particles that one label is drawn at; more would hide each other.
const LABELS: usize = 500;

/// Suffix of measures between nearest periodic images.
const PERIODIC: &str = "periodic";

/// Particles to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureRequest {
    /// Values of two to four particles in the column of ids.
    pub ids: Vec<f64>,
    /// True to take the nearest periodic images.
    pub periodic: bool,
}

impl FromStr for MeasureRequest {
    type Err = String;

    /// Parses ids with `-` between them, perhaps with `:periodic`.
    fn from_str(text: &str) -> Result<Self, String> {
        let (ids, periodic) = match text.split_once(':') {
            Some((ids, PERIODIC)) => (ids, true),
            Some((_, word)) => {
                return Err(format!(
                    "`{word}` is unknown: write 12-48:{PERIODIC} for nearest images"
                ));
            }
            None => (text, false),
        };
        let ids: Option<Vec<f64>> =
            ids.split('-').map(|id| id.trim().parse::<u64>().ok().map(|id| id as f64)).collect();
        let ids = ids.filter(|ids| (2..=4).contains(&ids.len())).ok_or_else(|| {
            "give the ids of two to four particles, as in 12-48, 12-48-7 or 12-48-7-3".to_owned()
        })?;
        match ids.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(format!("the particle {} follows itself; name another", pair[0])),
            None => Ok(Self { ids, periodic }),
        }
    }
}

/// Annotations at particles.
#[derive(Clone, Debug, Default)]
pub(super) struct Marks {
    labels: Vec<Marked>,
    pub(super) measures: Vec<Measure>,
    /// Names of columns, for messages.
    columns: Vec<String>,
}

/// A label at a particle.
#[derive(Clone, Debug)]
struct Marked {
    /// The row of the label among those of the request.
    row: usize,
    at: DVec3,
    /// Names and values of columns.
    fields: Vec<(String, Value)>,
}

impl Marks {
    /// Finds the particles of labels and measures.
    ///
    /// # Errors
    /// There are no such particles, or too many.
    pub(super) fn of(request: &Request, path: &Path, particles: &Particles) -> Result<Self, Fault> {
        let asked = &request.annotations;
        let mut marks = Self::default();
        // Frames of a trajectory may be empty.
        if request.style.allow_empty && particles.spheres.is_empty() {
            return Ok(marks);
        }
        for (row, label) in asked.labels.iter().enumerate() {
            let Some(selection) = &label.particles else { continue };
            let empty = request.style.allow_empty;
            let rows = particles.selected(path, selection, empty, "labeled")?;
            if rows.len() > LABELS {
                let why = format!(
                    "it is for {} particles, but at most {LABELS} can be told apart; select fewer, as with `and name CA`",
                    rows.len()
                );
                return Err(Fault::Label { row, why });
            }
            marks.add_labels(row, particles, &rows, &label.template);
        }
        if !marks.labels.is_empty() {
            marks.columns = particles.column_names();
        }
        for (row, measure) in asked.measures.iter().enumerate() {
            let found = marks.add_measure(particles, measure, request.style.allow_empty);
            found.map_err(|why| Fault::Measure { row, why })?;
        }
        Ok(marks)
    }

    fn add_labels(&mut self, row: usize, particles: &Particles, rows: &[usize], text: &Template) {
        let mut marked: Vec<Marked> = rows
            .iter()
            .map(|&own| Marked { row, at: particles.spheres.center(own), fields: Vec::new() })
            .collect();
        for name in text.fields() {
            let Some(values) = particles.column_values(name, rows) else { continue };
            for (at, marked) in marked.iter_mut().enumerate() {
                let value = match &values {
                    ColumnValues::Numbers(numbers) => number(numbers[at]),
                    ColumnValues::Texts(texts) => Value::Text(texts[at].clone()),
                };
                marked.fields.push((name.to_owned(), value));
            }
        }
        self.labels.extend(marked);
    }

    fn add_measure(
        &mut self,
        particles: &Particles,
        measure: &MeasureRequest,
        allow_empty: bool,
    ) -> Result<(), String> {
        let mut points = Vec::new();
        for &id in &measure.ids {
            match particles.position_of(id) {
                Some(point) => points.push(point),
                // Particles may be in some frames of a trajectory alone.
                None if allow_empty => return Ok(()),
                None => {
                    return Err(format!(
                        "no particle that is drawn has the id {id}; ids are those of the file, or numbers from 0 if it has none"
                    ));
                }
            }
        }
        let mut own = Measure { points, unit: particles.frame.unit.symbol().to_owned() };
        if measure.periodic {
            let cell = particles.frame.cell.filter(|cell| cell.periodic.contains(&true));
            let cell = cell.ok_or_else(|| {
                format!("the particles have no periodic cell; leave out :{PERIODIC}")
            })?;
            own = own.with_nearest_images(&cell);
        }
        self.measures.push(own);
        Ok(())
    }

    /// Returns the places and texts of a label of the request, but for those that slices cut away; `fields` are those of the
    /// frame.
    ///
    /// # Errors
    /// A field is unknown, or has no value.
    pub(super) fn labels(
        &self,
        row: usize,
        text: &Template,
        fields: &[(String, Value)],
        slices: &[Slice],
    ) -> Result<Vec<(DVec3, String)>, String> {
        let unknown =
            || self.columns.iter().map(|name| (name.clone(), Value::Missing("it was not read")));
        let shared: Vec<_> = fields.iter().cloned().chain(unknown()).collect();
        let own = self.labels.iter().filter(|label| label.row == row);
        let visible = own.filter(|label| !slices.iter().any(|slice| slice.depth(label.at) > 0.0));
        visible
            .map(|label| {
                let fields = [label.fields.as_slice(), &shared].concat();
                Ok((label.at, text.expand(&fields)?))
            })
            .collect()
    }
}

/// Returns a number as the value of a field: whole numbers as such, and nothing for a missing one.
fn number(value: f64) -> Value {
    if value.is_nan() {
        Value::Text(String::new())
    } else if value.fract() == 0.0 && value.abs() < 1e15 {
        Value::Whole(value as i64)
    } else {
        Value::Number(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measures_are_of_two_to_four_particles() {
        let measure = |ids: &[f64], periodic| Ok(MeasureRequest { ids: ids.to_vec(), periodic });
        assert_eq!("12-48".parse(), measure(&[12.0, 48.0], false));
        assert_eq!("1 - 2-1".parse(), measure(&[1.0, 2.0, 1.0], false));
        assert_eq!("0-1-2-3:periodic".parse(), measure(&[0.0, 1.0, 2.0, 3.0], true));
        for text in ["", "1", "1-", "1-2-3-4-5", "1-1", "1-a", "1.5-2", "1--2", "1-2:", "1-2:near"]
        {
            assert!(text.parse::<MeasureRequest>().is_err(), "{text}");
        }
    }
}
