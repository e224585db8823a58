// Suns and emissive spheres that smooth surfaces mirror: `integrator/mirrored_light.rs`. The first slot of a path's shadow
// rays is that of its light sample; those of suns follow, and one of an emissive sphere: of those in a direction, the
// nearest occludes the others.

// A direction that a smooth surface mirrors.
struct Mirror {
    // Where the mirrored ray leaves the surface, which is that of a sphere or the ground.
    point: vec3<f32>,
    hit: u32,
    toward: vec3<f32>,
    // What the path carries of light from there; 0 if there is no mirror.
    factor: vec3<f32>,
    // The bounce before.
    previous: u32,
}

fn no_mirror() -> Mirror {
    let none = vec3<f32>(0.0);
    return Mirror(none, MISS, none, none, CAMERA);
}

// Writes the shadow rays toward the lights in a mirrored direction. False if the device does not know which.
fn mirror_lights(path: u32, mirror: Mirror) -> bool {
    var nearest = INFINITELY_FAR;
    var goal = MISS;
    var nearest_light = vec3<f32>(0.0);
    for (var light = 0u; light < job.suns + job.emitters; light++) {
        let is_sun = light < job.suns;
        var radiance = vec3<f32>(0.0);
        var emitter = light - job.suns;
        var end = mirror.toward;
        var sphere = MISS;
        var t = INFINITELY_FAR;
        if is_sun {
            if !sun_is_toward(light, mirror.toward) {
                continue;
            }
            radiance = sun_radiance(light);
            emitter = emitter_of_sun(light);
        } else {
            sphere = light_rows[emitter].w;
            if sphere == mirror.hit || !is_outside(mirror.point, sphere) {
                continue;
            }
            let ahead = sphere_ahead(mirror.point, mirror.toward, sphere);
            if !ahead.known {
                return false;
            }
            if !ahead.meets {
                continue;
            }
            radiance = light_vector(emitter);
            t = ahead.t;
            end = keep3(mirror.point + scaled(mirror.toward, f32(t)));
        }
        var carried = keep3(mirror.factor * radiance);
        if CAUSTICS {
            carried = scaled(carried, mirrored_weight(path, mirror.hit, mirror.previous, emitter, end, mirror.toward));
        }
        if !(0.0 < greatest_of(carried)) {
            continue;
        }
        if is_sun {
            write_mirrored(path, 1u + light, mirror, carried, t, MISS);
            continue;
        }
        if goal != MISS {
            // Too close to each other for the order of rounded distances.
            if abs(t - nearest) < kept(nearest * 0x1p-20lf) {
                return false;
            }
            paths[path].w += SHADOW_RAY;
        }
        if t < nearest {
            nearest = t;
            goal = sphere;
            nearest_light = carried;
        }
    }
    if goal != MISS {
        write_mirrored(path, 1u + job.suns, mirror, nearest_light, nearest, goal);
    }
    return true;
}

fn write_mirrored(path: u32, slot: u32, mirror: Mirror, light: vec3<f32>, t: f64, goal: u32) {
    let row = path + slot * params.count;
    write_segment(path, row, mirror.point, mirror.toward, light, vec2<u32>(mirror.hit, goal), t);
}
