// Light samples: `integrator/direct_light.rs`, and the only light, `world/lights/sun.rs`.

fn power_heuristic(found: f32, other: f32) -> f32 {
    let ratio = quotient(other, found);
    return quotient(1.0, mul_add(ratio, ratio, 1.0));
}

// A direction toward the sun.
fn sample_sun(u: vec2<f32>) -> vec3<f32> {
    if !has(SUN_DISC) {
        return vector32(job.sun_direction);
    }
    let basis = Basis(vector32(job.sun_tangent), vector32(job.sun_bitangent), vector32(job.sun_direction));
    return to_world(basis, cap(u, job.sun_height));
}

// True if the disc is visible in a direction.
fn sun_is_toward(direction: vec3<f32>) -> bool {
    let offset = keep3(direction - vector32(job.sun_direction));
    let squares = keep3(offset * offset);
    let height = keep(keep(squares.x + squares.y) + squares.z) / 2.0;
    return has(SUN_DISC) && height <= job.sun_height;
}

// What a light sample adds if nothing is between: BSDF times throughput, weight and radiance.
fn sun_light(
    bsdf: ptr<function, Bsdf>,
    throughput: vec3<f32>,
    outgoing: vec3<f32>,
    incoming: vec3<f32>,
) -> vec3<f32> {
    var response = bsdf_eval(bsdf, outgoing, incoming);
    if !is_diffuse(bsdf) && has(SUN_DISC) {
        response = scaled(response, power_heuristic(job.sun_pdf, bsdf_pdf(bsdf, outgoing, incoming)));
    }
    return keep3(keep3(throughput * response) * vector32(job.sun_weight));
}
