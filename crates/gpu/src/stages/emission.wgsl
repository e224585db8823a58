// The light of the environment, of suns and of emissive spheres that paths reach: `integrator/emission.rs`.

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

// The weight of a sun or an emissive sphere, by its number among those that are sampled, that a path has found from its last
// point, at a point or in a direction; MISS for a sphere that is not sampled.
fn light_weight(path: u32, number: u32, is_sun: bool, sphere: u32, end: vec3<f32>, previous: u32) -> f32 {
    let point = ray_origin(path);
    if !light_sampled(previous) {
        let mirrored = mirrored_light_sampled(previous);
        if mirrored && (is_sun || (number != MISS && is_outside(point, sphere))) {
            return 0.0;
        }
        if !CAUSTICS {
            return 1.0;
        }
        var emitter = number;
        if is_sun {
            emitter = emitter_of_sun(number);
        }
        return chain_weight(path, emitter, end);
    }
    var light = number;
    var pdf = 0.0;
    if is_sun {
        light = job.emitters + job.points + number;
        pdf = sun_pdf(number);
    } else {
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
        pdf = seen.cone.pdf;
    }
    let probability = light_probability(point, states[path].normal, light);
    return power_heuristic(previous_density(previous), keep(probability * pdf));
}

// The light of the environment along a ray that leaves the scene.
fn environment_light(path: u32, previous: u32) -> vec3<f32> {
    let direction = ray_direction(path);
    let own = ray_own(path);
    // Glass shows the background, too.
    if has(BACKGROUND) && specular_only(previous) && own != MISS && material_kind(material_at(own)) == DIELECTRIC {
        return vector32(job.background);
    }
    if has(ILLUMINATES) || specular_only(previous) {
        return scaled(environment_radiance(direction), sky_weight(path, direction, previous));
    }
    return vec3<f32>(0.0);
}

// The light that a path carries of the surface that it has hit, or of what is around the scene: of the environment and
// the suns.
fn reached_light(path: u32, surface: ptr<function, Surface>, state: PathState) -> vec3<f32> {
    let escaped = (*surface).hit == MISS;
    let previous = state.previous;
    if escaped && params.bounce == 0u && has(BACKGROUND) {
        return keep3(state.throughput * vector32(job.background));
    }
    var light = vec3<f32>(0.0);
    // An emissive sphere counts as one sun.
    var count = 1u;
    if escaped {
        light = environment_light(path, previous);
        count = select(job.suns, 0u, after_diffuse(previous));
    }
    let direction = ray_direction(path);
    for (var sun = 0u; sun < count; sun++) {
        if escaped && !sun_is_toward(sun, direction) {
            continue;
        }
        var number = sun;
        var end = direction;
        if !escaped {
            number = emitter_number((*surface).hit);
            end = (*surface).point;
        }
        let weight = light_weight(path, number, escaped, (*surface).hit, end, previous);
        if !escaped {
            let radiance = material_color(material_at((*surface).hit), 3u);
            return scaled(keep3(state.throughput * radiance), weight);
        }
        light = keep3(light + scaled(sun_radiance(sun), weight));
    }
    return keep3(state.throughput * light);
}
