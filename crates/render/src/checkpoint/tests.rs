use super::read::{ReadError, read_from};
use super::*;
use crate::render::{End, Options, ResumableRender};
use crate::scene::{Scene, Settings, generate};
use crate::sealed::HASH_BYTES;
use crate::world::World;
use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::{AtomicU64, Ordering};

/// A small random field with an error target.
fn scene() -> Scene {
    let mut scene = generate::default_scene(3);
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.spp) = (24, 18, 64);
    settings.until_error = Some(0.001);
    scene
}

fn stopped(world: &World, settings: &Settings, tasks: u64) -> ResumableRender {
    let (count, cancel) = (AtomicU64::new(0), AtomicBool::new(false));
    let stop = |_| {
        let last = count.fetch_add(1, Ordering::Relaxed) + 1 >= tasks;
        cancel.fetch_or(last, Ordering::Relaxed);
    };
    let options = Options {
        progress: Some(&stop),
        cancel: Some(&cancel),
        statistics: true,
        ..Options::default()
    };
    let mut render = ResumableRender::begin(world, settings, &options).unwrap();
    assert_eq!(render.run(world, &options), End::Cancelled);
    render
}

fn caption() -> Caption {
    let looks = vec![("view".to_owned(), "auto".to_owned())];
    let (layers, features) = (vec![Layer::Albedo], vec![Features::NONE; 256]);
    let title = "A field".to_owned();
    let annotations = vec![0, 1];
    Caption { title, looks, drawn_over: true, annotations, layers, tiles: 0..1, features }
}

fn origin(scene: &Scene) -> Origin {
    let arguments = vec!["render".into(), "a b".into()];
    Origin { scene: Identity::of(scene), folder: "somewhere".into(), arguments, caption: caption() }
}

/// An interrupted render and its checkpoint.
struct SavedRender {
    world: World,
    origin: Origin,
    render: ResumableRender,
    bytes: Vec<u8>,
}

fn save(tasks: u64) -> SavedRender {
    let scene = scene();
    let world = World::build(&scene).unwrap();
    let render = stopped(&world, &scene.settings, tasks);
    let (folder, origin) = (tempfile::tempdir().unwrap(), origin(&scene));
    let path = folder.path().join("render");
    write(&path, &origin, &render).unwrap();
    let again = read(&path).unwrap();
    assert_eq!(again.0, origin);
    assert!(again.1.render().image == render.render().image);
    SavedRender { world, origin, render, bytes: fs::read(path).unwrap() }
}

fn parse(bytes: &[u8]) -> Result<(Origin, ResumableRender), ReadError> {
    read_from(Cursor::new(bytes), bytes.len() as u64)
}

#[test]
fn renders_resume_from_files() {
    for tasks in [1, 3, 6, 10] {
        let SavedRender { world, origin, mut render, bytes } = save(tasks);
        let (read, mut again) = parse(&bytes).ok().unwrap();
        assert_eq!(read, origin);
        // As in another process, everything comes from the file that was read.
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("again");
        write(&path, &read, &again).unwrap();
        assert!(fs::read(&path).unwrap() == bytes);
        let options = Options::default();
        assert_eq!(render.run(&world, &options), again.run(&world, &options));
        let (a, b) = (render.render(), again.render());
        assert!(a.image == b.image && a.statistics == b.statistics);
        assert_eq!((a.samples, a.noise, a.end), (b.samples, b.noise, b.end));
        assert_eq!(a.counters.rays(), b.counters.rays());
    }
}

#[test]
fn files_that_are_too_short_or_too_long_are_refused() {
    let SavedRender { mut bytes, .. } = save(6);
    for length in 0..bytes.len() {
        let expected = if length < MAGIC.len() { "foreign" } else { "damaged" };
        let found = match parse(&bytes[..length]) {
            Err(ReadError::Foreign) => "foreign",
            Err(ReadError::Damaged(_)) => "damaged",
            _ => "other",
        };
        assert_eq!(found, expected, "{length} bytes");
    }
    bytes.push(0);
    assert!(matches!(parse(&bytes), Err(ReadError::Damaged(_))));
}

#[test]
fn every_flipped_bit_is_detected() {
    let SavedRender { mut bytes, .. } = save(6);
    for at in 0..bytes.len() {
        let bit = 1 << (at % 8);
        bytes[at] ^= bit;
        assert!(parse(&bytes).is_err(), "byte {at}");
        bytes[at] ^= bit;
    }
    assert!(parse(&bytes).is_ok());
}

/// Replaces the hash at the end of changed bytes.
fn rehashed(bytes: &mut [u8]) -> &[u8] {
    let (content, hash) = bytes.split_at_mut(bytes.len() - HASH_BYTES as usize);
    hash.copy_from_slice(blake3::hash(content).as_bytes());
    bytes
}

#[test]
fn forgeries_with_a_valid_hash_are_refused_or_harmless() {
    let SavedRender { bytes, origin, .. } = save(6);
    let head = MAGIC.len() + 12;
    let size = |array: &[u8]| array.try_into().map(u64::from_le_bytes).unwrap() as usize;
    let end = head + size(&bytes[head - 8..head]);
    let features = head + postcard::to_stdvec(&(PROGRAM, &origin)).unwrap().len();
    let first = features - postcard::to_stdvec(&origin.caption.features).unwrap().len();
    assert!(bytes[first..].starts_with(&postcard::to_stdvec(&origin.caption.features).unwrap()));
    let mut refused = 0;
    for at in MAGIC.len()..bytes.len() - HASH_BYTES as usize {
        // The header matters most: lengths, counts, indices of tiles.
        let matters = at < first + 50 || (features..end + 50).contains(&at);
        if !matters && at % 97 != 0 {
            continue;
        }
        let mut forged = bytes.clone();
        forged[at] = [0, 0x7f, 0x80, 0xff][at / 3 % 4];
        match parse(rehashed(&mut forged)) {
            Ok((_, render)) => drop(render.render()),
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 50, "{refused}");
}

#[test]
fn absurd_sizes_take_no_memory() {
    let SavedRender { bytes, origin, render, .. } = save(5);
    let header = || crate::render::RenderHeader::of(&render);
    let forge = |head: Vec<u8>| {
        let mut forged = MAGIC.to_vec();
        forged.extend(FORMAT.to_le_bytes());
        forged.extend((head.len() as u64).to_le_bytes());
        forged.extend(head);
        forged.extend([0; HASH_BYTES as usize]);
        parse(rehashed(&mut forged)).err().map(|fault| matches!(fault, ReadError::Damaged(_)))
    };
    let mut large = header();
    (large.region.width, large.region.height) = (u32::MAX, u32::MAX);
    assert_eq!(forge(postcard::to_stdvec(&(PROGRAM, &origin, large)).unwrap()), Some(true));
    // An image without its sums.
    assert_eq!(forge(postcard::to_stdvec(&(PROGRAM, &origin, header())).unwrap()), Some(true));
    // A text of 2^63 bytes.
    assert_eq!(forge(vec![0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f]), Some(true));
    let other = postcard::to_stdvec(&("0.0.0", &origin, header())).unwrap();
    assert_eq!(forge(other), Some(false));
    let mut endless = bytes.clone();
    endless[MAGIC.len() + 4..MAGIC.len() + 12].fill(0xff);
    assert!(matches!(parse(rehashed(&mut endless)), Err(ReadError::Damaged(_))));
    let mut newer = bytes;
    newer[MAGIC.len()] = FORMAT as u8 + 1;
    let format = parse(rehashed(&mut newer)).err();
    assert!(matches!(format, Some(ReadError::Format(version)) if version == FORMAT + 1));
}

#[test]
fn other_files_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: PathBuf| read(&path).err().unwrap().to_string();
    let picture = folder.path().join("a.png");
    fs::write(&picture, "\u{89}PNG and so on, longer than what a checkpoint begins with").unwrap();
    assert!(message(picture).contains("is not a checkpoint"));
    assert!(message(folder.path().to_owned()).contains("is not a checkpoint"));
    assert!(message(folder.path().join("none")).contains("cannot be read"));
    #[cfg(unix)]
    assert!(message("/dev/zero".into()).contains("is not a checkpoint"));
}

#[test]
fn parts_of_a_few_dark_tiles_are_read() {
    let mut scene =
        Scene { spheres: scene().spheres, materials: scene().materials, ..Scene::default() };
    scene.environment.map = crate::scene::EnvironmentMap::Constant(crate::scene::Rgb::ZERO);
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.spp) = (1600, 1600, 1);
    let world = World::build(&scene).unwrap();
    let (options, part) =
        (Options::default(), crate::render::ImagePart { samples: 0..1, tiles: 0..1 });
    let mut render = ResumableRender::begin_part(&world, &scene.settings, &options, part).unwrap();
    render.run(&world, &options);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("part");
    write(&path, &origin(&scene), &render).unwrap();
    let sums = 1600 * 1600 * size_of::<[f64; 3]>() as u64;
    assert!(
        fs::metadata(&path).unwrap().len() < sums / 255,
        "shorter than the whole picture may be"
    );
    assert_eq!(read(&path).unwrap().1.samples(), render.samples());
}
