// Scattering at glass: `integrator/glass.rs` and `shade/dielectric.rs`.

// The index of refraction outside of a glass sphere that a path has hit; 0 if there is no interface, in other glass that
// decides the medium on both sides.
fn index_outside(path: u32, hit: u32) -> f32 {
    if has(NESTED_GLASS) {
        return outside_ior(path, hit);
    }
    return 1.0;
}

// Replaces the ray of a path by the one that is reflected, if the choice is less than the reflectance, or refracted. False
// if the device does not know what contains the path.
fn scatter_glass(path: u32, surface: ptr<function, Surface>, outside: f32, choice: f32) -> bool {
    let hit = (*surface).hit;
    let normal = (*surface).normal;
    let toward = vec3<f64>(ray_direction(path));
    let direction = kept3(toward * inverse_length(toward));
    let entering = dot_unfused(direction, normal) < 0.0;
    let real = outside > 0.0;
    var sent = direction;
    var inside = entering;
    if real {
        let ior = f64(ior_of(hit));
        let around = f64(outside);
        let eta = select(ior, around, entering) / select(around, ior, entering);
        let facing = select(-normal, normal, entering);
        let cosine = clamp(-dot_unfused(direction, facing), 0.0lf, 1.0lf);
        let passage = fresnel_dielectric(cosine, eta);
        let back = f64(choice) < passage.reflected;
        let mirrored = kept3(direction + kept3(facing * kept(2.0 * cosine)));
        let along = kept(kept(eta * cosine) - passage.refracted);
        let bent = kept3(kept3(direction * eta) + kept3(facing * along));
        sent = select(bent, mirrored, back);
        sent = kept3(sent * inverse_length(sent));
        inside = entering != back;
        let color = keep3(material_color(material_at(hit), 2u) * color_at(hit));
        states[path].throughput = keep3(states[path].throughput * color);
    }
    states[path].previous = next_bounce(states[path].previous, 0.0, false);
    if has(NESTED_GLASS) && inside && !enter_sphere(path, hit) {
        return false;
    }
    write_next_ray(path, surface, vec3<f32>(sent), inside);
    return true;
}
