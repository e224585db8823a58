// What each ray hits first, or whether it hits anything: certainly a sphere, certainly nothing, or unknown.
//
// Reads beside `bvh/one_ray.rs`, `slabs.rs` and `conservative.rs` of spherule-core. The bounds are not theirs: they are
// derived in docs/gpu.md for what WGSL promises of f32, and hold however sums are ordered and products are fused
// between two values that pass `keep`.

// Each node in six rows: the lower corner of its box, with the exponents of its grid's steps and the slots that have a
// child in four bytes; by axis, the lower and then the upper planes of eight children in steps of the grid, a byte each;
// and eight children. `nodes.rs` makes them.
@group(0) @binding(1) var<storage, read> nodes: array<vec4<u32>>;
// Columns of spheres.
@group(0) @binding(2) var<storage, read> spheres_0: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> spheres_1: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> spheres_2: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> spheres_3: array<vec4<u32>>;
// Each ray in three rows: origin, direction, own sphere, target, and the bounds of the distance where its search ends.
@group(0) @binding(6) var<storage, read> rays: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read_write> found: array<u32>;

// True if any hit ends the search.
override ANY: bool = false;
// True to search for the rays of which the answer is not known yet.
override AGAIN: bool = false;
// True to answer with the numbers of nodes and, from bit 16 on, leaves that the search visits. For measurements.
override COUNT: bool = false;

const NODE_ROWS: u32 = 6u;
const CHILD_ROW: u32 = 4u;
const LEAF: u32 = 0x40000000u;
const NO_CHILD: u32 = 0x80000000u;
const DEPTH: u32 = 24u;
// The bit of a radius where there is no sphere, or an equal one before it.
const NEVER_HIT: u32 = 0x80000000u;

// The largest relative error of a sum, a difference or a product: one unit in the last place.
const E: f32 = 0x1p-23f;
// Relative width of the band in which a sphere is neither hit nor missed for certain.
const K: f32 = 20.0 * E;
// More than anything that flushed numbers change.
const TINY: f32 = 0x1p-60f;
const TINY_SQUARE: f32 = 0x1p-100f;
// Distances of planes are moved by this part of the distance of the box's corner and of the grid's width.
const SLACK: f32 = 16.0 * E;
// Steps of a grid, and one more.
const STEPS: f32 = 256.0;
// Directions are kept this far from 0.
const LEAST: f32 = 0x1p-100f;
// Bits of 2^20, 1/4 and 4: the largest coordinate of origins, and the range of that of directions.
const REACH_BITS: u32 = 0x49800000u;
const SHORT_BITS: u32 = 0x3e800000u;
const LONG_BITS: u32 = 0x40800000u;

// No less than the square root of a number.
fn root_above(x: f32) -> f32 {
    let least = max(x, TINY_SQUARE);
    let root = keep(keep(sqrt(least)) * (1.0 + 16.0 * E));
    return select(max(least, 1.0), root, keep(root * root) >= least * (1.0 + 4.0 * E));
}

// No more than the square root of a number.
fn root_below(x: f32) -> f32 {
    let root = keep(keep(sqrt(max(x, TINY_SQUARE))) * (1.0 - 16.0 * E));
    let proven = x >= TINY_SQUARE && keep(root * root) <= x * (1.0 - 4.0 * E);
    return select(0.0, root, proven);
}

struct Ray {
    origin: vec3<f32>,
    direction: vec3<f32>,
    // The sphere that the ray starts on, and the one that it is aimed at, which it never hits; or MISS.
    own: u32,
    goal: u32,
    length2: f32,
    inverse_length2: f32,
    // No less than the direction's length.
    length: f32,
    // Maximum error of the origin if it is a rounded point of a surface; else 0.
    origin_error: f32,
}

// The search so far.
struct Search {
    // A hit that is certain, and bounds of its distance; MISS if there is none.
    sphere: u32,
    near: f32,
    far: f32,
    // Nothing else is hit before.
    others: f32,
    // A distance before which the search does not end, and one beyond which nothing counts.
    bound: f32,
    t_far: f32,
}

// 1 if the line of a ray may meet a sphere, else 0. `test_sphere` decides. The reach is a sum of what is not below 0, in
// which any order will do.
fn is_near(ray: ptr<function, Ray>, bits: vec4<u32>) -> u32 {
    let radius = bitcast<f32>(bits.w & ~NEVER_HIT);
    let to_center = keep3(bitcast<vec3<f32>>(bits.xyz) - (*ray).origin);
    let middle = keep(dot(to_center, (*ray).direction) * (*ray).inverse_length2);
    let perpendicular = keep3(to_center - middle * (*ray).direction);
    let reach = radius * (1.0 + K) + (abs(middle) * K * (*ray).length + TINY);
    let meets = dot(perpendicular, perpendicular) <= reach * reach;
    return select(0u, 1u, meets && (bits.w & NEVER_HIT) == 0u);
}

// The spheres of a leaf that the line of a ray may meet: a bit for each. All are read at once.
fn spheres_near(ray: ptr<function, Ray>, first: u32) -> u32 {
    let s0 = sphere_row(first);
    let s1 = sphere_row(first + 1u);
    let s2 = sphere_row(first + 2u);
    let s3 = sphere_row(first + 3u);
    let s4 = sphere_row(first + 4u);
    let s5 = sphere_row(first + 5u);
    let s6 = sphere_row(first + 6u);
    let s7 = sphere_row(first + 7u);
    return is_near(ray, s0) | is_near(ray, s1) << 1u | is_near(ray, s2) << 2u | is_near(ray, s3) << 3u
        | is_near(ray, s4) << 4u | is_near(ray, s5) << 5u | is_near(ray, s6) << 6u | is_near(ray, s7) << 7u;
}

// Whether a sphere is the one in a row, or coincides with it.
fn is_same(sphere: vec4<u32>, row: u32, known: u32) -> bool {
    return known == row
        || (known < UNKNOWN - 1u && all((sphere_row(known) & vec4<u32>(~0u, ~0u, ~0u, ~NEVER_HIT)) == sphere));
}

// Takes note of a hit that is certain, in an interval of distances.
fn keep_hit(search: ptr<function, Search>, row: u32, near: f32, far: f32) {
    if far < (*search).far {
        (*search).others = min((*search).others, (*search).near);
        (*search).sphere = row;
        (*search).near = near;
        (*search).far = far;
        (*search).t_far = min((*search).t_far, far);
    } else {
        (*search).others = min((*search).others, near);
    }
}

// Permutes the bits of slots so that they are in the order in which a ray of an octant meets them, or back.
fn in_order_of(octant: u32, slots: u32) -> u32 {
    var mask = slots;
    if (octant & 1u) != 0u {
        mask = ((mask & 0x55u) << 1u) | ((mask >> 1u) & 0x55u);
    }
    if (octant & 2u) != 0u {
        mask = ((mask & 0x33u) << 2u) | ((mask >> 2u) & 0x33u);
    }
    if (octant & 4u) != 0u {
        mask = ((mask & 0x0fu) << 4u) | (mask >> 4u);
    }
    return mask;
}

struct Slabs {
    origin: vec3<f32>,
    inverse: vec3<f32>,
    negative: vec3<bool>,
    octant: u32,
}

// Four bytes as numbers.
fn bytes(word: u32) -> vec4<f32> {
    return vec4<f32>((vec4<u32>(word) >> vec4<u32>(0u, 8u, 16u, 24u)) & vec4<u32>(0xffu));
}

// The children of a node that the ray may enter before `t_far`: a bit for each, in the order in which it meets them.
fn children_entered(slabs: ptr<function, Slabs>, node: u32, t_far: f32) -> u32 {
    let row = node * NODE_ROWS;
    let corner = nodes[row];
    let planes_x = nodes[row + 1u];
    let planes_y = nodes[row + 2u];
    let planes_z = nodes[row + 3u];
    let inverse = (*slabs).inverse;
    // Of a distance: what a step of the grid adds, and what the corner is at.
    let exponents = (vec3<u32>(corner.w) >> vec3<u32>(0u, 8u, 16u)) & vec3<u32>(0xffu);
    let step = bitcast<vec3<f32>>(exponents << vec3<u32>(23u)) * inverse;
    let base = keep3(bitcast<vec3<f32>>(corner.xyz) - (*slabs).origin) * inverse;
    let slack = (abs(base) + abs(step) * STEPS) * SLACK;
    let near_base = base - slack;
    let far_base = base + slack;
    let negative = (*slabs).negative;
    let near_x = select(planes_x.xy, planes_x.zw, negative.x);
    let near_y = select(planes_y.xy, planes_y.zw, negative.y);
    let near_z = select(planes_z.xy, planes_z.zw, negative.z);
    let far_x = select(planes_x.zw, planes_x.xy, negative.x);
    let far_y = select(planes_y.zw, planes_y.xy, negative.y);
    let far_z = select(planes_z.zw, planes_z.xy, negative.z);
    var slots = 0u;
    {
        let near = max(max(bytes(near_x.x) * step.x + near_base.x, bytes(near_y.x) * step.y + near_base.y),
            max(bytes(near_z.x) * step.z + near_base.z, vec4<f32>(0.0)));
        let far = min(min(bytes(far_x.x) * step.x + far_base.x, bytes(far_y.x) * step.y + far_base.y),
            min(bytes(far_z.x) * step.z + far_base.z, vec4<f32>(t_far)));
        slots = dot(vec4<u32>(near <= far), vec4<u32>(1u, 2u, 4u, 8u));
    }
    {
        let near = max(max(bytes(near_x.y) * step.x + near_base.x, bytes(near_y.y) * step.y + near_base.y),
            max(bytes(near_z.y) * step.z + near_base.z, vec4<f32>(0.0)));
        let far = min(min(bytes(far_x.y) * step.x + far_base.x, bytes(far_y.y) * step.y + far_base.y),
            min(bytes(far_z.y) * step.z + far_base.z, vec4<f32>(t_far)));
        slots |= dot(vec4<u32>(near <= far), vec4<u32>(16u, 32u, 64u, 128u));
    }
    return in_order_of((*slabs).octant, slots & (corner.w >> 24u));
}

// The answer for a search that has passed the tree.
fn answer(search: ptr<function, Search>) -> u32 {
    let first = min((*search).others, (*search).bound);
    if (*search).sphere != MISS && (*search).far < first {
        return (*search).sphere;
    }
    let none = (*search).sphere == MISS && (*search).others >= FAR;
    return select(UNKNOWN, MISS, none);
}

fn trace(ray: ptr<function, Ray>, search: ptr<function, Search>) -> u32 {
    var slabs: Slabs;
    let direction = (*ray).direction;
    let least = select(vec3<f32>(LEAST), vec3<f32>(-LEAST), direction < vec3<f32>(0.0));
    let kept = select(direction, least, abs(direction) < vec3<f32>(LEAST));
    slabs.origin = (*ray).origin;
    slabs.inverse = keep3(1.0 / kept);
    slabs.negative = kept < vec3<f32>(0.0);
    slabs.octant = dot(vec3<u32>(slabs.negative), vec3<u32>(1u, 2u, 4u));
    var stack: array<vec2<u32>, DEPTH>;
    var depth = 0u;
    var node = 0u;
    var open = children_entered(&slabs, node, (*search).t_far);
    var visits = 1u;
    loop {
        if open == 0u {
            if depth == 0u {
                break;
            }
            depth -= 1u;
            node = stack[depth].x;
            open = stack[depth].y;
        }
        let slot = firstTrailingBit(open) ^ slabs.octant;
        open &= open - 1u;
        let child = nodes[node * NODE_ROWS + CHILD_ROW + (slot >> 2u)][slot & 3u];
        if (child & LEAF) == 0u {
            if open != 0u {
                if depth == DEPTH {
                    return UNKNOWN;
                }
                stack[depth] = vec2<u32>(node, open);
                depth += 1u;
            }
            node = child;
            open = children_entered(&slabs, node, (*search).t_far);
            visits += 1u;
            continue;
        }
        visits += 1u << 16u;
        let first = (child & (LEAF - 1u)) * 8u;
        for (var near = spheres_near(ray, first); near != 0u; near &= near - 1u) {
            test_sphere(ray, search, first + firstTrailingBit(near));
            if ANY && (*search).sphere != MISS {
                break;
            }
        }
        if ANY && (*search).sphere != MISS {
            if (*search).far < (*search).bound {
                return select((*search).sphere, visits, COUNT);
            }
            // Too close to the end of the search.
            (*search).others = 0.0;
        }
    }
    return select(answer(search), visits, COUNT);
}

// The largest coordinate without its sign, in bits.
fn largest(v: vec3<u32>) -> u32 {
    let magnitude = v & vec3<u32>(0x7fffffffu);
    return max(max(magnitude.x, magnitude.y), magnitude.z);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = row_of(id.x);
    if row == NO_ROW || (AGAIN && found[row] != UNKNOWN) {
        return;
    }
    let first = rays[3u * row];
    let second = rays[3u * row + 1u];
    let third = rays[3u * row + 2u];
    let toward = vec3<u32>(first.w, second.xy);
    let long = largest(toward);
    let bounds = bitcast<vec2<f32>>(third.xy);
    if params.nodes == 0u || bounds.y < 0.0 {
        found[row] = MISS;
        return;
    }
    if largest(first.xyz) > REACH_BITS || long < SHORT_BITS || long > LONG_BITS {
        found[row] = UNKNOWN;
        return;
    }
    var ray: Ray;
    ray.origin = bitcast<vec3<f32>>(first.xyz);
    ray.direction = bitcast<vec3<f32>>(toward);
    ray.own = second.z;
    ray.goal = second.w;
    ray.length2 = keep(dot(ray.direction, ray.direction));
    ray.inverse_length2 = keep(1.0 / ray.length2);
    ray.length = root_above(ray.length2 * (1.0 + 8.0 * E));
    let span = abs(ray.origin.x) + abs(ray.origin.y) + abs(ray.origin.z);
    ray.origin_error = select(0.0, keep(span * (E * (1.0 + 8.0 * E))), ray.own != MISS);
    var search = Search(MISS, FAR, FAR, FAR, bounds.x, bounds.y);
    found[row] = trace(&ray, &search);
}
