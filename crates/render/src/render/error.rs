//! Reasons why a render cannot start.

use super::{ImagePart, Options};
use crate::film::{Region, RegionError};
use crate::scene::{InvalidSetting, Settings};
use crate::world::World;

/// A reason why a render cannot start.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum RenderError {
    /// A setting is out of range.
    #[error(transparent)]
    Setting(#[from] InvalidSetting),
    /// The region is not in the image.
    #[error(transparent)]
    Region(#[from] RegionError),
    /// A part with samples or tiles that the render does not have.
    #[error("not a part of the render: {0}")]
    Part(ImagePart),
    /// The image size of the settings differs from that of the world's camera.
    #[error(
        "the settings are for a picture of {} x {}, but the world's camera makes one of {} x {}; \
         build the world with these settings, or call World::set_camera",
        .settings[0], .settings[1], .camera[0], .camera[1]
    )]
    Size {
        /// Width and height of the settings.
        settings: [u32; 2],
        /// Width and height of the camera's image.
        camera: [u32; 2],
    },
}

/// Checks the settings and the region of a render. Returns the region, which is the whole image if
/// the options name none.
pub(crate) fn check(
    world: &World,
    settings: &Settings,
    options: &Options,
) -> Result<Region, RenderError> {
    settings.check()?;
    let (width, height) = (world.camera.width, world.camera.height);
    if (settings.width, settings.height) != (width, height) {
        let settings = [settings.width, settings.height];
        return Err(RenderError::Size { settings, camera: [width, height] });
    }
    let whole = Region { x: 0, y: 0, width, height };
    Ok(options.region.unwrap_or(whole).check_in(width, height)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::film::RegionError;
    use crate::layers::{Layer, ProgressiveLayers, layers};
    use crate::overlay;
    use crate::render::{ResumableRender, render};
    use crate::scene::generate::default_scene;

    #[test]
    fn renders_with_invalid_options_are_refused() {
        let mut scene = default_scene(0);
        (scene.settings.width, scene.settings.height) = (8, 6);
        let mut world = World::build(&scene).unwrap();
        let usual = || scene.settings.clone();
        let part = |x, width| Options {
            region: Some(Region { x, y: 0, width, height: 6 }),
            ..Options::default()
        };
        let outside = Region { x: 7, y: 0, width: 2, height: 6 };
        let cases = [
            (
                Settings { until_error: Some(f64::NAN), ..usual() },
                Options::default(),
                "until_error",
            ),
            (Settings { exposure: f64::NAN, ..usual() }, Options::default(), "exposure"),
            (Settings { spp: 0, ..usual() }, Options::default(), "spp"),
            (Settings { width: 9, ..usual() }, Options::default(), "World::set_camera"),
            (usual(), part(0, 0), "region"),
            (usual(), part(7, 2), "region"),
            (usual(), part(u32::MAX, u32::MAX), "region"),
        ];
        for (settings, options, name) in cases {
            let error = render(&world, &settings, &options).expect_err(name);
            assert!(error.to_string().contains(name), "{error}");
            let same = |other: Option<RenderError>| assert_eq!(other.as_ref(), Some(&error));
            same(ResumableRender::begin(&world, &settings, &options).err());
            same(layers(&world, &settings, &options, &[Layer::Depth]).err());
            same(ProgressiveLayers::begin(&world, &settings, &options).err());
            same(overlay::ground(&mut world, &settings, &options).err());
        }
        let error = render(&world, &usual(), &part(7, 2)).err();
        let expected = RegionError::Outside { region: outside, width: 8, height: 6 };
        assert_eq!(error, Some(RenderError::Region(expected)));
    }

    #[test]
    fn renders_cannot_resume_with_settings_out_of_range() {
        let mut scene = default_scene(0);
        (scene.settings.width, scene.settings.height, scene.settings.spp) = (8, 6, 1);
        let world = World::build(&scene).unwrap();
        let mut begun =
            ResumableRender::begin(&world, &scene.settings, &Options::default()).unwrap();
        let dark = Settings { exposure: f64::INFINITY, ..scene.settings.clone() };
        let error = begun.extend(&dark).expect_err("no exposure");
        assert!(error.to_string().contains("exposure"), "{error}");
    }
}
