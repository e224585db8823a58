// Light of shadow rays that are not occluded: `integrator/shadow_queue.rs`.

@group(0) @binding(1) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> lights: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> found: array<u32>;
@group(0) @binding(4) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> queue: array<u32>;
// The first caustic sample of each path, and the next one of each of these.
@group(0) @binding(6) var<storage, read> chains: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read> seconds: array<vec4<u32>>;

// Adds the light of a shadow ray.
fn add_shadow_ray(path: u32, row: u32, radiance: ptr<function, vec3<f32>>) {
    if is_ended(row) {
        return;
    }
    if found[row] == UNKNOWN {
        paths[path].w |= 1u;
    } else if found[row] == MISS {
        *radiance = keep3(*radiance + lights[row].xyz);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    var radiance = bitcast<vec3<f32>>(paths[path].xyz);
    for (var row = path; row < params.shadows * params.count; row += params.count) {
        add_shadow_ray(path, row, &radiance);
    }
    if params.caustics != 0u {
        var number = chains[4u * path + 3u].y;
        while number != MISS {
            add_shadow_ray(path, params.shadows * params.count + number, &radiance);
            number = seconds[3u * number + 2u].z;
        }
    }
    paths[path] = vec4<u32>(bitcast<vec3<u32>>(radiance), paths[path].w);
}
