//! Hashes of scenes, so that a scene can be compared with one that is no longer in memory.

use super::keys::{self, section_text};
use super::write::{self, sections};
use super::{EnvironmentMap, Scene};
use serde::{Deserialize, Serialize};
use std::fmt;

/// Values that are hashed at a time.
const CHUNK: usize = 1024;

/// Hashes of the parts of a scene: of everything that decides its picture except the settings.
///
/// Two scenes of the same identity render to the same bits, whatever their files and the names of their
/// materials: BLAKE3 is collision-resistant (O'Connor, Aumasson, Neves, Wilcox-O'Hearn, "BLAKE3",
/// 2020).
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Identity {
    spheres: [u8; 32],
    materials: [u8; 32],
    ground: [u8; 32],
    slices: [u8; 32],
    lights: [u8; 32],
    environment: [u8; 32],
    camera: [u8; 32],
    look: [u8; 32],
}

impl Identity {
    /// Hashes a scene. Takes about a second for a hundred million spheres.
    pub fn of(scene: &Scene) -> Self {
        let materials = scene.materials.iter().map(|row| keys::text(&row.material));
        let ground = scene.ground.as_ref().map_or(String::new(), |ground| {
            let normal = ground.normal.to_array();
            format!("{normal:?} {:?} {}", ground.height, ground.material)
        });
        let annotations = sections::annotations(&scene.annotations);
        let hash = |text: String| *blake3::hash(text.as_bytes()).as_bytes();
        Self {
            spheres: bodies(scene),
            materials: hash(materials.collect()),
            ground: hash(ground),
            slices: hash(scene.slices.iter().map(section_text).collect()),
            lights: hash(scene.lights.iter().map(section_text).collect()),
            environment: environment(scene),
            camera: hash(section_text(&scene.camera)),
            look: hash(sections::look(&scene.look) + &annotations),
        }
    }

    /// Returns the name of the first part in which two scenes differ.
    pub fn difference(&self, other: &Self) -> Option<&'static str> {
        let mut pairs = self.parts().into_iter().zip(other.parts());
        pairs.find(|((_, own), (_, theirs))| own != theirs).map(|((name, _), _)| name)
    }

    fn parts(&self) -> [(&'static str, &[u8; 32]); 8] {
        [
            ("spheres", &self.spheres),
            ("materials", &self.materials),
            ("ground", &self.ground),
            ("slices", &self.slices),
            // Lights of presets follow the camera.
            ("camera", &self.camera),
            ("lights", &self.lights),
            ("environment", &self.environment),
            ("look", &self.look),
        ]
    }
}

/// Formats the name and the first eight bytes of the hash of each part, as in `spheres 01ab...`,
/// separated by commas: enough to distinguish pictures by accident, not by malice.
impl fmt::Display for Identity {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, (name, hash)) in self.parts().into_iter().enumerate() {
            let comma = if index > 0 { ", " } else { "" };
            write!(formatter, "{comma}{name} ")?;
            hash.iter().take(8).try_for_each(|byte| write!(formatter, "{byte:02x}"))?;
        }
        Ok(())
    }
}

/// Hashes the spheres, and the other bodies if there are any.
fn bodies(scene: &Scene) -> [u8; 32] {
    let (spheres, mut hasher) = (&scene.spheres, blake3::Hasher::new());
    for column in [&spheres.x, &spheres.y, &spheres.z, &spheres.radius] {
        add(&mut hasher, column, |number| number.to_le_bytes());
    }
    add(&mut hasher, &spheres.material, |row| row.to_le_bytes());
    add(&mut hasher, &spheres.color, |color| {
        let [red, green, blue] = color.to_array().map(f32::to_le_bytes);
        let [[a, b, c, d], [e, f, g, h], [i, j, k, l]] = [red, green, blue];
        [a, b, c, d, e, f, g, h, i, j, k, l]
    });
    for bodies in scene.file_bodies() {
        hasher.update(sections::bodies(bodies, |row| row.to_string()).as_bytes());
    }
    *hasher.finalize().as_bytes()
}

fn environment(scene: &Scene) -> [u8; 32] {
    let mut hasher = blake3::Hasher::new();
    if let EnvironmentMap::Picture { image, up, rotation, scale } = &scene.environment.map {
        let (width, height, up) = (image.width, image.height, up.to_array());
        let lit = scene.environment.illuminates;
        let words = format!("{width} {height} {up:?} {rotation:?} {scale:?} {lit}");
        hasher.update(words.as_bytes());
        add(&mut hasher, image.pixels.as_flattened(), |value| value.to_le_bytes());
    } else {
        // All but pictures have a text form.
        let words = write::environment(&scene.environment, "");
        hasher.update(words.as_bytes());
    }
    *hasher.finalize().as_bytes()
}

/// Hashes the length of a column and its values.
fn add<T, const N: usize>(
    hasher: &mut blake3::Hasher,
    column: &[T],
    bytes: impl Fn(&T) -> [u8; N],
) {
    hasher.update(&(column.len() as u64).to_le_bytes());
    let mut buffer = Vec::with_capacity(CHUNK * N);
    for chunk in column.chunks(CHUNK) {
        buffer.clear();
        for value in chunk {
            buffer.extend_from_slice(&bytes(value));
        }
        hasher.update(&buffer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Image;
    use crate::scene::generate::default_scene;
    use crate::scene::{Environment, Ground, Light, Material, Rgb};
    use glam::DVec3;
    use std::sync::Arc;

    #[test]
    fn every_part_is_reported_by_its_name() {
        let scene = default_scene(1);
        let identity = Identity::of(&scene);
        let difference = |change: &dyn Fn(&mut Scene)| {
            let mut other = scene.clone();
            change(&mut other);
            identity.difference(&Identity::of(&other))
        };
        assert_eq!(difference(&|scene| scene.title.push('!')), None);
        assert_eq!(difference(&|scene| scene.settings.seed = 9), None);
        let next = |number: &mut f64| *number = number.next_up();
        assert_eq!(difference(&|scene| next(&mut scene.spheres.x[3])), Some("spheres"));
        assert_eq!(difference(&|scene| next(&mut scene.spheres.radius[9])), Some("spheres"));
        assert_eq!(difference(&|scene| scene.spheres.material[0] = 7), Some("spheres"));
        assert_eq!(difference(&|scene| scene.spheres.color[7] *= 0.5), Some("spheres"));
        let black = Material::Lambertian { color: Rgb::ZERO };
        assert_eq!(
            difference(&|scene| scene.materials[0].material = black.clone()),
            Some("materials")
        );
        let ground = Ground { normal: DVec3::Y, height: -7.0, material: 0 };
        assert_eq!(difference(&|scene| scene.ground = Some(ground.clone())), Some("ground"));
        let light = Light::Point { position: DVec3::X, intensity: Rgb::ONE, falloff: true };
        assert_eq!(difference(&|scene| scene.lights.push(light.clone())), Some("lights"));
        assert_eq!(difference(&|scene| next(&mut scene.camera.near)), Some("camera"));
        assert_eq!(difference(&|scene| scene.look.outline = true), Some("look"));
        let dark = |scene: &mut Scene| scene.environment.illuminates ^= true;
        assert_eq!(difference(&dark), Some("environment"));
    }

    #[test]
    fn texts_name_every_part_and_differ_with_it() {
        let scene = default_scene(1);
        let text = Identity::of(&scene).to_string();
        let parts: Vec<&str> = text.split(", ").collect();
        assert_eq!(parts.len(), 8);
        let camera = parts.iter().find(|part| part.starts_with("camera ")).unwrap();
        assert_eq!(camera.len(), "camera ".len() + 16);
        let mut other = scene;
        other.camera.near = 0.5;
        let other = Identity::of(&other).to_string();
        let differ: Vec<_> = parts.iter().zip(other.split(", ")).filter(|(a, b)| *a != b).collect();
        assert_eq!(differ.len(), 1);
        assert_eq!(differ[0].0, camera);
    }

    #[test]
    fn environment_maps_count_to_the_last_pixel() {
        let sky = |value, width| {
            let image = Arc::new(Image { width, height: 2, pixels: vec![[value; 3]; 4] });
            let map = EnvironmentMap::Picture { image, up: DVec3::Y, rotation: 0.0, scale: 1.0 };
            let environment = Environment { map, illuminates: true };
            Identity::of(&Scene { environment, ..Scene::default() })
        };
        assert_eq!(sky(0.5, 2), sky(0.5, 2));
        assert_eq!(sky(0.5, 2).difference(&sky(0.5_f32.next_up(), 2)), Some("environment"));
        assert_eq!(sky(0.5, 2).difference(&sky(0.5, 4)), Some("environment"));
    }
}
