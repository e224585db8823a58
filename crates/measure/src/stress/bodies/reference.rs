//! The first hit of a ray on a convex body with 180 decimal places, the reference for bodies other than spheres.
//!
//! A body is one part or the union of some: points where a quadratic form is at most 0, perhaps between two planes. A line enters
//! and leaves each part where the form is 0 between the planes, or in a plane where the form is at most 0; the first and the last
//! of these points bound the body, as it is convex. Formulas and code are independent of those in `spherule-core`.

use glam::DVec3;
use num_bigint::BigInt;
use spherule_core::internals::capsules::Capsule;
use spherule_core::internals::cones::Cone;
use spherule_core::internals::ellipsoids::Ellipsoid;
use spherule_core::internals::ray::ExactRay;
use spherule_core::internals::triangles::Triangle;
use spherule_render::elementary::power_of_two;

/// Binary places of all numbers.
const PLACES: u64 = 600;

/// Numbers of less than this many binary places are taken for 0: more than what rounding leaves, and less than anything else.
const NOTHING: u64 = 150;

/// A whole number of 2^-600.
type Fixed = BigInt;

type Vector = [Fixed; 3];

/// A body that a ray may hit.
#[derive(Clone, Copy, Debug)]
pub(super) enum Body {
    Capsule(Capsule),
    Ellipsoid(Ellipsoid),
    Cone(Cone),
    Triangle(Triangle),
}

/// A part of a body as a line crosses it: points at `t` with `a t^2 + 2 b t + c <= 0`, and with `start + t slope` from 0 to `height`.
struct Part {
    form: [Fixed; 3],
    slab: Option<Slab>,
}

struct Slab {
    start: Fixed,
    slope: Fixed,
    height: Fixed,
}

/// Returns the distance at which a ray enters a body, or, from within, leaves it; `None` for a miss.
pub(super) fn first_hit(ray: &ExactRay, body: &Body) -> Option<Fixed> {
    let (origin, direction) = (vector(ray.origin), vector(ray.direction));
    let mut at: Vec<Fixed> = match body {
        Body::Triangle(triangle) => of_triangle(triangle, &origin, &direction),
        _ => parts(body, &origin, &direction).iter().flat_map(Part::crossings).collect(),
    };
    if let Body::Cone(cone) = body {
        // At the apex, where the form has no sign to change.
        at.extend(distance_of(&vector(cone.apex), &origin, &direction));
    }
    at.sort_unstable();
    [at.first()?, at.last()?].into_iter().find(|t| is_positive(t)).cloned()
}

/// Returns whether a distance is less than another one, by more than rounding.
pub(super) fn is_less(a: &Fixed, b: &Fixed) -> bool {
    is_positive(&(b - a))
}

/// The nearest double, but for a few units of its last place.
pub(super) fn to_double(x: &Fixed) -> f64 {
    let surplus = x.bits().saturating_sub(64);
    let top = i128::try_from(x >> surplus).unwrap_or(0) as f64;
    top * power_of_two(surplus as i32 - PLACES as i32)
}

fn parts(body: &Body, origin: &Vector, direction: &Vector) -> Vec<Part> {
    match body {
        Body::Ellipsoid(Ellipsoid { center, to_unit }) => {
            let rows = to_unit.map(vector);
            let mapped = |v: &Vector| -> Vector { std::array::from_fn(|i| dot(&rows[i], v)) };
            let (y, w) = (mapped(&minus(origin, &vector(*center))), mapped(direction));
            let c = dot(&y, &y) - fixed(1.0);
            vec![Part { form: [dot(&w, &w), dot(&y, &w), c], slab: None }]
        }
        Body::Capsule(Capsule { ends, radius }) => {
            let ends = ends.map(vector);
            let radius2 = times(&fixed(*radius), &fixed(*radius));
            let sphere = |end: &Vector| {
                let from = minus(origin, end);
                let c = dot(&from, &from) - &radius2;
                Part { form: [dot(direction, direction), dot(&from, direction), c], slab: None }
            };
            let (axis, from) = (minus(&ends[1], &ends[0]), minus(origin, &ends[0]));
            let length2 = dot(&axis, &axis);
            let (n, m) = (cross(&from, &axis), cross(direction, &axis));
            let c = dot(&n, &n) - times(&radius2, &length2);
            let slab = Slab::new(&from, direction, &axis);
            let cylinder = Part { form: [dot(&m, &m), dot(&n, &m), c], slab: Some(slab) };
            vec![sphere(&ends[0]), sphere(&ends[1]), cylinder]
        }
        Body::Cone(Cone { apex, base, radius }) => {
            let apex = vector(*apex);
            let (axis, from) = (minus(&vector(*base), &apex), minus(origin, &apex));
            let (height2, radius) = (dot(&axis, &axis), fixed(*radius));
            // |P x v|^2 v.v - r^2 (P.v)^2.
            let form = |a: &Vector, b: &Vector| {
                let around = times(&dot(&cross(a, &axis), &cross(b, &axis)), &height2);
                let along = times(&times(&radius, &dot(a, &axis)), &times(&radius, &dot(b, &axis)));
                around - along
            };
            let slab = Slab::new(&from, direction, &axis);
            let form = [form(direction, direction), form(&from, direction), form(&from, &from)];
            vec![Part { form, slab: Some(slab) }]
        }
        // It has no quadratic form.
        Body::Triangle(_) => Vec::new(),
    }
}

/// Returns the distance at which a line meets a triangle, by coordinates of the point along two sides; or where it crosses its sides, if it is
/// in its plane.
fn of_triangle(triangle: &Triangle, origin: &Vector, direction: &Vector) -> Vec<Fixed> {
    let corners = triangle.corners.map(vector);
    let sides = [minus(&corners[1], &corners[0]), minus(&corners[2], &corners[0])];
    let normal = cross(&sides[0], &sides[1]);
    let from = minus(&corners[0], origin);
    let (height, slope) = (dot(&from, &normal), dot(direction, &normal));
    if is_zero(&slope) {
        let at =
            |i: usize| on_side([&corners[i], &corners[(i + 1) % 3]], &normal, origin, direction);
        return if is_zero(&height) { (0..3).flat_map(at).collect() } else { Vec::new() };
    }
    // All is multiplied by the slope, so that nothing is rounded that decides.
    let inward = |v: &Vector| -> Vector {
        std::array::from_fn(|i| times(&height, &direction[i]) - times(&slope, &v[i]))
    };
    let point = inward(&from);
    let gram = |i: usize, j: usize| dot(&sides[i], &sides[j]);
    let along = [dot(&point, &sides[0]), dot(&point, &sides[1])];
    let first = times(&gram(1, 1), &along[0]) - times(&gram(0, 1), &along[1]);
    let second = times(&gram(0, 0), &along[1]) - times(&gram(0, 1), &along[0]);
    let third = times(&slope, &dot(&normal, &normal)) - &first - &second;
    let is_up = is_positive(&slope);
    let outside = |weight: &Fixed| is_positive(&if is_up { -weight } else { weight.clone() });
    if [first, second, third].iter().any(outside) {
        Vec::new()
    } else {
        vec![over(&height, &slope)]
    }
}

/// Returns the distances at which a line meets a side of a triangle in whose plane it is.
fn on_side(
    [start, end]: [&Vector; 2],
    normal: &Vector,
    origin: &Vector,
    direction: &Vector,
) -> Vec<Fixed> {
    let (side, from) = (minus(end, start), minus(start, origin));
    let across = dot(&cross(direction, &side), normal);
    let aside = dot(&cross(&from, direction), normal);
    if is_zero(&across) {
        let along = |corner: &Vector| distance_of(corner, origin, direction);
        return if is_zero(&aside) {
            [along(start), along(end)].into_iter().flatten().collect()
        } else {
            Vec::new()
        };
    }
    let place = over(&aside, &across);
    let beyond = is_positive(&-&place) || is_positive(&(place - fixed(1.0)));
    if beyond { Vec::new() } else { vec![over(&dot(&cross(&from, &side), normal), &across)] }
}

impl Slab {
    /// The points between the planes across an axis at its ends.
    fn new(from: &Vector, direction: &Vector, axis: &Vector) -> Self {
        Self { start: dot(from, axis), slope: dot(direction, axis), height: dot(axis, axis) }
    }

    fn holds(&self, t: &Fixed) -> bool {
        let at = &self.start + times(t, &self.slope);
        !is_positive(&-&at) && !is_positive(&(at - &self.height))
    }
}

impl Part {
    /// Distances between the first and the last of which the line is in the part.
    fn crossings(&self) -> Vec<Fixed> {
        let [a, b, c] = &self.form;
        let mut at = Vec::new();
        if !is_zero(a) {
            let rest = times(b, b) - times(a, c);
            if !is_positive(&-&rest) {
                let root = (rest.max(Fixed::ZERO) << PLACES).sqrt();
                at.extend([over(&(&root - b), a), over(&-(root + b), a)]);
            }
        } else if !is_zero(b) {
            at.push(over(&-c, &(b * 2)));
        }
        let Some(slab) = &self.slab else { return at };
        at.retain(|t| slab.holds(t));
        if !is_zero(&slab.slope) {
            for plane in [Fixed::ZERO, slab.height.clone()] {
                let t = over(&(plane - &slab.start), &slab.slope);
                let value = times(&times(a, &t), &t) + times(b, &t) * 2 + c;
                if !is_positive(&value) && slab.holds(&t) {
                    at.push(t);
                }
            }
        }
        at
    }
}

/// The distance of a point, if the line goes through it.
fn distance_of(point: &Vector, origin: &Vector, direction: &Vector) -> Option<Fixed> {
    let (to, length2) = (minus(point, origin), dot(direction, direction));
    let off = cross(&to, direction);
    let meets = is_zero(&dot(&off, &off)) && !is_zero(&length2);
    meets.then(|| over(&dot(&to, direction), &length2))
}

fn is_zero(x: &Fixed) -> bool {
    x.bits() <= NOTHING
}

fn is_positive(x: &Fixed) -> bool {
    *x > Fixed::ZERO && !is_zero(x)
}

fn fixed(x: f64) -> Fixed {
    let mut places = PLACES;
    let mut x = x;
    while x.fract() != 0.0 {
        (places, x) = (places - 1, x * 2.0);
    }
    Fixed::from(x as i128) << places
}

fn vector(v: DVec3) -> Vector {
    v.to_array().map(fixed)
}

fn times(a: &Fixed, b: &Fixed) -> Fixed {
    (a * b) >> PLACES
}

fn over(a: &Fixed, b: &Fixed) -> Fixed {
    (a << PLACES) / b
}

fn minus(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| &a[i] - &b[i])
}

fn dot(a: &Vector, b: &Vector) -> Fixed {
    (&a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]) >> PLACES
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    std::array::from_fn(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        (&a[j] * &b[k] - &a[k] * &b[j]) >> PLACES
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(body: Body, origin: [f64; 3], direction: [f64; 3]) -> Option<f64> {
        let ray =
            ExactRay { origin: origin.into(), direction: direction.into(), origin_error: 0.0 };
        first_hit(&ray, &body).map(|t| to_double(&t))
    }

    #[test]
    fn hits_are_those_of_closed_forms() {
        let capsule = Body::Capsule(Capsule { ends: [DVec3::ZERO, DVec3::X * 4.0], radius: 1.0 });
        assert_eq!(hit(capsule, [2.0, 3.0, 0.0], [0.0, -1.0, 0.0]), Some(2.0));
        assert_eq!(hit(capsule, [-3.0, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(2.0));
        assert_eq!(hit(capsule, [2.0, 0.0, 0.0], [1.0, 0.0, 0.0]), Some(3.0));
        assert_eq!(hit(capsule, [2.0, 1.0, -5.0], [0.0, 0.0, 1.0]), Some(5.0));
        assert_eq!(hit(capsule, [2.0, 1.0_f64.next_up(), -5.0], [0.0, 0.0, 1.0]), None);
        let to_unit = [DVec3::X * 0.5, DVec3::Y, DVec3::Z];
        let ellipsoid = Body::Ellipsoid(Ellipsoid { center: DVec3::Y, to_unit });
        assert_eq!(hit(ellipsoid, [-4.0, 1.0, 0.0], [2.0, 0.0, 0.0]), Some(1.0));
        assert_eq!(hit(ellipsoid, [-4.0, 2.0, 0.0], [2.0, 0.0, 0.0]), Some(2.0));
        let cone = Body::Cone(Cone { apex: DVec3::Z * 4.0, base: DVec3::ZERO, radius: 3.0 });
        assert_eq!(hit(cone, [0.0, 0.0, 9.0], [0.0, 0.0, -1.0]), Some(5.0));
        assert_eq!(hit(cone, [-5.0, 0.0, 4.0], [1.0, 0.0, 0.0]), Some(5.0));
        assert_eq!(hit(cone, [-5.0, 0.0, 2.0], [1.0, 0.0, 0.0]), Some(3.5));
        assert_eq!(hit(cone, [-5.0, 0.0, 5.0], [1.0, 0.0, 0.0]), None);
        assert_eq!(hit(cone, [-3.0, 0.0, 8.0], [3.0, 0.0, -4.0]), Some(1.0));
    }
}
