// Light samples: `integrator/direct_light.rs`.

fn power_heuristic(found: f32, other: f32) -> f32 {
    let ratio = quotient(other, found);
    return quotient(1.0, mul_add(ratio, ratio, 1.0));
}

// What a light sample adds if nothing is between: BSDF times throughput, weight and radiance.
fn direct_light(
    bsdf: ptr<function, Bsdf>,
    throughput: vec3<f32>,
    outgoing: vec3<f32>,
    incoming: vec3<f32>,
    sample: ptr<function, LightSample>,
) -> vec3<f32> {
    var response = bsdf_eval(bsdf, outgoing, incoming);
    // Light that BSDF samples may find as well.
    let both = select(0.0 < (*sample).pdf, (*sample).close, is_diffuse(bsdf));
    if both {
        response = scaled(response, power_heuristic((*sample).pdf, bsdf_pdf(bsdf, outgoing, incoming)));
    }
    return keep3(keep3(throughput * response) * (*sample).weight);
}
