// Columns of paths, and what the kernels of bounces write to them.

@group(0) @binding(1) var<storage, read> job: Job;
@group(0) @binding(2) var<storage, read> spheres_0: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> spheres_1: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> spheres_2: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> spheres_3: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read> appearance: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read> materials: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read> sobol: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read> sequences: array<Sequence>;
@group(0) @binding(10) var<storage, read> found: array<u32>;
@group(0) @binding(11) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(12) var<storage, read_write> states: array<PathState>;
@group(0) @binding(13) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(14) var<storage, read_write> shadow_rays: array<vec4<u32>>;
@group(0) @binding(15) var<storage, read_write> lights: array<vec4<f32>>;
@group(0) @binding(16) var<storage, read> queue: array<u32>;
// Paths that go on.
@group(0) @binding(17) var<storage, read_write> next_queue: array<atomic<u32>>;
@group(0) @binding(18) var<storage, read_write> shadow_queue: array<atomic<u32>>;
@group(0) @binding(19) var<storage, read> light_rows: array<vec4<u32>>;
// Of each path the glass spheres that contain it, or MISS.
@group(0) @binding(20) var<storage, read_write> interiors: array<u32>;
@group(0) @binding(21) var<storage, read> sky_rows: array<vec4<u32>>;

fn go_on(path: u32) {
    let place = atomicAdd(&next_queue[3], 1u);
    if place % 64u == 0u {
        atomicAdd(&next_queue[0], 1u);
    }
    atomicStore(&next_queue[QUEUE_HEAD + place], path);
}

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

fn add_light(path: u32, light: vec3<f32>) {
    let radiance = keep3(bitcast<vec3<f32>>(paths[path].xyz) + light);
    paths[path] = vec4<u32>(bitcast<vec3<u32>>(radiance), paths[path].w);
}

fn clear_shadow_rays(path: u32) {
    for (var slot = 0u; slot < params.shadows; slot++) {
        end_shadow_ray(path + slot * params.count);
    }
}

// A shadow ray that is not traced.
fn end_shadow_ray(row: u32) {
    shadow_rays[3u * row + 2u] = vec4<u32>(bitcast<vec2<u32>>(vec2<f32>(-1.0)), 0u, 0u);
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
