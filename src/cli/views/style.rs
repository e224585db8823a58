//! Looks by name.

use crate::cli::settings::List;
use serde_json::json;
use spherule::color::srgb;
use spherule::scene::{Preset, Rgb, Scene};

/// What the picture looks like.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Look")]
pub(in crate::cli) struct StyleArgs {
    /// Materials, light and lines of a file of particles by name: chalk, studio, cloudy, glossy,
    /// depthcue or outline
    #[arg(long, value_name = "NAME", value_parser = preset)]
    preset: Option<Preset>,
    /// In the sky's place, which goes on lighting the scene: white, black or #rrggbb, before
    /// --exposure [default: white with --preset, or else the sky]
    #[arg(long, value_name = "COLOR", value_parser = color)]
    background: Option<Background>,
}

/// A color, and how it was typed.
#[derive(Clone, Debug, PartialEq)]
struct Background {
    typed: String,
    color: Rgb,
}

fn preset(name: &str) -> Result<Preset, String> {
    let found = Preset::ALL.into_iter().find(|preset| preset.name() == name);
    let names = || Preset::ALL.map(Preset::name).join(", ");
    found.ok_or_else(|| format!("looks are {}", names()))
}

fn color(text: &str) -> Result<Background, String> {
    let six = |digits: &&str| digits.len() == 6 && digits.bytes().all(|c| c.is_ascii_hexdigit());
    let hex = |digits: &str| u32::from_str_radix(digits, 16).ok();
    let color = match text {
        "white" => Some(Rgb::ONE),
        "black" => Some(Rgb::ZERO),
        _ => text.strip_prefix('#').filter(six).and_then(hex).map(srgb),
    };
    let typed = text.to_owned();
    color
        .map(|color| Background { typed, color })
        .ok_or_else(|| "give white, black, or six digits as in \"#f0f4ff\"".to_owned())
}

impl StyleArgs {
    pub(in crate::cli) fn preset(&self) -> Option<Preset> {
        self.preset
    }

    /// What is seen in the sky's place, linear.
    pub(in crate::cli) fn background(&self) -> Option<Rgb> {
        let typed = self.background.as_ref().map(|background| background.color);
        typed.or(self.preset.map(|_| Rgb::ONE))
    }

    /// Sets what the look says of settings, before others are typed.
    pub(in crate::cli) fn set(&self, scene: &mut Scene) {
        if let Some(preset) = self.preset {
            preset.set(&mut scene.settings);
        }
    }

    /// Lights a scene whose camera has its place.
    pub(in crate::cli) fn light(&self, scene: &mut Scene) {
        if let Some(preset) = self.preset {
            preset.light(scene);
        }
    }

    /// What makes the picture, for its file.
    pub(in crate::cli) fn list(&self) -> List {
        let mut list = List::new();
        if let Some(preset) = self.preset {
            list.insert("preset".to_owned(), json!(preset.name()));
        }
        if let Some(background) = &self.background {
            list.insert("background".to_owned(), json!(background.typed));
        }
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_and_looks_are_read() {
        let read = |text: &str| color(text).map(|background| background.color);
        assert_eq!((read("white"), read("#ffffff")), (Ok(Rgb::ONE), Ok(Rgb::ONE)));
        assert_eq!((read("black"), read("#FF0000")), (Ok(Rgb::ZERO), Ok(Rgb::X)));
        for text in ["", "#", "#fff", "#-fffff", "#+fffff", "ffffff", "red", "#ggffff"] {
            assert!(read(text).is_err(), "{text}");
        }
        for look in Preset::ALL {
            assert_eq!(preset(look.name()), Ok(look));
        }
        assert!(preset("pretty").is_err());
    }
}
