//! Microarchitecture levels of x86-64: what the program is compiled for, and what the processor has.
//!
//! The levels are those of the System V ABI ("x86-64 psABI", section "Micro-Architecture Levels"), which
//! compilers know as `-C target-cpu=x86-64-v3`. On other architectures there is one level.

#![forbid(unsafe_code)]

use std::fmt::{self, Display, Formatter};

/// A set of instructions that a program is compiled for, lowest first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// The instructions of every processor of the architecture: on x86-64, SSE2.
    Baseline,
    /// SSE4.2 and POPCNT; processors since about 2009.
    V2,
    /// AVX2 and FMA; processors since about 2013.
    V3,
    /// AVX-512 of Skylake-X; servers since 2017, AMD since Zen 4.
    V4,
}

/// An instruction set that a level adds to the one below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Feature {
    level: Level,
    name: &'static str,
    /// True if this crate is compiled for it.
    compiled: bool,
    /// True if the processor and the operating system have it; true for what the crate is compiled for.
    available: bool,
}

impl Level {
    /// The levels that packages hold programs for, highest first.
    pub const PACKAGED: &[Self] = if cfg!(target_arch = "x86_64") {
        &[Self::V4, Self::V3, Self::V2]
    } else {
        &[Self::Baseline]
    };

    /// The name in `SPHERULE_LEVEL` and in the names of programs.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::V2 => "v2",
            Self::V3 => "v3",
            Self::V4 => "v4",
        }
    }

    /// Returns the packaged level of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::PACKAGED.iter().copied().find(|level| level.name() == name)
    }

    /// Returns the highest level whose instructions the program may use: what it is compiled for.
    pub fn compiled() -> Self {
        highest(|feature| feature.compiled)
    }

    /// Returns the highest level whose instructions the processor has.
    pub fn of_processor() -> Self {
        highest(|feature| feature.available)
    }

    /// Returns the instruction sets of the level that the processor lacks.
    pub fn missing(self) -> Vec<&'static str> {
        let lacks = |feature: &Feature| feature.level <= self && !feature.available;
        features().into_iter().filter(lacks).map(|feature| feature.name).collect()
    }
}

/// The name for compilers, such as `x86-64-v3`.
impl Display for Level {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let architecture = std::env::consts::ARCH.replace('_', "-");
        match self {
            Self::Baseline => f.write_str(&architecture),
            level => write!(f, "{architecture}-{}", level.name()),
        }
    }
}

fn highest(has: impl Fn(&Feature) -> bool) -> Level {
    let features = features();
    let complete =
        |level: &&Level| features.iter().all(|feature| feature.level > **level || has(feature));
    *[Level::V4, Level::V3, Level::V2]
        .iter()
        .filter(|_| !features.is_empty())
        .find(complete)
        .unwrap_or(&Level::Baseline)
}

/// The instruction sets of all levels. Left out are `lahf` and `sahf` of v2, which compilers do not use,
/// and `xsave` of v3, which is part of the test of AVX.
#[cfg(target_arch = "x86_64")]
fn features() -> Vec<Feature> {
    macro_rules! features {
        ($($level:ident { $($name:tt)+ })+) => {
            vec![$($(Feature {
                level: Level::$level,
                name: $name,
                compiled: cfg!(target_feature = $name),
                available: is_x86_feature_detected!($name),
            },)+)+]
        };
    }
    features! {
        V2 { "cmpxchg16b" "popcnt" "sse3" "ssse3" "sse4.1" "sse4.2" }
        V3 { "avx" "avx2" "bmi1" "bmi2" "f16c" "fma" "lzcnt" "movbe" }
        V4 { "avx512f" "avx512bw" "avx512cd" "avx512dq" "avx512vl" }
    }
}

#[cfg(not(target_arch = "x86_64"))]
fn features() -> Vec<Feature> {
    Vec::new()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_packaged_levels_are_read_back() {
        for &level in Level::PACKAGED {
            assert_eq!(Level::from_name(level.name()), Some(level));
        }
        assert_eq!(Level::from_name("v5"), None);
        assert_eq!(Level::from_name(""), None);
    }

    #[test]
    fn processors_have_what_the_program_is_compiled_for() {
        assert!(Level::compiled() <= Level::of_processor());
        assert_eq!(Level::of_processor().missing(), Vec::<&str>::new());
    }

    #[test]
    #[cfg(target_arch = "x86_64")]
    fn a_level_needs_all_of_its_features_and_of_those_below() {
        let without = |name: &'static str| highest(move |feature| feature.name != name);
        assert_eq!(highest(|_| true), Level::V4);
        assert_eq!(without("avx512vl"), Level::V3);
        assert_eq!(without("fma"), Level::V2);
        assert_eq!(without("popcnt"), Level::Baseline);
        assert_eq!(Level::V3.to_string(), "x86-64-v3");
        assert_eq!(Level::Baseline.to_string(), "x86-64");
    }
}
