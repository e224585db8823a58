//! Closed spheres: no light enters or leaves.

use crate::common::*;
use glam::DVec3;
use spherule_render::render::Options;
use spherule_render::scene::{
    Environment, EnvironmentMap, Integrator, Light, LightChoice, Material, Rgb, Scene, Slice,
    SliceMode,
};
use spherule_render::trace::{PacketWidth, Tracer, Traversal};
use std::f64::consts::PI;

const WHITTED: Integrator = Integrator::Whitted { shadow_samples: 4 };

/// Radius of the closed spheres, which are centered at the origin.
const RADIUS: f64 = 3.0;

/// Every kind of opaque material that does not emit.
fn opaque() -> [(&'static str, Material); 5] {
    [
        ("diffuse", lambertian(0.75)),
        ("mirror", mirror()),
        ("rough metal", metal(0.3)),
        ("plastic", plastic()),
        ("reflective", reflective()),
    ]
}

fn plastic() -> Material {
    Material::Plastic { color: Rgb::splat(0.75), ior: 1.5 }
}

fn reflective() -> Material {
    Material::Reflective { color: Rgb::splat(0.75), diffuse: 0.75, mirror: 0.25 }
}

/// A light outside the closed spheres.
#[derive(Clone, Copy, Debug)]
enum Outside {
    Sun,
    SunDisc,
    Point,
    PointWithoutFalloff,
    Emitter,
    SkyPicture,
    ConstantSky,
    GradientSky,
    Everything,
}

impl Outside {
    const ALL: [Self; 9] = [
        Self::Sun,
        Self::SunDisc,
        Self::Point,
        Self::PointWithoutFalloff,
        Self::Emitter,
        Self::SkyPicture,
        Self::ConstantSky,
        Self::GradientSky,
        Self::Everything,
    ];

    fn add(self, scene: &mut Scene) {
        let (above, beside) = (DVec3::new(0.0, 0.6, 0.8), DVec3::new(-4.0, 1.0, 2.0));
        let sun = |angular_radius| Light::Sun {
            direction: above,
            irradiance: Rgb::splat(8.0),
            angular_radius,
        };
        let point =
            |falloff| Light::Point { position: beside, intensity: Rgb::splat(8.0), falloff };
        let sky = |map| Environment { map, illuminates: true };
        match self {
            Self::Sun => scene.lights.push(sun(0.0)),
            Self::SunDisc => scene.lights.push(sun(5.0)),
            Self::Point => scene.lights.push(point(true)),
            Self::PointWithoutFalloff => scene.lights.push(point(false)),
            Self::Emitter => sphere(scene, [1.0, -4.5, 1.0], 1.0, emitter(8.0, 0.5)),
            Self::SkyPicture => scene.environment = menagerie().environment,
            Self::ConstantSky => scene.environment = Environment::default(),
            Self::GradientSky => scene.environment = sky(gradient()),
            Self::Everything => {
                let distant = [Self::Sun, Self::SunDisc, Self::SkyPicture];
                let near = [Self::Point, Self::PointWithoutFalloff, Self::Emitter];
                for light in distant.into_iter().chain(near) {
                    light.add(scene);
                }
            }
        }
    }
}

/// Returns a closed sphere with the camera inside, off-center and not looking at the center.
fn closed(made_of: Material) -> Scene {
    let mut scene = dark();
    sphere(&mut scene, [0.0; 3], RADIUS, made_of);
    look(&mut scene, DVec3::new(0.5, -1.5, 0.25), DVec3::new(-0.5, 2.0, 1.0), 120.0);
    (scene.settings.spp, scene.settings.depth) = (16, Some(4));
    scene
}

/// Adds spheres of every material to a room, next to and inside one another.
fn furnish(scene: &mut Scene) {
    let materials = opaque().map(|(_, made_of)| made_of);
    for (place, made_of) in materials.into_iter().chain([glass(1.5), mirror()]).enumerate() {
        let (sin, cos) = (0.9 * place as f64).sin_cos();
        sphere(scene, [1.5 * cos, 0.5 + sin, 0.5 * cos * sin], 0.4, made_of);
    }
    sphere(scene, [0.0, 0.5, 0.0], 0.3, glass(1.5));
    sphere(scene, [0.0, 0.5, 0.0], 0.1, lambertian(0.75));
}

#[track_caller]
fn assert_black(scene: &Scene, what: &str) {
    assert_every_pixel(&render_scene(scene).image, 0.0, what);
}

#[test]
fn no_light_enters_a_closed_sphere() {
    for (what, made_of) in opaque() {
        for outside in Outside::ALL {
            let mut scene = closed(made_of.clone());
            outside.add(&mut scene);
            for integrator in
                [Integrator::Path, WHITTED, Integrator::Ao { distance: f64::INFINITY }]
            {
                scene.settings.integrator = integrator;
                assert_black(&scene, &format!("{what} {outside:?} {integrator:?}"));
            }
        }
    }
}

/// The same tests, with spheres in the room from which paths and shadow rays start.
#[test]
fn no_light_enters_a_furnished_room() {
    for (what, made_of) in opaque() {
        let mut scene = closed(made_of);
        furnish(&mut scene);
        Outside::Everything.add(&mut scene);
        for light_choice in [LightChoice::Tree, LightChoice::Power, LightChoice::Uniform] {
            for caustics in [true, false] {
                (scene.settings.light_choice, scene.settings.caustics) = (light_choice, caustics);
                assert_black(&scene, &format!("{what} {light_choice:?} {caustics}"));
            }
        }
        for integrator in [WHITTED, Integrator::Ao { distance: f64::INFINITY }] {
            scene.settings.integrator = integrator;
            assert_black(&scene, &format!("{what} {integrator:?}"));
        }
    }
}

#[test]
fn closed_spheres_are_black_for_every_traversal() {
    let mut scene = closed(plastic());
    Outside::Everything.add(&mut scene);
    let mut furnished = scene.clone();
    furnish(&mut furnished);
    for scene in [scene, furnished] {
        for traversal in [
            Traversal::Brute,
            Traversal::Single,
            Traversal::Stream,
            Traversal::Packet,
            Traversal::Auto,
        ] {
            for width in PacketWidth::ALL {
                let options = Options { tracer: Tracer { traversal, width }, ..Options::default() };
                let image = render_scene_with(&scene, &options).image;
                assert_every_pixel(&image, 0.0, &format!("{traversal:?} {width:?}"));
            }
        }
    }
}

/// A closed sphere inside glass, and glass inside a closed sphere with the camera in the glass.
#[test]
fn glass_lets_no_light_through_a_closed_sphere() {
    for integrator in [Integrator::Path, WHITTED] {
        for (inner, outer) in [(lambertian(0.75), glass(1.5)), (glass(1.5), lambertian(0.75))] {
            let mut scene = closed(inner);
            scene.settings.integrator = integrator;
            scene.settings.depth = Some(8);
            sphere(&mut scene, [0.0, 0.0, 0.1], RADIUS + 0.3, outer);
            Outside::Everything.add(&mut scene);
            assert_black(&scene, &format!("{integrator:?}"));
        }
    }
}

/// Inside a closed sphere around a light, only that light and its reflections are visible, for any light
/// outside.
#[test]
fn light_inside_lights_only_the_inside() {
    let albedo = 0.5;
    let point = Light::Point { position: DVec3::ZERO, intensity: Rgb::splat(9.0), falloff: true };
    // Radiance by an irradiance of 9 / RADIUS^2 = 1, and its reflections between the walls.
    let direct = albedo / PI;
    for outside in [None, Some(Outside::Everything)] {
        let mut scene = closed(lambertian(albedo as f32));
        scene.lights.push(point.clone());
        if let Some(outside) = outside {
            outside.add(&mut scene);
        }
        for (depth, truth) in [(1, direct), (2, 1.5 * direct), (4, 1.875 * direct)] {
            scene.settings.integrator = Integrator::Path;
            scene.settings.depth = Some(depth);
            scene.settings.spp = 64;
            let estimate = measure(&scene);
            assert_expected(estimate, truth, &format!("{depth} {outside:?}"));
            scene.settings.integrator = WHITTED;
            assert_expected(measure(&scene), direct, &format!("whitted {depth} {outside:?}"));
        }
    }
}

/// The inside of a wall under a light that is off-center, near that wall and far from it.
#[test]
fn walls_are_lit_across_the_room() {
    let position = DVec3::new(0.0, 0.0, 2.0);
    for (point, cosine) in [
        (DVec3::Z * RADIUS, 1.0),
        (DVec3::NEG_Z * RADIUS, 1.0),
        (DVec3::X * RADIUS, RADIUS / RADIUS.hypot(2.0)),
    ] {
        let mut scene = closed(lambertian(0.5));
        scene.lights.push(Light::Point { position, intensity: Rgb::splat(7.0), falloff: true });
        Outside::Everything.add(&mut scene);
        (scene.settings.depth, scene.settings.spp) = (Some(1), 256);
        let truth = 0.5 * 7.0 * cosine / (PI * point.distance_squared(position));
        for integrator in [Integrator::Path, WHITTED] {
            scene.settings.integrator = integrator;
            look(&mut scene, DVec3::new(0.5, 0.5, 0.5), point, 1e-4);
            assert_expected(measure(&scene), truth, &format!("{point} {integrator:?}"));
        }
    }
}

/// An emitter of radius 1 in the center gives walls of radius 3 a ninth of its radiosity.
#[test]
fn an_emitter_lights_the_room_that_it_is_in() {
    for made_of in [lambertian(0.5), reflective()] {
        for integrator in [Integrator::Path, WHITTED] {
            let mut scene = closed(made_of.clone());
            sphere(&mut scene, [0.0; 3], 1.0, emitter(4.0, 0.0));
            scene.settings.integrator = integrator;
            (scene.settings.depth, scene.settings.spp) = (Some(1), 256);
            look(&mut scene, DVec3::X * 2.0, DVec3::X * RADIUS, 60.0);
            let inside = measure(&scene);
            Outside::Everything.add(&mut scene);
            assert_agree(measure(&scene), inside, &format!("{integrator:?}"));
            if matches!(made_of, Material::Lambertian { .. }) {
                assert_expected(inside, 0.5 * 4.0 / 9.0, &format!("{integrator:?}"));
            }
        }
    }
}

/// The inside of an emitter: only its own light, reflected once and twice.
#[test]
fn no_light_enters_an_emitter() {
    let (albedo, depths) = (0.5_f32, [(0, 1.0), (1, 1.5), (2, 1.75)]);
    for outside in Outside::ALL {
        let mut scene = closed(emitter(1.0, albedo));
        outside.add(&mut scene);
        for (depth, truth) in depths {
            scene.settings.depth = Some(depth);
            let image = render_scene(&scene).image;
            assert_every_pixel(&image, truth, &format!("{outside:?} {depth}"));
        }
        scene.settings.integrator = WHITTED;
        assert_every_pixel(&render_scene(&scene).image, 1.0, &format!("whitted {outside:?}"));
    }
}

/// A chord is shorter than `distance` if the cosine at the surface is less than distance / diameter, so a
/// fraction of 1 - (distance / diameter)^2 of the directions is open.
#[test]
fn occlusion_inside_a_sphere_depends_on_its_chords() {
    // Glass occludes like all else.
    for (what, made_of) in [("diffuse", lambertian(1.0)), ("glass", glass(1.5))] {
        for factor in [0.1, 0.5, 0.9, 1.0, 1.5] {
            let mut scene = closed(made_of.clone());
            scene.settings.integrator = Integrator::Ao { distance: factor * 2.0 * RADIUS };
            scene.settings.spp = 256;
            let truth = (1.0 - factor * factor).max(0.0);
            assert_expected(measure(&scene), truth, &format!("{what} {factor}"));
        }
    }
}

/// The ground blocks light as well, from its own underside and from everything below.
#[test]
fn the_ground_is_dark_below_lights_that_are_above() {
    let above = [
        Light::Sun { direction: DVec3::Z, irradiance: Rgb::ONE, angular_radius: 0.0 },
        Light::Sun {
            direction: DVec3::new(0.6, 0.0, 0.8),
            irradiance: Rgb::ONE,
            angular_radius: 5.0,
        },
        Light::Point { position: DVec3::Z * 2.0, intensity: Rgb::ONE, falloff: true },
    ];
    for (what, made_of) in opaque() {
        let mut scene = dark();
        scene.settings.depth = Some(4);
        scene.lights = above.to_vec();
        sphere(&mut scene, [1.0, 0.0, 3.0], 1.0, emitter(4.0, 0.0));
        ground(&mut scene, made_of.clone());
        look(&mut scene, DVec3::new(0.0, -1.0, -5.0), DVec3::ZERO, 90.0);
        for below in [false, true] {
            if below {
                sphere(&mut scene, [0.0, 0.0, -1.5], 1.0, made_of.clone());
                sphere(&mut scene, [1.5, 0.0, -1.0], 0.5, lambertian(0.75));
            }
            for integrator in [Integrator::Path, WHITTED] {
                scene.settings.integrator = integrator;
                assert_black(&scene, &format!("{what} {integrator:?} {below}"));
            }
        }
    }
}

#[test]
fn the_ground_is_lit_from_below() {
    let direction = DVec3::new(0.6, 0.0, -0.8);
    for integrator in [Integrator::Path, WHITTED] {
        let mut scene = dark();
        ground(&mut scene, lambertian(0.5));
        scene.settings.integrator = integrator;
        scene.lights = vec![
            Light::Sun { direction, irradiance: Rgb::ONE, angular_radius: 0.0 },
            Light::Sun { direction: -direction, irradiance: Rgb::ONE, angular_radius: 0.0 },
        ];
        (scene.settings.depth, scene.settings.spp) = (Some(1), 256);
        for side in [-1.0, 1.0] {
            let estimate = probe(&mut scene, DVec3::ZERO, DVec3::new(1.0, 1.0, 3.0) * side);
            assert_expected(estimate, 0.5 * 0.8 / PI, &format!("{integrator:?} {side}"));
        }
    }
}

/// Returns a point light on the z axis.
fn point_at(z: f64) -> Light {
    Light::Point { position: DVec3::Z * z, intensity: Rgb::splat(9.0), falloff: true }
}

/// Half of a closed sphere, and a slab of one, with the camera inside; with lights in the part that was cut
/// away, and with or without spheres inside.
#[test]
fn no_light_enters_a_sphere_that_is_cut() {
    let caps = |normal| Slice { normal, distance: 1.0, mode: SliceMode::Caps };
    let half = (vec![caps(DVec3::Z)], vec![point_at(2.0)]);
    let slab = (vec![caps(DVec3::Z), caps(DVec3::NEG_Z)], vec![point_at(2.0), point_at(-2.0)]);
    for (what, made_of) in opaque() {
        for ((slices, lights), spheres) in [(&half, false), (&half, true), (&slab, true)] {
            let mut scene = closed(made_of.clone());
            scene.slices.clone_from(slices);
            scene.lights.clone_from(lights);
            Outside::Everything.add(&mut scene);
            if spheres {
                sphere(&mut scene, [0.0, 1.5, 0.0], 0.5, lambertian(0.75));
                sphere(&mut scene, [1.5, 0.0, -0.25], 0.5, plastic());
            }
            for integrator in
                [Integrator::Path, WHITTED, Integrator::Ao { distance: f64::INFINITY }]
            {
                scene.settings.integrator = integrator;
                for target in [DVec3::Z, DVec3::NEG_Z, DVec3::Y] {
                    look(&mut scene, DVec3::new(0.5, -1.5, 0.25), target * 3.0, 120.0);
                    let cuts = slices.len();
                    assert_black(
                        &scene,
                        &format!("{what} {integrator:?} {cuts} {target} {spheres}"),
                    );
                }
            }
        }
    }
}

/// A light inside a half sphere lights its wall, and nothing outside.
#[test]
fn light_stays_in_a_sphere_that_is_cut() {
    for integrator in [Integrator::Path, WHITTED] {
        let mut scene = closed(lambertian(0.5));
        scene.slices = vec![Slice { normal: DVec3::Z, distance: 1.0, mode: SliceMode::Caps }];
        scene.lights = vec![point_at(0.5), point_at(2.0)];
        scene.settings.integrator = integrator;
        (scene.settings.depth, scene.settings.spp) = (Some(1), 256);
        look(&mut scene, DVec3::new(0.5, 0.5, -0.5), DVec3::NEG_Z * RADIUS, 1e-4);
        let truth = 0.5 * 9.0 / (PI * (RADIUS + 0.5).powi(2));
        assert_expected(measure(&scene), truth, &format!("the wall, {integrator:?}"));
        // The cap is lit only from above, from a distance of 1.
        look(&mut scene, DVec3::new(1.0, 0.0, 5.0), DVec3::Z, 1e-4);
        assert_expected(measure(&scene), 0.5 * 9.0 / PI, &format!("the cap, {integrator:?}"));
    }
}

/// A sphere that is hidden from the camera still blocks light from its inside.
#[test]
fn spheres_that_are_hidden_stay_closed() {
    for integrator in [Integrator::Path, WHITTED, Integrator::Ao { distance: f64::INFINITY }] {
        let mut scene = closed(lambertian(0.75));
        scene.environment.map = EnvironmentMap::Constant(Rgb::ZERO);
        sphere(&mut scene, [0.0, 0.0, -1.0], 1.5, lambertian(0.5));
        scene.lights = vec![
            Light::Sun { direction: DVec3::Z, irradiance: Rgb::ONE, angular_radius: 0.0 },
            Light::Point { position: DVec3::Z * 6.0, intensity: Rgb::ONE, falloff: true },
        ];
        scene.slices = vec![Slice { normal: DVec3::Z, distance: -0.5, mode: SliceMode::Hide }];
        scene.settings.integrator = integrator;
        look(&mut scene, DVec3::Z * 9.0, DVec3::ZERO, 60.0);
        assert_black(&scene, &format!("{integrator:?}"));
        // Its inside is visible.
        scene.slices[0].mode = SliceMode::Remove;
        assert!(measure(&scene).mean > 0.0);
    }
}
