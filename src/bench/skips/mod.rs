//! What is saved by leaving out what a scene does not need: each saving is turned off by itself, in
//! a scene that allows it, and the picture stays the same to the byte.

mod converged;
mod tables;

use self::tables::{plot, table};
use super::rounds::Times;
use super::scenes::{FIELD, NamedScene};
use super::{BenchError, Options, Tell};
use crate::image::Image;
use crate::render::{self, Elisions, RenderError, render};
use crate::report::Report;
use crate::scene::{EnvironmentMap, Integrator, Material, Rgb, Scene};
use crate::world::World;

const EXPLANATION: &str = "Each saving is turned off by itself, in a scene that allows it; with and \
    without it the scene is rendered by turns. Pictures are compared byte by byte. Converged tiles are \
    another matter: there a picture that gives samples to the tiles where they help most, and ends at \
    an error, is held against one with as many samples of every pixel as have the same error, which \
    pictures of other seeds tell; byte by byte, each of its tiles is compared with a plain render of as \
    many samples. What a census of the scene leaves out without a choice (shading stages of materials \
    that do not occur, columns of colors) costs nothing that could be turned on.";

/// A saving: what it is, in which scene it is measured, and what that scene is changed to.
struct Saving {
    name: &'static str,
    about: &'static str,
    scene: &'static str,
    change: fn(&mut Scene),
    without: Elisions,
}

const SAVINGS: [Saving; 7] = [
    Saving {
        name: "empty tiles",
        about: "no tests against spheres where the tile sees none",
        scene: FIELD,
        change: |_| (),
        without: Elisions { empty_tiles: false, ..Elisions::ALL },
    },
    Saving {
        name: "even background",
        about: "no paths where the tile sees one color, in the field without ground and sun",
        scene: FIELD,
        change: floating,
        without: Elisions { even_background: false, ..Elisions::ALL },
    },
    Saving {
        name: "no lens",
        about: "no samples of a lens, in the field through a pinhole",
        scene: FIELD,
        change: |scene| scene.camera.lens = None,
        without: Elisions { lens: false, ..Elisions::ALL },
    },
    Saving {
        name: "no lights",
        about: "no samples of lights, in the field without its sun",
        scene: FIELD,
        change: |scene| scene.lights.clear(),
        without: Elisions { lights: false, ..Elisions::ALL },
    },
    Saving {
        name: "no plane",
        about: "no tests against a ground, in the field without one",
        scene: FIELD,
        change: |scene| scene.ground = None,
        without: Elisions { plane: false, ..Elisions::ALL },
    },
    Saving {
        name: "no glass",
        about: "no lists of the glass that paths are in, in the field with chalk for glass",
        scene: FIELD,
        change: chalk_for_glass,
        without: Elisions { glass: false, ..Elisions::ALL },
    },
    Saving {
        name: "any occluder",
        about: "shadow rays end at the first sphere found, whether or not it is the nearest",
        scene: "paper-field-20",
        change: |scene| scene.settings.integrator = Integrator::Whitted { shadow_samples: 4 },
        without: Elisions { nearest_occluder: false, ..Elisions::ALL },
    },
];

/// Nothing but spheres in a white sky.
fn floating(scene: &mut Scene) {
    scene.ground = None;
    scene.lights.clear();
    scene.environment.map = EnvironmentMap::Constant(Rgb::ONE);
}

/// The field without glass.
fn chalk_for_glass(scene: &mut Scene) {
    for row in &mut scene.materials {
        if let Material::Dielectric { color, .. } = row.material {
            row.material = Material::Lambertian { color };
        }
    }
}

/// What was measured: with the saving, and without it.
struct Outcome {
    name: &'static str,
    about: String,
    scene: String,
    times: Times,
}

/// Measures the savings; with scenes named, all of them in each of these.
///
/// # Errors
/// A scene is wrong, or a picture is not the same without a saving.
pub fn measure(options: &Options, tell: Tell) -> Result<Report, BenchError> {
    let mut outcomes = Vec::new();
    for saving in &SAVINGS {
        for scene in NamedScene::choose(options, &[saving.scene])? {
            tell(&format!("skips: {}, {}", saving.name, scene.name));
            outcomes.push(of_saving(saving, scene, options)?);
        }
    }
    for scene in NamedScene::choose(options, &[FIELD])? {
        tell(&format!("skips: {}, {}", converged::NAME, scene.name));
        outcomes.push(converged::measure(scene, options)?);
    }
    Ok(Report {
        name: "skips".to_owned(),
        title: "What leaving out saves".to_owned(),
        about: EXPLANATION.to_owned(),
        settings: options.settings(),
        tables: vec![table(&outcomes)],
        plots: vec![plot(&outcomes)],
    })
}

fn of_saving(
    saving: &'static Saving,
    scene: NamedScene,
    options: &Options,
) -> Result<Outcome, BenchError> {
    let mut scene = scene.resized(options.pick([32, 240, 640]));
    (saving.change)(&mut scene.scene);
    scene.scene.settings.spp = options.pick([1, 16, 32]);
    let world = scene.world()?;
    let mut first: Option<Image> = None;
    let times = Times::by_turns(options.rounds, 2, |contestant| {
        let elisions = if contestant == 0 { Elisions::ALL } else { saving.without };
        let (seconds, image) = draw(&world, &scene, elisions)?;
        if *first.get_or_insert_with(|| image.clone()) == image {
            return Ok(seconds);
        }
        let name = format!("{}: the picture without the saving \"{}\"", scene.name, saving.name);
        Err(BenchError::Differ(format!("{name} is another one")))
    })?;
    let Saving { name, about, .. } = saving;
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
    fn pictures_do_not_depend_on_what_is_left_out() {
        let report = measure(&quick(&[]), &|_| ()).unwrap();
        assert_eq!(report.tables[0].rows.len(), SAVINGS.len() + 1);
        // Scenes with lens, lights, glass and ground take no harm either.
        let report = measure(&quick(&["field", "smallpt", "veach"]), &|_| ()).unwrap();
        assert_eq!(report.tables[0].rows.len(), 3 * (SAVINGS.len() + 1));
    }

    #[test]
    fn every_saving_is_measured_once() {
        for (i, one) in SAVINGS.iter().enumerate() {
            assert_ne!(one.without, Elisions::ALL);
            assert!(SAVINGS[..i].iter().all(|other| other.without != one.without));
        }
    }
}
