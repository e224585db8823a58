// Next rays of paths, which the kernels of bounces write.

fn go_on(path: u32) {
    let place = atomicAdd(&next_queue[3], 1u);
    if place % 64u == 0u {
        atomicAdd(&next_queue[0], 1u);
    }
    atomicStore(&next_queue[QUEUE_HEAD + place], path);
}

// Replaces a path's ray by one from a surface, which may go through the inside of the surface's sphere.
fn write_next_ray(path: u32, surface: ptr<function, Surface>, direction: vec3<f32>, inside: bool) {
    var chord = INFINITELY_FAR;
    if inside {
        chord = chord_length((*surface).normal, (*surface).radius, direction);
    }
    let ground = cross_ground((*surface).point, direction, (*surface).hit);
    write_ray(path, (*surface).point, direction, (*surface).hit, bounds_before(ground, chord));
    states[path].inside = select(0u, 1u, inside);
    states[path].entry = (*surface).normal;
    paths[path].w += BOUNCE_RAY;
    go_on(path);
}

// True if a surface is on the inside of a sphere.
fn is_within(surface: ptr<function, Surface>) -> bool {
    return (*surface).inside && (*surface).hit != GROUND;
}

// True if a sphere hides a light from its own inside.
fn hides_itself(surface: ptr<function, Surface>, direction: vec3<f32>, t: f64) -> bool {
    return is_within(surface) && chord_length((*surface).normal, (*surface).radius, direction) < t;
}
