use super::read::{Fault, read_from};
use super::*;
use crate::render::{End, Options, ResumableRender};
use crate::scene::{Scene, Settings, generate};
use crate::sealed::SEAL;
use crate::world::World;
use std::fs;
use std::io::Cursor;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::sync::atomic::{AtomicU64, Ordering};

/// A random field, small, that is measured.
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
    Caption { title, looks, drawn_over: true, layers, tiles: 0..1, features }
}

fn origin(scene: &Scene) -> Origin {
    let arguments = vec!["render".into(), "a b".into()];
    Origin { scene: Identity::of(scene), folder: "somewhere".into(), arguments, caption: caption() }
}

/// A render that was stopped after so many tasks, and its file.
struct Kept {
    world: World,
    origin: Origin,
    render: ResumableRender,
    bytes: Vec<u8>,
}

fn kept(tasks: u64) -> Kept {
    let scene = scene();
    let world = World::build(&scene).unwrap();
    let render = stopped(&world, &scene.settings, tasks);
    let (folder, origin) = (tempfile::tempdir().unwrap(), origin(&scene));
    let path = folder.path().join("render");
    write(&path, &origin, &render).unwrap();
    let again = read(&path).unwrap();
    assert_eq!(again.0, origin);
    assert!(again.1.render().image == render.render().image);
    Kept { world, origin, render, bytes: fs::read(path).unwrap() }
}

fn parse(bytes: &[u8]) -> Result<(Origin, ResumableRender), Fault> {
    read_from(Cursor::new(bytes), bytes.len() as u64)
}

#[test]
fn renders_go_on_from_files() {
    for tasks in [1, 3, 6, 10] {
        let Kept { world, origin, mut render, bytes } = kept(tasks);
        let (read, mut again) = parse(&bytes).ok().unwrap();
        assert_eq!(read, origin);
        // In another process there would be nothing else: what it writes is what it has read.
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
fn files_that_are_cut_short_or_too_long_are_refused() {
    let Kept { mut bytes, .. } = kept(6);
    for length in 0..bytes.len() {
        let expected = if length < MAGIC.len() { "foreign" } else { "damaged" };
        let found = match parse(&bytes[..length]) {
            Err(Fault::Foreign) => "foreign",
            Err(Fault::Damaged(_)) => "damaged",
            _ => "other",
        };
        assert_eq!(found, expected, "{length} bytes");
    }
    bytes.push(0);
    assert!(matches!(parse(&bytes), Err(Fault::Damaged(_))));
}

#[test]
fn no_flipped_bit_is_overlooked() {
    let Kept { mut bytes, .. } = kept(6);
    for at in 0..bytes.len() {
        let bit = 1 << (at % 8);
        bytes[at] ^= bit;
        assert!(parse(&bytes).is_err(), "byte {at}");
        bytes[at] ^= bit;
    }
    assert!(parse(&bytes).is_ok());
}

/// Puts the right hash at the end of bytes that someone has changed.
fn sealed(bytes: &mut [u8]) -> &[u8] {
    let (content, hash) = bytes.split_at_mut(bytes.len() - SEAL as usize);
    hash.copy_from_slice(blake3::hash(content).as_bytes());
    bytes
}

#[test]
fn forgeries_with_the_right_hash_are_refused_or_harmless() {
    let Kept { bytes, .. } = kept(6);
    let head = MAGIC.len() + 12;
    let mut refused = 0;
    for at in MAGIC.len()..bytes.len() - SEAL as usize {
        // The head counts most: lengths, counts, places of tiles.
        if at > head + 4000 && at % 31 != 0 {
            continue;
        }
        let mut forged = bytes.clone();
        forged[at] = [0, 0x7f, 0x80, 0xff][at / 3 % 4];
        match parse(sealed(&mut forged)) {
            Ok((_, render)) => drop(render.render()),
            Err(_) => refused += 1,
        }
    }
    assert!(refused > 50, "{refused}");
}

#[test]
fn absurd_sizes_take_no_memory() {
    let Kept { bytes, origin, render, .. } = kept(5);
    let outline = || crate::render::Outline::of(&render);
    let forge = |head: Vec<u8>| {
        let mut forged = MAGIC.to_vec();
        forged.extend(FORMAT.to_le_bytes());
        forged.extend((head.len() as u64).to_le_bytes());
        forged.extend(head);
        forged.extend([0; SEAL as usize]);
        parse(sealed(&mut forged)).err().map(|fault| matches!(fault, Fault::Damaged(_)))
    };
    let mut large = outline();
    (large.region.width, large.region.height) = (u32::MAX, u32::MAX);
    assert_eq!(forge(postcard::to_stdvec(&(PROGRAM, &origin, large)).unwrap()), Some(true));
    // A picture without its sums.
    assert_eq!(forge(postcard::to_stdvec(&(PROGRAM, &origin, outline())).unwrap()), Some(true));
    // A text of 2^63 bytes.
    assert_eq!(forge(vec![0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f]), Some(true));
    let other = postcard::to_stdvec(&("0.0.0", &origin, outline())).unwrap();
    assert_eq!(forge(other), Some(false));
    let mut endless = bytes.clone();
    endless[MAGIC.len() + 4..MAGIC.len() + 12].fill(0xff);
    assert!(matches!(parse(sealed(&mut endless)), Err(Fault::Damaged(_))));
    let mut newer = bytes;
    newer[MAGIC.len()] = FORMAT as u8 + 1;
    let format = parse(sealed(&mut newer)).err();
    assert!(matches!(format, Some(Fault::Format(version)) if version == FORMAT + 1));
}

#[test]
fn what_is_no_checkpoint_is_told_so() {
    let folder = tempfile::tempdir().unwrap();
    let message = |path: PathBuf| read(&path).err().unwrap().to_string();
    let picture = folder.path().join("a.png");
    fs::write(&picture, "\u{89}PNG and so on, longer than what a checkpoint begins with").unwrap();
    assert!(message(picture).contains("is no checkpoint"));
    assert!(message(folder.path().to_owned()).contains("is no checkpoint"));
    assert!(message(folder.path().join("none")).contains("cannot be read"));
    #[cfg(unix)]
    assert!(message("/dev/zero".into()).contains("is no checkpoint"));
}
