//! Survey of a sequence before rendering: the camera and the color range, which all images share.

use super::{Fault, Request, Sections, Shared, Staged, choose, corners, leave_room, vertical};
use crate::scene::particles::{
    ArrowSizes, ArrowStyle, Category, ColumnSummary, Orientation, ParticleFrame, ParticleStyle,
    Particles, ReadOptions, TrajectoryReader,
};
use crate::scene::{FileError, Preset};
use crate::world::WorldError;
use crate::world::framing::SequenceBounds;
use std::path::Path;

/// Results of the survey, with memory independent of the number of frames.
#[derive(Debug, Default)]
pub struct Survey {
    bounds: Option<SequenceBounds>,
    orientation: Option<Orientation>,
    /// The numbers of [`ParticleStyle::column_colors`] in all frames.
    colors: Vec<ColumnSummary>,
    /// True for those that are of numbers, also if no frame has a finite one.
    numeric: Vec<bool>,
    /// True for the styles whose selections hold a particle of a frame.
    matched: Vec<bool>,
    /// The choices by the first frame of the file, and types and strings, whose order determines their colors.
    trajectory: TrajectoryReader,
    /// The names that colors stand for, if they are asked for.
    categories: Option<Vec<Named>>,
    /// The sizes of arrows in the first frame that has any.
    arrow_sizes: Option<ArrowSizes>,
    /// Warnings about the first frame that shows a sphere.
    pub warnings: Vec<String>,
    frames: u64,
    /// Number of frames that show a sphere.
    shown: u64,
    /// The preset of the frames.
    preset: Option<Preset>,
}

/// A name that a color stands for.
#[derive(Debug)]
struct Named {
    category: Category,
    /// The integer that the name is, and the row of its colors in [`Survey::colors`].
    label: Option<(usize, i64)>,
}

impl Survey {
    /// Creates a survey without frames.
    pub fn new(trajectory: TrajectoryReader) -> Self {
        Self { trajectory, ..Self::default() }
    }

    /// Returns the particles of a frame, with the choices by the first one, and types and strings in the common order.
    ///
    /// # Errors
    /// Those of [`TrajectoryReader::particles`].
    pub fn particles(
        &mut self,
        path: &Path,
        frame: ParticleFrame,
        options: &ReadOptions,
    ) -> Result<Particles, FileError> {
        self.trajectory.particles(path, frame, options)
    }

    /// Takes the choices that all frames have in common from a frame, unless they are known.
    pub fn add_first(
        &mut self,
        path: &Path,
        frame: &ParticleFrame,
        options: &ReadOptions,
        arrows: Option<&ArrowStyle>,
    ) {
        if self.trajectory.first_frame().is_none() {
            self.trajectory.add_first(path, frame.clone(), options, arrows);
        }
    }

    /// Counts the particles of a frame, and returns the request by which they are staged: the arrows of later frames have the
    /// sizes of those before. What is staged goes to [`Survey::add`].
    pub fn begin_frame(&mut self, request: &Request, particles: &Particles) -> Request {
        self.frames += 1;
        let numeric = request.style.column_colors().map(|own| own.is_numeric(particles));
        any_of(&mut self.numeric, numeric);
        let mut request = request.clone();
        self.fix_arrows(request.style.arrows.as_mut());
        request
    }

    /// Surveys the scene of a frame.
    ///
    /// # Errors
    /// Its camera cannot be chosen.
    pub fn add(&mut self, request: &Request, mut staged: Staged) -> Result<(), Fault> {
        self.arrow_sizes = self.arrow_sizes.or(staged.arrow_sizes);
        any_of(&mut self.matched, staged.applied.matched.iter().copied());
        if staged.scene.is_empty() {
            return Ok(());
        }
        self.shown += 1;
        let summaries = std::mem::take(&mut staged.applied.summaries);
        for category in staged.categories.take().into_iter().flatten() {
            let known = self.categories.get_or_insert_default();
            let label = summaries.iter().enumerate().find_map(|(row, summary)| {
                let summary = summary.as_ref()?;
                Some((row, summary.label(&category.name, category.color)?))
            });
            let same = |own: &&mut Named| {
                own.category.name == category.name
                    && own.category.source == category.source
                    && own.label == label
                    && (label.is_some() || own.category.color == category.color)
            };
            match known.iter_mut().find(same) {
                Some(own) => own.category.count += category.count,
                None => known.push(Named { category, label }),
            }
        }
        self.colors.resize_with(summaries.len(), ColumnSummary::default);
        for (all, summary) in self.colors.iter_mut().zip(&summaries) {
            if let Some(summary) = summary {
                all.add(summary);
            }
        }
        if self.shown == 1 {
            self.warnings = std::mem::take(&mut staged.scene.warnings);
            choose(request, &mut staged)?;
            leave_room(&mut staged.scene, request.camera.turns);
            (self.orientation, self.preset) = (staged.orientation, staged.preset);
            let orientation = self.orientation.as_ref();
            let vertical = vertical(request, &staged.scene.camera, orientation);
            self.bounds = SequenceBounds::new(&staged.scene, vertical);
        }
        let Staged { scene, .. } = staged;
        if let Some(bounds) = &mut self.bounds {
            bounds.add(&scene, &corners(&scene));
        }
        Ok(())
    }

    /// Sets the meaning of colors in all frames.
    pub fn fix_colors(&self, style: &mut ParticleStyle) {
        for (colors, summary) in style.column_colors_mut().zip(&self.colors) {
            colors.shared = summary.share(colors).ok();
        }
    }

    /// Returns the names that colors stand for in all frames, with the colors that they have there.
    fn categories(&self, style: &ParticleStyle) -> Option<Vec<Category>> {
        let in_all = |Named { category, label }: &Named| {
            let Some((row, label)) = *label else { return Some(category.clone()) };
            let shared = style.column_colors().nth(row)?.shared.as_ref();
            let color = shared.and_then(|shared| shared.color_of(label))?;
            Some(Category { color, ..category.clone() })
        };
        self.categories.as_ref()?.iter().map(in_all).collect()
    }

    /// Sets the sizes of the arrows of all frames.
    pub fn fix_arrows(&self, arrows: Option<&mut ArrowStyle>) {
        if let (Some(arrows), Some(sizes)) = (arrows, self.arrow_sizes) {
            arrows.fix(sizes);
        }
    }

    /// Checks that a frame shows a sphere, and that a frame has the particles that an option names.
    ///
    /// # Errors
    /// None does.
    pub fn check(&self, path: &Path, looks: &ParticleStyle) -> Result<(), FileError> {
        if self.shown > 0 {
            looks.check_types(path, self.trajectory.names())?;
            looks.check_matched(path, &self.matched)?;
            let colored = looks.column_colors().zip(&self.numeric).zip(&self.colors);
            for ((colors, _), summary) in colored.filter(|((_, numeric), _)| **numeric) {
                summary.share(colors).map_err(|error| colors.range_error(path, &error))?;
            }
            return Ok(());
        }
        let frames = match self.frames {
            1 => "1 frame".to_owned(),
            count => format!("{count} frames"),
        };
        let message = format!("has no sphere in {frames} of the sequence");
        let help = "the frames are empty, or --select and --slice remove all particles; of standard input, \
                    only the first frame is checked";
        Err(FileError::whole_file(path, message).with_help(help))
    }

    /// Returns the shared properties, for a turntable at `angle`.
    ///
    /// # Errors
    /// The frames cannot be framed.
    pub fn shared(&self, request: &Request, angle: Option<f64>) -> Result<Shared, WorldError> {
        let view = |angle| {
            let found = self.bounds.as_ref().ok_or(WorldError::NothingToFit);
            found.and_then(|bounds| bounds.view(angle))
        };
        // The ground is below all frames, for every view.
        let mut still = view(None)?;
        let own_lights = request.sections.as_ref().is_some_and(Sections::lights_scene);
        if let Some(preset) = self.preset.filter(|_| !own_lights) {
            let vertical = vertical(request, &still.camera, self.orientation.as_ref());
            preset.light(&mut still, vertical);
        }
        let ground = still.ground.map(|ground| ground.height);
        let camera = if angle.is_none() { still.camera } else { view(angle)?.camera };
        let categories = self.categories(&request.style);
        Ok(Shared { camera, orientation: self.orientation, ground, categories })
    }
}

/// Sets the rows of `all` for which `more` is true.
fn any_of(all: &mut Vec<bool>, more: impl Iterator<Item = bool>) {
    for (row, more) in more.enumerate() {
        match all.get_mut(row) {
            Some(own) => *own |= more,
            None => all.push(more),
        }
    }
}
