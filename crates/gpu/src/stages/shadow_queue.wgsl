// Light of shadow rays that are not occluded: `integrator/shadow_queue.rs`.

@group(0) @binding(1) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read> lights: array<vec4<f32>>;
@group(0) @binding(3) var<storage, read> found: array<u32>;
@group(0) @binding(4) var<storage, read_write> paths: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = id.x;
    if path >= params.count {
        return;
    }
    if is_ended(path) {
        return;
    }
    if found[path] == UNKNOWN {
        paths[path].w |= 1u;
    } else if found[path] == MISS {
        paths[path] = vec4<u32>(bitcast<vec3<u32>>(lights[path].xyz), paths[path].w);
    }
}
