// Chains of specular bounces since the last diffuse surface, for the MIS weights of caustics:
// `integrator/caustics/chain.rs`. Those from the camera count only in pixels that see images of lights, which are left to
// the processor.

// A path's specular bounces since it left a surface that is not specular.
struct SpecularChain {
    // Where it left that surface.
    at: Receiver,
    toward: vec3<f32>,
    pdf: f32,
    // The only sphere of the chain; MISS if there is none, or more than one.
    sphere: u32,
    // True if the path is, or was, inside the sphere.
    inside: bool,
}

fn no_chain() -> SpecularChain {
    let none = vec3<f32>(0.0);
    return SpecularChain(Receiver(none, none, MISS), none, 0.0, MISS, false);
}

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

// The chain of a path that has reached a sphere from a surface that is not specular, on the outside of a sphere or above
// the ground.
fn start_chain(path: u32, pdf: f32, sphere: u32) -> SpecularChain {
    let own = ray_own(path);
    if own == MISS {
        return no_chain();
    }
    let point = ray_origin(path);
    let toward = ray_direction(path);
    var normal = vec3<f32>(vector64(job.ground_normal));
    if own != GROUND {
        let off = keep3(point - bitcast<vec3<f32>>(sphere_row(own).xyz));
        normal = scaled(off, quotient(1.0, root(dot_unfused32(off, off))));
    }
    if dot_unfused32(normal, toward) <= 0.0 {
        return no_chain();
    }
    return SpecularChain(Receiver(point, normal, own), toward, pdf, sphere, false);
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

fn weight_of_chain(chain: SpecularChain, emitter: u32, end: vec3<f32>, toward: vec3<f32>) -> f32 {
    let hit = CausticHit(chain.at, chain.toward, chain.pdf, chain.sphere, chain.inside, emitter, end, toward);
    return caustic_weight(hit);
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

// The MIS weight of an emitter that the path's ray sees, in this direction, in the mirroring sphere that it has hit.
fn mirrored_weight(path: u32, hit: u32, previous: u32, emitter: u32, end: vec3<f32>, toward: vec3<f32>) -> f32 {
    if ray_own(path) == MISS || !light_sampled(previous) || caster_of(hit) == MISS {
        return 1.0;
    }
    let chain = start_chain(path, previous_density(previous), hit);
    if chain.sphere == MISS {
        return 1.0;
    }
    return weight_of_chain(chain, emitter, end, toward);
}
