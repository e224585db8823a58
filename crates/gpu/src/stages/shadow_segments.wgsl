// Shadow rays, which kernels write to their columns.

// A shadow ray to a light at this distance, with the light that it carries.
fn write_shadow_ray(
    path: u32,
    slot: u32,
    surface: ptr<function, Surface>,
    direction: vec3<f32>,
    light: vec3<f32>,
    t: f64,
    goal: u32,
) {
    let ends = vec2<u32>((*surface).hit, goal);
    write_segment(path, path + slot * params.count, (*surface).point, direction, light, ends, t);
}

// A shadow ray between two spheres, in a row. The ground may be in between.
fn write_segment(
    path: u32,
    row: u32,
    point: vec3<f32>,
    direction: vec3<f32>,
    light: vec3<f32>,
    ends: vec2<u32>,
    t: f64,
) {
    paths[path].w += SHADOW_RAY;
    let ground = cross_ground(point, direction, ends.x);
    if ground.crossed && ground.t < t {
        return;
    }
    let bounds = bounds_before(Crossing(false, 0.0), t);
    let start = bitcast<vec3<u32>>(point);
    let toward = bitcast<vec3<u32>>(direction);
    shadow_rays[3u * row] = vec4<u32>(start, toward.x);
    shadow_rays[3u * row + 1u] = vec4<u32>(toward.yz, ends);
    shadow_rays[3u * row + 2u] = vec4<u32>(bitcast<vec2<u32>>(bounds), 0u, 0u);
    lights[row] = vec4<f32>(light, 0.0);
    queue_shadow_ray(row);
}
