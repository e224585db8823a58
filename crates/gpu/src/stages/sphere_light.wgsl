// Emissive spheres as seen from points: `world/lights/sphere_light.rs` and `sampling/cone.rs`.

// A sphere as seen from a point: the cone that it fills.
struct SphereView {
    // False from inside.
    outside: bool,
    direction: vec3<f32>,
    // 1 - cos of the cone's half-angle, and the density of its directions.
    height: f32,
    pdf: f32,
    close: bool,
}

const TWO_PI: f64 = 0x1.921fb54442d18p+2lf;
const LEAST_HEIGHT: f64 = 0x1p-126lf;

fn view_sphere(point: vec3<f32>, sphere: u32) -> SphereView {
    let bits = sphere_row(sphere);
    let radius = f64(bitcast<f32>(bits.w));
    let toward = kept3(vec3<f64>(bitcast<vec3<f32>>(bits.xyz)) - vec3<f64>(point));
    let distance2 = dot_unfused(toward, toward);
    let distance = sqrt(distance2);
    let direction = kept3(toward * (1.0lf / distance));
    let reach = kept(job.reach * radius);
    let sine = radius / distance;
    let cosine2 = kept(kept(distance - radius) / distance * (kept(distance + radius) / distance));
    let height = max(kept(sine * sine) / kept(1.0lf + sqrt(cosine2)), LEAST_HEIGHT);
    return SphereView(
        0.0lf < radius && radius < distance,
        vec3<f32>(direction),
        f32(height),
        f32(1.0lf / kept(TWO_PI * height)),
        distance2 < kept(reach * reach),
    );
}

// Whether a ray from a surface meets a sphere ahead, and where, as `intersect::confirm` of spherule-core decides.
struct Ahead {
    known: bool,
    meets: bool,
    t: f64,
}

fn sphere_ahead(point: vec3<f32>, direction: vec3<f32>, sphere: u32) -> Ahead {
    let bits = sphere_row(sphere);
    let center = vec3<f64>(bitcast<vec3<f32>>(bits.xyz));
    let radius = f64(bitcast<f32>(bits.w));
    let origin = vec3<f64>(point);
    let terms = sphere_terms(origin, vec3<f64>(direction), center, radius);
    let apart = is_apart(terms, radius, rounding_of(origin));
    let found = sphere_distance(terms);
    if found.clear {
        return Ahead(apart, true, found.t);
    }
    let passes = is_chord_clear(terms) && terms.chord2 < 0.0;
    let behind = terms.outside > 0.0 && terms.b < -error_of_b(terms);
    return Ahead(apart && (passes || behind), false, 0.0lf);
}

fn sample_sphere_light(point: vec3<f32>, own: u32, light: u32, u: vec2<f32>) -> LightSample {
    let sphere = light_rows[light].w;
    var sample = no_light();
    if sphere == own {
        return sample;
    }
    let seen = view_sphere(point, sphere);
    if !seen.outside {
        return sample;
    }
    sample.lit = true;
    sample.direction = to_world(basis_about(seen.direction), cap(u, seen.height));
    let ahead = sphere_ahead(point, sample.direction, sphere);
    sample.known = ahead.known && ahead.meets;
    sample.t = ahead.t;
    sample.goal = sphere;
    sample.weight = quotients(light_vector(light), seen.pdf);
    sample.pdf = seen.pdf;
    sample.close = seen.close;
    return sample;
}

// The number of an emissive sphere among the lights; MISS if it is not sampled.
fn emitter_number(sphere: u32) -> u32 {
    var low = 0u;
    var high = job.emitters;
    while low < high {
        let middle = (low + high) / 2u;
        let found = light_rows[job.found_rows + middle];
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

// True if a point is outside of a sphere.
fn is_outside(point: vec3<f32>, sphere: u32) -> bool {
    let bits = sphere_row(sphere);
    let radius = f64(bitcast<f32>(bits.w));
    let toward = kept3(vec3<f64>(bitcast<vec3<f32>>(bits.xyz)) - vec3<f64>(point));
    return dot_unfused(toward, toward) > kept(radius * radius);
}
