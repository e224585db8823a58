//! Looks by name.

use crate::cli::settings::List;
use serde_json::json;
use spherule::scene::particles::Particles;
use spherule::scene::{Background, Look, Preset, Scene};
use spherule::{color, suggest};

/// What the picture looks like.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Look")]
pub(in crate::cli) struct StyleArgs {
    /// Material, light and lines of a file of particles by name: chalk, studio, cloudy, glossy,
    /// depthcue or outline. Radii, colors and materials of --type go before it
    #[arg(long, value_name = "NAME", value_parser = preset)]
    preset: Option<Preset>,
    /// In the sky's place, which goes on lighting the scene: a CSS color such as white or #rrggbb,
    /// before --exposure; transparent, for PNG, EXR, TIFF and WebP, where of the ground only shadows are
    /// left; or sky
    /// [default: white with --preset, or else what the scene says]
    #[arg(long, value_name = "COLOR", value_parser = background)]
    background: Option<Typed>,
}

/// A background, and how it was typed.
#[derive(Clone, Debug, PartialEq)]
struct Typed {
    text: String,
    background: Background,
}

/// Makes a scene of particles; those without a material of their own have that of a preset.
pub(in crate::cli) fn scene_of_particles(
    preset: Option<Preset>,
    particles: Particles,
    title: &str,
) -> Scene {
    match preset {
        Some(preset) => Scene::of_particles_with(particles, title, &preset.material()),
        None => Scene::of_particles(particles, title),
    }
}

fn preset(name: &str) -> Result<Preset, String> {
    let found = Preset::ALL.into_iter().find(|preset| preset.name() == name);
    let names = || Preset::ALL.map(Preset::name).into_iter();
    found.ok_or_else(|| suggest::help(name, names(), "looks are"))
}

fn background(text: &str) -> Result<Typed, String> {
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
    Ok(Typed { text: text.to_owned(), background })
}

impl StyleArgs {
    pub(in crate::cli) fn preset(&self) -> Option<Preset> {
        self.preset
    }

    /// Makes a scene of particles; those without a material of their own have this look's.
    pub(in crate::cli) fn scene(&self, particles: Particles, title: &str) -> Scene {
        scene_of_particles(self.preset, particles, title)
    }

    /// What is drawn over a picture: as a preset says or else the scene, but for the cell, and for
    /// the background if one was typed.
    pub(in crate::cli) fn look(&self, preset: Option<Preset>, own: Look) -> Look {
        let look = preset.map_or(own, Preset::look);
        let typed = self.background.as_ref().map(|typed| typed.background);
        Look { background: typed.unwrap_or(look.background), cell: own.cell, ..look }
    }

    /// Sets what the look says of settings and of what is drawn over the picture, before others are typed.
    pub(in crate::cli) fn set(&self, scene: &mut Scene) {
        if let Some(preset) = self.preset {
            preset.set(scene);
        }
        scene.look = self.look(self.preset, scene.look);
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
        if let Some(typed) = &self.background {
            list.insert("background".to_owned(), json!(typed.text));
        }
        list
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule::scene::Rgb;

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
