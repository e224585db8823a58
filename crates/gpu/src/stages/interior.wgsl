// Glass spheres that contain a path: `integrator/interior.rs`.

// Spheres that a path may be in; in more it is unknown.
const NESTING: u32 = 8u;

// The spheres that contain the origin of a camera ray; on a surface its direction decides. False if they are too many.
fn begin_interiors(path: u32) -> bool {
    for (var slot = 0u; slot < NESTING; slot++) {
        interiors[NESTING * path + slot] = MISS;
    }
    let origin = vec3<f64>(ray_origin(path));
    let direction = vec3<f64>(ray_direction(path));
    for (var place = 0u; place < job.camera_glass; place++) {
        let sphere = light_word(job.camera_glass_rows, place);
        let bits = sphere_row(sphere);
        let radius = f64(bitcast<f32>(bits.w));
        let offset = kept3(origin - vec3<f64>(bitcast<vec3<f32>>(bits.xyz)));
        let outside = kept(dot_unfused(offset, offset) - kept(radius * radius));
        let inward = dot_unfused(offset, direction) < 0.0;
        if (outside < 0.0 || (outside == 0.0 && inward)) && !enter_sphere(path, sphere) {
            return false;
        }
    }
    return true;
}

fn ior_of(sphere: u32) -> f32 {
    return material_numbers(material_at(sphere)).x;
}

// The number of a sphere in the scene.
fn sphere_id(sphere: u32) -> u32 {
    return appearance[job.spheres + (sphere >> 2u)][sphere & 3u];
}

// True if sphere `a` decides the medium where it overlaps sphere `b`.
fn precedes(a: u32, b: u32) -> bool {
    let radius_a = bitcast<f32>(sphere_row(a).w);
    let radius_b = bitcast<f32>(sphere_row(b).w);
    return radius_a < radius_b || (radius_a == radius_b && sphere_id(a) < sphere_id(b));
}

// The index of refraction outside of a glass sphere, which is removed from those that contain the path; 0 if another
// sphere decides the medium on both sides.
fn outside_ior(path: u32, sphere: u32) -> f32 {
    var inner = MISS;
    for (var slot = 0u; slot < NESTING; slot++) {
        let place = NESTING * path + slot;
        let other = interiors[place];
        if other == sphere {
            interiors[place] = MISS;
        } else if other != MISS && (inner == MISS || precedes(other, inner)) {
            inner = other;
        }
    }
    if inner == MISS {
        return 1.0;
    }
    return select(0.0, ior_of(inner), precedes(sphere, inner));
}

// Adds a sphere to those that contain the path. False if they are too many.
fn enter_sphere(path: u32, sphere: u32) -> bool {
    for (var slot = 0u; slot < NESTING; slot++) {
        let place = NESTING * path + slot;
        if interiors[place] == MISS {
            interiors[place] = sphere;
            return true;
        }
    }
    return false;
}
