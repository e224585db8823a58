//! Regimes: numerically hard kinds of scenes and rays.

use super::scenes::{Aim, Arrangement, Origin, Recipe};

/// A kind of scenes and rays.
#[derive(Debug)]
pub struct Regime {
    /// Name on the command line.
    pub name: &'static str,
    /// Description in a few words.
    pub about: &'static str,
    pub(super) recipe: Recipe,
}

impl Regime {
    /// Returns the regime with this name.
    pub fn named(name: &str) -> Option<&'static Self> {
        REGIMES.iter().find(|regime| regime.name == name)
    }
}

/// Spheres of radius about 1 around the origin, rays from a few radii away.
const NEAR: Recipe = Recipe {
    arrangement: Arrangement::Cluster,
    origin: Origin::Away([0.2, 1.5]),
    aim: Aim::Sphere,
    offset: 0.0,
    scale: 1.0,
    length: [0.0, 0.0],
};

const fn regime(name: &'static str, about: &'static str, recipe: Recipe) -> Regime {
    Regime { name, about, recipe }
}

const fn far(decade: f64) -> Recipe {
    Recipe { origin: Origin::Away([decade - 0.1, decade + 0.1]), ..NEAR }
}

const fn ground(radius: f64, origin: Origin, aim: Aim) -> Recipe {
    Recipe { arrangement: Arrangement::Ground(radius), origin, aim, ..NEAR }
}

const fn tangent(origin: [f64; 2]) -> Recipe {
    Recipe { origin: Origin::Away(origin), aim: Aim::Tangent([-9.0, -1.0]), ..NEAR }
}

const fn scaled(scale: f64) -> Recipe {
    Recipe { scale, ..NEAR }
}

const fn moved(offset: f64) -> Recipe {
    Recipe { offset, ..NEAR }
}

const fn arranged(arrangement: Arrangement, origin: Origin, aim: Aim) -> Recipe {
    Recipe { arrangement, origin, aim, ..NEAR }
}

const fn directed(shortest: f64, longest: f64) -> Recipe {
    Recipe { length: [shortest, longest], ..NEAR }
}

const ABOVE: Origin = Origin::Above([-4.0, 1.0]);
const AROUND: Origin = Origin::Away([0.1, 1.5]);

/// All regimes, in display order.
pub static REGIMES: [Regime; 36] = [
    regime("near_unit", "radii 0.2 to 1, rays from 2 to 30 radii", NEAR),
    regime("inside", "rays that start inside a sphere", Recipe { origin: Origin::Inside, ..NEAR }),
    regime("far_1e3", "radius / distance 1e-3", far(3.0)),
    regime("far_1e4", "radius / distance 1e-4", far(4.0)),
    regime("far_1e5", "radius / distance 1e-5", far(5.0)),
    regime("far_1e6", "radius / distance 1e-6", far(6.0)),
    regime("far_1e7", "radius / distance 1e-7", far(7.0)),
    regime(
        "far_1e5_at_0",
        "radius / distance 1e-5, rays from the origin of coordinates",
        Recipe { origin: Origin::Zero, offset: 1e5, ..NEAR },
    ),
    regime(
        "ground_1e5",
        "just above a sphere of radius 1e5",
        ground(1e5, ABOVE, Aim::SphereOrTangent),
    ),
    regime(
        "ground_1e7",
        "just above a sphere of radius 1e7",
        ground(1e7, ABOVE, Aim::SphereOrTangent),
    ),
    regime(
        "on_ground_1e5",
        "on a sphere of radius 1e5",
        ground(1e5, Origin::Ground, Aim::Anywhere),
    ),
    regime(
        "on_ground_1e7",
        "on a sphere of radius 1e7",
        ground(1e7, Origin::Ground, Aim::Anywhere),
    ),
    regime("grazing", "nearly tangent rays, off by 1e-9 to 0.1 radii", tangent([0.2, 1.5])),
    regime("grazing_far", "the same from 1e3 to 1e6 radii", tangent([3.0, 6.0])),
    regime(
        "axis_tangent",
        "tangents along axes, exact or off by one unit in the last place",
        arranged(Arrangement::Lattice, AROUND, Aim::AxisTangent),
    ),
    regime(
        "hair",
        "tangents and equal distances, off by 1e-30 to 1e-8",
        arranged(Arrangement::Pencil, Origin::Zero, Aim::NearOrigin([-30.0, -8.0])),
    ),
    regime("offset_1e4", "scene 1e4 from the origin of coordinates", moved(1e4)),
    regime("offset_1e6", "scene 1e6 from the origin of coordinates", moved(1e6)),
    regime("scale_1e-10", "scene scaled by 1e-10", scaled(1e-10)),
    regime("scale_1e10", "scene scaled by 1e10", scaled(1e10)),
    regime("scale_1e-20", "scene scaled by 1e-20", scaled(1e-20)),
    regime("scale_1e20", "scene scaled by 1e20", scaled(1e20)),
    regime("scale_1e-30", "scene scaled by 1e-30", scaled(1e-30)),
    regime("scale_1e30", "scene scaled by 1e30", scaled(1e30)),
    regime("denormal", "scene scaled by 1e-40", scaled(1e-40)),
    regime("direction_1e3", "directions of lengths 1e-3 to 1e3", directed(-3.0, 3.0)),
    regime("direction_extreme", "directions of lengths 1e-41 to 1e38", directed(-41.0, 38.0)),
    regime("behind", "rays that point away from a sphere", Recipe { aim: Aim::Away, ..NEAR }),
    regime(
        "on_surface",
        "rays that start on a surface, with a rounded origin",
        Recipe { origin: Origin::Surface, aim: Aim::Anywhere, ..NEAR },
    ),
    regime(
        "touching",
        "touching spheres, rays toward the contact",
        arranged(Arrangement::Chain, AROUND, Aim::Contact),
    ),
    regime(
        "shells",
        "concentric spheres, 4e-5 of the radius apart",
        arranged(Arrangement::Shells, AROUND, Aim::SphereOrTangent),
    ),
    regime(
        "shells_inside",
        "the same, with rays from the gaps",
        arranged(Arrangement::Shells, Origin::Surface, Aim::Anywhere),
    ),
    regime("twins", "equal spheres", arranged(Arrangement::Twins, AROUND, Aim::Sphere)),
    regime(
        "mixed",
        "radii and distances over 12 decades",
        arranged(
            Arrangement::Decades([-6.0, 6.0]),
            Origin::Somewhere([-6.0, 6.0]),
            Aim::SphereOrTangent,
        ),
    ),
    regime(
        "mixed_all",
        "radii and distances over 82 decades",
        arranged(
            Arrangement::Decades([-44.0, 38.0]),
            Origin::Somewhere([-44.0, 38.0]),
            Aim::SphereOrTangent,
        ),
    ),
    regime(
        "both_ends",
        "a sphere of 1e38, and rays near and tangent to ones of 1e-44",
        arranged(Arrangement::Ends, Origin::Zero, Aim::Ends),
    ),
];

#[cfg(test)]
mod tests {
    use super::super::rays::ray;
    use super::super::scenes::{center_and_radius, scene};
    use super::*;
    use glam::Vec3;
    use spherule_core::internals::random::Random;

    #[test]
    fn names_are_unique_and_found() {
        for (i, regime) in REGIMES.iter().enumerate() {
            let found = Regime::named(regime.name).map(std::ptr::from_ref);
            assert_eq!(found, Some(std::ptr::from_ref(&REGIMES[i])), "{}", regime.name);
        }
        assert!(Regime::named("nowhere").is_none());
    }

    #[test]
    fn every_number_is_finite_and_no_direction_zero() {
        for regime in &REGIMES {
            let mut random = Random::new(3);
            for _ in 0..200 {
                let spheres = scene(&regime.recipe, &mut random);
                assert!((1..=8).contains(&spheres.len()));
                assert!(spheres.iter().flatten().all(|x| x.is_finite()), "{}", regime.name);
                assert!(spheres.iter().all(|sphere| sphere[3] > 0.0), "{}", regime.name);
                let ray = ray(&regime.recipe, &spheres, &mut random);
                assert!(Vec3::from(ray.origin).is_finite(), "{}", regime.name);
                assert!(Vec3::from(ray.direction).is_finite(), "{}: {ray:?}", regime.name);
                assert!(ray.direction != [0.0; 3], "{}", regime.name);
            }
        }
    }

    #[test]
    fn rays_start_where_the_recipe_says() {
        let mut random = Random::new(4);
        for (name, tolerance) in [("on_surface", 1e-6), ("on_ground_1e7", 1e-6), ("far_1e6", 1e7)] {
            let recipe = &Regime::named(name).unwrap().recipe;
            let spheres = scene(recipe, &mut random);
            let origin = Vec3::from(ray(recipe, &spheres, &mut random).origin).as_dvec3();
            let gaps = spheres.iter().map(|&sphere| {
                let (center, radius) = center_and_radius(sphere);
                (origin.distance(center) / radius - 1.0).abs()
            });
            let gap = gaps.fold(f64::INFINITY, f64::min);
            assert!(
                gap < tolerance && (tolerance < 1.0 || gap > tolerance / 100.0),
                "{name}: {gap}"
            );
        }
    }
}
