// What a path carries from bounce to bounce: `integrator/path_state.rs`.

struct PathState {
    throughput: vec3<f32>,
    // The density of the ray's direction, in bits: negative after a diffuse surface, infinite from the camera or a
    // specular surface, and negative as well if the path has met only specular surfaces. The largest finite values
    // stand for infinite ones where a specular surface has sampled the lights in the mirrored direction.
    previous: u32,
    // The normal of the last surface, where the choice of a light depends on it.
    normal: vec3<f32>,
    // 1 if the ray is inside of the glass sphere on which it starts, and the normal where it entered.
    inside: u32,
    entry: vec3<f64>,
}

const SIGN: u32 = 0x80000000u;
const INFINITE: u32 = 0x7f800000u;
const LARGEST: u32 = 0x7f7fffffu;
const CAMERA: u32 = SIGN | INFINITE;

fn light_sampled(previous: u32) -> bool {
    return (previous & ~SIGN) < LARGEST;
}

fn after_diffuse(previous: u32) -> bool {
    return light_sampled(previous) && (previous & SIGN) != 0u;
}

fn specular_only(previous: u32) -> bool {
    return !light_sampled(previous) && (previous & SIGN) != 0u;
}

fn mirrored_light_sampled(previous: u32) -> bool {
    return (previous & ~SIGN) == LARGEST;
}

// Where a light sample could have found the direction.
fn previous_density(previous: u32) -> f32 {
    return bitcast<f32>(previous & ~SIGN);
}

fn with_mirrored_light(previous: u32) -> u32 {
    return (previous & SIGN) | min(previous & ~SIGN, LARGEST);
}

// After one more bounce with this density, 0 for specular ones.
fn next_bounce(previous: u32, density: f32, diffuse: bool) -> u32 {
    if 0.0 < density {
        return bitcast<u32>(density) | select(0u, SIGN, diffuse);
    }
    return INFINITE | select(0u, SIGN, specular_only(previous));
}
