// Suns and emissive spheres that glass mirrors: `integrator/glass.rs`.

// True if a path has hit an interface of glass from outside.
fn meets_glass_from_outside(path: u32, surface: ptr<function, Surface>, outside: f32) -> bool {
    return outside > 0.0 && dot_unfused((*surface).normal, vec3<f64>(ray_direction(path))) < 0.0;
}

// The direction that glass mirrors: on the outside, or once on the inside of glass that stands alone, which rays leave at
// the next interface.
fn glass_mirror(
    path: u32,
    surface: ptr<function, Surface>,
    outside: f32,
    from_outside: bool,
    state: PathState,
) -> Mirror {
    let hit = (*surface).hit;
    let color = keep3(material_color(material_at(hit), 2u) * color_at(hit));
    let tint = keep3(state.throughput * color);
    let given = ray_direction(path);
    let ior = f64(ior_of(hit));
    if from_outside {
        let normal = vec3<f32>((*surface).normal);
        let cosine = -dot_fused(given, normal);
        let toward = normalized(keep3(given + scaled(normal, keep(cosine + cosine))));
        let passage = fresnel_dielectric(clamp(f64(cosine), 0.0lf, 1.0lf), f64(outside) / ior);
        let factor = scaled(tint, f32(passage.reflected));
        return Mirror((*surface).point, hit, toward, factor, state.previous);
    }
    if caster_of(hit) == MISS || params.bounce + 2u > job.depth {
        return no_mirror();
    }
    let unscaled = vec3<f64>(given);
    let direction = kept3(unscaled * kept(inverse_length(unscaled)));
    let normal = (*surface).normal;
    let cosine = dot_unfused(direction, normal);
    let twice = kept(2.0lf * cosine);
    let mirrored = kept3(direction - kept3(normal * twice));
    let across = kept3(mirrored * twice);
    let eta = kept(ior / f64(outside));
    let passage = fresnel_dielectric(cosine, eta);
    let bend = kept(passage.refracted - kept(eta * cosine));
    let leaving = kept3(kept3(mirrored * eta) + kept3(kept3(normal + across) * bend));
    let share = kept(passage.reflected * kept(1.0lf - passage.reflected));
    let far_side = vec3<f32>(kept3(vec3<f64>((*surface).point) + kept3(across * (*surface).radius)));
    let factor = scaled(keep3(tint * color), f32(share));
    // Caustic samples do not find this light.
    return Mirror(far_side, hit, normalized(vec3<f32>(leaving)), factor, CAMERA);
}

// Marks a path that has left the glass by a way on which its light was sampled.
fn mark_mirrored_light(path: u32, hit: u32, from_outside: bool, before: u32) {
    let inward = states[path].inside != 0u;
    var sampled = !inward;
    if !from_outside {
        let simple = caster_of(hit) != MISS;
        sampled = simple && (inward || mirrored_light_sampled(before));
    }
    if sampled {
        states[path].previous = with_mirrored_light(states[path].previous);
    }
}
