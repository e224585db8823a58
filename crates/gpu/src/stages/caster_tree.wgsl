// Estimates of the light that specular spheres bring to a receiver, and their tree: `world/caustics/estimate.rs` and
// `world/caustics/tree.rs`.

// Least divergence of rays that is assumed.
const LEAST_RATE: f32 = 0x1.99999ap-3f;
// 6 * 4 / 27 / 1.44
const LEAST_TURN: f32 = 0x1.3c0ca4p-1f;
// Levels of the tree at most.
const CASTER_LEVELS: u32 = 16u;

// A point that is lit.
struct Receiver {
    point: vec3<f32>,
    normal: vec3<f32>,
    own: u32,
}

// An emitter, and how it lights the receiver.
struct EmitterView {
    far: bool,
    // The center of a sphere; the direction toward a sun.
    place: vec3<f32>,
    // The squared radius; that of a sun is angular.
    radius2: f32,
    // The squared distance of a sphere from the receiver.
    distance2: f32,
}

// An estimate for a node.
struct NodeLight {
    // By kind of path.
    paths: vec4<f32>,
    sum: f32,
    // True if the receiver is in the node: the estimate is the sum over its children.
    vague: bool,
}

fn dot_unfused32(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let products = keep3(a * b);
    return keep(keep(products.x + products.y) + products.z);
}

fn view_emitter(emitter: u32, at: Receiver) -> EmitterView {
    let row = bitcast<vec4<f32>>(emitter_row(emitter, 2u));
    let toward = keep3(row.xyz - at.point);
    return EmitterView(is_sun(emitter), row.xyz, row.w, max(dot_unfused32(toward, toward), row.w));
}

fn caster_node(node: u32, place: u32) -> vec4<u32> {
    return light_rows[caster_head(1u).x + 3u * node + place];
}

fn children_of_caster(node: u32) -> Siblings {
    let row = caster_node(node, 2u);
    return Siblings(row.z, row.w & ((1u << CHILDREN_BITS) - 1u));
}

fn top_casters() -> Siblings {
    return Siblings(0u, caster_head(1u).y);
}

// The contributions of the paths through glass.
fn light_through(ends: f32, turn: f32, spread: f32, index: f32, level: f32, sine2: f32) -> vec3<f32> {
    let along = root(keep(1.0 - keep(spread * spread)));
    let across = root(keep(1.0 - keep(turn * turn)));
    let turned = mul_add(turn, along, keep(across * spread));
    let forward = select(turned, 1.0, along < turn);
    let index2 = keep(index * index);
    let straight = keep(2.0 - keep(2.0 * index));
    let rate = keep(straight - ends);
    let parting = quotient(1.0, max(abs(rate), LEAST_RATE));
    let parting2 = keep(parting * parting);
    let edge = keep(keep(2.0 * index2) - 1.0);
    let beam = min(max(keep(keep(forward - edge) * 1.125), 0.0), 1.0);
    let beam3 = keep(keep(beam * beam) * beam);
    let crossed = keep(keep(level * beam3) * select(2.25, parting2, 0.0 < rate));
    let depth = max(-rate, 0.0);
    let least_turn2 = keep(keep(keep(depth * depth) * depth) * LEAST_TURN);
    let reach = keep(least_turn2 + sine2);
    if !(keep(1.0 - forward) < reach && 0.0 < depth) {
        return vec3<f32>(crossed, 0.0, 0.0);
    }
    let part = quotient(reach, keep(reach + keep(spread * spread)));
    let paraxial = keep(keep(level * part) * parting2);
    return vec3<f32>(crossed, paraxial, keep(paraxial * 0.5));
}

fn estimate_node(node: u32, at: Receiver, emitter: EmitterView) -> NodeLight {
    let place = bitcast<vec4<f32>>(caster_node(node, 0u));
    let numbers = bitcast<vec4<f32>>(caster_node(node, 1u));
    let rest = caster_node(node, 2u);
    let center = place.xyz;
    let extent = place.w;
    let radius = numbers.x;
    let transmitted = bitcast<f32>(rest.x);
    let extent2 = keep(extent * extent);
    let least = keep(extent2 * WITHIN);
    // The emitter as seen from the node.
    var axis = emitter.place;
    var axis_inverse = 0.0;
    var irradiance = 1.0;
    var sine2 = emitter.radius2;
    if !emitter.far {
        let toward = keep3(emitter.place - center);
        let inverse2 = quotient(1.0, max(dot_fused(toward, toward), least));
        axis_inverse = root(inverse2);
        axis = scaled(toward, axis_inverse);
        irradiance = keep(inverse2 * emitter.distance2);
        sine2 = keep(inverse2 * emitter.radius2);
    }
    let toward = keep3(center - at.point);
    let distance2 = dot_fused(toward, toward);
    let inverse = quotient(1.0, root(max(distance2, least)));
    let near = keep(radius * inverse);
    let sine = keep(keep(extent + radius) * inverse);
    let facing = min(horizon(keep(dot_fused(toward, at.normal) * inverse), sine), 1.0);
    let level = keep(facing * keep(keep(inverse * inverse) * irradiance));
    let ends = keep(near + keep(radius * axis_inverse));
    let forward = max(min(keep(dot_fused(toward, axis) * inverse), 1.0), -1.0);
    let side = keep(keep(1.0 - forward) * 0.5);
    let x = min(keep(keep(ends * side) * 0.5), 1.0);
    let parted = mul_add(x, mul_add(x, 0.75, 0.5), 0.25);
    let grazing = keep(1.0 - side);
    let reflectance = mul_add(keep(keep(grazing * grazing) * grazing), numbers.w, numbers.z);
    let reflected = keep(keep(level * reflectance) * parted);
    let spread = min(keep(extent * keep(inverse + axis_inverse)), 1.0);
    var paths = vec4<f32>(0.0);
    // A leaf that contains the point has no light for it.
    if near < 1.0 || 0.0 < extent {
        let through = light_through(ends, forward, spread, numbers.y, keep(level * transmitted), sine2);
        paths = vec4<f32>(reflected, through);
    }
    var sum = keep(keep(paths.x + paths.y) + keep(paths.z + paths.w));
    // A sphere brings no light to itself.
    if rest.y == at.own {
        sum = 0.0;
    }
    return NodeLight(paths, sum, distance2 < extent2 && 0.0 < transmitted);
}

// The sum of the estimates of a node's children; where they contain the receiver, of theirs.
fn refined_estimate(node: u32, at: Receiver, emitter: EmitterView) -> f32 {
    var next: array<u32, CASTER_LEVELS>;
    var end: array<u32, CASTER_LEVELS>;
    var sum: array<f32, CASTER_LEVELS>;
    var level = 0u;
    let top = children_of_caster(node);
    next[0] = top.first;
    end[0] = top.first + top.count;
    sum[0] = 0.0;
    loop {
        if next[level] == end[level] {
            if level == 0u {
                break;
            }
            level--;
            sum[level] = keep(sum[level] + sum[level + 1u]);
            continue;
        }
        let child = next[level];
        next[level]++;
        let light = estimate_node(child, at, emitter);
        if light.vague {
            level++;
            let below = children_of_caster(child);
            next[level] = below.first;
            end[level] = below.first + below.count;
            sum[level] = 0.0;
        } else {
            sum[level] = keep(sum[level] + light.sum);
        }
    }
    return sum[0];
}

fn find_caster_chances(chances: ptr<function, Chances>, siblings: Siblings, at: Receiver, emitter: EmitterView) {
    for (var lane = 0u; lane < siblings.count; lane++) {
        let node = siblings.first + lane;
        let light = estimate_node(node, at, emitter);
        var sum = light.sum;
        if light.vague {
            sum = refined_estimate(node, at, emitter);
        }
        (*chances).each[lane] = sum;
    }
    sum_chances(chances, siblings.count);
}
