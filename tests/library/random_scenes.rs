//! Random scenes: images have the same bytes however they are rendered, and means that estimate the same light in different ways
//! agree.

use crate::common::*;
use spherule_measure::{random_scene, random_scene_of_all_bodies};
use spherule_render::World;
use spherule_render::film::Region;
use spherule_render::render::{Elisions, ImagePart, Options, ResumableRender, render};
use spherule_render::scene::{Integrator, LightChoice, Roulette, SamplerKind, Scene, Settings};
use spherule_render::trace::{PacketWidth, Tracer, Traversal};
use std::ops::Range;
use std::path::Path;

/// Independent images of each scene and way, and samples of their pixels.
const IMAGES: u64 = 12;
const SAMPLES: u32 = 32;

/// Tolerance in standard errors, which are themselves estimated, and of distributions with long tails.
const TOLERANCE: f64 = 6.0;

/// The scenes, by their seeds.
const SEEDS: Range<u64> = 0..56;

/// Changes settings without changing what an image converges to. The choice of lights by power is not among them: near a
/// large sphere it finds faint lights so rarely that their light is not in the error either.
type Way = (&'static str, fn(&mut Settings));

const WAYS: [Way; 4] = [
    ("uniform", |settings| settings.light_choice = LightChoice::Uniform),
    ("roulette", |settings| settings.roulette = Roulette::Fixed(0.7)),
    ("stratified", |settings| settings.sampler = SamplerKind::Stratified),
    ("independent", |settings| settings.sampler = SamplerKind::Independent),
];

/// Returns the mean radiance of a scene's images under these settings.
fn mean(scene: &Scene, change: impl Fn(&mut Settings)) -> Estimate {
    let mut scene = scene.clone();
    change(&mut scene.settings);
    let world = World::build(&scene).expect("a scene in range");
    let means: Vec<f64> = (0..IMAGES)
        .map(|seed| {
            let settings = Settings { seed, ..scene.settings.clone() };
            let image = render(&world, &settings, &Options::default()).expect("settings in range");
            let pixels = image.image.pixels;
            let sum: f64 = pixels.iter().flatten().copied().map(f64::from).sum();
            sum / pixels.len() as f64
        })
        .collect();
    Estimate::of(means.into_iter())
}

/// Returns by how many standard errors the mean differs under each way; `None` for scenes of other integrators.
fn differences(seed: u64) -> Option<[f64; WAYS.len()]> {
    let mut scene = Scene::parse(&random_scene(seed), "random", Path::new(".")).expect("a scene");
    if scene.settings.integrator != Integrator::Path {
        return None;
    }
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (10, 8, SAMPLES);
    scene.settings.depth.get_or_insert(12);
    scene.settings.light_choice = LightChoice::Tree;
    scene.settings.roulette = Roulette::None;
    scene.settings.sampler = SamplerKind::Sobol;
    let expected = mean(&scene, |_| ());
    Some(WAYS.map(|(name, change)| {
        let found = mean(&scene, change);
        let error = expected.error.hypot(found.error);
        let what = format!("scene {seed}, {name}: {found:?}, not {expected:?}");
        assert!(within(found.mean, expected.mean, TOLERANCE, error), "{what}");
        let same = within(found.mean, expected.mean, 0.0, 0.0);
        if same { 0.0 } else { (found.mean - expected.mean) / error }
    }))
}

#[test]
fn means_do_not_depend_on_how_light_is_sampled() {
    // Images are of one tile, which one thread samples.
    let all: Vec<[f64; WAYS.len()]> = std::thread::scope(|scope| {
        let share = |first| SEEDS.skip(first).step_by(2).filter_map(differences).collect();
        let threads = [0, 1].map(|first| scope.spawn(move || -> Vec<_> { share(first) }));
        threads.into_iter().flat_map(|thread| thread.join().expect("means that agree")).collect()
    });
    assert!(all.len() > 30, "{}", all.len());
    // An error that all scenes have.
    for (way, (name, _)) in WAYS.iter().enumerate() {
        let sum: f64 = all.iter().map(|differences| differences[way]).sum();
        let sigmas = sum / (all.len() as f64).sqrt();
        assert!(sigmas.abs() < SIGMAS, "{name}: {sigmas}");
    }
}

/// Returns options that change no byte.
fn options() -> [Options<'static>; 12] {
    let traced = |traversal, width| {
        let tracer = Tracer { traversal, width };
        Options { tracer, ..Options::default() }
    };
    let eliding = |elisions| Options { elisions, ..Options::default() };
    let all = Elisions::ALL;
    [
        traced(Traversal::Brute, PacketWidth::Eight),
        traced(Traversal::Single, PacketWidth::Eight),
        traced(Traversal::Stream, PacketWidth::Eight),
        traced(Traversal::Packet, PacketWidth::One),
        traced(Traversal::Packet, PacketWidth::Sixteen),
        eliding(Elisions { empty_tiles: false, ..all }),
        eliding(Elisions { even_background: false, ..all }),
        eliding(Elisions { lens: false, ..all }),
        eliding(Elisions { lights: false, ..all }),
        eliding(Elisions { plane: false, ..all }),
        eliding(Elisions { glass: false, ..all }),
        eliding(Elisions { nearest_occluder: false, ..all }),
    ]
}

/// Bodies of all kinds, slices and translucent bodies among them.
#[test]
fn bytes_do_not_depend_on_how_images_are_rendered() {
    let (usual, mut compared) = (Options::default(), 0);
    for seed in 0..60 {
        let text = random_scene_of_all_bodies(seed);
        let scene = Scene::parse(&text, "random", Path::new(".")).expect("a scene");
        // Slices may have removed all that the camera is to frame.
        let Ok(world) = World::build(&scene) else { continue };
        compared += 1;
        let settings = &scene.settings;
        let image =
            |options: &Options| render(&world, settings, options).expect("settings in range").image;
        let whole = image(&usual);
        assert!(whole.pixels.iter().flatten().all(|x| (0.0..f32::INFINITY).contains(x)), "{seed}");
        // Each option on a third of the scenes.
        for options in options().iter().skip(seed as usize % 3).step_by(3) {
            let what = (options.tracer, options.elisions);
            assert!(image(options) == whole, "scene {seed}: {what:?}");
        }
        let part = |samples| {
            let region = Region { x: 0, y: 0, width: settings.width, height: settings.height };
            let part = ImagePart { samples, ..ImagePart::whole(region, settings.spp) };
            let mut part =
                ResumableRender::begin_part(&world, settings, &usual, part).expect("a part");
            part.run(&world, &usual);
            part.film().clone()
        };
        let middle = settings.spp / 2;
        if middle > 0 {
            let mut film = part(0..middle);
            assert!(film.merge(part(middle..settings.spp)));
            assert!(film.resolve() == whole, "scene {seed}: parts");
        }
        let region = Region { x: 3, y: 2, width: 7, height: 5 };
        let cut = image(&Options { region: Some(region), ..usual });
        for (row, pixels) in cut.pixels.chunks(7).enumerate() {
            let first = (row + 2) * settings.width as usize + 3;
            assert_eq!(pixels, &whole.pixels[first..first + 7], "scene {seed}: a region");
        }
    }
    assert!(compared > 54, "{compared}");
}
