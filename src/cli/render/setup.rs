//! The setup of a render: scene, settings and output, validated as far as possible without the scene.

use super::args::RenderArgs;
use crate::cli::options::annotations::AnnotationArgs;
use crate::cli::options::appearance::{AppearanceArgs, BarPlace};

use crate::cli::failure::Failure;
use crate::cli::options::checkpoints::CheckpointArgs;
use crate::cli::options::image::{EncodingArgs, PictureArgs, ReportArgs, SpeedArgs};
use crate::cli::options::lists::region_text;
use crate::cli::options::names;
use crate::cli::options::particles::ParticleArgs;
use crate::cli::options::sequences::SequenceArgs;
use crate::cli::options::slices::SliceArgs;
use crate::cli::options::style::StyleArgs;
use crate::cli::options::views::ViewArgs;
use crate::cli::picture_file::{self, AlbumKind};
use crate::cli::source::Source;
use crate::cli::threads;
use spherule_render::World;
use spherule_render::bvh::builders::Builder;
use spherule_render::compose::{Fault, Request, Shared};
use spherule_render::film::Region;
use spherule_render::graphics;
use spherule_render::image::Format;
use spherule_render::scene::particles::{ParticleStyle, TypeStyle};
use spherule_render::scene::{Background, Preset, Settings};
use spherule_render::split::{Part, Split};
use spherule_render::trace::Tracer;
use std::path::PathBuf;

/// Maximum number of values in columns that are read to be told: 20 columns of 200 000 particles.
pub(in crate::cli) const VALUES: usize = 4_000_000;

/// Place of an image in a sequence.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) struct Place {
    /// From 0.
    pub(in crate::cli) index: u64,
    /// True if no other image follows, as far as is known.
    pub(in crate::cli) last: bool,
}

/// Properties shared by all images of a sequence.
#[derive(Clone)]
pub(in crate::cli) struct Common {
    pub(in crate::cli) shared: Shared,
    /// True if the camera is placed for all images, and not only for the first.
    pub(in crate::cli) frames_all: bool,
}

/// The setup of a render: the arguments of its command, validated, and the place of its image in a sequence.
#[derive(Clone)]
pub(in crate::cli) struct RenderSetup<'a> {
    pub(in crate::cli) source: Source,
    /// The request for the scene.
    pub(in crate::cli) request: Request,
    pub(in crate::cli) particles: &'a ParticleArgs,
    pub(in crate::cli) looks: &'a AppearanceArgs,
    pub(in crate::cli) color_bar: Option<&'a BarPlace>,
    pub(in crate::cli) output: PathBuf,
    /// Format of the image, or of the image on the page.
    pub(in crate::cli) format: Format,
    /// Format of the page with the image and its annotations as vectors, if the output is one.
    pub(in crate::cli) page: Option<graphics::Format>,
    pub(in crate::cli) picture: &'a PictureArgs,
    pub(in crate::cli) slices: &'a SliceArgs,
    pub(in crate::cli) views: &'a ViewArgs,
    pub(in crate::cli) style: &'a StyleArgs,
    pub(in crate::cli) annotations: &'a AnnotationArgs,
    /// Number of the turntable's image, from 0.
    pub(in crate::cli) turn: Option<u32>,
    /// Number of the trajectory frame.
    pub(in crate::cli) frame: Option<u64>,
    /// Properties shared by all images of the sequence.
    pub(in crate::cli) common: Option<Common>,
    pub(in crate::cli) encoding: &'a EncodingArgs,
    pub(in crate::cli) checkpoints: &'a CheckpointArgs,
    pub(in crate::cli) sequence: SequenceArgs,
    /// Place in the sequence.
    pub(in crate::cli) place: Option<Place>,
    /// The part of the sequence that this process renders, if not all.
    pub(in crate::cli) deal: Option<Part>,
    /// Kind of the file of all images, if there is one.
    pub(in crate::cli) album: Option<AlbumKind>,
    /// The part of the image that this process renders, if not all.
    pub(in crate::cli) part: Option<Part>,
    pub(in crate::cli) split: Option<Split>,
    pub(in crate::cli) speed: &'a SpeedArgs,
    pub(in crate::cli) tracer: Tracer,
    pub(in crate::cli) threads: usize,
    pub(in crate::cli) report: ReportArgs,
}

/// Suffixes of pages and videos.
const PAGES_AND_VIDEOS: [&str; 7] = ["pdf", "svg", "html", "mp4", "mov", "webm", "gif"];

impl<'a> RenderSetup<'a> {
    /// Creates the setup from the arguments.
    pub(in crate::cli) fn new(args: &'a RenderArgs) -> Result<Self, Failure> {
        let seed = args.picture.settings.seed().unwrap_or(0);
        let album = album(args)?;
        let page = graphics::Format::of_suffix(&args.output)
            .filter(|page| *page != graphics::Format::Png)
            .filter(|_| args.encoding.output_format.is_none());
        if page.is_some() {
            check_page(args)?;
        }
        let format = format(args, album, page)?;
        if args.sequence.skip_existing && format == Format::Pfm {
            let message = "--skip-existing needs metadata, which PFM files cannot store; use an --output \
                           that ends in .png, .ppm or .exr";
            return Err(Failure::usage("render", message));
        }
        args.encoding.check_layers("render", format)?;
        let background = args.style.background();
        check_alpha(background == Some(Background::Transparent), format)?;
        let inside = matches!(&args.looks.color_bar, Some(BarPlace::Inside(_)));
        if inside && args.picture.region.is_some() {
            let message = "--color-bar inside needs the whole image; remove --region";
            return Err(Failure::usage("render", message));
        }
        if !args.annotations.is_empty() && args.picture.region.is_some() {
            let message = "annotations need the whole image; remove --region";
            return Err(Failure::usage("render", message));
        }
        let source = match &args.scene {
            Some(path) => Source::of_path("render", path, &args.particles)?,
            None if args.particles.any() => {
                let message = "these options need a particle file; name one";
                return Err(Failure::usage("render", message));
            }
            None => Source::Field { seed },
        };
        if matches!(source, Source::Prepared(_)) {
            refuse_changes(args)?;
        }
        if args.style.preset().is_some() && !matches!(source, Source::Particles(..)) {
            let message = "--preset applies only to particle files; a scene defines its own style";
            return Err(Failure::usage("render", message));
        }
        if args.views.sets_up() && !matches!(source, Source::Particles(..)) {
            let message = "--up applies only to particle files; a scene's [camera] says what is up";
            return Err(Failure::usage("render", message));
        }
        args.checkpoints.check()?;
        let part = args.part.resolved();
        let (part, deal) = if args.is_sequence() { (None, part) } else { (part, None) };
        let mut looks = args.looks.looks(args.particles.options().radius_scale);
        looks.framed = args.views.framed();
        // A scene refuses what is for particles itself.
        if matches!(source, Source::Particles(..)) {
            looks.also_read =
                [args.views.lens().columns(), args.annotations.request(None).columns()].concat();
        }
        Ok(Self {
            source: with_columns(source, &looks, album)?,
            request: Request {
                keeps_labels: album == Some(AlbumKind::Figure),
                ..request(args, looks, part.is_some())?
            },
            particles: &args.particles,
            looks: &args.looks,
            color_bar: args.looks.color_bar.as_ref(),
            output: args.output.clone(),
            format,
            page,
            picture: &args.picture,
            slices: &args.slices,
            views: &args.views,
            style: &args.style,
            annotations: &args.annotations,
            turn: None,
            frame: None,
            common: None,
            encoding: &args.encoding,
            checkpoints: &args.checkpoints,
            sequence: args.sequence,
            place: None,
            deal,
            album,
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

    /// Returns the preset: that of `--preset`, or the default of particle files.
    pub(in crate::cli) fn preset(&self) -> Option<Preset> {
        let particles = matches!(self.source, Source::Particles(..));
        self.style.preset().or(particles.then(Preset::default))
    }

    /// Words a fault of the scene's composition.
    pub(in crate::cli) fn refuse(&self, fault: Fault) -> Failure {
        let message = match fault {
            Fault::File(error) => return error.into(),
            Fault::World(title, error) => return Failure::World(title, error),
            Fault::Legend { numeric: true } => {
                "--legend needs colors that stand for names; use --color-bar for those of numbers, or --color-map \
                 categories for a color for each integer"
            }
            Fault::Legend { numeric: false } => {
                "--legend needs a particle file whose colors stand for elements, types or the texts of \
                 --color-by"
            }
            Fault::AxesOfCell => "--axes=cell needs a particle file with a cell; use --axes",
            Fault::Label { row, why } => {
                let message = format!("--label '{}': {why}", self.annotations.label(row));
                return Failure::usage("render", message);
            }
            Fault::Measure { row, why } => {
                let message = format!("--measure {}: {why}", self.annotations.measure(row));
                return Failure::usage("render", message);
            }
            Fault::Margin => "--margin has no effect on the scene's own camera; add --view",
            Fault::FocusOfPinhole => "--focus needs a lens; add --aperture with its diameter",
            Fault::FocusWithoutParticles => "--focus id:ID needs a particle file; give a distance",
            Fault::FocusBehindCamera(id) => {
                let message = format!("--focus: the particle {id} is behind the camera");
                return Failure::usage("render", message);
            }
        };
        Failure::usage("render", message)
    }

    /// Returns whether the image is part of a sequence.
    pub(in crate::cli) fn is_of_sequence(&self) -> bool {
        self.place.is_some()
    }

    /// Returns whether the image's metadata identifies the scene.
    pub(in crate::cli) fn is_identified(&self) -> bool {
        self.album.is_none() && (self.is_of_sequence() || self.sequence.skip_existing)
    }

    /// Creates the thread pool.
    pub(in crate::cli) fn pool(&self) -> Result<rayon::ThreadPool, Failure> {
        threads::pool(self.threads)
    }

    /// Returns the BVH builder for a number of spheres and samples.
    pub(in crate::cli) fn builder(&self, spheres: usize, samples: u64) -> Builder {
        match self.speed.builder {
            names::Builder::Auto => World::builder(spheres, samples),
            names::Builder::Median => Builder::Median,
            names::Builder::SurfaceArea => Builder::SurfaceArea,
            names::Builder::Morton => Builder::Morton,
        }
    }

    /// Returns the region that is rendered, for an image of known size.
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
            "--region {} exceeds the image of {width}x{height} pixels; X + W is at most {width}, Y + H at \
             most {height}",
            region_text(part)
        );
        Err(Failure::usage("render", message))
    }
}

/// Returns the kind of the file of all images, if there is one.
fn album(args: &RenderArgs) -> Result<Option<AlbumKind>, Failure> {
    // An explicit format applies to images, whatever their names.
    let album =
        AlbumKind::of_suffix(&args.output).filter(|_| args.encoding.output_format.is_none());
    if let Some(album) = album {
        check_album(args, album)?;
    }
    if args.sequence.fps.is_some() && !matches!(album, Some(AlbumKind::Video(_))) {
        let message =
            "--fps applies only to videos; use an --output that ends in .mp4, .mov, .webm or .gif";
        return Err(Failure::usage("render", message));
    }
    Ok(album)
}

/// Returns the format of the image, or of each image in an album or on a page.
fn format(
    args: &RenderArgs,
    album: Option<AlbumKind>,
    page: Option<graphics::Format>,
) -> Result<Format, Failure> {
    let transparent = args.style.background() == Some(Background::Transparent);
    Ok(match album {
        // Images of a video have 8 bits, as PPM files do.
        Some(AlbumKind::Video(_)) => Format::Ppm,
        // Many images are small files, with what their format can store.
        Some(AlbumKind::Figure) if args.is_sequence() && !transparent => Format::Jpeg,
        Some(AlbumKind::Figure) => Format::Png,
        None if page.is_some() => Format::Png,
        None => picture_file::format(&args.output, args.encoding.output_format)
            .map_err(|error| error.or_suffixes(&PAGES_AND_VIDEOS))?,
    })
}

/// Returns what the options ask of the scene, with the resolution, since sizes depend on it; of a part of an image, all
/// settings of its display, too, since the image is written elsewhere.
fn request(args: &RenderArgs, style: ParticleStyle, part: bool) -> Result<Request, Failure> {
    let bar = match &args.looks.color_bar {
        Some(BarPlace::Inside(position)) => Some(*position),
        Some(BarPlace::File(..)) | None => None,
    };
    let mut settings = args.picture.settings.values().to_vec();
    let display = args.encoding.display.values().iter();
    settings.extend(display.filter(|(name, _)| part || *name == "dpi"));
    let request = Request {
        style,
        cell: args.views.cell(),
        up: args.views.up(),
        preset: args.style.preset(),
        background: args.style.background(),
        depth_cue: args.style.depth_cue(),
        outline: args.style.outline(),
        planes: args.slices.planes().to_vec(),
        slice_mode: args.slices.mode(),
        annotations: args.annotations.request(bar),
        settings,
        camera: args.views.camera()?,
        lit_from: args.views.lit_from()?,
        lens: args.views.lens(),
        ..Request::default()
    };
    match request.contradiction() {
        Some(name) => {
            let name = name.replace('_', "-");
            let message = format!("--camera says all of the camera; remove --{name}");
            Err(Failure::usage("render", message))
        }
        None => Ok(request),
    }
}

/// Returns the source, with the columns that colors, selections and figures need; an error if it has no particles.
fn with_columns(
    source: Source,
    looks: &ParticleStyle,
    album: Option<AlbumKind>,
) -> Result<Source, Failure> {
    match source {
        Source::Particles(path, mut options) => {
            options.columns.wanted.extend(looks.columns());
            options.columns.rest = (album == Some(AlbumKind::Figure)).then_some(VALUES);
            options.bonds = looks.bond_source();
            let element = |style: &TypeStyle| Some((style.name.clone(), style.element?));
            options.elements = looks.types.iter().filter_map(element).collect();
            Ok(Source::Particles(path, options))
        }
        other if *looks == ParticleStyle::default() => Ok(other),
        Source::Toml(_) | Source::Prepared(_) | Source::Field { .. } => {
            let message = "options for particles need a particle file; a scene defines its own colors and \
                           materials";
            Err(Failure::usage("render", message))
        }
    }
}

/// Rejects options that would change a prepared scene.
fn refuse_changes(args: &RenderArgs) -> Result<(), Failure> {
    let none = args.looks.list(None).is_empty() && args.looks.color_bar.is_none();
    let none = none && args.slices.list().is_empty() && args.style.list().is_empty();
    let none = none && args.views.list().is_empty() && args.annotations.is_empty();
    let none = none && !args.is_sequence();
    if args.prepare.is_none() && none && !args.particles.any() {
        return Ok(());
    }
    let message = "spheres, materials, camera and annotations of a prepared scene are fixed; use the file it was made \
                   from, or remove options that change them";
    Err(Failure::usage("render", message))
}

/// Rejects options that do not apply to pages.
fn check_page(args: &RenderArgs) -> Result<(), Failure> {
    let what = if !args.encoding.layers.is_empty() {
        "--layers; use an --output that ends in .exr"
    } else if args.sequence.skip_existing {
        "metadata for --skip-existing; use an --output that ends in .png, .ppm or .exr"
    } else if args.part.resolved().is_some() && !args.is_sequence() {
        "parts of an image; use an --output that ends in .png"
    } else {
        return Ok(());
    };
    Err(Failure::usage("render", format!("SVG and PDF files cannot store {what}")))
}

/// Rejects options that do not apply to files of all images.
fn check_album(args: &RenderArgs, album: AlbumKind) -> Result<(), Failure> {
    let is_video = album != AlbumKind::Figure;
    let instead = if is_video {
        "write numbered images with -o NAME-%04d.png, and encode the video from them"
    } else {
        "use an --output that ends in .png"
    };
    let what = if is_video && !args.is_sequence() {
        let message = "a video needs a sequence of images; add --frame all or --turntable N, or use an \
                       --output that ends in .png";
        return Err(Failure::usage("render", message));
    } else if !args.encoding.layers.is_empty() {
        "--layers"
    } else if args.encoding.bits.is_some() || args.encoding.ppm.is_some() {
        "--bits and --ppm"
    } else if args.checkpoints.file().is_some() {
        "--checkpoint"
    } else if args.part.resolved().is_some() {
        "--part"
    } else if args.sequence.skip_existing {
        "--skip-existing"
    } else if is_video && args.style.background() == Some(Background::Transparent) {
        "a transparent background"
    } else {
        return Ok(());
    };
    Err(Failure::usage("render", format!("{} cannot store {what}; {instead}", album.name())))
}

/// Rejects a transparent background for formats without alpha.
pub(in crate::cli) fn check_alpha(transparent: bool, format: Format) -> Result<(), Failure> {
    if !transparent || format.has_alpha() {
        return Ok(());
    }
    let suffixes = Format::list_suffixes(Format::has_alpha);
    let message = format!(
        "{format} files cannot store a transparent background; use an --output that ends in {suffixes}, or \
         --background white"
    );
    Err(Failure::usage("render", message))
}
