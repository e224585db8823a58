//! Survey of a sequence before rendering: the camera and the color range, which all images share.

use crate::cli::contents::plural;
use crate::cli::failure::Failure;
use crate::cli::render::prepare::stage;
use crate::cli::render::setup::{Common, RenderSetup};
use spherule_render::compose::{self, Shared, Staged};
use spherule_render::scene::FileError;
use spherule_render::scene::particles::{
    ArrowSizes, ArrowStyle, Category, ColumnSummary, Orientation, ParticleFrame, ParticleStyle,
    Particles, ReadOptions, TrajectoryReader,
};
use spherule_render::world::WorldError;
use spherule_render::world::framing::SequenceBounds;
use std::path::Path;

/// Results of the survey, with memory independent of the number of frames.
#[derive(Default)]
pub(super) struct Survey {
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
    pub(super) warnings: Vec<String>,
    frames: u64,
    /// Number of frames that show a sphere.
    shown: u64,
    /// True if all frames are surveyed, and not only the first.
    all: bool,
}

/// A name that a color stands for.
struct Named {
    category: Category,
    /// The integer that the name is, and the row of its colors in [`Survey::colors`].
    label: Option<(usize, i64)>,
}

impl Survey {
    /// Creates a survey of all frames, or only of the first.
    pub(super) fn new(all: bool, trajectory: TrajectoryReader) -> Self {
        Self { trajectory, all, ..Self::default() }
    }

    /// Returns the particles of a frame, with the choices by the first one, and types and strings in the common order.
    pub(super) fn particles(
        &mut self,
        path: &Path,
        frame: ParticleFrame,
        options: &ReadOptions,
    ) -> Result<Particles, FileError> {
        self.trajectory.particles(path, frame, options)
    }

    /// Surveys the particles of a frame.
    pub(super) fn add(&mut self, setup: &RenderSetup, particles: Particles) -> Result<(), Failure> {
        self.frames += 1;
        let numeric = setup.request.style.column_colors().map(|own| own.is_numeric(&particles));
        any_of(&mut self.numeric, numeric);
        // The arrows of later frames have the sizes of those before.
        let mut sized = setup.clone();
        self.fix_arrows(sized.request.style.arrows.as_mut());
        let mut staged = stage(&sized, Some(particles))?;
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
            compose::choose(&setup.request, &mut staged).map_err(|fault| setup.refuse(fault))?;
            compose::leave_room(&mut staged.scene, setup.request.camera.turns);
            self.orientation = staged.orientation;
            let orientation = self.orientation.as_ref();
            let vertical = compose::vertical(&setup.request, &staged.scene.camera, orientation);
            self.bounds = SequenceBounds::new(&staged.scene, vertical);
        }
        let Staged { scene, .. } = staged;
        if let Some(bounds) = &mut self.bounds {
            bounds.add(&scene, &compose::corners(&scene));
        }
        Ok(())
    }

    /// Sets the meaning of colors in all frames.
    pub(super) fn fix_colors(&self, style: &mut ParticleStyle) {
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
    pub(super) fn fix_arrows(&self, arrows: Option<&mut ArrowStyle>) {
        if let (Some(arrows), Some(sizes)) = (arrows, self.arrow_sizes) {
            arrows.fix(sizes);
        }
    }

    /// Returns an error if no frame shows a sphere, or if no frame has particles that an option names.
    pub(super) fn check(&self, path: &Path, looks: &ParticleStyle) -> Result<(), FileError> {
        if self.shown > 0 {
            looks.check_types(path, self.trajectory.names())?;
            looks.check_matched(path, &self.matched)?;
            let colored = looks.column_colors().zip(&self.numeric).zip(&self.colors);
            for ((colors, _), summary) in colored.filter(|((_, numeric), _)| **numeric) {
                summary.share(colors).map_err(|error| colors.range_error(path, &error))?;
            }
            return Ok(());
        }
        let frames = plural(self.frames, "frame");
        let message = format!("has no sphere in {frames} of the sequence");
        let help = "the frames are empty, or --select and --slice remove all particles; of standard input, \
                    only the first frame is checked";
        Err(FileError::whole_file(path, message).with_help(help))
    }

    /// Returns the shared properties, for a turntable at `angle`.
    pub(super) fn common(
        &self,
        setup: &RenderSetup,
        angle: Option<f64>,
    ) -> Result<Common, Failure> {
        let view = |angle| {
            let found = self.bounds.as_ref().ok_or(WorldError::NothingToFit);
            let failure = |error| Failure::World(setup.source.name().into_owned(), error);
            found.and_then(|bounds| bounds.view(angle)).map_err(failure)
        };
        // The ground is below all frames, for every view.
        let mut still = view(None)?;
        if let Some(preset) = setup.preset() {
            let vertical =
                compose::vertical(&setup.request, &still.camera, self.orientation.as_ref());
            preset.light(&mut still, vertical);
        }
        let ground = still.ground.map(|ground| ground.height);
        let camera = if angle.is_none() { still.camera } else { view(angle)?.camera };
        let categories = self.categories(&setup.request.style);
        let orientation = self.orientation;
        let shared = Shared { camera, orientation, ground, categories };
        Ok(Common { shared, frames_all: self.all })
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
