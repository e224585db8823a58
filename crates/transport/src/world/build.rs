//! Construction of worlds from scenes, and from other worlds with parts replaced.

use super::lights::EmissiveSpheres;
use super::{
    Appearance, Camera, CausticCasters, Cut, Environment, Features, Ground, LightImages, Lights,
    OtherBodies, Parts, Placement, Transform, World, WorldError, bodies, check, fit,
};
use crate::body_rows::{BodyKind, BodyRows};
use crate::bvh::builders::Builder;
use crate::bvh::{Bvh, Tree};
use crate::scene::{self, Background, Footprint, Scene};
use crate::settings::Settings;
use crate::shade::Materials;
use crate::spheres::Spheres;
use std::borrow::Cow;

/// Approximate number of rays per sample, with bounces and shadow rays, for choosing the tree builder.
const RAYS_PER_SAMPLE: u64 = 4;

impl World {
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
}
