// Tests a sphere in double precision: `intersect/terms.rs` of spherule-core, whose bounds say what is clear.

// 2^20 times the bounds of terms.
const CLEAR_PART: f64 = 0x1p-28lf;
const CLEAR_PART_SQUARED: f64 = 0x1p-56lf;
// The bound of the relative error of clear distances.
const DISTANCE_ERROR: f64 = 0x1p-18lf;
// Far more than the relative error of scalar products.
const PRODUCT_ERROR: f64 = 0x1p-40lf;
// More than what conversion to single precision takes.
const LESS: f32 = 1.0 - 0x1p-21f;
const MORE: f32 = 1.0 + 0x1p-21f;

fn test_sphere(ray: ptr<function, Ray>, search: ptr<function, Search>, row: u32) {
    let bits = sphere_row(row);
    if (bits.w & 0x80000000u) != 0u {
        return;
    }
    let radius = f64(bitcast<f32>(bits.w));
    let origin = vec3<f64>((*ray).origin);
    let direction = vec3<f64>((*ray).direction);
    let from_center = kept3(origin - vec3<f64>(bitcast<vec3<f32>>(bits.xyz)));
    let distance2 = dot_unfused(from_center, from_center);
    let a = dot_unfused(direction, direction);
    let b = -dot_unfused(from_center, direction);
    let perpendicular = kept3(from_center + kept3(direction * (b / a)));
    let p2 = dot_unfused(perpendicular, perpendicular);
    let r2 = kept(radius * radius);
    let chord2 = kept(r2 - p2);
    let outside = kept(distance2 - r2);
    let is_clear = kept(CLEAR_PART * kept(p2 + r2)) < abs(chord2)
        && kept(kept(CLEAR_PART_SQUARED * distance2) * p2) < kept(chord2 * chord2)
        && kept(CLEAR_PART_SQUARED * distance2) < abs(chord2);
    if is_clear && chord2 < 0.0 {
        return;
    }
    // Points of surfaces are rounded.
    var error = 0.0lf;
    if (*ray).own != MISS {
        error = kept(kept(kept(abs(origin.x) + abs(origin.y)) + abs(origin.z)) * 0x1p-23lf);
    }
    let band = kept(error * kept(kept(2.0 * radius) + error));
    let apart = kept(CLEAR_PART * kept(distance2 + r2)) < abs(outside) && band < abs(outside);
    let ahead = kept(PRODUCT_ERROR * sqrt(kept(distance2 * a)));
    if apart && outside > 0.0 && b < -ahead {
        return;
    }
    let nearest = f32(max(kept(sqrt(distance2) - radius), 0.0lf) / sqrt(a)) * LESS;
    if nearest > (*search).t_far {
        return;
    }
    if is_same(bits, row, (*ray).own) || is_same(bits, row, (*ray).goal) {
        return;
    }
    if !is_clear || !apart || (outside > 0.0 && b <= ahead) {
        (*search).others = min((*search).others, nearest);
        return;
    }
    let far_end = outside < 0.0 && b >= 0.0;
    let sum = abs(b) + sqrt(kept(a * chord2));
    let t = select(abs(outside), sum, far_end) / select(sum, a, far_end);
    let near = f32(kept(t * (1.0lf - DISTANCE_ERROR))) * LESS;
    let far = f32(kept(t * (1.0lf + DISTANCE_ERROR))) * MORE;
    if near > (*search).t_far {
        return;
    }
    keep_hit(search, row, near, far);
}
