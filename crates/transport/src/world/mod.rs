//! The world: a scene as kernels read it, in columns and tables, and a census of its features.
//!
//! [`World::build`] moves a [`Scene`] to the origin by a multiple of a power of two, scales it by an
//! exact power of two so that its largest coordinate is about 1 ([`Transform`]), stores it in single
//! precision, builds the tree and permutes the spheres' columns so that a leaf is a contiguous range.
//! All errors of a scene are found here or before; rendering cannot fail.

mod appearance;
mod bodies;
mod camera;
mod camera_visible;
mod caustics;
mod census;
mod check;
mod cut;
mod device;
mod environment;
mod fit;
pub mod framing;
mod ground;
mod light_images;
mod lights;
mod parts;
mod spheres;
mod transform;
mod visibility;

pub use appearance::{Appearance, Colors, Column};
pub use bodies::{OtherBodies, VisibleBodies, WorldBodies};
pub use camera::{Camera, CameraTerms};
pub use camera_visible::CameraVisible;
pub use caustics::CausticCasters;
pub(crate) use caustics::{
    Caster, CausticHit, CausticPath, CausticQuery, CausticSample, CausticSource,
};
pub use census::Features;
pub use cut::{Cut, Span};
pub use device::{
    DeviceCaster, DeviceCasterNode, DeviceCaustics, DeviceEmitter, DeviceIntegration,
    DeviceIntegrator, DeviceJob, DeviceLightChoice, DeviceLightNode, DeviceLightTree, DeviceLights,
    DevicePath, DevicePaths, DevicePicture, DevicePixel, DevicePixels, DevicePoint, DeviceRoulette,
    DeviceSky, DeviceSkyPart, DeviceSun,
};
pub use environment::{
    Environment, Irradiance, PartBounds, Picture, Radiance, SkyLight, SkySamples,
};
pub use fit::Placement;
pub use ground::Ground;
pub(crate) use light_images::{LightImage, LightImages, SeenLight};
pub(crate) use lights::MAX_MIDDLES;
pub use lights::{
    Disc, LANES, LightLanes, LightSample, LightView, Lights, Point, Receiver, ReceiverRow, Sun,
};
pub use parts::{OmittedSpheres, Parts};
pub use transform::Transform;
pub use visibility::Visibility;

use crate::body_rows::{BodyKind, BodyRows};
use crate::bvh::builders::Builder;
use crate::bvh::{Bvh, Tree};
use crate::memory::Shortage;
use crate::ray::{GROUND, MISS};
use crate::scene::{self, Background, Footprint, Rgb, Scene};
use crate::settings::{InvalidSetting, Settings};
use crate::shade::{MaterialId, MaterialKind, Materials};
use crate::spheres::Spheres;
use crate::translucency::OpticalDepth;
use lights::EmissiveSpheres;
use std::borrow::Cow;
use std::sync::Arc;

/// Approximate number of rays per sample, with bounces and shadow rays, for choosing the tree builder.
const RAYS_PER_SAMPLE: u64 = 4;

/// All data that a render reads, immutable.
#[derive(Clone, Debug)]
pub struct World {
    /// Transform from the user's coordinates to the world's.
    #[doc(hidden)]
    pub transform: Transform,
    /// The camera in the user's coordinates.
    pub placement: Placement,
    /// The spheres, in the order of the tree's leaves.
    #[doc(hidden)]
    pub spheres: Spheres,
    /// Materials and colors of the spheres.
    #[doc(hidden)]
    pub appearance: Appearance,
    /// The tree over them.
    #[doc(hidden)]
    pub bvh: Bvh,
    /// All other bodies.
    #[doc(hidden)]
    pub others: OtherBodies,
    /// Numbers of bodies of the scene other than spheres, those that slices remove included.
    scene_bodies: BodyRows,
    /// Planes at which spheres are cut.
    #[doc(hidden)]
    pub cut: Cut,
    /// The spheres that the camera sees, if slices hide some from it.
    #[doc(hidden)]
    pub camera_visible: Option<CameraVisible>,
    /// In worlds with translucent bodies, the rows of spheres that coincide with an earlier one, which is seen alone.
    coincident: Vec<u32>,
    /// The ground plane, if there is one.
    #[doc(hidden)]
    pub ground: Option<Ground>,
    /// One table for each kind of material.
    #[doc(hidden)]
    pub materials: Materials,
    /// Lights that can be sampled.
    #[doc(hidden)]
    pub lights: Lights,
    /// The specular spheres and emitters whose caustics are sampled.
    #[doc(hidden)]
    pub caustic_casters: CausticCasters,
    /// Images of lights in the picture.
    pub(crate) light_images: LightImages,
    /// The environment: radiance of rays that hit nothing.
    #[doc(hidden)]
    pub environment: Environment,
    /// The camera.
    #[doc(hidden)]
    pub camera: Camera,
    /// Follows whole paths in place of the processor, where it can.
    #[doc(hidden)]
    pub device_paths: Option<Arc<dyn DeviceIntegrator>>,
    /// Features of the world, which decide which stages run.
    pub features: Features,
}

/// Reasons why a scene cannot be rendered.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WorldError {
    /// Rows are 32-bit numbers, a few of which are reserved.
    #[error("too many spheres: {0}, but at most {max} fit; render a part of them", max = Spheres::MAX)]
    TooManySpheres(usize),
    /// Not enough memory for the columns and the construction of the tree.
    #[error("{0} spheres need {1}; render fewer of them")]
    Memory(usize, Shortage),
    /// Not enough memory for the light distribution of an environment map.
    #[error("the environment's picture needs {0}; use a smaller one")]
    Environment(Shortage),
    /// A glass sphere is cut; caps are opaque.
    #[error(
        "a slice cuts sphere {0}, which is of glass, but flat caps are opaque; use the mode remove or hide, or another material"
    )]
    Glass(u32),
    /// A fitted camera without spheres.
    #[error(
        "the camera has nothing to frame: the scene has no spheres, or slices cut all of them away; give it spheres, or give the camera `eye` and `target`"
    )]
    NothingToFit,
    /// The camera is closer to its target than double precision resolves, or similar.
    #[error("the camera at {eye:?} sees nothing: {why}")]
    Camera {
        /// Position in the scene's coordinates.
        eye: [f64; 3],
        /// The reason, and how to fix it.
        why: &'static str,
    },
    /// A setting is out of range.
    #[error(transparent)]
    Setting(#[from] InvalidSetting),
    /// A row of a column is invalid; scenes from files are checked before.
    #[error("{0}")]
    Invalid(String),
}

impl World {
    /// Returns center and radius of a sphere in the user's coordinates, by its row in [`World::spheres`].
    ///
    /// # Panics
    /// There is no such row.
    pub fn sphere(&self, row: usize) -> (glam::DVec3, f64) {
        let (center, radius) = self.spheres.exact(row);
        (self.transform.user_point(center), radius / self.transform.scale)
    }

    /// Builds the world, with the tree builder that suits its settings.
    ///
    /// Spheres that vanish in single precision relative to the largest coordinate (a radius below about
    /// 1e-45 of it) are omitted; [`Features::vanished`] counts them.
    ///
    /// # Errors
    /// Too many spheres, or too many for the available memory; a camera that frames nothing,
    /// or rows that no scene file can contain: columns of different lengths, values that are not
    /// finite, materials that do not exist.
    pub fn build(scene: &Scene) -> Result<Self, WorldError> {
        let Settings { width, height, spp, .. } = scene.settings;
        let samples = u64::from(width) * u64::from(height) * u64::from(spp);
        Self::build_with(scene, Self::builder(scene.spheres.len(), samples))
    }

    /// Returns the tree builder that suits a render of this many spheres and samples, summed over all
    /// pixels.
    pub fn builder(spheres: usize, samples: u64) -> Builder {
        Builder::for_rays(spheres, samples.saturating_mul(RAYS_PER_SAMPLE))
    }

    /// Builds the world with a certain tree builder, which does not change the picture.
    ///
    /// # Errors
    /// Those of [`World::build`].
    pub fn build_with(scene: &Scene, builder: Builder) -> Result<Self, WorldError> {
        let (transform, placement) = check::place(scene, Self::bytes_for(scene))?;
        Self::assemble(scene, Cow::Borrowed(&scene.spheres), transform, placement, builder)
    }

    /// Builds the world of a scene whose spheres are not needed afterwards: their memory is freed
    /// during construction, which halves the peak.
    ///
    /// # Errors
    /// Those of [`World::build`]; after all except [`WorldError::Glass`] the scene still has its
    /// spheres.
    pub fn build_taking(scene: &mut Scene, builder: Builder) -> Result<Self, WorldError> {
        let (transform, placement) = check::place(scene, Self::additional_bytes(scene))?;
        let spheres = std::mem::take(&mut scene.spheres);
        Self::assemble(scene, Cow::Owned(spheres), transform, placement, builder)
    }

    /// Returns the peak bytes that [`World::build_taking`] allocates in addition to those of the scene.
    pub fn additional_bytes(scene: &Scene) -> u64 {
        let footprint = Footprint::of(scene);
        footprint.peak().saturating_sub(footprint.scene())
    }

    /// Returns the peak bytes that [`World::build_with`] allocates in addition to those of the scene.
    fn bytes_for(scene: &Scene) -> u64 {
        let footprint = Footprint::of(scene);
        let kept = footprint.scene();
        footprint.peak_keeping(kept).saturating_sub(kept)
    }

    /// Builds the world from transformed coordinates and placed camera.
    fn assemble(
        scene: &Scene,
        from: Cow<scene::Spheres>,
        transform: Transform,
        placement: Placement,
        builder: Builder,
    ) -> Result<Self, WorldError> {
        let parts = Parts::build(scene, from, transform, placement, builder)?;
        Ok(Self::complete(scene, parts))
    }

    /// Completes the spheres and their tree by all that follows from them and from the rest of the
    /// scene.
    pub fn complete(scene: &Scene, parts: Parts) -> Self {
        let Parts { transform, placement, spheres, bvh, mut appearance, camera_visible, omitted } =
            parts;
        let materials = Materials::build(&scene.materials);
        let mut scene_bodies = scene.body_rows();
        // Spheres may be in the world alone.
        scene_bodies.0[BodyKind::Sphere as usize] = 0;
        let others = OtherBodies::build(scene, &transform);
        let trees = others.trees(Tree { bvh: &bvh, spheres: &spheres });
        bodies::append_appearance(&mut appearance, trees, scene, &materials);
        let cut = Cut::build(&scene.slices, &transform);
        let camera = Camera::build(scene, &placement, &transform);
        let environment = Environment::build(&scene.environment, &scene.look);
        let ground =
            scene.ground.as_ref().map(|ground| Ground::build(ground, &transform, &materials));
        let emissive = EmissiveSpheres::find(&spheres, &cut, &appearance, &materials);
        let lights = Lights::build(scene, &transform, &spheres, emissive, &environment);
        let mut world = Self {
            transform,
            placement,
            spheres,
            appearance,
            bvh,
            others,
            scene_bodies,
            cut,
            camera_visible,
            coincident: Vec::new(),
            ground,
            materials,
            lights,
            caustic_casters: CausticCasters::default(),
            light_images: LightImages::default(),
            environment,
            camera,
            device_paths: None,
            features: Features::default(),
        };
        world.features = Features::census(&world, omitted);
        if world.features.translucent {
            world.coincident = world.spheres.later_of_equals();
        }
        world.caustic_casters = CausticCasters::find(&world);
        world.light_images = LightImages::find(&world);
        world
    }

    /// Returns whether slices hide or cut spheres, so that the processor traces all rays.
    pub fn is_sliced(&self) -> bool {
        self.camera_visible.is_some() || self.others.any_hidden() || !self.cut.is_empty()
    }

    /// Returns whether any body is translucent.
    fn has_translucent(&self) -> bool {
        if !self.materials.has_translucent() {
            return false;
        }
        let passes = |id: MaterialId| !self.materials.optical_depth(id).is_opaque();
        match &self.appearance.material {
            Column::Uniform(id) => passes(*id),
            Column::Rows(rows) => rows.iter().any(|&id| passes(id)),
        }
    }

    /// The optical depth of the body of a hit.
    #[inline(always)]
    pub(crate) fn optical_depth(&self, hit: u32) -> OpticalDepth {
        if self.coincident.binary_search(&hit).is_ok() {
            return OpticalDepth::NONE;
        }
        self.materials.optical_depth(self.material(hit))
    }

    /// Returns the same world without its spheres, and without the light of emissive spheres.
    pub fn without_spheres(&self) -> Self {
        let mut features = self.features.clone();
        features.glass_at_camera.clear();
        Self {
            transform: self.transform,
            placement: self.placement,
            spheres: Spheres::default(),
            appearance: Appearance::NONE,
            bvh: Bvh::default(),
            others: OtherBodies::default(),
            scene_bodies: BodyRows::default(),
            cut: Cut::default(),
            camera_visible: None,
            coincident: Vec::new(),
            ground: self.ground,
            materials: self.materials.clone(),
            lights: self.lights.without_spheres(&self.environment),
            caustic_casters: CausticCasters::default(),
            light_images: LightImages::default(),
            environment: self.environment.clone(),
            camera: self.camera,
            device_paths: None,
            features,
        }
    }

    /// Replaces the camera by that of `scene`, with its picture size; the rest of the scene must be as
    /// the world was built. Pictures are equal to the last bit to those of a world that is built anew,
    /// in a small fraction of the time.
    ///
    /// Returns false, and changes nothing, if the camera is so far away that the world must be built
    /// anew.
    ///
    /// # Errors
    /// The camera sees nothing, or has values out of range.
    pub fn set_camera(&mut self, scene: &Scene) -> Result<bool, WorldError> {
        check::check_view(scene)?;
        let pose = fit::pose(scene)?;
        if !self.transform.suits(&pose) {
            return Ok(false);
        }
        self.camera = Camera::build(scene, &pose, &self.transform);
        self.placement = pose;
        self.features = std::mem::take(&mut self.features).with_camera_of(self);
        self.light_images = LightImages::find(self);
        Ok(true)
    }

    /// Replaces the background that the camera sees; the light of the environment does not change.
    pub fn set_background(&mut self, background: Background) {
        self.environment.set_background(background);
        self.light_images = LightImages::find(self);
    }

    /// Returns whether paths sample the light that specular spheres pass on: caustics, or emitters that
    /// coats and glass mirror.
    pub fn samples_specular_light(&self) -> bool {
        let kinds = [MaterialKind::Dielectric, MaterialKind::Plastic, MaterialKind::Reflective];
        let mirrors = kinds.iter().any(|&kind| self.features.has(kind));
        !self.caustic_casters.is_empty() || (mirrors && self.lights.samples_mirrored_light())
    }

    /// Returns the number of what is hit: of spheres, after them of all other kinds ([`BodyKind::ALL`]), in the scene's order; other hits are
    /// unchanged.
    pub fn id_of(&self, hit: u32) -> u32 {
        let given = self.omitted();
        let spheres = self.spheres.len() as u64 + given.cut_away + given.vanished + given.hidden;
        let Some(body) = self.body(hit) else { return hit };
        let id = self.trees().id(body);
        if body.kind == BodyKind::Sphere {
            return id;
        }
        let before = BodyKind::ALL.into_iter().take_while(|&kind| kind < body.kind);
        let before: usize = before.map(|kind| self.scene_bodies.count(kind)).sum();
        spheres as u32 + before as u32 + id
    }

    /// Returns the outward normal of the surface of a hit at a point of it, or of a surface without inside that on the side of a direction;
    /// `None` for a miss.
    pub(crate) fn normal_at(
        &self,
        hit: u32,
        point: glam::Vec3,
        toward: glam::Vec3,
    ) -> Option<glam::Vec3> {
        match (hit, &self.ground) {
            (GROUND, Some(ground)) => Some(ground.normal.as_vec3()),
            (MISS | GROUND, _) => None,
            _ => {
                let body = self.body(hit)?;
                let other = self.trees().normal_at(body, point.as_dvec3(), toward.as_dvec3());
                let sphere = || (point - self.spheres.center(body.row)).normalize_or_zero();
                Some(other.map_or_else(sphere, glam::DVec3::as_vec3))
            }
        }
    }

    /// Returns the material at a hit: a row of the appearance or [`GROUND`].
    #[inline(always)]
    pub fn material(&self, hit: u32) -> MaterialId {
        match &self.ground {
            Some(ground) if hit == GROUND => ground.material,
            _ => self.appearance.material.row(hit as usize),
        }
    }

    /// Returns the factor on the material's color at a hit.
    #[inline(always)]
    pub fn color(&self, hit: u32) -> Rgb {
        match &self.appearance.color {
            Some(colors) if hit != GROUND => colors.row(hit as usize),
            _ => Rgb::ONE,
        }
    }

    /// Returns the characteristic color at a hit: [`Materials::albedo`] times the sphere's own color.
    pub fn albedo(&self, hit: u32) -> Rgb {
        self.materials.albedo(self.material(hit)) * self.color(hit)
    }
}
