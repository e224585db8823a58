//! Sources of scenes.

use super::failure::Failure;
use super::options::particles::ParticleArgs;
use spherule_render::prepared::is_prepared;
use spherule_render::scene::particles::ReadOptions;
use spherule_render::scene::{FileError, Scene, generate};
use std::borrow::Cow;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Sources of scenes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Source {
    /// A scene file.
    Toml(PathBuf),
    /// A prepared scene with its acceleration structure, as `render --prepare` writes it.
    Prepared(PathBuf),
    /// A particle file, and options for reading it.
    Particles(PathBuf, Box<ReadOptions>),
    /// The default scene, a random field of spheres.
    Field {
        /// Seed of the random numbers.
        seed: u64,
    },
}

impl Source {
    /// Returns the source for a path. `args` of `command` apply only to particle files.
    pub(super) fn of_path(
        command: &str,
        path: &Path,
        args: &ParticleArgs,
    ) -> Result<Self, Failure> {
        let toml = is_scene(path);
        if is_prepared(path) {
            return Ok(Self::Prepared(path.to_owned()));
        }
        if toml && args.any() {
            let message = "options for particle files do not apply to a scene; set format, radius and scale \
                           in its [[file]] tables";
            return Err(Failure::usage(command, message));
        }
        Ok(if toml {
            Self::Toml(path.to_owned())
        } else {
            Self::Particles(path.to_owned(), Box::new(args.options()))
        })
    }

    /// Loads the scene.
    pub(super) fn load(&self) -> Result<Scene, FileError> {
        match self {
            Self::Toml(path) => Scene::load(path),
            Self::Prepared(path) => {
                let error = FileError::whole_file(path, "is a prepared scene");
                Err(error.with_help(
                    "render it with `spherule render`, or use the file it was made from",
                ))
            }
            Self::Particles(path, options) => Scene::from_particles(path, options),
            Self::Field { seed } => Ok(generate::default_scene(*seed)),
        }
    }

    /// Returns the name of the source for messages.
    pub(super) fn name(&self) -> Cow<'_, str> {
        match self {
            Self::Toml(path) | Self::Prepared(path) | Self::Particles(path, _) => {
                path.to_string_lossy()
            }
            Self::Field { .. } => Cow::Borrowed("the random field"),
        }
    }

    /// Returns the scene's title, or else the file's name, without folders, which are private.
    pub(super) fn title<'a>(&'a self, scene: &'a Scene) -> Cow<'a, str> {
        match self {
            Self::Toml(path) | Self::Particles(path, _) if scene.title.is_empty() => {
                path.file_name().map_or(Cow::Borrowed(""), OsStr::to_string_lossy)
            }
            _ => Cow::Borrowed(&scene.title),
        }
    }
}

/// Returns whether a file is a scene, by its name; any other is a particle file.
pub(super) fn is_scene(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of_path(name: &str) -> Source {
        Source::of_path("info", Path::new(name), &ParticleArgs::default())
            .expect("nothing of particles")
    }

    #[test]
    fn suffixes_distinguish_scenes_from_particles() {
        let toml = |name: &str| matches!(of_path(name), Source::Toml(_));
        assert!(toml("a/b.toml") && toml("B.TOML"));
        assert!(!toml("a.xyz") && !toml("toml") && !toml("a.toml.csv"));
    }

    #[test]
    fn titles_contain_no_folders() {
        let source = of_path("somewhere/private/a.toml");
        assert_eq!(source.title(&Scene::default()), "a.toml");
        let titled = Scene { title: "A scene".to_owned(), ..Scene::default() };
        assert_eq!(source.title(&titled), "A scene");
    }
}
