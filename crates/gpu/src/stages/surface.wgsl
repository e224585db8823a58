// Points and normals of hits: `integrator/surface.rs`, and distances as `intersect/terms.rs` of spherule-core computes
// them.

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

// As in `intersect/terms.rs`.
const PART: f64 = 0x1p-28lf;
const PART_TWICE: f64 = 0x1p-27lf;
const PART_SQUARED: f64 = 0x1p-56lf;

struct Distance {
    // True if rounding decides nothing.
    clear: bool,
    t: f64,
    // Squared distance of the origin from the surface, in a measure: less than 0 inside.
    outside: f64,
}

fn sphere_distance(origin: vec3<f64>, direction: vec3<f64>, center: vec3<f64>, radius: f64) -> Distance {
    let from_center = kept3(origin - center);
    let distance2 = dot_unfused(from_center, from_center);
    let a = dot_unfused(direction, direction);
    let b = -dot_unfused(from_center, direction);
    let perpendicular = kept3(from_center + kept3(direction * (b / a)));
    let p2 = dot_unfused(perpendicular, perpendicular);
    let r2 = kept(radius * radius);
    let chord2 = kept(r2 - p2);
    let outside = kept(distance2 - r2);
    let meets = kept(PART_TWICE * r2) < chord2
        && kept(kept(PART_SQUARED * distance2) * r2) < kept(chord2 * chord2)
        && kept(PART * kept(distance2 + r2)) < abs(outside);
    if !meets || (outside > 0.0 && b <= 0.0) {
        return Distance(false, 0.0, outside);
    }
    let far = outside < 0.0 && b >= 0.0;
    let sum = abs(b) + sqrt(kept(a * chord2));
    return Distance(true, select(abs(outside), sum, far) / select(sum, a, far), outside);
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
        let distance = sphere_distance(origin, direction, center, surface.radius);
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
