//! Values of the options for cameras.

use crate::cli::options::values;
use spherule_render::compose;
use spherule_render::scene::Axis;
use spherule_render::settings::share;
use spherule_render::suggest;

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

/// A magnification.
pub(super) fn zoom(text: &str) -> Result<f64, String> {
    compose::zoom(values::finite(text).unwrap_or(0.0))
}

/// 0 to 0.9.
pub(super) fn margin(text: &str) -> Result<f64, String> {
    let share = share(text).filter(|share| (0.0..=0.9).contains(share));
    share.ok_or_else(|| "give a fraction of the image from 0 to 0.9, as in 0.05 or 5%".to_owned())
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
    fn zooms_are_factors() {
        assert_eq!((zoom("2"), zoom("0.01")), (Ok(2.0), Ok(0.01)));
        for text in ["0", "-1", "1001", "NaN", "200%", ""] {
            assert!(zoom(text).is_err(), "{text}");
        }
    }

    #[test]
    fn margins_are_less_than_the_whole() {
        assert_eq!((margin("0.1"), margin("10%")), (Ok(0.1), Ok(0.1)));
        assert!(margin("-0.1").is_err() && margin("1").is_err() && margin("NaN").is_err());
    }
}
