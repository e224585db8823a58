//! The census of a world, which decides which stages of a render run.

use super::parts::OmittedSpheres;
use super::{Features, World};
use crate::body_rows::BodyKind;
use crate::shade::MaterialKind;
use glam::DVec3;
use rayon::prelude::*;

/// Spheres that are nearer than this fraction of their coordinates count as touching.
const TOUCH: f64 = 1e-5;

impl Features {
    /// Counts the features of a world; `omitted` spheres of its scene are not in the world.
    pub(super) fn census(world: &World, omitted: OmittedSpheres) -> Self {
        Self {
            bodies_by_kind: BodyKind::ALL.map(|kind| world.count_materials(kind)),
            vanished: omitted.vanished,
            cut_away: omitted.cut_away,
            cuts: world.cut.len() as u64,
            around_camera: false,
            unseen: world
                .camera_visible
                .as_ref()
                .map_or(0, |visible| world.spheres.len() - visible.spheres.len())
                as u64,
            hidden: omitted.hidden,
            ground_kind: world.ground.map(|ground| ground.material.kind()),
            colors: world.appearance.color.is_some(),
            translucent: world.has_translucent(),
            lights: !world.lights.is_empty(),
            lens: false,
            environment: !world.environment.is_black(),
            glass_at_camera: Vec::new(),
            nested_glass: nested_glass(world),
        }
        .with_camera_of(world)
    }

    /// Updates the features that depend on the camera.
    pub(super) fn with_camera_of(self, world: &World) -> Self {
        Self {
            lens: world.camera.has_lens(),
            around_camera: around_camera(world),
            glass_at_camera: glass_at_camera(world),
            ..self
        }
    }
}

/// Returns whether a cut sphere overlaps the sphere that contains the camera rays' origins.
fn around_camera(world: &World) -> bool {
    let (at, reach) = world.camera.origins();
    let around = |row: usize| {
        let (center, radius) = world.spheres.exact(row);
        let near = center.distance(at) <= (radius + reach) * (1.0 + 1e-6);
        near && world.cut.divides(center, radius)
    };
    !world.cut.is_empty() && (0..world.spheres.len()).into_par_iter().any(around)
}

/// Maximum number of glass spheres that are tested in pairs; more count as touching.
const MAX_TESTED: usize = 1024;

/// Returns whether glass spheres may touch, with a tolerance far above the rounding of surface
/// points.
fn nested_glass(world: &World) -> bool {
    let is_glass =
        |row: &usize| world.appearance.material.row(*row).kind() == MaterialKind::Dielectric;
    if world.materials.dielectric.is_empty() {
        return false;
    }
    let rows = (0..world.spheres.len()).filter(is_glass).take(MAX_TESTED + 1);
    let glass: Vec<_> = rows.map(|row| world.spheres.exact(row)).collect();
    let apart = |(i, (center, radius)): (usize, &(DVec3, f64))| {
        glass[..i].iter().all(|(other, other_radius)| {
            let reach = radius + other_radius;
            let size = center.length() + other.length() + reach;
            center.distance(*other) > reach + size * TOUCH
        })
    };
    glass.len() > MAX_TESTED || !glass.iter().enumerate().all(apart)
}

/// Returns the glass spheres that overlap the sphere that contains the camera rays' origins.
fn glass_at_camera(world: &World) -> Vec<u32> {
    if world.materials.dielectric.is_empty() {
        return Vec::new();
    }
    let (center, reach) = world.camera.origins();
    let is_glass =
        |row: &u32| world.appearance.material.row(*row as usize).kind() == MaterialKind::Dielectric;
    let near = |row: &u32| {
        let (at, radius) = world.spheres.exact(*row as usize);
        at.distance(center) <= (radius + reach) * (1.0 + 1e-6)
    };
    let rows = (0..world.spheres.len() as u32).into_par_iter();
    let rows: Vec<u32> = rows.filter(|row| is_glass(row) && near(row)).collect();
    let mut rows = world.spheres.first_of_equals(rows.into_iter());
    rows.retain(is_glass);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Material, NamedMaterial, Rgb, Scene};

    /// Returns whether glass may be nested, for glass spheres along an axis, and one of another
    /// material in the first.
    fn nested(spheres: &[(f64, f64)]) -> bool {
        let mut scene = Scene::default();
        let glass = Material::Dielectric { ior: 1.5, color: Rgb::ONE };
        let solid = Material::Lambertian { color: Rgb::ONE };
        scene.materials = [("glass", glass), ("solid", solid)]
            .map(|(name, material)| NamedMaterial { name: name.into(), material })
            .into();
        for (index, &(x, radius)) in spheres.iter().chain(&[(0.0, 0.1)]).enumerate() {
            let material = u32::from(index == spheres.len());
            scene.spheres.push(DVec3::X * x, radius, material, Rgb::ONE);
        }
        World::build(&scene).unwrap().features.nested_glass
    }

    #[test]
    fn what_is_absent_is_skipped_and_nothing_else() {
        let all = Features {
            bodies_by_kind: [[1; MaterialKind::COUNT]; BodyKind::ALL.len()],
            cuts: 1,
            ground_kind: Some(MaterialKind::Lambertian),
            colors: true,
            translucent: true,
            lights: true,
            lens: true,
            environment: true,
            glass_at_camera: vec![0],
            nested_glass: true,
            ..Features::default()
        };
        assert!(all.skipped().is_empty(), "{:?}", all.skipped());
        let fewer = Features { ground_kind: None, lens: false, ..all };
        assert_eq!(fewer.skipped(), ["no ground: no plane test", "no lens: no lens samples"]);
        assert_eq!(Features::default().skipped().len(), 9 + MaterialKind::COUNT);
    }

    #[test]
    fn glass_is_nested_where_it_touches_glass() {
        assert!(!nested(&[(0.0, 1.0)]));
        assert!(!nested(&[(0.0, 1.0), (2.1, 1.0), (-3.0, 1.5)]));
        assert!(nested(&[(0.0, 1.0), (2.0, 1.0)]), "touching");
        assert!(nested(&[(0.0, 1.0), (5.0, 0.1), (0.3, 0.2)]), "inside");
        assert!(nested(&[(0.0, 1.0), (-1.5, 1.0)]), "overlapping");
        // A gap below the rounding of points.
        assert!(nested(&[(0.0, 1.0), (1e6, 1e-3), (1e6 + 3e-3, 1e-3)]));
    }
}
