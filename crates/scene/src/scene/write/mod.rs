//! From a scene to files that load as the same scene: a TOML file, and its spheres in a CSV file
//! beside it.

pub(super) mod sections;

use self::sections::{annotations, ground, look, render};
use super::keys::{self, EnvironmentKeys, quoted, section_text};
use super::{
    Camera, Environment, EnvironmentMap, FileError, Look, NamedMaterial, Rgb, Scene, Settings,
    Spheres, included_files,
};
use crate::atomic::write_atomically;
use crate::image::WriteOptions;
use std::borrow::Cow;
use std::collections::HashSet;
use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::Path;

/// First line of a scene that was written by a program: the files beside it, which it names, are replaced
/// when it is written again.
const MARK: &str = "# Written by spherule, as are the files that it names\n";

/// The part of a scene that describes its picture, without its content.
#[derive(Clone, Copy, Debug)]
pub struct Header<'a> {
    /// As [`Scene::title`].
    pub title: &'a str,
    /// The camera.
    pub camera: &'a Camera,
    /// The render settings.
    pub settings: &'a Settings,
    /// Background, lines and effects that are drawn over the picture.
    pub look: &'a Look,
}

/// Writes a scene to `path`, its spheres to a file of the same name that ends in `.csv`, and the
/// picture of its environment, if it has one, to one that ends in `.pfm`. Loading it gives the same
/// scene to the last bit, but for its warnings.
///
/// # Errors
///
/// A file cannot be written, a file beside the scene is in the way that no scene at `path` was written
/// with, or the scene has what a scene file cannot say: materials whose names are
/// empty, framed by blanks or not unique, or rows of materials that are not there.
pub fn write(scene: &Scene, path: &Path) -> Result<(), FileError> {
    let Scene { title, camera, settings, look, .. } = scene;
    write_as(scene, &Header { title, camera, settings, look }, path)
}

/// Writes a scene with another header than its own.
///
/// # Errors
///
/// The same as those of [`write()`].
pub fn write_as(scene: &Scene, header: &Header, path: &Path) -> Result<(), FileError> {
    let columns = path.with_extension("csv");
    if columns == path {
        let error = FileError::whole_file(path, "a scene cannot be written to a .csv file");
        return Err(error.with_help("name it .toml: the spheres go to a .csv file beside it"));
    }
    check(scene).map_err(|message| FileError::whole_file(path, message))?;
    let sky = path.with_extension("pfm");
    if !scene.spheres.is_empty() {
        check_beside(path, &columns)?;
    }
    if let EnvironmentMap::Picture { image, .. } = &scene.environment.map {
        check_beside(path, &sky)?;
        let written = image.write(&sky, &WriteOptions::default());
        written.map_err(|error| failed(&sky, &error))?;
    }
    let mut text = document(scene, header, &environment(&scene.environment, &name(&sky)));
    if !scene.spheres.is_empty() {
        text += &file(&columns);
        write_atomically(&columns, |file| write_columns(scene, file))
            .map_err(|error| failed(&columns, &error))?;
    }
    write_atomically(path, |file| file.write_all(text.as_bytes()))
        .map_err(|error| failed(path, &error))
}

/// Refuses to replace a file beside a scene, unless it belongs to a scene that was written here before.
fn check_beside(path: &Path, beside: &Path) -> Result<(), FileError> {
    let free = fs::symlink_metadata(beside).is_err();
    let written = || fs::read(path).is_ok_and(|text| text.starts_with(MARK.as_bytes()));
    if free || (written() && included_files(path).iter().any(|file| file == beside)) {
        return Ok(());
    }
    let message =
        format!("already exists, and belongs to no scene that was written to {}", path.display());
    let error = FileError::whole_file(beside, message);
    Err(error.with_help("delete it, or give the scene another name"))
}

fn failed(path: &Path, error: &dyn std::error::Error) -> FileError {
    FileError::whole_file(path, format!("cannot be written: {error}"))
}

/// Checks for contents that a scene built in code may have, but not one from a file.
fn check(scene: &Scene) -> Result<(), String> {
    let mut names = HashSet::new();
    for NamedMaterial { name, .. } in &scene.materials {
        if name.is_empty() || name.trim() != name || !names.insert(name) {
            return Err(format!(
                "a material is named \"{name}\": empty, framed by blanks, or twice"
            ));
        }
    }
    let spheres = &scene.spheres;
    let used = (0..spheres.len()).map(|sphere| spheres.material_of(sphere));
    let used = used.chain(scene.ground.iter().map(|ground| ground.material));
    let others = scene.other_bodies().into_iter();
    let used = used.chain(others.flat_map(|bodies| bodies.materials().iter().copied()));
    match used.max() {
        Some(row) if row as usize >= scene.materials.len() => {
            Err(format!("row {row} of the materials is used, but not there"))
        }
        _ => Ok(()),
    }
}

/// Returns a scene file without its spheres and without the picture of its environment, for what holds these by
/// itself.
///
/// # Errors
///
/// The scene has what a scene file cannot say, as for [`write()`].
pub fn text_without_columns(scene: &Scene) -> Result<String, String> {
    check(scene)?;
    let Scene { title, camera, settings, look, .. } = scene;
    let sky = match &scene.environment.map {
        EnvironmentMap::Picture { .. } => EnvironmentMap::Constant(Rgb::ZERO),
        other => other.clone(),
    };
    let sky = Environment { map: sky, illuminates: scene.environment.illuminates };
    Ok(document(scene, &Header { title, camera, settings, look }, &environment(&sky, "")))
}

/// The TOML file but for its spheres; `sky` is the section of the environment.
fn document(scene: &Scene, header: &Header, sky: &str) -> String {
    let mut text = format!("{MARK}title = {}\n\n", quoted(header.title));
    text += &render(header.settings);
    text += &section_text(header.camera);
    text += &look(header.look);
    text += &annotations(&scene.annotations);
    text += sky;
    for NamedMaterial { name, material } in &scene.materials {
        let _ = write!(text, "[material.{}]\n{}\n", quoted(name), keys::text(material));
    }
    text += &ground(scene);
    text.extend(scene.slices.iter().map(section_text));
    text.extend(scene.lights.iter().map(section_text));
    let name = |row: u32| quoted(&scene.materials[row as usize].name);
    text.extend(scene.file_bodies().map(|bodies| sections::bodies(bodies, name)));
    text
}

/// The section of an environment; `picture` is the name of its picture's file, if it has one.
pub(super) fn environment(environment: &Environment, picture: &str) -> String {
    section_text(&EnvironmentKeys { environment: environment.clone(), file: picture.to_owned() })
}

/// The section that names the file of the spheres.
fn file(columns: &Path) -> String {
    format!("[[file]]\npath = {}\nformat = \"csv\"\n", quoted(&name(columns)))
}

fn name(path: &Path) -> Cow<'_, str> {
    path.file_name().unwrap_or_default().to_string_lossy()
}

/// Every sphere's row; the columns of colors only where there are colors.
fn write_columns(scene: &Scene, file: &mut dyn io::Write) -> io::Result<()> {
    let spheres: &Spheres = &scene.spheres;
    let mut rows = csv::Writer::from_writer(file);
    let names = ["x", "y", "z", "radius", "material", "red", "green", "blue"];
    let width = if spheres.color.is_empty() { 5 } else { 8 };
    rows.write_record(&names[..width])?;
    // Materials are found by the check that comes first.
    let name = |sphere| scene.materials.get(spheres.material_of(sphere) as usize);
    for sphere in 0..spheres.len() {
        let center = spheres.center(sphere);
        for number in [center.x, center.y, center.z, spheres.radius[sphere]] {
            rows.write_field(format!("{number:?}"))?;
        }
        rows.write_field(name(sphere).map_or("", |material| &material.name))?;
        for value in spheres.color.get(sphere).map(Rgb::to_array).iter().flatten() {
            rows.write_field(format!("{value:?}"))?;
        }
        rows.write_record(None::<&[u8]>)?;
    }
    rows.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::{Map, Range, Scale, Spacing};
    use crate::scene::generate::default_scene;
    use crate::scene::particles::Cell;
    use crate::scene::{
        Anchor, Annotations, AxisTripod, BRIGHTEST, Background, ColorBar, ColorLegend,
        ConductorFresnel, Filter, FramedSphere, Ground, Insets, Integrator, Label, Lens,
        LetterSize, Lettering, Light, LightChoice, Material, Measure, Projection, Roulette,
        SamplerKind, ScaleBar, Slice, SliceMode,
    };
    use glam::DVec3;
    use std::sync::Arc;

    fn same(first: &Scene, second: &Scene) -> bool {
        // Floats print as what they are to the last bit, but for the payloads of NaN, which no
        // scene has.
        format!("{first:?}") == format!("{second:?}")
    }

    fn round_trip(scene: &Scene) -> Scene {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("scene.toml");
        write(scene, &path).expect("the scene can be written");
        Scene::load(&path).expect("what was written can be read")
    }

    fn material_of_each_kind() -> Vec<NamedMaterial> {
        let odd = Rgb::new(0.1, 1.0 / 3.0, 0.999_999_94);
        let exact = ConductorFresnel::Exact { eta: odd, k: odd * 3e10 };
        let materials = [
            Material::Lambertian { color: odd },
            Material::Conductor { fresnel: ConductorFresnel::Schlick(odd), roughness: 1.0 / 3.0 },
            Material::Conductor { fresnel: ConductorFresnel::Constant(odd), roughness: 0.0 },
            Material::Conductor { fresnel: exact, roughness: 1e-300 },
            Material::Dielectric { ior: 1.0 / 3.0, color: odd },
            Material::Plastic { color: odd, ior: 1.0 + f64::EPSILON },
            Material::Reflective { color: odd, diffuse: 0.3, mirror: 0.7 },
            Material::Emitter { radiance: odd * BRIGHTEST, albedo: odd },
        ];
        let names = ["plain", "gold, rough", "z", "a \"b\"", "ä\\", "t", "line\nbreak", "d.e"];
        let named = |(name, material): (&str, _)| NamedMaterial { name: name.to_owned(), material };
        names.into_iter().zip(materials).map(named).collect()
    }

    fn everything() -> Scene {
        let mut scene = default_scene(7);
        scene.title = "quotes \" and \\ and\nlines".to_owned();
        scene.materials = material_of_each_kind();
        scene.ground = Some(Ground {
            normal: DVec3::new(0.3, -0.4, 0.1).normalize(),
            height: -1e-300,
            material: 6,
        });
        for (_, mode) in SliceMode::ALL {
            let normal = DVec3::new(-0.2, 0.7, 0.3).normalize();
            scene.slices.push(Slice { normal, distance: 1.0 / 3.0, mode });
        }
        scene.lights.push(Light::Point {
            position: DVec3::new(1e300, -0.1, 5e-324),
            intensity: Rgb::new(f32::MAX, 1e-45, 0.0),
            falloff: false,
        });
        for (row, material) in scene.spheres.material.iter_mut().enumerate() {
            *material = row as u32 % 8;
        }
        scene
    }

    #[test]
    fn whole_scenes_survive_to_the_last_bit() {
        for mut scene in [default_scene(3), everything()] {
            scene.settings.stop_given = true;
            let again = round_trip(&scene);
            assert!(same(&scene, &again), "{scene:?}\n{again:?}");
        }
    }

    #[test]
    fn settings_and_cameras_come_back() {
        let mut scene = Scene::default();
        let integrators = [
            Integrator::Path,
            Integrator::Whitted { shadow_samples: 3 },
            Integrator::Ao { distance: 0.1 },
            Integrator::Ao { distance: f64::INFINITY },
        ];
        let roulettes = [Roulette::None, Roulette::Throughput, Roulette::Fixed(1.0 / 3.0)];
        let samplers = [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent];
        let filters = [Filter::Box, Filter::Gaussian, Filter::BlackmanHarris];
        let projections = [
            Projection::Perspective { fov: 179.999 },
            Projection::Orthographic { height: None },
            Projection::Orthographic { height: Some(1e-9) },
        ];
        let lights = [LightChoice::Tree, LightChoice::Power, LightChoice::Uniform];
        for choice in 0..4 {
            scene.settings.integrator = integrators[choice];
            scene.settings.light_choice = lights[choice % 3];
            scene.settings.caustics = choice % 2 == 0;
            scene.settings.roulette = roulettes[choice % 3];
            scene.settings.sampler = samplers[choice % 3];
            scene.settings.filter = filters[choice % 3];
            scene.settings.depth = Some(choice as u32).filter(|depth| *depth > 0);
            scene.settings.seed = u64::MAX;
            scene.camera.projection = projections[choice % 3];
            let focus = Some(choice as f64).filter(|focus| *focus > 0.0);
            scene.camera.lens = Some(Lens { aperture: choice as f64 / 3.0, focus });
            let again = round_trip(&scene);
            assert!(same(&scene, &again), "{scene:?}\n{again:?}");
        }
    }

    #[test]
    fn annotations_survive() {
        let range = Range::new(1.0 / 3.0, 7e30, Spacing::Logarithmic).unwrap();
        let scale = Scale { reversed: true, ..Scale::new(Map::Plasma, range) };
        let odd = Rgb::new(0.1, 1.0 / 3.0, 0.999_999_94);
        for (_, position) in Anchor::ALL {
            let label = "c_pe \"per atom\"\nand more".to_owned();
            let names = ["a", "b\\", ""].map(str::to_owned);
            let directions = [DVec3::X / 3.0, DVec3::new(1e-300, 2.0, -0.1), DVec3::NEG_Z];
            let entries = vec![(odd, "C \"a\"".to_owned()), (Rgb::ZERO, String::new())];
            let right = position.across() == 1.0;
            let annotations = Annotations {
                color_bar: Some(ColorBar { scale, label: label.clone(), position }),
                legend: Some(ColorLegend { label: label.clone(), entries, omitted: 7, position }),
                axes: Some(AxisTripod { directions, names, position }),
                scale_bar: Some(ScaleBar {
                    length: right.then_some(1.0 / 3.0),
                    unit: "\u{c5}".to_owned(),
                    position,
                }),
                labels: vec![
                    Label { text: label, position, at: right.then_some(DVec3::splat(0.1)) },
                    Label::default(),
                ],
                measures: vec![Measure {
                    points: vec![DVec3::ZERO, DVec3::new(1e-300, 1.0 / 3.0, -7.0)],
                    unit: "nm".to_owned(),
                }],
                lettering: Lettering {
                    size: Some(if right {
                        "7.1pt".parse().unwrap()
                    } else {
                        LetterSize::Share(1.0 / 30.0)
                    }),
                    color: right.then_some(odd * 3.0),
                },
            };
            let again = round_trip(&Scene { annotations: annotations.clone(), ..Scene::default() });
            assert_eq!(again.annotations, annotations);
        }
    }

    #[test]
    fn sizes_on_paper_survive() {
        for size in ["85mm", "85mmx60mm", "80mmx60mm"] {
            let text = format!("[render]\nsize = \"{size}\"\ndpi = 600\n");
            let scene = Scene::parse(&text, "", Path::new("")).unwrap();
            let again = round_trip(&scene);
            assert_eq!(again.settings, scene.settings);
            assert!(render(&scene.settings).contains(&format!("size = \"{size}\"\n")), "{size}");
        }
    }

    #[test]
    fn insets_survive() {
        let insets = Insets { left: 0.1, right: 1.0 / 3.0, bottom: 0.0, top: 1e-9 };
        let framed = Some(FramedSphere { center: DVec3::new(0.1, -2.0, 3e9), radius: 1e-3 });
        let camera = Camera { insets, zoom: 1.5, framed, ..Camera::default() };
        assert_eq!(
            round_trip(&Scene { camera: camera.clone(), ..Scene::default() }).camera,
            camera
        );
    }

    #[test]
    fn looks_survive() {
        let odd = Rgb::new(0.1, 1.0 / 3.0, BRIGHTEST);
        let vectors = [DVec3::new(0.1, -1e300, 0.0), DVec3::Y / 3.0, DVec3::Z];
        let cell = Cell { origin: DVec3::NEG_ONE / 7.0, vectors, periodic: [false; 3] };
        for background in [Background::Sky, Background::Color(odd), Background::Transparent] {
            for (depth_cue, outline) in [(false, false), (true, false), (false, true)] {
                let cell = outline.then_some(cell);
                let look = Look { background, depth_cue, outline, cell };
                let again = round_trip(&Scene { look, ..Scene::default() });
                assert_eq!(again.look, look);
            }
        }
    }

    #[test]
    fn only_chosen_samples_are_written() {
        let of = |spp, stop_given| {
            let settings = Settings { spp, stop_given, ..Settings::default() };
            let again = round_trip(&Scene { settings, ..Scene::default() }).settings;
            (again.spp, again.stop_given)
        };
        assert_eq!(of(16, false), (16, false));
        assert_eq!(of(16, true), (16, true));
        // Numbers that differ from the default are kept, so they count as chosen.
        assert_eq!(of(64, false), (64, true));
    }

    #[test]
    fn environment_maps_survive() {
        let pixels = vec![[0.1, 1e-30, 3e8], [0.0, 1.0 / 3.0, 2.0]];
        let image = Arc::new(crate::image::Image { width: 2, height: 1, pixels });
        let mut scene = default_scene(1);
        scene.settings.stop_given = true;
        scene.environment.map =
            EnvironmentMap::Picture { image, up: DVec3::Z, rotation: -12.3, scale: 0.7 };
        let again = round_trip(&scene);
        assert!(same(&scene, &again), "{:?}", again.environment);
    }

    #[test]
    fn scenes_that_no_file_can_describe_are_refused() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let refused = |scene: &Scene| write(scene, &folder.path().join("scene.toml")).is_err();
        let mut scene = default_scene(0);
        scene.materials[1].name = scene.materials[0].name.clone();
        assert!(refused(&scene));
        let mut scene = default_scene(0);
        scene.materials.truncate(1);
        assert!(refused(&scene));
        assert!(write(&default_scene(0), &folder.path().join("scene.csv")).is_err());
        assert!(write(&default_scene(0), &folder.path().join("nowhere/scene.toml")).is_err());
    }
}
