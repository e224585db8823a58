//! Interrupted renders: resumed images have the same bytes as uninterrupted ones.

use crate::common::*;
use glam::DVec3;
use spherule_render::film::Region;
use spherule_render::render::{
    End, IncompatibleSettings, Options, Render, ResumableRender, render,
};
use spherule_render::scene::{Filter, Material, Rgb, Roulette, SamplerKind, Scene, Settings};
use spherule_render::trace::{PacketWidth, Tracer};
use spherule_render::world::World;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

/// Returns plastic, glass and a translucent sphere under a uniform sky, with tiles that see only the sky.
fn still_life() -> Scene {
    let mut scene = furnace();
    sphere(&mut scene, [-0.5, 0.0, 0.0], 1.0, Material::Plastic { color: Rgb::ONE, ior: 1.5 });
    sphere(&mut scene, [0.9, 0.5, 0.3], 0.7, lambertian(0.5));
    sphere(&mut scene, [0.3, -1.0, 0.5], 0.5, glass(1.5));
    let surface = Box::new(lambertian(0.7));
    sphere(&mut scene, [-0.2, 1.1, 0.9], 0.5, Material::Translucent { opacity: 0.4, surface });
    look(&mut scene, DVec3::new(1.0, 2.0, 9.0), DVec3::ZERO, 45.0);
    scene.settings.roulette = Roulette::Throughput;
    scene.settings.filter = Filter::Gaussian;
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (83, 61, 70);
    scene
}

/// Renders until a number of tasks is done, or to the end.
fn run_for(unfinished: &mut ResumableRender, world: &World, tasks: u64, threads: usize) -> End {
    let (done, cancel) = (AtomicU64::new(0), AtomicBool::new(false));
    let count = |_| {
        let last = done.fetch_add(1, Ordering::Relaxed) + 1 >= tasks;
        cancel.fetch_or(last, Ordering::Relaxed);
    };
    // Options that never change the image.
    let widths = PacketWidth::ALL;
    let tracer = Tracer { width: widths[tasks as usize % 4], ..Tracer::default() };
    let options =
        Options { progress: Some(&count), cancel: Some(&cancel), tracer, ..Options::default() };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
    pool.install(|| unfinished.run(world, &options))
}

/// Renders with an interruption after every few tasks, alternately on one thread and on several.
fn run_in_pieces(unfinished: &mut ResumableRender, world: &World, tasks: u64) -> u32 {
    let mut pauses = 0;
    while run_for(unfinished, world, tasks + u64::from(pauses % 3), 1 + pauses as usize % 3)
        == End::Cancelled
    {
        pauses += 1;

        assert!(pauses < 100_000, "it does not go on");
    }
    pauses
}

fn in_pieces(scene: &Scene, options: &Options, tasks: u64) -> Render {
    let world = World::build(scene).expect("the scene is sound");
    let mut unfinished =
        ResumableRender::begin(&world, &scene.settings, options).expect("settings in range");
    assert!(run_in_pieces(&mut unfinished, &world, tasks) > 1);
    unfinished.render()
}

#[track_caller]
fn assert_same(a: &Render, b: &Render, what: &str) {
    assert!(a.image == b.image, "{what}: other bytes");
    assert_eq!((a.samples, a.noise, a.end), (b.samples, b.noise, b.end), "{what}");
    assert_eq!(a.statistics, b.statistics, "{what}");
    let work = |render: &Render| (render.counters.rays(), render.counters.skipped_samples);
    assert_eq!(work(a), work(b), "{what}: nothing is done twice");
}

fn with(scene: &Scene, change: impl FnOnce(&mut Settings)) -> Scene {
    let mut scene = scene.clone();
    change(&mut scene.settings);
    scene
}

#[test]
fn resumed_renders_equal_uninterrupted_ones() {
    let scene = still_life();
    let error = |settings: &mut Settings| (settings.until_error, settings.spp) = (Some(0.03), 4096);
    let time = |settings: &mut Settings| {
        (settings.time, settings.spp) = (Some(Duration::from_secs(3600)), 40);
    };
    let cases = [
        ("uniform", scene.clone()),
        ("error", with(&scene, error)),
        ("time", with(&scene, time)),
        ("error and time", with(&scene, |settings| (error(settings), time(settings)).0)),
        ("menagerie", with(&menagerie(), |settings| settings.spp = 300)),
    ];
    for (case, (name, scene)) in cases.into_iter().enumerate() {
        for statistics in [false, true] {
            let options = Options { statistics, ..Options::default() };
            let straight = render_scene_with(&scene, &options);
            assert!(straight.complete);
            let tasks = [1, 7][(case + usize::from(statistics)) % 2];
            assert_same(&in_pieces(&scene, &options, tasks), &straight, name);
        }
    }
}

#[test]
fn regions_resume() {
    let region = Some(Region { x: 13, y: 15, width: 40, height: 33 });
    let options = Options { region, ..Options::default() };
    let straight = render_scene_with(&still_life(), &options);
    assert_same(&in_pieces(&still_life(), &options, 3), &straight, "region");
}

#[test]
fn added_samples_equal_samples_from_the_start() {
    for sampler in [SamplerKind::Sobol, SamplerKind::Independent] {
        let scene = with(&still_life(), |settings| settings.sampler = sampler);
        let options = Options { statistics: true, ..Options::default() };
        let world = World::build(&scene).expect("the scene is sound");
        let mut unfinished = ResumableRender::begin(
            &world,
            &Settings { spp: 5, ..scene.settings.clone() },
            &options,
        )
        .expect("settings in range");
        for spp in [5, 5, 21, 32, 70] {
            let settings = Settings { spp, ..scene.settings.clone() };
            unfinished.extend(&settings).expect("it is more");
            // The last passes of the first goal may still be missing.
            run_for(&mut unfinished, &world, 60, 2);
        }
        assert_eq!(unfinished.run(&world, &options), End::Samples);
        assert_same(&unfinished.render(), &render_scene_with(&scene, &options), "70 samples");
    }
}

/// A first goal, and a second one that is set after a number of tasks.
fn two_targets(world: &World, settings: [&Settings; 2], after: u64) -> Render {
    let mut unfinished =
        ResumableRender::begin(world, settings[0], &Options::default()).expect("settings in range");
    run_for(&mut unfinished, world, after, 2);
    unfinished.extend(settings[1]).expect("it is more");
    run_in_pieces(&mut unfinished, world, 50);
    assert_eq!(unfinished.stop_conditions().len(), 2);
    unfinished.render()
}

#[test]
fn a_smaller_error_may_be_requested_at_any_time() {
    let scene = with(&still_life(), |settings| settings.spp = 4096);
    let world = World::build(&scene).expect("the scene is sound");
    let error = |error| Settings { until_error: Some(error), ..scene.settings.clone() };
    let more = |spp| Settings { spp, ..error(0.004) };
    for (first, second) in [(error(0.03), error(0.01)), (more(50), more(150))] {
        let late = two_targets(&world, [&first, &second], u64::MAX);
        for tasks in [1, 40, 200] {
            assert_same(&two_targets(&world, [&first, &second], tasks), &late, "two targets");
        }
        let alone = render(&world, &second, &Options::default()).expect("settings in range");
        assert_eq!(alone.end, late.end);
        assert!(late.samples.total > 0 && late.noise.is_some());
    }
}

#[test]
fn finished_renders_do_not_change() {
    let scene = with(&still_life(), |settings| settings.until_error = Some(0.05));
    for scene in [scene, still_life()] {
        let world = World::build(&scene).expect("the scene is sound");
        let mut unfinished = ResumableRender::begin(&world, &scene.settings, &Options::default())
            .expect("settings in range");
        assert!(!unfinished.render().complete);
        let end = unfinished.run(&world, &Options::default());
        let first = unfinished.render();
        unfinished.extend(&scene.settings).expect("nothing changes");
        assert_eq!(unfinished.run(&world, &Options::default()), end);
        assert_same(&unfinished.render(), &first, "again");
    }
}

#[test]
fn elapsed_time_counts() {
    let scene = with(&still_life(), |settings| {
        (settings.time, settings.spp) = (Some(Duration::from_millis(150)), 1 << 16);
    });
    let world = World::build(&scene).expect("the scene is sound");
    let mut unfinished = ResumableRender::begin(&world, &scene.settings, &Options::default())
        .expect("settings in range");
    assert_eq!(unfinished.run(&world, &Options::default()), End::Time);
    let first = unfinished.render();
    assert_eq!(unfinished.run(&world, &Options::default()), End::Time);
    assert!(first.image == unfinished.render().image);
    let more = Settings { time: Some(Duration::from_millis(400)), ..scene.settings.clone() };
    unfinished.extend(&more).expect("it is more");
    assert_eq!(unfinished.run(&world, &Options::default()), End::Time);
    assert!(unfinished.samples().total > first.samples.total);
}

#[test]
fn other_settings_and_lower_targets_are_refused() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let refused = |then: &dyn Fn(&mut Settings), now: &dyn Fn(&mut Settings)| {
        let (mut first, mut second) = (scene.settings.clone(), scene.settings.clone());
        then(&mut first);
        now(&mut second);
        let mut unfinished =
            ResumableRender::begin(&world, &first, &Options::default()).expect("settings in range");
        let error = unfinished.extend(&second).expect_err("it is refused");
        assert_eq!(unfinished.settings(), &first);
        error
    };
    let same = |_: &mut Settings| ();
    let seed = refused(&same, &|settings| settings.seed = 3);
    assert_eq!(seed.to_string(), "seed is 3, but was 0 when the render began; leave it as it was");
    assert!(matches!(
        refused(&same, &|s| s.spp = 69),
        IncompatibleSettings::Less { name: "spp", .. }
    ));
    let error = |error| move |settings: &mut Settings| settings.until_error = Some(error);
    let more = refused(&error(0.1), &error(0.2));
    assert!(matches!(more, IncompatibleSettings::Less { name: "until_error", .. }), "{more}");
    let new = refused(&same, &error(0.1));
    assert!(
        matches!(new, IncompatibleSettings::Target { name: "until_error", then: false }),
        "{new}"
    );
    let strata = |spp| {
        move |settings: &mut Settings| {
            (settings.sampler, settings.spp) = (SamplerKind::Stratified, spp);
        }
    };
    assert_eq!(
        refused(&strata(70), &strata(71)),
        IncompatibleSettings::Strata { then: 70, now: 71 }
    );
}
