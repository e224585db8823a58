// Connections of a receiver and a point of an emitter by a specular sphere: `world/caustics/connection.rs`.

// Sine below which two directions from the center define no plane: 1e-12.
const LEAST_PLANE_SINE: f64 = 0x1.19799812dea11p-40lf;

// Points are relative to the sphere's center.
struct Connection {
    found: bool,
    toward: vec3<f64>,
    exit: vec3<f64>,
    toward_emitter: vec3<f64>,
    // Lengths of both segments.
    length: vec2<f64>,
    // Angle of incidence.
    at: Angle,
    // Area across the ray at the emitter per steradian at the receiver, over the squared distance of the emitter.
    spread: f64,
}

fn connect(radius: f64, index: f64, receiver: vec3<f64>, emitter: vec3<f64>, path: u32) -> Connection {
    let through = path != REFLECTED;
    let crosses = path == CROSSED;
    let distance = vec2<f64>(
        kept(sqrt(dot_unfused(receiver, receiver))),
        kept(sqrt(dot_unfused(emitter, emitter))),
    );
    let u = kept3(receiver * kept(1.0lf / distance.x));
    let v = kept3(emitter * kept(1.0lf / distance.y));
    let cosine = dot_unfused(u, v);
    let across = kept3(v - kept3(u * cosine));
    let sine = kept(sqrt(dot_unfused(across, across)));
    let stays = select(cosine, -cosine, through);
    let turn = Angle(select(sine, -sine, through && !crosses), stays);
    let least = kept(1.0lf - kept(kept(2.0lf * index) * index));
    let edge = select(least, -least, crosses);
    let reachable = !through || edge < stays;
    let sphere = specular_sphere(radius, distance, select(0.0lf, index, through));
    let incidence = find_incidence(sphere, turn, path == PARAXIAL);
    let at = incidence.at;
    let here = turn_of(sphere, at);
    let side = kept(select(1.0lf, -1.0lf, crosses) / sine);
    let inside = kept(radius * at.cosine);
    let length = vec2<f64>(
        kept(kept(distance.x * here.slope.x) - inside),
        kept(kept(distance.y * here.slope.y) - inside),
    );
    // The angle at the center between the emitter and the point where the ray leaves the sphere.
    let ratio = sphere.ratio.y;
    let slope = here.slope.y;
    let exit_cosine = kept(kept(kept(ratio * at.sine) * at.sine) + kept(slope * at.cosine));
    let exit_sine = kept(at.sine * kept(slope - kept(ratio * at.cosine)));
    let off = kept3(kept3(u - kept3(v * cosine)) * kept(side * exit_sine));
    let exit = kept3(kept3(kept3(v * exit_cosine) + off) * radius);
    let receiver_sine = kept(sphere.ratio.x * at.sine);
    let toward = kept3(kept3(across * kept(side * receiver_sine)) - kept3(u * here.slope.x));
    return Connection(
        incidence.found && reachable && LEAST_PLANE_SINE < sine && 0.0lf < at.cosine,
        toward,
        exit,
        kept3(kept3(emitter - exit) * kept(1.0lf / length.y)),
        length,
        at,
        spread_of(sphere, at, here),
    );
}

// The fraction of light that reflection or refraction keeps, without colors.
fn fresnel_factor(cosine: f64, index: f64, through: bool) -> f64 {
    if !(0.0lf < index) {
        return 1.0lf;
    }
    let reflected = kept(fresnel_dielectric(cosine, index).reflected);
    let passing = kept(1.0lf - reflected);
    return select(reflected, kept(passing * passing), through);
}
