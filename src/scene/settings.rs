//! How the picture is made.

use serde::{Deserialize, Serialize};
use std::time::Duration;

/// How the picture is made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// Pixels, 1..=65535 each way.
    pub width: u32,
    /// Pixels, 1..=65535 each way.
    pub height: u32,
    /// Samples per pixel, 1 or more; with a target, `until_error` or `time`, the most.
    pub spp: u32,
    /// Ends the render when the picture's error is below this, more than 0: the root of the mean
    /// squared error of linear radiance, by the mean radiance.
    pub until_error: Option<f64>,
    /// Ends the render when this time is over.
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
    /// Stops: radiance is multiplied by 2 to this power when it becomes a picture of 8 or 16 bits.
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
        /// Shadow samples per light and hit, 1 or more.
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

impl Settings {
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
