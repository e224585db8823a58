// Trigonometric functions of angles in turns: `sampling/angles.rs`.

const ROUNDER: f32 = 12582912.0;
const TAN_PI_8: f32 = 0.41421357;
const FRAC_PI_2: f32 = 0x1.921fb6p+0f;
const TURNS_PER_RADIAN: f32 = 0x1.45f306p-3f;

fn sine_cosine(turns: f32) -> vec2<f32> {
    let quarters = keep(abs(turns) * 4.0);
    let quadrant = keep(keep(quarters + ROUNDER) - ROUNDER);
    let both = octant_sine_cosine(keep(keep(quarters - quadrant) * FRAC_PI_2));
    let swapped = (0.5 < quadrant && quadrant < 1.5) || (2.5 < quadrant && quadrant < 3.5);
    var result = select(both, both.yx, swapped);
    if 1.5 < quadrant && quadrant < 3.5 {
        result.x = -result.x;
    }
    if 0.5 < quadrant && quadrant < 2.5 {
        result.y = -result.y;
    }
    if is_negative(turns) {
        result.x = -result.x;
    }
    return result;
}

fn is_negative(x: f32) -> bool {
    return (bitcast<u32>(x) >> 31u) != 0u;
}

fn arc_tangent(tangent: f32) -> f32 {
    let s = keep(tangent * tangent);
    let series = mul_add(mul_add(mul_add(8.0537445e-2, s, -0.13877686), s, 0.1997771), s, -0.3333295);
    return mul_add(keep(series * s), tangent, tangent);
}

// The angle from the x axis to a point.
fn turns_of(y: f32, x: f32) -> f32 {
    let across = abs(x);
    let up = abs(y);
    let less = min(across, up);
    let greater = max(across, up);
    let far = keep(greater * TAN_PI_8) < less;
    let numerator = select(less, keep(less - greater), far);
    let denominator = select(greater, keep(less + greater), far);
    var tangent = 0.0;
    if 0.0 < denominator {
        tangent = quotient(numerator, denominator);
    }
    var turns = mul_add(arc_tangent(tangent), TURNS_PER_RADIAN, select(0.0, 0.125, far));
    if across < up {
        turns = keep(0.25 - turns);
    }
    if is_negative(x) {
        turns = keep(0.5 - turns);
    }
    if is_negative(y) {
        turns = keep(1.0 - turns);
    }
    return turns;
}
