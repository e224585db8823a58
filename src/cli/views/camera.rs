//! Cameras: what is up, views from a side, projections and turntables.

use super::ViewArgs;
use spherule_render::compose::CameraRequest;
use spherule_render::scene::Axis;
use spherule_render::scene::particles::{Orientation, UpReason};
use spherule_render::suggest;
use spherule_render::world::framing::view::View;
use std::f64::consts::TAU;

/// The direction that is up, or `auto`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct UpArg(pub(super) Option<Axis>);

impl UpArg {
    pub(super) fn name(self) -> &'static str {
        self.0.map_or("auto", Axis::name)
    }
}

/// Names of the coordinate axes.
fn axes() -> impl Iterator<Item = &'static str> + Clone {
    Axis::ALL.iter().map(|(name, _)| *name)
}

/// Parses `auto` or the name of an axis.
pub(super) fn up(text: &str) -> Result<UpArg, String> {
    let axis = Axis::named(text).map(Some);
    let up = if text == "auto" { Some(None) } else { axis };
    up.map(UpArg).ok_or_else(|| suggest::help(text, axes().chain(["auto"]), "directions are"))
}

/// 0 to 0.9.
pub(super) fn margin(text: &str) -> Result<f64, String> {
    let share = text.parse().ok().filter(|share| (0.0..=0.9).contains(share));
    share.ok_or_else(|| "give a fraction of the image from 0 to 0.9, as in 0.05".to_owned())
}

impl ViewArgs {
    /// Returns the direction that is up, if one is chosen.
    pub(in crate::cli) fn up(&self) -> Option<Axis> {
        self.up.and_then(|up| up.0)
    }

    /// Returns the view that is asked for.
    pub(in crate::cli) fn camera(&self) -> CameraRequest {
        let Self { view, projection, margin, turntable, .. } = *self;
        CameraRequest { view, projection, margin, turns: turntable.is_some() }
    }

    /// Returns a sentence on what is up and why; `None` if the view does not depend on it.
    pub(in crate::cli) fn explain_up(&self, orientation: &Orientation) -> Option<String> {
        let reason = orientation.reason;
        let up = match self.view {
            Some(View::Auto) if !reason.is_evident() => return None,
            Some(View::Iso | View::Side(_)) => orientation.up_of_sides(),
            Some(View::Auto) | None => orientation.up,
        };
        let chosen = reason == UpReason::Chosen;
        (!chosen).then(|| format!("{} is up: {reason}; --up chooses another direction", up.name()))
    }

    /// Angle of an image of the turntable, in radians.
    pub(in crate::cli) fn angle(&self, turn: u32) -> f64 {
        TAU * f64::from(turn) / f64::from(self.turntable.unwrap_or(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_read_and_named() {
        for name in ["auto", "x", "-x", "y", "-y", "z", "-z"] {
            assert_eq!(up(name).map(UpArg::name), Ok(name));
        }
        assert!(up("iso").is_err() && up("").is_err() && up("+z").is_err());
    }

    #[test]
    fn margins_are_less_than_the_whole() {
        assert_eq!(margin("0.1"), Ok(0.1));
        assert!(margin("-0.1").is_err() && margin("1").is_err() && margin("NaN").is_err());
    }
}
