// Caustic samples of surfaces that are not specular: `integrator/caustics/mod.rs`.
//
// This kernel comes before that of the bounce, although the light of its samples is added after all other light of a
// path. Their shadow rays have two segments. The first, from surfaces to spheres, are traced with all other shadow rays,
// in rows after those; `second_segments.wgsl` replaces those that are not occluded. The samples of a path are linked in
// order.

// `ALTERNATE` of `sampling/sampler.rs`.
const ALTERNATE: vec2<u32> = vec2<u32>(0xfe94f82bu, 0x3c6ef372u);

// The next point of Roberts' sequence in the unit square: `sampling/warp.rs`.
fn next_in_square(u: vec2<f32>) -> vec2<f32> {
    let next = vec2<f32>(keep(u.x + 0x1.827f54p-1f), keep(u.y + 0x1.23c21cp-1f));
    let inside = select(keep4(vec4<f32>(next - 1.0, 0.0, 0.0)).xy, next, next < vec2<f32>(1.0));
    return min(inside, vec2<f32>(ONE_BELOW));
}

// The radiance of the emitter, times the color of the sphere.
fn caustic_color(sphere: u32, emitter: u32, path: u32, incidence: f32) -> vec3<f32> {
    let radiance = bitcast<vec3<f32>>(emitter_row(emitter, 3u).xyz);
    let material = material_at(sphere);
    switch material_kind(material) {
        case CONDUCTOR: {
            var metal = bsdf_at(sphere);
            return keep3(radiance * conductor_reflectance(&metal, incidence));
        }
        case DIELECTRIC: {
            let color = keep3(material_color(material, 2u) * color_at(sphere));
            if path != REFLECTED {
                return keep3(radiance * keep3(color * color));
            }
            return keep3(radiance * color);
        }
        default: { return radiance; }
    }
}

// Samples the caustics at a surface. False if the device has no room for a sample.
fn sample_caustics(path: u32, surface: ptr<function, Surface>, bsdf: ptr<function, Bsdf>) -> bool {
    let throughput = states[path].throughput;
    let basis = basis_about((*surface).facing);
    var outgoing = to_local(basis, -ray_direction(path));
    outgoing.z = max(outgoing.z, 0x1p-23f);
    var alternate = sequences[path];
    alternate.seed ^= ALTERNATE.x;
    alternate.upper ^= ALTERNATE.y;
    let numbers = draw4(alternate, lights_set(params.bounce));
    let at = Receiver((*surface).point, (*surface).facing, (*surface).hit);
    var draw = begin_caustics(at, light_draw(numbers));
    var place = numbers.xy;
    var last = MISS;
    for (var index = 0u; ; index++) {
        let choice = choose_caustic(&draw, index);
        if !choice.found {
            return true;
        }
        let pair = caster_pair(choice.caster, draw.emitter);
        let sample = sample_caustic(pair, choice.path, f32(choice.rate), at.point, place);
        place = next_in_square(place);
        let incoming = to_local(basis, sample.toward);
        let response = bsdf_eval(bsdf, outgoing, incoming);
        var chance = sample.kept_light;
        if has(MIRRORED_LIGHT) && choice.path == REFLECTED {
            chance = 1.0;
        }
        let own = keep(bsdf_pdf(bsdf, outgoing, incoming) * chance);
        let weight = quotient(keep(sample.kept_light * power_heuristic(sample.pdf, own)), sample.pdf);
        let color = caustic_color(pair.sphere, draw.emitter, choice.path, sample.incidence);
        let light = scaled(keep3(keep3(throughput * response) * color), weight);
        let greatest = greatest_of(light);
        let lit = 0.0 < greatest && greatest < bitcast<f32>(INFINITE) && 0.0 < incoming.z;
        // Light through glass has one more bounce.
        let deep = choice.path != REFLECTED && params.bounce + 3u > job.depth;
        if !(pair.valid && sample.found && lit) || deep {
            continue;
        }
        let number = atomicAdd(&shadow_queue[4], 1u);
        if number >= params.count {
            return false;
        }
        let row = params.shadows * params.count + number;
        var goal = MISS;
        var length = INFINITELY_FAR;
        if !is_sun(draw.emitter) {
            goal = emitter_row(draw.emitter, 3u).w;
            length = sample.length.y;
        }
        seconds[3u * number] = vec4<u32>(bitcast<vec3<u32>>(sample.exit), pair.sphere);
        seconds[3u * number + 1u] = vec4<u32>(bitcast<vec3<u32>>(sample.toward_emitter), goal);
        let far = bitcast<u64>(length);
        seconds[3u * number + 2u] = vec4<u32>(u32(far & 0xfffffffflu), u32(far >> 32u), MISS, 0u);
        if last == MISS {
            chains[4u * path + 3u].y = number;
        } else {
            seconds[3u * last + 2u].z = number;
        }
        last = number;
        end_shadow_ray(row);
        write_segment(path, row, at.point, sample.toward, light, vec2<u32>(at.own, pair.sphere), sample.length.x);
    }
    // Not reached: validators ask for it.
    return true;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    begin_chain(path);
    if params.bounce + 2u > job.depth || (paths[path].w & 1u) != 0u || !has(LIGHTS) {
        return;
    }
    let state = states[path];
    var surface = surface_of(path, found[path], Entry(state.inside != 0u, state.entry));
    if !surface.known || surface.hit == MISS || surface.inside {
        return;
    }
    if material_kind(material_at(surface.hit)) == DIELECTRIC {
        return;
    }
    var bsdf = bsdf_at(surface.hit);
    if !is_delta(&bsdf) && !sample_caustics(path, &surface, &bsdf) {
        paths[path].w |= 1u;
    }
}
