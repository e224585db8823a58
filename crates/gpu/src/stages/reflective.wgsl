// A diffuse and a mirror share: `shade/reflective.rs`. The numbers are both, and the probability of the mirror.

fn reflective_density(bsdf: ptr<function, Bsdf>, cosine: f32) -> f32 {
    return keep(keep(keep(1.0 - (*bsdf).numbers.z) * FRAC_1_PI) * cosine);
}

fn reflective_eval(bsdf: ptr<function, Bsdf>, incoming: vec3<f32>) -> vec3<f32> {
    let share = keep(keep((*bsdf).numbers.x * FRAC_1_PI) * max(incoming.z, 0.0));
    return scaled((*bsdf).color, share);
}

fn reflective_sample(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, direction: vec2<f32>, choice: f32) -> Scatter {
    let weight = scaled((*bsdf).color, keep((*bsdf).numbers.x + (*bsdf).numbers.y));
    if choice < (*bsdf).numbers.z {
        return Scatter(mirror(outgoing), weight, 0.0);
    }
    let incoming = cosine_hemisphere(direction);
    return Scatter(incoming, weight, reflective_density(bsdf, incoming.z));
}
