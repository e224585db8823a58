// What is the same for all paths of a render: camera, ground, environment and settings.

struct Job {
    // Of `world/camera.rs`.
    eye: array<f64, 3>,
    right: array<f64, 3>,
    up: array<f64, 3>,
    forward: array<f64, 3>,
    size: array<f64, 2>,
    half_size: array<f64, 2>,
    lens_radius: f64,
    focus: f64,
    near: f64,
    // Of `world/ground.rs`.
    ground_normal: array<f64, 3>,
    ground_height: f64,
    // Distance beyond which nothing occludes.
    distance: f64,
    // Distance from its center, in radii, within which an emissive sphere is close.
    reach: f64,
    // Hash of the seed, lower half first.
    seed: array<u32, 2>,
    flags: u32,
    // The number of bounces after which paths are cut.
    depth: u32,
    // Row of the ground's material.
    ground_material: u32,
    // Number of spheres.
    spheres: u32,
    // Radiance of the environment: its mean, half of its difference, and the direction in which it increases.
    middle: array<f32, 3>,
    slope: array<f32, 3>,
    toward: array<f32, 3>,
    // What the camera sees in its place.
    background: array<f32, 3>,
    // Throughput below which roulette may end paths, and the probability with which they survive if it is fixed.
    threshold: f32,
    survival: f32,
    // Numbers of emissive spheres, of points, of suns, and of parts of the sky's picture.
    emitters: u32,
    points: u32,
    suns: u32,
    sky_parts: u32,
    // Where their rows begin, those of the light tree, and those of its leaves or of a table.
    found_rows: u32,
    point_rows: u32,
    sun_rows: u32,
    node_rows: u32,
    last_rows: u32,
    // Number of the children of the light tree's root.
    top: u32,
    // Where the rows of specular spheres and their emitters begin.
    caster_rows: u32,
    // Glass spheres in which camera rays may start, and where their rows are.
    camera_glass: u32,
    camera_glass_rows: u32,
    // Whitted ray tracing: samples of each light with extent, and of all lights and the sky.
    shadow_samples: u32,
    all_shadows: u32,
}

// Bits of the flags.
const ORTHOGRAPHIC: u32 = 1u;
const LENS: u32 = 2u;
const HAS_GROUND: u32 = 4u;
const FILTER_TABLE: u32 = 8u;
const BACKGROUND: u32 = 16u;
const GRADIENT: u32 = 32u;
const ILLUMINATES: u32 = 64u;
const ROULETTE_BY_THROUGHPUT: u32 = 128u;
const ROULETTE_FIXED: u32 = 256u;
const LIGHTS: u32 = 512u;
const MIRRORED_LIGHT: u32 = 1024u;
const LIGHT_TREE: u32 = 2048u;
const LIGHT_TABLE: u32 = 4096u;
const NESTED_GLASS: u32 = 8192u;
const PICTURE: u32 = 16384u;

fn has(flag: u32) -> bool {
    return (job.flags & flag) != 0u;
}

fn vector64(v: array<f64, 3>) -> vec3<f64> {
    return vec3<f64>(v[0], v[1], v[2]);
}

fn vector32(v: array<f32, 3>) -> vec3<f32> {
    return vec3<f32>(v[0], v[1], v[2]);
}
