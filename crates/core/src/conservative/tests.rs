//! The filter against arithmetic without rounding, where it is closest to being wrong.

use super::*;
use crate::exact::{self, Distance};
use crate::intersect;
use crate::lanes::{F32x16, Mask};
use crate::random::Random;
use crate::random::direction_past;
use crate::ray::ExactRay;
use glam::{DVec3, Vec3 as Point};
use std::cmp::Ordering;

/// Origins are no farther from the coordinates' origin.
const REACH: f64 = (1 << 20) as f64;

/// A ray and a sphere in single precision.
#[derive(Clone, Copy, Debug)]
struct Case {
    origin: Point,
    direction: Point,
    center: Point,
    radius: f32,
}

fn lanes(v: Point) -> Vec3<f32> {
    Vec3::new(v.x, v.y, v.z)
}

impl Case {
    fn filter(&self) -> ConservativeRay<f32> {
        ConservativeRay::new(lanes(self.origin), lanes(self.direction))
    }

    fn chord(&self) -> Chord<f32> {
        Chord::new(&self.filter(), lanes(self.center), self.radius)
    }

    fn enters(&self) -> (bool, f32) {
        let (filter, chord) = (self.filter(), self.chord());
        let enters = chord.enters(&filter, self.radius, &filter.margin());
        (enters, chord.near_at_most(self.radius, &filter.margin()))
    }

    fn exact(&self, on_surface: bool) -> ExactRay {
        ExactRay::new(self.origin, self.direction, on_surface)
    }

    fn sphere(&self) -> (DVec3, f64) {
        (self.center.as_dvec3(), f64::from(self.radius))
    }

    fn hit(&self) -> Option<f64> {
        let (center, radius) = self.sphere();
        exact::hit(&self.exact(false), center, radius)
    }

    /// Compares the distance of the hit that there is with a number, exactly.
    fn compare(&self, t: f32) -> Ordering {
        let (center, radius) = self.sphere();
        let hit = Distance::Hit(center, radius);
        exact::compare(&self.exact(false), &hit, &Distance::Number(f64::from(t)))
    }
}

/// A sphere of any size up to that of its world, and a ray that starts anywhere next to it: at
/// 1e-7 to 1e7 times the radius, close to the surface, or on it but for the last bits.
fn case(random: &mut Random) -> Case {
    let ratio = random.decades([-7.0, 7.0]);
    let radius = random.decades([-7.0, 0.0]).min(REACH / 2.0 * ratio) as f32;
    let place = if random.coin() { 0.0 } else { random.decades([-7.0, 0.0]) };
    let center = (random.direction() * place).as_vec3();
    let distance = match random.index(4) {
        0 => 1.0,
        1 => 1.0 + random.sign() * random.decades([-9.0, -1.0]),
        _ => 1.0 / ratio,
    } * f64::from(radius);
    let start = (center.as_dvec3() + random.direction() * distance).as_vec3();
    let origin = Point::from(start.to_array().map(|x| nudged(x, random)));
    let toward = center.as_dvec3() - origin.as_dvec3();
    let offset = match random.index(5) {
        0 => 0.0,
        1 => 1.0,
        2 => 1.0 + random.sign() * random.decades([-9.0, -1.0]),
        _ => 1.2 * random.unit().sqrt(),
    };
    let ahead = if random.index(8) == 0 { -1.0 } else { 1.0 };
    let line = direction_past(toward, offset * f64::from(radius), random) * ahead;
    let direction = (line * random.between([0.5, 2.0])).as_vec3();
    Case { origin, direction, center, radius }
}

/// The number, or one that is close to it.
fn nudged(x: f32, random: &mut Random) -> f32 {
    match random.index(6) {
        0 => x.next_up(),
        1 => x.next_down(),
        _ => x,
    }
}

/// The ordinary: spheres of a scene, seen from outside, most of them hit.
fn ordinary(random: &mut Random) -> Case {
    let radius = random.decades([-2.0, -0.5]) as f32;
    let center = random.in_cube().as_vec3();
    let distance = f64::from(radius) * random.decades([0.1, 2.0]);
    let origin = (center.as_dvec3() + random.direction() * distance).as_vec3();
    let toward = center.as_dvec3() - origin.as_dvec3();
    let offset = 1.2 * random.unit().sqrt() * f64::from(radius);
    let direction = direction_past(toward, offset, random).as_vec3();
    Case { origin, direction, center, radius }
}

#[test]
fn no_hit_is_rejected() {
    let mut random = Random::new(1);
    let (mut hits, mut edges) = (0, 0);
    for _ in 0..400_000 {
        let case = case(&mut random);
        let Some(t) = case.hit() else { continue };
        // The least number that is not before the hit.
        let near = t as f32;
        let t_max = if case.compare(near).is_gt() { near.next_up() } else { near };
        let chord = case.chord();
        assert!(chord.may_hit(t_max) && chord.may_hit(f32::INFINITY), "{case:?} at {t}");
        hits += 1;
        edges += i32::from(!case.enters().0);
    }
    assert!(hits > 200_000 && edges > 50_000 && hits - edges > 40_000, "{hits} {edges}");
}

#[test]
fn certain_hits_are_true_and_bounded() {
    let mut random = Random::new(2);
    let mut certain = 0;
    for _ in 0..400_000 {
        let case = case(&mut random);
        let (enters, far) = case.enters();
        if !enters {
            continue;
        }
        certain += 1;
        let near = case.chord().near();
        assert!(case.hit().is_some() && near > 0.0, "{case:?}");
        assert!(case.compare(near).is_ge() && case.compare(far).is_le(), "{case:?}: {near} {far}");
        // Nor is it within the band of an origin that was rounded.
        let (center, radius) = case.sphere();
        let inside = || unreachable!("{case:?} is outside the band");
        let root = intersect::confirm(&case.exact(true), center, radius, inside);
        let root = root.unwrap_or_else(|| panic!("{case:?} is a hit"));
        assert!(root.t >= f64::from(near) * (1.0 - 1e-9), "{case:?}");
        assert!(root.t <= f64::from(far) * (1.0 + 1e-9), "{case:?}");
    }
    assert!(certain > 40_000, "{certain}");
}

#[test]
fn certain_exits_start_inside_and_are_bounded() {
    let mut random = Random::new(6);
    let mut certain = 0;
    for _ in 0..400_000 {
        let case = case(&mut random);
        let (filter, chord) = (case.filter(), case.chord());
        let (leaves, [least, most]) = chord.leaves(&filter, case.radius, &filter.margin());
        if !leaves {
            continue;
        }
        certain += 1;
        assert!(case.hit().is_some() && least > 0.0, "{case:?}");
        assert!(
            case.compare(least).is_ge() && case.compare(most).is_le(),
            "{case:?}: {least} {most}"
        );
        let (center, radius) = case.sphere();
        assert!(exact::is_inside(case.exact(false).origin, center, radius), "{case:?}");
        // Nor is it within the band of an origin that was rounded.
        let inside = || unreachable!("{case:?} is within the band");
        let root = intersect::confirm(&case.exact(true), center, radius, inside);
        let root = root.unwrap_or_else(|| panic!("{case:?} is a hit"));
        assert!(root.t >= f64::from(least) * (1.0 - 1e-9), "{case:?}");
        assert!(root.t <= f64::from(most) * (1.0 + 1e-9), "{case:?}");
    }
    assert!(certain > 40_000, "{certain}");
}

#[test]
fn the_origins_error_is_no_less_than_that_of_the_decision() {
    let mut random = Random::new(3);
    for _ in 0..10_000 {
        let case = case(&mut random);
        assert!(f64::from(case.filter().origin_error()) >= case.exact(true).origin_error);
    }
}

#[test]
fn few_ordinary_rays_are_undecided() {
    const RAYS: i32 = 200_000;
    let mut random = Random::new(4);
    let (mut open, mut widest) = (0, 0.0_f32);
    for _ in 0..RAYS {
        let case = ordinary(&mut random);
        let chord = case.chord();
        let (enters, far) = case.enters();
        open += i32::from(chord.may_hit(f32::INFINITY) && !enters);
        if enters && case.direction.dot(case.center - case.origin) > case.radius {
            widest = widest.max((far - chord.near()) / far);
        }
    }
    assert!(f64::from(open) < 1e-3 * f64::from(RAYS), "{open} of {RAYS}");
    assert!(open > 0 && widest < 0.2, "{open}, {widest}");
}

#[test]
fn every_lane_width_agrees() {
    let mut random = Random::new(5);
    for _ in 0..1000 {
        let cases: [Case; 16] = std::array::from_fn(|_| case(&mut random));
        let column = |x: fn(&Case) -> f32| F32x16::new(cases.each_ref().map(x));
        let vector = |v: fn(&Case) -> Point| {
            let [x, y, z] = [0, 1, 2].map(|axis| F32x16::new(cases.map(|case| v(&case)[axis])));
            Vec3::new(x, y, z)
        };
        let radius = column(|case| case.radius);
        let filter =
            ConservativeRay::new(vector(|case| case.origin), vector(|case| case.direction));
        let chord = Chord::new(&filter, vector(|case| case.center), radius);
        let certain = chord.enters(&filter, radius, &filter.margin());
        let far = chord.near_at_most(radius, &filter.margin());
        let mut rows = [ConservativeRow::NONE; 16];
        filter.rows(&mut rows);
        let (met, near) = (chord.may_hit(F32x16::splat(1.0)).bits(), chord.near().to_array());
        for (lane, case) in cases.iter().enumerate() {
            let one = case.chord();
            let (enters, distance) = case.enters();
            let bit = |bits: u32| bits >> lane & 1 == 1;
            assert_eq!((bit(met), bit(certain.bits())), (one.may_hit(1.0), enters), "{case:?}");
            assert_eq!(near[lane].to_bits(), one.near().to_bits(), "{case:?}");
            let row = ConservativeRay::from(rows[lane]);
            assert_eq!(format!("{row:?}"), format!("{:?}", case.filter()), "{case:?}");
            assert_eq!(far.to_array()[lane].to_bits(), distance.to_bits(), "{case:?}");
        }
    }
}
