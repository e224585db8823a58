// A diffuse base under a smooth coat: `shade/plastic.rs`. The numbers are the coat's index of refraction, and the share
// of diffuse light that it reflects back down.

fn set_plastic(bsdf: ptr<function, Bsdf>, material: u32, color: vec3<f32>) {
    let ior = (*bsdf).numbers.x;
    let albedo = keep3(material_color(material, 2u) * color);
    let scale = keep(ior * ior);
    let left = scaled(keep3(1.0 - scaled(albedo, (*bsdf).numbers.y)), scale);
    (*bsdf).color = vec3<f32>(
        quotient(albedo.x, left.x),
        quotient(albedo.y, left.y),
        quotient(albedo.z, left.z),
    );
}

// The reflectance of the coat.
fn plastic_coat(bsdf: ptr<function, Bsdf>, cosine: f32) -> f32 {
    return keep(f32(fresnel_dielectric(f64(cosine), 1.0 / f64((*bsdf).numbers.x)).reflected));
}

// The probability of the mirrored direction.
fn plastic_mirrored_probability(bsdf: ptr<function, Bsdf>, coat: f32) -> f32 {
    let base = keep(keep(1.0 - coat) * greatest_of((*bsdf).color));
    let sum = max(keep(coat + base), LEAST_NORMAL);
    return keep(1.0 - quotient(base, sum));
}

fn plastic_eval(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, incoming: vec3<f32>) -> vec3<f32> {
    let cosine = max(incoming.z, 0.0);
    let passes = keep(keep(1.0 - plastic_coat(bsdf, outgoing.z)) * keep(1.0 - plastic_coat(bsdf, cosine)));
    return scaled((*bsdf).color, keep(keep(passes * FRAC_1_PI) * cosine));
}

fn plastic_pdf(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, incoming: vec3<f32>) -> f32 {
    let base = keep(1.0 - plastic_mirrored_probability(bsdf, plastic_coat(bsdf, outgoing.z)));
    return keep(keep(base * FRAC_1_PI) * max(incoming.z, 0.0));
}

fn plastic_sample(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, direction: vec2<f32>, choice: f32) -> Scatter {
    let coat = plastic_coat(bsdf, outgoing.z);
    let mirrored = plastic_mirrored_probability(bsdf, coat);
    if choice < mirrored {
        return Scatter(mirror(outgoing), vec3<f32>(quotient(coat, max(mirrored, LEAST_NORMAL))), 0.0);
    }
    let incoming = cosine_hemisphere(direction);
    let below = max(keep(1.0 - mirrored), LEAST_NORMAL);
    let passes = keep(keep(1.0 - coat) * keep(1.0 - plastic_coat(bsdf, incoming.z)));
    let weight = scaled((*bsdf).color, quotient(passes, below));
    return Scatter(incoming, weight, keep(keep(keep(1.0 - mirrored) * FRAC_1_PI) * incoming.z));
}
