// Chains of specular bounces in four rows of `chains`, which is bound by the kernels; the last also has the path's first
// caustic sample.

fn chain_of(path: u32) -> SpecularChain {
    let start = chains[4u * path];
    let normal = chains[4u * path + 1u];
    let toward = chains[4u * path + 2u];
    let at = Receiver(bitcast<vec3<f32>>(start.xyz), bitcast<vec3<f32>>(normal.xyz), start.w);
    let inside = chains[4u * path + 3u].x != 0u;
    return SpecularChain(at, bitcast<vec3<f32>>(toward.xyz), bitcast<f32>(toward.w), normal.w, inside);
}

fn set_chain(path: u32, chain: SpecularChain) {
    chains[4u * path] = vec4<u32>(bitcast<vec3<u32>>(chain.at.point), chain.at.own);
    chains[4u * path + 1u] = vec4<u32>(bitcast<vec3<u32>>(chain.at.normal), chain.sphere);
    chains[4u * path + 2u] = vec4<u32>(bitcast<vec3<u32>>(chain.toward), bitcast<u32>(chain.pdf));
    chains[4u * path + 3u].x = select(0u, 1u, chain.inside);
}

// Before a bounce: no caustic samples, and at the camera no chain.
fn begin_chain(path: u32) {
    if params.bounce == 0u {
        set_chain(path, no_chain());
    }
    chains[4u * path + 3u].y = MISS;
}

// Updates the chain of a path before it is scattered.
fn track_chain(path: u32, hit: u32, previous: u32) {
    let chain = chain_of(path);
    let sampled = light_sampled(previous);
    var next = no_chain();
    if sampled && caster_of(hit) != MISS {
        next = start_chain(path, previous_density(previous), hit);
    } else if !sampled && chain.sphere == hit && ray_own(path) == hit && !chain.inside {
        next = chain;
        next.inside = true;
    }
    set_chain(path, next);
}

// The MIS weight of an emitter that a path reaches by specular surfaces alone, at a point or in a direction.
fn chain_weight(path: u32, emitter: u32, end: vec3<f32>) -> f32 {
    let own = ray_own(path);
    let chain = chain_of(path);
    if own == MISS || own == GROUND || own != chain.sphere {
        return 1.0;
    }
    return weight_of_chain(chain, emitter, end, ray_direction(path));
}
