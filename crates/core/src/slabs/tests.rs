//! Boxes that have a point on a ray by construction, and boxes in double precision.

use super::*;
use crate::random::Random;
use glam::DVec3;

/// A ray, and a distance along it.
#[derive(Clone, Copy, Debug)]
struct Point {
    origin: Vec3,
    direction: Vec3,
    t: f32,
}

/// A ray from up to 2^20 away, some of them along axes, in planes or nearly so; and a
/// distance, which is sometimes 0.
fn point(random: &mut Random) -> Point {
    let origin = random.in_cube() * random.decades([-6.0, 6.0]);
    let direction = random.direction().to_array().map(|x| match random.index(8) {
        0 => 0.0_f64.copysign(x),
        1 => x * random.decades([-40.0, -1.0]),
        _ => x,
    });
    let direction = DVec3::from(direction).as_vec3();
    // Distances are as in a scene: the ray crosses the margin about a box no sooner.
    let t = if random.index(16) == 0 { 0.0 } else { random.decades([-6.0, 6.0]) };
    Point { origin: origin.as_vec3(), direction, t: t as f32 }
}

impl Point {
    /// Bounds of the point's coordinate on an axis: the same number twice, if there is one.
    fn coordinate(&self, axis: usize) -> [f32; 2] {
        let (origin, way) = (
            f64::from(self.origin[axis]),
            // Of two numbers of single precision: exact.
            f64::from(self.direction[axis]) * f64::from(self.t),
        );
        let sum = origin + way;
        let exact = sum - origin == way && sum - way == origin;
        let [low, high] = if exact { [sum; 2] } else { [sum.next_down(), sum.next_up()] };
        let (below, above) = (low as f32, high as f32);
        [
            if f64::from(below) > low { below.next_down() } else { below },
            if f64::from(above) < high { above.next_up() } else { above },
        ]
    }

    /// A box with the point in it, or on its sides, edges and corners.
    fn box_about(&self, random: &mut Random) -> [[f32; 2]; 3] {
        std::array::from_fn(|axis| {
            let [low, high] = self.coordinate(axis);
            // As all boxes are, where a ray along a side could be distinguished from one beside it.
            let margin = if self.direction[axis].abs() < LEAST { MARGIN } else { 0.0 };
            let mut wider = || if random.coin() { 0.0 } else { random.decades([-7.0, 0.5]) as f32 };
            [low - wider() - margin, high + wider() + margin]
        })
    }
}

/// Eight boxes in the layout of [`Slabs::enters`].
fn planes(boxes: &[[[f32; 2]; 3]; 8]) -> Planes {
    [0, 1, 2].map(|axis| [0, 1].map(|side| boxes.map(|sides| sides[axis][side])))
}

/// Asserts that boxes about points at distances of 0 or more are hit no farther than the points.
fn assert_met(slabs: &impl Slabs, points: &[Point; 8], random: &mut Random) {
    let boxes = points.map(|point| point.box_about(random));
    for (i, point) in points.iter().enumerate() {
        let (met, near) = slabs.enters(&planes(&boxes), point.t);
        let near = near.to_array()[i];
        assert!(met >> i & 1 == 1 && near <= point.t, "{point:?}, {:?}: {near}", boxes[i]);
    }
}

#[test]
fn no_box_with_a_point_on_a_ray_is_missed() {
    let mut random = Random::new(1);
    for _ in 0..100_000 {
        let point = point(&mut random);
        let slabs = RaySlabs::new(point.origin, point.direction);
        assert_met(&slabs, &[point; 8], &mut random);
    }
}

#[test]
fn no_box_near_a_point_on_a_ray_is_missed_by_widened_slabs() {
    let mut random = Random::new(9);
    for _ in 0..100_000 {
        let point = Point { t: random.decades([-3.0, 1.0]) as f32, ..point(&mut random) };
        let slack = random.decades([-5.0, 0.0]);
        let slabs = RaySlabs::new(point.origin, point.direction).widened(slack as f32);
        // Boxes about a point of a line that is beside the ray.
        let beside = random.in_cube() * (0.5 * slack);
        let boxes = [(); 8].map(|()| {
            let sides = point.box_about(&mut random);
            std::array::from_fn(|axis| {
                let [low, high] = sides[axis].map(|side| f64::from(side) + beside[axis]);
                [low as f32, high as f32]
            })
        });
        let (met, near) = slabs.enters(&planes(&boxes), point.t);
        let nearest = near.to_array().into_iter().fold(0.0, f32::max);
        assert!(met == 0xff && nearest <= point.t, "{point:?} {boxes:?}");
    }
}

#[test]
fn no_box_with_a_point_on_a_packets_ray_is_missed() {
    let mut random = Random::new(2);
    for _ in 0..100_000 {
        let first = point(&mut random);
        let spread = random.decades([-6.0, 0.0]);
        let points = [(); 8].map(|()| nearby(&first, spread, &mut random));
        let slabs = between(&points);
        assert_met(&slabs, &points, &mut random);
    }
}

/// A ray from nearby, of the same signs on each axis.
fn nearby(first: &Point, spread: f64, random: &mut Random) -> Point {
    let moved = random.in_cube() * spread * f64::from(first.origin.abs().max_element());
    let turned = (first.direction.as_dvec3() + random.in_cube() * spread).as_vec3();
    let t = first.t * random.between([0.5, 2.0]) as f32;
    Point {
        origin: (first.origin.as_dvec3() + moved).as_vec3(),
        direction: turned.abs().copysign(first.direction),
        t,
    }
}

fn between(points: &[Point; 8]) -> PacketSlabs {
    let bounds = |of: fn(&Point) -> Vec3| {
        let low = points.iter().map(of).reduce(Vec3::min).unwrap_or_default();
        let high = points.iter().map(of).reduce(Vec3::max).unwrap_or_default();
        [row(low), row(high)]
    };
    PacketSlabs::between(bounds(|point| point.origin), bounds(|point| point.direction))
}

/// Returns the distance from entering a box, or the start of the ray, to leaving it. Relative to the
/// distances to the planes and of the origin, as rounding errors are.
fn gap(point: &Point, sides: &[[f32; 2]; 3]) -> f64 {
    let (mut near, mut far, mut size) = (0.0_f64, f64::from(point.t), 0.0_f64);
    for (axis, sides) in sides.iter().enumerate() {
        let (origin, d) = (f64::from(point.origin[axis]), f64::from(point.direction[axis]));
        let [a, b] = sides.map(|side| (f64::from(side) - origin) / d);
        (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        size = size.max(a.abs()).max(b.abs()).max((origin / d).abs());
    }
    (far - near) / size
}

#[test]
fn slab_tests_agree_with_double_precision() {
    let mut random = Random::new(3);
    let (mut hits, mut undecided) = (0, 0);
    for _ in 0..20_000 {
        let ray = Point { t: random.decades([-1.0, 2.0]) as f32, ..point(&mut random) };
        // Toward the boxes, or none would be met.
        let target = random.in_cube() - ray.origin.as_dvec3();
        let direction = target.normalize().as_vec3();
        let ray = Point { t: ray.t * target.length() as f32, direction, ..ray };
        let boxes: [_; 8] = std::array::from_fn(|_| {
            let (center, size) = (random.in_cube(), random.decades([-2.0, 0.0]));
            [0, 1, 2].map(|axis| [center[axis] - size, center[axis] + size].map(|x| x as f32))
        });
        let (met, _) = RaySlabs::new(ray.origin, ray.direction).enters(&planes(&boxes), ray.t);
        for (i, sides) in boxes.iter().enumerate() {
            let gap = gap(&ray, sides);
            if gap.abs() < 1e-5 {
                undecided += 1;
            } else {
                assert_eq!(met >> i & 1 == 1, gap > 0.0, "{ray:?}, {sides:?}: {gap}");
                hits += met >> i & 1;
            }
        }
    }
    assert!(hits > 10_000 && undecided < 80_000, "{hits} {undecided}");
}

#[test]
fn rays_in_lanes_equal_single_rays() {
    let mut random = Random::new(7);
    for _ in 0..500 {
        let rays: [Point; 16] = std::array::from_fn(|_| point(&mut random));
        let columns = |v: fn(&Point) -> Vec3| {
            [0, 1, 2].map(|axis| F32x16::new(rays.each_ref().map(|ray| v(ray)[axis])))
        };
        let mut slabs = [RaySlabs::IDLE; 16];
        RaySlabs::of_rays(columns(|ray| ray.origin), columns(|ray| ray.direction), &mut slabs);
        for (slabs, ray) in slabs.iter().zip(&rays) {
            let one = RaySlabs::new(ray.origin, ray.direction);
            let numbers = |slabs: &RaySlabs, axis: usize| {
                slabs.distances(axis).map(|distance| distance.map(f32::to_bits))
            };
            for axis in 0..3 {
                assert_eq!(numbers(slabs, axis), numbers(&one, axis), "{ray:?}");
                assert_eq!(slabs.is_negative(axis), one.is_negative(axis), "{ray:?}");
            }
            assert_eq!(slabs.octant(), one.octant(), "{ray:?}");
        }
    }
}

#[test]
fn signs_of_the_direction_make_the_octant() {
    let octant = |x, y, z| RaySlabs::new(Vec3::ONE, Vec3::new(x, y, z)).octant();
    assert_eq!([octant(1.0, 0.0, 1.0), octant(-1.0, 1.0, -0.0), octant(0.5, -0.1, 0.0)], [0, 5, 2]);
}
