//! Preparation of a render: loads the scene and builds the world.

use super::estimate::Estimate;
use super::notes;
use super::notices::Notices;
use super::setup::{RenderSetup, check_alpha};
use super::visibility;
use crate::cli::contents::{dropped, found};
use crate::cli::devices::Attached;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::picture_file;
use crate::cli::source::Source;
use spherule_render::World;
use spherule_render::bvh::builders::Builder;
use spherule_render::compose::{self, Content, Labels, Staged, Subject, Value};
use spherule_render::denoise::{self, Asked, Choice};
use spherule_render::film::Region;
use spherule_render::prepared::{self, PreparedScene};
use spherule_render::render::{ImagePart, Render};
use spherule_render::scene::particles::{
    FrameChoice, Legend, Orientation, Particles, TrajectoryReader, count_frames,
};
use spherule_render::scene::{Denoise, Identity, Scene, Settings};
use std::path::Path;
use std::time::{Duration, Instant};

/// A world that is ready to render, with facts about its preparation.
pub(super) struct Prepared {
    /// The scene without its spheres, which have moved to the world.
    pub(super) scene: Scene,
    pub(super) title: String,
    pub(super) world: World,
    /// The region that is rendered.
    pub(super) region: Region,
    /// The samples and tiles of the region that this process renders.
    pub(super) part: ImagePart,
    /// Builder of the BVH.
    pub(super) builder: Builder,
    /// Time to read or generate the scene.
    pub(super) load: Duration,
    /// Time to build the columns and the BVH.
    pub(super) build: Duration,
    /// Estimated peak memory of the process in bytes, computed before the world was built.
    pub(super) estimate: u64,
    /// Settings that have no effect.
    pub(super) notes: Vec<String>,
    /// The color scale, if colors represent numbers.
    pub(super) legend: Option<Legend>,
    /// The orientation of the particles, if the scene is of particles.
    orientation: Option<Orientation>,
    /// Settings for particles from a prepared scene, for the image's metadata.
    pub(super) looks: Option<Vec<(String, String)>>,
    /// Identity of the scene, if the image or a checkpoint records it.
    pub(super) identity: Option<Identity>,
    /// The choice between the denoised and the unfiltered image; `None` if it is not denoised.
    pub(super) denoise: Option<Choice>,
    /// Warnings about the input.
    pub(super) warnings: Vec<String>,
    /// Types and columns of the spheres, if a figure tells them, and half the diagonal of the scene's bounding box.
    pub(super) labels: Labels,
    pub(super) extent: f64,
    /// Reason why the image shows no sphere, if it shows none.
    pub(super) empty: Option<String>,
    /// The device that follows paths.
    pub(super) device: Attached,
}

/// Loads the scene with the setup's settings, before its camera is placed; `given` are its particles, if they are already
/// loaded.
pub(super) fn stage(setup: &RenderSetup, given: Option<Particles>) -> Result<Staged, Failure> {
    let content = match (&setup.source, given) {
        (_, Some(particles)) => Content::Particles(Box::new(particles)),
        (Source::Particles(path, options), None) => {
            let arrows = setup.request.style.arrows.as_ref();
            Content::Particles(Box::new(TrajectoryReader::default().read(path, options, arrows)?))
        }
        (source, None) => {
            setup.views.refuse_cells()?;
            Content::Scene(Box::new(source.load()?))
        }
    };
    let name = setup.source.name();
    let title = setup.source.title(&Scene::default()).into_owned();
    let frame = frame_number(setup)?;
    let subject = Subject { path: Path::new(&*name), title: &title, frame: &frame };
    let shared = setup.common.as_ref().map(|common| &common.shared);
    let staged = compose::stage(&setup.request, &subject, content, shared);
    let staged = staged.map_err(|fault| setup.refuse(fault))?;
    check_region(setup, &staged.scene)?;
    check_alpha(staged.scene.look.is_transparent(), setup.format)?;
    Ok(staged)
}

/// Returns the number of the frame that is drawn, from 0, if a label shows it.
pub(in crate::cli) fn frame_number(setup: &RenderSetup) -> Result<Value, Failure> {
    if !setup.request.annotations.shows("frame") {
        return Ok(Value::Missing("no label shows it"));
    }
    if let Some(number) = setup.frame {
        return Ok(Value::Whole(number as i64));
    }
    let Source::Particles(path, options) = &setup.source else {
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

/// A scene whose camera and lights are placed, so that everything that determines the image is known.
pub(in crate::cli) struct PlacedScene {
    pub(in crate::cli) scene: Scene,
    pub(super) legend: Option<Legend>,
    /// The orientation of the particles, if the scene is of particles.
    orientation: Option<Orientation>,
    pub(super) region: Region,
    /// Identity of the scene, if the image or a checkpoint records it.
    pub(super) identity: Option<Identity>,
    /// The choice between the denoised and the unfiltered image; `None` if it is not denoised.
    pub(super) denoise: Option<Choice>,
    /// The world, if the scene is a prepared one.
    pub(super) stored: Option<Box<PreparedScene>>,
    /// Types and columns of the spheres, if a figure tells them.
    labels: Labels,
    /// Options without effect on the scene.
    notes: Vec<String>,
    load: Duration,
}

impl PlacedScene {
    /// Loads the scene, applies the setup's settings, and places the camera; `given` are its particles, if they
    /// are already loaded.
    pub(in crate::cli) fn load(
        setup: &RenderSetup,
        given: Option<Particles>,
    ) -> Result<Self, Failure> {
        if let Source::Prepared(path) = &setup.source {
            return Self::open(setup, path);
        }
        let start = Instant::now();
        let mut staged = stage(setup, given)?;
        let load = start.elapsed();
        let shared = setup.common.as_ref().map(|common| &common.shared);
        let angle = setup.turn.map(|turn| setup.views.angle(turn));
        compose::place(&setup.request, &mut staged, shared, angle)
            .map_err(|fault| setup.refuse(fault))?;
        let notes = notes::of_staged(setup, &staged);
        let Staged { mut scene, legend, orientation, first_frame, labels, .. } = staged;
        let region = setup.region(&scene.settings)?;
        if setup.part.is_none() {
            picture_file::check_size("render", region, setup.format)?;
        }
        let spheres = scene.spheres.len();
        let asked = Asked { first_frame, ..asked(setup) };
        let denoise = choose(&mut scene, region, spheres, asked)?;
        let asked = setup.checkpoints.file().is_some() || setup.is_identified();
        let identity = asked.then(|| Identity::of(&scene));
        let stored = None;
        Ok(Self {
            scene,
            legend,
            orientation,
            region,
            identity,
            denoise,
            stored,
            labels,
            notes,
            load,
        })
    }

    /// Opens a prepared scene, and applies the setup's settings.
    fn open(setup: &RenderSetup, path: &Path) -> Result<Self, Failure> {
        let start = Instant::now();
        let mut stored = prepared::read(path)?;
        let mut scene = std::mem::take(&mut stored.scene);
        let load = start.elapsed();
        check_region(setup, &scene)?;
        check_alpha(scene.look.is_transparent(), setup.format)?;
        scene.settings.change(&setup.request.settings);
        let region = setup.region(&scene.settings)?;
        if setup.part.is_none() {
            picture_file::check_size("render", region, setup.format)?;
        }
        let denoise = choose(&mut scene, region, stored.sphere_count(), asked(setup))?;
        let identity = Some(stored.identity.clone());
        let stored = Some(Box::new(stored));
        Ok(Self {
            scene,
            legend: None,
            orientation: None,
            region,
            identity,
            denoise,
            stored,
            labels: Labels::default(),
            notes: Vec::new(),
            load,
        })
    }

    /// Builds the world, unless its estimated memory exceeds the limit.
    pub(super) fn build(self, setup: &RenderSetup) -> Result<Prepared, Failure> {
        let Self { mut scene, legend, orientation, region, identity, denoise, stored, .. } = self;
        let (mut notes, load, labels) = (self.notes, self.load, self.labels);
        let extent = compose::extent(&scene);
        let image_part = image_part(setup, region, &scene)?;
        let estimate = Estimate::new(&scene, region, setup, denoise.is_some())
            .of_tiles(image_part.tiles.len())
            .check()?;
        let start = Instant::now();
        let name = || setup.source.name().into_owned();
        let mut looks = None;
        let (mut world, builder) = if let Some(mut stored) = stored {
            stored.scene = scene;
            looks = Some(std::mem::take(&mut stored.metadata));
            let builder = stored.builder;
            let built = stored.build().map_err(|error| Failure::Prepare(name(), error))?;
            scene = built.0;
            (built.1, builder)
        } else {
            let part = image_part.size() as f64
                / ImagePart::whole(region, scene.settings.spp).size() as f64;
            let samples = samples(region, &scene.settings) as f64 * part;
            let builder = setup.builder(scene.spheres.len(), samples as u64);
            let world = World::build_taking(&mut scene, builder)
                .map_err(|error| Failure::World(name(), error))?;
            (world, builder)
        };
        let build = start.elapsed();
        let device = Attached::to(&mut world, &scene.settings, setup.speed.device);
        let mut warnings = std::mem::take(&mut scene.warnings);
        warnings.extend(dropped(&world));
        warnings.extend(device.refusal());
        let empty = visibility::explain_empty(&world, region, scene.settings.spp);
        notes.extend(notes::notes(setup, &scene, &world));
        notes.extend(compose::notes(&scene.annotations));
        Ok(Prepared {
            title: setup.source.title(&scene).into_owned(),
            notes,
            scene,
            world,
            region,
            part: image_part,
            builder,
            load,
            build,
            estimate,
            legend,
            orientation,
            looks,
            identity,
            denoise,
            warnings,
            labels,
            extent,
            empty,
            device,
        })
    }
}

impl Prepared {
    /// Prints warnings and notes before the render starts.
    pub(super) fn report(&self, setup: &RenderSetup, notices: &mut Notices) {
        self.warnings.iter().for_each(|text| notices.warn(text));
        match &self.empty {
            Some(_) if setup.is_of_sequence() => notices.count_empty(),
            Some(why) => notices.warn(why),
            None => {}
        }
        if setup.common.as_ref().is_some_and(|common| !common.frames_all)
            && self.world.centers_out_of_view() > 0
        {
            notices.count_cropped();
        }
        if setup.report.quiet {
            return;
        }
        self.notes.iter().for_each(|text| notices.note(text));
        if let Some(orientation) = &self.orientation
            && let Some(text) = setup.views.explain_up(orientation)
            && (setup.report.verbose || orientation.reason.is_evident())
        {
            notices.note(&text);
        }
        if setup.report.verbose {
            for text in self.device.facts() {
                notices.note(&text);
            }
            output::note(format_args!("found: {}", found(&self.world).join(", ")));
            for skipped in self.world.features.skipped() {
                output::note(format_args!("skipped: {skipped}"));
            }
        }
    }

    /// Returns the number of samples of a complete render.
    pub(super) fn samples(&self) -> u64 {
        samples(self.region, &self.scene.settings)
    }

    /// Returns the fraction of the samples that a render has taken, 0..=1.
    pub(super) fn taken(&self, render: &Render) -> f64 {
        render.samples.total as f64 / self.samples() as f64
    }
}

/// Rejects annotations of a region of an image.
fn check_region(setup: &RenderSetup, scene: &Scene) -> Result<(), Failure> {
    if scene.annotations.is_empty() || setup.picture.region.is_none() {
        return Ok(());
    }
    let message = "annotations inside the image need the whole image; remove --region";
    Err(Failure::usage("render", message))
}

/// Returns the samples and tiles to render: all, or those of the part.
fn image_part(setup: &RenderSetup, region: Region, scene: &Scene) -> Result<ImagePart, Failure> {
    let settings = &scene.settings;
    let whole = ImagePart::whole(region, settings.spp);
    let Some(part) = setup.part else { return Ok(whole) };
    let refuse = |message: &dyn std::fmt::Display| Err(Failure::usage("render", message));
    if settings.has_target() {
        return refuse(
            &"--part cannot stop at an error or a time of the whole image; use --until-error none, --time \
              none and --spp",
        );
    }
    if !scene.look.is_plain() {
        return refuse(
            &"--cell, --background transparent, --preset depthcue and outline, and the same in a scene need the whole \
              image; remove them with --part. The cell of a crystal is left out with --model NAME",
        );
    }
    part.of_image(&whole, setup.split).or_else(|error| refuse(&format!("--part: {error}")))
}

/// Completes the settings, and returns how the image is denoised, if at all. `spheres` is the number of spheres, which
/// the scene itself does not have any more if it was prepared.
fn choose(
    scene: &mut Scene,
    region: Region,
    spheres: usize,
    asked: Asked,
) -> Result<Option<Choice>, Failure> {
    if asked.part && scene.settings.denoise == Denoise::On {
        let message = "--denoise on needs the whole image; remove it with --part";
        return Err(Failure::usage("render", message));
    }
    Ok(denoise::choose(scene, region, spheres, asked))
}

/// Returns what the setup asks for.
fn asked(setup: &RenderSetup) -> Asked {
    let (part, spp) = (setup.part.is_some(), setup.picture.settings.spp().is_some());
    Asked { part, spp, first_frame: None }
}

/// Returns the number of samples of a region.
fn samples(region: Region, settings: &Settings) -> u64 {
    u64::from(region.width) * u64::from(region.height) * u64::from(settings.spp)
}
