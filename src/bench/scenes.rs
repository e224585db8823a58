//! Whole scenes, with light and a camera: what pictures are measured on.

use super::{BenchError, Options};
use crate::scene::Scene;
use crate::scene::generate::default_scene;
use crate::world::World;
use std::path::Path;

/// A scene and what it is called.
#[derive(Clone, Debug)]
pub struct NamedScene {
    /// A word, or the path of a file.
    pub name: String,
    /// The scene.
    pub scene: Scene,
}

/// The scene that is rendered when nobody says what to render.
pub const FIELD: &str = "field";

/// Scenes that the program knows without a file: those of the folder `scenes`.
const FILES: [(&str, &str); 8] = [
    ("furnace", include_str!("../../scenes/furnace.toml")),
    ("glass-nested", include_str!("../../scenes/glass-nested.toml")),
    ("mirror-sky", include_str!("../../scenes/mirror-sky.toml")),
    ("paper-field-20", include_str!("../../scenes/paper-field-20.toml")),
    ("smallpt", include_str!("../../scenes/smallpt.toml")),
    ("sphereflake", include_str!("../../scenes/sphereflake.toml")),
    ("veach", include_str!("../../scenes/veach.toml")),
    ("weekend", include_str!("../../scenes/weekend.toml")),
];

impl NamedScene {
    /// The scenes that were asked for, by name or as files, or else the usual ones.
    ///
    /// # Errors
    /// There is no such scene, or its file is wrong.
    pub fn choose(options: &Options, usual: &[&str]) -> Result<Vec<Self>, BenchError> {
        if options.scenes.is_empty() {
            return usual.iter().map(|name| Self::named(name)).collect();
        }
        options.scenes.iter().map(|name| Self::named(name)).collect()
    }

    /// The scene of a name; what ends in `.toml` is a file.
    ///
    /// # Errors
    /// There is no such scene, or its file is wrong.
    pub fn named(name: &str) -> Result<Self, BenchError> {
        let found = FILES.iter().find(|file| file.0 == name);
        let mut scene = match found {
            Some((name, text)) => Scene::parse(text, name, Path::new("."))?,
            None if name == FIELD => default_scene(0),
            None if is_file(name) => Scene::load(Path::new(name))?,
            None => {
                let known: Vec<_> = FILES.iter().map(|file| file.0).collect();
                let known = format!("{FIELD}, {}, or a file that ends in .toml", known.join(", "));
                return Err(BenchError::UnknownScene { name: name.to_owned(), known });
            }
        };
        // Measurements decide themselves on samples.
        (scene.settings.until_error, scene.settings.time) = (None, None);
        Ok(Self { name: name.to_owned(), scene })
    }

    /// The same so many pixels wide, in about the same shape.
    pub fn resized(mut self, width: u32) -> Self {
        let settings = &mut self.scene.settings;
        let shape = f64::from(settings.height) / f64::from(settings.width);
        settings.height = (f64::from(width) * shape).round().max(1.0) as u32;
        settings.width = width;
        self
    }

    /// What is rendered.
    ///
    /// # Errors
    /// The scene cannot be rendered.
    pub fn world(&self) -> Result<World, BenchError> {
        World::build(&self.scene).map_err(|error| BenchError::World(self.name.clone(), error))
    }

    /// The name without folders and suffix, for files.
    pub fn stem(&self) -> String {
        let stem = Path::new(&self.name).file_stem();
        stem.map_or_else(|| self.name.clone(), |stem| stem.to_string_lossy().into_owned())
    }
}

fn is_file(name: &str) -> bool {
    Path::new(name).extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_of_the_list_can_be_rendered() {
        for name in FILES.iter().map(|file| file.0).chain([FIELD]) {
            let scene = NamedScene::named(name).unwrap().resized(40);
            assert_eq!(scene.scene.settings.width, 40);
            assert_eq!(scene.world().unwrap().camera.width, 40, "{name}");
            assert_eq!(scene.stem(), name);
        }
    }

    #[test]
    fn unknown_scenes_are_refused_with_the_names_that_there_are() {
        let message = NamedScene::named("nowhere").unwrap_err().to_string();
        assert!(message.contains("nowhere") && message.contains("smallpt"), "{message}");
        assert!(NamedScene::named("nowhere.toml").is_err());
    }
}
