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
mod shown;
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

use bodies::FileBodies;
use spherule_core::internals::body_rows::{BodyKind, BodyRows};

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

impl Scene {
    /// The bodies of all kinds but spheres, in the order in which they are numbered.
    #[doc(hidden)]
    pub fn other_bodies(&self) -> [&dyn BodyColumns; BodyKind::ALL.len() - 1] {
        [&self.sticks, &self.ellipsoids, &self.cones, &self.triangles]
    }

    /// The numbers of bodies.
    #[doc(hidden)]
    pub fn body_rows(&self) -> BodyRows {
        let mut rows = BodyRows::default();
        rows.0[BodyKind::Sphere as usize] = self.spheres.len();
        self.other_bodies().iter().for_each(|bodies| rows.0[bodies.kind() as usize] = bodies.len());
        rows
    }

    /// The same bodies, as files describe them.
    fn file_bodies(&self) -> [&dyn FileBodies; BodyKind::ALL.len() - 1] {
        [&self.sticks, &self.ellipsoids, &self.cones, &self.triangles]
    }

    /// Reads the same bodies from files.
    fn file_bodies_mut(&mut self) -> [&mut dyn FileBodies; BodyKind::ALL.len() - 1] {
        [&mut self.sticks, &mut self.ellipsoids, &mut self.cones, &mut self.triangles]
    }

    /// Appends the same bodies of another scene; `material` gives the row here of a row of its materials.
    #[doc(hidden)]
    pub fn append_bodies(&mut self, other: &Self, material: impl Fn(u32) -> u32) {
        self.sticks.append(other.sticks.clone(), &material);
        self.ellipsoids.append(other.ellipsoids.clone(), &material);
        self.cones.append(other.cones.clone(), &material);
        self.triangles.append(other.triangles.clone(), &material);
    }

    /// Returns whether there is no body.
    pub fn is_empty(&self) -> bool {
        self.spheres.is_empty() && self.other_bodies().iter().all(|bodies| bodies.is_empty())
    }
}
