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

fn node_place(node: u32) -> vec4<f32> {
    return bitcast<vec4<f32>>(light_rows[job.node_rows + 2u * node]);
}

fn node_rest(node: u32) -> vec4<u32> {
    return light_rows[job.node_rows + 2u * node + 1u];
}

// The irradiance of a disc whose center is at this cosine to the normal, with the sine of its angular radius.
fn horizon(cosine: f32, sine: f32) -> f32 {
    if !(cosine < sine) {
        return cosine;
    }
    let above = max(keep(cosine + sine), 0.0);
    return quotient(keep(above * above), keep(sine * 4.0));
}

fn node_irradiance(node: u32, point: vec3<f32>, normal: vec3<f32>) -> f32 {
    let place = node_place(node);
    let light = bitcast<vec2<f32>>(node_rest(node).xy);
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
    if sine > 0.0 || cosine > 0.0 {
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

fn find_chances(chances: ptr<function, Chances>, siblings: Siblings, point: vec3<f32>, normal: vec3<f32>) {
    for (var lane = 0u; lane < siblings.count; lane++) {
        (*chances).each[lane] = node_irradiance(siblings.first + lane, point, normal);
    }
    sum_chances(chances, siblings.count);
    if (*chances).total >= LEAST_SUM && (*chances).total < MOST_SUM {
        return;
    }
    for (var lane = 0u; lane < siblings.count; lane++) {
        let light = bitcast<vec2<f32>>(node_rest(siblings.first + lane).xy);
        (*chances).each[lane] = keep(light.x + light.y);
    }
    sum_chances(chances, siblings.count);
}

fn chance_of(chances: ptr<function, Chances>, lane: u32) -> f64 {
    return f64((*chances).each[lane]) / (*chances).total;
}

fn choose_in_tree(point: vec3<f32>, normal: vec3<f32>, number: f64) -> LightChoice {
    var draw = number;
    var probability = 1.0lf;
    var siblings = Siblings(0u, job.top);
    var chances: Chances;
    loop {
        find_chances(&chances, siblings, point, normal);
        var left = kept(draw * chances.total);
        var chosen = 0u;
        var rest = 0.0lf;
        for (var lane = 0u; lane < siblings.count; lane++) {
            let chance = f64(chances.each[lane]);
            if chance > 0.0lf {
                chosen = lane;
                rest = left / chance;
                if left < chance {
                    break;
                }
            }
            left = kept(left - chance);
        }
        draw = clamp(rest, 0.0lf, 1.0lf - 0x1p-52lf);
        probability = kept(probability * chance_of(&chances, chosen));
        let node = node_rest(siblings.first + chosen);
        siblings = Siblings(node.z, node.w & ((1u << CHILDREN_BITS) - 1u));
        if siblings.count == 0u {
            return LightChoice(node.z, f32(probability));
        }
    }
    // Not reached: validators ask for it.
    return LightChoice(0u, 1.0);
}

fn probability_in_tree(point: vec3<f32>, normal: vec3<f32>, light: u32) -> f32 {
    var node = light_word(job.last_rows, light);
    if node == NO_LEAF {
        return 0.0;
    }
    var probability = 1.0lf;
    var chances: Chances;
    loop {
        let above = node_rest(node).w >> CHILDREN_BITS;
        var siblings = Siblings(0u, job.top);
        if above != ROOT {
            let parent = node_rest(above);
            siblings = Siblings(parent.z, parent.w & ((1u << CHILDREN_BITS) - 1u));
        }
        find_chances(&chances, siblings, point, normal);
        probability = kept(probability * chance_of(&chances, node - siblings.first));
        if above == ROOT {
            break;
        }
        node = above;
    }
    return f32(probability);
}
