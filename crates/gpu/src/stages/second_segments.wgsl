// Second segments of caustic samples, from spheres to emitters, in place of the first ones that are not occluded:
// `trace_first_segments` of `integrator/caustics/mod.rs`.

@group(0) @binding(1) var<storage, read> job: Job;
// Shadow rays.
@group(0) @binding(2) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> found: array<u32>;
@group(0) @binding(4) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> queue: array<u32>;
@group(0) @binding(6) var<storage, read_write> shadow_queue: array<atomic<u32>>;
@group(0) @binding(7) var<storage, read> chains: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read> seconds: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    var number = chains[4u * path + 3u].y;
    while number != MISS {
        let row = params.shadows * params.count + number;
        let start = seconds[3u * number];
        let toward = seconds[3u * number + 1u];
        let rest = seconds[3u * number + 2u];
        number = rest.z;
        if is_ended(row) {
            continue;
        }
        end_ray(row);
        if found[row] == UNKNOWN {
            paths[path].w |= 1u;
        } else if found[row] == MISS {
            paths[path].w += SHADOW_RAY;
            let point = bitcast<vec3<f32>>(start.xyz);
            let direction = bitcast<vec3<f32>>(toward.xyz);
            let t = double_at(rest.xy);
            let ground = cross_ground(point, direction, start.w);
            if ground.crossed && ground.t < t {
                continue;
            }
            let bounds = bounds_before(Crossing(false, 0.0), t);
            rays[3u * row] = vec4<u32>(start.xyz, toward.x);
            rays[3u * row + 1u] = vec4<u32>(toward.yz, start.w, toward.w);
            rays[3u * row + 2u] = vec4<u32>(bitcast<vec2<u32>>(bounds), 0u, 0u);
            queue_shadow_ray(row);
        }
    }
}
