//! What the tests of sticks, ellipsoids and cones share: scenes, layers, and the comparison of traversals.

use crate::common::{dark, look_parallel, render_scene_with};
use glam::DVec3;
use spherule_render::layers::{Features, Layer, layers};
use spherule_render::ray::{GROUND, Hits, MISS, Rays};
use spherule_render::render::Options;
use spherule_render::sampling::{stream, unit};
use spherule_render::scene::{Scene, Slice, SliceMode};
use spherule_render::trace::{self, PacketWidth, Tracer, Traversal};
use spherule_render::world::World;

/// Returns numbers from 0 to 1.
pub(crate) fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut count = 0;
    move || {
        count += 1;
        f64::from(unit(stream(seed, count) as u32))
    }
}

/// A scene without light that the camera sees from the z axis, six units high, with a hundred pixels for a unit of area.
pub(crate) fn parallel() -> Scene {
    let mut scene = dark();
    look_parallel(&mut scene, DVec3::Z * 10.0, DVec3::ZERO, 6.0);
    (scene.settings.width, scene.settings.height) = (60, 60);
    scene
}

/// The layers of all pixels.
pub(crate) fn features(scene: &Scene) -> Vec<Features> {
    let world = World::build(scene).expect("a valid scene");
    layers(&world, &scene.settings, &Options::default(), &Layer::ALL)
        .expect("valid settings")
        .pixels
}

/// The pixel of [`parallel`] at a place.
pub(crate) fn at(features: &[Features], x: f64, y: f64) -> Features {
    let pixel = |v: f64| ((v + 3.0) * 10.0) as usize;
    features[pixel(-y) * 60 + pixel(x)]
}

/// Compares the hits of all traversals and widths with those of all bodies, without slices and with each kind of them, and calls
/// `count` with each hit on a body.
pub(crate) fn assert_traversals_agree(scene: &Scene, mut count: impl FnMut(&World, usize)) {
    let mut slices = vec![Vec::new()];
    for mode in [SliceMode::Caps, SliceMode::Hide, SliceMode::Remove] {
        slices.push(vec![Slice { normal: DVec3::X, distance: 0.1, mode }]);
    }
    for slices in slices {
        let world = World::build(&Scene { slices, ..scene.clone() }).expect("a valid scene");
        let (mut number, unit) = (numbers(9), world.transform.length(1.0));
        for from_camera in [true, false] {
            let mut rays = Rays::with_capacity(500);
            for _ in 0..500 {
                let mut point =
                    || DVec3::from([number(), number(), number()].map(|x| 2.0 * x - 1.0)) * unit;
                let own = if from_camera { MISS } else { GROUND };
                let origin = point() * 2.0;
                let direction = (point() - origin).normalize();
                rays.push(origin.as_vec3(), direction.as_vec3(), own);
            }
            let found = |traversal, width| {
                let (mut hits, mut shadows) = (Hits::with_capacity(500), Hits::with_capacity(500));
                let tracer = Tracer { traversal, width };
                trace::closest(tracer, &world, &rays, &mut hits);
                trace::occluded(tracer, &world, &rays, &mut shadows);
                let hidden =
                    shadows.sphere.iter().map(|&sphere| sphere != MISS).collect::<Vec<_>>();
                (hits.sphere, hidden)
            };
            let expected = found(Traversal::Brute, PacketWidth::One);
            for traversal in
                [Traversal::Single, Traversal::Stream, Traversal::Packet, Traversal::Auto]
            {
                for width in PacketWidth::ALL {
                    assert_eq!(found(traversal, width), expected);
                }
            }
            for (row, (&hit, &hidden)) in expected.0.iter().zip(&expected.1).enumerate() {
                assert_eq!(hit != MISS, hidden, "row {row}");
                if hit != MISS {
                    count(&world, hit as usize);
                }
            }
        }
    }
}

/// Compares the picture of one thread and single rays with those of packets and more threads.
pub(crate) fn assert_one_picture(scene: &Scene) {
    let picture = |traversal, width, threads| {
        let tracer = Tracer { traversal, width };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let options = Options { tracer, ..Options::default() };
        pool.install(|| render_scene_with(scene, &options).image.pixels)
    };
    let expected = picture(Traversal::Single, PacketWidth::One, 1);
    for (width, threads) in [(PacketWidth::Four, 2), (PacketWidth::Sixteen, 3)] {
        assert!(picture(Traversal::Auto, width, threads) == expected);
    }
}
