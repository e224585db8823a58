//! Scenes: the user's description in double precision, validated, in the user's own units.
//!
//! A [`Scene`] comes from a [file](mod@file), from a [generator](generate), from a [particle
//! file](particles) or from code; a `World` is built from it. Distances are in the scene's
//! own unit, angles in degrees, colors linear RGB with the primaries of sRGB. [`write`](write())
//! puts a scene into files that load as the same scene.

mod annotations;
mod axis;
mod bodies;
mod camera;
pub mod file;
mod footprint;
pub mod generate;
mod identity;
pub mod keys;
mod light;
mod look;
mod material;
mod measure;
pub mod particles;
mod preset;
mod slice;
mod spheres;
pub(crate) mod write;

pub use crate::color::{Rgb, linear_from_srgb, srgb};
pub use crate::settings::{
    Denoise, Filter, Integrator, InvalidSetting, Length, LightChoice, Paper, Roulette, SamplerKind,
    Settings, Tone,
};
pub use annotations::{
    Anchor, Annotations, AxisTripod, ColorBar, ColorLegend, Label, LetterSize, Lettering, ScaleBar,
};
pub use axis::Axis;
pub use bodies::{
    BodyBytes, BodyColumns, Cones, Ellipsoids, Hull, PlacedBodies, Sticks, Triangles,
};
pub use camera::{Camera, FramedSphere, Insets, Lens, Pose, Projection};
pub use file::included_files;
pub use footprint::{ColorColumn, Footprint};
pub use identity::Identity;
pub use light::{BRIGHTEST, Environment, EnvironmentMap, Light, is_radiance};
pub use look::{Background, Look};
pub use material::{ConductorFresnel, Ground, Material, NamedMaterial};
pub use measure::Measure;
pub use preset::Preset;
pub use slice::{Slice, SliceMode, SlicePlane};
pub use spheres::Spheres;
pub use spherule_particles::{FileError, Place};
pub use write::{Header, text_without_columns, write, write_as};

/// A whole scene: objects, lights, camera and settings.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// One-line description of the scene; may be empty.
    pub title: String,
    /// The spheres, in columns.
    pub spheres: Spheres,
    /// Sticks, in columns. They are numbered after the spheres.
    pub sticks: Sticks,
    /// Ellipsoids, in columns. They are numbered after the sticks.
    pub ellipsoids: Ellipsoids,
    /// Cones, in columns. They are numbered after the ellipsoids.
    pub cones: Cones,
    /// Triangles, in columns. They are numbered after the cones.
    pub triangles: Triangles,
    /// Materials of spheres and ground; `Spheres::material` and `Ground::material` are rows of it.
    pub materials: Vec<NamedMaterial>,
    /// The infinite ground plane, if there is one.
    pub ground: Option<Ground>,
    /// Half spaces that are cut away.
    pub slices: Vec<Slice>,
    /// Lights that are not spheres.
    pub lights: Vec<Light>,
    /// Radiance of rays that hit nothing.
    pub environment: Environment,
    /// The camera.
    pub camera: Camera,
    /// Render settings.
    pub settings: Settings,
    /// Overlays and background.
    pub look: Look,
    /// Annotations of the picture.
    pub annotations: Annotations,
    /// Warnings for the user: one sentence each, such as how many rows of a particle file were dropped
    /// and why.
    pub warnings: Vec<String>,
}
