//! Transforms the user's spheres to columns in world space.

use super::appearance::Looks;
use super::{Frame, WorldError};
use crate::scene::{self, Scene, Slice, SliceMode};
use crate::spheres::Spheres;
use std::borrow::Cow;
use std::mem::take;

/// The scene's spheres in world space.
pub(super) struct WorldSpheres<'s> {
    /// Spheres in the user's order, without those that are cut away or vanish in single precision.
    pub(super) spheres: Spheres,
    /// Materials and colors of all of the user's spheres.
    pub(super) looks: Looks<'s>,
    /// Number of spheres that slices leave.
    pub(super) shown: usize,
    /// Whether the camera sees each of the user's spheres; empty if it sees all.
    pub(super) hidden: Vec<bool>,
}

impl<'s> WorldSpheres<'s> {
    /// Transforms spheres; frees the memory of owned columns as early as possible.
    pub(super) fn build(from: Cow<'s, scene::Spheres>, slices: &[Slice], frame: &Frame) -> Self {
        match from {
            Cow::Borrowed(from) => {
                let looks = Looks::new(Cow::Borrowed(&from.material), Cow::Borrowed(&from.color));
                Self::of(from, looks, slices, frame)
            }
            Cow::Owned(mut from) => {
                let (material, color) = (take(&mut from.material), take(&mut from.color));
                let looks = Looks::new(Cow::Owned(material), Cow::Owned(color));
                Self::of(&from, looks, slices, frame)
            }
        }
    }

    fn of(from: &scene::Spheres, looks: Looks<'s>, slices: &[Slice], frame: &Frame) -> Self {
        let hides = |row: usize| slices.iter().any(|slice| slice.hides(from.center(row)));
        let any = slices.iter().any(|slice| slice.mode == SliceMode::Hide);
        let hidden = if any { (0..from.len()).map(hides).collect() } else { Vec::new() };
        let drops =
            |row: usize| slices.iter().any(|slice| slice.drops(from.center(row), from.radius[row]));
        let (mut spheres, mut shown) = (Spheres::with_capacity(from.len()), 0);
        for row in (0..from.len()).filter(|&row| !drops(row)) {
            shown += 1;
            let radius = frame.length(from.radius[row]) as f32;
            if radius > 0.0 {
                let center = frame.point(from.center(row)).as_vec3();
                spheres.push(center, radius, row as u32);
            }
        }
        Self { spheres, looks, shown, hidden }
    }
}

/// Checks columns that code may have filled; files are checked when they are read, with line numbers.
pub(super) fn validate(scene: &Scene) -> Result<(), WorldError> {
    let spheres = &scene.spheres;
    let n = spheres.len();
    if n > Spheres::MAX {
        return Err(WorldError::TooManySpheres(n));
    }
    let invalid = |what: String| Err(WorldError::Invalid(what));
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
    fn a_world_that_takes_the_spheres_is_the_one_that_leaves_them() {
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
    fn what_is_refused_keeps_its_spheres() {
        let mut scene = default_scene(3);
        scene.spheres.radius[5] = -1.0;
        let before = scene.spheres.clone();
        let refused = World::build_taking(&mut scene, Builder::default());
        assert!(matches!(refused, Err(WorldError::Invalid(_))));
        assert_eq!(scene.spheres, before);
    }
}
