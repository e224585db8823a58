//! The tests of `hits.wgsl`, operation by operation, on the worst device that keeps the promises of WGSL.
//!
//! Every operation rounds up or down as chance has it, products are fused with sums or not, sums are taken in any
//! order, and numbers that are too small become 0 or not. What the kernel calls certain must hold all the same:
//! docs/gpu.md has the proof. Names are those of the kernel.

use crate::nodes::Grid;
use spherule_core::internals::intersect::confirm;
use spherule_core::internals::random::Random;
use spherule_core::internals::ray::{ExactRay, MISS};
use spherule_core::{RayColumns, SphereTree};
use spherule_measure::stress::{REGIMES, sample};

const E: f32 = f32::EPSILON;
const K: f32 = 20.0 * E;
const TINY: f32 = 1.0 / (1_u64 << 60) as f32;
const TINY_SQUARE: f32 = 1.0 / (1_u128 << 100) as f32;
const SLACK: f32 = 16.0 * E;
const STEPS: f32 = 256.0;
const LEAST: f32 = TINY_SQUARE;

/// The way in which a device rounds.
#[derive(Clone, Copy, Debug)]
enum Rounding {
    Nearest,
    Up,
    Down,
    /// Away from 0, and toward it.
    Away,
    Toward,
    Any,
}

const ROUNDINGS: [Rounding; 6] = [
    Rounding::Nearest,
    Rounding::Up,
    Rounding::Down,
    Rounding::Away,
    Rounding::Toward,
    Rounding::Any,
];

/// The worst device.
struct Machine {
    rounding: Rounding,
    random: Random,
}

type V = [f32; 3];

impl Machine {
    /// One of the two neighbors of a number; the number itself if it is single.
    fn round(&mut self, x: f64) -> f32 {
        let nearest = x as f32;
        let rounded = if f64::from(nearest) == x {
            nearest
        } else {
            let (low, high) = if f64::from(nearest) < x {
                (nearest, nearest.next_up())
            } else {
                (nearest.next_down(), nearest)
            };
            let outward = if x < 0.0 { low } else { high };
            let inward = if x < 0.0 { high } else { low };
            match self.rounding {
                Rounding::Nearest => nearest,
                Rounding::Up => high,
                Rounding::Down => low,
                Rounding::Away => outward,
                Rounding::Toward => inward,
                Rounding::Any => {
                    if self.random.coin() {
                        low
                    } else {
                        high
                    }
                }
            }
        };
        if rounded.is_subnormal() && self.random.coin() { 0.0 } else { rounded }
    }

    fn add(&mut self, x: f32, y: f32) -> f32 {
        self.round(f64::from(x) + f64::from(y))
    }

    fn sub(&mut self, x: f32, y: f32) -> f32 {
        self.add(x, -y)
    }

    fn mul(&mut self, x: f32, y: f32) -> f32 {
        self.round(f64::from(x) * f64::from(y))
    }

    /// A product and a sum, fused or not.
    fn mul_add(&mut self, x: f32, y: f32, z: f32) -> f32 {
        if self.random.coin() {
            return self.round(f64::from(x) * f64::from(y) + f64::from(z));
        }
        let product = self.mul(x, y);
        self.add(product, z)
    }

    /// `1 / x`, off by up to two and a half units.
    fn inverse(&mut self, x: f32) -> f32 {
        let nearest = (1.0 / f64::from(x)) as f32;
        match self.random.index(5) {
            0 => nearest.next_up().next_up(),
            1 => nearest.next_down().next_down(),
            2 => nearest.next_up(),
            3 => nearest.next_down(),
            _ => nearest,
        }
    }

    /// A root that is as bad as it likes: the kernel does not trust it.
    fn sqrt(&mut self, x: f32) -> f32 {
        let factor = match self.random.index(6) {
            0 => 1.0 + 1e-5 * self.random.unit() as f32,
            1 => 1.0 - 1e-5 * self.random.unit() as f32,
            2 => 1.0 + 4.0 * E,
            3 => 1.0 - 4.0 * E,
            _ => 1.0,
        };
        x.sqrt() * factor
    }

    /// A sum of products, in any order, fused or not.
    fn sum(&mut self, mut terms: Vec<[f32; 2]>) -> f32 {
        let [x, y] = terms.swap_remove(self.random.index(terms.len()));
        let mut sum = self.mul(x, y);
        while !terms.is_empty() {
            let [x, y] = terms.swap_remove(self.random.index(terms.len()));
            sum = self.mul_add(x, y, sum);
        }
        sum
    }

    fn dot(&mut self, v: V, w: V) -> f32 {
        self.sum((0..3).map(|i| [v[i], w[i]]).collect())
    }

    fn root_above(&mut self, x: f32) -> f32 {
        let least = x.max(TINY_SQUARE);
        let root = self.sqrt(least);
        let root = self.mul(root, 1.0 + 16.0 * E);
        let proven = self.mul(root, root) >= self.mul(least, 1.0 + 4.0 * E);
        if proven { root } else { least.max(1.0) }
    }

    fn root_below(&mut self, x: f32) -> f32 {
        let root = self.sqrt(x.max(TINY_SQUARE));
        let root = self.mul(root, 1.0 - 16.0 * E);
        let proven = x >= TINY_SQUARE && self.mul(root, root) <= self.mul(x, 1.0 - 4.0 * E);
        if proven { root } else { 0.0 }
    }
}

/// A ray as the kernel prepares it.
struct Ray {
    origin: V,
    direction: V,
    own: u32,
    length2: f32,
    inverse_length2: f32,
    length: f32,
    origin_error: f32,
}

impl Ray {
    fn new(machine: &mut Machine, origin: V, direction: V, own: u32) -> Self {
        let length2 = machine.dot(direction, direction);
        let inverse_length2 = machine.inverse(length2);
        let above = machine.mul(length2, 1.0 + 8.0 * E);
        let length = machine.root_above(above);
        let span = machine.sum(origin.map(|x| [x.abs(), 1.0]).to_vec());
        let error = machine.mul(span, E * (1.0 + 8.0 * E));
        let origin_error = if own == MISS { 0.0 } else { error };
        Self { origin, direction, own, length2, inverse_length2, length, origin_error }
    }
}

/// Result of the test of a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Verdict {
    /// It is not hit.
    Missed,
    /// It is not hit before this.
    Unknown(f32),
    /// It is hit within this.
    Hit([f32; 2]),
}

fn is_near(machine: &mut Machine, ray: &Ray, center: V, radius: f32) -> bool {
    let to_center = [0, 1, 2].map(|i| machine.sub(center[i], ray.origin[i]));
    let along = machine.dot(to_center, ray.direction);
    let middle = machine.mul(along, ray.inverse_length2);
    let perpendicular = [0, 1, 2].map(|i| machine.mul_add(-middle, ray.direction[i], to_center[i]));
    let slack = machine.mul(middle.abs(), K);
    let reach = machine.sum(vec![[radius, 1.0 + K], [slack, ray.length], [TINY, 1.0]]);
    machine.dot(perpendicular, perpendicular) <= machine.mul(reach, reach)
}

fn test_sphere(machine: &mut Machine, ray: &Ray, center: V, radius: f32) -> Verdict {
    let to_center = [0, 1, 2].map(|i| machine.sub(center[i], ray.origin[i]));
    let along = machine.dot(to_center, ray.direction);
    let middle = machine.mul(along, ray.inverse_length2);
    let perpendicular = [0, 1, 2].map(|i| machine.mul_add(-middle, ray.direction[i], to_center[i]));
    let squares = || perpendicular.map(|x| [-x, x]).to_vec();
    let slack = machine.mul(middle.abs(), K);
    let band = machine.mul_add(slack, ray.length, TINY);
    let reach = machine.mul_add(radius, 1.0 + K, band);
    let mut terms = squares();
    terms.push([reach, reach]);
    let chord2 = machine.sum(terms);
    if chord2 < 0.0 {
        return Verdict::Missed;
    }
    let scaled = machine.mul(chord2, ray.inverse_length2);
    let root = machine.root_above(scaled);
    let half = machine.mul_add(root, 1.0 + 2.0 * K, slack);
    let enter_low = machine.sub(middle, half);
    let leave_high = machine.add(middle, half);
    if leave_high < 0.0 {
        return Verdict::Missed;
    }
    let inner = machine.mul_add(radius, 1.0 - K, -band);
    let mut terms = squares();
    terms.push([inner, inner]);
    let inner2 = machine.sum(terms);
    let unknown = Verdict::Unknown(enter_low.max(0.0));
    if !(inner > 0.0 && inner2 > 0.0) {
        return unknown;
    }
    let scaled = machine.mul(inner2, ray.inverse_length2);
    let root = machine.root_below(scaled);
    let least = machine.mul_add(root, 1.0 - 2.0 * K, -slack);
    let enter_high = machine.sub(middle, least);
    let leave_low = machine.add(middle, least);
    let mut edge = TINY_SQUARE;
    if ray.own != MISS {
        let error = ray.origin_error;
        let mut terms = to_center.map(|x| [x, x]).to_vec();
        terms.push([radius, radius]);
        let size = machine.sum(terms);
        let sum = machine.mul_add(2.0, radius, error);
        let size = machine.mul(size, 1.0 / (1_u64 << 36) as f32);
        let both = machine.mul_add(error, sum, size);
        edge = machine.mul_add(both, 1.0 + 32.0 * E, edge);
    }
    let scale = machine.mul(ray.length2, 1.0 - 32.0 * E);
    let mut beyond = |x: f32, y: f32| {
        let product = machine.mul(x, y);
        ray.own == MISS || machine.mul(product, scale) > edge
    };
    if enter_low > 0.0 && beyond(enter_low, leave_low) {
        Verdict::Hit([enter_low, enter_high])
    } else if enter_low > 0.0 {
        unknown
    } else if enter_high < 0.0 && leave_low > 0.0 && beyond(-enter_high, leave_low) {
        Verdict::Hit([leave_low, leave_high])
    } else {
        unknown
    }
}

/// Counts of verdicts.
#[derive(Debug, Default)]
struct Counts {
    missed: u32,
    unknown: u32,
    hit: u32,
}

impl Counts {
    /// Compares a verdict with the truth.
    fn check(&mut self, verdict: Verdict, truth: Option<[f64; 2]>, what: impl Fn() -> String) {
        match verdict {
            Verdict::Missed => {
                self.missed += 1;
                assert_eq!(truth, None, "{}", what());
            }
            Verdict::Unknown(low) => {
                self.unknown += 1;
                assert!(
                    truth.is_none_or(|[_, t]| f64::from(low) <= t),
                    "{}: {low} {truth:?}",
                    what()
                );
            }
            Verdict::Hit([low, high]) => {
                self.hit += 1;
                let within =
                    |[least, most]: [f64; 2]| f64::from(low) <= most && least <= f64::from(high);
                assert!(truth.is_some_and(within), "{}: {low} {high} {truth:?}", what());
            }
        }
    }
}

/// Returns bounds of the distance at which a ray hits a sphere.
fn truth(ray: &ExactRay, center: V, radius: f32) -> Option<[f64; 2]> {
    let root = confirm(ray, glam::Vec3::from(center).as_dvec3(), f64::from(radius), || false)?;
    Some([root.t - root.error, root.t + root.error])
}

#[test]
fn what_is_certain_on_the_worst_device_is_true_on_all_stress_regimes() {
    let mut machine = Machine { rounding: Rounding::Any, random: Random::new(5) };
    for regime in &REGIMES {
        let mut counts = Counts::default();
        let mut random = Random::new(9);
        for scene in 0..60 {
            let (spheres, rays) = sample(regime, 40, &mut random);
            let tree = SphereTree::from_rows(&spheres).unwrap();
            let column = |i: usize| -> Vec<f32> {
                let of = |ray: &spherule_measure::stress::rays::Ray| {
                    if i < 3 { ray.origin[i] } else { ray.direction[i - 3] }
                };
                rays.iter().map(of).collect()
            };
            let columns: [Vec<f32>; 6] = std::array::from_fn(column);
            let [x, y, z, u, v, w] = &columns;
            let columns = RayColumns { origin: [x, y, z], direction: [u, v, w] };
            let bounds = vec![f64::INFINITY; rays.len()];
            let (scaled, bounds) = tree.scaled_rays(&columns, &bounds).unwrap();
            let spheres = tree.parts().spheres;
            if !spheres.precise.is_empty() {
                continue;
            }
            for row in (0..scaled.len()).filter(|&row| bounds.t[row] > 0.0) {
                let (origin, direction) = (scaled.origin.row(row), scaled.direction.row(row));
                for sphere in 0..spheres.len() {
                    let (center, radius) =
                        (spheres.center(sphere).to_array(), spheres.radius(sphere));
                    let own = if (scene + row) % 2 == 0 { MISS } else { 0 };
                    let exact = ExactRay::new(origin, direction, own != MISS);
                    machine.rounding = ROUNDINGS[(scene + row + sphere) % ROUNDINGS.len()];
                    let ray = Ray::new(&mut machine, origin.to_array(), direction.to_array(), own);
                    let verdict = test_sphere(&mut machine, &ray, center, radius);
                    let rounding = machine.rounding;
                    let what =
                        || format!("{} {rounding:?} {exact:?} {center:?} {radius}", regime.name);
                    let truth = truth(&exact, center, radius);
                    let near = is_near(&mut machine, &ray, center, radius);
                    assert!(near || truth.is_none(), "{}", what());
                    counts.check(verdict, truth, what);
                }
            }
        }
    }
}

/// Spheres of every size at every distance, and rays that nearly touch them: where the bounds matter.
#[test]
fn what_is_certain_on_the_worst_device_is_true_at_tangents() {
    let mut machine = Machine { rounding: Rounding::Any, random: Random::new(6) };
    let mut random = Random::new(2);
    let (mut counts, mut far) = (Counts::default(), 0);
    for round in 0..200_000 {
        let origin = (random.direction() * random.decades([-3.0, 5.0])).as_vec3();
        let center = random.in_cube().as_vec3();
        let toward = (center - origin).as_dvec3();
        let radius = (toward.length() * random.decades([-6.0, -0.1])) as f32;
        // About as far off as single precision can tell.
        let band = f64::from(E) * (1.0 + toward.length() / f64::from(radius));
        let off = random.sign() * band * random.decades([-1.0, 2.5]);
        let past = f64::from(radius) * (1.0 + off).max(0.0);
        let direction = spherule_core::internals::random::direction_past(toward, past, &mut random);
        let longest = direction.abs().max_element();
        let direction = (direction * (random.between([1.0, 1.99]) / longest)).as_vec3();
        let own = if round % 2 == 0 { MISS } else { 0 };
        machine.rounding = ROUNDINGS[round % ROUNDINGS.len()];
        let ray = Ray::new(&mut machine, origin.to_array(), direction.to_array(), own);
        let verdict = test_sphere(&mut machine, &ray, center.to_array(), radius);
        let exact = ExactRay::new(origin, direction, own != MISS);
        let rounding = machine.rounding;
        let what = || format!("{rounding:?} {exact:?} {center:?} {radius}");
        let truth = truth(&exact, center.to_array(), radius);
        let near = is_near(&mut machine, &ray, center.to_array(), radius);
        assert!(near || truth.is_none(), "{}", what());
        far += u32::from(!near);
        counts.check(verdict, truth, what);
    }
    assert!(far > 10_000, "{far}");
    assert!(counts.missed > 10_000 && counts.unknown > 10_000 && counts.hit > 10_000, "{counts:?}");
}

/// The kernel's test of a box on a grid, by axis: whether the ray may enter it before `t_far`.
fn enters(
    machine: &mut Machine,
    origin: V,
    direction: V,
    boxes: [(Grid, [u8; 2]); 3],
    t_far: f32,
) -> bool {
    let (mut near, mut far) = (0.0_f32, t_far);
    for axis in 0..3 {
        let (grid, steps) = boxes[axis];
        let d = direction[axis];
        let kept =
            if d.abs() < LEAST { LEAST.copysign(if d < 0.0 { -1.0 } else { 1.0 }) } else { d };
        let inverse = machine.inverse(kept);
        let step = machine.mul(f32::from_bits(((grid.exponent + 127) as u32) << 23), inverse);
        let to_corner = machine.sub(grid.corner, origin[axis]);
        let width = machine.mul(step.abs(), STEPS);
        let side = usize::from(kept < 0.0);
        // The sum in any order, with the quotient taken of each term or of the sum.
        let mut plane = |steps: u8, sign: f32| {
            let base = machine.mul(to_corner, inverse);
            let slack = machine.mul_add(base.abs(), SLACK, SLACK * width);
            let mut terms = vec![[f32::from(steps), step], [sign, slack]];
            if machine.random.coin() {
                terms.push([to_corner, inverse]);
            } else {
                terms.push([base, 1.0]);
            }
            machine.sum(terms)
        };
        near = near.max(plane(steps[side], -1.0));
        far = far.min(plane(steps[1 - side], 1.0));
    }
    near <= far
}

#[test]
fn no_box_that_a_ray_enters_is_left_out_on_the_worst_device() {
    /// By which boxes are wider than what is in them.
    const MARGIN: f64 = 1.0 / (1_u64 << 56) as f64;
    let mut machine = Machine { rounding: Rounding::Any, random: Random::new(7) };
    let mut random = Random::new(4);
    let mut refused = 0;
    for round in 0..200_000 {
        machine.rounding = ROUNDINGS[round % ROUNDINGS.len()];
        let point = random.in_cube();
        let mut direction = random.direction();
        if round % 7 == 0 {
            direction[round / 7 % 3] *= random.decades([-40.0, -1.0]);
        }
        let longest = direction.abs().max_element();
        let direction = (direction * (1.5 / longest)).as_vec3();
        let origin = (point - direction.as_dvec3() * random.decades([-4.0, 5.0])).as_vec3();
        // The point of the ray, now that it is rounded.
        let t = (point - origin.as_dvec3()).dot(direction.as_dvec3())
            / direction.as_dvec3().length_squared();
        if t <= 0.0 {
            continue;
        }
        let at = origin.as_dvec3() + direction.as_dvec3() * t;
        // A box that the ray touches in a corner, or that is flat.
        let boxes = [0, 1, 2].map(|axis| {
            // What double precision may be off, and the margin.
            let error =
                MARGIN + 4.0 * f64::EPSILON * (f64::from(origin[axis].abs()) + at[axis].abs());
            let low = ((at[axis] - error) as f32).next_down();
            let high = ((at[axis] + error) as f32).next_up();
            let wide = random.decades([-8.0, -1.0]) as f32;
            let own = match random.index(3) {
                0 => [low, high],
                1 => [low, high + wide],
                _ => [low - wide, high],
            };
            // Other children widen the grid.
            let beside = |x: f32, sign: f32, random: &mut Random| {
                let by = random.decades([-8.0, 0.0]) as f32;
                if random.coin() { x } else { x + sign * by }
            };
            let other = [beside(own[0], -1.0, &mut random), beside(own[1], 1.0, &mut random)];
            let sides = [0, 1].map(|side| [own[side], other[side], 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
            let grid = Grid::about(&sides, [0, 1, 2, 3, 4, 5, 6, 7].map(|child| child < 2));
            let steps = grid.steps(own);
            assert!(grid.plane(steps[0]) <= f64::from(own[0]), "{grid:?} {own:?}");
            assert!(grid.plane(steps[1]) >= f64::from(own[1]), "{grid:?} {own:?}");
            (grid, steps)
        });
        let t_far = (t as f32).next_up();
        let entered = enters(&mut machine, origin.to_array(), direction.to_array(), boxes, t_far);
        assert!(entered, "{:?} {origin:?} {direction:?} {boxes:?} {t}", machine.rounding);
        // Far beside it, none.
        let aside = boxes.map(|(grid, steps)| (Grid { corner: grid.corner + 9.0, ..grid }, steps));
        refused +=
            u32::from(!enters(&mut machine, origin.to_array(), direction.to_array(), aside, t_far));
    }
    assert!(refused > 100_000, "{refused}");
}
