//! Particles that are ellipsoids, as ellipsoids of the scene.

use super::Particles;
use crate::scene::{Ellipsoids, NamedMaterial};

impl Particles {
    /// Takes the particles that are ellipsoids out of the spheres; `materials` are those of the scene, and `rows` the row there of
    /// each material of the particles; warnings name `source`.
    ///
    /// Materials that only spheres can have are replaced by the first one, with a warning.
    pub(in crate::scene) fn take_ellipsoids(
        &mut self,
        materials: &[NamedMaterial],
        rows: &[u32],
        source: &str,
    ) -> Ellipsoids {
        let mut ellipsoids = Ellipsoids::default();
        if self.frame.shapes.is_empty() {
            return ellipsoids;
        }
        let mut keep = vec![true; self.spheres.len()];
        let mut replaced = 0_u64;
        for (row, keep) in keep.iter_mut().enumerate() {
            *keep = self.frame.shapes.is_sphere(row);
            if *keep {
                continue;
            }
            let own = rows.get(self.spheres.material_of(row) as usize).copied().unwrap_or(0);
            let is_solid =
                materials.get(own as usize).is_none_or(|named| named.material.is_solid());
            replaced += u64::from(!is_solid);
            ellipsoids.push(
                self.spheres.center(row),
                self.frame.shapes.semi_axes[row] * self.spheres.radius[row],
                self.frame.shapes.orientation_of(row),
                if is_solid { own } else { 0 },
                self.spheres.color_of(row),
            );
        }
        if replaced > 0 {
            let warning = format!(
                "{source}: {replaced} ellipsoids cannot be glass or emitters, and have another material"
            );
            self.frame.warnings.push(warning);
        }
        self.retain(&keep);
        ellipsoids
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::particles::{Particles, Shapes};
    use crate::scene::{Rgb, Scene};
    use glam::{DQuat, DVec3};

    #[test]
    fn particles_with_shapes_become_ellipsoids_of_their_radius_and_color() {
        let turned = DQuat::from_rotation_x(1.0);
        let mut particles = Particles::default();
        for (x, radius) in [(1.0, 2.0), (2.0, 3.0), (5.0, 4.0)] {
            particles.spheres.push(DVec3::X * x, radius, 0, Rgb::X * x as f32);
        }
        let axes = DVec3::new(0.5, 1.0, 0.25);
        particles.frame.shapes = Shapes {
            semi_axes: vec![axes, DVec3::ONE, axes],
            orientation: vec![DQuat::IDENTITY, DQuat::IDENTITY, turned],
        };
        let scene = Scene::of_particles(particles.clone(), "");
        assert_eq!(scene.spheres.radius, [3.0]);
        let own = &scene.ellipsoids;
        assert_eq!(own.center, [DVec3::X, DVec3::X * 5.0]);
        assert_eq!(own.semi_axes, [axes * 2.0, axes * 4.0]);
        assert_eq!(own.orientation, [DQuat::IDENTITY, turned]);
        assert_eq!(own.color, [Rgb::X, Rgb::X * 5.0]);
        assert!(scene.warnings.is_empty());

        particles.material_names = vec!["glass".to_owned()];
        let scene = Scene::of_particles(particles.clone(), "file");
        assert_eq!(scene.ellipsoids.material, [0, 0]);
        assert!(scene.warnings[0].starts_with("file: 2 ellipsoids"), "{:?}", scene.warnings);
    }
}
