//! Scenes with lights and a camera, for measurements of rendering.

use super::{BenchError, Options};
use spherule_render::scene::Scene;
use spherule_render::scene::generate::default_scene;
use spherule_render::world::World;
use std::path::Path;

/// A scene with its name.
#[derive(Clone, Debug)]
pub struct NamedScene {
    /// A built-in name, or the path of a file.
    pub name: String,
    /// The scene.
    pub scene: Scene,
}

/// Name of the program's default scene.
pub const FIELD: &str = "field";

/// Built-in scenes, by links to the folder `scenes` of the repository, which packages replace by the files.
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
    /// Returns the scenes given by name or as files, or else the usual ones.
    ///
    /// # Errors
    /// A scene is unknown, or its file is invalid.
    pub fn choose(options: &Options, usual: &[&str]) -> Result<Vec<Self>, BenchError> {
        if options.scenes.is_empty() {
            return usual.iter().map(|name| Self::named(name)).collect();
        }
        options.scenes.iter().map(|name| Self::named(name)).collect()
    }

    /// Returns the scene of this name; names that end in `.toml` are files.
    ///
    /// # Errors
    /// The scene is unknown, or its file is invalid.
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
        // Measurements choose the number of samples.
        (scene.settings.until_error, scene.settings.time) = (None, None);
        Ok(Self { name: name.to_owned(), scene })
    }

    /// Returns the scene with another image width, and about the same aspect ratio.
    pub fn resized(mut self, width: u32) -> Self {
        let settings = &mut self.scene.settings;
        let aspect = f64::from(settings.height) / f64::from(settings.width);
        settings.height = (f64::from(width) * aspect).round().max(1.0) as u32;
        settings.width = width;
        self
    }

    /// Builds the world to render.
    ///
    /// # Errors
    /// The scene cannot be rendered.
    pub fn world(&self) -> Result<World, BenchError> {
        World::build(&self.scene).map_err(|error| BenchError::World(self.name.clone(), error))
    }

    /// Returns the name without folders and suffix, for file names.
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
