// Diffuse surfaces: `shade/lambertian.rs`.

fn lambertian_pdf(incoming: vec3<f32>) -> f32 {
    return keep(FRAC_1_PI * max(incoming.z, 0.0));
}
