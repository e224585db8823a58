//! Facts about a frame of particles that annotations show.

use super::Value;
use crate::cli::failure::Failure;
use crate::cli::render::Job;
use crate::cli::source::Source;
use spherule_render::scene::Scene;
use spherule_render::scene::particles::{
    Category, Cell, Coloring, FrameChoice, LengthUnit, Particles, count_frames,
};

/// Facts about a frame of particles.
#[derive(Clone, Debug, Default)]
pub(in crate::cli) struct FrameFacts {
    /// The names that colors stand for, if they are asked for and exist.
    pub(in crate::cli) categories: Option<Vec<Category>>,
    /// True if colors stand for numbers.
    pub(super) numeric: bool,
    pub(super) cell: Option<Cell>,
    /// Symbol of the unit of length; empty if the unit is unknown.
    pub(super) unit: String,
    /// Step, time and the header's values; `None` if the scene is not a particle file.
    header: Option<Header>,
}

#[derive(Clone, Debug)]
struct Header {
    step: Option<i64>,
    time: Option<f64>,
    title: String,
    values: Vec<(String, String)>,
}

impl FrameFacts {
    /// Returns the facts about particles whose colors are final.
    pub(in crate::cli) fn of(job: &Job, particles: &Particles) -> Self {
        let coloring = &job.looks.coloring;
        let legend = job.annotations.has_legend();
        Self {
            categories: legend.then(|| particles.categories(coloring)).flatten(),
            numeric: matches!(coloring, Coloring::Column(colors) if colors.is_numeric(particles)),
            cell: particles.cell,
            unit: symbol(particles.unit).to_owned(),
            header: Some(Header {
                step: particles.step,
                time: particles.time,
                title: particles.title.clone(),
                values: particles.header_values(),
            }),
        }
    }

    /// Returns the fields of labels with their values.
    pub(super) fn fields(&self, job: &Job, scene: &Scene) -> Result<Vec<(String, Value)>, Failure> {
        const NO_FRAMES: Value = Value::Missing("only particle files have it");
        let missing = |name| Value::Missing(name);
        let (mut step, mut time, mut frame) = (NO_FRAMES, NO_FRAMES, NO_FRAMES);
        let mut title = scene.title.clone();
        let mut values = Vec::new();
        if let Some(header) = &self.header {
            step = header.step.map_or(missing("the file has no steps"), Value::Whole);
            time = header.time.map_or(missing("the file has no times"), Value::Number);
            let asked = job.annotations.labels.iter().any(|label| label.template.has("frame"));
            if asked {
                frame = frame_number(job)?;
            }
            title.clone_from(&header.title);
            values.clone_from(&header.values);
        }
        let path = job.source.name();
        let file = path.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
        let particles = scene.spheres.len() + scene.ellipsoids.len();
        let own = [
            ("time", time),
            ("step", step),
            ("frame", frame),
            ("file", Value::Text(file)),
            ("title", Value::Text(title)),
            ("particles", Value::Whole(particles as i64)),
        ];
        let own = own.map(|(name, value)| (name.to_owned(), value));
        let values = values.into_iter().map(|(name, value)| (name, Value::Text(value)));
        Ok(own.into_iter().chain(values).collect())
    }
}

/// Returns the number of the frame that is drawn, from 0.
fn frame_number(job: &Job) -> Result<Value, Failure> {
    if let Some(number) = job.frame {
        return Ok(Value::Whole(number as i64));
    }
    let Source::Particles(path, options) = &job.source else {
        return Ok(Value::Missing("only particle files have it"));
    };
    Ok(match options.frame {
        FrameChoice::Index(index) => Value::Whole(index as i64),
        FrameChoice::Last if path.is_file() => {
            Value::Whole(count_frames(path, options)?.saturating_sub(1) as i64)
        }
        FrameChoice::Last => Value::Missing("the input can be read only once"),
    })
}

/// Returns the symbol of a unit of length; empty if the unit is unknown.
fn symbol(unit: LengthUnit) -> &'static str {
    match unit {
        LengthUnit::Unknown => "",
        LengthUnit::Angstrom => "\u{c5}",
        LengthUnit::Nanometer => "nm",
        LengthUnit::Bohr => "bohr",
        LengthUnit::Micrometer => "\u{b5}m",
        LengthUnit::Centimeter => "cm",
        LengthUnit::Meter => "m",
    }
}
