// The light of the environment and of the sun that paths reach: `integrator/emission.rs`.

// The light of a ray that leaves the scene.
fn escaped_light(direction: vec3<f32>, previous: u32) -> vec3<f32> {
    if params.bounce == 0u && has(BACKGROUND) {
        return vector32(job.background);
    }
    var light = vec3<f32>(0.0);
    if has(ILLUMINATES) || specular_only(previous) {
        light = environment_radiance(direction);
    }
    if after_diffuse(previous) || mirrored_light_sampled(previous) || !sun_is_toward(direction) {
        return light;
    }
    var weight = 1.0;
    if light_sampled(previous) {
        weight = power_heuristic(previous_density(previous), job.sun_pdf);
    }
    return keep3(light + scaled(vector32(job.sun_radiance), weight));
}
