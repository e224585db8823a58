//! Whether a render can go on by other settings.

use super::{Status, Unfinished, target};
use crate::film::Region;
use crate::scene::{InvalidSetting, SamplerKind, Settings};
use std::fmt::Debug;
use std::time::Duration;

/// Why a render cannot go on by other settings.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unlike {
    /// A setting is out of its range.
    #[error(transparent)]
    Invalid(#[from] InvalidSetting),
    /// What every sample depends on.
    #[error("{name} is {now}, but was {then} when the render began; leave it as it was")]
    Setting {
        /// By the name that scene files use.
        name: &'static str,
        /// At the beginning.
        then: String,
        /// What it would be.
        now: String,
    },
    /// A target can neither come nor go.
    #[error("the render began {} {name}, and goes on so; {}", if *.then { "with" } else { "without" }, if *.then { "give it again, or leave it as it was" } else { "leave it out" })]
    Target {
        /// By the name that scene files use.
        name: &'static str,
        /// Whether there was one.
        then: bool,
    },
    /// What is there is not taken back.
    #[error("{name} is {now}, but {then} was asked for before; ask for as much or for more")]
    Less {
        /// By the name that scene files use.
        name: &'static str,
        /// What was asked for.
        then: String,
        /// What would be.
        now: String,
    },
    /// A share of a render is a share of so many samples.
    #[error(
        "spp is {now}, but this is a part of a render of {then}; leave it as it was, or render all \
         parts anew"
    )]
    Share {
        /// Samples per pixel that were asked for.
        then: u32,
        /// What would be.
        now: u32,
    },
    /// The samples that there are lie in other strata.
    #[error(
        "spp is {now}, but the samples were stratified for {then}; leave it as it was, or begin \
         anew with the sampler sobol"
    )]
    Strata {
        /// Samples per pixel that were asked for.
        then: u32,
        /// What would be.
        now: u32,
    },
}

/// Finds out whether a render that was to reach `then` can go on to `now`.
pub(super) fn check(then: &Settings, now: &Settings) -> Result<(), Unlike> {
    if let Some((name, then, now)) = first_difference(&samples(then), &samples(now)) {
        return Err(Unlike::Setting { name, then, now });
    }
    same_target("until_error", then.until_error.is_some(), now.until_error.is_some())?;
    same_target("time", then.time.is_some(), now.time.is_some())?;
    no_less(then, now)
}

/// In what two renders differ, if their shares do not belong together: by which name, and what it is in
/// both.
pub(crate) fn difference(a: &Unfinished, b: &Unfinished) -> Option<(&'static str, String, String)> {
    let all =
        |render: &Unfinished| of_all_parts(render.settings(), render.region(), render.statistics());
    first_difference(&all(a), &all(b))
}

impl Status {
    /// The first setting, by name, in which two renders differ whose parts are not of one picture, and its
    /// values.
    pub fn difference(&self, other: &Self) -> Option<(&'static str, String, String)> {
        let all = |status: &Self| of_all_parts(&status.settings, status.region, status.statistics);
        first_difference(&all(self), &all(other))
    }
}

/// Settings that all parts of a picture share, by name.
fn of_all_parts(
    settings: &Settings,
    region: Region,
    statistics: bool,
) -> Vec<(&'static str, String)> {
    let rest: [(&'static str, &dyn Debug); 5] = [
        ("spp", &settings.spp),
        ("exposure", &settings.exposure),
        ("tone", &settings.tone),
        ("region", &region),
        ("whether statistics are kept", &statistics),
    ];
    let rest = rest.map(|(name, value)| (name, format!("{value:?}")));
    samples(settings).into_iter().chain(rest).collect()
}

/// What every sample depends on, by name.
fn samples(settings: &Settings) -> Vec<(&'static str, String)> {
    let all: [(&'static str, &dyn Debug); 10] = [
        ("width", &settings.width),
        ("height", &settings.height),
        ("depth", &settings.depth),
        ("seed", &settings.seed),
        ("integrator", &settings.integrator),
        ("sampler", &settings.sampler),
        ("filter", &settings.filter),
        ("roulette", &settings.roulette),
        ("light_choice", &settings.light_choice),
        ("caustics", &settings.caustics),
    ];
    all.map(|(name, value)| (name, format!("{value:?}"))).into()
}

fn first_difference(
    a: &[(&'static str, String)],
    b: &[(&'static str, String)],
) -> Option<(&'static str, String, String)> {
    let (a, b) = a.iter().zip(b).find(|(a, b)| a != b)?;
    Some((a.0, a.1.clone(), b.1.clone()))
}

fn same_target(name: &'static str, then: bool, now: bool) -> Result<(), Unlike> {
    if then == now { Ok(()) } else { Err(Unlike::Target { name, then }) }
}

fn no_less(then: &Settings, now: &Settings) -> Result<(), Unlike> {
    let less = |name, then: String, now: String| Err(Unlike::Less { name, then, now });
    if now.spp < then.spp {
        return less("spp", then.spp.to_string(), now.spp.to_string());
    }
    if let (Some(then), Some(now)) = (then.until_error, now.until_error)
        && now > then
    {
        return less("until_error", then.to_string(), now.to_string());
    }
    let seconds = |time: Duration| format!("{} s", time.as_secs_f64());
    if let (Some(then), Some(now)) = (then.time, now.time)
        && now < then
    {
        return less("time", seconds(then), seconds(now));
    }
    let stratified = now.sampler == SamplerKind::Stratified;
    if stratified && target::strata(then) != target::strata(now) {
        return Err(Unlike::Strata { then: then.spp, now: now.spp });
    }
    Ok(())
}
