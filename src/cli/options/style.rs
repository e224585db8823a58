//! Options for presets, backgrounds and what is drawn over images.

use super::lists::{self, List};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use spherule_render::scene::{Background, Preset};
use spherule_render::{color, suggest};

/// Options for presets, backgrounds and what is drawn over images.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Style")]
pub(in crate::cli) struct StyleArgs {
    /// Preset of material, light and outlines for particle files: figure, chalk, studio, cloudy, glossy,
    /// depthcue, outline, ghost or x-ray. Radii, colors and materials of --type override it [default: figure]
    #[arg(long, value_name = "NAME", value_parser = preset)]
    preset: Option<Preset>,
    /// Background: a CSS color such as white or #rrggbb, before --exposure; transparent, for PNG, EXR, TIFF
    /// and WebP, where the ground shows only shadows; or sky. The sky lights the scene in any case [default:
    /// white for particle files, or else the scene's background]
    #[arg(long, value_name = "COLOR", value_parser = background)]
    background: Option<BackgroundArg>,
    /// Depth cue: far particles fade into the background: on or off [default: that of the preset or the scene]
    #[arg(long, value_name = "on|off", value_parser = switch())]
    depth_cue: Option<bool>,
    /// Dark outlines of particles where the depth steps: on or off [default: those of the preset or the scene]
    #[arg(long, value_name = "on|off", value_parser = switch())]
    outline: Option<bool>,
}

/// A background, and its text on the command line.
#[derive(Clone, Debug, PartialEq)]
struct BackgroundArg {
    text: String,
    background: Background,
}

/// Names of a thing that is there, and of one that is not.
const SWITCH: [&str; 2] = ["on", "off"];

fn switch() -> impl TypedValueParser<Value = bool> {
    PossibleValuesParser::new(SWITCH).map(|text| text == SWITCH[0])
}

fn preset(name: &str) -> Result<Preset, String> {
    let found = Preset::ALL.into_iter().find(|preset| preset.name() == name);
    let names = || Preset::ALL.map(Preset::name).into_iter();
    found.ok_or_else(|| suggest::help(name, names(), "presets are"))
}

fn background(text: &str) -> Result<BackgroundArg, String> {
    let background = match text {
        "transparent" => Background::Transparent,
        "sky" => Background::Sky,
        _ => color::parse(text).map(Background::Color).ok_or_else(|| {
            let words = ["transparent", "sky"].into_iter().chain(color::names());
            let near = suggest::question(text, words);
            format!(
                "give a CSS color such as white, six digits as in \"#f0f4ff\", transparent or \
                 sky{near}"
            )
        })?,
    };
    Ok(BackgroundArg { text: text.to_owned(), background })
}

impl StyleArgs {
    /// Returns the preset that is given.
    pub(in crate::cli) fn preset(&self) -> Option<Preset> {
        self.preset
    }

    /// Returns the background that is given.
    pub(in crate::cli) fn background(&self) -> Option<Background> {
        self.background.as_ref().map(|typed| typed.background)
    }

    /// Returns whether far particles fade, if that is given.
    pub(in crate::cli) fn depth_cue(&self) -> Option<bool> {
        self.depth_cue
    }

    /// Returns whether there are outlines, if that is given.
    pub(in crate::cli) fn outline(&self) -> Option<bool> {
        self.outline
    }

    /// Settings for the image's metadata.
    pub(in crate::cli) fn list(&self) -> List {
        let mut list = List::new();
        lists::put(&mut list, "preset", self.preset.map(Preset::name));
        lists::put(&mut list, "background", self.background.as_ref().map(|typed| &*typed.text));
        let name = |on: bool| SWITCH[usize::from(!on)];
        lists::put(&mut list, "depth-cue", self.depth_cue.map(name));
        lists::put(&mut list, "outline", self.outline.map(name));
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_render::scene::Rgb;

    #[test]
    fn colors_and_looks_are_read() {
        let read = |text: &str| background(text).map(|typed| typed.background);
        let color = Background::Color;
        for (text, expected) in [
            ("white", color(Rgb::ONE)),
            ("#ffffff", color(Rgb::ONE)),
            ("black", color(Rgb::ZERO)),
            ("#FF0000", color(Rgb::X)),
            ("Lime", color(Rgb::Y)),
            ("transparent", Background::Transparent),
            ("sky", Background::Sky),
        ] {
            assert_eq!(read(text), Ok(expected));
        }
        for text in ["", "#", "#fff", "#-fffff", "#+fffff", "ffffff", "rde", "#ggffff"] {
            assert!(read(text).is_err(), "{text}");
        }
        for look in Preset::ALL {
            assert_eq!(preset(look.name()), Ok(look));
        }
        assert!(preset("pretty").is_err());
    }
}
