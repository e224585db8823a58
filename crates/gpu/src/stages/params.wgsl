// What every kernel is given, and values through which nothing is fused or reordered.

struct Params {
    // 0, which no compiler knows.
    zero: u32,
    // Rays, or paths.
    count: u32,
    // Spheres in each column but the last, a multiple of 8; as a power of two.
    brick_bits: u32,
    nodes: u32,
    // The first of the samples of each pixel, and their number.
    first_sample: u32,
    samples: u32,
    // Index of the bounce, from 0.
    bounce: u32,
    // Shadow rays of each path at most: in rows `count` apart.
    shadows: u32,
    // The first of the shadow samples of a surface that come next, in Whitted ray tracing.
    first_shadow: u32,
    // 1 if paths have caustic samples.
    caustics: u32,
    // Words from the queue of a kind of material to that of the next.
    kind_stride: u32,
}

// Not a uniform buffer: drivers may compile kernels anew for its values, and then they know the 0.
@group(0) @binding(0) var<storage, read> params: Params;

// In place of a row.
const NO_ROW: u32 = 0xffffffffu;

// Words before the rows of a queue.
const QUEUE_HEAD: u32 = 5u;

const MISS: u32 = 0xffffffffu;
const GROUND: u32 = 0xfffffffeu;
const UNKNOWN: u32 = 0xfffffffdu;

// More than any distance.
const FAR: f32 = 0x1p100f;

// The same number, through which nothing is fused or reordered.
fn keep(x: f32) -> f32 {
    return bitcast<f32>(bitcast<u32>(x) ^ params.zero);
}

fn keep4(v: vec4<f32>) -> vec4<f32> {
    return bitcast<vec4<f32>>(bitcast<vec4<u32>>(v) ^ vec4<u32>(params.zero));
}

fn keep3(v: vec3<f32>) -> vec3<f32> {
    return bitcast<vec3<f32>>(bitcast<vec3<u32>>(v) ^ vec3<u32>(params.zero));
}
