//! Notes about options that have no effect.

use super::job::Job;
use spherule_render::World;
use spherule_render::image::{Depth, Format};
use spherule_render::scene::{Integrator, Roulette, Settings, Tone};
use spherule_render::trace::Traversal;

/// The bounce at which Russian roulette by throughput starts, from 1.
const ROULETTE_BEGINS: u32 = 4;

/// Returns a sentence for each option that has no effect.
pub(super) fn notes(job: &Job, settings: &Settings, world: &World) -> Vec<String> {
    let mut notes = Vec::new();
    let mut note = |asked: bool, idle: bool, name: &str, why: &str| {
        if asked && idle {
            notes.push(format!("{name} has no effect: {why}"));
        }
    };
    let picture = job.picture;
    let whitted = matches!(settings.integrator, Integrator::Whitted { .. });
    let ao = matches!(settings.integrator, Integrator::Ao { .. });
    let shadow_samples = picture.shadow_samples.is_some();
    note(shadow_samples, !whitted, "--shadow-samples", "it applies only to the integrator whitted");
    let dark = whitted && !world.features.lights;
    note(shadow_samples, dark, "--shadow-samples", "the scene has no lights to sample");
    note(
        picture.ao_distance.is_some(),
        !ao,
        "--ao-distance",
        "it applies only to the integrator ao",
    );
    let one_bounce = "the integrator ao traces no paths";
    let materials = job.looks.types.iter().any(|look| look.material.is_some());
    let matte = "the integrator ao ignores materials";
    note(materials, ao, "--type with a material", matte);
    note(picture.depth.is_some(), ao, "--depth", one_bounce);
    note(picture.roulette.is_some(), ao, "--roulette", one_bounce);
    let chosen = picture.light_choice.is_some();
    note(chosen, ao || whitted, "--light-choice", "it applies only to the integrator path");
    let lone = world.lights.len() < 2;
    note(chosen, lone, "--light-choice", "the scene has fewer than two lights");
    let cast = !ao && !whitted && !world.caustic_casters.is_empty();
    note(picture.no_caustics, !cast, "--no-caustics", "the scene has no caustics that are sampled");
    let short = settings.depth.is_some_and(|depth| depth < ROULETTE_BEGINS);
    let late = !ao && short && picture.roulette == Some(Roulette::Throughput);
    note(late, true, "--roulette throughput", "it starts at the fourth bounce, beyond --depth");
    let alone = matches!(job.speed.traversal, Traversal::Single | Traversal::Stream);
    note(
        job.speed.lanes.is_some(),
        alone,
        "--lanes",
        "--traversal scalar and stream trace no packets",
    );
    let encoding = job.encoding;
    let linear = job.format.is_linear();
    let holds = format!("{} files store linear radiance", job.format);
    note(exposed(job, settings), linear, "exposure", &holds);
    note(toned(job, settings), linear, "tone", &holds);
    note(encoding.bits.is_some(), linear, "--bits", "EXR and PFM files store 32-bit floats");
    let eight = !linear && !job.format.has_sixteen_bits();
    let deep = encoding.bits.is_some_and(|bits| bits != Depth::Eight);
    note(deep, eight, "--bits", &format!("{} files store 8 bits", job.format));
    let lossless = job.format != Format::Jpeg;
    note(encoding.quality.is_some(), lossless, "--quality", "the output is not JPEG");
    let part = job.part.is_some();
    note(encoding.bits.is_some(), part, "--bits", "parts are not images; use it with merge");
    note(encoding.ppm.is_some(), part, "--ppm", "parts are not images; use it with merge");
    note(encoding.ppm.is_some(), job.format != Format::Ppm, "--ppm", "the output is not PPM");
    notes
}

/// Returns whether the command or the scene sets an exposure.
fn exposed(job: &Job, settings: &Settings) -> bool {
    job.encoding.exposure.is_some() || settings.exposure != 0.0
}

/// Returns whether the command or the scene sets a tone curve.
fn toned(job: &Job, settings: &Settings) -> bool {
    job.encoding.tone.is_some() || settings.tone != Tone::Linear
}
