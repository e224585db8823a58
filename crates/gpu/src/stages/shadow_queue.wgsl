// Light of shadow rays that are not occluded: `integrator/shadow_queue.rs`.

@group(0) @binding(1) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> lights: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> found: array<u32>;
@group(0) @binding(4) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> queue: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    var radiance = bitcast<vec3<f32>>(paths[path].xyz);
    for (var row = path; row < params.shadows * params.count; row += params.count) {
        if is_ended(row) {
            continue;
        }
        if found[row] == UNKNOWN {
            paths[path].w |= 1u;
        } else if found[row] == MISS {
            radiance = keep3(radiance + lights[row].xyz);
        }
    }
    paths[path] = vec4<u32>(bitcast<vec3<u32>>(radiance), paths[path].w);
}
