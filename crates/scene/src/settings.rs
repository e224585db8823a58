//! Render settings: size, samples, stop conditions, algorithms, exposure.
//!
//! [`Settings`] are their values; [`SETTINGS`] is a table with a row for each.

mod length;
mod limits;
mod table;

pub use length::{Length, Paper, paper_size};
pub use limits::{Limits, share};
pub use table::{
    INTEGRATORS, Kind, Names, Need, Role, SAMPLERS, SETTINGS, Scope, Setting, TONES, Value, manual,
};

pub use crate::image::tone::Tone;

use crate::image::tone;
use serde::{Deserialize, Serialize};
use std::num::NonZeroU16;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Render settings of a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Pixels, [`Settings::PIXELS`].
    pub width: u32,
    /// Pixels, [`Settings::PIXELS`].
    pub height: u32,
    /// Pixels per inch on paper; `None` if it is not known.
    pub dpi: Option<NonZeroU16>,
    /// The size on paper that the pixels come from; without effect once these are others: see [`Settings::paper`].
    pub paper: Option<Paper>,
    /// Samples per pixel, [`Settings::SAMPLES`]; with `until_error` or `time`, the maximum.
    pub spp: u32,
    /// Error that stops the render, more than 0 and at most 1: the root of the mean squared error of
    /// linear radiance, divided by the mean radiance.
    pub until_error: Option<f64>,
    /// Time that stops the render, [`Settings::TIMES`].
    pub time: Option<Duration>,
    /// Maximum number of bounces of a path: 0 sees only emitted light. `None`: no limit but
    /// [`Settings::HARD_DEPTH`].
    pub depth: Option<u32>,
    /// Seed of every random number.
    pub seed: u64,
    /// Rendering algorithm.
    pub integrator: Integrator,
    /// Generator of sample points.
    pub sampler: SamplerKind,
    /// Pixel filter.
    pub filter: Filter,
    /// Russian roulette, which ends paths before `depth`.
    pub roulette: Roulette,
    /// Light selection for direct lighting.
    pub light_choice: LightChoice,
    /// True if diffuse surfaces sample lights through mirrors and glass, where the path is known in
    /// closed form.
    pub caustics: bool,
    /// Exposure in stops, [`Settings::EXPOSURES`]: radiance is multiplied by 2 to this power in images
    /// of 8 or 16 bits.
    pub exposure: f64,
    /// Tone curve, applied before the sRGB curve.
    pub tone: Tone,
    /// Denoising of the finished picture, by the program: `render` leaves pictures as they
    /// are.
    pub denoise: Denoise,
    /// True if the user chose `spp`, `until_error` or `time`. If not, the program decides when a render stops.
    pub stop_given: bool,
}

/// The choice to denoise a finished picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Denoise {
    /// Unless the user chose the number of samples or the error, or the measured error rises by it.
    #[default]
    Auto,
    /// Always; the error target is then that of the denoised picture.
    On,
    /// Never.
    Off,
}

/// The rendering algorithm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Integrator {
    /// Path tracing with next-event estimation and multiple importance sampling.
    Path,
    /// Direct light with stratified shadow samples, and mirror and glass bounces: Whitted, "An Improved
    /// Illumination Model for Shaded Display", CACM 1980.
    Whitted {
        /// Shadow rays to each light at each hit, [`Settings::SAMPLES`].
        shadow_samples: u32,
    },
    /// Ambient occlusion: the cosine-weighted fraction of directions that see the sky.
    Ao {
        /// Maximum distance of occluders; 0 for none, `f64::INFINITY` for no limit.
        distance: f64,
    },
}

/// A generator of sample points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SamplerKind {
    /// Owen-scrambled Sobol points.
    Sobol,
    /// One jittered sample in each of `spp` strata, shuffled between dimensions.
    Stratified,
    /// Independent random numbers.
    Independent,
}

/// The pixel reconstruction filter, applied by filter importance sampling: every sample has weight
/// 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Filter {
    /// The pixel's own square.
    Box,
    /// Gaussian of standard deviation 0.5 pixel, cut at 2 pixels.
    Gaussian,
    /// Blackman-Harris window, 4 pixels wide.
    BlackmanHarris,
}

/// Russian roulette.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Roulette {
    /// Paths end by depth only.
    None,
    /// From the fourth bounce on, a path whose largest throughput is below a threshold survives with a
    /// probability in proportion to it. The threshold is a quarter under a sky, and a half without.
    Throughput,
    /// A path survives each bounce with this probability, more than 0 and at most 1.
    Fixed(f64),
}

/// A strategy that selects the light of a direct lighting sample.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LightChoice {
    /// By the estimated contribution of each light at the shading point, without occlusion.
    #[default]
    Tree,
    /// By power, the same everywhere.
    Power,
    /// With equal probability.
    Uniform,
}

/// A setting outside of its range.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is {value}, but must be {range}")]
pub struct InvalidSetting {
    /// Name of the setting in scene files.
    pub name: &'static str,
    /// Its value.
    pub value: String,
    /// The values that it may have.
    pub range: String,
}

impl Settings {
    /// Overrides settings with others, by name. If these add the first stop condition, the former number of samples is
    /// no limit.
    pub fn change(&mut self, values: &[(&'static str, Value)]) {
        let given = |name: &str| values.iter().any(|(own, _)| *own == name);
        let had_target = self.has_target();
        for (name, value) in values {
            if let Some(setting) = Setting::named(name) {
                setting.set(self, *value);
            }
        }
        self.stop_given |= ["spp", "until_error", "time"].into_iter().any(given);
        if !given("spp") {
            self.spp = match (had_target, self.has_target()) {
                (false, true) => Self::HARD_SAMPLES,
                (true, false) => Self::default().spp,
                _ => self.spp,
            };
        }
    }

    /// Returns the size on paper, if that is what the pixels come from.
    pub fn paper(&self) -> Option<Paper> {
        let resolution = self.dpi?;
        self.paper.filter(|paper| paper.pixels(resolution) == [self.width, self.height])
    }

    /// Sets the size on paper, and the pixels that it is; the resolution is 300 if there is none.
    fn set_paper(&mut self, paper: Paper) {
        let resolution = *self.dpi.get_or_insert(Length::RESOLUTION);
        [self.width, self.height] = paper.pixels(resolution);
        self.paper = Some(paper);
    }

    /// Sets the resolution, and the pixels of an image whose size on paper is given.
    fn set_resolution(&mut self, dpi: Option<NonZeroU16>) {
        let paper = self.paper();
        self.dpi = dpi;
        self.paper = None;
        if let Some(paper) = paper {
            self.set_paper(paper);
        }
    }

    /// Width and height of an image in pixels.
    pub const PIXELS: RangeInclusive<u32> = 1..=65_535;

    /// Samples per pixel or per light: above, sums in single precision would stall.
    pub const SAMPLES: RangeInclusive<u32> = 1..=1 << 24;

    /// Time limits: up to some thirty years.
    pub const TIMES: RangeInclusive<Duration> =
        Duration::from_millis(1)..=Duration::from_secs(1_000_000_000);

    /// Exposure in stops.
    pub const EXPOSURES: RangeInclusive<f64> = tone::EXPOSURES;

    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// The first value that is not.
    pub fn check(&self) -> Result<(), InvalidSetting> {
        SETTINGS.iter().try_for_each(|setting| setting.check(self))
    }

    /// Maximum number of bounces of a path whose depth is not limited. Paths that end here are counted and
    /// reported.
    pub const HARD_DEPTH: u32 = 4096;

    /// Default maximum number of samples per pixel of a render that an error or a time stops.
    pub const HARD_SAMPLES: u32 = 1 << 16;

    /// Returns whether an error or a time stops the render.
    pub fn has_target(&self) -> bool {
        self.until_error.is_some() || self.time.is_some()
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 800,
            height: 600,
            dpi: None,
            paper: None,
            spp: 16,
            until_error: None,
            time: None,
            depth: None,
            seed: 0,
            integrator: Integrator::Path,
            sampler: SamplerKind::Sobol,
            filter: Filter::BlackmanHarris,
            roulette: Roulette::Throughput,
            light_choice: LightChoice::Tree,
            caustics: true,
            exposure: 0.0,
            tone: Tone::Linear,
            denoise: Denoise::Auto,
            stop_given: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    /// Settings with every field of every integrator and roulette, between them.
    fn all_fields() -> Vec<Settings> {
        let integrators = [
            Integrator::Path,
            Integrator::Whitted { shadow_samples: 16 },
            Integrator::Ao { distance: 2.5 },
        ];
        let roulettes = [Roulette::None, Roulette::Throughput, Roulette::Fixed(0.5)];
        let settings = |(integrator, roulette)| Settings {
            width: 800,
            height: 600,
            dpi: NonZeroU16::new(300),
            paper: Some(Paper::new(Length::points(192), None, [800, 600])),
            spp: 16,
            until_error: Some(0.25),
            time: Some(Duration::from_millis(1500)),
            depth: Some(5),
            seed: 7,
            integrator,
            sampler: SamplerKind::Sobol,
            filter: Filter::Box,
            roulette,
            light_choice: LightChoice::Tree,
            caustics: true,
            exposure: 0.5,
            tone: Tone::Linear,
            denoise: Denoise::On,
            stop_given: true,
        };
        integrators.into_iter().zip(roulettes).map(settings).collect()
    }

    /// Paths to all numbers in a tree of values.
    fn numbers(value: &Value, path: &str, found: &mut Vec<(String, bool)>) {
        match value {
            Value::Number(number) => found.push((path.to_owned(), number.is_f64())),
            Value::Object(entries) => {
                entries.iter().for_each(|(key, own)| numbers(own, &format!("{path}/{key}"), found));
            }
            Value::Array(list) => {
                let entries = list.iter().enumerate();
                entries.for_each(|(row, own)| numbers(own, &format!("{path}/{row}"), found));
            }
            Value::Null => panic!("{path} needs a value here, so that its numbers are tested"),
            Value::Bool(_) | Value::String(_) => (),
        }
    }

    /// The settings with a number as their text has it, which JSON need not be able to say.
    fn changed(settings: &Settings, path: &str, number: f64) -> Option<Settings> {
        /// Stands for the number until the text is read.
        const MARK: f64 = 12_345.062_5;
        let mut value = serde_json::to_value(settings).unwrap();
        *value.pointer_mut(path).unwrap() = MARK.into();
        let table = toml::to_string(&value).unwrap();
        let table = table.replace(
            &MARK.to_string(),
            &match number {
                number if number.is_nan() => "nan".to_owned(),
                number if number.is_infinite() => format!("{number}"),
                number => format!("{number:?}"),
            },
        );
        toml::from_str::<toml::Value>(&table).unwrap().try_into().ok()
    }

    #[test]
    fn no_number_of_the_settings_can_be_out_of_range() {
        let mut floats = Vec::new();
        for settings in all_fields() {
            assert_eq!(settings.check(), Ok(()));
            let mut found = Vec::new();
            numbers(&serde_json::to_value(&settings).unwrap(), "", &mut found);
            for (path, _) in found.into_iter().filter(|(_, is_float)| *is_float) {
                for number in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -1e300, 1e300] {
                    let other = changed(&settings, &path, number).expect("a float of any value");
                    let endless = path == "/integrator/Ao/distance" && number > 0.0;
                    assert_eq!(other.check().is_ok(), endless, "{path} {number}");
                }
                floats.push(path);
            }
        }
        for path in ["/until_error", "/integrator/Ao/distance", "/roulette/Fixed", "/exposure"] {
            assert!(floats.iter().any(|own| own == path), "{path} {floats:?}");
        }
    }

    #[test]
    fn errors_name_the_setting() {
        let usual = Settings::default;
        let cases = [
            ("size", Settings { width: 0, ..usual() }),
            ("size", Settings { height: 65_536, ..usual() }),
            ("spp", Settings { spp: 0, ..usual() }),
            ("spp", Settings { spp: u32::MAX, ..usual() }),
            ("until_error", Settings { until_error: Some(f64::NAN), ..usual() }),
            ("time", Settings { time: Some(Duration::ZERO), ..usual() }),
            ("time", Settings { time: Some(Duration::MAX), ..usual() }),
            ("exposure", Settings { exposure: f64::NAN, ..usual() }),
            ("roulette", Settings { roulette: Roulette::Fixed(0.0), ..usual() }),
        ];
        for (name, settings) in cases {
            let error = settings.check().expect_err(name);
            assert!(error.name == name && error.to_string().contains(name), "{error}");
        }
    }
}
