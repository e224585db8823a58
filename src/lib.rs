//! Renders scenes made of spheres: random sphere fields, particle simulations, molecules.
//!
//! Three things set Spherule apart. **Visibility is exact**: which sphere a ray hits first is decided on
//! the numbers as they are stored, without an epsilon, at any scale ([`query`]). **There is one image**:
//! the same scene, seed and settings give the same bytes at every lane width, thread count and BVH
//! ([`render`]). And **what a scene does not need is skipped**: a census of the world decides which stages
//! run ([`world::Features`]).
//!
//! # Data flow
//!
//! ```text
//! scene file, particle file, generator
//!    -> Scene    what the user wrote, validated, in double precision       scene
//!    -> World    columns for the kernels, with a BVH                       world
//!    -> Render   samples of all pixels, their error and statistics         render
//!    -> Image    linear radiance, and files of it                          image
//! ```
//!
//! Everything that can be wrong with a scene is found by the time there is a [`World`]; after that, only
//! settings out of range are refused.
//!
//! # Example
//!
//! A sphere in the sun, drawn in characters:
//!
//! ```
//! use glam::DVec3;
//! use spherule::render::{Options, render};
//! use spherule::scene::{EnvironmentMap, Light, Material, NamedMaterial, Pose, Rgb, Scene};
//! use spherule::world::World;
//!
//! let mut scene = Scene::default();
//! scene.spheres.push(DVec3::ZERO, 1.0, 0, Rgb::ONE);
//! let material = Material::Lambertian { color: Rgb::ONE };
//! scene.materials.push(NamedMaterial { name: "white".into(), material });
//! scene.lights.push(Light::Sun {
//!     direction: DVec3::new(-1.0, 1.0, 1.0).normalize(),
//!     irradiance: Rgb::splat(3.0),
//!     angular_radius: 0.0,
//! });
//! scene.environment.map = EnvironmentMap::Constant(Rgb::ZERO);
//! scene.camera.pose = Pose::Fit { direction: DVec3::NEG_Z, margin: 0.0 };
//! (scene.settings.width, scene.settings.height) = (11, 11);
//!
//! let world = World::build(&scene)?;
//! let picture = render(&world, &scene.settings, &Options::default())?.image;
//!
//! let shades: Vec<char> = " .:-=+*#%@".chars().collect();
//! let rows: Vec<String> = picture
//!     .pixels
//!     .chunks(11)
//!     .map(|row| row.iter().map(|pixel| shades[(pixel[1] * 9.9) as usize]).collect())
//!     .collect();
//! assert_eq!(rows, [
//!     "  :=**+-.  ",
//!     " :*%%#*+=. ",
//!     ":#%%##*+=: ",
//!     "*%%##*++-: ",
//!     "*%##**+=-: ",
//!     "*##**+=-:. ",
//!     "+**++=--:  ",
//!     "-+++=--:.  ",
//!     ".-=--:..   ",
//!     " .:::.     ",
//!     "           ",
//! ]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct LibraryGuide;

#[doc(no_inline)]
pub use spherule_core as query;
#[doc(no_inline)]
pub use spherule_particles as particles;

pub use image::Image;
pub use scene::Scene;
pub use world::World;

/// Colors for numbers, categories and elements.
pub mod color {
    #[doc(inline)]
    pub use spherule_render::color::{
        CustomMap, Map, Range, RangeError, Rgb, Scale, Spacing, Tick, category, linear_from_srgb,
        parse, srgb, ticks,
    };
}

/// Scenes: spheres, materials, lights, camera and settings, in double precision, in the user's units.
pub mod scene {
    #[doc(inline)]
    pub use spherule_render::scene::{
        Anchor, Annotations, Axis, AxisTripod, Background, BodyBytes, Camera, ColorBar,
        ColorLegend, ConductorFresnel, Cones, Denoise, Ellipsoids, Environment, EnvironmentMap,
        FileError, Filter, Footprint, FramedSphere, Ground, Header, Identity, Insets, Integrator,
        InvalidSetting, Label, Length, Lens, LetterSize, Lettering, Light, LightChoice, Look,
        Material, Measure, NamedMaterial, Paper, Place, Pose, Preset, Projection, Rgb, Roulette,
        SamplerKind, ScaleBar, Scene, Settings, Slice, SliceMode, SlicePlane, Spheres, Sticks,
        Tone, Triangles, text_without_columns, write, write_as,
    };

    /// Generators of spheres.
    pub mod generate {
        #[doc(inline)]
        pub use spherule_render::scene::generate::{
            Field, GenerateError, Generator, Grid, Group, Lattice, Sphereflake, Volume, Weekend,
            default_scene,
        };
    }

    /// Scenes of particle files: selections, periodic images, colors and radii by column.
    pub mod particles {
        #[doc(inline)]
        pub use spherule_render::scene::particles::{
            AddedBodies, Applied, ArrowCentering, ArrowSizes, ArrowStyle, Arrows, BondRules,
            BondSource, Bonds, Boundary, Cell, ColorEnd, ColorEnds, Coloring, ColumnColors,
            ColumnSummary, ColumnValues, Coordination, ElementColors, FirstFrame, Legend, Model,
            NumberColors, Opacity, Orientation, Outside, ParticleStyle, Particles, PeriodicError,
            Polyhedra, Properties, SelectedStyle, Selection, Shapes, SharedColors, Trails,
            TrajectoryReader, TypeMaterial, TypeStyle, UpReason, VectorColumns,
            accept_radii_expression, of_frame, of_frame_in, read,
        };
    }
}

/// The table of render settings: their names, kinds and ranges.
pub mod settings {
    #[doc(inline)]
    pub use spherule_render::settings::{
        Kind, Limits, Names, Need, Role, SETTINGS, Scope, Setting, Value,
    };
}

/// Worlds: scenes as the kernels read them.
pub mod world {
    #[doc(inline)]
    pub use spherule_core::internals::bvh::builders::Builder;
    #[doc(inline)]
    pub use spherule_render::world::{Features, World, WorldError};

    /// Cameras that frame a scene.
    pub mod framing {
        #[doc(inline)]
        pub use spherule_render::world::framing::include_points;
        #[doc(inline)]
        pub use spherule_render::world::framing::view::{View, choose, vertical};
    }
}

/// Composition of scenes: particles or a scene, and all that is asked of it, become the scene that is drawn.
#[cfg(feature = "drawing")]
pub mod compose {
    #[doc(inline)]
    pub use spherule_render::compose::{
        AnnotationRequest, Axes, Bar, CameraRequest, CellRequest, Content, Descriptions, Fault,
        Focus, LabelText, Labels, LensRequest, LookAt, MeasureRequest, ROWS, Request, Sections,
        Shared, Staged, Subject, Survey, Template, Value, change, choose, extent, frame,
        light_ahead, place, position, stage, zoom,
    };
}

/// Overlays of finished images: the look, and annotations.
pub mod overlay {
    /// Annotations: color bars, legends, axes, scale bars and labels.
    #[cfg(feature = "drawing")]
    pub mod annotations {
        #[doc(inline)]
        pub use spherule_render::overlay::annotations::{AnnotationDrawing, draw, insets};
    }
    #[doc(inline)]
    pub use spherule_render::overlay::{Canvas, Matte};
}

/// Renders: passes over tiles, tiles over threads; renders that can be stopped and resumed.
pub mod render {
    #[doc(inline)]
    pub use spherule_render::film::{Film, Region, RegionError};
    #[doc(inline)]
    pub use spherule_render::noise::{Noise, StopCondition};
    #[doc(inline)]
    pub use spherule_render::render::{
        Elisions, End, ImagePart, IncompatibleSettings, Judge, Options, Progress, Render,
        RenderError, ResumableRender, Samples, Statistics, Status, Tasks, Totals, render,
    };
    #[doc(inline)]
    pub use spherule_render::trace::{PacketWidth, Tracer, Traversal};
}

/// Denoising, and the error of its result.
pub mod denoise {
    #[doc(inline)]
    pub use spherule_render::denoise::{
        Asked, Choice, Denoised, Denoiser, Judged, MAX_ERROR, choose, denoise, max_samples,
        trajectory_samples,
    };
}

/// Files of unfinished renders.
pub mod checkpoint {
    #[doc(inline)]
    pub use spherule_render::checkpoint::{
        Caption, CheckpointError, Lock, LockError, Origin, inspect, read, write,
    };
}

/// Files of scenes with their BVH, which start to render at once.
pub mod prepared {
    #[doc(inline)]
    pub use spherule_render::prepared::{
        PrepareError, PreparedError, PreparedScene, is_prepared, read, write,
    };
}

/// Parts of a render, and their merge.
pub mod split {
    #[doc(inline)]
    pub use spherule_render::split::{Merge, MergeError, Part, Split, SplitError, uncovered_parts};
}

/// Auxiliary channels for denoisers and compositing.
pub mod layers {
    #[doc(inline)]
    pub use spherule_render::layers::{GROUND_PLANE, Layer, Layers, NOTHING, layers};
}

/// Drawings of annotations as vectors, and pages: SVG and PDF files of an image with a drawing over it.
#[cfg(feature = "drawing")]
pub mod graphics {
    #[doc(inline)]
    pub use spherule_render::graphics::{Drawing, Figure, Format, Page, PageError};
}

/// Videos of images, by the program `ffmpeg`.
pub mod video {
    #[doc(inline)]
    pub use spherule_render::video::{Container, FPS, Video, VideoError};
}

/// Images: linear RGB in memory, their files, and their comparison.
pub mod image {
    #[doc(inline)]
    pub use spherule_render::image::{
        Channel, CompareError, Comparison, Depth, Difference, Format, Image, ImageError, Metadata,
        PpmEncoding, QUALITY, Values, WriteOptions, check_writable, compare, read_metadata,
    };

    /// Exposure, tone curve and sRGB curve of displays.
    pub mod tone {
        #[doc(inline)]
        pub use spherule_render::image::tone::DisplayTransform;
    }
}
