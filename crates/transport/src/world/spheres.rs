//! Transforms the user's spheres to columns in world space.

use super::appearance::SceneAppearance;
use super::{Transform, WorldError};
use crate::scene::{self, Scene, Slice, SliceMode};
use crate::spheres::Spheres;
use std::borrow::Cow;
use std::mem::take;

/// The scene's spheres in world space.
pub(super) struct WorldSpheres<'s> {
    /// Spheres in the user's order, without those that are cut away or vanish in single precision.
    pub spheres: Spheres,
    /// Materials and colors of all of the user's spheres.
    pub(super) appearance: SceneAppearance<'s>,
    /// Number of spheres that slices do not remove.
    pub(super) shown: usize,
    /// One flag for each of the user's spheres, true if the camera does not see it; empty if all
    /// are visible.
    pub(super) hidden: Vec<bool>,
}

impl<'s> WorldSpheres<'s> {
    /// Transforms spheres; frees the memory of owned columns as early as possible.
    pub(super) fn build(
        from: Cow<'s, scene::Spheres>,
        slices: &[Slice],
        transform: &Transform,
    ) -> Self {
        match from {
            Cow::Borrowed(from) => {
                let appearance =
                    SceneAppearance::new(Cow::Borrowed(&from.material), Cow::Borrowed(&from.color));
                Self::of(from, appearance, slices, transform)
            }
            Cow::Owned(mut from) => {
                let (material, color) = (take(&mut from.material), take(&mut from.color));
                let appearance = SceneAppearance::new(Cow::Owned(material), Cow::Owned(color));
                Self::of(&from, appearance, slices, transform)
            }
        }
    }

    fn of(
        from: &scene::Spheres,
        appearance: SceneAppearance<'s>,
        slices: &[Slice],
        transform: &Transform,
    ) -> Self {
        let hides = |row: usize| slices.iter().any(|slice| slice.hides(from.center(row)));
        let any = slices.iter().any(|slice| slice.mode == SliceMode::Hide);
        let hidden = if any { (0..from.len()).map(hides).collect() } else { Vec::new() };
        let drops =
            |row: usize| slices.iter().any(|slice| slice.drops(from.center(row), from.radius[row]));
        let (mut spheres, mut shown) = (Spheres::with_capacity(from.len()), 0);
        for row in (0..from.len()).filter(|&row| !drops(row)) {
            shown += 1;
            let radius = transform.length(from.radius[row]) as f32;
            if radius > 0.0 {
                let center = transform.point(from.center(row)).as_vec3();
                spheres.push(center, radius, row as u32);
            }
        }
        Self { spheres, appearance, shown, hidden }
    }
}

/// Checks columns that come from code; those from files were checked when they were read, with line
/// numbers.
pub(super) fn validate(scene: &Scene) -> Result<(), WorldError> {
    let spheres = &scene.spheres;
    let n = spheres.len();
    if n > Spheres::MAX {
        return Err(WorldError::TooManySpheres(n));
    }
    let invalid = |message: String| Err(WorldError::Invalid(message));
    let optional = |len: usize| len == 0 || len == n;
    if [spheres.x.len(), spheres.y.len(), spheres.z.len()] != [n; 3]
        || !optional(spheres.material.len())
        || !optional(spheres.color.len())
    {
        return invalid(format!("the columns of the spheres differ in length from `radius`, {n}"));
    }
    for i in 0..n {
        if !(spheres.center(i).is_finite()
            && spheres.radius[i].is_finite()
            && spheres.radius[i] > 0.0)
        {
            return invalid(format!(
                "sphere {i}: the center must be finite and the radius more than 0, not {:?} and {}",
                spheres.center(i),
                spheres.radius[i]
            ));
        }
    }
    let used = spheres.material.iter().copied().max().unwrap_or(0);
    let used = used.max(scene.ground.as_ref().map_or(0, |ground| ground.material));
    if (n > 0 || scene.ground.is_some()) && used as usize >= scene.materials.len() {
        return invalid(format!(
            "material {used} does not exist: the scene has {}",
            scene.materials.len()
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use crate::bvh::builders::Builder;
    use crate::scene::generate::default_scene;
    use crate::world::{World, WorldError};

    #[test]
    fn worlds_that_own_or_borrow_the_spheres_are_equal() {
        let mut scene = default_scene(3);
        scene.spheres.radius[5] = 1e-60;
        for builder in Builder::ALL {
            let left = World::build_with(&scene, builder).unwrap();
            let mut given = scene.clone();
            let taken = World::build_taking(&mut given, builder).unwrap();
            assert_eq!(format!("{taken:?}"), format!("{left:?}"));
            assert_eq!((taken.features.vanished, given.spheres.len()), (1, 0));
        }
    }

    #[test]
    fn refused_scenes_keep_their_spheres() {
        let mut scene = default_scene(3);
        scene.spheres.radius[5] = -1.0;
        let before = scene.spheres.clone();
        let refused = World::build_taking(&mut scene, Builder::default());
        assert!(matches!(refused, Err(WorldError::Invalid(_))));
        assert_eq!(scene.spheres, before);
    }
}
