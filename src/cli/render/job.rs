//! What is to be rendered, how, and where to: validated as far as it can be without the scene.

use super::film::Container;
use super::looks::with_columns;
use super::sequence::Common;
use super::store;
use crate::cli::args::{EncodingArgs, PictureArgs, RenderArgs, ReportArgs, SpeedArgs};
use crate::cli::failure::Failure;
use crate::cli::keep::KeepArgs;
use crate::cli::looks::{BarPlace, LookArgs};
use crate::cli::names;
use crate::cli::particles::ParticleArgs;
use crate::cli::picture_file;
use crate::cli::sequences::SequenceArgs;
use crate::cli::settings::region_text;
use crate::cli::slices::SliceArgs;
use crate::cli::source::Source;
use crate::cli::threads;
use crate::cli::views::{StyleArgs, ViewArgs};
use spherule::World;
use spherule::bvh::builders::Builder;
use spherule::film::Region;
use spherule::image::Format;
use spherule::scene::particles::Looks;
use spherule::scene::{Look, Settings};
use spherule::split::{Part, Split};
use spherule::trace::Tracer;
use std::path::PathBuf;

/// The place of a picture among many.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) struct Place {
    /// From 0.
    pub(in crate::cli) index: u64,
    /// True if no other one follows, as far as that is known.
    pub(in crate::cli) last: bool,
}

/// A render to be done.
#[derive(Clone)]
pub(in crate::cli) struct Job<'a> {
    pub(in crate::cli) source: Source,
    pub(in crate::cli) looks: Looks,
    /// What of it was typed.
    pub(in crate::cli) typed: (&'a ParticleArgs, &'a LookArgs),
    pub(in crate::cli) color_bar: Option<&'a BarPlace>,
    pub(in crate::cli) output: PathBuf,
    pub(in crate::cli) format: Format,
    pub(in crate::cli) picture: &'a PictureArgs,
    pub(in crate::cli) slices: &'a SliceArgs,
    pub(in crate::cli) views: &'a ViewArgs,
    pub(in crate::cli) style: &'a StyleArgs,
    /// Which picture of a turn it is, from 0.
    pub(in crate::cli) turn: Option<u32>,
    /// Which of many frames it is.
    pub(in crate::cli) frame: Option<u64>,
    /// Properties that it shares with the other pictures of its sequence.
    pub(in crate::cli) common: Option<Common>,
    pub(in crate::cli) encoding: &'a EncodingArgs,
    pub(in crate::cli) keep: &'a KeepArgs,
    pub(in crate::cli) sequence: SequenceArgs,
    /// Its place among many pictures.
    pub(in crate::cli) place: Option<Place>,
    /// The part of a sequence's pictures that is made here, if not all are.
    pub(in crate::cli) deal: Option<Part>,
    /// The kind of the film that pictures go to, if they do.
    pub(in crate::cli) film: Option<Container>,
    /// Which part of the render it is, if it is but one.
    pub(in crate::cli) part: Option<Part>,
    pub(in crate::cli) split: Option<Split>,
    pub(in crate::cli) speed: &'a SpeedArgs,
    pub(in crate::cli) tracer: Tracer,
    pub(in crate::cli) threads: usize,
    pub(in crate::cli) report: ReportArgs,
}

impl<'a> Job<'a> {
    /// What was typed, made sense of.
    pub(in crate::cli) fn new(args: &'a RenderArgs) -> Result<Self, Failure> {
        let seed = args.picture.seed.unwrap_or(0);
        // A format that is typed is that of pictures, whatever their names.
        let film =
            Container::of_suffix(&args.output).filter(|_| args.encoding.output_format.is_none());
        if film.is_some() {
            check_film(args)?;
        } else if args.sequence.fps.is_some() {
            let message =
                "--fps is for films: end the name of --output in .mp4, .mov, .webm or .gif";
            return Err(Failure::usage("render", message));
        }
        // Pictures of a film have codes of 8 bits, as those of PPM.
        let format = match film {
            Some(_) => Format::Ppm,
            None => picture_file::format(&args.output, args.encoding.output_format)?,
        };
        if args.sequence.skip_existing && format == Format::Pfm {
            let message = "--skip-existing needs pictures that say what they are: PFM has no room for \
                           that; end the name of --output in .png, .ppm or .exr";
            return Err(Failure::usage("render", message));
        }
        if !args.encoding.layers.is_empty() && format != Format::Exr {
            let message = format!(
                "{format} has no room for --layers; end the name of --output in .exr, or give --output-format exr"
            );
            return Err(Failure::usage("render", message));
        }
        check_alpha(&args.style.look(None, Look::default()), format)?;
        let inside = matches!(&args.looks.color_bar, Some(BarPlace::Inside(_)));
        if inside && args.picture.region.is_some() {
            let message = "--color-bar inside is for a whole picture: leave --region out";
            return Err(Failure::usage("render", message));
        }
        let source = match &args.scene {
            Some(path) => Source::of_path("render", path, &args.particles)?,
            None if args.particles.any() => {
                let message = "these settings are for a file of particles: name one";
                return Err(Failure::usage("render", message));
            }
            None => Source::Field { seed },
        };
        if matches!(source, Source::Prepared(_)) {
            store::refuse_changes(args)?;
        }
        if args.style.preset().is_some() && !matches!(source, Source::Particles(..)) {
            let message = "--preset is for a file of particles: a scene says how it looks";
            return Err(Failure::usage("render", message));
        }
        args.keep.check()?;
        let part = args.part.settled();
        let (part, deal) = if args.is_sequence() { (None, part) } else { (part, None) };
        let looks = args.looks.looks(args.particles.options().radius_scale);
        Ok(Self {
            source: with_columns(source, &looks)?,
            looks,
            typed: (&args.particles, &args.looks),
            color_bar: args.looks.color_bar.as_ref(),
            output: args.output.clone(),
            format,
            picture: &args.picture,
            slices: &args.slices,
            views: &args.views,
            style: &args.style,
            turn: None,
            frame: None,
            common: None,
            encoding: &args.encoding,
            keep: &args.keep,
            sequence: args.sequence,
            place: None,
            deal,
            film,
            part,
            split: args.part.split,
            speed: &args.speed,
            tracer: Tracer {
                traversal: args.speed.traversal,
                width: args.speed.lanes.unwrap_or(Tracer::default().width),
            },
            threads: threads::count(args.speed.threads),
            report: args.report,
        })
    }

    /// Returns whether it is one of many pictures.
    pub(in crate::cli) fn is_of_sequence(&self) -> bool {
        self.place.is_some()
    }

    /// Returns whether the file of the picture says of which scene it is.
    pub(in crate::cli) fn is_identified(&self) -> bool {
        self.film.is_none() && (self.is_of_sequence() || self.sequence.skip_existing)
    }

    /// The threads that do it.
    pub(in crate::cli) fn pool(&self) -> Result<rayon::ThreadPool, Failure> {
        threads::pool(self.threads)
    }

    /// The tree for a render of so many spheres and samples.
    pub(in crate::cli) fn builder(&self, spheres: usize, samples: u64) -> Builder {
        match self.speed.builder {
            names::Builder::Auto => World::builder(spheres, samples),
            names::Builder::Median => Builder::Median,
            names::Builder::SurfaceArea => Builder::SurfaceArea,
            names::Builder::Morton => Builder::Morton,
        }
    }

    /// The part of the picture that is rendered, once its size is known.
    pub(in crate::cli) fn region(&self, settings: &Settings) -> Result<Region, Failure> {
        let (width, height) = (settings.width, settings.height);
        let Some(part) = self.picture.region else {
            return Ok(Region { x: 0, y: 0, width, height });
        };
        let fits = |first: u32, count: u32, most: u32| {
            u64::from(first) + u64::from(count) <= u64::from(most)
        };
        if fits(part.x, part.width, width) && fits(part.y, part.height, height) {
            return Ok(part);
        }
        let message = format!(
            "--region {} does not lie in the picture of {width}x{height}; X + W is at most \
             {width}, Y + H at most {height}",
            region_text(part)
        );
        Err(Failure::usage("render", message))
    }
}

/// Refuses what films cannot have.
fn check_film(args: &RenderArgs) -> Result<(), Failure> {
    let numbered = "write numbered pictures, as with -o NAME-%04d.png, and make the film of them";
    let what = if !args.is_sequence() {
        let message = "a film has many pictures: add --frame all or --turntable N, or end the name of \
                       --output in .png";
        return Err(Failure::usage("render", message));
    } else if !args.encoding.layers.is_empty() {
        "--layers"
    } else if args.encoding.bits.is_some() || args.encoding.ppm.is_some() {
        "--bits and --ppm"
    } else if args.keep.file().is_some() {
        "--checkpoint"
    } else if args.part.settled().is_some() {
        "--part"
    } else if args.sequence.skip_existing {
        "--skip-existing"
    } else if args.style.look(None, Look::default()).is_transparent() {
        "a transparent background"
    } else {
        return Ok(());
    };
    Err(Failure::usage("render", format!("a film has no room for {what}: {numbered}")))
}

/// Refuses a transparent background in files that cannot have one.
pub(in crate::cli) fn check_alpha(look: &Look, format: Format) -> Result<(), Failure> {
    if !look.is_transparent() || format.has_alpha() {
        return Ok(());
    }
    let suffixes = Format::list_suffixes(Format::has_alpha);
    let message = format!(
        "{format} has no room for a transparent background; end the name of --output in {suffixes}, \
         or give --background white"
    );
    Err(Failure::usage("render", message))
}
