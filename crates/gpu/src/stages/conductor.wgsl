// Metals: `shade/conductor.rs`. The numbers are GGX's alpha, the weight of Schlick's approximation, and 1 if the metal
// has an index of refraction.

fn set_conductor(bsdf: ptr<function, Bsdf>, material: u32, color: vec3<f32>) {
    if (*bsdf).numbers.z > 0.0 {
        (*bsdf).eta = material_color(material, 3u);
        (*bsdf).k = material_color(material, 4u);
        (*bsdf).tint = keep3(material_color(material, 5u) * color);
    } else {
        (*bsdf).color = keep3(material_color(material, 2u) * color);
    }
}

// The reflectance at a cosine between direction and facet.
fn conductor_reflectance(bsdf: ptr<function, Bsdf>, cosine: f32) -> vec3<f32> {
    let rise = keep(schlick_rise(cosine) * (*bsdf).numbers.y);
    let color = (*bsdf).color;
    var all = keep3(color + scaled(keep3(1.0 - color), rise));
    if (*bsdf).numbers.z > 0.0 {
        let eta = (*bsdf).eta;
        let k = (*bsdf).k;
        let c = f64(cosine);
        let share = vec3<f32>(
            f32(fresnel_conductor(c, f64(eta.x), f64(k.x))),
            f32(fresnel_conductor(c, f64(eta.y), f64(k.y))),
            f32(fresnel_conductor(c, f64(eta.z), f64(k.z))),
        );
        all = keep3(all + keep3(share * (*bsdf).tint));
    }
    return min(all, vec3<f32>(1.0));
}

fn conductor_eval(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, incoming: vec3<f32>) -> vec3<f32> {
    let alpha = (*bsdf).numbers.x;
    if !(0.0 < alpha && 0.0 < incoming.z) {
        return vec3<f32>(0.0);
    }
    let normal = upward(keep3(outgoing + incoming));
    let both = keep(smith_lambda(alpha, outgoing) + smith_lambda(alpha, incoming));
    let facets = facet_distribution(alpha, normal);
    let response = quotient(facets, keep(keep(1.0 + both) * keep(4.0 * outgoing.z)));
    return scaled(conductor_reflectance(bsdf, dot_fused(outgoing, normal)), response);
}

fn conductor_pdf(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, incoming: vec3<f32>) -> f32 {
    let alpha = (*bsdf).numbers.x;
    if !(0.0 < alpha && 0.0 < incoming.z) {
        return 0.0;
    }
    let normal = upward(keep3(outgoing + incoming));
    return quotient(visible_normal_pdf(alpha, outgoing, normal), keep(4.0 * dot_fused(outgoing, normal)));
}

fn conductor_sample(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, direction: vec2<f32>) -> Scatter {
    let alpha = (*bsdf).numbers.x;
    if alpha <= 0.0 {
        return Scatter(mirror(outgoing), conductor_reflectance(bsdf, outgoing.z), 0.0);
    }
    let normal = sample_visible_normal(alpha, outgoing, direction);
    let cosine = dot_fused(outgoing, normal);
    let incoming = normalized(keep3(scaled(normal, keep(cosine + cosine)) - outgoing));
    let seen = keep(1.0 + smith_lambda(alpha, outgoing));
    let both = keep(seen + smith_lambda(alpha, incoming));
    var share = 0.0;
    if 0.0 < incoming.z && 0.0 < cosine {
        share = quotient(seen, both);
    }
    let density = quotient(visible_normal_pdf(alpha, outgoing, normal), keep(4.0 * cosine));
    return Scatter(incoming, scaled(conductor_reflectance(bsdf, cosine), share), max(density, LEAST_NORMAL));
}
