//! Light samples against their densities.

use super::*;
use crate::image::Image;
use crate::intersect;
use crate::ray::ExactRay;
use crate::sampling::statistics::{Grid, random_pairs};
use crate::scene::{EnvironmentMap, Light as SceneLight, Material, NamedMaterial};
use crate::world::World;
use glam::DVec3;
use std::sync::Arc;

const ANYWHERE: Receiver = Receiver { point: Vec3::ZERO, normal: Vec3::Y, own: MISS };

/// Angular radius, in degrees.
const SUNS: [f64; 3] = [0.266, 20.0, 0.0];

/// Returns a few lights of every kind; the emissive sphere of radius 1 at 0 is the largest.
pub(super) fn world() -> World {
    let mut scene = Scene::default();
    let mut sphere = |center: DVec3, radius: f64, radiance: f32| {
        let material =
            Material::Emitter { radiance: Rgb::new(radiance, 0.5, 1.0), albedo: Rgb::ZERO };
        scene.materials.push(NamedMaterial { name: String::new(), material });
        scene.spheres.push(center, radius, scene.materials.len() as u32 - 1, Rgb::ONE);
    };
    sphere(DVec3::ZERO, 1.0, 0.02);
    sphere(DVec3::X * 3.0, 0.1, 4.0);
    let position = DVec3::Z * 2.0;
    scene.lights.push(SceneLight::Point { position, intensity: Rgb::ONE, falloff: true });
    let direction = DVec3::new(0.36, 0.48, -0.8);
    let irradiance = Rgb::splat(0.05);
    let suns = SUNS.map(|angular_radius| SceneLight::Sun { direction, irradiance, angular_radius });
    scene.lights.extend(suns);
    let image = Arc::new(Image::new(2, 1, vec![[0.1; 3], [0.2; 3]]).unwrap());
    let up = DVec3::Z;
    scene.environment.map = EnvironmentMap::Picture { image, up, rotation: 0.0, scale: 1.0 };
    World::build(&scene).unwrap()
}

/// Returns the light's index and row in the world of the first emissive sphere of the scene.
fn largest(world: &World) -> (usize, usize) {
    let is_largest = |row: &u32| world.spheres.id[*row as usize] == 0;
    let index = world.lights.emitters.iter().position(is_largest).unwrap();
    (index, world.lights.emitters[index] as usize)
}

#[test]
fn emissive_spheres_are_sampled_by_their_density() {
    let world = world();
    let (index, row) = largest(&world);
    let (center, radius) = world.spheres.exact(row);
    for distance in [1.0 + 1e-6, 1.000_1, 1.1, 1.5, 3.0, 1e3] {
        let toward = DVec3::new(-0.48, 0.6, 0.64);
        let origin = (center - toward * (distance * radius)).as_vec3();
        let at = Receiver { point: origin, normal: toward.as_vec3(), own: MISS };
        let view = world.light_view(index, origin, MISS).unwrap();
        let to_center = center - origin.as_dvec3();
        let angle = (radius / to_center.length()).asin();
        let axis = to_center.normalize().as_vec3();
        let directions = random_pairs(200_000, 2).map(|u| Some(view.sample(u)?.direction));
        let pdf = view.sample([0.5; 2]).and_then(|sample| sample.pdf).unwrap();
        Grid::cone(axis, angle).check(directions, |_| pdf, Some(0.0));
        let of_all = world.lights.emitter_pdf(&world.spheres, row as u32, &at, false);
        assert!((of_all / (pdf * world.lights.probability(&at, index)) - 1.0).abs() < 1e-6);
        for sample in random_pairs(10_000, 3).filter_map(|u| view.sample(u)) {
            assert_eq!((sample.pdf, sample.target), (Some(pdf), row as u32));
            let radiance = sample.weight * pdf / world.lights.radiance[index];
            assert!((radiance - Rgb::ONE).abs().max_element() < 1e-6, "{radiance}");
            // At the edge, rounding may make the ray miss the sphere.
            let ray = ExactRay::new(origin, sample.direction, true);
            let root = intersect::confirm(&ray, center, radius, || false);
            assert!(root.is_none_or(|root| root.t == sample.t), "{sample:?}");
        }
    }
}

#[test]
fn suns_are_sampled_by_their_density() {
    let world = world();
    let lights = &world.lights;
    let first = lights.emitters.len() + lights.points.len();
    for (i, degrees) in SUNS.into_iter().enumerate() {
        let view = world.light_view(first + i, Vec3::ZERO, MISS).unwrap();
        let sun = lights.suns[i];
        let Some(cone) = sun.disc else {
            assert!(degrees == 0.0 && view.sample([0.3; 2]).unwrap().weight == sun.irradiance);
            continue;
        };
        let directions = random_pairs(200_000, 4).map(|u| Some(view.sample(u)?.direction));
        Grid::cone(sun.direction, degrees.to_radians()).check(
            directions,
            |_| cone.pdf(),
            Some(0.0),
        );
        let radiance = sun.radiance;
        let mut outside = 0;
        for sample in random_pairs(10_000, 5).filter_map(|u| view.sample(u)) {
            assert_eq!(sample.pdf, Some(cone.pdf()));
            let weighted = sample.weight * cone.pdf() / radiance;
            assert!((weighted - Rgb::ONE).abs().max_element() < 1e-6);
            // A ray in that direction sees that sun, except where rounding moves it past the edge.
            outside +=
                i32::from(!lights.suns_toward(sample.direction).any(|seen| seen == (i, radiance)));
        }
        assert!(outside < 20, "{degrees}: {outside}");
        let pdf = cone.pdf() * lights.probability(&ANYWHERE, first + i);
        assert!(pdf > 0.0 && lights.sun_pdf(i, &ANYWHERE) == pdf);
    }
}

#[test]
fn the_sky_is_sampled_by_its_density() {
    let world = world();
    let last = world.lights.len() - 1;
    let view = world.light_view(last, Vec3::ZERO, MISS).unwrap();
    for sample in random_pairs(1000, 6).filter_map(|u| view.sample(u)) {
        let pdf = sample.pdf.unwrap();
        let picture = world.environment.picture().unwrap();
        let light = picture.light::<f32>(sample.direction.into(), 1);
        assert!((light.pdf / pdf - 1.0).abs() < 1e-3);
        let radiance = Rgb::from(light.radiance);
        assert!((sample.weight * pdf / radiance - Rgb::ONE).abs().max_element() < 1e-5);
    }
}
