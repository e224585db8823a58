// Terms of the decision about a ray and a sphere in double precision: `intersect/terms.rs` of spherule-core, whose bounds
// say what is clear.

// 2^20 times the bounds of terms; its square is for products.
const PART: f64 = 0x1p-28lf;
const PART_TWICE: f64 = 0x1p-27lf;
const PART_SQUARED: f64 = 0x1p-56lf;
// Far more than the relative error of scalar products and of distances of centers.
const PRODUCT_ERROR: f64 = 0x1p-40lf;

struct SphereTerms {
    // Squared length of the direction.
    a: f64,
    // Way to the middle of the chord, times `a`.
    b: f64,
    // Squared distance of the origin from the center, and that of the line.
    distance2: f64,
    p2: f64,
    r2: f64,
    // Squared half of the chord; negative where the line misses.
    chord2: f64,
    // Negative inside, positive outside.
    outside: f64,
}

fn sphere_terms(origin: vec3<f64>, direction: vec3<f64>, center: vec3<f64>, radius: f64) -> SphereTerms {
    let from_center = kept3(origin - center);
    let distance2 = dot_unfused(from_center, from_center);
    let a = dot_unfused(direction, direction);
    let b = -dot_unfused(from_center, direction);
    let perpendicular = kept3(from_center + kept3(direction * (b / a)));
    let p2 = dot_unfused(perpendicular, perpendicular);
    let r2 = kept(radius * radius);
    return SphereTerms(a, b, distance2, p2, r2, kept(r2 - p2), kept(distance2 - r2));
}

// True if it is certain whether the line meets the sphere, and the chord is precise.
fn is_chord_clear(terms: SphereTerms) -> bool {
    let chord2 = abs(terms.chord2);
    return kept(PART * kept(terms.p2 + terms.r2)) < chord2
        && kept(kept(PART_SQUARED * terms.distance2) * terms.p2) < kept(chord2 * chord2)
        && kept(PART_SQUARED * terms.distance2) < chord2;
}

// True if it is certain on which side of the sphere the origin is.
fn is_side_clear(terms: SphereTerms) -> bool {
    return kept(PART * kept(terms.distance2 + terms.r2)) < abs(terms.outside);
}

// The same for an origin that may be off by an error.
fn is_apart(terms: SphereTerms, radius: f64, error: f64) -> bool {
    return is_side_clear(terms) && kept(error * kept(kept(2.0 * radius) + error)) < abs(terms.outside);
}

// More than what rounding takes from `b`.
fn error_of_b(terms: SphereTerms) -> f64 {
    return kept(PRODUCT_ERROR * sqrt(kept(terms.distance2 * terms.a)));
}

// The distance to the hit of a ray that meets the sphere.
fn distance_of(terms: SphereTerms) -> f64 {
    let far = terms.outside < 0.0 && terms.b >= 0.0;
    let sum = abs(terms.b) + sqrt(kept(terms.a * terms.chord2));
    return select(abs(terms.outside), sum, far) / select(sum, terms.a, far);
}

// How far a point of a surface may be off by its rounding: `ray.rs` of spherule-core.
fn rounding_of(point: vec3<f64>) -> f64 {
    return kept(kept(kept(abs(point.x) + abs(point.y)) + abs(point.z)) * 0x1p-23lf);
}
