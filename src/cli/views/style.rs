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
    /// --exposure; or transparent, for PNG and EXR, where of the ground only shadows are left
    /// [default: white with --preset, or else the sky]
    #[arg(long, value_name = "COLOR", value_parser = color)]
    background: Option<Background>,
}

/// A color, or none, and how it was typed.
#[derive(Clone, Debug, PartialEq)]
struct Background {
    typed: String,
    /// `None`: it is transparent.
    color: Option<Rgb>,
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
    if color.is_none() && text != "transparent" {
        return Err("give white, black, transparent, or six digits as in \"#f0f4ff\"".to_owned());
    }
    Ok(Background { typed: text.to_owned(), color })
}

impl StyleArgs {
    pub(in crate::cli) fn preset(&self) -> Option<Preset> {
        self.preset
    }

    /// What is seen in the sky's place, linear.
    pub(in crate::cli) fn background(&self) -> Option<Rgb> {
        match &self.background {
            Some(background) => background.color,
            None => self.preset.map(|_| Rgb::ONE),
        }
    }

    /// Whether nothing is.
    pub(in crate::cli) fn is_transparent(&self) -> bool {
        self.background.as_ref().is_some_and(|background| background.color.is_none())
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
        for (text, color) in [
            ("white", Some(Rgb::ONE)),
            ("#ffffff", Some(Rgb::ONE)),
            ("black", Some(Rgb::ZERO)),
            ("#FF0000", Some(Rgb::X)),
            ("transparent", None),
        ] {
            assert_eq!(read(text), Ok(color));
        }
        for text in ["", "#", "#fff", "#-fffff", "#+fffff", "ffffff", "red", "#ggffff"] {
            assert!(read(text).is_err(), "{text}");
        }
        for look in Preset::ALL {
            assert_eq!(preset(look.name()), Ok(look));
        }
        assert!(preset("pretty").is_err());
    }
}
