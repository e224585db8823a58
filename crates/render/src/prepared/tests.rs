use super::*;
use crate::image::Image;
use crate::render::{Options, render};
use crate::scene::generate::default_scene;
use crate::scene::{
    Environment, EnvironmentMap, LightChoice, Material, NamedMaterial, Pose, Projection, Rgb,
    Slice, SliceMode,
};
use crate::sealed::HASH_BYTES;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Replaces a file. Truncating the one that is there would wait for the disk.
fn replace(path: &Path, content: &[u8]) {
    fs::remove_file(path).expect("the file is there");
    fs::write(path, content).expect("there is space");
}

/// A file of a scene in a folder that is removed with it.
struct SavedScene {
    _folder: tempfile::TempDir,
    path: PathBuf,
    world: World,
}

fn save(scene: &Scene, builder: Builder) -> SavedScene {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("scene.prepared");
    let world = World::build_with(scene, builder).expect("the scene is right");
    let metadata = [("view".to_owned(), "x".to_owned())];
    write(&path, scene, &world, &Identity::of(scene), &metadata, builder)
        .expect("it can be written");
    SavedScene { _folder: folder, path, world }
}

/// A few hundred spheres of every kind of material.
fn field() -> Scene {
    let mut scene = default_scene(3);
    let settings = &mut scene.settings;
    (settings.width, settings.height, settings.spp) = (24, 18, 2);
    scene
}

/// The first spheres of that field.
fn field_of(count: usize) -> Scene {
    let mut scene = field();
    let spheres = &mut scene.spheres;
    for column in [&mut spheres.x, &mut spheres.y, &mut spheres.z, &mut spheres.radius] {
        column.truncate(count);
    }
    spheres.material.truncate(count);
    spheres.color.truncate(count);
    scene
}

/// Scenes with each of the columns, and without.
fn scenes() -> Vec<(&'static str, Scene)> {
    let field = field();
    let with = |change: &dyn Fn(&mut Scene)| {
        let mut scene = field.clone();
        change(&mut scene);
        scene
    };
    let slice = |mode| Slice { normal: DVec3::X, distance: 0.3, mode };
    let emitter = Material::Emitter { radiance: Rgb::splat(3.0), albedo: Rgb::ZERO };
    let image = Image { width: 4, height: 2, pixels: (0..8).map(|i| [i as f32; 3]).collect() };
    let map = EnvironmentMap::Picture {
        image: Arc::new(image),
        up: DVec3::Y,
        rotation: 30.0,
        scale: 0.5,
    };
    let gray = |row: usize, count: usize| Rgb::splat((row % count) as f32 / count as f32);
    let color = |scene: &mut Scene, count: usize| {
        scene.spheres.color = (0..scene.spheres.len()).map(|row| gray(row, count)).collect();
    };
    vec![
        ("field", field.clone()),
        ("one material", with(&|scene| scene.spheres.material.clear())),
        ("no colors", with(&|scene| scene.spheres.color.clear())),
        ("many colors", with(&|scene| color(scene, 300))),
        ("few colors", with(&|scene| color(scene, 30))),
        ("hidden", with(&|scene| scene.slices.push(slice(SliceMode::Hide)))),
        ("removed", with(&|scene| scene.slices.push(slice(SliceMode::Remove)))),
        ("vanished", with(&|scene| scene.spheres.radius[5] = 1e-60)),
        (
            "emitters",
            with(&|scene| {
                scene
                    .materials
                    .push(NamedMaterial { name: "emitter".into(), material: emitter.clone() });
                let row = scene.materials.len() as u32 - 1;
                scene.spheres.material.iter_mut().step_by(9).for_each(|material| *material = row);
            }),
        ),
        (
            "sky",
            with(&|scene| {
                scene.environment = Environment { map: map.clone(), illuminates: true };
            }),
        ),
        ("no spheres", {
            let pose = Pose::LookAt { eye: DVec3::ZERO, target: DVec3::NEG_Z };
            let mut scene = with(&|scene| scene.camera.pose = pose);
            scene.spheres = crate::scene::Spheres::default();
            scene
        }),
    ]
}

#[test]
fn worlds_are_the_ones_that_were_written() {
    for (name, scene) in scenes() {
        // The builder decides the nodes alone, of all spheres and of those that the camera sees.
        let builders = if matches!(name, "field" | "hidden") {
            &Builder::ALL[..]
        } else {
            &[Builder::default()]
        };
        for &builder in builders {
            let saved = save(&scene, builder);
            assert!(is_prepared(&saved.path));
            let stored = read(&saved.path).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(stored.identity, Identity::of(&scene), "{name}");
            assert_eq!((stored.builder, stored.metadata.len()), (builder, 1), "{name}");
            let (_, world) = stored.build().unwrap_or_else(|error| panic!("{name}: {error}"));
            assert_eq!(format!("{world:?}"), format!("{:?}", saved.world), "{name}, {builder:?}");
        }
    }
}

/// The world of a prepared scene with another image size.
fn resized(scene: &Scene, [width, height]: [u32; 2]) -> Result<(Scene, World), PrepareError> {
    let saved = save(scene, Builder::default());
    let mut stored = read(&saved.path).expect("it was written");
    (stored.scene.settings.width, stored.scene.settings.height) = (width, height);
    stored.build()
}

#[test]
fn pictures_of_other_sizes_are_those_of_the_scene() {
    let mut scene = field();
    let framing = Pose::Fit { direction: DVec3::new(-1.0, -0.5, -2.0), margin: 0.1 };
    let looking = Pose::LookAt { eye: DVec3::new(3.0, 2.0, 5.0), target: DVec3::ZERO };
    let parallel = Projection::Orthographic { height: Some(2.0) };
    for (pose, projection, size, possible) in [
        (framing, scene.camera.projection, [12, 9], true),
        (framing, scene.camera.projection, [12, 10], false),
        (looking, scene.camera.projection, [12, 10], true),
        (looking, parallel, [12, 9], true),
        (looking, parallel, [12, 10], false),
    ] {
        (scene.camera.pose, scene.camera.projection) = (pose, projection);
        (scene.settings.width, scene.settings.height) = (24, 18);
        let found = resized(&scene, size);
        if !possible {
            assert!(matches!(found, Err(PrepareError::Aspect([24, 18]))), "{size:?}");
            continue;
        }
        let (stored, world) = found.expect("the aspect is the same, or does not matter");
        [scene.settings.width, scene.settings.height] = size;
        let whole = World::build(&scene).expect("the scene is right");
        let picture = |world, settings| {
            render(world, settings, &Options::default()).expect("there is memory").image
        };
        assert_eq!(picture(&world, &stored.settings), picture(&whole, &scene.settings), "{size:?}");
    }
}

#[test]
fn settings_of_lights_are_the_new_ones() {
    let scene = scenes().into_iter().find(|(name, _)| *name == "emitters").expect("it is there").1;
    let saved = save(&scene, Builder::default());
    let mut changed = scene.clone();
    for choice in [LightChoice::Power, LightChoice::Tree] {
        let mut stored = read(&saved.path).expect("it was written");
        changed.settings.light_choice = choice;
        stored.scene.settings.light_choice = choice;
        let (_, world) = stored.build().expect("nothing else changed");
        let anew = World::build(&changed).expect("the scene is right");
        assert_eq!(format!("{world:?}"), format!("{anew:?}"));
    }
}

#[test]
fn damaged_files_are_refused() {
    let saved = save(&field_of(20), Builder::default());
    let bytes = fs::read(&saved.path).expect("it was written");
    assert!(bytes.len() < 1 << 14, "{}", bytes.len());
    let refused = |bytes: &[u8]| {
        replace(&saved.path, bytes);
        read(&saved.path).expect_err("it is damaged")
    };
    for length in 0..bytes.len() {
        let error = refused(&bytes[..length]);
        let foreign = matches!(error, PreparedError::Foreign(_));
        assert_eq!(foreign, length < MAGIC.len(), "{length}: {error}");
    }
    for at in 0..bytes.len() {
        let mut bytes = bytes.clone();
        bytes[at] ^= 1 << (at % 8);
        refused(&bytes);
    }
    refused(&[&bytes[..], &[0]].concat());
}

#[test]
fn forged_files_neither_panic_nor_hang() {
    let saved = save(&field_of(40), Builder::default());
    let bytes = fs::read(&saved.path).expect("it was written");
    let content = bytes.len() - HASH_BYTES as usize;
    let (mut refused, mut read_anyway) = (0, 0);
    for at in (MAGIC.len() + 12..content).step_by(31) {
        for value in [0, 0x7F, 0xFF] {
            let mut forged = bytes.clone();
            forged[at] = value;
            let hash = *blake3::hash(&forged[..content]).as_bytes();
            forged[content..].copy_from_slice(&hash);
            replace(&saved.path, &forged);
            let Ok(stored) = read(&saved.path) else {
                refused += 1;
                continue;
            };
            read_anyway += 1;
            let small = |stored: &mut PreparedScene| {
                let settings = &mut stored.scene.settings;
                (settings.width, settings.height, settings.spp) = (4, 3, 1);
            };
            let mut stored = stored;
            small(&mut stored);
            if let Ok((scene, world)) = stored.build()
                && read_anyway % 50 == 0
            {
                _ = render(&world, &scene.settings, &Options::default());
            }
        }
    }
    assert!(refused > 100 && read_anyway > 100, "{refused} {read_anyway}");
}
