//! Random scenes after a recipe.
//!
//! Everything is laid out in double precision and then rounded to single: what is decided about is
//! the rounded numbers, which every form gets bit by bit.

use glam::{DVec3, Vec3};
use spherule_core::internals::random::Random;

/// Most spheres of a scene.
const MOST: usize = 8;

/// How far apart shells are, in radii.
const GAP: f64 = 4e-5;

/// How far from the top of a giant ball things stand on it.
const FIELD: f64 = 10.0;

/// How scenes and rays are made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    pub(super) arrangement: Arrangement,
    pub(super) origin: Origin,
    pub(super) aim: Aim,
    /// How far the scene is from the coordinates' origin, before it is scaled.
    pub(super) offset: f64,
    /// What everything is multiplied by.
    pub(super) scale: f64,
    /// Decades of the direction's length.
    pub(super) length: [f64; 2],
}

/// How spheres lie.
#[derive(Clone, Copy, Debug)]
pub(super) enum Arrangement {
    /// In a cube, overlapping.
    Cluster,
    /// In a cube, all numbers multiples of 1/16.
    Lattice,
    /// All touch the origin of coordinates, from either side of one plane.
    Pencil,
    /// Small ones on a giant of this radius.
    Ground(f64),
    /// Each touches the one before; every second time exactly.
    Chain,
    /// Concentric, close together.
    Shells,
    /// Some of them equal.
    Twins,
    /// Sizes and places of 12 decades.
    Decades,
}

/// Where rays start.
#[derive(Clone, Copy, Debug)]
pub(super) enum Origin {
    /// At this many radii from the center of the sphere aimed at, in decades.
    Away([f64; 2]),
    /// At the origin of coordinates.
    Zero,
    /// In the sphere aimed at.
    Inside,
    /// On its surface, as well as single precision can tell.
    Surface,
    /// Above the giant, in decades.
    Above([f64; 2]),
    /// On the giant, as well as single precision can tell.
    Ground,
    /// Somewhere, in decades of the distance from the origin of coordinates.
    Somewhere([f64; 2]),
}

/// Where rays go.
#[derive(Clone, Copy, Debug)]
pub(super) enum Aim {
    /// At a sphere: the line passes its center within 1.2 radii.
    Sphere,
    /// Past a sphere: the line is a tangent but for a part of the radius, in decades.
    Tangent([f64; 2]),
    /// Either of these.
    SphereOrTangent,
    /// Along an axis, a tangent exactly or one number beside it.
    AxisTangent,
    /// Through the origin of coordinates, but for a hair, in decades.
    Hair([f64; 2]),
    /// Away from a sphere.
    Away,
    /// Anywhere.
    Anywhere,
    /// At the contact of two spheres, or at a sphere.
    Contact,
}

/// Rows of x, y, z and radius after a recipe.
pub(super) fn scene(recipe: &Recipe, random: &mut Random) -> Vec<[f32; 4]> {
    let count = 1 + random.index(MOST);
    let spheres = match recipe.arrangement {
        Arrangement::Cluster => (0..count).map(|_| anywhere(random)).collect(),
        Arrangement::Lattice => (0..count).map(|_| on_lattice(random)).collect(),
        Arrangement::Pencil => pencil(count, random),
        Arrangement::Ground(radius) => ground(radius, count, random),
        Arrangement::Chain => chain(count, random),
        Arrangement::Shells => shells(count, random),
        Arrangement::Twins => twins(count, random),
        Arrangement::Decades => (0..count).map(|_| of_any_size(random)).collect(),
    };
    let offset = random.direction() * recipe.offset;
    let rounded = |(center, radius): (DVec3, f64)| {
        let center = (center + offset) * recipe.scale;
        [center.x as f32, center.y as f32, center.z as f32, (radius * recipe.scale) as f32]
    };
    spheres.into_iter().map(rounded).collect()
}

fn anywhere(random: &mut Random) -> (DVec3, f64) {
    (random.in_cube() * 2.0, random.between([0.2, 1.0]))
}

fn on_lattice(random: &mut Random) -> (DVec3, f64) {
    let center = (random.in_cube() * 32.0).round() / 16.0;
    (center, (1.0 + random.index(16) as f64) / 16.0)
}

/// The normals of pencils, and their lengths, all of them whole: so tangents are exact.
pub(super) const NORMALS: [(DVec3, f64); 2] = [(DVec3::Y, 1.0), (DVec3::new(2.0, 3.0, 6.0), 7.0)];

fn pencil(count: usize, random: &mut Random) -> Vec<(DVec3, f64)> {
    /// Few enough bits for seven times as much to fit single precision.
    const STEPS: f64 = (1 << 20) as f64;
    let (normal, length) = NORMALS[random.index(NORMALS.len())];
    let sphere = |_| {
        let part = (random.between([0.2, 1.0]) * STEPS).round() / STEPS;
        (normal * (random.sign() * part), length * part)
    };
    (0..count).map(sphere).collect()
}

/// A giant whose surface passes near the origin of coordinates, and small spheres that stand on it.
fn ground(radius: f64, count: usize, random: &mut Random) -> Vec<(DVec3, f64)> {
    // As it is once it is rounded, for the others to stand on.
    let center = (random.direction() * -radius).as_vec3().as_dvec3();
    let mut spheres = vec![(center, radius)];
    spheres.extend((1..count).map(|_| {
        let small = random.decades([-2.0, 0.0]);
        (center + above(center, random) * (radius + small), small)
    }));
    spheres
}

/// The direction from a giant's center to a place near the origin of coordinates.
pub(super) fn above(center: DVec3, random: &mut Random) -> DVec3 {
    (random.in_cube() * FIELD - center).normalize()
}

fn chain(count: usize, random: &mut Random) -> Vec<(DVec3, f64)> {
    let exact = random.coin();
    let mut spheres = vec![if exact { on_lattice(random) } else { anywhere(random) }];
    while let Some(&(center, radius)) = spheres.last()
        && spheres.len() < count
    {
        let (_, next) = if exact { on_lattice(random) } else { anywhere(random) };
        let direction = if exact { axis(random) } else { random.direction() };
        spheres.push((center + direction * (radius + next), next));
    }
    spheres
}

fn shells(count: usize, random: &mut Random) -> Vec<(DVec3, f64)> {
    let (center, radius) = anywhere(random);
    (0..count).map(|i| (center, radius * (1.0 + GAP * i as f64))).collect()
}

fn twins(count: usize, random: &mut Random) -> Vec<(DVec3, f64)> {
    let mut spheres = vec![anywhere(random)];
    while spheres.len() < count {
        let twin = spheres[random.index(spheres.len())];
        spheres.push(if random.coin() { twin } else { anywhere(random) });
    }
    spheres
}

fn of_any_size(random: &mut Random) -> (DVec3, f64) {
    (random.direction() * random.decades([-6.0, 6.0]), random.decades([-6.0, 6.0]))
}

pub(super) fn axis(random: &mut Random) -> DVec3 {
    DVec3::AXES[random.index(3)] * random.sign()
}

/// Center and radius.
pub(super) fn parts([x, y, z, radius]: [f32; 4]) -> (DVec3, f64) {
    (Vec3::new(x, y, z).as_dvec3(), f64::from(radius))
}
