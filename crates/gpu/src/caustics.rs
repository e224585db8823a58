//! Specular spheres and emitters of caustics, as `casters.wgsl` has them.

use crate::lights::{self, halves};
use crate::materials::words;
use spherule_render::world::{
    DeviceCaster, DeviceCasterNode, DeviceCaustics, DeviceEmitter, DeviceLightChoice,
};

/// Rows that say where the others begin.
const HEAD: usize = 5;

/// Appends the rows of the specular spheres and emitters to those of lights; returns the first.
pub(crate) fn append(rows: &mut Vec<[u32; 4]>, caustics: &DeviceCaustics) -> u32 {
    let first = rows.len();
    rows.extend([[0; 4]; HEAD]);
    let start = |rows: &mut Vec<[u32; 4]>, more: Vec<[u32; 4]>| {
        let start = rows.len() as u32;
        rows.extend(more);
        start
    };
    let mut found: Vec<[u32; 4]> = caustics
        .casters
        .iter()
        .zip(0..)
        .map(|(caster, number)| [caster.sphere, number, 0, 0])
        .collect();
    found.sort_unstable();
    let found = start(rows, found);
    let casters = start(rows, caustics.casters.iter().map(caster).collect());
    let emitters = start(rows, caustics.emitters.iter().flat_map(emitter).collect());
    let nodes = start(rows, caustics.nodes.iter().flat_map(node).collect());
    let (tree, top, leaves) = match &caustics.choice {
        DeviceLightChoice::Tree(tree) => {
            (tree.nodes.iter().flat_map(lights::node).collect(), tree.top, tree.leaf.clone())
        }
        _ => Default::default(),
    };
    let has_tree = u32::from(top > 0);
    let tree = start(rows, tree);
    let leaves = start(rows, words(&leaves).collect());
    let bounds: Vec<u32> = caustics.bounds.iter().flatten().copied().map(f32::to_bits).collect();
    let bounds = start(rows, words(&bounds).collect());
    let [x, y, z] = caustics.low.to_array().map(f32::to_bits);
    let [columns, depth, height] = caustics.cells.to_array();
    rows[first..first + HEAD].copy_from_slice(&[
        [caustics.casters.len() as u32, found, casters, emitters],
        [nodes, caustics.top, tree, top],
        [leaves, bounds, has_tree, 0],
        [x, y, z, caustics.cells_per_length.to_bits()],
        [columns, depth, height, 0],
    ]);
    first as u32
}

fn caster(caster: &DeviceCaster) -> [u32; 4] {
    let [low, high] = halves(caster.index);
    [low, high, caster.sphere, caster.leaf]
}

fn emitter(emitter: &DeviceEmitter) -> [[u32; 4]; 4] {
    let [x, y, z] = emitter.center.to_array().map(halves);
    let radius = halves(emitter.radius);
    let row = |v: [f32; 3], w: u32| [v[0].to_bits(), v[1].to_bits(), v[2].to_bits(), w];
    [
        [x[0], x[1], y[0], y[1]],
        [z[0], z[1], radius[0], radius[1]],
        row(emitter.place.to_array(), emitter.radius2.to_bits()),
        row(emitter.radiance.to_array(), emitter.source),
    ]
}

fn node(node: &DeviceCasterNode) -> [[u32; 4]; 3] {
    let [x, y, z] = node.center.to_array().map(f32::to_bits);
    let family = lights::family(node.parent, node.children);
    [
        [x, y, z, node.extent.to_bits()],
        [node.radius, node.index, node.reflected, node.rise].map(f32::to_bits),
        [node.transmitted.to_bits(), node.sphere, node.child, family],
    ]
}
