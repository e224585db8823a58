// A bounce of paths among diffuse surfaces under the sky alone: `integrator/path.rs`, `integrator/roulette.rs`,
// `shade/lambertian.rs`. Replaces each ray by the next one of its path.

@group(0) @binding(1) var<storage, read> job: Job;
@group(0) @binding(2) var<storage, read> spheres_0: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> spheres_1: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> spheres_2: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> spheres_3: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read> albedos: array<f32>;
@group(0) @binding(7) var<storage, read> sobol: array<vec4<u32>>;
@group(0) @binding(8) var<storage, read> sequences: array<Sequence>;
@group(0) @binding(9) var<storage, read> found: array<u32>;
@group(0) @binding(10) var<storage, read_write> rays: array<vec4<u32>>;
// Throughput.
@group(0) @binding(11) var<storage, read_write> lights: array<vec4<f32>>;
@group(0) @binding(12) var<storage, read_write> paths: array<vec4<u32>>;
// The number of paths that go on.
@group(0) @binding(13) var<storage, read_write> alive: atomic<u32>;

// True if roulette may end paths at this bounce.
fn roulette_active() -> bool {
    return has(ROULETTE_FIXED) || (has(ROULETTE_BY_THROUGHPUT) && params.bounce >= 3u);
}

fn survival_probability(greatest: f32) -> f32 {
    if !roulette_active() {
        return 1.0;
    }
    if has(ROULETTE_FIXED) {
        return job.survival;
    }
    return min(max(quotient(greatest, job.threshold), 0.05), 1.0);
}

// Adds the light of the environment to a path that leaves the scene.
fn add_environment(path: u32) {
    var light = vec3<f32>(0.0);
    if params.bounce == 0u {
        light = seen_by_camera(ray_direction(path));
    } else if has(ILLUMINATES) {
        light = environment_radiance(ray_direction(path));
    }
    let radiance = keep3(lights[path].xyz * light);
    paths[path] = vec4<u32>(bitcast<vec3<u32>>(radiance), paths[path].w);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = id.x;
    if path >= params.count || is_ended(path) {
        return;
    }
    let surface = surface_of(path, found[path]);
    if surface.known && surface.hit == MISS {
        add_environment(path);
        end_ray(path);
        return;
    }
    let cut = params.bounce == job.depth;
    if !surface.known || surface.inside || (!cut && choices(params.bounce) >= SETS) {
        paths[path].w |= 1u;
        end_ray(path);
        return;
    }
    if cut {
        end_ray(path);
        return;
    }
    let sequence = sequences[path];
    let draw = draw4(sequence, directions(params.bounce));
    var roulette = 0.0;
    if roulette_active() {
        roulette = draw4(sequence, choices(params.bounce)).w;
    }
    let throughput = keep3(lights[path].xyz * albedo_of(surface.hit));
    let greatest = max(max(throughput.x, throughput.y), throughput.z);
    let survival = survival_probability(greatest);
    if !(roulette < survival && 0.0 < greatest) {
        end_ray(path);
        return;
    }
    lights[path] = vec4<f32>(
        quotient(throughput.x, survival),
        quotient(throughput.y, survival),
        quotient(throughput.z, survival),
        0.0,
    );
    let direction = to_world(basis_about(surface.facing), cosine_hemisphere(draw.xy));
    let ground = cross_ground(surface.point, direction, surface.hit);
    var bounds = vec2<f32>(FAR);
    if ground.crossed {
        bounds = bounds_around(ground.t);
    }
    write_ray(path, surface.point, direction, surface.hit, bounds);
    paths[path].w += 2u;
    atomicAdd(&alive, 1u);
}
