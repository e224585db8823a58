// Tests a sphere in double precision, by what `sphere_terms.wgsl` calls clear.

// The bound of the relative error of clear distances.
const DISTANCE_ERROR: f64 = 0x1p-18lf;
// More than what conversion to single precision takes.
const LESS: f32 = 1.0 - 0x1p-21f;
const MORE: f32 = 1.0 + 0x1p-21f;

fn test_sphere(ray: ptr<function, Ray>, search: ptr<function, Search>, row: u32) {
    let bits = sphere_row(row);
    if (bits.w & NEVER_HIT) != 0u {
        return;
    }
    let radius = f64(bitcast<f32>(bits.w));
    let origin = vec3<f64>((*ray).origin);
    let direction = vec3<f64>((*ray).direction);
    let center = vec3<f64>(bitcast<vec3<f32>>(bits.xyz));
    let terms = sphere_terms(origin, direction, center, radius);
    let is_clear = is_chord_clear(terms);
    if is_clear && terms.chord2 < 0.0 {
        return;
    }
    // Points of surfaces are rounded.
    let error = select(rounding_of(origin), 0.0lf, (*ray).own == MISS);
    let apart = is_apart(terms, radius, error);
    let ahead = error_of_b(terms);
    let outside = terms.outside > 0.0;
    if apart && outside && terms.b < -ahead {
        return;
    }
    // No hit is nearer than the surface, less what rounding takes.
    let distance = sqrt(terms.distance2);
    let gap = kept(kept(distance - radius) - kept(PRODUCT_ERROR * kept(distance + radius)));
    let nearest = f32(max(gap, 0.0lf) / sqrt(terms.a)) * LESS;
    if nearest > (*search).t_far {
        return;
    }
    if is_same(bits, row, (*ray).own) || is_same(bits, row, (*ray).goal) {
        return;
    }
    if !is_clear || !apart || (outside && terms.b <= ahead) {
        (*search).others = min((*search).others, nearest);
        return;
    }
    let t = distance_of(terms);
    let near = f32(kept(t * (1.0lf - DISTANCE_ERROR))) * LESS;
    let far = f32(kept(t * (1.0lf + DISTANCE_ERROR))) * MORE;
    if near > (*search).t_far {
        return;
    }
    keep_hit(search, row, near, far);
}
