//! Random scenes: means of images that estimate the same light in different ways agree.

use crate::common::*;
use spherule_measure::random_scene;
use spherule_render::World;
use spherule_render::render::{Options, render};
use spherule_render::scene::{Integrator, LightChoice, Roulette, SamplerKind, Scene, Settings};
use std::ops::Range;
use std::path::Path;

/// Independent images of each scene and way, and samples of their pixels.
const IMAGES: u64 = 12;
const SAMPLES: u32 = 64;

/// Tolerance in standard errors, which are themselves estimated, and of distributions with long tails.
const TOLERANCE: f64 = 6.0;

/// The scenes, by their seeds.
const SEEDS: Range<u64> = 0..80;

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
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (12, 10, SAMPLES);
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
    assert!(all.len() > 40, "{}", all.len());
    // An error that all scenes have.
    for (way, (name, _)) in WAYS.iter().enumerate() {
        let sum: f64 = all.iter().map(|differences| differences[way]).sum();
        let sigmas = sum / (all.len() as f64).sqrt();
        assert!(sigmas.abs() < SIGMAS, "{name}: {sigmas}");
    }
}
