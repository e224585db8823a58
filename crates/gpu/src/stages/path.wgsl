// A bounce of paths: `integrator/path.rs`. Replaces each ray by the next one of its path, and writes its shadow rays
// with the light that they carry.

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

// A shadow ray to a light at this distance, with the light that it carries. The ground may be in between.
fn write_shadow_ray(
    path: u32,
    slot: u32,
    surface: ptr<function, Surface>,
    direction: vec3<f32>,
    light: vec3<f32>,
    t: f64,
    goal: u32,
) {
    paths[path].w += SHADOW_RAY;
    let ground = cross_ground((*surface).point, direction, (*surface).hit);
    if ground.crossed && ground.t < t {
        return;
    }
    let bounds = bounds_before(Crossing(false, 0.0), t);
    let row = path + slot * params.count;
    let start = bitcast<vec3<u32>>((*surface).point);
    let toward = bitcast<vec3<u32>>(direction);
    shadow_rays[3u * row] = vec4<u32>(start, toward.x);
    shadow_rays[3u * row + 1u] = vec4<u32>(toward.yz, (*surface).hit, goal);
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
        let row = path + slot * params.count;
        shadow_rays[3u * row + 2u] = vec4<u32>(bitcast<vec2<u32>>(vec2<f32>(-1.0)), 0u, 0u);
    }
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    clear_shadow_rays(path);
    if params.bounce == 0u && has(NESTED_GLASS) {
        clear_interiors(path);
    }
    let state = states[path];
    var surface = surface_of(path, found[path], Entry(state.inside != 0u, state.entry));
    let cut = params.bounce == job.depth;
    let known = surface.known && (paths[path].w & 1u) == 0u;
    if known && surface.hit == MISS {
        add_light(path, keep3(state.throughput * escaped_light(path, state.previous)));
        return;
    }
    var kind = LAMBERTIAN;
    if known {
        kind = material_kind(material_at(surface.hit));
    }
    let followed = known && (!surface.inside || kind == DIELECTRIC);
    if !followed || (!cut && lights_set(params.bounce) >= SETS) {
        paths[path].w |= 1u;
        return;
    }
    if kind == EMITTER {
        add_light(path, emitted_light(path, surface.hit, state));
    }
    if cut {
        return;
    }
    let sequence = sequences[path];
    if kind == DIELECTRIC {
        if !scatter_glass(path, &surface, draw4(sequence, choices(params.bounce)).z) {
            paths[path].w |= 1u;
            return;
        }
        paths[path].w += BOUNCE_RAY;
        go_on(path);
        return;
    }
    var bsdf = bsdf_at(surface.hit);
    let basis = basis_about(surface.facing);
    var outgoing = to_local(basis, -ray_direction(path));
    outgoing.z = max(outgoing.z, 0x1p-23f);
    if has(LIGHTS) && !is_delta(&bsdf) {
        var sample = sample_light(surface.point, surface.facing, surface.hit, draw4(sequence, lights_set(params.bounce)));
        let incoming = to_local(basis, sample.direction);
        if sample.lit && 0.0 < incoming.z {
            let light = direct_light(&bsdf, state.throughput, outgoing, incoming, &sample);
            if 0.0 < greatest_of(light) {
                if !sample.known {
                    paths[path].w |= 1u;
                    return;
                }
                write_shadow_ray(path, 0u, &surface, sample.direction, light, sample.t, sample.goal);
            }
        }
    }
    let mirrors = has(MIRRORED_LIGHT) && has_diffuse_base(&bsdf);
    if mirrors {
        let factor = keep3(state.throughput * bsdf_mirrored(&bsdf, outgoing));
        let toward = normalized(to_world(basis, mirror(outgoing)));
        if 0.0 < greatest_of(factor) && !mirror_lights(path, &surface, toward, factor) {
            paths[path].w |= 1u;
            return;
        }
    }
    let draw = draw4(sequence, directions(params.bounce));
    var choice = vec2<f32>(0.0);
    if !is_diffuse(&bsdf) || roulette_active() {
        choice = draw4(sequence, choices(params.bounce)).zw;
    }
    let scatter = bsdf_sample(&bsdf, outgoing, draw.xy, choice.x);
    let throughput = keep3(state.throughput * scatter.weight);
    let greatest = greatest_of(throughput);
    let survival = survival_probability(greatest);
    if !(choice.y < survival && 0.0 < greatest) {
        return;
    }
    var previous = next_bounce(state.previous, scatter.pdf, is_diffuse(&bsdf));
    if mirrors && scatter.pdf <= 0.0 {
        previous = with_mirrored_light(previous);
    }
    states[path].throughput = quotients(throughput, survival);
    states[path].previous = previous;
    states[path].inside = 0u;
    if has(LIGHT_TREE) {
        states[path].normal = surface.facing;
    }
    let direction = normalized(to_world(basis, scatter.incoming));
    let ground = cross_ground(surface.point, direction, surface.hit);
    write_ray(path, surface.point, direction, surface.hit, bounds_before(ground, INFINITELY_FAR));
    paths[path].w += BOUNCE_RAY;
    go_on(path);
}
