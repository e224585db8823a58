// Surfaces of one kind of material that paths have hit: `integrator/path.rs`. Replaces each ray by the next one of its
// path, and writes its shadow rays with the light that they carry.

// True if surfaces sample caustics.
override CAUSTICS: bool = true;
// The kind of material; emissive surfaces count as diffuse.
override KIND: u32 = 0u;

// As `row_of`, for the queue of the kind among those of all.
fn row_of_kind(id: u32) -> u32 {
    let first = KIND * params.kind_stride;
    if id >= queue[first + 3u] {
        return NO_ROW;
    }
    return queue[first + QUEUE_HEAD + id];
}

// Writes the shadow ray of a light sample. False if the device does not know it.
fn sample_direct_light(
    path: u32,
    surface: ptr<function, Surface>,
    bsdf: ptr<function, Bsdf>,
    basis: Basis,
    outgoing: vec3<f32>,
    state: PathState,
) -> bool {
    let numbers = draw4(sequences[path], lights_set(params.bounce));
    var sample = sample_light((*surface).point, (*surface).facing, (*surface).hit, numbers);
    let incoming = to_local(basis, sample.direction);
    if !sample.lit || !(0.0 < incoming.z) {
        return true;
    }
    let light = direct_light(bsdf, state.throughput, outgoing, incoming, &sample);
    if !(0.0 < greatest_of(light)) {
        return true;
    }
    if sample.known && !hides_itself(surface, sample.direction, sample.t) {
        write_shadow_ray(path, 0u, surface, sample.direction, light, sample.t, sample.goal);
    }
    return sample.known;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of_kind(id.x);
    if path == NO_ROW {
        return;
    }
    let state = states[path];
    var surface = surface_of(path, found[path], Entry(state.inside != 0u, state.entry));
    let sequence = sequences[path];
    let is_glass = KIND == DIELECTRIC;
    var bsdf = bsdf_of(surface.hit, KIND);
    let basis = basis_about(surface.facing);
    var outgoing = to_local(basis, -ray_direction(path));
    outgoing.z = max(outgoing.z, 0x1p-23f);
    var outside = 1.0;
    var from_outside = false;
    var mirrors = false;
    var mirrored = no_mirror();
    if is_glass {
        outside = index_outside(path, surface.hit);
        from_outside = meets_glass_from_outside(path, &surface, outside);
        if has(MIRRORED_LIGHT) {
            mirrored = glass_mirror(path, &surface, outside, from_outside, state);
        }
    } else {
        if has(LIGHTS) && !is_delta(&bsdf) && !sample_direct_light(path, &surface, &bsdf, basis, outgoing, state) {
            paths[path].w |= 1u;
            return;
        }
        mirrors = has(MIRRORED_LIGHT) && has_diffuse_base(&bsdf) && !surface.inside;
        if mirrors && (KIND == PLASTIC || KIND == REFLECTIVE) {
            let factor = keep3(state.throughput * bsdf_mirrored(&bsdf, outgoing));
            let toward = normalized(to_world(basis, mirror(outgoing)));
            mirrored = Mirror(surface.point, surface.hit, toward, factor, state.previous);
        }
    }
    if 0.0 < greatest_of(mirrored.factor) && !mirror_lights(path, mirrored) {
        paths[path].w |= 1u;
        return;
    }
    if is_glass {
        if !scatter_glass(path, &surface, outside, draw4(sequence, choices(params.bounce)).z) {
            paths[path].w |= 1u;
        } else if has(MIRRORED_LIGHT) {
            mark_mirrored_light(path, surface.hit, from_outside, state.previous);
        }
        return;
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
