//! Parts of renders: merged images have the same bytes as whole ones.

use crate::common::*;
use glam::DVec3;
use spherule_render::film::{Film, Region};
use spherule_render::layers::{Layer, Layers, features, layers};
use spherule_render::render::{End, ImagePart, Options, Render, ResumableRender, render};
use spherule_render::sampling::mix;
use spherule_render::scene::{
    EnvironmentMap, Identity, Material, Rgb, Roulette, SamplerKind, Scene, Settings,
};
use spherule_render::settings::Filter;
use spherule_render::split::{Merge, MergeError, Part, Split};
use spherule_render::world::World;
use std::sync::atomic::AtomicBool;

/// Returns plastic, glass, a translucent sphere and a bright emitter, with highlights on dark surfaces, under a uniform sky.
fn still_life() -> Scene {
    let mut scene = furnace();
    sphere(&mut scene, [-0.5, 0.0, 0.0], 1.0, Material::Plastic { color: Rgb::ONE, ior: 1.5 });
    sphere(&mut scene, [0.9, 0.5, 0.3], 0.7, lambertian(0.001));
    sphere(&mut scene, [0.3, -1.0, 0.5], 0.5, glass(1.5));
    let surface = Box::new(lambertian(0.7));
    sphere(&mut scene, [-0.2, 1.1, 0.9], 0.5, Material::Translucent { opacity: 0.4, surface });
    sphere(&mut scene, [1.5, -1.5, 1.5], 0.1, emitter(1e6, 0.0));
    look(&mut scene, DVec3::new(1.0, 2.0, 9.0), DVec3::ZERO, 45.0);
    scene.settings.roulette = Roulette::Throughput;
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (83, 61, 70);
    scene
}

const STATISTICS: Options = Options {
    tracer: spherule_render::trace::Tracer {
        traversal: spherule_render::trace::Traversal::Auto,
        width: spherule_render::trace::PacketWidth::Eight,
    },
    region: None,
    progress: None,
    cancel: None,
    statistics: true,
    features: false,
    judge: None,
    elisions: spherule_render::render::Elisions::ALL,
};

/// Returns a complete part of a render.
fn take(
    world: &World,
    settings: &Settings,
    options: &Options,
    share: ImagePart,
) -> ResumableRender {
    let mut render =
        ResumableRender::begin_part(world, settings, options, share).expect("settings in range");
    assert_eq!(render.run(world, options), End::Samples);
    render
}

fn whole(settings: &Settings) -> ImagePart {
    let Settings { width, height, spp, .. } = *settings;
    ImagePart::whole(Region { x: 0, y: 0, width, height }, spp)
}

/// Returns all parts of a render, in any order.
fn parts(
    world: &World,
    settings: &Settings,
    options: &Options,
    split: Split,
    count: u32,
) -> Vec<ResumableRender> {
    let mut numbers: Vec<u32> = (1..=count).collect();
    numbers.sort_by_key(|&number| mix(u64::from(number)));
    let region = options.region.unwrap_or(Region {
        x: 0,
        y: 0,
        width: settings.width,
        height: settings.height,
    });
    let of = |number| {
        let part = Part::new(number, count).expect("it is one of them");
        let whole = ImagePart::whole(region, settings.spp);
        let share = part.of_image(&whole, Some(split)).expect("there are enough");
        take(world, settings, options, share)
    };
    numbers.into_iter().map(of).collect()
}

fn merge(partial: bool, parts: Vec<ResumableRender>) -> Result<ResumableRender, MergeError> {
    let (scene, mut merge) = (Identity::of(&still_life()), Merge::new(partial));
    for (part, number) in parts.into_iter().zip(1..) {
        merge.add(&format!("file {number}"), &scene, part)?;
    }
    merge.finish().map(|(whole, _)| whole)
}

#[track_caller]
fn assert_same(a: &Render, b: &Render, what: &str) {
    assert!(a.image == b.image, "{what}: other bytes");
    assert_eq!((a.samples, a.noise, a.end), (b.samples, b.noise, b.end), "{what}");
    assert!(a.statistics == b.statistics, "{what}: other statistics");
    let work = |render: &Render| (render.counters.rays(), render.counters.skipped_samples);
    assert_eq!(work(a), work(b), "{what}: nothing is done twice");
}

#[test]
fn merged_parts_equal_the_whole() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let splits = [
        (Split::Samples, 7),
        (Split::Tiles, 7),
        (Split::Samples, 1),
        (Split::Samples, 2),
        (Split::Samples, 3),
        (Split::Samples, 64),
        (Split::Tiles, 2),
        (Split::Tiles, 24),
    ];
    for (options, splits) in [(Options::default(), &splits[..2]), (STATISTICS, &splits[..])] {
        let straight = render(&world, &scene.settings, &options).expect("settings in range");
        for &(split, count) in splits {
            let parts = parts(&world, &scene.settings, &options, split, count);
            let merged = merge(false, parts).expect("they are all there").render();
            assert!(merged.complete);
            assert_same(&merged, &straight, &format!("{count} parts by {split:?}"));
        }
    }
}

/// Parts of an image of many small lights: more shadow rays than are traced at once, and other ones at once in each part.
#[test]
fn images_of_many_lights_can_be_split() {
    let mut scene = furnace();
    for i in 0..200 {
        let (sin, cos) = f64::from(i).sin_cos();
        let center = [cos, sin, (0.7 * f64::from(i)).sin()];
        sphere(&mut scene, center, 0.003, emitter(1.0 + 0.3 * i as f32, 0.0));
    }
    // Lights are searched for in the image only where they may be mirrored, too.
    sphere(&mut scene, [0.0; 3], 0.4, mirror());
    scene.environment.map = EnvironmentMap::Constant(Rgb::new(0.3, 0.7, 0.9));
    look(&mut scene, DVec3::new(1.0, 2.0, 9.0), DVec3::ZERO, 10.0);
    scene.settings.filter = Filter::BlackmanHarris;
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (13, 11, 40);
    let world = World::build(&scene).expect("the scene is sound");
    let straight = render(&world, &scene.settings, &STATISTICS).expect("settings in range");
    for count in [2, 7, 40] {
        let parts = parts(&world, &scene.settings, &STATISTICS, Split::Samples, count);
        let merged = merge(false, parts).expect("they are all there").render();
        assert_same(&merged, &straight, &format!("{count} parts"));
    }
}

#[test]
fn regions_and_every_sampler_can_be_split() {
    let mut scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let region = Some(Region { x: 13, y: 15, width: 40, height: 33 });
    for sampler in [SamplerKind::Stratified, SamplerKind::Independent] {
        scene.settings.sampler = sampler;
        let options = Options { region, ..STATISTICS };
        let straight = render(&world, &scene.settings, &options).expect("settings in range");
        for split in [Split::Samples, Split::Tiles] {
            let parts = parts(&world, &scene.settings, &options, split, 5);
            let merged = merge(false, parts).expect("they are all there").render();
            assert_same(&merged, &straight, &format!("{sampler:?}"));
        }
    }
}

#[test]
fn parts_may_be_split_in_different_ways() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let ImagePart { tiles, samples } = whole(&scene.settings);
    let shares = [(0..20, tiles.clone()), (20..samples.end, 0..9), (20..samples.end, 9..tiles.end)];
    let take = |(samples, tiles)| {
        take(&world, &scene.settings, &Options::default(), ImagePart { samples, tiles })
    };
    let merged = merge(false, shares.map(take).into()).expect("they are all there").render();
    assert_same(&merged, &render_scene(&scene), "three pieces");
}

#[test]
fn layers_of_parts_are_those_of_the_whole() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let region = Region { x: 3, y: 5, width: 61, height: 37 };
    let options = Options { region: Some(region), ..Options::default() };
    let wanted = [Layer::Albedo, Layer::Depth, Layer::Id];
    let straight = layers(&world, &scene.settings, &options, &wanted).expect("settings in range");
    let count = Film::tile_count(region);
    let piece = |tiles: std::ops::Range<u32>| {
        let known = features(&world, &scene.settings, &options, &wanted, tiles.clone())
            .expect("settings in range");
        (tiles, known)
    };
    let pieces = [piece(5..count), piece(0..2), piece(2..5)];
    assert!(Layers::gather(region, &pieces) == straight);
    assert!(Layers::gather(region, &pieces[1..]) != straight);
}

#[test]
fn merging_one_file_changes_nothing() {
    let mut scene = still_life();
    (scene.settings.until_error, scene.settings.spp) = (Some(0.5), 4096);
    let world = World::build(&scene).expect("the scene is sound");
    let mut alone =
        ResumableRender::begin(&world, &scene.settings, &STATISTICS).expect("settings in range");
    assert_eq!(alone.run(&world, &STATISTICS), End::Error);
    let merged = merge(false, vec![alone.clone()]).expect("it is the whole");
    assert_same(&merged.render(), &alone.render(), "alone");
}

#[test]
fn overlapping_parts_are_refused() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let mut parts = parts(&world, &scene.settings, &Options::default(), Split::Samples, 7);
    parts.truncate(3);
    parts.push(parts[1].clone());
    let common = parts[1].part().clone();
    let (first, second) = ("file 2".to_owned(), "file 4".to_owned());
    let error = merge(true, parts).expect_err("one is there twice");
    assert_eq!(error, MergeError::Overlap { first, second, common });
}

#[test]
fn missing_parts_are_named() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let first = ImagePart { samples: 0..35, tiles: 0..24 };
    let second = ImagePart { samples: 35..70, tiles: 3..24 };
    let take = |share| take(&world, &scene.settings, &Options::default(), share);
    let message = merge(false, vec![take(second), take(first)]).map(drop);
    let message = message.map_err(|error| error.to_string());
    let expected = "no part has samples 36 to 70 of tiles 1 to 3; render the missing parts, or merge \
                    the others with --partial";
    assert_eq!(message, Err(expected.to_owned()));
    assert_eq!(merge(true, Vec::new()).map(drop), Err(MergeError::Nothing));
}

#[test]
fn incomplete_merges_have_the_right_weights() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let take =
        |samples, tiles| take(&world, &scene.settings, &STATISTICS, ImagePart { samples, tiles });
    let parts = vec![take(0..16, 0..12), take(30..35, 0..6)];
    let merged = merge(true, parts).expect("that may be").render();
    assert!(!merged.complete);
    assert_eq!((merged.samples.least, merged.samples.most), (0, 21));
    let statistics = merged.statistics.expect("they were asked for");
    // The mean of 16 samples and 5 others, for pixels of the second tile.
    let few = |samples: std::ops::Range<u32>| {
        merge(true, vec![take(samples, 0..24)]).expect("that may be").render().image
    };
    let (a, b) = (few(0..16), few(30..35));
    for (row, column) in [(3, 17), (15, 31), (0, 16)] {
        let at = row * 83 + column;
        assert_eq!(statistics.samples[at], 21);
        for channel in 0..3 {
            let (a, b) = (a.pixels[at][channel], b.pixels[at][channel]);
            let mean = (16.0 * f64::from(a) + 5.0 * f64::from(b)) / 21.0;
            let found = f64::from(merged.image.pixels[at][channel]);
            assert!((found - mean).abs() <= 1e-6 * mean, "{found} {mean}");
        }
        assert_eq!(merged.image.pixels[60 * 83 + column], [0.0; 3]);
    }
}

#[test]
fn parts_of_other_renders_are_refused() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let identity = Identity::of(&scene);
    let refused = |options: &Options, change: &dyn Fn(&mut Settings)| {
        let mut other = scene.settings.clone();
        change(&mut other);
        let begin = |settings, options, samples| {
            let share = ImagePart { samples, tiles: 0..1 };
            ResumableRender::begin_part(&world, settings, options, share)
                .expect("settings in range")
        };
        let (usual, mut merge) = (Options::default(), Merge::new(true));
        let first = begin(&scene.settings, &usual, 0..3);
        merge.add("a", &identity, first).expect("it is the first");
        let second = begin(&other, options, 3..5);
        merge.add("b", &identity, second).expect_err("it is foreign").to_string()
    };
    let usual = Options::default();
    let seed = refused(&usual, &|settings| settings.seed = 9);
    let expected = "b: is not a part of the same render as a: seed is 9, but 0 there; merge parts of \
                    one render";
    assert_eq!(seed, expected);
    assert!(refused(&usual, &|settings| settings.spp = 71).contains("spp is 71, but 70"));
    assert!(refused(&usual, &|settings| settings.exposure = 1.0).contains("exposure"));
    assert!(refused(&usual, &|s| s.sampler = SamplerKind::Independent).contains("sampler"));
    assert!(refused(&STATISTICS, &|_| ()).contains("statistics"));
    let region = Some(Region { x: 1, y: 0, width: 20, height: 20 });
    assert!(refused(&Options { region, ..usual }, &|_| ()).contains("region"));
    let mut merge = Merge::new(true);
    let part = |samples| {
        let share = ImagePart { samples, tiles: 0..1 };
        ResumableRender::begin_part(&world, &scene.settings, &usual, share)
            .expect("settings in range")
    };
    merge.add("a", &identity, part(0..3)).expect("it is the first");
    let other = Identity::of(&furnace());
    let error = merge.add("b", &other, part(3..5)).map_err(|error| error.to_string());
    let expected = "b: is of another scene than a (different spheres); merge parts of one render";
    assert_eq!(error, Err(expected.to_owned()));
}

#[test]
fn interrupted_parts_are_refused_unless_allowed() {
    let scene = still_life();
    let world = World::build(&scene).expect("the scene is sound");
    let cancel = AtomicBool::new(true);
    let options = Options { cancel: Some(&cancel), ..Options::default() };
    let share = whole(&scene.settings);
    let mut part = ResumableRender::begin_part(&world, &scene.settings, &options, share)
        .expect("settings in range");
    assert_eq!(part.run(&world, &options), End::Cancelled);
    let wanted = 83 * 61 * 70;
    let (name, error) = ("file 1".to_owned(), merge(false, vec![part.clone()]));
    let expected = MergeError::Interrupted { name, taken: 0, wanted };
    assert_eq!(error.map(drop), Err(expected));
    assert!(!merge(true, vec![part]).expect("that may be").is_complete());
}
