//! Time saved by eliding work that a scene does not need. Each elision is turned off by itself, in a
//! scene where it applies; the image stays the same, byte for byte.

mod converged;
mod tables;

use self::tables::{plot, table};
use super::rounds::Times;
use super::scenes::{FIELD, NamedScene};
use super::{BenchError, Options, Progress};
use crate::report::Report;
use spherule_render::image::Image;
use spherule_render::render::{self, Elisions, RenderError, render};
use spherule_render::scene::{EnvironmentMap, Integrator, Material, Rgb, Scene};
use spherule_render::world::World;

const EXPLANATION: &str = "Each elision is turned off by itself, in a scene where it applies. The scene \
    is rendered with and without it in turns, and images are compared byte for byte. Converged tiles \
    are different: there an adaptive render, which samples tiles where that reduces the error most and \
    stops at an error, is compared with a render that takes equally many samples of every pixel and \
    has the same error, as estimated from images with other seeds. Each of its tiles is compared byte \
    for byte with a plain render of as many samples. Work that is always omitted (shading stages of \
    materials that do not occur, color columns) cannot be turned on, and is not measured.";

/// An elision, and the scene in which it is measured.
struct MeasuredElision {
    name: &'static str,
    about: &'static str,
    scene: &'static str,
    change: fn(&mut Scene),
    without: Elisions,
}

const ELISIONS: [MeasuredElision; 7] = [
    MeasuredElision {
        name: "empty tiles",
        about: "no sphere tests in tiles without spheres",
        scene: FIELD,
        change: |_| (),
        without: Elisions { empty_tiles: false, ..Elisions::ALL },
    },
    MeasuredElision {
        name: "even background",
        about: "no paths in tiles of one color, in the field without ground and sun",
        scene: FIELD,
        change: floating,
        without: Elisions { even_background: false, ..Elisions::ALL },
    },
    MeasuredElision {
        name: "no lens",
        about: "no lens samples, in the field with a pinhole camera",
        scene: FIELD,
        change: |scene| scene.camera.lens = None,
        without: Elisions { lens: false, ..Elisions::ALL },
    },
    MeasuredElision {
        name: "no lights",
        about: "no light samples, in the field without its sun",
        scene: FIELD,
        change: |scene| scene.lights.clear(),
        without: Elisions { lights: false, ..Elisions::ALL },
    },
    MeasuredElision {
        name: "no plane",
        about: "no ground tests, in the field without a ground",
        scene: FIELD,
        change: |scene| scene.ground = None,
        without: Elisions { plane: false, ..Elisions::ALL },
    },
    MeasuredElision {
        name: "no glass",
        about: "no interior lists of paths, in the field with chalk instead of glass",
        scene: FIELD,
        change: chalk_for_glass,
        without: Elisions { glass: false, ..Elisions::ALL },
    },
    MeasuredElision {
        name: "any occluder",
        about: "shadow rays stop at any sphere, not the nearest",
        scene: "paper-field-20",
        change: |scene| scene.settings.integrator = Integrator::Whitted { shadow_samples: 4 },
        without: Elisions { nearest_occluder: false, ..Elisions::ALL },
    },
];

/// Leaves only spheres under a white sky.
fn floating(scene: &mut Scene) {
    scene.ground = None;
    scene.lights.clear();
    scene.environment.map = EnvironmentMap::Constant(Rgb::ONE);
}

/// Replaces glass by a diffuse material.
fn chalk_for_glass(scene: &mut Scene) {
    for row in &mut scene.materials {
        if let Material::Dielectric { color, .. } = row.material {
            row.material = Material::Lambertian { color };
        }
    }
}

/// Times with the elision, then without it.
struct Outcome {
    name: &'static str,
    about: String,
    scene: String,
    times: Times,
}

/// Measures the time saved by each elision; in each of the given scenes, if there are any.
///
/// # Errors
/// A scene is invalid, or an elision changes the image.
pub fn measure(options: &Options, progress: Progress) -> Result<Report, BenchError> {
    let mut outcomes = Vec::new();
    for elision in &ELISIONS {
        for scene in NamedScene::choose(options, &[elision.scene])? {
            progress(&format!("skips: {}, {}", elision.name, scene.name));
            outcomes.push(measure_elision(elision, scene, options)?);
        }
    }
    for scene in NamedScene::choose(options, &[FIELD])? {
        progress(&format!("skips: {}, {}", converged::NAME, scene.name));
        outcomes.push(converged::measure(scene, options)?);
    }
    Ok(Report {
        name: "skips".to_owned(),
        title: "Time saved by skipping work".to_owned(),
        about: EXPLANATION.to_owned(),
        settings: options.settings(),
        tables: vec![table(&outcomes)],
        plots: vec![plot(&outcomes)],
    })
}

fn measure_elision(
    elision: &'static MeasuredElision,
    scene: NamedScene,
    options: &Options,
) -> Result<Outcome, BenchError> {
    let mut scene = scene.resized(options.pick([24, 240, 640]));
    (elision.change)(&mut scene.scene);
    scene.scene.settings.spp = options.pick([1, 16, 32]);
    let world = scene.world()?;
    let mut first: Option<Image> = None;
    let times = Times::measure(options.rounds, 2, |contestant| {
        let elisions = if contestant == 0 { Elisions::ALL } else { elision.without };
        let (seconds, image) = draw(&world, &scene, elisions)?;
        if *first.get_or_insert_with(|| image.clone()) == image {
            return Ok(seconds);
        }
        let message = format!("{}: the image differs without \"{}\"", scene.name, elision.name);
        Err(BenchError::Differ(message))
    })?;
    let MeasuredElision { name, about, .. } = elision;
    Ok(Outcome { name, about: (*about).to_owned(), scene: scene.stem(), times })
}

fn draw(
    world: &World,
    scene: &NamedScene,
    elisions: Elisions,
) -> Result<(f64, Image), RenderError> {
    let options = render::Options { elisions, ..render::Options::default() };
    let render = render(world, &scene.scene.settings, &options)?;
    Ok((render.elapsed.as_secs_f64(), render.image))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::tests::quick;

    #[test]
    fn elisions_do_not_change_images() {
        let report = measure(&quick(&[]), &|_| ()).unwrap();
        assert_eq!(report.tables[0].rows.len(), ELISIONS.len() + 1);
        // Also in scenes with lens, lights, glass and ground.
        let report = measure(&quick(&["field", "smallpt", "veach"]), &|_| ()).unwrap();
        assert_eq!(report.tables[0].rows.len(), 3 * (ELISIONS.len() + 1));
    }

    #[test]
    fn every_elision_is_measured_once() {
        for (i, one) in ELISIONS.iter().enumerate() {
            assert_ne!(one.without, Elisions::ALL);
            assert!(ELISIONS[..i].iter().all(|other| other.without != one.without));
        }
    }
}
