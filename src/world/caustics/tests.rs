//! Ways of light, held against rays that are reflected and refracted.

mod densities;

use super::ball::{Angle, Ball};
use super::link::{Link, Way, Ways, link};
use crate::lanes::{Doubles, F64x8, Mask};
use crate::shade::dielectric::{Meeting, pass};
use crate::vec3::Vec3;
use glam::DVec3;
use spherule_core::internals::random::Random;
use std::f64::consts::PI;

/// A way in every lane.
fn ways<D: Doubles>(way: Way) -> Ways<D> {
    let every = |is: bool| D::splat(0.0).lt(D::splat(f64::from(u8::from(is))));
    Ways {
        through: every(way != Way::Reflected),
        crosses: every(way == Way::Crossed),
        inner: every(way == Way::Paraxial),
    }
}

/// A ball about the origin, a receiver and a point of a lamp.
struct Setting {
    radius: f64,
    index: f64,
    receiver: DVec3,
    lamp: DVec3,
}

impl Setting {
    /// From near to far, next to the axis too.
    fn random(random: &mut Random) -> Self {
        let radius = 2.0_f64.powf(6.0 * random.unit() - 3.0);
        let far = |random: &mut Random| radius * (1.0 + 10.0_f64.powf(5.0 * random.unit() - 3.0));
        let receiver = random.direction() * far(random);
        let mut toward = random.direction();
        if random.index(3) == 0 {
            toward = (-receiver.normalize() + toward * 0.2 * random.unit()).normalize();
        }
        let index = 1.0 / (1.05 + 1.5 * random.unit());
        Self { radius, index, receiver, lamp: toward * far(random) }
    }

    fn link(&self, way: Way) -> Link<f64> {
        let places = [self.receiver, self.lamp].map(Vec3::from);
        link((self.radius, self.index), places, ways(way))
    }

    fn ball(&self, way: Way) -> Ball<f64> {
        let distance = [self.receiver, self.lamp].map(DVec3::length);
        let index = if way == Way::Reflected { 0.0 } else { self.index };
        Ball::new(self.radius, distance, index)
    }

    /// Where a ray from the receiver leaves the ball, and its direction there: by the equations of
    /// reflection and refraction alone.
    fn trace(&self, direction: DVec3, way: Way) -> Option<(DVec3, DVec3)> {
        let middle = -self.receiver.dot(direction);
        let off2 = (self.receiver + direction * middle).length_squared();
        let half2 = self.radius * self.radius - off2;
        let entry = self.receiver + direction * (middle - (half2 > 0.0).then(|| half2.sqrt())?);
        let choice = if way == Way::Reflected { -1.0 } else { 1.0 };
        let meet = |direction: DVec3, point: DVec3, choice| {
            let normal = (point / self.radius).into();
            let (here, around) = (1.0 / self.index, 1.0);
            let sent = pass(&Meeting { direction: direction.into(), normal, here, around, choice });
            DVec3::new(sent.direction.x, sent.direction.y, sent.direction.z)
        };
        if way == Way::Reflected {
            // A share of 1 is reflected where none is chosen.
            let normal = entry / self.radius;
            return Some((entry, direction - 2.0 * direction.dot(normal) * normal));
        }
        let inside = meet(direction, entry, choice);
        let exit = entry - inside * (2.0 * entry.dot(inside));
        Some((exit, meet(inside, exit, choice)))
    }

    /// Where a ray from the receiver passes the plane through the lamp's point across `axis`.
    fn landing(&self, direction: DVec3, way: Way, axis: DVec3) -> DVec3 {
        let (exit, onward) = self.trace(direction, way).expect("the ray meets the ball");
        exit + onward * ((self.lamp - exit).dot(axis) / onward.dot(axis))
    }
}

fn vector(v: Vec3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

#[test]
fn rays_along_the_ways_that_are_found_meet_the_lamp() {
    let mut random = Random::new(1);
    let mut met = [0; 4];
    for _ in 0..40_000 {
        let setting = Setting::random(&mut random);
        for (way, met) in Way::ALL.into_iter().zip(&mut met) {
            let link = setting.link(way);
            if !link.found {
                continue;
            }
            *met += 1;
            let toward = vector(link.toward);
            assert!((toward.length() - 1.0).abs() < 1e-9);
            let (exit, onward) = setting.trace(toward, way).expect("it meets the ball");
            let far = setting.lamp.length() + setting.receiver.length();
            let tolerance = 1e-6 * far / link.at.cosine;
            assert!(exit.distance(vector(link.exit)) < tolerance, "{way:?}");
            assert!(onward.distance(vector(link.onward)) < 1e-6 / link.at.cosine, "{way:?}");
            let end = exit + onward * link.length[1];
            assert!(end.distance(setting.lamp) < tolerance, "{way:?} {end} {}", setting.lamp);
            assert!(link.length[0] >= 0.0 && link.length[1] >= 0.0);
        }
    }
    assert!(met.iter().all(|&met| met > 1000), "{met:?}");
}

/// How often the turn of rays passes what is looked for, by small steps.
fn roots_by_scan(ball: &Ball<f64>, turn: f64) -> usize {
    const STEPS: u32 = 20_000;
    let rest = |step: u32| {
        let sine = (0.5 * PI * f64::from(step) / f64::from(STEPS)).sin();
        let [k, l] = ball.distance.map(|distance| (ball.radius / distance * sine).acos());
        k + l + 2.0 * (ball.index * sine).acos() - 2.0 * sine.acos() - PI - turn
    };
    (0..STEPS).filter(|&step| (rest(step) < 0.0) != (rest(step + 1) < 0.0)).count()
}

#[test]
fn all_ways_are_found() {
    let mut random = Random::new(2);
    for _ in 0..400 {
        let setting = Setting::random(&mut random);
        let between = setting.receiver.angle_between(setting.lamp);
        let cases = [
            (between, &[Way::Reflected][..]),
            (PI - between, &[Way::Crossed][..]),
            (between - PI, &[Way::Paraxial, Way::Marginal][..]),
        ];
        for (turn, ways) in cases {
            let expected = roots_by_scan(&setting.ball(ways[0]), turn);
            let found = ways.iter().filter(|&&way| setting.link(way).found).count();
            assert_eq!(found, expected, "{ways:?} {turn}");
        }
    }
}

#[test]
fn a_way_is_told_by_its_ray() {
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let setting = Setting::random(&mut random);
        for way in [Way::Crossed, Way::Paraxial, Way::Marginal] {
            let link = setting.link(way);
            if link.found {
                assert_eq!(Way::through(&setting.ball(way).turn(link.at)), way);
            }
        }
    }
}

#[test]
fn the_spread_is_that_of_neighboring_rays() {
    let mut random = Random::new(4);
    let mut compared = [0; 4];
    for _ in 0..20_000 {
        let setting = Setting::random(&mut random);
        for (way, compared) in Way::ALL.into_iter().zip(&mut compared) {
            let link = setting.link(way);
            if !link.found || link.at.cosine < 0.05 {
                continue;
            }
            let (toward, onward) = (vector(link.toward), vector(link.onward));
            let (x, y) = toward.any_orthonormal_pair();
            let step = 1e-6 * setting.radius / setting.receiver.length();
            let moved = |by: DVec3| setting.landing((toward + by).normalize(), way, onward);
            let along = |axis: DVec3| (moved(axis * step) - moved(-axis * step)) / (2.0 * step);
            let expected = along(x).cross(along(y)).length();
            let scale =
                (setting.lamp.length() * setting.receiver.length() / setting.radius).powi(2);
            let tolerance = 1e-4 * expected + 1e-5 * scale;
            assert!(
                (link.spread - expected).abs() < tolerance,
                "{way:?} {} {expected}",
                link.spread
            );
            *compared += 1;
        }
    }
    assert!(compared.iter().all(|&compared| compared > 500), "{compared:?}");
}

#[test]
fn rows_are_what_their_lanes_are() {
    let mut random = Random::new(5);
    for _ in 0..500 {
        let settings: [Setting; 8] = std::array::from_fn(|_| Setting::random(&mut random));
        let column = |of: &dyn Fn(&Setting) -> f64| F64x8::new(settings.each_ref().map(of));
        let place = |of: fn(&Setting) -> DVec3| {
            let axis = |i: usize| column(&|setting| of(setting)[i]);
            Vec3::new(axis(0), axis(1), axis(2))
        };
        let ball = (column(&|s| s.radius), column(&|s| s.index));
        let places = [place(|s| s.receiver), place(|s| s.lamp)];
        for way in Way::ALL {
            let Link { toward, spread, found, .. } = link(ball, places, ways(way));
            for (lane, setting) in settings.iter().enumerate() {
                let one = setting.link(way);
                assert_eq!(found.bits() >> lane & 1 == 1, one.found);
                if one.found {
                    assert_eq!(toward.x.to_array()[lane], one.toward.x);
                    assert_eq!(spread.to_array()[lane], one.spread);
                }
            }
        }
    }
}

/// Alhazen's problem for two points as far away, where the way is known by symmetry.
#[test]
fn a_reflection_between_equals_is_in_the_middle() {
    let ball = Ball::new(1.0, [3.0, 3.0], 0.0);
    for degrees in [1.0_f64, 40.0, 100.0, 140.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let (at, found) = ball.find(Angle { sine, cosine }, false);
        let half = 0.5 * degrees.to_radians();
        let incidence = (3.0 * half.sin()).atan2(3.0 * half.cos() - 1.0);
        assert!(found && (at.sine - incidence.sin()).abs() < 1e-9, "{degrees}");
    }
    let (sine, cosine) = 142.0_f64.to_radians().sin_cos();
    assert!(!ball.find(Angle { sine, cosine }, false).1, "the ball is in between");
}
