// Intersections with the ground plane: `trace/ground.rs` and `Plane::crossed` of spherule-core.

// More than any distance at which anything occludes.
const INFINITELY_FAR: f64 = 0x1p200lf;

struct Crossing {
    crossed: bool,
    t: f64,
}

fn cross_ground(origin: vec3<f32>, direction: vec3<f32>, own: u32) -> Crossing {
    if !has(HAS_GROUND) || own == GROUND {
        return Crossing(false, 0.0);
    }
    let normal = vector64(job.ground_normal);
    let start = vec3<f64>(origin);
    let above = kept(dot_unfused(normal, start) - job.ground_height);
    let descent = -dot_unfused(normal, vec3<f64>(direction));
    let origin_error = select(rounding_of(start), 0.0lf, own == MISS);
    let apart = origin_error < abs(above);
    if descent == 0.0 {
        return Crossing(false, 0.0);
    }
    let t = above / descent;
    return Crossing(select(descent > 0.0, t > 0.0, apart), max(t, 0.0));
}

// Finite numbers around a distance at which a search ends.
fn bounds_around(t: f64) -> vec2<f32> {
    let near = f32(t);
    let bits = bitcast<u32>(near);
    let low = select(near, bitcast<f32>(max(bits, 1u) - 1u), f64(near) > t);
    let high = select(near, bitcast<f32>(bits + 1u), f64(near) < t);
    return vec2<f32>(select(min(low, FAR), -1.0, low < 1.0 / FAR), clamp(high, 1.0 / FAR, FAR));
}

// Finite numbers around the lesser of the distance at which a search ends and that of the ground.
fn bounds_before(ground: Crossing, t: f64) -> vec2<f32> {
    let end = select(t, min(ground.t, t), ground.crossed);
    if end < f64(FAR) {
        return bounds_around(end);
    }
    return vec2<f32>(FAR);
}
