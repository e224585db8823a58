//! `[render]`: how the picture is made.

use super::block::Block;
use super::value::{Limits, Value};
use crate::scene::{
    FileError, Filter, Integrator, LightChoice, Roulette, SamplerKind, Settings, Tone,
};
use std::time::Duration;
use toml::de::DeValue;

/// Most pixels each way.
const MOST_PIXELS: u64 = *Settings::PIXELS.end() as u64;
/// Most samples per pixel.
const MOST_SAMPLES: u64 = *Settings::SAMPLES.end() as u64;

pub(super) fn read(block: &Block) -> Result<Settings, FileError> {
    let usual = Settings::default();
    let [width, height] =
        block.value("size").map_or(Ok([usual.width, usual.height]), |value| size(&value))?;
    let until_error = block.value("until_error").map(|v| v.number(Limits::AboveTo(0.0, 1.0)));
    let [least, most] = [Settings::TIMES.start(), Settings::TIMES.end()].map(Duration::as_secs_f64);
    let time = block.value("time").map(|v| v.number(Limits::Within(least, most)));
    let (until_error, time) = (until_error.transpose()?, time.transpose()?);
    let targeted = until_error.is_some() || time.is_some();
    let usual_spp = if targeted { Settings::HARD_SAMPLES } else { usual.spp };
    let spp = block.value("spp").map_or(Ok(u64::from(usual_spp)), |v| v.whole(1, MOST_SAMPLES))?;
    let depth = block.value("depth").map_or(Ok(usual.depth), |value| depth(&value))?;
    let seed = block.value("seed").map_or(Ok(usual.seed), |value| value.whole(0, u64::MAX))?;
    let exposure = block.value("exposure").map_or(Ok(usual.exposure), |value| {
        let exposures = Settings::EXPOSURES;
        value.number(Limits::Within(*exposures.start(), *exposures.end()))
    })?;
    Ok(Settings {
        width,
        height,
        spp: spp as u32,
        until_error,
        time: time.map(Duration::from_secs_f64),
        depth,
        seed,
        integrator: integrator(block)?,
        sampler: block.value("sampler").map_or(Ok(usual.sampler), |value| sampler(&value))?,
        filter: block.value("filter").map_or(Ok(usual.filter), |value| filter(&value))?,
        roulette: block.value("roulette").map_or(Ok(usual.roulette), |value| roulette(&value))?,
        light_choice: block
            .value("light_choice")
            .map_or(Ok(usual.light_choice), |value| light_choice(&value))?,
        caustics: block.value("caustics").map_or(Ok(usual.caustics), |value| value.flag())?,
        exposure,
        tone: block.value("tone").map_or(Ok(usual.tone), |value| tone(&value))?,
    })
}

fn size(value: &Value) -> Result<[u32; 2], FileError> {
    let [width, height] = value.list()?;
    let pixels = |value: Value| value.whole(1, MOST_PIXELS).map(|pixels| pixels as u32);
    Ok([pixels(width)?, pixels(height)?])
}

fn depth(value: &Value) -> Result<Option<u32>, FileError> {
    match value.item {
        DeValue::String(_) => value.choice(&["unlimited"]).map(|_| None),
        _ => value.whole(0, u64::from(u32::MAX)).map(|depth| Some(depth as u32)),
    }
}

fn integrator(block: &Block) -> Result<Integrator, FileError> {
    Ok(match block.kind()? {
        "whitted" => {
            let samples = block.value("shadow_samples");
            let samples = samples.map_or(Ok(16), |value| value.whole(1, MOST_SAMPLES))?;
            Integrator::Whitted { shadow_samples: samples as u32 }
        }
        "ao" => {
            let distance = block.value("ao_distance");
            let distance =
                distance.map_or(Ok(f64::INFINITY), |value| value.number(Limits::Positive))?;
            Integrator::Ao { distance }
        }
        _ => Integrator::Path,
    })
}

fn sampler(value: &Value) -> Result<SamplerKind, FileError> {
    Ok(match value.choice(&["sobol", "stratified", "independent"])? {
        "stratified" => SamplerKind::Stratified,
        "independent" => SamplerKind::Independent,
        _ => SamplerKind::Sobol,
    })
}

fn filter(value: &Value) -> Result<Filter, FileError> {
    Ok(match value.choice(&["box", "gaussian", "blackman-harris"])? {
        "box" => Filter::Box,
        "gaussian" => Filter::Gaussian,
        _ => Filter::BlackmanHarris,
    })
}

fn roulette(value: &Value) -> Result<Roulette, FileError> {
    match value.item {
        DeValue::String(_) => Ok(match value.choice(&["none", "throughput"])? {
            "none" => Roulette::None,
            _ => Roulette::Throughput,
        }),
        _ => value.number(Limits::AboveTo(0.0, 1.0)).map(Roulette::Fixed),
    }
}

fn light_choice(value: &Value) -> Result<LightChoice, FileError> {
    Ok(match value.choice(&["tree", "power", "uniform"])? {
        "power" => LightChoice::Power,
        "uniform" => LightChoice::Uniform,
        _ => LightChoice::Tree,
    })
}

fn tone(value: &Value) -> Result<Tone, FileError> {
    Ok(match value.choice(&["linear", "filmic"])? {
        "filmic" => Tone::Filmic,
        _ => Tone::Linear,
    })
}
