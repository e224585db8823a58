//! Content of the viewer, without camera and settings: a change needs a new world.

use super::options::Options;
use glam::DVec3;
use spherule_render::scene::{Background, Camera, Preset};

/// Content of the viewer.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Content {
    /// The file, and options that say how it looks.
    pub(super) options: Options,
    /// Trajectory frame; `None` for that of the command line.
    pub(super) frame: Option<u64>,
    /// Hidden types.
    pub(super) hidden: Vec<String>,
    /// Slices.
    pub(super) cuts: Vec<CutPlane>,
    /// Column of the colors; `None` for that of the command line.
    pub(super) color: Option<String>,
    /// Preset, and the camera for its lights.
    pub(super) preset: Option<(Preset, Camera)>,
}

/// Changes of the scene's look by keys.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct LookChanges {
    pub(super) background: Option<Background>,
    pub(super) depth_cue: Option<bool>,
    pub(super) outline: Option<bool>,
}

/// A plane; spheres whose centers are beyond it are hidden.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CutPlane {
    /// Normal, toward the hidden side.
    pub(super) normal: DVec3,
    /// A point on the plane.
    pub(super) point: DVec3,
}

impl Content {
    /// Returns the condition for visible particles in the syntax of `--select`; `None` if all are visible.
    pub(super) fn condition(&self) -> Option<String> {
        let hidden = self.hidden.iter().map(|name| {
            let quote = if name.contains('"') { '\'' } else { '"' };
            format!("type != {quote}{name}{quote}")
        });
        let cuts = self.cuts.iter().map(|CutPlane { normal: n, point }| {
            // Differences first: far from the origin, products would lose precision.
            let term = |axis: char, i: usize| format!("({axis} - {:?}) * {:?}", point[i], n[i]);
            format!("{} + {} + {} <= 0", term('x', 0), term('y', 1), term('z', 2))
        });
        let parts: Vec<String> = hidden.chain(cuts).collect();
        (!parts.is_empty()).then(|| parts.join(" and "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_render::scene::particles::{ParticleStyle, Particles, Selection};
    use spherule_render::scene::{Rgb, Spheres};
    use std::path::Path;

    #[test]
    fn cuts_keep_one_side_of_the_plane() {
        assert_eq!(Content::default().condition(), None);
        let mut spheres = Spheres::default();
        for x in [-2.0, -1e-9, 0.5, 3.0] {
            spheres.push(DVec3::new(1e6 + x, 0.0, 1.0), 1.0, 0, Rgb::ONE);
        }
        let mut particles = Particles { spheres, ..Particles::default() };
        let cut =
            CutPlane { normal: DVec3::new(1e-20, 0.0, -0.0), point: DVec3::new(1e6, -3.0, 7.5) };
        let content = Content { cuts: vec![cut], ..Content::default() };
        let select: Selection = content.condition().unwrap().parse().unwrap();
        let looks = ParticleStyle { select: Some(select), ..ParticleStyle::default() };
        looks.apply(Path::new("test"), &mut particles).unwrap();
        assert_eq!(particles.spheres.len(), 2);
    }

    #[test]
    fn names_of_types_are_quoted() {
        let hidden = vec!["Na".to_owned(), "H\"".to_owned()];
        let content = Content { hidden, ..Content::default() };
        let condition = content.condition().unwrap();
        assert_eq!(condition, "type != \"Na\" and type != 'H\"'");
        assert!(condition.parse::<Selection>().is_ok());
    }
}
