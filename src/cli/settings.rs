//! Render settings: options that override the scene's, and lists of settings for metadata and reports.

use super::args::{EncodingArgs, PictureArgs};
use super::names::{FILTERS, INTEGRATORS, LIGHT_CHOICES, PPM, SAMPLERS, TONES};
use super::values::OrNone;
use serde_json::{Map, Value, json};
use spherule_render::film::Region;
use spherule_render::image::{Depth, Format, WriteOptions};
use spherule_render::scene::{Integrator, Roulette, Settings};

/// Names and values, in order.
pub(super) type List = Map<String, Value>;

impl PictureArgs {
    /// Overrides the scene's settings with those of the command line.
    pub(super) fn replace(&self, settings: &mut Settings) {
        if let Some(size) = self.size {
            (settings.width, settings.height) = (size.width, size.height);
        }
        if let Some(depth) = self.depth {
            settings.depth = depth.0;
        }
        self.set_target(settings);
        settings.seed = self.seed.unwrap_or(settings.seed);
        settings.sampler = self.sampler.unwrap_or(settings.sampler);
        settings.filter = self.filter.unwrap_or(settings.filter);
        settings.roulette = self.roulette.unwrap_or(settings.roulette);
        settings.light_choice = self.light_choice.unwrap_or(settings.light_choice);
        settings.caustics &= !self.no_caustics;
        settings.integrator = self.integrator(settings.integrator);
    }

    /// Sets samples and targets. If the command line sets the first target, the scene's number of samples is
    /// no limit.
    fn set_target(&self, settings: &mut Settings) {
        let had_target = settings.has_target();
        if let Some(OrNone(error)) = self.until_error {
            settings.until_error = error;
        }
        if let Some(OrNone(time)) = self.time {
            settings.time = time;
        }
        let default = match (had_target, settings.has_target()) {
            (false, true) => Settings::HARD_SAMPLES,
            (true, false) => Settings::default().spp,
            _ => settings.spp,
        };
        settings.spp = self.spp.unwrap_or(default);
    }

    /// Returns the integrator. The scene's parameters are kept if the command line names the scene's
    /// integrator.
    fn integrator(&self, scene: Integrator) -> Integrator {
        let same = |typed: &Integrator| INTEGRATORS.name(typed) == INTEGRATORS.name(&scene);
        match self.integrator.filter(|typed| !same(typed)).unwrap_or(scene) {
            Integrator::Path => Integrator::Path,
            Integrator::Whitted { shadow_samples } => Integrator::Whitted {
                shadow_samples: self.shadow_samples.unwrap_or(shadow_samples),
            },
            Integrator::Ao { distance } => {
                Integrator::Ao { distance: self.ao_distance.unwrap_or(distance) }
            }
        }
    }
}

impl EncodingArgs {
    /// Overrides the scene's settings with those of the command line.
    pub(super) fn replace(&self, settings: &mut Settings) {
        settings.exposure = self.exposure.unwrap_or(settings.exposure);
        settings.tone = self.tone.unwrap_or(settings.tone);
    }
}

/// Lists all settings that determine the image, by the names of scene files, and nothing else: equal images
/// have equal lists.
pub(super) fn list(settings: &Settings, region: Region) -> List {
    let mut list = List::new();
    let mut put = |name: &str, value: Value| list.insert(name.to_owned(), value);
    put("width", json!(settings.width));
    put("height", json!(settings.height));
    let whole = Region { x: 0, y: 0, width: settings.width, height: settings.height };
    if region != whole {
        put("region", json!(region_text(region)));
    }
    put("spp", json!(settings.spp));
    if let Some(error) = settings.until_error {
        put("until_error", json!(error));
    }
    if let Some(time) = settings.time {
        put("time", json!(time.as_secs_f64()));
    }
    put("depth", settings.depth.map_or(json!("unlimited"), |depth| json!(depth)));
    put("seed", json!(settings.seed));
    put("integrator", json!(INTEGRATORS.name(&settings.integrator)));
    match settings.integrator {
        Integrator::Path => put("light_choice", json!(LIGHT_CHOICES.name(&settings.light_choice))),
        Integrator::Whitted { shadow_samples } => put("shadow_samples", json!(shadow_samples)),
        Integrator::Ao { distance } if distance.is_finite() => put("ao_distance", json!(distance)),
        Integrator::Ao { .. } => put("ao_distance", json!("inf")),
    };
    if !settings.caustics {
        put("caustics", json!(false));
    }
    put("sampler", json!(SAMPLERS.name(&settings.sampler)));
    put("filter", json!(FILTERS.name(&settings.filter)));
    put("roulette", roulette(settings.roulette));
    list
}

/// Lists exposure and tone curve; nothing for formats that store linear radiance.
pub(super) fn list_encoding(format: Format, options: &WriteOptions) -> List {
    let mut list = List::new();
    if !format.is_linear() {
        list.insert("exposure".to_owned(), json!(options.exposure));
        list.insert("tone".to_owned(), json!(TONES.name(&options.tone)));
        list.insert("bits".to_owned(), json!(bits(options.depth)));
    }
    if format == Format::Jpeg {
        list.insert("quality".to_owned(), json!(options.quality));
    }
    if format == Format::Ppm {
        list.insert("ppm".to_owned(), json!(PPM.name(&options.ppm)));
    }
    list
}

/// Formats a region as the command line takes it.
pub(super) fn region_text(region: Region) -> String {
    format!("{},{},{}x{}", region.x, region.y, region.width, region.height)
}

fn roulette(roulette: Roulette) -> Value {
    match roulette {
        Roulette::None => json!("none"),
        Roulette::Throughput => json!("throughput"),
        Roulette::Fixed(probability) => json!(probability),
    }
}

fn bits(depth: Depth) -> u32 {
    match depth {
        Depth::Eight => 8,
        Depth::Sixteen => 16,
    }
}
