//! The scene as the kernels want it: columns, tables, and a census of what there is.
//!
//! [`World::build`] takes a [`Scene`] and moves it by a multiple of a power of two to the origin,
//! scales it by an exact power of two so that its largest coordinate is about 1 ([`Frame`]), stores
//! it in single precision, builds the tree and permutes the spheres' columns so that a leaf is a
//! slice. Everything that can be wrong with a scene is found here or before; past it nothing can
//! fail.

mod appearance;
mod camera;
mod camera_visible;
mod caustics;
mod census;
mod check;
mod cut;
mod environment;
mod fit;
mod footprint;
mod frame;
pub mod framing;
mod ground;
mod lights;
mod materials;
mod parts;
mod spheres;
mod visibility;

pub use appearance::{Appearance, Colors, Column};
pub use camera::Camera;
pub use camera_visible::CameraVisible;
pub use caustics::CausticCasters;
pub(crate) use caustics::{CausticHit, CausticPath, CausticQuery, CausticSample};
pub use census::Features;
pub use cut::{Cut, Span};
pub use environment::{Environment, Picture, Radiance, SkySample};
pub(crate) use fit::Placement;
pub use footprint::{ColorColumn, Footprint};
pub use frame::Frame;
pub use ground::Ground;
pub use lights::{
    Disc, LightRow, LightSample, LightView, Lights, Point, ROW, Receiver, ReceiverRow, Sun,
};
pub use materials::{
    Conductor, Dielectric, Emitter, Kind, Lambertian, MaterialId, Materials, Plastic, Reflective,
};
pub(crate) use parts::{LeftOut, Parts};
pub use visibility::Visibility;

use crate::bvh::Bvh;
use crate::bvh::builders::Builder;
use crate::memory::Shortage;
use crate::ray::GROUND;
use crate::scene::{self, InvalidSetting, Rgb, Scene, Settings};
use crate::spheres::Spheres;
use std::borrow::Cow;

/// Approximate number of rays per sample, with bounces and shadow rays, for choosing the tree builder.
const RAYS_PER_SAMPLE: u64 = 4;

/// Everything that a render reads, immutable.
#[derive(Clone, Debug)]
pub struct World {
    /// From the user's coordinates to the world's.
    pub frame: Frame,
    /// The camera in the user's coordinates.
    pub(crate) placement: Placement,
    /// The spheres, in the order of the tree's leaves.
    pub spheres: Spheres,
    /// What they look like.
    pub appearance: Appearance,
    /// The tree over them.
    pub bvh: Bvh,
    /// Where spheres are cut off.
    pub cut: Cut,
    /// The spheres that the camera sees, if slices hide some from it.
    pub camera_visible: Option<CameraVisible>,
    /// The ground plane, if there is one.
    pub ground: Option<Ground>,
    /// One table for each kind of material.
    pub materials: Materials,
    /// Lights that can be sampled.
    pub lights: Lights,
    /// Pairs of specular sphere and emitter whose caustics are sampled.
    pub caustic_casters: CausticCasters,
    /// What rays see that hit nothing.
    pub environment: Environment,
    /// Who looks.
    pub camera: Camera,
    /// What there is, and so which stages run.
    pub features: Features,
}

/// Why a scene cannot be rendered.
#[derive(Debug, thiserror::Error)]
pub enum WorldError {
    /// Rows are 32-bit numbers, a few of which mean something else.
    #[error("{0} spheres are too many: at most {max} fit; render a part of them", max = Spheres::MAX)]
    TooManySpheres(usize),
    /// The columns, and what it takes to build the tree.
    #[error("{0} spheres need {1}; render fewer of them")]
    Memory(usize, Shortage),
    /// The distribution of the light of a picture of the sky.
    #[error("the environment's picture needs {0}; use a smaller one")]
    Environment(Shortage),
    /// A cap would need a surface that light passes.
    #[error(
        "a slice cuts sphere {0}, which is of glass, but flat caps are opaque; use the mode remove or hide, or another material"
    )]
    Glass(u32),
    /// `fit` without spheres.
    #[error(
        "the camera has nothing to frame: the scene has no spheres, or slices cut all of them away; give it spheres, or give the camera `eye` and `target`"
    )]
    NothingToFit,
    /// The camera is closer to its target than double precision resolves, or similar.
    #[error("the camera at {eye:?} sees nothing: {why}")]
    Camera {
        /// Where it stands, in the scene's coordinates.
        eye: [f64; 3],
        /// What is wrong, and the mend.
        why: &'static str,
    },
    /// A setting is out of its range.
    #[error(transparent)]
    Setting(#[from] InvalidSetting),
    /// A row of a column is invalid; scenes from files are checked before.
    #[error("{0}")]
    Invalid(String),
}

impl World {
    /// Builds the world and the tree that suits its settings.
    ///
    /// Spheres that vanish in single precision beside the largest coordinate (a radius below about
    /// 1e-45 of it) are left out; [`Features::vanished`] counts them.
    ///
    /// # Errors
    /// Too many spheres, or too many for the memory that is left; a camera that frames nothing, or
    /// rows that no scene file could hold: columns of different lengths, values that are not
    /// finite, materials that do not exist.
    pub fn build(scene: &Scene) -> Result<Self, WorldError> {
        let Settings { width, height, spp, .. } = scene.settings;
        let samples = u64::from(width) * u64::from(height) * u64::from(spp);
        Self::build_with(scene, Self::builder(scene.spheres.len(), samples))
    }

    /// The tree that suits a render of so many spheres and samples, all pixels taken together.
    pub fn builder(spheres: usize, samples: u64) -> Builder {
        Builder::for_rays(spheres, samples.saturating_mul(RAYS_PER_SAMPLE))
    }

    /// Builds the world with a certain kind of tree, which changes nothing that is seen.
    ///
    /// # Errors
    /// Those of [`World::build`].
    pub fn build_with(scene: &Scene, builder: Builder) -> Result<Self, WorldError> {
        let at = check::place(scene, Self::bytes_for(scene))?;
        Self::assemble(scene, Cow::Borrowed(&scene.spheres), &at, builder)
    }

    /// Builds the world of a scene whose spheres nobody needs any more: their memory is given back
    /// while the world is built, which halves what both take at most.
    ///
    /// # Errors
    /// Those of [`World::build`]; for all but [`WorldError::Glass`] the scene still has its spheres.
    pub fn build_taking(scene: &mut Scene, builder: Builder) -> Result<Self, WorldError> {
        let at = check::place(scene, Self::bytes_beside(scene))?;
        let spheres = std::mem::take(&mut scene.spheres);
        Self::assemble(scene, Cow::Owned(spheres), &at, builder)
    }

    /// Builds what is in its place.
    fn assemble(
        scene: &Scene,
        from: Cow<scene::Spheres>,
        at: &(Frame, Placement),
        builder: Builder,
    ) -> Result<Self, WorldError> {
        Ok(Self::complete(scene, Parts::build(scene, from, at, builder)?))
    }

    /// Adds to the spheres and their tree all that follows from them and from the rest of the scene.
    pub(crate) fn complete(scene: &Scene, parts: Parts) -> Self {
        let Parts { frame, placement, spheres, bvh, appearance, camera_visible, left_out } = parts;
        let materials = Materials::build(&scene.materials);
        let cut = Cut::build(&scene.slices, &frame);
        let camera = Camera::build(scene, &placement, &frame);
        let environment = Environment::build(&scene.environment);
        let ground = scene.ground.as_ref().map(|ground| Ground::build(ground, &frame, &materials));
        let lights =
            Lights::build(scene, (&frame, &cut), (&spheres, &appearance), &materials, &environment);
        let mut world = Self {
            frame,
            placement,
            spheres,
            appearance,
            bvh,
            cut,
            camera_visible,
            ground,
            materials,
            lights,
            caustic_casters: CausticCasters::default(),
            environment,
            camera,
            features: Features::default(),
        };
        world.features = Features::census(&world, left_out);
        world.caustic_casters = CausticCasters::find(&world);
        world
    }

    /// The same world without its spheres, and so without the light of those that glow.
    pub fn without_spheres(&self) -> Self {
        let mut features = self.features.clone();
        features.glass_at_camera.clear();
        Self {
            frame: self.frame,
            placement: self.placement,
            spheres: Spheres::default(),
            appearance: Appearance::NONE,
            bvh: Bvh::default(),
            cut: Cut::default(),
            camera_visible: None,
            ground: self.ground,
            materials: self.materials.clone(),
            lights: self.lights.without_spheres(&self.environment),
            caustic_casters: CausticCasters::default(),
            environment: self.environment.clone(),
            camera: self.camera,
            features,
        }
    }

    /// Lets the camera of `scene`, and its picture's size, take the place of this world's; all else of
    /// the scene is as the world was built. Pictures are the same to the last bit as those of a world
    /// that is built anew, at a small part of the time.
    ///
    /// False, and nothing is changed, where the camera is so far away that the world has to be built
    /// anew.
    ///
    /// # Errors
    /// The camera sees nothing, or has values out of their ranges.
    pub fn look(&mut self, scene: &Scene) -> Result<bool, WorldError> {
        check::check_view(scene)?;
        let pose = fit::pose(scene)?;
        if !self.frame.suits(&pose) {
            return Ok(false);
        }
        self.camera = Camera::build(scene, &pose, &self.frame);
        self.placement = pose;
        self.features = std::mem::take(&mut self.features).seen_by(self);
        Ok(true)
    }

    /// The material of what was hit: a sphere's row or [`GROUND`].
    #[inline(always)]
    pub fn material(&self, hit: u32) -> MaterialId {
        match &self.ground {
            Some(ground) if hit == GROUND => ground.material,
            _ => self.appearance.material.row(hit as usize),
        }
    }

    /// The factor on the material's color of what was hit.
    #[inline(always)]
    pub fn color(&self, hit: u32) -> Rgb {
        match &self.appearance.color {
            Some(colors) if hit != GROUND => colors.row(hit as usize),
            _ => Rgb::ONE,
        }
    }

    /// The color by which what was hit is told from others: [`Materials::albedo`], times the
    /// sphere's own color.
    pub fn albedo(&self, hit: u32) -> Rgb {
        self.materials.albedo(self.material(hit)) * self.color(hit)
    }
}
