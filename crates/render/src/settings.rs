//! How the picture is made.

use serde::{Deserialize, Serialize};
use std::fmt::Debug;
use std::ops::RangeInclusive;
use std::time::Duration;

/// How the picture is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Pixels, [`Settings::PIXELS`].
    pub width: u32,
    /// Pixels, [`Settings::PIXELS`].
    pub height: u32,
    /// Samples per pixel, [`Settings::SAMPLES`]; with a target, `until_error` or `time`, the most.
    pub spp: u32,
    /// Ends the render when the picture's error is below this, more than 0 and at most 1: the root
    /// of the mean squared error of linear radiance, by the mean radiance.
    pub until_error: Option<f64>,
    /// Ends the render when this time is over, [`Settings::TIMES`].
    pub time: Option<Duration>,
    /// Most scatterings on a path: 0 sees only what emits. `None`: no limit but
    /// [`Settings::HARD_DEPTH`].
    pub depth: Option<u32>,
    /// Seed of every random number.
    pub seed: u64,
    /// How light is gathered.
    pub integrator: Integrator,
    /// Where samples lie.
    pub sampler: SamplerKind,
    /// How samples become pixels.
    pub filter: Filter,
    /// How paths end before `depth`.
    pub roulette: Roulette,
    /// How a path chooses the light that it looks for.
    pub light_choice: LightChoice,
    /// Whether diffuse surfaces look for the light of lamps by way of mirrors and glass where that is
    /// known in closed form.
    pub caustics: bool,
    /// Stops, [`Settings::EXPOSURES`]: radiance is multiplied by 2 to this power when it becomes a
    /// picture of 8 or 16 bits.
    pub exposure: f64,
    /// From radiance to a displayable value, before the sRGB curve.
    pub tone: Tone,
}

/// How light is gathered.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Integrator {
    /// Path tracing with next-event estimation and multiple importance sampling.
    Path,
    /// Direct light with stratified shadow samples, mirror and glass bounces: the paper's.
    Whitted {
        /// Shadow samples per light and hit, [`Settings::SAMPLES`].
        shadow_samples: u32,
    },
    /// Ambient occlusion: the cosine-weighted share of directions that see the sky.
    Ao {
        /// What is farther does not occlude; more than 0, `f64::INFINITY` for no limit.
        distance: f64,
    },
}

/// Where samples lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SamplerKind {
    /// Owen-scrambled Sobol points.
    Sobol,
    /// One jittered sample in each of `spp` strata, shuffled between dimensions: the paper's.
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
    /// From the fourth scattering on, a path whose largest throughput is little goes on with a
    /// probability in proportion to it: less than a quarter under a sky, than a half without.
    Throughput,
    /// Every bounce survives with this probability, more than 0, at most 1: the paper's.
    Fixed(f64),
}

/// How a path chooses the light that it looks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum LightChoice {
    /// By what each would give where it is looked for, if nothing stood between.
    #[default]
    Tree,
    /// By power, the same everywhere.
    Power,
    /// All alike.
    Uniform,
}

/// From linear radiance to display-linear 0..=1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Tone {
    /// Clip at 1.
    Linear,
    /// A filmic curve that rolls highlights off.
    Filmic,
}

/// A setting outside of its range.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{name}` is {value}, but must be {range}")]
pub struct InvalidSetting {
    /// The setting, by the name that scene files have for it.
    pub name: &'static str,
    /// Its value.
    pub value: String,
    /// The values that it can have.
    pub range: String,
}

impl InvalidSetting {
    /// Accepts a value if it is in its range.
    fn check(
        name: &'static str,
        value: &impl Debug,
        holds: bool,
        range: impl Into<String>,
    ) -> Result<(), Self> {
        let invalid = || Self { name, value: format!("{value:?}"), range: range.into() };
        if holds { Ok(()) } else { Err(invalid()) }
    }

    fn check_range<T: Debug + PartialOrd>(
        name: &'static str,
        value: &T,
        range: &RangeInclusive<T>,
    ) -> Result<(), Self> {
        let text = format!("{:?} to {:?}", range.start(), range.end());
        Self::check(name, value, range.contains(value), text)
    }
}

impl Settings {
    /// Pixels of a picture, each way.
    pub const PIXELS: RangeInclusive<u32> = 1..=65_535;

    /// Samples of a pixel, or of a light: above, sums in single precision would stall.
    pub const SAMPLES: RangeInclusive<u32> = 1..=1 << 24;

    /// Limits of time: up to some thirty years.
    pub const TIMES: RangeInclusive<Duration> =
        Duration::from_millis(1)..=Duration::from_secs(1_000_000_000);

    /// Stops of exposure.
    pub const EXPOSURES: RangeInclusive<f64> = -100.0..=100.0;

    /// Checks that every value is in its range.
    ///
    /// # Errors
    /// The first one that is not.
    pub fn check(&self) -> Result<(), InvalidSetting> {
        // All fields are named, so that none is forgotten that is added later.
        let Self {
            width,
            height,
            spp,
            until_error,
            time,
            depth: _,
            seed: _,
            integrator,
            sampler: SamplerKind::Sobol | SamplerKind::Stratified | SamplerKind::Independent,
            filter: Filter::Box | Filter::Gaussian | Filter::BlackmanHarris,
            roulette,
            light_choice: LightChoice::Tree | LightChoice::Power | LightChoice::Uniform,
            caustics: _,
            exposure,
            tone: Tone::Linear | Tone::Filmic,
        } = self;
        InvalidSetting::check_range("width", width, &Self::PIXELS)?;
        InvalidSetting::check_range("height", height, &Self::PIXELS)?;
        InvalidSetting::check_range("spp", spp, &Self::SAMPLES)?;
        if let Some(error) = until_error {
            let holds = *error > 0.0 && *error <= 1.0;
            let range = "more than 0 and at most 1";
            InvalidSetting::check("until_error", error, holds, range)?;
        }
        if let Some(time) = time {
            InvalidSetting::check_range("time", time, &Self::TIMES)?;
        }
        match integrator {
            Integrator::Path => (),
            Integrator::Whitted { shadow_samples } => {
                InvalidSetting::check_range("shadow_samples", shadow_samples, &Self::SAMPLES)?;
            }
            Integrator::Ao { distance } => {
                let range = "more than 0, or infinite";
                InvalidSetting::check("ao_distance", distance, *distance > 0.0, range)?;
            }
        }
        match roulette {
            Roulette::None | Roulette::Throughput => (),
            Roulette::Fixed(probability) => {
                let holds = *probability > 0.0 && *probability <= 1.0;
                let range = "more than 0 and at most 1";
                InvalidSetting::check("roulette", probability, holds, range)?;
            }
        }
        InvalidSetting::check_range("exposure", exposure, &Self::EXPOSURES)
    }

    /// The most scatterings of a path whose depth is not limited. Paths cut here are counted, and
    /// reported.
    pub const HARD_DEPTH: u32 = 4096;

    /// The most samples of a pixel with a target, where nobody says how many.
    pub const HARD_SAMPLES: u32 = 1 << 16;

    /// Whether a target decides on samples.
    pub fn has_target(&self) -> bool {
        self.until_error.is_some() || self.time.is_some()
    }
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            width: 800,
            height: 600,
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
            ("width", Settings { width: 0, ..usual() }),
            ("height", Settings { height: 65_536, ..usual() }),
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
