//! Modified checkpoints and parts: damaged ones are refused, and forged ones with a correct hash are refused
//! or harmless. Neither crashes the program or makes it allocate without bound.

#![allow(clippy::disallowed_methods, reason = "tests compare with tolerances")]

mod common;

use cap::Cap;
use common::*;
use glam::DVec3;
use proptest::collection::vec;
use proptest::prelude::*;
use proptest::sample::Index;
use spherule_render::checkpoint::{self, Caption, Origin};
use spherule_render::film::Region;
use spherule_render::render::{ImagePart, Options, ResumableRender};
use spherule_render::scene::{Identity, Scene};
use spherule_render::split::{Merge, Part, Split};
use spherule_render::world::World;
use std::alloc::System;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::time::Duration;
use std::{fs, thread};

/// Memory limit of the process; larger allocations fail.
const MEMORY: usize = 256 << 20;

#[global_allocator]
static ALLOCATOR: Cap<System> = Cap::new(System, MEMORY);

/// Bytes before the head's length, of the length, and of the hash at the end.
const START: usize = 24;
const LENGTH: usize = 8;
const HASH: usize = 32;

/// Returns a small scene, with or without an error goal.
fn scene(until_error: Option<f64>) -> Scene {
    let mut scene = furnace();
    sphere(&mut scene, [0.0, 0.0, 0.0], 1.0, lambertian(0.5));
    look(&mut scene, DVec3::new(0.0, 0.0, 6.0), DVec3::ZERO, 45.0);
    (scene.settings.width, scene.settings.height, scene.settings.spp) = (40, 33, 64);
    scene.settings.until_error = until_error;
    scene
}

/// Returns files of interrupted renders and of parts.
fn files() -> &'static [Vec<u8>] {
    static FILES: OnceLock<Vec<Vec<u8>>> = OnceLock::new();
    FILES.get_or_init(|| {
        let region = Region { x: 0, y: 0, width: 40, height: 33 };
        let whole = ImagePart::whole(region, 64);
        let part = |split| Part::new(2, 3).expect("it is one").of_image(&whole, Some(split));
        let shares = [Split::Samples, Split::Tiles].map(|split| part(split).expect("enough"));
        let stopped = [None, Some(1e-6)].map(|error| (scene(error), whole.clone(), 7));
        let parts = shares.map(|share| (scene(None), share, u32::MAX));
        stopped
            .into_iter()
            .chain(parts)
            .map(|(scene, share, tasks)| kept(&scene, share, tasks))
            .collect()
    })
}

/// Returns the file of a part that was stopped after a number of tasks.
fn kept(scene: &Scene, share: ImagePart, tasks: u32) -> Vec<u8> {
    let world = World::build(scene).expect("a world");
    let (count, cancel) = (AtomicU32::new(0), AtomicBool::new(false));
    let stop = |_| {
        let over = count.fetch_add(1, Ordering::Relaxed) + 1 >= tasks;
        cancel.fetch_or(over, Ordering::Relaxed);
    };
    let options = Options {
        progress: Some(&stop),
        cancel: Some(&cancel),
        statistics: true,
        ..Options::default()
    };
    let mut render = ResumableRender::begin_part(&world, &scene.settings, &options, share)
        .expect("settings in range");
    render.run(&world, &options);
    written(&origin(scene), &render)
}

fn origin(scene: &Scene) -> Origin {
    let arguments = vec!["render".into()];
    let caption = Caption { title: "A ball".to_owned(), ..Caption::default() };
    Origin { scene: Identity::of(scene), folder: "somewhere".into(), arguments, caption }
}

fn written(origin: &Origin, render: &ResumableRender) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("render");
    checkpoint::write(&path, origin, render).expect("a file");
    fs::read(path).expect("the file")
}

fn read(bytes: &[u8]) -> Result<(Origin, ResumableRender), String> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("render");
    fs::write(&path, bytes).expect("a file");
    checkpoint::read(&path).map_err(|error| error.to_string())
}

/// A modification of bytes.
#[derive(Clone, Debug)]
enum Change {
    Set(Index, Vec<u8>),
    Flip(Index, u8),
    Insert(Index, Vec<u8>),
    Remove(Index, usize),
    Repeat(Index, Index, usize),
}

fn changes() -> impl Strategy<Value = Vec<Change>> {
    let large = Just([[0xff; 9].as_slice(), &[1]].concat());
    let content = || prop_oneof![vec(any::<u8>(), 1..10), large.clone(), vec(Just(0), 1..10)];
    let change = prop_oneof![
        (any::<Index>(), content()).prop_map(|(at, bytes)| Change::Set(at, bytes)),
        (any::<Index>(), 0..8_u8).prop_map(|(at, bit)| Change::Flip(at, bit)),
        (any::<Index>(), content()).prop_map(|(at, bytes)| Change::Insert(at, bytes)),
        (any::<Index>(), 1..40_usize).prop_map(|(at, count)| Change::Remove(at, count)),
        (any::<Index>(), any::<Index>(), 1..40_usize).prop_map(|(a, b, n)| Change::Repeat(a, b, n)),
    ];
    vec(change, 1..4)
}

impl Change {
    fn make(&self, bytes: &mut Vec<u8>) {
        let length = bytes.len();
        let place = |at: &Index| at.index(length + 1);
        let stretch = |first: usize, count: usize| first..length.min(first + count);
        match self {
            Self::Set(at, content) => {
                let range = stretch(place(at), content.len());
                let content = content[..range.len()].to_vec();
                bytes.splice(range, content);
            }
            Self::Flip(at, bit) => {
                if let Some(byte) = bytes.get_mut(place(at)) {
                    *byte ^= 1 << bit;
                }
            }
            Self::Insert(at, content) => {
                bytes.splice(place(at)..place(at), content.iter().copied());
            }
            Self::Remove(at, count) => drop(bytes.drain(stretch(place(at), *count))),
            Self::Repeat(from, to, count) => {
                let content = bytes[stretch(place(from), *count)].to_vec();
                bytes.splice(place(to)..place(to), content);
            }
        }
    }
}

/// Returns the head of a file, and the blocks.
fn divided(file: &[u8]) -> [Vec<u8>; 2] {
    let (length, content) = file[START..file.len() - HASH].split_at(LENGTH);
    let length = u64::from_le_bytes(length.try_into().expect("eight bytes"));
    let (head, blocks) = content.split_at(length as usize);
    [head.to_vec(), blocks.to_vec()]
}

/// Returns a file with the correct length of its head and the correct hash.
fn sealed(file: &[u8], [head, blocks]: &[Vec<u8>; 2]) -> Vec<u8> {
    let mut forged = file[..START].to_vec();
    forged.extend((head.len() as u64).to_le_bytes());
    forged.extend(head);
    forged.extend(blocks);
    let hash = blake3::hash(&forged);
    forged.extend(hash.as_bytes());
    forged
}

/// Performs all operations on a file's content.
fn exercise(origin: &Origin, mut render: ResumableRender, scene: &Scene) {
    drop(render.render());
    assert!(read(&written(origin, &render)).is_ok(), "it can be kept");
    let mut merge = Merge::new(true);
    if merge.add("a", &origin.scene, render.clone()).is_ok() {
        drop(merge.add("b", &origin.scene, render.clone()));
    }
    let mut alone = Merge::new(true);
    if alone.add("a", &origin.scene, render.clone()).is_ok() {
        drop(alone.finish().map(|(whole, _)| whole.render()));
    }
    let settings = render.settings();
    if (settings.width, settings.height) == (scene.settings.width, scene.settings.height) {
        resume_briefly(&mut render, scene);
    }
}

/// Resumes briefly, since the number of samples may be large.
fn resume_briefly(render: &mut ResumableRender, scene: &Scene) {
    static WORLD: OnceLock<World> = OnceLock::new();
    let world = WORLD.get_or_init(|| World::build(scene).expect("a world"));
    let cancel = AtomicBool::new(false);
    let options = Options { cancel: Some(&cancel), ..Options::default() };
    thread::scope(|scope| {
        scope.spawn(|| {
            thread::sleep(Duration::from_millis(3));
            cancel.store(true, Ordering::Relaxed);
        });
        render.run(world, &options);
    });
    drop(render.render());
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..Default::default() })]

    #[test]
    fn damaged_files_are_refused(file: Index, changes in changes()) {
        let file = file.get(files());
        let mut damaged = file.clone();
        for change in &changes {
            change.make(&mut damaged);
        }
        prop_assert_eq!(read(&damaged).is_ok(), damaged == *file);
    }

    #[test]
    fn forged_files_are_refused_or_harmless(
        file: Index, in_blocks in prop::bool::weighted(0.2), changes in changes()
    ) {
        let file = file.get(files());
        let mut parts = divided(file);
        for change in &changes {
            change.make(&mut parts[usize::from(in_blocks)]);
        }
        if let Ok((origin, render)) = read(&sealed(file, &parts)) {
            exercise(&origin, render, &scene(None));
        }
    }
}

#[test]
fn forgeries_with_unchanged_content_equal_the_file() {
    for file in files() {
        let forged = sealed(file, &divided(file));
        assert!(forged == *file);
        let (origin, render) = read(&forged).expect("a render");
        assert!(written(&origin, &render) == *file);
        exercise(&origin, render, &scene(None));
    }
}
