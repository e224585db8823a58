// The light of the environment, of suns and of emissive spheres that paths reach: `integrator/emission.rs`.

// The weight of a sun that a path has found in a direction, from its last point.
fn sun_weight(path: u32, sun: u32, direction: vec3<f32>, previous: u32) -> f32 {
    if mirrored_light_sampled(previous) {
        return 0.0;
    }
    if !light_sampled(previous) {
        if !CAUSTICS {
            return 1.0;
        }
        return chain_weight(path, emitter_of_sun(sun), direction);
    }
    let light = job.emitters + job.points + sun;
    let probability = light_probability(ray_origin(path), states[path].normal, light);
    return power_heuristic(previous_density(previous), keep(probability * sun_pdf(sun)));
}

// The weight of the sky's picture where a light sample may have found it, from a path's last point.
fn sky_weight(path: u32, direction: vec3<f32>, previous: u32) -> f32 {
    if job.sky_parts == 0u || !light_sampled(previous) {
        return 1.0;
    }
    let found = picture_density(direction);
    let light = job.emitters + job.points + job.suns + found.part;
    let probability = light_probability(ray_origin(path), states[path].normal, light);
    return power_heuristic(previous_density(previous), keep(found.pdf * probability));
}

// The light of a ray that leaves the scene.
fn escaped_light(path: u32, previous: u32) -> vec3<f32> {
    let direction = ray_direction(path);
    if params.bounce == 0u && has(BACKGROUND) {
        return vector32(job.background);
    }
    var light = vec3<f32>(0.0);
    if has(ILLUMINATES) || specular_only(previous) {
        light = scaled(environment_radiance(direction), sky_weight(path, direction, previous));
    }
    let own = ray_own(path);
    // Glass shows the background, too.
    if has(BACKGROUND) && specular_only(previous) && own != MISS && material_kind(material_at(own)) == DIELECTRIC {
        light = vector32(job.background);
    }
    if after_diffuse(previous) {
        return light;
    }
    for (var sun = 0u; sun < job.suns; sun++) {
        if sun_is_toward(sun, direction) {
            light = keep3(light + scaled(sun_radiance(sun), sun_weight(path, sun, direction, previous)));
        }
    }
    return light;
}

// The weight of an emissive sphere that a path has hit at a point, from its last point.
fn emitter_weight(path: u32, sphere: u32, end: vec3<f32>, previous: u32) -> f32 {
    let point = ray_origin(path);
    let number = emitter_number(sphere);
    if !light_sampled(previous) {
        if mirrored_light_sampled(previous) && number != MISS && is_outside(point, sphere) {
            return 0.0;
        }
        if !CAUSTICS {
            return 1.0;
        }
        return chain_weight(path, number, end);
    }
    if number == MISS || sphere == ray_own(path) {
        return 1.0;
    }
    let seen = view_sphere(point, sphere);
    if !seen.cone.outside {
        return 1.0;
    }
    if after_diffuse(previous) && !seen.close {
        return 0.0;
    }
    let probability = light_probability(point, states[path].normal, number);
    return power_heuristic(previous_density(previous), keep(probability * seen.cone.pdf));
}

// The light that a surface emits along the path that has hit it.
fn emitted_light(path: u32, surface: ptr<function, Surface>, state: PathState) -> vec3<f32> {
    let hit = (*surface).hit;
    let radiance = material_color(material_at(hit), 3u);
    let weight = emitter_weight(path, hit, (*surface).point, state.previous);
    return scaled(keep3(state.throughput * radiance), weight);
}
