//! Lights, as `lights.wgsl` has them.

use crate::caustics;
use crate::materials::words;
use bytemuck::{Pod, Zeroable};
use spherule_render::world::{
    DeviceJob, DeviceLightChoice, DeviceLightNode, DeviceLights, DevicePoint, DeviceSun,
};

/// A distance in radii that stands for an infinite one.
const FAR_REACH: f64 = 1e100;

/// Bits of a node's last word with its number of children; the others have its parent.
const CHILDREN_BITS: u32 = 5;

/// Numbers of lights, and where their rows begin.
#[repr(C)]
#[derive(Clone, Copy, Default, Pod, Zeroable)]
pub(crate) struct LightUniforms {
    emitters: u32,
    points: u32,
    suns: u32,
    sky_parts: u32,
    found_rows: u32,
    point_rows: u32,
    sun_rows: u32,
    node_rows: u32,
    /// The leaves of the tree, or the table.
    last_rows: u32,
    /// Number of the root's children.
    top: u32,
    /// Specular spheres and the emitters of caustics.
    caster_rows: u32,
    /// Glass spheres in which camera rays may start.
    camera_glass: u32,
    camera_glass_rows: u32,
}

/// Returns the rows of all lights of a job, of four words each, and of what comes after them; and their numbers.
pub(crate) fn rows(job: &DeviceJob) -> (Vec<[u32; 4]>, LightUniforms) {
    let lights = &job.lights;
    let mut rows: Vec<[u32; 4]> = lights
        .emitters
        .iter()
        .map(|&(sphere, radiance)| {
            let [r, g, b] = radiance.to_array().map(f32::to_bits);
            [r, g, b, sphere]
        })
        .collect();
    let mut numbers = LightUniforms {
        emitters: lights.emitters.len() as u32,
        points: lights.points.len() as u32,
        suns: lights.suns.len() as u32,
        sky_parts: lights.sky_parts as u32,
        ..LightUniforms::default()
    };
    numbers.found_rows = rows.len() as u32;
    let mut found: Vec<[u32; 4]> = lights
        .emitters
        .iter()
        .zip(0..)
        .map(|(&(sphere, _), index)| [sphere, index, 0, 0])
        .collect();
    found.sort_unstable();
    rows.extend(found);
    numbers.point_rows = rows.len() as u32;
    rows.extend(lights.points.iter().flat_map(point));
    numbers.sun_rows = rows.len() as u32;
    rows.extend(lights.suns.iter().flat_map(sun));
    numbers.node_rows = rows.len() as u32;
    let last: Vec<u32> = match &lights.choice {
        DeviceLightChoice::None | DeviceLightChoice::Single => Vec::new(),
        DeviceLightChoice::Tree(tree) => {
            rows.extend(tree.nodes.iter().flat_map(node));
            numbers.top = tree.top;
            tree.leaf.clone()
        }
        DeviceLightChoice::Table(cumulative) => {
            cumulative.iter().copied().map(f32::to_bits).collect()
        }
    };
    numbers.last_rows = rows.len() as u32;
    rows.extend(words(&last));
    numbers.caster_rows = caustics::append(&mut rows, &job.caustics);
    let around = &job.world.features.glass_at_camera;
    numbers.camera_glass = around.len() as u32;
    numbers.camera_glass_rows = rows.len() as u32;
    rows.extend(words(around));
    (rows, numbers)
}

/// Returns the distance from its center, in radii, within which an emissive sphere is close.
pub(crate) fn reach(lights: &DeviceLights) -> f64 {
    lights.reach.min(FAR_REACH)
}

/// Returns a number as two words.
pub(crate) fn halves(x: f64) -> [u32; 2] {
    [x.to_bits() as u32, (x.to_bits() >> 32) as u32]
}

fn point(point: &DevicePoint) -> [[u32; 4]; 3] {
    let [x, y, z] = point.position.to_array().map(halves);
    let [scale, more] = halves(point.falloff);
    let [r, g, b] = point.intensity.to_array().map(f32::to_bits);
    [[x[0], x[1], y[0], y[1]], [z[0], z[1], scale, more], [r, g, b, 0]]
}

fn sun(sun: &DeviceSun) -> [[u32; 4]; 5] {
    // Without extent, the disc is in no direction.
    let [height, pdf] = sun.disc.unwrap_or([-1.0, 0.0]);
    let row = |v: [f32; 3], w: f32| [v[0], v[1], v[2], w].map(f32::to_bits);
    [
        row(sun.basis.tangent.to_array(), height),
        row(sun.basis.bitangent.to_array(), pdf),
        row(sun.basis.normal.to_array(), 0.0),
        row(sun.radiance.to_array(), 0.0),
        row(sun.weight.to_array(), 0.0),
    ]
}

/// Returns the last word of a node.
pub(crate) fn family(parent: u32, children: u32) -> u32 {
    parent << CHILDREN_BITS | children
}

/// Returns the rows of a node of a tree of lights.
pub(crate) fn node(node: &DeviceLightNode) -> [[u32; 4]; 2] {
    let [x, y, z] = node.center.to_array().map(f32::to_bits);
    let family = family(node.parent, node.children);
    [
        [x, y, z, node.radius.to_bits()],
        [node.power.to_bits(), node.steady.to_bits(), node.child, family],
    ]
}
