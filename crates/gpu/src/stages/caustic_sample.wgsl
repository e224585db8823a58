// Samples of caustics, and MIS weights of caustics that BSDF samples find: `world/caustics/sample.rs`.

// Light that arrives if both segments are unoccluded.
struct CausticSample {
    found: bool,
    toward: vec3<f32>,
    // Point where the ray leaves the sphere, and the direction from there.
    exit: vec3<f32>,
    toward_emitter: vec3<f32>,
    // Lengths of both segments.
    length: vec2<f64>,
    // Cosine of the angle of incidence.
    incidence: f32,
    // Fraction of light that reflection or refraction keeps, without colors.
    kept_light: f32,
    pdf: f32,
}

// A path from a surface that reached an emitter by way of a specular sphere.
struct CausticHit {
    at: Receiver,
    // Direction at the receiver, and its density.
    toward: vec3<f32>,
    pdf: f32,
    sphere: u32,
    through: bool,
    emitter: u32,
    // Point of an emissive sphere; of a sun, the direction toward it.
    end: vec3<f32>,
    toward_emitter: vec3<f32>,
}

// Samples a path, from two numbers in [0, 1).
fn sample_caustic(pair: CasterPair, path: u32, rate: f32, start: vec3<f32>, u: vec2<f32>) -> CausticSample {
    let axis = vec3<f32>(kept3(pair.offset * kept(inverse_length(pair.offset))));
    let direction = vec3<f64>(to_world(basis_about(axis), cap(u, pair.cone.height)));
    let seen = kept3(direction * kept(inverse_length(direction)));
    let chosen = f64(keep(pair.cone.pdf * rate));
    let receiver = kept3(vec3<f64>(start) - pair.center);
    let radius = pair.emitter_radius;
    let middle = dot_unfused(pair.offset, seen);
    let off = kept3(pair.offset - kept3(seen * middle));
    let half2 = kept(kept(radius * radius) - dot_unfused(off, off));
    let distance = kept(middle - kept(sqrt(select(0.0lf, half2, 0.0lf < half2))));
    let emitter = kept3(seen * distance);
    let outside = kept(pair.radius * pair.radius) < dot_unfused(receiver, receiver);
    let connection = connect(pair.radius, pair.index, receiver, emitter, path);
    let outward = kept3(kept3(emitter - pair.offset) * kept(1.0lf / radius));
    let leaving = -dot_unfused(outward, seen);
    let arriving = -dot_unfused(outward, connection.toward_emitter);
    let pdf = kept(kept(kept(chosen * leaving) * connection.spread) / arriving);
    let there = 0.0lf < leaving && 0.0lf < arriving && 0.0lf < pdf;
    return CausticSample(
        connection.found && outside && there,
        normalized(vec3<f32>(connection.toward)),
        keep3(vec3<f32>(connection.exit) + vec3<f32>(pair.center)),
        normalized(vec3<f32>(connection.toward_emitter)),
        connection.length,
        f32(connection.at.cosine),
        f32(fresnel_factor(connection.at.cosine, pair.index, path != REFLECTED)),
        f32(pdf),
    );
}

fn length64(v: vec3<f64>) -> f64 {
    return kept(sqrt(dot_unfused(v, v)));
}

fn cross_unfused(a: vec3<f64>, b: vec3<f64>) -> vec3<f64> {
    return kept3(kept3(a.yzx * b.zxy) - kept3(b.yzx * a.zxy));
}

// The MIS weight of an emitter that a BSDF sample has hit, beside caustic samples.
fn caustic_weight(found: CausticHit) -> f32 {
    let caster = caster_of(found.sphere);
    if caster == MISS || found.emitter == MISS {
        return 1.0;
    }
    let pair = caster_pair(caster, found.emitter);
    if !pair.valid {
        return 1.0;
    }
    let origin = kept3(vec3<f64>(found.at.point) - pair.center);
    var end = kept3(vec3<f64>(found.end) - pair.center);
    if is_sun(found.emitter) {
        // The point of the sun's sphere in that direction.
        let given = vec3<f64>(found.end);
        let direction = kept3(given * kept(inverse_length(given)));
        let middle = dot_unfused(pair.offset, direction);
        let off = kept3(pair.offset - kept3(direction * middle));
        let half2 = kept(kept(pair.emitter_radius * pair.emitter_radius) - dot_unfused(off, off));
        end = kept3(direction * kept(middle - kept(sqrt(max(half2, 0.0lf)))));
    }
    let toward = vec3<f64>(found.toward);
    let distance = vec2<f64>(length64(origin), length64(end));
    let sine = kept(length64(cross_unfused(origin, toward)) / kept(length64(toward) * pair.radius));
    if distance.x <= pair.radius || sine >= 1.0lf {
        return 1.0;
    }
    let at = Angle(sine, kept(sqrt(kept(kept(1.0lf - sine) * kept(1.0lf + sine)))));
    let sphere = specular_sphere(pair.radius, distance, select(0.0lf, pair.index, found.through));
    let turn = turn_of(sphere, at);
    var path = REFLECTED;
    if found.through {
        path = select(select(PARAXIAL, MARGINAL, turn.rate > 0.0lf), CROSSED, turn.angle.sine > 0.0lf);
    }
    let outward = kept3(end - pair.offset) / pair.emitter_radius;
    let leaving = kept(-dot_unfused(outward, end) / distance.y);
    let arriving = -dot_unfused(outward, vec3<f64>(found.toward_emitter));
    let rate = caustic_rate(found.at, found.emitter, caster, path);
    let cone = f64(pair.cone.pdf);
    let both = kept(kept(kept(rate * cone) * leaving) * spread_of(sphere, at, turn));
    let density = kept(both / arriving);
    // Mirrored light that is sampled is not left to chance.
    var passing = 1.0lf;
    if found.through || !has(MIRRORED_LIGHT) {
        passing = fresnel_factor(at.cosine, pair.index, found.through);
    }
    let own = kept(f64(found.pdf) * passing);
    if leaving > 0.0lf && arriving > 0.0lf && density > 0.0lf {
        let ratio = kept(density / own);
        return f32(1.0lf / kept(1.0lf + kept(ratio * ratio)));
    }
    return 1.0;
}
