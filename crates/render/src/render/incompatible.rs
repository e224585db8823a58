//! Settings with which a render cannot be resumed.

use super::resumable::strata;
use super::{ResumableRender, Status};
use crate::film::Region;
use crate::settings::{InvalidSetting, Role, SETTINGS, SamplerKind, Settings};
use std::time::Duration;

/// The reason why a render cannot be resumed with other settings.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum IncompatibleSettings {
    /// A setting is out of its range.
    #[error(transparent)]
    Invalid(#[from] InvalidSetting),
    /// A setting on which every sample depends has changed.
    #[error("{name} is {now}, but was {then} when the render began; leave it as it was")]
    Setting {
        /// By the name that scene files use.
        name: &'static str,
        /// At the beginning.
        then: String,
        /// The new value.
        now: String,
    },
    /// A target was added or removed.
    #[error("the render began {} {name}; {}", if *.then { "with" } else { "without" }, if *.then { "do not turn it off" } else { "leave it out" })]
    Target {
        /// By the name that scene files use.
        name: &'static str,
        /// True if the render began with it.
        then: bool,
    },
    /// A target asks for less than before.
    #[error("{name} is {now}, but {then} was asked for before; ask for as much or for more")]
    Less {
        /// By the name that scene files use.
        name: &'static str,
        /// The value so far.
        then: String,
        /// The new value.
        now: String,
    },
    /// The number of samples of a part has changed.
    #[error(
        "spp is {now}, but this is a part of a render of {then}; leave it as it was, or render all \
         parts anew"
    )]
    Part {
        /// Samples per pixel that were asked for.
        then: u32,
        /// The new value.
        now: u32,
    },
    /// The samples so far lie in other strata.
    #[error(
        "spp is {now}, but the samples were stratified for {then}; leave it as it was, or begin \
         anew with the sampler sobol"
    )]
    Strata {
        /// Samples per pixel that were asked for.
        then: u32,
        /// The new value.
        now: u32,
    },
}

/// Checks that a render with the settings `then` can be resumed with the settings `now`.
pub(super) fn check(then: &Settings, now: &Settings) -> Result<(), IncompatibleSettings> {
    let [of_then, of_now] = [then, now].map(|settings| samples(settings).collect::<Vec<_>>());
    if let Some((name, then, now)) = first_difference(&of_then, &of_now) {
        return Err(IncompatibleSettings::Setting { name, then, now });
    }
    same_target("until_error", then.until_error.is_some(), now.until_error.is_some())?;
    same_target("time", then.time.is_some(), now.time.is_some())?;
    no_less(then, now)
}

/// Returns the name of the first setting in which two renders differ that are not parts of one image, and
/// its values.
pub(crate) fn difference(
    a: &ResumableRender,
    b: &ResumableRender,
) -> Option<(&'static str, String, String)> {
    let all = |render: &ResumableRender| {
        of_all_parts(render.settings(), render.region(), render.statistics())
    };
    first_difference(&all(a), &all(b))
}

impl Status {
    /// Returns the name of the first setting in which two parts differ that are not of one image, and its
    /// values.
    pub fn difference(&self, other: &Self) -> Option<(&'static str, String, String)> {
        let all = |status: &Self| of_all_parts(&status.settings, status.region, status.statistics);
        first_difference(&all(self), &all(other))
    }
}

/// Returns the settings that all parts of an image share, by name.
fn of_all_parts(
    settings: &Settings,
    region: Region,
    statistics: bool,
) -> Vec<(&'static str, String)> {
    let rest = with_roles(settings, |role, name| role == Role::Display || name == "spp");
    let render = [
        ("region", format!("{region:?}")),
        ("whether statistics are kept", statistics.to_string()),
    ];
    samples(settings).chain(rest).chain(render).collect()
}

/// Returns the settings on which every sample depends, by name.
fn samples(settings: &Settings) -> impl Iterator<Item = (&'static str, String)> {
    with_roles(settings, |role, _| role == Role::Samples)
}

/// Returns names and values of settings, by their roles and names.
fn with_roles(
    settings: &Settings,
    is_wanted: impl Fn(Role, &str) -> bool,
) -> impl Iterator<Item = (&'static str, String)> {
    let wanted = SETTINGS.iter().filter(move |setting| is_wanted(setting.role, setting.name));
    wanted.map(|setting| (setting.name, setting.get(settings).to_string()))
}

fn first_difference(
    a: &[(&'static str, String)],
    b: &[(&'static str, String)],
) -> Option<(&'static str, String, String)> {
    let (a, b) = a.iter().zip(b).find(|(a, b)| a != b)?;
    Some((a.0, a.1.clone(), b.1.clone()))
}

fn same_target(name: &'static str, then: bool, now: bool) -> Result<(), IncompatibleSettings> {
    if then == now { Ok(()) } else { Err(IncompatibleSettings::Target { name, then }) }
}

fn no_less(then: &Settings, now: &Settings) -> Result<(), IncompatibleSettings> {
    let less =
        |name, then: String, now: String| Err(IncompatibleSettings::Less { name, then, now });
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
    if stratified && strata(then) != strata(now) {
        return Err(IncompatibleSettings::Strata { then: then.spp, now: now.spp });
    }
    Ok(())
}
