// Suns and emissive spheres that smooth surfaces mirror: `integrator/mirrored_light.rs`. The first slot of a path's shadow
// rays is that of its light sample; those of suns follow, and one of an emissive sphere: of those in a direction, the
// nearest occludes the others.

// Writes the shadow rays toward the lights in a mirrored direction, which bring this part of their radiance, beside
// caustic samples at the bounce before, which was this one. False if the device does not know which.
fn mirror_lights(
    path: u32,
    surface: ptr<function, Surface>,
    toward: vec3<f32>,
    factor: vec3<f32>,
    previous: u32,
) -> bool {
    for (var sun = 0u; sun < job.suns; sun++) {
        if !sun_is_toward(sun, toward) {
            continue;
        }
        var light = keep3(factor * sun_radiance(sun));
        if CAUSTICS {
            light = scaled(light, mirrored_weight(path, (*surface).hit, previous, emitter_of_sun(sun), toward, toward));
        }
        if 0.0 < greatest_of(light) {
            write_shadow_ray(path, 1u + sun, surface, toward, light, INFINITELY_FAR, MISS);
        }
    }
    var nearest = INFINITELY_FAR;
    var goal = MISS;
    var nearest_light = vec3<f32>(0.0);
    for (var emitter = 0u; emitter < job.emitters; emitter++) {
        let sphere = light_rows[emitter].w;
        if sphere == (*surface).hit || !is_outside((*surface).point, sphere) {
            continue;
        }
        let ahead = sphere_ahead((*surface).point, toward, sphere);
        if !ahead.known {
            return false;
        }
        if !ahead.meets {
            continue;
        }
        var light = keep3(factor * light_vector(emitter));
        if CAUSTICS {
            let end = keep3((*surface).point + scaled(toward, f32(ahead.t)));
            light = scaled(light, mirrored_weight(path, (*surface).hit, previous, emitter, end, toward));
        }
        if !(0.0 < greatest_of(light)) {
            continue;
        }
        if goal != MISS {
            // Too close to each other for the order of rounded distances.
            if abs(ahead.t - nearest) < kept(nearest * 0x1p-20lf) {
                return false;
            }
            paths[path].w += SHADOW_RAY;
        }
        if ahead.t < nearest {
            nearest = ahead.t;
            goal = sphere;
            nearest_light = light;
        }
    }
    if goal != MISS {
        write_shadow_ray(path, 1u + job.suns, surface, toward, nearest_light, nearest, goal);
    }
    return true;
}
