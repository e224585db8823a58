//! What a world contains, and so which stages of a render exist.

use super::World;
use super::materials::Kind;
use super::parts::LeftOut;
use glam::DVec3;
use rayon::prelude::*;

/// Spheres that are nearer than this share of their coordinates are taken to touch.
const TOUCH: f64 = 1e-5;

/// What there is in a world. What is not, is not run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is one independent fact of the census")]
pub struct Features {
    /// Spheres of each kind of material, in the order of [`Kind::ALL`].
    pub spheres_by_kind: [u64; Kind::COUNT],
    /// Spheres too small for single precision beside the largest coordinate, left out.
    pub vanished: u64,
    /// Spheres that coincide with an earlier one, in a crowd about one center, left out.
    pub hidden: u64,
    /// Spheres that slices leave nothing of.
    pub cut_away: u64,
    /// Planes at which spheres end.
    pub cuts: u64,
    /// Whether the camera may be inside a sphere that is cut; looked for only where there are cuts.
    pub around_camera: bool,
    /// Spheres that the camera does not see, though they are there.
    pub unseen: u64,
    /// The ground's kind of material; `None` if there is no ground, and rays are not tested against
    /// it.
    pub ground_kind: Option<Kind>,
    /// Whether spheres have their own colors.
    pub colors: bool,
    /// Whether there is anything to sample for light: if not, there are no shadow rays.
    pub lights: bool,
    /// Whether rays start on a lens.
    pub lens: bool,
    /// Whether rays that escape see anything.
    pub environment: bool,
    /// Glass spheres that a camera ray may start in; empty if there are none, and then every ray
    /// starts outside.
    pub glass_at_camera: Vec<u32>,
    /// Whether a ray may be in more than one glass sphere at a time: some may touch or overlap, or
    /// one be in another.
    pub nested_glass: bool,
}

impl Features {
    /// Counts what there is in a world, beside the spheres of its scene that are not.
    pub(super) fn census(world: &World, left_out: LeftOut) -> Self {
        let mut spheres_by_kind = [0; Kind::COUNT];
        for row in 0..world.spheres.len() {
            spheres_by_kind[world.appearance.material.row(row).kind() as usize] += 1;
        }
        Self {
            spheres_by_kind,
            vanished: left_out.vanished,
            cut_away: left_out.cut_away,
            cuts: world.cut.len() as u64,
            around_camera: false,
            unseen: world
                .camera_visible
                .as_ref()
                .map_or(0, |visible| world.spheres.len() - visible.spheres.len())
                as u64,
            hidden: left_out.hidden,
            ground_kind: world.ground.map(|ground| ground.material.kind()),
            colors: world.appearance.color.is_some(),
            lights: !world.lights.is_empty(),
            lens: false,
            environment: !world.environment.is_black(),
            glass_at_camera: Vec::new(),
            nested_glass: nested_glass(world),
        }
        .seen_by(world)
    }

    /// The same for the camera that the world has now.
    pub(super) fn seen_by(self, world: &World) -> Self {
        Self {
            lens: world.camera.has_lens(),
            around_camera: around_camera(world),
            glass_at_camera: glass_at_camera(world),
            ..self
        }
    }

    /// Whether anything is made of this kind of material.
    pub fn has(&self, kind: Kind) -> bool {
        self.spheres_by_kind[kind as usize] > 0 || self.ground_kind == Some(kind)
    }

    /// What the render will do without, in words.
    pub fn skipped(&self) -> Vec<String> {
        let mut skipped = Vec::new();
        let mut skip = |absent: bool, what: &str| {
            if absent {
                skipped.push(what.to_owned());
            }
        };
        skip(self.cuts == 0, "no flat cuts: no ray is clipped");
        skip(self.ground_kind.is_none(), "no ground: no plane test");
        skip(!self.lights, "no lights to sample: no shadow rays");
        skip(!self.lens, "no lens: no lens samples");
        skip(!self.colors, "no colors of single spheres: no color column");
        skip(!self.environment, "black environment: rays that escape end without a look-up");
        skip(
            self.glass_at_camera.is_empty(),
            "no glass around the camera: every ray starts outside",
        );
        skip(!self.nested_glass, "no glass at or in other glass: no path keeps what it is in");
        for kind in Kind::ALL {
            skip(!self.has(kind), &format!("no {}: its shading stage does not run", kind.name()));
        }
        skipped
    }
}

/// Whether a sphere that is cut touches the ball in which camera rays start.
fn around_camera(world: &World) -> bool {
    let (at, reach) = world.camera.origins();
    let around = |row: usize| {
        let (center, radius) = world.spheres.exact(row);
        let near = center.distance(at) <= (radius + reach) * (1.0 + 1e-6);
        near && world.cut.divides(center, radius)
    };
    !world.cut.is_empty() && (0..world.spheres.len()).into_par_iter().any(around)
}

/// So many glass spheres are held against each other; more are taken to touch.
const HELD_TOGETHER: usize = 1024;

/// Whether glass spheres may touch, by far more than what rounding moves points of them.
fn nested_glass(world: &World) -> bool {
    let is_glass = |row: &usize| world.appearance.material.row(*row).kind() == Kind::Dielectric;
    if world.materials.dielectric.is_empty() {
        return false;
    }
    let rows = (0..world.spheres.len()).filter(is_glass).take(HELD_TOGETHER + 1);
    let glass: Vec<_> = rows.map(|row| world.spheres.exact(row)).collect();
    let apart = |(i, (center, radius)): (usize, &(DVec3, f64))| {
        glass[..i].iter().all(|(other, other_radius)| {
            let reach = radius + other_radius;
            let size = center.length() + other.length() + reach;
            center.distance(*other) > reach + size * TOUCH
        })
    };
    glass.len() > HELD_TOGETHER || !glass.iter().enumerate().all(apart)
}

/// Glass spheres that touch the ball in which camera rays start.
fn glass_at_camera(world: &World) -> Vec<u32> {
    if world.materials.dielectric.is_empty() {
        return Vec::new();
    }
    let (center, reach) = world.camera.origins();
    let is_glass =
        |row: &u32| world.appearance.material.row(*row as usize).kind() == Kind::Dielectric;
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

    /// Whether glass may be nested, of glass spheres along an axis; and of one that is not of
    /// glass, in the first.
    fn nested(spheres: &[(f64, f64)]) -> bool {
        let mut scene = Scene::default();
        let glass = Material::Dielectric { ior: 1.5, color: Rgb::ONE };
        let solid = Material::Lambertian { color: Rgb::ONE };
        scene.materials = [("glass", glass), ("solid", solid)]
            .map(|(name, material)| NamedMaterial { name: name.into(), material })
            .into();
        for (place, &(x, radius)) in spheres.iter().chain(&[(0.0, 0.1)]).enumerate() {
            let material = u32::from(place == spheres.len());
            scene.spheres.push(DVec3::X * x, radius, material, Rgb::ONE);
        }
        World::build(&scene).unwrap().features.nested_glass
    }

    #[test]
    fn glass_is_nested_where_it_touches_glass() {
        assert!(!nested(&[(0.0, 1.0)]));
        assert!(!nested(&[(0.0, 1.0), (2.1, 1.0), (-3.0, 1.5)]));
        assert!(nested(&[(0.0, 1.0), (2.0, 1.0)]), "touching");
        assert!(nested(&[(0.0, 1.0), (5.0, 0.1), (0.3, 0.2)]), "inside");
        assert!(nested(&[(0.0, 1.0), (-1.5, 1.0)]), "overlapping");
        // What rounding moves a point by is more than lies between.
        assert!(nested(&[(0.0, 1.0), (1e6, 1e-3), (1e6 + 3e-3, 1e-3)]));
    }
}
