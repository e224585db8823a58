//! Targets: operations on an input, and invariants of their results.

use spherule_render::image::{Image, compare, read_metadata};
use spherule_render::render::{Options, render};
use spherule_render::scene::particles::{
    Format, FrameChoice, Radii, ReadOptions, count_frames, read,
};
use spherule_render::scene::{Integrator, Scene, Spheres};
use spherule_render::trace::{PacketWidth, Tracer, Traversal};
use spherule_render::world::World;
use std::error::Error;
use std::fs;
use std::hint::black_box;
use std::path::Path;

/// Maximum number of spheres of scenes that are rendered.
const RENDERED: usize = 5000;

/// Maximum number of spheres of scenes that are rendered by brute force.
const COMPARED: usize = 200;

/// Maximum length of a message in bytes.
const LONGEST: usize = 5000;

/// Reads a scene, and renders it if it is small.
pub(crate) fn scene(path: &Path) {
    look_at(checked(Scene::load(path)));
}

/// Reads particles in every format, and renders them in detected formats.
pub(crate) fn particles(path: &Path) {
    let options = |format, radius, scale| {
        let radii = Option::map_or(radius, Radii::Auto, Radii::Missing);
        ReadOptions { format, radii, scale, ..ReadOptions::default() }
    };
    let all = Format::ALL.map(|(_, format)| options(Some(format), None, 1.0));
    let some = [options(None, Some(1e-300), 1e300), options(Some(Format::Xyzr), None, 1e-300)];
    for options in some.into_iter().chain(all) {
        if let Some(particles) = checked(read(path, &options)) {
            assert!(!particles.spheres.is_empty());
            check_spheres(&particles.spheres, particles.material_names.len());
        }
    }
    let last = ReadOptions { frame: FrameChoice::Last, ..ReadOptions::default() };
    checked(read(path, &last));
    checked(count_frames(path, &last));
    look_at(checked(Scene::from_particles(path, &ReadOptions::default())));
}

/// Reads an image and its metadata, compares it, and renders a sphere under it.
pub(crate) fn picture(path: &Path) {
    checked(read_metadata(path));
    if let Some(image) = checked(Image::read(path)) {
        assert_eq!(image.pixels.len() as u64, u64::from(image.width) * u64::from(image.height));
        assert!(!image.pixels.is_empty());
        checked(compare(&image, &image));
    }
    let text = "environment = { kind = \"picture\", file = \"case\" }\n\
                sphere = [{ center = [0, 0, 0], radius = 1 }]";
    let folder = path.parent().unwrap_or(Path::new(""));
    look_at(checked(Scene::parse(text, "sky", folder)));
}

/// Fails in the way that the input names, to test the fuzzer.
pub(crate) fn fault(path: &Path) {
    match fs::read(path).expect("a case").as_slice() {
        b"panic" => panic!("as requested"),
        b"memory" => drop(black_box(vec![1_u8; 1 << 30])),
        b"stack" => drop(endless(0)),
        b"end" => std::process::exit(0),
        _ => (),
    }
}

#[expect(unconditional_recursion, reason = "to overflow the stack")]
fn endless(depth: u64) -> [u64; 64] {
    let below = endless(black_box(depth) + 1);
    black_box(below.map(|value| value + depth))
}

/// Returns the value, or `None` after a check of the error's message.
fn checked<T, E: Error>(outcome: Result<T, E>) -> Option<T> {
    outcome
        .map_err(|error| {
            let message = error.to_string();
            assert!(message.len() <= LONGEST, "a message of {} bytes", message.len());
            assert!(!message.is_empty());
        })
        .ok()
}

/// Checks a scene, and renders it if it is small.
fn look_at(scene: Option<Scene>) {
    let Some(mut scene) = scene else { return };
    check_spheres(&scene.spheres, scene.materials.len());
    assert!(scene.warnings.iter().all(|warning| warning.len() <= LONGEST), "a long warning");
    if scene.spheres.len() > RENDERED {
        return;
    }
    let settings = &mut scene.settings;
    (settings.width, settings.height) = (settings.width.min(8), settings.height.min(8));
    (settings.spp, settings.depth) = (1, Some(settings.depth.unwrap_or(4).min(4)));
    if let Integrator::Whitted { shadow_samples } = &mut settings.integrator {
        *shadow_samples = (*shadow_samples).min(4);
    }
    if let Some(world) = checked(World::build(&scene)) {
        draw(&scene, &world);
    }
}

/// Renders a world, and, if it is tiny, also by brute force.
fn draw(scene: &Scene, world: &World) {
    world.bvh.validate(&world.spheres).expect("a sound tree");
    let picture = render(world, &scene.settings, &Options::default()).expect("settings in range");
    assert_eq!(picture.counters.bad_samples, 0, "samples that are no radiance");
    let sound = |value: &f32| value.is_finite() && *value >= 0.0;
    assert!(picture.image.pixels.iter().flatten().all(sound), "a radiance that is none");
    if scene.spheres.len() <= COMPARED {
        let tracer = Tracer { traversal: Traversal::Brute, width: PacketWidth::One };
        let plain = render(world, &scene.settings, &Options { tracer, ..Options::default() })
            .expect("settings in range");
        assert!(plain.image == picture.image, "another picture without the tree");
    }
}

fn check_spheres(spheres: &Spheres, materials: usize) {
    let count = spheres.len();
    assert_eq!([spheres.x.len(), spheres.y.len(), spheres.z.len()], [count; 3]);
    for row in 0..count {
        assert!(spheres.center(row).is_finite());
        assert!(spheres.radius[row] > 0.0 && spheres.radius[row].is_finite());
        assert!((spheres.material_of(row) as usize) < materials);
        let color = spheres.color_of(row);
        assert!(color.min_element() >= 0.0 && color.max_element() <= 1.0);
    }
}
