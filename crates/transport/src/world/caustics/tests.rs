//! Tests of connections against rays that are reflected and refracted.

mod densities;

use super::connection::{CausticPath, Connection, PathMasks, connect};
use super::specular_sphere::{Angle, SpecularSphere};
use crate::lanes::{Doubles, F64x8, Mask};
use crate::shade::dielectric::{Interface, scatter};
use crate::vec3::Vec3;
use glam::DVec3;
use spherule_core::internals::random::Random;
use std::f64::consts::PI;

/// Masks of a path in every lane.
fn paths<D: Doubles>(path: CausticPath) -> PathMasks<D> {
    let every = |is: bool| D::splat(0.0).lt(D::splat(f64::from(u8::from(is))));
    PathMasks {
        through: every(path != CausticPath::Reflected),
        crosses: every(path == CausticPath::Crossed),
        inner: every(path == CausticPath::Paraxial),
    }
}

/// A sphere about the origin, a receiver and a point of an emitter.
struct Setting {
    radius: f64,
    index: f64,
    receiver: DVec3,
    emitter: DVec3,
}

impl Setting {
    /// Random settings from near to far, some next to the axis.
    fn random(random: &mut Random) -> Self {
        let radius = 2.0_f64.powf(6.0 * random.unit() - 3.0);
        let far = |random: &mut Random| radius * (1.0 + 10.0_f64.powf(5.0 * random.unit() - 3.0));
        let receiver = random.direction() * far(random);
        let mut toward = random.direction();
        if random.index(3) == 0 {
            toward = (-receiver.normalize() + toward * 0.2 * random.unit()).normalize();
        }
        let index = 1.0 / (1.05 + 1.5 * random.unit());
        Self { radius, index, receiver, emitter: toward * far(random) }
    }

    fn connect(&self, path: CausticPath) -> Connection<f64> {
        let places = [self.receiver, self.emitter].map(Vec3::from);
        connect(self.radius, self.index, places, paths(path))
    }

    fn sphere(&self, path: CausticPath) -> SpecularSphere<f64> {
        let distance = [self.receiver, self.emitter].map(DVec3::length);
        let index = if path == CausticPath::Reflected { 0.0 } else { self.index };
        SpecularSphere::new(self.radius, distance, index)
    }

    /// Returns where a ray from the receiver leaves the sphere, and its direction there, by the equations of
    /// reflection and refraction alone.
    fn trace(&self, direction: DVec3, path: CausticPath) -> Option<(DVec3, DVec3)> {
        let middle = -self.receiver.dot(direction);
        let off2 = (self.receiver + direction * middle).length_squared();
        let half2 = self.radius * self.radius - off2;
        let entry = self.receiver + direction * (middle - (half2 > 0.0).then(|| half2.sqrt())?);
        let choice = if path == CausticPath::Reflected { -1.0 } else { 1.0 };
        let scatter_at = |direction: DVec3, point: DVec3, choice| {
            let normal = (point / self.radius).into();
            let (here, around) = (1.0 / self.index, 1.0);
            let sample = scatter(&Interface {
                direction: direction.into(),
                normal,
                ior_inside: here,
                ior_outside: around,
                choice,
            });
            DVec3::new(sample.direction.x, sample.direction.y, sample.direction.z)
        };
        if path == CausticPath::Reflected {
            // The reflection of a mirror, without the choice at a dielectric interface.
            let normal = entry / self.radius;
            return Some((entry, direction - 2.0 * direction.dot(normal) * normal));
        }
        let inside = scatter_at(direction, entry, choice);
        let exit = entry - inside * (2.0 * entry.dot(inside));
        Some((exit, scatter_at(inside, exit, choice)))
    }

    /// Returns where a ray from the receiver crosses the plane through the emitter's point across `axis`.
    fn landing(&self, direction: DVec3, path: CausticPath, axis: DVec3) -> DVec3 {
        let (exit, toward_emitter) = self.trace(direction, path).expect("the ray meets the sphere");
        exit + toward_emitter * ((self.emitter - exit).dot(axis) / toward_emitter.dot(axis))
    }
}

fn vector(v: Vec3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

#[test]
fn rays_along_connections_reach_the_emitter() {
    let mut random = Random::new(1);
    let mut met = [0; 4];
    for _ in 0..40_000 {
        let setting = Setting::random(&mut random);
        for (path, met) in CausticPath::ALL.into_iter().zip(&mut met) {
            let connection = setting.connect(path);
            if !connection.found {
                continue;
            }
            *met += 1;
            let toward = vector(connection.toward);
            assert!((toward.length() - 1.0).abs() < 1e-9);
            let (exit, toward_emitter) = setting.trace(toward, path).expect("it meets the sphere");
            let far = setting.emitter.length() + setting.receiver.length();
            let tolerance = 1e-6 * far / connection.at.cosine;
            assert!(exit.distance(vector(connection.exit)) < tolerance, "{path:?}");
            assert!(
                toward_emitter.distance(vector(connection.toward_emitter))
                    < 1e-6 / connection.at.cosine,
                "{path:?}"
            );
            let end = exit + toward_emitter * connection.length[1];
            assert!(
                end.distance(setting.emitter) < tolerance,
                "{path:?} {end} {}",
                setting.emitter
            );
            assert!(connection.length[0] >= 0.0 && connection.length[1] >= 0.0);
        }
    }
    assert!(met.iter().all(|&met| met > 1000), "{met:?}");
}

/// Counts the roots of the turn by small steps, at angles with these sines.
fn roots_by_scan(sphere: &SpecularSphere<f64>, turn: f64, angles: &[(f64, f64)]) -> usize {
    let is_below = angles.iter().map(|(angle, sine)| {
        let [k, l] = sphere.distance.map(|distance| (sphere.radius / distance * sine).acos());
        let beside = PI / 2.0 - angle;
        k + l + 2.0 * (sphere.index * sine).acos() - 2.0 * beside - PI < turn
    });
    let mut last = None;
    is_below.filter(|&now| last.replace(now).is_some_and(|before| before != now)).count()
}

#[test]
fn all_paths_are_found() {
    const STEPS: u32 = 20_000;
    let angle = |step| 0.5 * PI * f64::from(step) / f64::from(STEPS);
    let angles: Vec<(f64, f64)> = (0..=STEPS).map(angle).map(|at| (at, at.sin())).collect();
    let mut random = Random::new(2);
    for _ in 0..400 {
        let setting = Setting::random(&mut random);
        let between = setting.receiver.angle_between(setting.emitter);
        let cases = [
            (between, &[CausticPath::Reflected][..]),
            (PI - between, &[CausticPath::Crossed][..]),
            (between - PI, &[CausticPath::Paraxial, CausticPath::Marginal][..]),
        ];
        for (turn, paths) in cases {
            let expected = roots_by_scan(&setting.sphere(paths[0]), turn, &angles);
            let found = paths.iter().filter(|&&path| setting.connect(path).found).count();
            assert_eq!(found, expected, "{paths:?} {turn}");
        }
    }
}

#[test]
fn the_kind_of_a_path_follows_from_its_deflection() {
    let mut random = Random::new(3);
    for _ in 0..2000 {
        let setting = Setting::random(&mut random);
        for path in [CausticPath::Crossed, CausticPath::Paraxial, CausticPath::Marginal] {
            let connection = setting.connect(path);
            if connection.found {
                assert_eq!(CausticPath::through(&setting.sphere(path).turn(connection.at)), path);
            }
        }
    }
}

#[test]
fn the_spread_equals_that_of_neighboring_rays() {
    let mut random = Random::new(4);
    let mut compared = [0; 4];
    for _ in 0..20_000 {
        let setting = Setting::random(&mut random);
        for (path, compared) in CausticPath::ALL.into_iter().zip(&mut compared) {
            let connection = setting.connect(path);
            if !connection.found || connection.at.cosine < 0.05 {
                continue;
            }
            let (toward, toward_emitter) =
                (vector(connection.toward), vector(connection.toward_emitter));
            let (x, y) = toward.any_orthonormal_pair();
            let step = 1e-6 * setting.radius / setting.receiver.length();
            let moved =
                |by: DVec3| setting.landing((toward + by).normalize(), path, toward_emitter);
            let along = |axis: DVec3| (moved(axis * step) - moved(-axis * step)) / (2.0 * step);
            let distance2 = setting.emitter.length_squared();
            let expected = along(x).cross(along(y)).length() / distance2;
            let scale = (setting.receiver.length() / setting.radius).powi(2);
            let tolerance = 1e-4 * expected + 1e-5 * scale;
            assert!(
                (connection.spread - expected).abs() < tolerance,
                "{path:?} {} {expected}",
                connection.spread
            );
            *compared += 1;
        }
    }
    assert!(compared.iter().all(|&compared| compared > 500), "{compared:?}");
}

#[test]
fn rows_equal_their_lanes() {
    let mut random = Random::new(5);
    for _ in 0..500 {
        let settings: [Setting; 8] = std::array::from_fn(|_| Setting::random(&mut random));
        let column = |of: &dyn Fn(&Setting) -> f64| F64x8::new(settings.each_ref().map(of));
        let place = |of: fn(&Setting) -> DVec3| {
            let axis = |i: usize| column(&|setting| of(setting)[i]);
            Vec3::new(axis(0), axis(1), axis(2))
        };
        let (radius, index) = (column(&|s| s.radius), column(&|s| s.index));
        let places = [place(|s| s.receiver), place(|s| s.emitter)];
        for path in CausticPath::ALL {
            let Connection { toward, spread, found, .. } =
                connect(radius, index, places, paths(path));
            for (lane, setting) in settings.iter().enumerate() {
                let one = setting.connect(path);
                assert_eq!(found.bits() >> lane & 1 == 1, one.found);
                if one.found {
                    assert_eq!(toward.x.to_array()[lane], one.toward.x);
                    assert_eq!(spread.to_array()[lane], one.spread);
                }
            }
        }
    }
}

/// Alhazen's problem for two points at equal distances, where symmetry gives the path.
#[test]
fn a_reflection_between_equals_is_in_the_middle() {
    let sphere = SpecularSphere::new(1.0, [3.0, 3.0], 0.0);
    for degrees in [1.0_f64, 40.0, 100.0, 140.0] {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        let (at, found) = sphere.find(Angle { sine, cosine }, false);
        let half = 0.5 * degrees.to_radians();
        let incidence = (3.0 * half.sin()).atan2(3.0 * half.cos() - 1.0);
        assert!(found && (at.sine - incidence.sin()).abs() < 1e-9, "{degrees}");
    }
    let (sine, cosine) = 142.0_f64.to_radians().sin_cos();
    assert!(!sphere.find(Angle { sine, cosine }, false).1, "the sphere is in between");
}
