//! The last scene of a book (Shirley, Black, Hollasch, "Ray Tracing in One Weekend", 2016-2024).

use super::Group;
use super::random::Random;
use crate::scene::{ConductorFresnel, Material, NamedMaterial, Rgb};
use glam::DVec3;

/// About 485 small spheres around three large ones on a very large one. The book's positions come from
/// an unspecified random generator; these come from ours.
///
/// The book's `fuzz` becomes GGX roughness: similar in appearance, not in value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Weekend;

const DIFFUSE: u32 = 0;
const GLASS: u32 = 1;
const MIRROR: u32 = 2;

impl Weekend {
    /// Number of spheres if none of the small ones were omitted for being too near to a large one.
    pub(super) const MAX_COUNT: u64 = 22 * 22 + 4;

    pub(super) fn generate(seed: u64) -> Group {
        let mut group = Group { materials: materials(), ..Group::default() };
        let mut random = Random::new(seed);
        let ground = DVec3::new(0.0, -1000.0, 0.0);
        group.spheres.push(ground, 1000.0, DIFFUSE, Rgb::splat(0.5));
        for column in -11..11 {
            for row in -11..11 {
                let choice = random.unit();
                let [x, z] = [column, row].map(|cell| f64::from(cell) + 0.9 * random.unit());
                let center = DVec3::new(x, 0.2, z);
                if center.distance(DVec3::new(4.0, 0.2, 0.0)) > 0.9 {
                    push_small(&mut group, &mut random, center, choice);
                }
            }
        }
        let spheres = &mut group.spheres;
        spheres.push(DVec3::new(0.0, 1.0, 0.0), 1.0, GLASS, Rgb::ONE);
        spheres.push(DVec3::new(-4.0, 1.0, 0.0), 1.0, DIFFUSE, Rgb::new(0.4, 0.2, 0.1));
        spheres.push(DVec3::new(4.0, 1.0, 0.0), 1.0, MIRROR, Rgb::new(0.7, 0.6, 0.5));
        group
    }
}

/// Appends a small sphere; `choice` in 0..1 decides its material.
fn push_small(group: &mut Group, random: &mut Random, center: DVec3, choice: f64) {
    let (material, color) = if choice < 0.8 {
        (DIFFUSE, random.rgb(0.0, 1.0) * random.rgb(0.0, 1.0))
    } else if choice < 0.95 {
        let color = random.rgb(0.5, 1.0);
        let row = group.materials.len() as u32;
        group.materials.push(metal(format!("weekend-metal-{row}"), random.between(0.0, 0.5)));
        (row, color)
    } else {
        (GLASS, Rgb::ONE)
    };
    group.spheres.push(center, 0.2, material, color);
}

fn metal(name: String, roughness: f64) -> NamedMaterial {
    let fresnel = ConductorFresnel::Constant(Rgb::ONE);
    NamedMaterial { name, material: Material::Conductor { fresnel, roughness } }
}

/// Returns the materials that several spheres use.
fn materials() -> Vec<NamedMaterial> {
    let named = |name: &str, material| NamedMaterial { name: name.to_owned(), material };
    vec![
        named("weekend-diffuse", Material::Lambertian { color: Rgb::ONE }),
        named("weekend-glass", Material::Dielectric { ior: 1.5, color: Rgb::ONE }),
        metal("weekend-mirror".to_owned(), 0.0),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spheres_are_the_books() {
        let Group { spheres, materials } = Weekend::generate(1);
        let small: Vec<usize> =
            (0..spheres.len()).filter(|&row| spheres.radius[row] == 0.2).collect();
        assert_eq!(small.len() + 4, spheres.len());
        assert!((470..=Weekend::MAX_COUNT as usize).contains(&spheres.len()));
        let large = DVec3::new(4.0, 0.2, 0.0);
        for &row in &small {
            let center = spheres.center(row);
            assert!(center.y == 0.2 && center.distance(large) > 0.9);
            assert!((-11.0..10.9).contains(&center.x) && (-11.0..10.9).contains(&center.z));
        }
        let diffuse = small.iter().filter(|&&row| spheres.material_of(row) == DIFFUSE).count();
        assert!((340..=430).contains(&diffuse), "{diffuse}");
        assert!(materials.iter().all(|row| match row.material {
            Material::Conductor { roughness, .. } => (0.0..0.5).contains(&roughness),
            _ => true,
        }));
    }
}
