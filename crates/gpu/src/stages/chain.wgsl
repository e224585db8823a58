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

fn weight_of_chain(chain: SpecularChain, emitter: u32, end: vec3<f32>, toward: vec3<f32>) -> f32 {
    let hit = CausticHit(chain.at, chain.toward, chain.pdf, chain.sphere, chain.inside, emitter, end, toward);
    return caustic_weight(hit);
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
