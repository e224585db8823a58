// Rays in columns, as `hits.wgsl` reads them: in three rows each. `rays` is bound by the kernels.

fn write_ray(row: u32, origin: vec3<f32>, direction: vec3<f32>, own: u32, bounds: vec2<f32>) {
    let start = bitcast<vec3<u32>>(origin);
    let toward = bitcast<vec3<u32>>(direction);
    rays[3u * row] = vec4<u32>(start, toward.x);
    rays[3u * row + 1u] = vec4<u32>(toward.yz, own, MISS);
    rays[3u * row + 2u] = vec4<u32>(bitcast<vec2<u32>>(bounds), 0u, 0u);
}

// A ray that is not traced: it hits nothing.
fn end_ray(row: u32) {
    rays[3u * row + 2u] = vec4<u32>(bitcast<vec2<u32>>(vec2<f32>(-1.0)), 0u, 0u);
}

// True if a ray is not traced.
fn is_ended(row: u32) -> bool {
    return bitcast<f32>(rays[3u * row + 2u].y) < 0.0;
}

fn ray_origin(row: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(rays[3u * row].xyz);
}

fn ray_direction(row: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(vec3<u32>(rays[3u * row].w, rays[3u * row + 1u].xy));
}

fn ray_own(row: u32) -> u32 {
    return rays[3u * row + 1u].z;
}

// What a path's last word counts: bit 0 is set if its radiance is unknown, then follow rays of bounces, and shadow
// rays.
const BOUNCE_RAY: u32 = 2u;
const SHADOW_RAY: u32 = 0x10000u;
