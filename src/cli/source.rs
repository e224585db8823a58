//! Where a scene comes from.

use spherule::scene::{Scene, SceneError, generate};
use std::borrow::Cow;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// Where a scene comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Source {
    /// A scene file.
    Toml(PathBuf),
    /// A file of particles.
    Particles(PathBuf),
    /// The random field that shows what the program does.
    Field {
        /// Of the field's random numbers.
        seed: u64,
    },
}

impl Source {
    /// The source that a path speaks of.
    pub(super) fn of_path(path: &Path) -> Self {
        let toml = path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml"));
        if toml { Self::Toml(path.to_owned()) } else { Self::Particles(path.to_owned()) }
    }

    /// The scene.
    pub(super) fn load(&self) -> Result<Scene, SceneError> {
        match self {
            Self::Toml(path) => Scene::load(path),
            Self::Particles(path) => Scene::from_particles(path),
            Self::Field { seed } => Ok(generate::default_scene(*seed)),
        }
    }

    /// As the user knows it.
    pub(super) fn name(&self) -> Cow<'_, str> {
        match self {
            Self::Toml(path) | Self::Particles(path) => path.to_string_lossy(),
            Self::Field { .. } => Cow::Borrowed("the random field"),
        }
    }

    /// The scene's own title, or else the file's name without its folders, which are the user's own
    /// business.
    pub(super) fn title<'a>(&'a self, scene: &'a Scene) -> Cow<'a, str> {
        match self {
            Self::Toml(path) | Self::Particles(path) if scene.title.is_empty() => {
                path.file_name().map_or(Cow::Borrowed(""), OsStr::to_string_lossy)
            }
            _ => Cow::Borrowed(&scene.title),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn suffixes_tell_scenes_from_particles() {
        let toml = |name: &str| matches!(Source::of_path(Path::new(name)), Source::Toml(_));
        assert!(toml("a/b.toml") && toml("B.TOML"));
        assert!(!toml("a.xyz") && !toml("toml") && !toml("a.toml.csv"));
    }

    #[test]
    fn titles_tell_no_folders() {
        let source = Source::of_path(Path::new("/home/someone/secret/a.toml"));
        assert_eq!(source.title(&Scene::default()), "a.toml");
        let titled = Scene { title: "A scene".to_owned(), ..Scene::default() };
        assert_eq!(source.title(&titled), "A scene");
    }
}
