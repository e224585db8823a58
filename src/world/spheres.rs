//! From the user's spheres to columns in world space.

use super::{Frame, WorldError};
use crate::scene::Scene;
use crate::spheres::Spheres;

/// The spheres in world space, in the user's order, without those that are cut away or vanish in
/// single precision.
pub(super) fn build(scene: &Scene, frame: &Frame) -> Spheres {
    let from = &scene.spheres;
    let mut spheres = Spheres::with_capacity(from.len());
    for row in scene.shown() {
        let radius = frame.length(from.radius[row]) as f32;
        if radius > 0.0 {
            let center = frame.point(from.center(row)).as_vec3();
            spheres.push(center, radius, row as u32);
        }
    }
    spheres
}

/// Checks what only code can get wrong: files are checked when they are read, with their lines.
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
