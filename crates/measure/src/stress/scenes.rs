//! Random scenes by a recipe.
//!
//! Scenes are generated in double precision and then rounded to single. All tests get the same rounded
//! numbers.

use glam::{DVec3, Vec3};
use spherule_core::internals::random::Random;

/// Maximum number of spheres of a scene.
const MAX_SPHERES: usize = 8;

/// Distance of shells in radii.
const GAP: f64 = 4e-5;

/// Extent of the region around the top of a large sphere in which spheres stand on it.
const FIELD: f64 = 10.0;

/// The least positive number of single precision.
pub(super) const LEAST: f64 = f32::from_bits(1) as f64;

/// Parameters of random scenes and rays.
#[derive(Clone, Copy, Debug)]
pub(super) struct Recipe {
    pub(super) arrangement: Arrangement,
    pub(super) origin: Origin,
    pub(super) aim: Aim,
    /// Distance of the scene from the origin of coordinates, before scaling.
    pub(super) offset: f64,
    /// Scale factor of all lengths.
    pub(super) scale: f64,
    /// Range of the direction's length in decades.
    pub(super) length: [f64; 2],
}

/// Arrangement of spheres.
#[derive(Clone, Copy, Debug)]
pub(super) enum Arrangement {
    /// In a cube, overlapping.
    Cluster,
    /// In a cube, all numbers multiples of 1/16.
    Lattice,
    /// All touching the origin of coordinates, from either side of a plane.
    Pencil,
    /// Small spheres on one of this radius.
    Ground(f64),
    /// Each touching the previous one; exactly in half of the scenes.
    Chain,
    /// Concentric, close together.
    Shells,
    /// Some of them equal.
    Twins,
    /// Radii and positions over a range of decades.
    Decades([f64; 2]),
    /// A sphere of 1e38, and spheres whose centers and radii are small multiples of [`LEAST`].
    Ends,
}

/// Distribution of ray origins.
#[derive(Clone, Copy, Debug)]
pub(super) enum Origin {
    /// At a range of radii, in decades, from the center of the target sphere.
    Away([f64; 2]),
    /// At the origin of coordinates.
    Zero,
    /// Inside the target sphere.
    Inside,
    /// On the surface of the target sphere, up to rounding.
    Surface,
    /// Above the large sphere, at a range of heights in decades.
    Above([f64; 2]),
    /// On the large sphere, up to rounding.
    Ground,
    /// At a range of distances, in decades, from the origin of coordinates.
    Somewhere([f64; 2]),
}

/// Distribution of ray directions.
#[derive(Clone, Copy, Debug)]
pub(super) enum Aim {
    /// Toward a sphere: the line passes its center within 1.2 radii.
    Sphere,
    /// Nearly tangent to a sphere, off by a fraction of the radius in a range of decades.
    Tangent([f64; 2]),
    /// Toward a sphere or nearly tangent.
    SphereOrTangent,
    /// Along an axis, tangent exactly or up to one unit in the last place.
    AxisTangent,
    /// Nearly through the origin of coordinates, off by a range of decades.
    NearOrigin([f64; 2]),
    /// Away from a sphere.
    Away,
    /// Uniformly distributed.
    Anywhere,
    /// Toward the contact of two spheres, or toward a sphere.
    Contact,
    /// Tangent to a sphere of [`Arrangement::Ends`], exactly or off by [`LEAST`], or toward it.
    Ends,
}

/// Returns a random scene by a recipe, as rows of x, y, z and radius.
pub(super) fn scene(recipe: &Recipe, random: &mut Random) -> Vec<[f32; 4]> {
    let count = 1 + random.index(MAX_SPHERES);
    let spheres = match recipe.arrangement {
        Arrangement::Cluster => (0..count).map(|_| anywhere(random)).collect(),
        Arrangement::Lattice => (0..count).map(|_| on_lattice(random)).collect(),
        Arrangement::Pencil => pencil(count, random),
        Arrangement::Ground(radius) => ground(radius, count, random),
        Arrangement::Chain => chain(count, random),
        Arrangement::Shells => shells(count, random),
        Arrangement::Twins => twins(count, random),
        Arrangement::Decades(range) => (0..count).map(|_| of_any_size(range, random)).collect(),
        Arrangement::Ends => ends(count.max(2), random),
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

/// Normals of pencils and their lengths. All are integers, so that tangents are exact.
pub(super) const NORMALS: [(DVec3, f64); 2] = [(DVec3::Y, 1.0), (DVec3::new(2.0, 3.0, 6.0), 7.0)];

fn pencil(count: usize, random: &mut Random) -> Vec<(DVec3, f64)> {
    /// Few enough bits that seven times as much is exact in single precision.
    const STEPS: f64 = (1 << 20) as f64;
    let (normal, length) = NORMALS[random.index(NORMALS.len())];
    let sphere = |_| {
        let fraction = (random.between([0.2, 1.0]) * STEPS).round() / STEPS;
        (normal * (random.sign() * fraction), length * fraction)
    };
    (0..count).map(sphere).collect()
}

/// Returns a large sphere whose surface passes near the origin of coordinates, and small spheres on it.
fn ground(radius: f64, count: usize, random: &mut Random) -> Vec<(DVec3, f64)> {
    // Rounded, so that the other spheres stand on the final one.
    let center = (random.direction() * -radius).as_vec3().as_dvec3();
    let mut spheres = vec![(center, radius)];
    spheres.extend((1..count).map(|_| {
        let small = random.decades([-2.0, 0.0]);
        (center + above(center, random) * (radius + small), small)
    }));
    spheres
}

/// Returns the direction from a large sphere's center to a point near the origin of coordinates.
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

fn of_any_size(range: [f64; 2], random: &mut Random) -> (DVec3, f64) {
    (random.direction() * random.decades(range), random.decades(range))
}

/// Directions, normals to them of the same length, and that length. All are integers, so that tangents to spheres
/// whose radius is a multiple of the length are exact.
pub(super) const TANGENTS: [(DVec3, DVec3, f64); 3] = [
    (DVec3::new(2.0, 6.0, -3.0), DVec3::new(6.0, -3.0, -2.0), 7.0),
    (DVec3::new(3.0, 4.0, 0.0), DVec3::new(-4.0, 3.0, 0.0), 5.0),
    (DVec3::Z, DVec3::X, 1.0),
];

fn ends(count: usize, random: &mut Random) -> Vec<(DVec3, f64)> {
    let mut spheres = vec![(random.direction() * 1e38, 1e38 * random.between([0.5, 2.0]))];
    while spheres.len() < count {
        let (_, _, length) = TANGENTS[random.index(TANGENTS.len())];
        let radius = length * (1.0 + random.index(3) as f64);
        spheres.push(((random.in_cube() * 300.0).round() * LEAST, radius * LEAST));
    }
    spheres
}

pub(super) fn axis(random: &mut Random) -> DVec3 {
    DVec3::AXES[random.index(3)] * random.sign()
}

/// Returns center and radius.
pub(super) fn center_and_radius([x, y, z, radius]: [f32; 4]) -> (DVec3, f64) {
    (Vec3::new(x, y, z).as_dvec3(), f64::from(radius))
}
