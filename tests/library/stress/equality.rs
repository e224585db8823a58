//! Equal images for all threads, packets, builders and regions.

use crate::common::*;
use glam::DVec3;
use spherule_render::World;
use spherule_render::bvh::builders::Builder;
use spherule_render::film::Region;
use spherule_render::image::Image;
use spherule_render::integrator::counters::Counters;
use spherule_render::render::{Options, render};
use spherule_render::sampling::{stream, unit};
use spherule_render::scene::{
    EnvironmentMap, Integrator, Lens, Pose, Projection, Rgb, SamplerKind, Scene,
};
use spherule_render::trace::{PacketWidth, Tracer, Traversal};

const INTEGRATORS: [Integrator; 3] =
    [Integrator::Path, Integrator::Whitted { shadow_samples: 3 }, Integrator::Ao { distance: 2.0 }];

/// All features, in an image whose sides are not multiples of a tile, with an incomplete pass.
fn everything(integrator: Integrator) -> Scene {
    let mut scene = menagerie();
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (37, 21, 19);
    scene.settings.integrator = integrator;
    scene
}

#[test]
fn every_tracer_makes_the_same_picture() {
    const TRAVERSALS: [Traversal; 5] = [
        Traversal::Brute,
        Traversal::Single,
        Traversal::Stream,
        Traversal::Packet,
        Traversal::Auto,
    ];
    for integrator in INTEGRATORS {
        let scene = everything(integrator);
        let picture = render_scene(&scene);
        for traversal in TRAVERSALS {
            for width in PacketWidth::ALL {
                let tracer = Tracer { traversal, width };
                let other = render_scene_with(&scene, &Options { tracer, ..Options::default() });
                assert!(other.image == picture.image, "{integrator:?} {tracer:?}");
                let work = |counters: &Counters| (counters.rays(), counters.cut_paths);
                let (expected, got) = (work(&picture.counters), work(&other.counters));
                assert_eq!(got, expected, "{integrator:?} {tracer:?}");
            }
        }
    }
}

/// Tiles without visible spheres are not traced; brute force traces all tiles.
#[test]
fn skipped_tiles_are_background() {
    let projections =
        [Projection::Perspective { fov: 70.0 }, Projection::Orthographic { height: Some(9.0) }];
    let lenses = [None, Some(Lens { aperture: 0.4, focus: Some(5.0) })];
    for (i, (projection, lens)) in
        projections.into_iter().flat_map(|p| lenses.map(|lens| (p, lens))).enumerate()
    {
        let mut scene = dark();
        material(&mut scene, lambertian(0.6));
        let number = |k: u64| f64::from(unit(stream(31 + i as u64, k) as u32)) * 2.0 - 1.0;
        for k in 0..12 {
            let center = DVec3::new(number(3 * k), number(3 * k + 1), number(3 * k + 2));
            scene.spheres.push(center * 2.0, 0.05 + 0.1 * number(100 + k).abs(), 0, Rgb::ONE);
        }
        scene.camera.pose = Pose::LookAt { eye: DVec3::new(3.0, 2.0, 4.0), target: DVec3::ZERO };
        (scene.camera.projection, scene.camera.lens, scene.camera.near) = (projection, lens, 0.3);
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (150, 130, 5);
        scene.environment.map = EnvironmentMap::Constant(Rgb::new(0.3, 0.7, 1.1));
        let picture = render_scene_with(&scene, &Options::default());
        assert!(picture.counters.skipped_samples > 10_000, "{}", picture.counters.skipped_samples);
        let tracer = Tracer { traversal: Traversal::Brute, ..Tracer::default() };
        let brute = render_scene_with(&scene, &Options { tracer, ..Options::default() });
        assert_eq!(brute.counters.skipped_samples, 0);
        assert!(brute.image == picture.image, "{projection:?} {lens:?}");
    }
}

#[test]
fn every_builder_makes_the_same_picture() {
    for integrator in INTEGRATORS {
        let mut scene = everything(integrator);
        add_dust(&mut scene);
        let pictures = Builder::ALL.map(|builder| {
            let world = World::build_with(&scene, builder).expect("the scene is sound");
            (
                render(&world, &scene.settings, &Options::default()).expect("settings in range"),
                world.spheres.id,
            )
        });
        let [(picture, order), others @ ..] = &pictures;
        for (other, other_order) in others {
            assert!(other.image == picture.image, "{integrator:?}");
            assert_eq!(other.counters.rays(), picture.counters.rays(), "{integrator:?}");
            assert_ne!(other_order, order, "trees that differ put rows into different orders");
        }
    }
}

/// Small spheres of all materials, including emitters, so that BVHs differ.
fn add_dust(scene: &mut Scene) {
    let center = |i: usize| {
        let number = |k| f64::from(unit(stream(i as u64, k) as u32));
        DVec3::new(number(1) - 0.5, number(2), number(3) - 0.5) * 4.0
    };
    for i in 0..300 {
        let material = (i % scene.materials.len()) as u32;
        scene.spheres.push(center(i), 0.04 + 1e-4 * i as f64, material, Rgb::ONE);
    }
}

#[test]
fn every_number_of_threads_makes_the_same_picture() {
    for sampler in [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent] {
        let mut scene = everything(Integrator::Path);
        scene.settings.sampler = sampler;
        let picture = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads can be started").install(|| render_scene(&scene).image)
        };
        let one = picture(1);
        for threads in [2, 5] {
            assert!(picture(threads) == one, "{threads} threads, {sampler:?}");
        }
    }
}

fn crop(image: &Image, region: Region) -> Vec<[f32; 3]> {
    (region.y..region.y + region.height)
        .flat_map(|y| (region.x..region.x + region.width).map(move |x| (x, y)))
        .map(|(x, y)| image.pixel(x, y).expect("the region is inside"))
        .collect()
}

#[test]
fn a_region_is_a_part_of_the_whole() {
    for integrator in INTEGRATORS {
        let scene = everything(integrator);
        let whole = render_scene(&scene).image;
        for (x, y, width, height) in
            [(0, 0, 37, 21), (5, 3, 20, 17), (36, 20, 1, 1), (16, 0, 16, 21)]
        {
            let region = Region { x, y, width, height };
            let part =
                render_scene_with(&scene, &Options { region: Some(region), ..Options::default() });
            assert_eq!((part.image.width, part.image.height), (width, height));
            assert!(part.image.pixels == crop(&whole, region), "{integrator:?} {region:?}");
        }
    }
}

/// Independent random numbers do not depend on the number of samples or passes. The first 16 of 32 samples
/// are those of an image of 16, so the contribution of the others is not negative.
#[test]
fn samples_do_not_depend_on_their_number() {
    let mut scene = everything(Integrator::Path);
    scene.settings.sampler = SamplerKind::Independent;
    let mut mean = |spp: u32| {
        scene.settings.spp = spp;
        render_scene(&scene).image
    };
    let (first, both) = (mean(16), mean(32));
    for (half, all) in first.pixels.iter().flatten().zip(both.pixels.iter().flatten()) {
        let rest = 2.0 * f64::from(*all) - f64::from(*half);
        assert!(rest >= -2.0 * f64::from(f32::EPSILON) * f64::from(*half), "{half} {all}");
    }
}

/// Without coincident spheres, their order in the scene does not matter: spheres and emitters are sorted in
/// the order of the BVH.
#[test]
fn shuffled_spheres_make_the_same_picture() {
    let scene = everything(Integrator::Path);
    let mut shuffled = scene.clone();
    shuffled.spheres = spherule_render::scene::Spheres::default();
    let count = scene.spheres.len();
    for i in 0..count {
        // A permutation, since 7 and the number of spheres have no common factor.
        let row = (7 * i + 3) % count;
        let spheres = &scene.spheres;
        shuffled.spheres.push(
            spheres.center(row),
            spheres.radius[row],
            spheres.material_of(row),
            spheres.color_of(row),
        );
    }
    assert_ne!(count % 7, 0);
    assert!(render_scene(&shuffled).image == render_scene(&scene).image);
}

#[test]
fn the_seed_changes_the_picture() {
    let mut scene = everything(Integrator::Path);
    let zero = render_scene(&scene).image;
    scene.settings.seed = 1;
    assert!(render_scene(&scene).image != zero);
}
