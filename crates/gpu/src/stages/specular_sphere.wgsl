// Paths of light between two points by a sphere: `world/caustics/specular_sphere.rs`.

const NEWTON_STEPS: u32 = 24u;
// Tolerance of the turn, in radians: 1e-11.
const TURN_RESOLVED: f64 = 0x1.5fd7fe1796495p-37lf;

struct Angle {
    sine: f64,
    cosine: f64,
}

struct SpecularSphere {
    radius: f64,
    // Distances of the receiver and of the emitter's point.
    distance: vec2<f64>,
    // Index of refraction outside over that inside; 0 for a reflection.
    index: f64,
    // Radius over distance, and 1 minus its square.
    ratio: vec2<f64>,
    gap: vec2<f64>,
    index_gap: f64,
}

struct Deflection {
    angle: Angle,
    // Sine of the turn over the sine of the incidence.
    gain: f64,
    // Derivative of the turn by the incidence.
    rate: f64,
    // Cosines of the ray to the axes from receiver and emitter.
    slope: vec2<f64>,
}

fn minus_angle(a: Angle, b: Angle) -> Angle {
    return Angle(
        kept(kept(a.sine * b.cosine) - kept(a.cosine * b.sine)),
        kept(kept(a.cosine * b.cosine) + kept(a.sine * b.sine)),
    );
}

// Subtracts a small angle in radians, or a little less.
fn less_angle(a: Angle, step: f64) -> Angle {
    let half = kept(step * 0.5lf);
    let square = kept(half * half);
    let scale = kept(1.0lf / kept(1.0lf + square));
    return minus_angle(a, Angle(kept(step * scale), kept(kept(1.0lf - square) * scale)));
}

fn gap_of(distance: f64, radius: f64, ratio: f64) -> f64 {
    return kept(kept(kept(distance - radius) / distance) * kept(1.0lf + ratio));
}

fn specular_sphere(radius: f64, distance: vec2<f64>, index: f64) -> SpecularSphere {
    let ratio = vec2<f64>(kept(radius / distance.x), kept(radius / distance.y));
    let gap = vec2<f64>(gap_of(distance.x, radius, ratio.x), gap_of(distance.y, radius, ratio.y));
    return SpecularSphere(radius, distance, index, ratio, gap, kept(1.0lf - kept(index * index)));
}

fn turn_of(sphere: SpecularSphere, at: Angle) -> Deflection {
    let sine2 = kept(at.sine * at.sine);
    let cosine2 = kept(at.cosine * at.cosine);
    let k = sphere.ratio.x;
    let l = sphere.ratio.y;
    let m = sphere.index;
    let a = kept(sqrt(kept(cosine2 + kept(sphere.gap.x * sine2))));
    let b = kept(sqrt(kept(cosine2 + kept(sphere.gap.y * sine2))));
    let w = kept(sqrt(kept(cosine2 + kept(sphere.index_gap * sine2))));
    let ab = kept(a * b);
    let ends_cosine = kept(kept(kept(k * l) * sine2) - ab);
    let ends = kept(kept(k * b) + kept(l * a));
    let half = kept(kept(m * at.cosine) - w);
    let up = kept(kept(m * sine2) + kept(at.cosine * w));
    let both = kept(kept(kept(half * half) * sine2) - kept(up * up));
    let first = kept(kept(kept(2.0lf * ends_cosine) * half) * up);
    let gain = kept(first + kept(ends * both));
    let second = kept(kept(kept(kept(2.0lf * ends) * half) * up) * sine2);
    let turned = kept(kept(ends_cosine * both) - second);
    let scale = kept(at.cosine / kept(ab * w));
    let slower = kept(kept(ends * w) + kept(kept(2.0lf * m) * ab));
    let rate = kept(2.0lf - kept(scale * slower));
    return Deflection(Angle(kept(gain * at.sine), turned), gain, rate, vec2<f64>(a, b));
}

struct Incidence {
    at: Angle,
    found: bool,
}

// The incidence at which a ray turns by `turn`.
fn find_incidence(sphere: SpecularSphere, turn: Angle, inner: bool) -> Incidence {
    var at = Angle(1.0lf, 0.0lf);
    var sign = 1.0lf;
    if inner {
        at = Angle(0.0lf, 1.0lf);
        sign = -1.0lf;
    }
    for (var step = 0u; step < NEWTON_STEPS; step++) {
        let here = turn_of(sphere, at);
        let rest = minus_angle(here.angle, turn);
        let near = abs(rest.sine) < TURN_RESOLVED && 0.0lf < rest.cosine;
        let this_side = !(at.sine < 0.0lf);
        if near && this_side {
            return Incidence(at, true);
        }
        let ahead = 0.0lf < rest.sine && 0.0lf < kept(here.rate * sign) && this_side;
        if !ahead || near {
            break;
        }
        let bound = kept(kept(2.0lf + rest.cosine) * here.rate);
        at = less_angle(at, kept(kept(3.0lf * rest.sine) / bound));
    }
    return Incidence(at, false);
}

fn spread_of(sphere: SpecularSphere, at: Angle, turn: Deflection) -> f64 {
    let across = kept(sphere.distance.x / sphere.radius);
    let rate = abs(kept(turn.gain * turn.rate));
    let ends = kept(kept(kept(kept(across * across) * rate) * turn.slope.x) * turn.slope.y);
    return kept(ends / at.cosine);
}
