// A bounce of Whitted ray tracing: `integrator/whitted.rs`. Three kernels follow one another: the light that paths reach, shadow
// rays as often as there are samples left, and the next rays.

@group(0) @binding(22) var<storage, read> pixels: array<u32>;

override STEP: u32 = 0u;

const LIGHT: u32 = 0u;
const SHADOWS: u32 = 1u;

// `SPLIT` of `sampling/sampler.rs`.
const SPLIT: vec2<u32> = vec2<u32>(0x4c957f2du, 0x5851f42du);

// One of the samples of a light, or of the sky after all lights.
struct ShadowSample {
    light: u32,
    index: u32,
    count: u32,
}

fn is_delta_light(light: u32) -> bool {
    let first_sun = job.emitters + job.points;
    if light < job.emitters || light >= first_sun + job.suns {
        return false;
    }
    return light < first_sun || sun_height(light - first_sun) < 0.0;
}

fn shadow_sample(number: u32) -> ShadowSample {
    let lights = job.emitters + job.points + job.suns + job.sky_parts;
    var first = 0u;
    for (var light = 0u; light < lights; light++) {
        let count = select(job.shadow_samples, 1u, is_delta_light(light));
        if number - first < count {
            return ShadowSample(light, number - first, count);
        }
        first += count;
    }
    return ShadowSample(lights, number - first, job.shadow_samples);
}

// `Sampler::split` and `Split::pair`.
fn split_pair(path: u32, sample: ShadowSample) -> vec2<f32> {
    let pixel = pixels[path / params.samples];
    let index = params.first_sample + path % params.samples;
    let place = stream(vec2<u32>(job.seed[0], job.seed[1]), vec2<u32>(pixel & 0xffffu, pixel >> 16u));
    let key = stream(place, vec2<u32>(index >> INDEX_BITS, 0u));
    let event = params.bounce * 0x9e3779b9u + sample.light;
    let own = stream(key ^ SPLIT, vec2<u32>(event, 0u));
    let mask = (1u << INDEX_BITS) - 1u;
    let position = (index & mask) * sample.count + sample.index;
    let seed = stream(own, vec2<u32>(position >> INDEX_BITS, 0u)).x;
    return draw4(Sequence(shuffle(position & mask, seed), seed, 0u, 0u), 0u).xy;
}

// The light of a ray that leaves the scene: there is no MIS weight.
fn whitted_environment(path: u32) -> vec3<f32> {
    let direction = ray_direction(path);
    if params.bounce == 0u && has(BACKGROUND) {
        return vector32(job.background);
    }
    var suns = vec3<f32>(0.0);
    for (var sun = 0u; sun < job.suns; sun++) {
        if sun_is_toward(sun, direction) {
            suns = keep3(suns + sun_radiance(sun));
        }
    }
    if has(BACKGROUND) && material_kind(material_at(ray_own(path))) == DIELECTRIC {
        return keep3(vector32(job.background) + suns);
    }
    return keep3(environment_radiance(direction) + suns);
}

fn sample_sky_by_cosine(basis: Basis, u: vec2<f32>) -> LightSample {
    let incoming = cosine_hemisphere(u);
    var sample = no_light();
    sample.lit = true;
    sample.direction = normalized(to_world(basis, incoming));
    let factor = quotient(PI, max(incoming.z, LEAST_NORMAL));
    sample.weight = scaled(environment_radiance(sample.direction), factor);
    return sample;
}

// The sample of a light from a surface.
fn whitted_sample(path: u32, surface: ptr<function, Surface>, basis: Basis, own: ShadowSample) -> LightSample {
    let u = split_pair(path, own);
    let first_sun = job.emitters + job.points;
    if own.light < job.emitters {
        return sample_sphere_light((*surface).point, (*surface).hit, own.light, u);
    }
    if own.light < first_sun {
        return sample_point_light((*surface).point, own.light - job.emitters);
    }
    if own.light < first_sun + job.suns {
        return sample_sun(own.light - first_sun, u);
    }
    if own.light < first_sun + job.suns + job.sky_parts {
        return sample_sky(own.light - first_sun - job.suns, u);
    }
    return sample_sky_by_cosine(basis, u);
}

// Writes the next shadow rays of a path. False if the device does not know one.
fn write_shadows(path: u32, surface: ptr<function, Surface>, bsdf: ptr<function, Bsdf>) -> bool {
    let basis = basis_about((*surface).facing);
    var outgoing = to_local(basis, -ray_direction(path));
    outgoing.z = max(outgoing.z, 0x1p-23f);
    for (var slot = 0u; slot < params.shadows; slot++) {
        let number = params.first_shadow + slot;
        if number >= job.all_shadows {
            return true;
        }
        let own = shadow_sample(number);
        let sample = whitted_sample(path, surface, basis, own);
        let incoming = to_local(basis, sample.direction);
        if !sample.lit || !(0.0 < incoming.z) {
            continue;
        }
        let share = quotients(states[path].throughput, f32(own.count));
        let light = keep3(keep3(share * bsdf_eval(bsdf, outgoing, incoming)) * sample.weight);
        if !(0.0 < greatest_of(light)) {
            continue;
        }
        if !sample.known {
            return false;
        }
        if !hides_itself(surface, sample.direction, sample.t) {
            write_shadow_ray(path, slot, surface, sample.direction, light, sample.t, sample.goal);
        }
    }
    return true;
}

// Replaces a path's ray by that of its mirror component, or of a sample of a rough metal.
fn whitted_bounce(path: u32, surface: ptr<function, Surface>, bsdf: ptr<function, Bsdf>) {
    let basis = basis_about((*surface).facing);
    var outgoing = to_local(basis, -ray_direction(path));
    outgoing.z = max(outgoing.z, 0x1p-23f);
    let sequence = sequences[path];
    let choice = draw4(sequence, choices(params.bounce)).zw;
    var scatter = Scatter(mirror(outgoing), bsdf_mirrored(bsdf, outgoing), 0.0);
    if !has_diffuse_base(bsdf) {
        scatter = bsdf_sample(bsdf, outgoing, draw4(sequence, directions(params.bounce)).xy, choice.x);
    }
    let throughput = keep3(states[path].throughput * scatter.weight);
    let greatest = greatest_of(throughput);
    let survival = survival_probability(greatest);
    if !(0.0 < greatest) || choice.y >= survival {
        return;
    }
    states[path].throughput = quotients(throughput, survival);
    let direction = normalized_unfused(to_world(basis, scatter.incoming));
    write_next_ray(path, surface, direction, is_within(surface));
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    if STEP == SHADOWS {
        clear_shadow_rays(path);
    }
    if STEP == LIGHT && params.bounce == 0u && has(NESTED_GLASS) && !begin_interiors(path) {
        paths[path].w |= 1u;
    }
    if (paths[path].w & 1u) != 0u {
        return;
    }
    let state = states[path];
    var surface = surface_of(path, found[path], Entry(state.inside != 0u, state.entry));
    if surface.known && surface.hit == MISS {
        if STEP == LIGHT {
            add_light(path, keep3(state.throughput * whitted_environment(path)));
        }
        return;
    }
    var kind = LAMBERTIAN;
    if surface.known {
        kind = material_kind(material_at(surface.hit));
    }
    if !surface.known {
        paths[path].w |= 1u;
        return;
    }
    if STEP == LIGHT {
        if kind == EMITTER {
            add_light(path, keep3(state.throughput * material_color(material_at(surface.hit), 3u)));
        }
        return;
    }
    if kind == DIELECTRIC {
        if STEP == SHADOWS {
            return;
        }
        let outside = index_outside(path, surface.hit);
        if !scatter_glass(path, &surface, outside, draw4(sequences[path], choices(params.bounce)).z) {
            paths[path].w |= 1u;
        }
        return;
    }
    var bsdf = bsdf_at(surface.hit);
    if STEP == SHADOWS {
        if has_diffuse_base(&bsdf) && !is_delta(&bsdf) && !write_shadows(path, &surface, &bsdf) {
            paths[path].w |= 1u;
        }
        return;
    }
    whitted_bounce(path, &surface, &bsdf);
}
