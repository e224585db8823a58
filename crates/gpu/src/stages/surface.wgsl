// Points and normals of hits: `integrator/surface.rs`.

struct Surface {
    // False where the device does not know the processor's numbers.
    known: bool,
    // The sphere, GROUND, or MISS.
    hit: u32,
    point: vec3<f32>,
    normal: vec3<f64>,
    // The normal on the side that the ray comes from, rounded.
    facing: vec3<f32>,
    // True if the surface is hit from inside.
    inside: bool,
    // 0 on the ground.
    radius: f64,
}

// A distance that rounding does not decide.
struct Distance {
    clear: bool,
    t: f64,
}

// The distance to the hit of a ray that meets a sphere: `confirm_either` of spherule-core.
fn sphere_distance(terms: SphereTerms) -> Distance {
    let chord2 = terms.chord2;
    let meets = kept(PART_TWICE * terms.r2) < chord2
        && kept(kept(PART_SQUARED * terms.distance2) * terms.r2) < kept(chord2 * chord2)
        && is_side_clear(terms);
    if !meets || (terms.outside > 0.0 && terms.b <= 0.0) {
        return Distance(false, 0.0);
    }
    return Distance(true, distance_of(terms));
}

// Whether a ray is inside of the glass sphere on which it starts, and the normal where it entered.
struct Entry {
    inside: bool,
    normal: vec3<f64>,
}

// The length of a chord through a sphere from a point with this normal: `chord_length` of `integrator/surface.rs`.
fn chord_length(normal: vec3<f64>, radius: f64, toward: vec3<f32>) -> f64 {
    let direction = vec3<f64>(toward);
    let length2 = dot_unfused(direction, direction);
    let t = kept(kept(-2.0 * radius) * dot_unfused(normal, direction)) / length2;
    return max(t, 0.0);
}

// Where a chord leaves a sphere, as a normal, from that of its entry.
fn chord_exit(entry: vec3<f64>, direction: vec3<f64>) -> vec3<f64> {
    let length2 = dot_unfused(direction, direction);
    let toward = kept3(entry - kept3(direction * (kept(2.0 * dot_unfused(entry, direction)) / length2)));
    return kept3(toward * inverse_length(toward));
}

// The surface that a ray hits, of which `found` is the answer of `hits.wgsl`.
fn surface_of(row: u32, found: u32, entry: Entry) -> Surface {
    let none = vec3<f64>(0.0);
    var surface = Surface(false, found, vec3<f32>(0.0), none, vec3<f32>(0.0), false, 0.0);
    if found == UNKNOWN {
        return surface;
    }
    let own = ray_own(row);
    let start = ray_origin(row);
    let origin = vec3<f64>(start);
    let direction = vec3<f64>(ray_direction(row));
    var point = none;
    if found == MISS {
        let ground = cross_ground(start, ray_direction(row), own);
        var center = none;
        var chord = INFINITELY_FAR;
        if entry.inside {
            let sphere = sphere_row(own);
            center = vec3<f64>(bitcast<vec3<f32>>(sphere.xyz));
            surface.radius = f64(bitcast<f32>(sphere.w));
            chord = chord_length(entry.normal, surface.radius, ray_direction(row));
        }
        if ground.crossed && ground.t < chord {
            surface.hit = GROUND;
            surface.radius = 0.0;
            surface.normal = vector64(job.ground_normal);
            let above = kept3(origin + kept3(direction * ground.t));
            let off = kept(dot_unfused(surface.normal, above) - job.ground_height);
            point = above - kept3(surface.normal * off);
        } else if entry.inside {
            surface.hit = own;
            surface.normal = chord_exit(entry.normal, direction);
            point = center + kept3(surface.normal * surface.radius);
        } else {
            surface.known = true;
            return surface;
        }
    } else {
        let sphere = sphere_row(found);
        let center = vec3<f64>(bitcast<vec3<f32>>(sphere.xyz));
        surface.radius = f64(bitcast<f32>(sphere.w));
        let distance = sphere_distance(sphere_terms(origin, direction, center, surface.radius));
        // Rays inside of the sphere on which they start leave where their chord ends, which is the processor's.
        if !distance.clear || found == own {
            return surface;
        }
        let toward = kept3(kept3(origin - center) + kept3(direction * distance.t));
        surface.normal = kept3(toward * inverse_length(toward));
        point = center + kept3(surface.normal * surface.radius);
    }
    surface.known = true;
    surface.inside = dot_unfused(surface.normal, direction) > 0.0;
    surface.point = vec3<f32>(point);
    surface.facing = vec3<f32>(select(surface.normal, -surface.normal, surface.inside));
    return surface;
}
