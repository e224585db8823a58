//! Mattes: images without background, and the coverage of each pixel.

use crate::common::{emitter, furnace, lambertian, look_parallel, noon, render_scene, sphere};
use glam::DVec3;
use spherule_render::World;
use spherule_render::film::Region;
use spherule_render::image::{Channel, Image, ImageError, Values, WriteOptions};
use spherule_render::layers::{Layer, layers};
use spherule_render::overlay::{self, Matte, Overlay, draw_alpha};
use spherule_render::render::{Options, render};
use spherule_render::scene::Scene;
use std::f64::consts::PI;

const SIZE: u32 = 64;

/// Returns an image without its background, and the original.
fn lifted(scene: &Scene) -> ([Image; 2], Matte) {
    let mut world = World::build(scene).expect("a sound scene");
    let options = Options::default();
    let before = render(&world, &scene.settings, &options).expect("settings in range").image;
    let ground = overlay::ground(&mut world, &scene.settings, &options).expect("settings in range");
    let layers =
        layers(&world, &scene.settings, &options, &[Layer::Depth]).expect("settings in range");
    let region = Region { x: 0, y: 0, width: SIZE, height: SIZE };
    let mut after = before.clone();
    let matte = Overlay { world: &world, region, layers: &layers, depths: None }
        .remove_background(&mut after, ground);
    assert_eq!(
        render(&world, &scene.settings, &options).expect("settings in range").image,
        before,
        "the world is the same"
    );
    ([before, after], matte)
}

/// Returns a scene at noon, seen by parallel rays downward at 45 degrees, with an image height of 10.
fn slanted() -> Scene {
    let mut scene = noon();
    look_parallel(&mut scene, DVec3::new(0.0, -20.0, 20.0), DVec3::ZERO, 10.0);
    (scene.settings.width, scene.settings.height) = (SIZE, SIZE);
    scene
}

/// Returns the pixel in which a point is visible.
fn pixel(scene: &Scene, point: DVec3) -> usize {
    let world = World::build(scene).expect("a sound scene");
    let place = world.camera.pixel(world.camera.view(world.transform.point(point)));
    place.y as usize * SIZE as usize + place.x as usize
}

#[test]
fn the_umbra_is_black_and_as_large_as_the_sphere() {
    let scene = slanted();
    let ([before, after], matte) = lifted(&scene);
    let area = |values: &[f32]| {
        values.iter().map(|&value| f64::from(value)).sum::<f64>() * (10.0 / f64::from(SIZE)).powi(2)
    };
    // Disks; the one on the ground is seen obliquely.
    let (disk, aslant) = (PI, PI * 0.5_f64.sqrt());
    assert!((area(&matte.coverage) - disk).abs() < 0.01, "{}", area(&matte.coverage));
    assert!((area(&matte.shadow) - aslant).abs() < 0.01, "{}", area(&matte.shadow));
    let alpha = matte.linear();
    // They do not overlap in the image.
    assert!((area(&alpha) - disk - aslant).abs() < 0.02, "{}", area(&alpha));
    let umbra = pixel(&scene, DVec3::ZERO);
    assert_eq!((matte.shadow[umbra], alpha[umbra], after.pixels[umbra]), (1.0, 1.0, [0.0; 3]));
    let covered = pixel(&scene, DVec3::new(0.0, 0.0, 4.0) - DVec3::Y * 0.2);
    assert_eq!((matte.coverage[covered], after.pixels[covered]), (1.0, before.pixels[covered]));
    assert!(after.pixels[covered][0] > 0.1);
    let sunny = pixel(&scene, DVec3::new(3.5, -2.0, 0.0));
    assert_eq!((alpha[sunny], after.pixels[sunny]), (0.0, [0.0; 3]));
    assert!(before.pixels[sunny][0] > 0.1);
}

#[test]
fn compositing_over_the_ground_restores_the_picture() {
    let mut scene = slanted();
    let bare = render_scene(&Scene {
        spheres: spherule_render::scene::Spheres::default(),
        ..scene.clone()
    })
    .image;
    scene.settings.spp = 256;
    let ([before, after], matte) = lifted(&scene);
    for (row, alpha) in matte.linear().into_iter().enumerate() {
        let again = after.pixels[row][0] + (1.0 - alpha) * bare.pixels[row][0];
        assert!((again - before.pixels[row][0]).abs() < 0.02, "{row} {again}");
    }
}

#[test]
fn where_there_is_no_ground_coverage_is_alpha() {
    let mut scene = furnace();
    sphere(&mut scene, [0.0; 3], 1.0, lambertian(0.25));
    look_parallel(&mut scene, DVec3::X * 9.0, DVec3::ZERO, 4.0);
    (scene.settings.width, scene.settings.height) = (SIZE, SIZE);
    let ([_, after], matte) = lifted(&scene);
    assert!(matte.shadow.is_empty());
    assert_eq!(matte.linear(), matte.encoded());
    for (pixel, alpha) in after.pixels.iter().zip(matte.linear()) {
        // A sphere of albedo 0.25 in the furnace: only its coverage of the pixel varies.
        assert!((pixel[1] - 0.25 * alpha).abs() < 1e-5, "{pixel:?} {alpha}");
    }
}

#[test]
fn light_is_not_shadow() {
    let mut scene = slanted();
    sphere(&mut scene, [3.0, 0.0, 1.0], 0.5, emitter(2.0, 0.0));
    let (_, matte) = lifted(&scene);
    assert!(matte.shadow.iter().all(|shadow| (0.0..=1.0).contains(shadow)));
    let beside = pixel(&scene, DVec3::new(3.0, -1.5, 0.0));
    assert_eq!(matte.shadow[beside], 0.0);
}

#[test]
fn overlays_are_opaque() {
    let mut alpha = vec![0.0, 0.5, 1.0];
    let shares = [0.25, 0.5, 0.75];
    draw_alpha(&mut alpha, (3, 1), |image| {
        for (pixel, share) in image.pixels.iter_mut().zip(shares) {
            *pixel = pixel.map(|old| old + (0.3 - old) * share);
        }
    });
    for (found, expected) in alpha.into_iter().zip([0.25, 0.75, 1.0]) {
        assert!((found - expected).abs() < 1e-6, "{found} {expected}");
    }
}

#[test]
fn shadows_over_white_have_the_code_of_white_in_the_shadow() {
    let shadow = vec![0.0, 0.25, 0.5, 1.0];
    let matte = Matte { coverage: vec![0.0; 4], shadow: shadow.clone() };
    for (alpha, shadow) in matte.encoded().into_iter().zip(shadow) {
        let code = spherule_render::image::tone::srgb_encode(f64::from(1.0 - shadow));
        assert!((f64::from(1.0 - alpha) - code).abs() < 1e-6);
    }
    assert_eq!(matte.linear(), matte.shadow);
}

fn alpha(values: &[f32]) -> Channel {
    Channel { name: "A".to_owned(), values: Values::Floats(values.to_vec()) }
}

#[test]
fn png_holds_colors_beside_alpha() {
    let folder = tempfile::tempdir().expect("a folder");
    let (png, exr) = (folder.path().join("a.png"), folder.path().join("a.exr"));
    let image = Image::new(3, 1, vec![[0.5, 0.25, 0.0], [0.0; 3], [1.0; 3]]).expect("a picture");
    let channels = [alpha(&[0.5, 0.25, 1.0])];
    for path in [&png, &exr] {
        image.write_layers(path, &channels, &WriteOptions::default()).expect("a file");
    }
    let bytes = std::fs::File::open(&png).map(std::io::BufReader::new).expect("the file");
    let mut reader = ::png::Decoder::new(bytes).read_info().expect("a header");
    let mut codes = vec![0; reader.output_buffer_size().expect("a size")];
    reader.next_frame(&mut codes).expect("pixels");
    assert_eq!(codes, [255, 188, 0, 128, 0, 0, 0, 64, 255, 255, 255, 255]);
    // EXR has premultiplied colors.
    assert_eq!(Image::read(&exr).expect("a picture"), image);
    for name in ["a.pfm", "a.ppm"] {
        let refused =
            image.write_layers(folder.path().join(name), &channels, &WriteOptions::default());
        assert!(matches!(refused, Err(ImageError::Layers { .. })), "{name}");
    }
    let mut more = channels.to_vec();
    more.push(Channel { name: "depth.Z".to_owned(), ..alpha(&[1.0; 3]) });
    assert!(image.write_layers(&png, &more, &WriteOptions::default()).is_err());
    assert!(image.write_layers(&exr, &more, &WriteOptions::default()).is_ok());
}
