// Lights in rows, and the choice of one: `world/lights/mod.rs` and `sampler.rs`, and `sampling/distribution.rs`.
//
// `light_rows` is bound by the kernels. Of each emissive sphere it has the radiance and the sphere; then the same spheres
// with their numbers among these, by sphere; of each point three rows, of each sun five; then two rows of each node of the
// light tree, and the leaf of each light, or cumulative probabilities. `casters.wgsl` describes the others.

struct LightChoice {
    light: u32,
    probability: f32,
    // The place of the random number in the light's share, by the tree.
    rest: f64,
}

// A light sample.
struct LightSample {
    // False where the device does not know the processor's numbers.
    known: bool,
    // False if there is no light.
    lit: bool,
    direction: vec3<f32>,
    // Distance of the light.
    t: f64,
    // The light, if it is a sphere.
    goal: u32,
    // Radiance over density.
    weight: vec3<f32>,
    // 0 for lights without extent.
    pdf: f32,
    // True for emissive spheres that diffuse surfaces find by BSDF samples as well.
    close: bool,
}

fn no_light() -> LightSample {
    let none = vec3<f32>(0.0);
    return LightSample(true, false, none, INFINITELY_FAR, MISS, none, 0.0, false);
}

// One of the words that begin at a row.
fn light_word(first: u32, place: u32) -> u32 {
    return light_rows[first + (place >> 2u)][place & 3u];
}

// The number beside a sphere in rows that are ordered by spheres; MISS if it is not among them.
fn number_of(sphere: u32, first: u32, count: u32) -> u32 {
    var low = 0u;
    var high = count;
    while low < high {
        let middle = (low + high) / 2u;
        let found = light_rows[first + middle];
        if found.x == sphere {
            return found.y;
        }
        if found.x < sphere {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return MISS;
}

fn light_vector(row: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(light_rows[row].xyz);
}

// The number that chooses a light: `LightDraw` of `sampling/plan.rs`.
fn light_draw(numbers: vec4<f32>) -> f64 {
    return min(kept(f64(numbers.z) + kept(f64(numbers.w) * 0x1p-23lf)), 1.0lf - 0x1p-52lf);
}

fn cumulative(place: u32) -> f32 {
    return bitcast<f32>(light_word(job.last_rows, place));
}

fn choose_by_table(draw: f32) -> LightChoice {
    let u = min(draw, ONE_BELOW);
    var low = 0u;
    var high = job.emitters + job.points + job.suns + job.sky_parts - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if cumulative(middle + 1u) <= u {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return LightChoice(low, keep(cumulative(low + 1u) - cumulative(low)), 0.0lf);
}

fn choose_light(point: vec3<f32>, normal: vec3<f32>, draw: f64) -> LightChoice {
    if has(LIGHT_TREE) {
        return choose_in_tree(light_tree(), point, normal, draw);
    }
    if has(LIGHT_TABLE) {
        return choose_by_table(f32(draw));
    }
    return LightChoice(0u, 1.0, 0.0lf);
}

// The probability with which a light is chosen.
fn light_probability(point: vec3<f32>, normal: vec3<f32>, light: u32) -> f32 {
    if has(LIGHT_TREE) {
        return probability_in_tree(light_tree(), point, normal, light);
    }
    if has(LIGHT_TABLE) {
        return keep(cumulative(light + 1u) - cumulative(light));
    }
    return select(0.0, 1.0, has(LIGHTS));
}

fn power_heuristic(found: f32, other: f32) -> f32 {
    let ratio = quotient(other, found);
    return quotient(1.0, mul_add(ratio, ratio, 1.0));
}
