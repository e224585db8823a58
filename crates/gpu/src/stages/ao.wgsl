// Ambient occlusion: `integrator/ao.rs`. Replaces each camera ray by a shadow ray, and stores the light
// that it carries.

@group(0) @binding(8) var<storage, read> sobol: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read> sequences: array<Sequence>;
@group(0) @binding(10) var<storage, read> found: array<u32>;
@group(0) @binding(11) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(12) var<storage, read_write> lights: array<vec4<f32>>;
@group(0) @binding(13) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(14) var<storage, read> queue: array<u32>;
@group(0) @binding(15) var<storage, read_write> shadow_queue: array<atomic<u32>>;
@group(0) @binding(16) var<storage, read> sky_rows: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    let surface = surface_of(path, found[path], Entry(false, vec3<f64>(0.0)));
    if !surface.known {
        paths[path].w |= 1u;
        end_ray(path);
        return;
    }
    if surface.hit == MISS {
        paths[path] = vec4<u32>(bitcast<vec3<u32>>(seen_by_camera(ray_direction(path))), 0u);
        end_ray(path);
        return;
    }
    let light = albedo_of(surface.hit);
    let draw = draw4(sequences[path], directions(0u));
    let direction = normalized(to_world(basis_about(surface.facing), cosine_hemisphere(draw.xy)));
    let lit = max(max(light.x, light.y), light.z) > 0.0;
    let hidden = surface.inside && surface.hit != GROUND && chord_length(surface.normal, surface.radius, direction) < job.distance;
    if !lit || hidden {
        end_ray(path);
        return;
    }
    paths[path].w += SHADOW_RAY;
    lights[path] = vec4<f32>(light, 0.0);
    let ground = cross_ground(surface.point, direction, surface.hit);
    if ground.crossed && ground.t < job.distance {
        end_ray(path);
        return;
    }
    write_ray(path, surface.point, direction, surface.hit, bounds_around(job.distance));
    queue_shadow_ray(path);
}
