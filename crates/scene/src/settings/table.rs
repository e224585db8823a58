//! The table of render settings: a row for each, from which all else follows.
//!
//! The command line, the reader and the writer of scene files, the table in the manual, the check of
//! ranges, the comparison of checkpoints, reports and the notes on options without effect read these
//! rows.

use super::{
    Denoise, Filter, Integrator, InvalidSetting, LightChoice, Limits, Roulette, SamplerKind,
    Settings, Tone,
    length::{Length, Paper},
};
use std::fmt::{self, Display};
use std::mem::discriminant;
use std::num::NonZeroU16;
use std::ops::RangeInclusive;
use std::time::Duration;

/// A render setting.
pub struct Setting {
    /// The key in scene files. The option has hyphens instead of underscores.
    pub name: &'static str,
    /// One line for the command line's help and for the manual, without a period.
    pub help: &'static str,
    /// Type and range.
    pub kind: Kind,
    /// The integrators that use it.
    pub scope: Scope,
    /// The scene content without which the setting has no effect.
    pub need: Need,
    /// The part of a render that depends on it.
    pub role: Role,
    get: fn(&Settings) -> Value,
    set: fn(&mut Settings, Value),
}

/// The type of a setting, and the range of its values.
#[derive(Clone, Copy)]
pub enum Kind {
    /// Width and height in pixels, [`Settings::PIXELS`] each, or as lengths on paper.
    Size,
    /// An integer in a range, or one of some words.
    Whole {
        /// Least and greatest value.
        range: [u64; 2],
        /// Words that are values, too.
        words: &'static [&'static str],
    },
    /// A number, or one of some words.
    Number {
        /// Values.
        limits: Limits,
        /// Placeholder in the command line's help.
        placeholder: &'static str,
        /// Words that are values, too.
        words: &'static [&'static str],
    },
    /// A relative error, or none: the command line takes it in percent.
    Error,
    /// Seconds, [`Settings::TIMES`], or none: the command line takes them with a unit.
    Time,
    /// One of some words: their names and help.
    Choice(fn() -> Vec<(&'static str, &'static str)>),
    /// True or false; true by default. The command line has the option `--no-NAME`.
    Flag,
}

/// The integrators that use a setting.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// All.
    All,
    /// Only these; the others ignore it.
    Only(&'static [&'static str]),
    /// A parameter of these: scene files with another integrator may not have it.
    ParameterOf(&'static [&'static str]),
}

/// Scene content without which a setting has no effect.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Nothing.
    Nothing,
    /// An integrator that traces paths of several bounces.
    Bounces,
    /// A light that can be sampled.
    Light,
    /// Two lights or more.
    Lights,
    /// Caustics that are sampled.
    Caustics,
}

/// The part of a render that depends on a setting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Every sample: a render cannot be resumed with another value.
    Samples,
    /// When the render stops.
    Stop,
    /// The conversion to an image of 8 or 16 bits.
    Display,
}

/// A value of a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// No value: no limit, or no such parameter of the integrator.
    None,
    /// True or false.
    Flag(bool),
    /// An integer.
    Whole(u64),
    /// A number; infinite for no limit.
    Number(f64),
    /// A word.
    Word(&'static str),
    /// Width and height in pixels.
    Size([u32; 2]),
    /// Width and height on paper.
    Paper {
        /// Width.
        width: Length,
        /// Height; `None` keeps the aspect.
        height: Option<Length>,
    },
}

/// Values of an enum with their names and help, in the order in which they are listed. Names without help
/// are former ones, and are not listed. Of a value with parameters only the variant counts.
pub struct Names<T: 'static>(pub &'static [(&'static str, T, &'static str)]);

impl<T: Clone> Names<T> {
    /// Returns the name of a value.
    pub fn name(&self, value: &T) -> &'static str {
        let row = self.0.iter().find(|row| discriminant(&row.1) == discriminant(value));
        row.map_or("", |row| row.0)
    }

    /// Returns the value with a name.
    pub fn find(&self, name: &str) -> Option<T> {
        self.0.iter().find(|row| row.0 == name).map(|row| row.1.clone())
    }

    /// Returns names and help.
    pub fn list(&self) -> Vec<(&'static str, &'static str)> {
        self.0.iter().map(|&(name, _, help)| (name, help)).collect()
    }
}

/// Integrators, with their default parameters.
pub const INTEGRATORS: Names<Integrator> = Names(&[
    ("path", Integrator::Path, "Path tracing with direct light sampling: full global illumination"),
    (
        "whitted",
        Integrator::Whitted { shadow_samples: 16 },
        "Whitted ray tracing: direct light, mirrors and glass only",
    ),
    (
        "ao",
        Integrator::Ao { distance: f64::INFINITY },
        "Ambient occlusion: shows shape, ignores lights and materials",
    ),
]);

/// Samplers.
pub const SAMPLERS: Names<SamplerKind> = Names(&[
    ("sobol", SamplerKind::Sobol, "Owen-scrambled Sobol points: least noise"),
    ("stratified", SamplerKind::Stratified, "Jittered strata"),
    ("independent", SamplerKind::Independent, "Independent random numbers"),
]);

/// Strategies that select the light of a direct lighting sample.
const LIGHT_CHOICES: Names<LightChoice> = Names(&[
    (
        "tree",
        LightChoice::Tree,
        "Light tree: by the estimated contribution at the shading point; least noise",
    ),
    ("power", LightChoice::Power, "By power, the same everywhere"),
    ("uniform", LightChoice::Uniform, "All lights with equal probability"),
]);

/// Pixel filters.
const FILTERS: Names<Filter> = Names(&[
    ("box", Filter::Box, "The square of the pixel"),
    ("gaussian", Filter::Gaussian, "Gaussian with a standard deviation of half a pixel"),
    ("blackman-harris", Filter::BlackmanHarris, "Blackman-Harris window, 4 pixels wide"),
]);

/// Tone curves.
pub const TONES: Names<Tone> = Names(&[
    ("linear", Tone::Linear, "Clip at 1"),
    ("filmic", Tone::Filmic, "Filmic curve that compresses highlights"),
]);

/// Kinds of denoising.
const DENOISE: Names<Denoise> = Names(&[
    (
        "auto",
        Denoise::Auto,
        "Unless --spp or an error target is given, or the measured error rises by it",
    ),
    ("on", Denoise::On, "Always; an error target is then that of the denoised image"),
    ("off", Denoise::Off, "Never"),
]);

/// Samples per pixel, or per light.
const SAMPLES: Kind =
    whole(*Settings::SAMPLES.start() as u64, *Settings::SAMPLES.end() as u64, &[]);

const fn whole(least: u64, greatest: u64, words: &'static [&'static str]) -> Kind {
    Kind::Whole { range: [least, greatest], words }
}

/// All settings, in the order in which they are listed and applied.
pub const SETTINGS: &[Setting] = &[
    Setting {
        name: "size",
        help: "Width and height in pixels, each 1 to 65535; or on paper, in mm, cm, in or pt: 85mmx60mm, or \
               85mm, which keeps the aspect",
        kind: Kind::Size,
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Samples,
        get: |settings| Value::Size([settings.width, settings.height]),
        set: |settings, value| match value {
            Value::Paper { width, height } => {
                settings.set_paper(Paper::new(width, height, [settings.width, settings.height]));
            }
            pixels => {
                [settings.width, settings.height] = pixels.size();
                settings.paper = None;
            }
        },
    },
    Setting {
        name: "spp",
        help: "Samples per pixel; the maximum if an error or a time stops the render",
        kind: SAMPLES,
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Stop,
        get: |settings| Value::Whole(settings.spp.into()),
        set: |settings, value| settings.spp = value.whole() as u32,
    },
    Setting {
        name: "until_error",
        help: "Stop when the relative error of the image, its root mean square error divided by its mean \
               radiance, is below this with 95 % confidence",
        kind: Kind::Error,
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Stop,
        get: |settings| settings.until_error.map_or(Value::None, Value::Number),
        set: |settings, value| settings.until_error = value.optional_number(),
    },
    Setting {
        name: "time",
        help: "Stop after this time",
        kind: Kind::Time,
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Stop,
        get: |settings| settings.time.map_or(Value::None, |time| Value::Number(time.as_secs_f64())),
        set: |settings, value| {
            settings.time = value.optional_number().map(Duration::from_secs_f64);
        },
    },
    Setting {
        name: "denoise",
        help: "Denoise the finished image",
        kind: Kind::Choice(|| DENOISE.list()),
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Stop,
        get: |settings| Value::Word(DENOISE.name(&settings.denoise)),
        set: |settings, value| settings.denoise = value.named(&DENOISE),
    },
    Setting {
        name: "depth",
        help: "Maximum number of bounces of a path: 0 sees only emitted light; unlimited stops, and reports \
               it, at 4096",
        kind: whole(0, u32::MAX as u64, &["unlimited"]),
        scope: Scope::All,
        need: Need::Bounces,
        role: Role::Samples,
        get: |settings| {
            settings.depth.map_or(Value::Word("unlimited"), |depth| Value::Whole(depth.into()))
        },
        set: |settings, value| {
            settings.depth = match value {
                Value::Word(_) => None,
                depth => Some(depth.whole() as u32),
            };
        },
    },
    Setting {
        name: "seed",
        help: "Seed of the random numbers",
        kind: whole(0, u64::MAX, &[]),
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Samples,
        get: |settings| Value::Whole(settings.seed),
        set: |settings, value| settings.seed = value.whole(),
    },
    Setting {
        name: "integrator",
        help: "Rendering algorithm",
        kind: Kind::Choice(|| INTEGRATORS.list()),
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Samples,
        get: |settings| Value::Word(INTEGRATORS.name(&settings.integrator)),
        // The same integrator keeps its parameters.
        set: |settings, value| {
            if INTEGRATORS.name(&settings.integrator) != value.word() {
                settings.integrator = value.named(&INTEGRATORS);
            }
        },
    },
    Setting {
        name: "light_choice",
        help: "Light selection for direct lighting, for the integrator path",
        kind: Kind::Choice(|| LIGHT_CHOICES.list()),
        scope: Scope::Only(&["path"]),
        need: Need::Lights,
        role: Role::Samples,
        get: |settings| Value::Word(LIGHT_CHOICES.name(&settings.light_choice)),
        set: |settings, value| settings.light_choice = value.named(&LIGHT_CHOICES),
    },
    Setting {
        name: "shadow_samples",
        help: "Shadow rays to each light at each hit, for the integrator whitted",
        kind: SAMPLES,
        scope: Scope::ParameterOf(&["whitted"]),
        need: Need::Light,
        role: Role::Samples,
        get: |settings| match settings.integrator {
            Integrator::Whitted { shadow_samples } => Value::Whole(shadow_samples.into()),
            _ => Value::None,
        },
        set: |settings, value| {
            if let Integrator::Whitted { shadow_samples } = &mut settings.integrator {
                *shadow_samples = value.whole() as u32;
            }
        },
    },
    Setting {
        name: "ao_distance",
        help: "Maximum distance of occluders in the scene's unit, for the integrator ao; with 0, \
               surfaces show their color alone",
        kind: Kind::Number {
            limits: Limits::NotNegative,
            placeholder: "DISTANCE",
            words: &["inf"],
        },
        scope: Scope::ParameterOf(&["ao"]),
        need: Need::Nothing,
        role: Role::Samples,
        get: |settings| match settings.integrator {
            Integrator::Ao { distance } if distance == f64::INFINITY => Value::Word("inf"),
            Integrator::Ao { distance } => Value::Number(distance),
            _ => Value::None,
        },
        set: |settings, value| {
            if let Integrator::Ao { distance } = &mut settings.integrator {
                *distance = value.optional_number().unwrap_or(f64::INFINITY);
            }
        },
    },
    Setting {
        name: "caustics",
        help: "Sample lights through mirrors and glass, for the integrator path: without this, \
               caustics come only from paths that hit a light by chance",
        kind: Kind::Flag,
        scope: Scope::All,
        need: Need::Caustics,
        role: Role::Samples,
        get: |settings| Value::Flag(settings.caustics),
        set: |settings, value| settings.caustics = value == Value::Flag(true),
    },
    Setting {
        name: "sampler",
        help: "Generator of sample points",
        kind: Kind::Choice(|| SAMPLERS.list()),
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Samples,
        get: |settings| Value::Word(SAMPLERS.name(&settings.sampler)),
        set: |settings, value| settings.sampler = value.named(&SAMPLERS),
    },
    Setting {
        name: "filter",
        help: "Pixel filter",
        kind: Kind::Choice(|| FILTERS.list()),
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Samples,
        get: |settings| Value::Word(FILTERS.name(&settings.filter)),
        set: |settings, value| settings.filter = value.named(&FILTERS),
    },
    Setting {
        name: "roulette",
        help: "Russian roulette: none, by throughput from the fourth bounce on, or the probability of a path \
               to survive each bounce",
        kind: Kind::Number {
            limits: Limits::AboveTo(0.0, 1.0),
            placeholder: "none|throughput|P",
            words: &["none", "throughput"],
        },
        scope: Scope::All,
        need: Need::Bounces,
        role: Role::Samples,
        get: |settings| match settings.roulette {
            Roulette::None => Value::Word("none"),
            Roulette::Throughput => Value::Word("throughput"),
            Roulette::Fixed(probability) => Value::Number(probability),
        },
        set: |settings, value| {
            settings.roulette = match value {
                Value::Word("none") => Roulette::None,
                Value::Word(_) => Roulette::Throughput,
                probability => Roulette::Fixed(probability.number()),
            };
        },
    },
    Setting {
        name: "dpi",
        help: "Pixels per inch on paper, which PNG, TIFF, JPEG, EXR, SVG and PDF files store; by default 300 if \
               the size or letters are lengths on paper",
        kind: whole(1, u16::MAX as u64, &[]),
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Display,
        get: |settings| settings.dpi.map_or(Value::None, |dpi| Value::Whole(dpi.get().into())),
        set: |settings, value| {
            let dpi = match value {
                Value::None => None,
                dpi => u16::try_from(dpi.whole()).ok().and_then(NonZeroU16::new),
            };
            settings.set_resolution(dpi);
        },
    },
    Setting {
        name: "exposure",
        help: "Exposure in stops: multiplies the radiance by 2 to this power, for all formats but EXR and PFM",
        kind: Kind::Number {
            limits: Limits::Within(*Settings::EXPOSURES.start(), *Settings::EXPOSURES.end()),
            placeholder: "STOPS",
            words: &[],
        },
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Display,
        get: |settings| Value::Number(settings.exposure),
        set: |settings, value| settings.exposure = value.number(),
    },
    Setting {
        name: "tone",
        help: "Tone curve, for all formats but EXR and PFM",
        kind: Kind::Choice(|| TONES.list()),
        scope: Scope::All,
        need: Need::Nothing,
        role: Role::Display,
        get: |settings| Value::Word(TONES.name(&settings.tone)),
        set: |settings, value| settings.tone = value.named(&TONES),
    },
];

impl Setting {
    /// Returns the setting with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        SETTINGS.iter().find(|setting| setting.name == name)
    }

    /// Returns the value in these settings.
    pub fn get(&self, settings: &Settings) -> Value {
        (self.get)(settings)
    }

    /// Sets the value. A parameter of another integrator is ignored.
    ///
    /// # Panics
    /// The value is not of the setting's kind.
    pub fn set(&self, settings: &mut Settings, value: Value) {
        (self.set)(settings, value);
    }

    /// Checks that the value in these settings is in range.
    ///
    /// # Errors
    /// It is not.
    pub(super) fn check(&self, settings: &Settings) -> Result<(), InvalidSetting> {
        let value = self.get(settings);
        if self.kind.contains(value) {
            return Ok(());
        }
        let (value, range) = (value.to_string(), self.kind.describe());
        Err(InvalidSetting { name: self.name, value, range })
    }
}

impl Kind {
    /// Returns whether the value is in range.
    pub fn contains(&self, value: Value) -> bool {
        match (*self, value) {
            // The pixels of a size on paper depend on the resolution.
            (_, Value::None)
            | (Self::Choice(_), Value::Word(_))
            | (Self::Flag, Value::Flag(_))
            | (Self::Size, Value::Paper { .. }) => true,
            (Self::Whole { words, .. } | Self::Number { words, .. }, Value::Word(word)) => {
                words.contains(&word)
            }
            (Self::Size, Value::Size(size)) => {
                size.iter().all(|pixels| Settings::PIXELS.contains(pixels))
            }
            (Self::Whole { range: [least, greatest], .. }, Value::Whole(number)) => {
                (least..=greatest).contains(&number)
            }
            (Self::Number { limits, .. }, Value::Number(number)) => limits.contain(number),
            (Self::Error, Value::Number(error)) => error > 0.0 && error <= 1.0,
            (Self::Time, Value::Number(seconds)) => seconds_range().contains(&seconds),
            _ => false,
        }
    }

    /// Returns the range in words, to follow "must be", for scene files.
    pub fn describe(&self) -> String {
        let or = |words: &[&str]| {
            words.iter().fold(String::new(), |list, word| list + ", or \"" + word + "\"")
        };
        match *self {
            Self::Size => {
                format!(
                    "[width, height], each {} to {}, or lengths such as \"85mm\" or \"85mmx60mm\"",
                    Settings::PIXELS.start(),
                    Settings::PIXELS.end()
                )
            }
            Self::Whole { range: [least, greatest], words } => {
                let words = or(words);
                format!("an integer from {least} to {greatest}{words}")
            }
            Self::Number { limits, words, .. } => {
                let words = or(words);
                format!("{}{words}", limits.describe())
            }
            Self::Error => Limits::AboveTo(0.0, 1.0).describe(),
            Self::Time => {
                let range = seconds_range();
                format!("{} seconds", Limits::Within(*range.start(), *range.end()).describe())
            }
            Self::Choice(list) => {
                let names: Vec<_> = list().iter().map(|(name, _)| format!("\"{name}\"")).collect();
                names.join(", ")
            }
            Self::Flag => "true or false".to_owned(),
        }
    }
}

/// Seconds of [`Settings::TIMES`].
fn seconds_range() -> RangeInclusive<f64> {
    Settings::TIMES.start().as_secs_f64()..=Settings::TIMES.end().as_secs_f64()
}

impl Value {
    fn size(self) -> [u32; 2] {
        match self {
            Self::Size(size) => size,
            _ => unreachable!("{self:?} is no size"),
        }
    }

    fn whole(self) -> u64 {
        match self {
            Self::Whole(number) => number,
            _ => unreachable!("{self:?} is no integer"),
        }
    }

    fn number(self) -> f64 {
        self.optional_number().unwrap_or_else(|| unreachable!("{self:?} is no number"))
    }

    /// Returns the number, if there is one.
    fn optional_number(self) -> Option<f64> {
        match self {
            Self::Number(number) => Some(number),
            _ => None,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Word(word) => word,
            _ => unreachable!("{self:?} is no word"),
        }
    }

    fn named<T: Clone>(self, names: &Names<T>) -> T {
        names.find(self.word()).unwrap_or_else(|| unreachable!("{self:?} is none of the names"))
    }
}

/// As scene files have it, but for quotes.
impl Display for Value {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::None => write!(f, "none"),
            Self::Flag(flag) => write!(f, "{flag}"),
            Self::Whole(number) => write!(f, "{number}"),
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Word(word) => write!(f, "{word}"),
            Self::Size([width, height]) => write!(f, "[{width}, {height}]"),
            Self::Paper { width, height: None } => write!(f, "{width}"),
            Self::Paper { width, height: Some(height) } => write!(f, "{width}x{height}"),
        }
    }
}

/// Returns the table of settings of the manual, in Markdown.
pub fn manual() -> String {
    let mut rows = vec!["| key | meaning | values | default |\n|---|---|---|---|\n".to_owned()];
    for setting in SETTINGS {
        let Setting { name, help, kind, .. } = setting;
        let mut meaning = (*help).to_owned();
        if let Kind::Choice(list) = kind {
            let choice = |(name, help): &(&str, &str)| format!("`\"{name}\"`: {help}");
            let choices: Vec<_> = list().iter().map(choice).collect();
            meaning = format!("{meaning}:<br>{}", choices.join("<br>"));
        }
        let values = match kind {
            Kind::Choice(list) => {
                let names: Vec<_> =
                    list().iter().map(|(name, _)| format!("`\"{name}\"`")).collect();
                names.join(", ")
            }
            _ => kind.describe(),
        };
        let mut all_parameters = Settings::default();
        if let Scope::ParameterOf(&[integrator, ..]) = setting.scope {
            all_parameters.integrator = Value::Word(integrator).named(&INTEGRATORS);
        }
        let default = match setting.get(&all_parameters) {
            Value::None => "none".to_owned(),
            Value::Word(word) => format!("`\"{word}\"`"),
            Value::Whole(16) if *name == "spp" => {
                format!(
                    "{} if an error or a time stops the render; if neither is given, [the error of the denoised \
                     image](../docs/long-renders.md#when-nothing-is-said), or 16 without denoising",
                    Settings::HARD_SAMPLES
                )
            }
            value => format!("`{value}`"),
        };
        rows.push(format!("| `{name}` | {meaning} | {values} | {default} |\n"));
    }
    rows.concat()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Returns a value of each kind that is no default.
    fn other_value(setting: &Setting) -> Value {
        match setting.kind {
            Kind::Size => Value::Size([17, 19]),
            Kind::Whole { .. } => Value::Whole(7),
            Kind::Number { .. } | Kind::Error => Value::Number(0.75),
            Kind::Time => Value::Number(1.5),
            Kind::Choice(list) => Value::Word(list()[1].0),
            Kind::Flag => Value::Flag(false),
        }
    }

    /// Returns default settings with the integrator whose parameter a setting is.
    fn defaults_for(setting: &Setting) -> Settings {
        let mut settings = Settings::default();
        if let Scope::ParameterOf(&[integrator, ..]) = setting.scope {
            settings.integrator = INTEGRATORS.find(integrator).unwrap();
        }
        settings
    }

    #[test]
    fn every_row_reads_back_what_it_sets() {
        let names: HashSet<_> = SETTINGS.iter().map(|setting| setting.name).collect();
        assert_eq!(names.len(), SETTINGS.len());
        for setting in SETTINGS {
            let mut settings = defaults_for(setting);
            let (default, other) = (setting.get(&settings), other_value(setting));
            assert!(default != other && setting.kind.contains(default), "{}", setting.name);
            setting.set(&mut settings, other);
            assert_eq!(setting.get(&settings), other, "{}", setting.name);
            assert_eq!(settings.check(), Ok(()), "{}", setting.name);
            setting.set(&mut settings, default);
            assert_eq!(settings, defaults_for(setting), "{}", setting.name);
        }
    }

    #[test]
    fn every_field_has_a_row() {
        let mut all = Settings::default();
        for setting in SETTINGS {
            setting.set(&mut all, other_value(setting));
        }
        let usual = Settings::default();
        // All fields are named, so that none is forgotten that is added later.
        let Settings {
            width,
            height,
            dpi,
            // Follows from the size.
            paper: _,
            spp,
            until_error,
            time,
            depth,
            seed,
            integrator,
            sampler,
            filter,
            roulette,
            light_choice,
            caustics,
            exposure,
            tone,
            denoise,
            // Follows from others.
            stop_given: _,
        } = all;
        assert!((width, height) == (17, 19) && spp != usual.spp && seed != usual.seed);
        assert!(until_error.is_some() && time.is_some() && depth.is_some());
        assert!(integrator != usual.integrator && sampler != usual.sampler);
        assert!(filter != usual.filter && roulette != usual.roulette && tone != usual.tone);
        assert!(light_choice != usual.light_choice && caustics != usual.caustics);
        assert!(exposure != usual.exposure && denoise != usual.denoise && dpi != usual.dpi);
    }

    #[test]
    fn parameters_of_other_integrators_are_ignored() {
        for setting in SETTINGS.iter().filter(|row| matches!(row.scope, Scope::ParameterOf(_))) {
            let mut settings = Settings::default();
            setting.set(&mut settings, other_value(setting));
            assert_eq!(settings, Settings::default(), "{}", setting.name);
            assert_eq!(setting.get(&settings), Value::None, "{}", setting.name);
        }
    }

    #[test]
    fn scopes_name_integrators() {
        for setting in SETTINGS {
            if let Scope::Only(names) | Scope::ParameterOf(names) = setting.scope {
                let known = names.iter().all(|name| INTEGRATORS.find(name).is_some());
                assert!(known && !names.is_empty(), "{}", setting.name);
            }
        }
    }

    #[test]
    fn the_manual_has_the_table() {
        let manual = include_str!("../../../../scenes/README.md");
        let table = super::manual();
        assert!(manual.contains(&table), "the table in scenes/README.md must be:\n\n{table}");
    }
}
