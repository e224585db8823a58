// The light tree: `world/lights/tree.rs`. Each node has up to sixteen children, among which a light is chosen by its
// estimated contribution.

const BRANCHES: u32 = 16u;
const HIDDEN: f32 = 1e-2;
const WITHIN: f32 = 0.25;
// Sums that single precision resolves well.
const LEAST_SUM: f64 = 1e-30lf;
const MOST_SUM: f64 = 1e30lf;
// Bits of a node's last word with its number of children; the others have its parent.
const CHILDREN_BITS: u32 = 5u;
const ROOT: u32 = 0x7ffffffu;
const NO_LEAF: u32 = 0xffffffffu;

// A tree of lights: the first rows of its nodes and of its leaves, and the number of the root's children.
struct LightTree {
    nodes: u32,
    top: u32,
    leaves: u32,
    // True if receivers are lit from everywhere, and not from above their horizon alone.
    around: bool,
}

// The children of a node.
struct Siblings {
    first: u32,
    count: u32,
}

// Relative probabilities of siblings.
struct Chances {
    each: array<f32, BRANCHES>,
    total: f64,
}

fn light_tree() -> LightTree {
    return LightTree(job.node_rows, job.top, job.last_rows, false);
}

fn node_place(tree: LightTree, node: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(light_rows[tree.nodes + 2u * node]);
}

fn node_rest(tree: LightTree, node: u32) -> vec4<u32> {
    return light_rows[tree.nodes + 2u * node + 1u];
}

// The irradiance of a disc whose center is at this cosine to the normal, with the sine of its angular radius.
fn horizon(cosine: f32, sine: f32) -> f32 {
    if !(cosine < sine) {
        return cosine;
    }
    let above = max(keep(cosine + sine), 0.0);
    return quotient(keep(above * above), keep(sine * 4.0));
}

fn node_irradiance(tree: LightTree, node: u32, point: vec3<f32>, normal: vec3<f32>) -> f32 {
    let place = node_place(tree, node);
    let light = bitcast<vec2<f32>>(node_rest(tree, node).xy);
    let toward = keep3(place.xyz - point);
    let distance2 = dot_fused(toward, toward);
    let radius2 = keep(place.w * place.w);
    let hollow = (bitcast<u32>(place.w) >> 31u) != 0u;
    if hollow && distance2 < radius2 {
        return 0.0;
    }
    let near = quotient(1.0, root(max(distance2, keep(radius2 * WITHIN))));
    let cosine = keep(dot_fused(toward, normal) * near);
    let sine = keep(abs(place.w) * near);
    var facing = HIDDEN;
    // Of a point below the horizon it is 0 / 0.
    if tree.around {
        facing = 1.0;
    } else if sine > 0.0 || cosine > 0.0 {
        facing = max(horizon(cosine, sine), HIDDEN);
    }
    let total = mul_add(keep(near * near), light.x, light.y);
    return max(keep(total * facing), LEAST_NORMAL);
}

fn sum_chances(chances: ptr<function, Chances>, count: u32) {
    var total = 0.0lf;
    for (var lane = 0u; lane < count; lane++) {
        total = kept(total + f64((*chances).each[lane]));
    }
    (*chances).total = total;
}

fn find_chances(
    chances: ptr<function, Chances>,
    tree: LightTree,
    siblings: Siblings,
    point: vec3<f32>,
    normal: vec3<f32>,
) {
    for (var lane = 0u; lane < siblings.count; lane++) {
        (*chances).each[lane] = node_irradiance(tree, siblings.first + lane, point, normal);
    }
    sum_chances(chances, siblings.count);
    if (*chances).total >= LEAST_SUM && (*chances).total < MOST_SUM {
        return;
    }
    for (var lane = 0u; lane < siblings.count; lane++) {
        let light = bitcast<vec2<f32>>(node_rest(tree, siblings.first + lane).xy);
        (*chances).each[lane] = keep(light.x + light.y);
    }
    sum_chances(chances, siblings.count);
}

fn chance_of(chances: ptr<function, Chances>, lane: u32) -> f64 {
    return f64((*chances).each[lane]) / (*chances).total;
}

// The lane in whose share a random number falls, and its place in that share.
struct Pick {
    lane: u32,
    rest: f64,
}

fn pick_chance(chances: ptr<function, Chances>, count: u32, draw: f64) -> Pick {
    var left = kept(draw * (*chances).total);
    var pick = Pick(0u, 0.0lf);
    for (var lane = 0u; lane < count; lane++) {
        let chance = f64((*chances).each[lane]);
        if chance > 0.0lf {
            pick = Pick(lane, left / chance);
            if left < chance {
                break;
            }
        }
        left = kept(left - chance);
    }
    return Pick(pick.lane, clamp(pick.rest, 0.0lf, 1.0lf - 0x1p-52lf));
}

fn choose_in_tree(tree: LightTree, point: vec3<f32>, normal: vec3<f32>, number: f64) -> LightChoice {
    var draw = number;
    var probability = 1.0lf;
    var siblings = Siblings(0u, tree.top);
    var chances: Chances;
    loop {
        find_chances(&chances, tree, siblings, point, normal);
        let pick = pick_chance(&chances, siblings.count, draw);
        draw = pick.rest;
        probability = kept(probability * chance_of(&chances, pick.lane));
        let node = node_rest(tree, siblings.first + pick.lane);
        siblings = Siblings(node.z, node.w & ((1u << CHILDREN_BITS) - 1u));
        if siblings.count == 0u {
            return LightChoice(node.z, f32(probability), draw);
        }
    }
    // Not reached: validators ask for it.
    return LightChoice(0u, 1.0, 0.0lf);
}

fn probability_in_tree(tree: LightTree, point: vec3<f32>, normal: vec3<f32>, light: u32) -> f32 {
    var node = light_word(tree.leaves, light);
    if node == NO_LEAF {
        return 0.0;
    }
    var probability = 1.0lf;
    var chances: Chances;
    loop {
        let above = node_rest(tree, node).w >> CHILDREN_BITS;
        var siblings = Siblings(0u, tree.top);
        if above != ROOT {
            let parent = node_rest(tree, above);
            siblings = Siblings(parent.z, parent.w & ((1u << CHILDREN_BITS) - 1u));
        }
        find_chances(&chances, tree, siblings, point, normal);
        probability = kept(probability * chance_of(&chances, node - siblings.first));
        if above == ROOT {
            break;
        }
        node = above;
    }
    return f32(probability);
}
