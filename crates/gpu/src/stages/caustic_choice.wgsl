// The choice of a caustic for a surface point: `world/caustics/selection.rs` and `world/caustics/bounds.rs`.

const IRRADIANCE_TO_SAMPLES: f64 = 0.25lf;
const MAX_CAUSTIC_SAMPLES: f64 = 16.0lf;

// Kinds of paths, in their order.
const REFLECTED: u32 = 0u;
const CROSSED: u32 = 1u;
const PARAXIAL: u32 = 2u;
const MARGINAL: u32 = 3u;

// The numbers that all samples of a receiver have in common.
struct CausticDraw {
    at: Receiver,
    emitter: u32,
    // Probability of the emitter.
    probability: f32,
    view: EmitterView,
    // The random number.
    number: f64,
    // Expected number of samples; 0 if there is none for the random number.
    samples: f64,
    // Of the root's children.
    chances: Chances,
}

// An emitter, a specular sphere and a kind of path.
struct CausticChoice {
    found: bool,
    caster: u32,
    path: u32,
    // Probability of the choice times the expected number of samples.
    rate: f64,
}

fn emitter_tree() -> LightTree {
    let head = caster_head(1u);
    return LightTree(head.z, head.w, caster_head(2u).x, true);
}

fn has_emitter_tree() -> bool {
    return caster_head(2u).z != 0u;
}

// The bound of the number of samples at a point.
fn bound_of_samples(at: Receiver) -> f64 {
    let low = bitcast<vec4<f32>>(caster_head(3u));
    let cells = caster_head(4u).xyz;
    let place = keep3(keep3(at.point - low.xyz) * low.w);
    if !(all(place >= vec3<f32>(0.0)) && all(place < vec3<f32>(cells))) {
        return INFINITELY_FAR;
    }
    let cell = vec3<u32>(place);
    let first = 6u * (cell.x + cells.x * (cell.y + cells.y * cell.z));
    let side = select(vec3<u32>(3u), vec3<u32>(0u), at.normal >= vec3<f32>(0.0));
    let words = caster_head(2u).y;
    let along = bitcast<vec3<f32>>(vec3<u32>(
        light_word(words, first + side.x),
        light_word(words, first + side.y + 1u),
        light_word(words, first + side.z + 2u),
    ));
    return f64(dot_unfused32(along, abs(at.normal)));
}

// The expected number of samples, by the chances of the root's children.
fn expected_samples(total: f64) -> f64 {
    if total >= LEAST_SUM && total < MOST_SUM {
        return min(kept(total * IRRADIANCE_TO_SAMPLES), MAX_CAUSTIC_SAMPLES);
    }
    return 0.0lf;
}

fn begin_caustics(at: Receiver, number: f64) -> CausticDraw {
    var draw: CausticDraw;
    draw.at = at;
    draw.emitter = 0u;
    draw.probability = 1.0;
    draw.number = number;
    if has_emitter_tree() {
        let choice = choose_in_tree(emitter_tree(), at.point, at.normal, number);
        draw.emitter = choice.light;
        draw.probability = choice.probability;
        draw.number = choice.rest;
    }
    draw.samples = 0.0lf;
    let bound = bound_of_samples(at);
    if draw.number < bound {
        draw.view = view_emitter(draw.emitter, at);
        var chances: Chances;
        find_caster_chances(&chances, top_casters(), at, draw.view);
        draw.chances = chances;
        draw.samples = min(expected_samples(chances.total), bound);
    }
    return draw;
}

// The share of a kind of path in the contribution of a node.
fn share_of_path(paths: vec4<f32>, path: u32) -> f64 {
    let each = vec4<f64>(paths);
    let sum = kept(kept(kept(each.x + each.y) + each.z) + each.w);
    if !(sum > 0.0lf) {
        return 0.0lf;
    }
    return each[path] / sum;
}

// The choice of sample `index`.
fn choose_caustic(draw: ptr<function, CausticDraw>, index: u32) -> CausticChoice {
    var choice = CausticChoice(false, 0u, REFLECTED, 0.0lf);
    let left = kept(f64(index) + (*draw).number);
    if !(left < (*draw).samples) {
        return choice;
    }
    var number = left / (*draw).samples;
    var rate = kept(f64((*draw).probability) * (*draw).samples);
    var siblings = top_casters();
    var chances = (*draw).chances;
    loop {
        let picked = pick_chance(&chances, siblings.count, number);
        rate = kept(rate * chance_of(&chances, picked.lane));
        let node = siblings.first + picked.lane;
        let below = children_of_caster(node);
        if below.count == 0u {
            let paths = estimate_node(node, (*draw).at, (*draw).view).paths;
            var rest = picked.rest;
            var last = 0.0lf;
            for (var path = REFLECTED; path <= MARGINAL; path++) {
                let share = share_of_path(paths, path);
                if share > 0.0lf {
                    choice.found = true;
                    choice.path = path;
                    last = share;
                    if rest < share {
                        break;
                    }
                }
                rest = kept(rest - share);
            }
            choice.caster = below.first;
            choice.rate = kept(rate * last);
            return choice;
        }
        siblings = below;
        find_caster_chances(&chances, siblings, (*draw).at, (*draw).view);
        if !(chances.total >= LEAST_SUM && chances.total < MOST_SUM) {
            return choice;
        }
        number = picked.rest;
    }
    // Not reached: validators ask for it.
    return choice;
}

// The expected number of samples of a caustic at a receiver.
fn caustic_rate(at: Receiver, emitter: u32, caster: u32, path: u32) -> f64 {
    var rate = 1.0lf;
    if has_emitter_tree() {
        rate = f64(probability_in_tree(emitter_tree(), at.point, at.normal, emitter));
    }
    let view = view_emitter(emitter, at);
    var node = caster_row(caster).w;
    if node == NO_LEAF {
        return 0.0lf;
    }
    let leaf = node;
    var chances: Chances;
    loop {
        let above = caster_node(node, 2u).w >> CHILDREN_BITS;
        var siblings = top_casters();
        if above != ROOT {
            siblings = children_of_caster(above);
        }
        find_caster_chances(&chances, siblings, at, view);
        if !(chances.total >= LEAST_SUM && chances.total < MOST_SUM) {
            return 0.0lf;
        }
        rate = kept(rate * chance_of(&chances, node - siblings.first));
        if node == leaf {
            rate = kept(rate * share_of_path(estimate_node(node, at, view).paths, path));
        }
        if above == ROOT {
            return kept(rate * min(expected_samples(chances.total), bound_of_samples(at)));
        }
        node = above;
    }
    // Not reached: validators ask for it.
    return rate;
}
