//! Tables of a job for devices: its lights, caustics and sky as numbers.

use crate::image::Image;
use crate::sampling::Basis;
use crate::scene::Rgb;
use std::sync::Arc;

/// Most levels of the tree of specular spheres.
pub(crate) const MAX_CASTER_LEVELS: usize = 16;

/// The integrator of a job, as far as devices have it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceIntegration {
    /// Ambient occlusion, with a distance in the world's unit.
    Occlusion {
        /// Distance beyond which nothing occludes.
        distance: f64,
    },
    /// Whitted ray tracing.
    Whitted {
        /// Maximum number of bounces.
        depth: u32,
        /// Russian roulette.
        roulette: DeviceRoulette,
        /// Shadow samples of each light that has extent, and of the sky.
        shadow_samples: u32,
        /// True if the sky is sampled, beside the lights.
        sky: bool,
    },
    /// Paths.
    Paths {
        /// Maximum number of bounces.
        depth: u32,
        /// Russian roulette.
        roulette: DeviceRoulette,
        /// True if suns and emissive spheres are sampled where smooth surfaces mirror them.
        mirrored_light: bool,
    },
}

/// Russian roulette.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeviceRoulette {
    /// None.
    None,
    /// From some bounce on, of paths with a throughput below this.
    ByThroughput(f32),
    /// Paths survive each bounce with this probability.
    Fixed(f32),
}

/// The lights that paths sample: emissive spheres, points, suns and parts of a picture of the sky, which are numbered in this
/// order.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DeviceLights {
    /// Rows and radiance of the emissive spheres.
    pub emitters: Vec<(u32, Rgb)>,
    /// The points.
    pub points: Vec<DevicePoint>,
    /// The suns.
    pub suns: Vec<DeviceSun>,
    /// Number of parts of the sky's picture that are sampled.
    pub sky_parts: usize,
    /// The choice of one of them.
    pub choice: DeviceLightChoice,
    /// Distance from its center, in radii, within which an emissive sphere is close.
    pub reach: f64,
}

/// The choice of a light.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum DeviceLightChoice {
    /// None is luminous.
    #[default]
    None,
    /// There is only one.
    Single,
    /// By the light tree.
    Tree(DeviceLightTree),
    /// By cumulative probabilities, from 0 to 1: one more than lights.
    Table(Vec<f32>),
}

/// The light tree.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceLightTree {
    /// The nodes; the children of each are neighbors, and those of the root the first.
    pub nodes: Vec<DeviceLightNode>,
    /// Number of the root's children.
    pub top: u32,
    /// The leaf of each light; [`u32::MAX`] for one that is not luminous.
    pub leaf: Vec<u32>,
}

/// A node of the light tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceLightNode {
    /// Center of its bounds.
    pub center: glam::Vec3,
    /// Their radius, negative if light samples find nothing inside.
    pub radius: f32,
    /// Irradiance on a plane that faces the light, times the squared distance.
    pub power: f32,
    /// Irradiance of light without falloff.
    pub steady: f32,
    /// First child; the light of a leaf.
    pub child: u32,
    /// Number of children, at most 16; 0 for a leaf.
    pub children: u32,
    /// Parent; [`u32::MAX`] for children of the root.
    pub parent: u32,
}

/// A point light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DevicePoint {
    /// Its place.
    pub position: glam::DVec3,
    /// Radiant intensity; irradiance if there is no falloff.
    pub intensity: Rgb,
    /// Scale of the distance in the falloff; 0 if there is none.
    pub falloff: f64,
}

/// A sun.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceSun {
    /// The basis about its direction.
    pub basis: Basis,
    /// 1 - cos of its angular radius, and the density of directions toward it; `None` if it has no extent.
    pub disc: Option<[f32; 2]>,
    /// Radiance of the disc.
    pub radiance: Rgb,
    /// Weight of a light sample.
    pub weight: Rgb,
}

/// The smooth specular spheres that pass on the light of emissive spheres and suns, and these emitters.
#[derive(Clone, Debug, Default)]
pub struct DeviceCaustics {
    /// True if paths sample caustics.
    pub sampled: bool,
    /// The specular spheres.
    pub casters: Vec<DeviceCaster>,
    /// Their tree; the children of each node are neighbors, and those of the root the first.
    pub nodes: Vec<DeviceCasterNode>,
    /// Number of the root's children.
    pub top: u32,
    /// Emissive spheres, in the order of [`DeviceLights`], and then suns with discs.
    pub emitters: Vec<DeviceEmitter>,
    /// The choice of one of them, by the light that reaches a point from any side.
    pub choice: DeviceLightChoice,
    /// Lower corner of a grid of bounds of the number of samples, the reciprocal of a cell's edge, and the number of cells.
    pub low: glam::Vec3,
    /// See `low`.
    pub cells_per_length: f32,
    /// See `low`.
    pub cells: glam::UVec3,
    /// Bounds of each cell, along x first, for the normals +x, +y, +z, -x, -y and -z.
    pub bounds: Vec<[f32; 6]>,
}

/// A smooth specular sphere.
#[derive(Clone, Copy, Debug)]
pub struct DeviceCaster {
    /// Its row.
    pub sphere: u32,
    /// Index of refraction outside over that inside; 0 for a mirror.
    pub index: f64,
    /// Its leaf; [`u32::MAX`] if it has none.
    pub leaf: u32,
}

/// A node of the tree of specular spheres: one of them, or a cluster.
#[derive(Clone, Copy, Debug)]
pub struct DeviceCasterNode {
    /// Center of its bounds.
    pub center: glam::Vec3,
    /// Distance from it within which the spheres' centers are.
    pub extent: f32,
    /// Mean radius.
    pub radius: f32,
    /// Mean index of refraction outside over that inside.
    pub index: f32,
    /// Sums of squared radii times reflectance at normal incidence, and times its rise toward grazing angles.
    pub reflected: f32,
    /// See `reflected`.
    pub rise: f32,
    /// Sum of squared radii of glass.
    pub transmitted: f32,
    /// Row of the sphere of a leaf; [`u32::MAX`] for others.
    pub sphere: u32,
    /// First child; the number of a leaf's sphere.
    pub child: u32,
    /// Number of children; 0 for a leaf.
    pub children: u32,
    /// Parent; [`u32::MAX`] for children of the root.
    pub parent: u32,
}

/// An emissive sphere or a sun whose caustics are sampled.
#[derive(Clone, Copy, Debug)]
pub struct DeviceEmitter {
    /// Center of a sphere; that of a sun is far away.
    pub center: glam::DVec3,
    /// Its radius.
    pub radius: f64,
    /// Center, or direction toward a sun, for estimates.
    pub place: glam::Vec3,
    /// Squared radius, that of a sun angular, for estimates.
    pub radius2: f32,
    /// Radiance.
    pub radiance: Rgb,
    /// Row of the sphere; number of the sun.
    pub source: u32,
}

/// Radiance of the sky: `middle`, plus `slope` times the cosine of the angle to `up`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DeviceSky {
    /// The mean.
    pub middle: Rgb,
    /// Half of the difference between top and bottom, and the direction; `None` if the sky is even.
    pub gradient: Option<(Rgb, glam::Vec3)>,
    /// Radiance that the camera sees in its place.
    pub background: Option<Rgb>,
    /// True if it lights diffuse surfaces.
    pub illuminates: bool,
}

/// A picture of the sky, by longitude and latitude.
#[derive(Clone, Debug)]
pub struct DevicePicture {
    /// The radiance of its pixels, before it is scaled.
    pub image: Arc<Image>,
    /// Factor on the radiance.
    pub scale: f32,
    /// Its axes.
    pub axes: Basis,
    /// Rows of patches between pixel centers: the sines at the ends of each, and the reciprocal of a patch's area.
    pub rows: Vec<[f32; 3]>,
    /// The parts that are lights of their own.
    pub parts: Vec<DeviceSkyPart>,
}

/// A part of a picture of the sky: a rectangle of patches, which may wrap around.
#[derive(Clone, Debug)]
pub struct DeviceSkyPart {
    /// The first column and row, width and height.
    pub region: [u32; 4],
    /// Cumulative probabilities of its rows, and of the patches in each.
    pub rows: Vec<f32>,
    /// See `rows`.
    pub columns: Vec<Vec<f32>>,
}
