//! The world: a scene as kernels read it, in columns and tables, and a census of its features.
//!
//! [`World::build`] moves a [`Scene`](crate::Scene) to the origin by a multiple of a power of two, scales it by an
//! exact power of two so that its largest coordinate is about 1 ([`Transform`]), stores it in single
//! precision, builds the tree and permutes the spheres' columns so that a leaf is a contiguous range.
//! All errors of a scene are found here or before; rendering cannot fail.

mod appearance;
mod bodies;
mod build;
mod camera;
mod camera_visible;
mod caustics;
mod census;
mod check;
mod cut;
mod device;
mod device_tables;
mod environment;
mod error;
mod features;
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
pub use cut::{Cut, Span};
pub use device::{DeviceIntegrator, DeviceJob, DevicePath, DevicePaths, DevicePixel, DevicePixels};
pub use device_tables::{
    DeviceCaster, DeviceCasterNode, DeviceCaustics, DeviceEmitter, DeviceIntegration,
    DeviceLightChoice, DeviceLightNode, DeviceLightTree, DeviceLights, DevicePicture, DevicePoint,
    DeviceRoulette, DeviceSky, DeviceSkyPart, DeviceSun,
};
pub use environment::{
    Environment, Irradiance, PartBounds, Picture, Radiance, SkyLight, SkySamples,
};
pub use error::WorldError;
pub use features::Features;
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

use crate::bodies::BodyTrees;
use crate::body_rows::{BodyKind, BodyRow, BodyRows};
use crate::bvh::{Bvh, Tree};
use crate::ray::{GROUND, MISS};
use crate::scene::Rgb;
use crate::shade::{MaterialId, MaterialKind, Materials};
use crate::spheres::Spheres;
use crate::translucency::OpticalDepth;
use std::sync::Arc;

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

impl World {
    /// Returns center and radius of a sphere in the user's coordinates, by its row in [`World::spheres`].
    ///
    /// # Panics
    /// There is no such row.
    pub fn sphere(&self, row: usize) -> (glam::DVec3, f64) {
        let (center, radius) = self.spheres.exact(row);
        (self.transform.user_point(center), radius / self.transform.scale)
    }

    /// Returns all bodies.
    #[inline(always)]
    pub fn trees(&self) -> BodyTrees<'_> {
        self.others.trees(Tree { bvh: &self.bvh, spheres: &self.spheres })
    }

    /// Returns the bodies that the camera sees.
    pub(crate) fn visible_trees(&self) -> BodyTrees<'_> {
        let visible = self.camera_visible.as_ref();
        let (bvh, spheres) =
            visible.map_or((&self.bvh, &self.spheres), |visible| (&visible.bvh, &visible.spheres));
        self.others.seen(Tree { bvh, spheres })
    }

    /// Returns the row among all bodies of a row of [`World::visible_trees`].
    pub(crate) fn row_of_visible(&self, body: BodyRow) -> BodyRow {
        let rows = match body.kind {
            BodyKind::Sphere => self.camera_visible.as_ref().map(|visible| &*visible.row),
            kind => self.others.rows_of_seen(kind),
        };
        BodyRow { row: rows.map_or(body.row, |rows| rows[body.row] as usize), ..body }
    }

    /// Returns the numbers of hits on bodies.
    #[inline(always)]
    pub(crate) fn body_rows(&self) -> BodyRows {
        self.trees().rows()
    }

    /// Returns the number of hits on bodies, of which each half of a stick is one.
    pub fn body_count(&self) -> usize {
        self.body_rows().all_hits()
    }

    /// Returns whether there are bodies other than spheres.
    #[inline(always)]
    pub fn has_other_bodies(&self) -> bool {
        self.trees().other_kinds().next().is_some()
    }

    /// Returns the body of a hit; `None` for the ground, and for none.
    #[inline(always)]
    pub fn body(&self, hit: u32) -> Option<BodyRow> {
        self.body_rows().row(hit)
    }

    /// Returns how many bodies of a kind have each kind of material, in the order of [`MaterialKind::ALL`].
    pub(super) fn count_materials(&self, kind: BodyKind) -> [u64; MaterialKind::COUNT] {
        let (rows, mut counts) = (self.body_rows(), [0; MaterialKind::COUNT]);
        for hit in (rows.first(kind)..).step_by(kind.hits()).take(rows.count(kind)) {
            counts[self.appearance.material.row(hit).kind() as usize] += 1;
        }
        counts
    }

    /// Returns the numbers of spheres of its scene that are not in the world.
    pub fn omitted(&self) -> OmittedSpheres {
        let features = &self.features;
        OmittedSpheres {
            cut_away: features.cut_away,
            vanished: features.vanished,
            hidden: features.hidden,
        }
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
