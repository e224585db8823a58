// Light samples: `integrator/direct_light.rs`.

fn sample_light(point: vec3<f32>, normal: vec3<f32>, own: u32, numbers: vec4<f32>) -> LightSample {
    let choice = choose_light(point, normal, light_draw(numbers));
    let u = numbers.xy;
    var sample = no_light();
    if choice.light < job.emitters {
        sample = sample_sphere_light(point, own, choice.light, u);
    } else if choice.light < job.emitters + job.points {
        sample = sample_point_light(point, choice.light - job.emitters);
    } else if choice.light < job.emitters + job.points + job.suns {
        sample = sample_sun(choice.light - job.emitters - job.points, u);
    } else {
        sample = sample_sky(choice.light - job.emitters - job.points - job.suns, u);
    }
    if has(LIGHT_TREE) || has(LIGHT_TABLE) {
        sample.weight = quotients(sample.weight, choice.probability);
        sample.pdf = keep(sample.pdf * choice.probability);
    }
    return sample;
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
