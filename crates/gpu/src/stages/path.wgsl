// A bounce of paths: `integrator/path.rs`. Replaces each ray by the next one of its path, and writes its shadow rays
// with the light that they carry.

// Specular bounces of paths since the last diffuse surface, in four rows, the last of which has the path's first caustic
// sample; and of each caustic sample its second segment, in three rows, and the next sample of the path.
@group(0) @binding(22) var<storage, read_write> chains: array<vec4<u32>>;
@group(0) @binding(23) var<storage, read_write> seconds: array<vec4<u32>>;

// True if surfaces sample caustics: kernels without them keep less.
override CAUSTICS: bool = true;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    clear_shadow_rays(path);
    if CAUSTICS {
        begin_chain(path);
    }
    if params.bounce == 0u && has(NESTED_GLASS) && !begin_interiors(path) {
        paths[path].w |= 1u;
        return;
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
    if !known {
        paths[path].w |= 1u;
        return;
    }
    if kind == EMITTER {
        add_light(path, emitted_light(path, &surface, state));
    }
    if cut {
        return;
    }
    let sequence = sequences[path];
    if CAUSTICS && (kind == CONDUCTOR || kind == DIELECTRIC || kind == PLASTIC) {
        track_chain(path, surface.hit, state.previous);
    }
    if kind == DIELECTRIC {
        let outside = index_outside(path, surface.hit);
        let from_outside = meets_glass_from_outside(path, &surface, outside);
        if has(MIRRORED_LIGHT) && !mirror_lights_by_glass(path, &surface, outside, from_outside, state) {
            paths[path].w |= 1u;
            return;
        }
        if !scatter_glass(path, &surface, outside, draw4(sequence, choices(params.bounce)).z) {
            paths[path].w |= 1u;
        } else if has(MIRRORED_LIGHT) {
            mark_mirrored_light(path, surface.hit, from_outside, state.previous);
        }
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
                if !hides_itself(&surface, sample.direction, sample.t) {
                    write_shadow_ray(path, 0u, &surface, sample.direction, light, sample.t, sample.goal);
                }
            }
        }
    }
    let mirrors = has(MIRRORED_LIGHT) && has_diffuse_base(&bsdf) && !surface.inside;
    if mirrors {
        let factor = keep3(state.throughput * bsdf_mirrored(&bsdf, outgoing));
        let toward = normalized(to_world(basis, mirror(outgoing)));
        if 0.0 < greatest_of(factor) && !mirror_lights(path, &surface, toward, factor, state.previous) {
            paths[path].w |= 1u;
            return;
        }
    }
    // After all other light of the path.
    if CAUSTICS && has(LIGHTS) && !is_delta(&bsdf) && !surface.inside {
        if !sample_caustics(path, &surface, &bsdf, basis, outgoing, state.throughput, sequence) {
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
    if has(LIGHT_TREE) {
        states[path].normal = surface.facing;
    }
    let direction = normalized(to_world(basis, scatter.incoming));
    write_next_ray(path, &surface, direction, is_within(&surface));
}
