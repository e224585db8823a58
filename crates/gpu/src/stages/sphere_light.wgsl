// Emissive spheres as seen from points: `world/lights/sphere_light.rs` and `sampling/cone.rs`.

// The cone of directions to a sphere.
struct Cone {
    // False from inside.
    outside: bool,
    // 1 - cos of the half-angle, and the density of the directions.
    height: f32,
    pdf: f32,
}

// A sphere as seen from a point.
struct SphereView {
    direction: vec3<f32>,
    cone: Cone,
    close: bool,
}

const TWO_PI: f64 = 0x1.921fb54442d18p+2lf;
const LEAST_HEIGHT: f64 = 0x1p-126lf;

// `Cone::toward_sphere`.
fn cone_toward(distance2: f64, radius: f64) -> Cone {
    let distance = sqrt(distance2);
    let sine = radius / distance;
    let cosine2 = kept(kept(distance - radius) / distance * (kept(distance + radius) / distance));
    let height = max(kept(sine * sine) / kept(1.0lf + sqrt(cosine2)), LEAST_HEIGHT);
    let outside = 0.0lf < radius && radius < distance;
    return Cone(outside, f32(height), f32(1.0lf / kept(TWO_PI * height)));
}

fn view_sphere(point: vec3<f32>, sphere: u32) -> SphereView {
    let bits = sphere_row(sphere);
    let radius = f64(bitcast<f32>(bits.w));
    let toward = kept3(vec3<f64>(bitcast<vec3<f32>>(bits.xyz)) - vec3<f64>(point));
    let distance2 = dot_unfused(toward, toward);
    let direction = kept3(toward * (1.0lf / sqrt(distance2)));
    let reach = kept(job.reach * radius);
    return SphereView(vec3<f32>(direction), cone_toward(distance2, radius), distance2 < kept(reach * reach));
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
    if !seen.cone.outside {
        return sample;
    }
    sample.lit = true;
    sample.direction = to_world(basis_about(seen.direction), cap(u, seen.cone.height));
    let ahead = sphere_ahead(point, sample.direction, sphere);
    sample.known = ahead.known && ahead.meets;
    sample.t = ahead.t;
    sample.goal = sphere;
    sample.weight = quotients(light_vector(light), seen.cone.pdf);
    sample.pdf = seen.cone.pdf;
    sample.close = seen.close;
    return sample;
}

// The number of an emissive sphere among the lights; MISS if it is not sampled.
fn emitter_number(sphere: u32) -> u32 {
    return number_of(sphere, job.found_rows, job.emitters);
}

// True if a point is outside of a sphere.
fn is_outside(point: vec3<f32>, sphere: u32) -> bool {
    let bits = sphere_row(sphere);
    let radius = f64(bitcast<f32>(bits.w));
    let toward = kept3(vec3<f64>(bitcast<vec3<f32>>(bits.xyz)) - vec3<f64>(point));
    return dot_unfused(toward, toward) > kept(radius * radius);
}
