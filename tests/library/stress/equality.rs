//! One picture: whatever the threads, the packets, the tree and the part that is asked for.

use crate::common::*;
use glam::DVec3;
use spherule::World;
use spherule::bvh::builders::Builder;
use spherule::film::Region;
use spherule::image::Image;
use spherule::integrator::counters::Counters;
use spherule::render::{Options, render};
use spherule::sampling::{stream, unit};
use spherule::scene::{
    EnvironmentMap, Integrator, Lens, Pose, Projection, Rgb, SamplerKind, Scene,
};
use spherule::trace::{PacketWidth, Tracer, Traversal};

const INTEGRATORS: [Integrator; 3] =
    [Integrator::Path, Integrator::Whitted { shadow_samples: 3 }, Integrator::Ao { distance: 2.0 }];

/// Everything there is, in a picture whose sides are no multiples of a tile, with a part of a pass.
fn everything(integrator: Integrator) -> Scene {
    let mut scene = menagerie();
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (37, 21, 19);
    scene.settings.integrator = integrator;
    scene
}

#[test]
fn every_tracer_makes_the_same_picture() {
    const WIDTHS: [PacketWidth; 4] =
        [PacketWidth::One, PacketWidth::Four, PacketWidth::Eight, PacketWidth::Sixteen];
    const TRAVERSALS: [Traversal; 5] = [
        Traversal::Brute,
        Traversal::Single,
        Traversal::Stream,
        Traversal::Packet,
        Traversal::Auto,
    ];
    for integrator in INTEGRATORS {
        let scene = everything(integrator);
        let picture = shoot(&scene);
        for traversal in TRAVERSALS {
            for width in WIDTHS {
                let tracer = Tracer { traversal, width };
                let other = shoot_with(&scene, &Options { tracer, ..Options::default() });
                assert!(other.image == picture.image, "{integrator:?} {tracer:?}");
                let work = |counters: &Counters| (counters.rays(), counters.cut_paths);
                let (expected, got) = (work(&picture.counters), work(&other.counters));
                assert_eq!(got, expected, "{integrator:?} {tracer:?}");
            }
        }
    }
}

/// Tiles in which no sphere can be seen are not traced; brute force traces them all.
#[test]
fn what_is_skipped_is_background() {
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
        let picture = shoot_with(&scene, &Options::default());
        assert!(picture.counters.skipped_samples > 10_000, "{}", picture.counters.skipped_samples);
        let tracer = Tracer { traversal: Traversal::Brute, ..Tracer::default() };
        let brute = shoot_with(&scene, &Options { tracer, ..Options::default() });
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

/// Small spheres of all materials, emitters among them, so that trees have something to differ in.
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
            pool.expect("threads can be started").install(|| shoot(&scene).image)
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
        let whole = shoot(&scene).image;
        for (x, y, width, height) in
            [(0, 0, 37, 21), (5, 3, 20, 17), (36, 20, 1, 1), (16, 0, 16, 21)]
        {
            let region = Region { x, y, width, height };
            let part = shoot_with(&scene, &Options { region: Some(region), ..Options::default() });
            assert_eq!((part.image.width, part.image.height), (width, height));
            assert!(part.image.pixels == crop(&whole, region), "{integrator:?} {region:?}");
        }
    }
}

/// Independent numbers do not depend on how many samples there are, nor on the passes that they come in: the first 16
/// of 32 samples are those of a picture of 16, so what the others add is not negative.
#[test]
fn samples_do_not_depend_on_their_number() {
    let mut scene = everything(Integrator::Path);
    scene.settings.sampler = SamplerKind::Independent;
    let mut mean = |spp: u32| {
        scene.settings.spp = spp;
        shoot(&scene).image
    };
    let (first, both) = (mean(16), mean(32));
    for (half, all) in first.pixels.iter().flatten().zip(both.pixels.iter().flatten()) {
        let rest = 2.0 * f64::from(*all) - f64::from(*half);
        assert!(rest >= -2.0 * f64::from(f32::EPSILON) * f64::from(*half), "{half} {all}");
    }
}

/// The order of the spheres in the scene does not matter where none coincide: they, and the lights among them, are in
/// the order of the tree.
#[test]
fn shuffled_spheres_make_the_same_picture() {
    let scene = everything(Integrator::Path);
    let mut shuffled = scene.clone();
    shuffled.spheres = spherule::scene::Spheres::default();
    let count = scene.spheres.len();
    for i in 0..count {
        // One-to-one as 7 and the number of spheres have no common factor.
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
    assert!(shoot(&shuffled).image == shoot(&scene).image);
}

#[test]
fn the_seed_changes_the_picture() {
    let mut scene = everything(Integrator::Path);
    let zero = shoot(&scene).image;
    scene.settings.seed = 1;
    assert!(shoot(&scene).image != zero);
}
