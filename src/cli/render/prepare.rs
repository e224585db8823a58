//! From a job to a world that can be rendered.

use super::estimate::Estimate;
use super::job::{Job, check_alpha};
use super::notes::notes;
use super::told::Told;
use super::{layers, looks, metadata, part, unseen};
use crate::cli::contents::{dropped, found};
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::picture_file;
use glam::DVec3;
use spherule::World;
use spherule::bvh::build::Builder;
use spherule::film::Region;
use spherule::render::{Render, Share};
use spherule::scene::particles::{Cell, Legend, Particles};
use spherule::scene::{Identity, Scene, Settings};
use std::path::Path;
use std::time::{Duration, Instant};

/// A world that can be rendered, and how it came about.
pub(super) struct Prepared {
    /// Without its spheres, which are the world's now.
    pub(super) scene: Scene,
    pub(super) title: String,
    pub(super) world: World,
    /// The part of the picture that is rendered.
    pub(super) region: Region,
    /// What of that is rendered here.
    pub(super) share: Share,
    /// How the tree was built.
    pub(super) builder: Builder,
    /// Time for reading or generating.
    pub(super) load: Duration,
    /// Time for the columns and the tree.
    pub(super) build: Duration,
    /// Settings that have no effect.
    pub(super) notes: Vec<String>,
    /// What colors stand for, if they stand for numbers.
    pub(super) legend: Option<Legend>,
    /// What the scene is told by, if the render is kept.
    pub(super) identity: Option<Identity>,
    /// What is wrong with the input.
    pub(super) warnings: Vec<String>,
    /// Why the picture shows no sphere, if it shows none.
    pub(super) unseen: Option<String>,
}

/// A scene with the job's settings in it, whose camera has no place yet.
pub(super) struct Staged {
    pub(super) scene: Scene,
    /// Normals of the slices that cut anything, toward what is cut away.
    pub(super) cuts: Vec<DVec3>,
    pub(super) legend: Option<Legend>,
    load: Duration,
}

impl Staged {
    /// Loads the scene; `given` are its particles, if they were read before.
    pub(super) fn load(job: &Job, given: Option<Particles>) -> Result<Self, Failure> {
        let start = Instant::now();
        let looks::Loaded { mut scene, legend, cell } = looks::load(job, given)?;
        scene.color_bar = looks::color_bar(job, legend.as_ref()).or(scene.color_bar);
        let box_of = cell.as_ref().map(Cell::bounds);
        let path = job.source.name().into_owned();
        let cuts = job.slices.cut(&mut scene, Path::new(&path), box_of, job.looks.allow_empty)?;
        if scene.color_bar.is_some() && job.picture.region.is_some() {
            let message = "a color bar inside is for a whole picture: leave --region out";
            return Err(Failure::usage("render", message));
        }
        let load = start.elapsed();
        job.style.set(&mut scene);
        job.views.show_cell(&mut scene, cell.as_ref());
        check_alpha(&scene.look, job.format)?;
        job.picture.replace(&mut scene.settings);
        if job.part.is_some() {
            // The picture is written elsewhere, from what the part's settings say.
            job.encoding.replace(&mut scene.settings);
        }
        Ok(Self { scene, cuts, legend, load })
    }
}

/// A scene whose camera and lights have their places: all that makes the picture is known.
pub(super) struct Placed {
    pub(super) scene: Scene,
    pub(super) legend: Option<Legend>,
    pub(super) region: Region,
    /// Identity of the scene, if someone asks.
    pub(super) identity: Option<Identity>,
    load: Duration,
}

impl Placed {
    /// Loads the scene, puts in the job's settings, and places the camera; `given` are its particles, if
    /// they were read before.
    pub(super) fn load(job: &Job, given: Option<Particles>) -> Result<Self, Failure> {
        let Staged { mut scene, cuts, legend, load } = Staged::load(job, given)?;
        place_camera(job, &mut scene, &cuts)?;
        job.style.light(&mut scene);
        if let (Some(ground), Some(common)) = (&mut scene.ground, &job.common) {
            ground.height = common.ground.unwrap_or(ground.height);
        }
        let region = job.region(&scene.settings)?;
        if job.part.is_none() {
            picture_file::check_size("render", region, job.format)?;
        }
        let asked = job.keep.file().is_some() || job.is_identified();
        let identity = asked.then(|| Identity::of(&scene));
        Ok(Self { scene, legend, region, identity, load })
    }

    /// Builds the world, if there is memory for it.
    pub(super) fn build(self, job: &Job) -> Result<Prepared, Failure> {
        let Self { mut scene, legend, region, identity, load } = self;
        let layered = !job.encoding.layers.is_empty() || !scene.look.is_plain();
        let share = part::share(job, region, &scene)?;
        Estimate::new(&scene, region, layers::need_statistics(job), layered)
            .of_tiles(share.tiles.len())
            .check()?;
        let start = Instant::now();
        let part = share.size() as f64 / Share::whole(region, scene.settings.spp).size() as f64;
        let samples = samples(region, &scene.settings) as f64 * part;
        let builder = job.builder(scene.spheres.len(), samples as u64);
        let world = World::build_taking(&mut scene, builder)
            .map_err(|error| Failure::World(job.source.name().into_owned(), error))?;
        let build = start.elapsed();
        let mut warnings = std::mem::take(&mut scene.warnings);
        warnings.extend(dropped(&world));
        let unseen = unseen::why(&world, region, scene.settings.spp);
        Ok(Prepared {
            title: job.source.title(&scene).into_owned(),
            notes: notes(job, &scene.settings, &world),
            scene,
            world,
            region,
            share,
            builder,
            load,
            build,
            legend,
            identity,
            warnings,
            unseen,
        })
    }
}

impl Prepared {
    /// Returns the settings by which particles are looked at, as a file lists them.
    pub(super) fn looks(&self, job: &Job) -> Vec<(String, String)> {
        metadata::looks(job, self.legend.as_ref(), self.identity.as_ref())
    }

    /// Tells what is worth knowing before the render takes its time.
    pub(super) fn tell(&self, job: &Job, told: &mut Told) {
        self.warnings.iter().for_each(|text| told.warn(text));
        match &self.unseen {
            Some(_) if job.is_of_sequence() => told.see_no_sphere(),
            Some(why) => told.warn(why),
            None => {}
        }
        if job.common.as_ref().is_some_and(|common| !common.frames_all)
            && self.world.centers_out_of_view() > 0
        {
            told.see_cropped();
        }
        if job.report.quiet {
            return;
        }
        self.notes.iter().for_each(|text| told.note(text));
        if job.report.verbose {
            output::note(format_args!("found: {}", found(&self.world).join(", ")));
            for skipped in self.world.features.skipped() {
                output::note(format_args!("skipped: {skipped}"));
            }
        }
    }

    /// Samples that a complete render takes.
    pub(super) fn samples(&self) -> u64 {
        samples(self.region, &self.scene.settings)
    }

    /// Share of the samples that a render has taken, 0..=1.
    pub(super) fn taken(&self, render: &Render) -> f64 {
        render.samples.total as f64 / self.samples() as f64
    }
}

/// Places the camera, by itself or as in the other pictures of its sequence.
fn place_camera(job: &Job, scene: &mut Scene, cuts: &[DVec3]) -> Result<(), Failure> {
    match &job.common {
        Some(common) => {
            scene.camera = common.camera.clone();
            Ok(())
        }
        None => job.views.frame(scene, job.turn, cuts),
    }
}

/// Samples of a part of the picture.
fn samples(region: Region, settings: &Settings) -> u64 {
    u64::from(region.width) * u64::from(region.height) * u64::from(settings.spp)
}
