//! Sections of a scene file beside particles, whose keys override what the style of the particles gives.

use super::Staged;
use crate::scene::{Camera, Look, Pose, Scene, Settings};
use crate::settings::{Paper, SETTINGS, Setting, Value};
use std::collections::HashMap;

/// Sections of a scene file.
#[derive(Clone, Debug)]
pub struct Sections {
    /// The scene that they are.
    pub scene: Scene,
    /// The keys of each section that is given.
    pub keys: HashMap<String, Vec<String>>,
}

impl Sections {
    fn has(&self, section: &str) -> bool {
        self.keys.contains_key(section)
    }

    fn keys_of(&self, section: &str) -> &[String] {
        self.keys.get(section).map_or(&[], Vec::as_slice)
    }

    fn has_key(&self, section: &str, key: &str) -> bool {
        self.keys_of(section).iter().any(|own| own == key)
    }

    /// Overrides the look by the keys that are given.
    pub(super) fn set_look(&self, look: &mut Look) {
        if !self.has("look") {
            return;
        }
        let given = &self.scene.look;
        if self.has_key("look", "background") {
            look.background = given.background;
        }
        if self.has_key("look", "depth_cue") {
            look.depth_cue = given.depth_cue;
        }
        if self.has_key("look", "outline") {
            look.outline = given.outline;
        }
        look.cell = given.cell;
    }

    /// Overrides the settings that are given.
    pub(super) fn set_settings(&self, settings: &mut Settings) {
        change(settings, &self.scene.settings, self.keys_of("render"));
    }

    /// Returns whether they say where the camera is.
    pub(super) fn places_camera(&self) -> bool {
        ["eye", "target", "direction"].iter().any(|key| self.has_key("camera", key))
    }

    /// Sets the properties of the camera that are given.
    pub(super) fn set_camera(&self, camera: &mut Camera) {
        let given = &self.scene.camera;
        let has = |names: &[&str]| names.iter().any(|key| self.has_key("camera", key));
        if has(&["projection", "fov", "height"]) {
            camera.projection = given.projection;
        }
        if self.places_camera() {
            (camera.pose, camera.up) = (given.pose, given.up);
        } else if has(&["margin"])
            && let (Pose::Fit { margin, .. }, Pose::Fit { margin: own, .. }) =
                (&mut camera.pose, given.pose)
        {
            *margin = own;
        }
        if has(&["up"]) {
            camera.up = given.up;
        }
        if has(&["aperture", "focus"]) {
            camera.lens = given.lens;
        }
        if has(&["near"]) {
            camera.near = given.near;
        }
        if has(&["zoom"]) {
            camera.zoom = given.zoom;
        }
        if has(&["center", "radius"]) {
            camera.framed = given.framed;
        }
        if has(&["insets"]) {
            camera.insets = given.insets;
        }
    }

    /// Returns whether they say what lights the scene.
    pub(super) fn lights_scene(&self) -> bool {
        ["light", "environment", "ground"].into_iter().any(|section| self.has(section))
    }

    /// Replaces what lights the scene.
    pub(super) fn set_lights(&self, scene: &mut Scene) {
        scene.lights.clone_from(&self.scene.lights);
        scene.environment = self.scene.environment.clone();
        scene.ground = self.scene.ground.clone().map(|mut ground| {
            ground.material = self.material_row(scene, ground.material);
            ground
        });
    }

    /// Adds their bodies and materials to a scene of `count` particles, whose camera is chosen, and their rows, which
    /// follow those of the particles: spheres, sticks and ellipsoids.
    pub fn append_bodies(&self, staged: &mut Staged, count: usize) {
        let Staged { scene, rows, ellipsoid_rows, .. } = staged;
        if !self.scene.is_empty() {
            self.append_to(scene);
        }
        let Some(rows) = rows else { return };
        let mut next = count;
        let mut number = |more: usize| {
            next += more;
            (next - more..next).map(|row| row as u32)
        };
        rows.extend(number(scene.spheres.len() - rows.len()));
        if let Some(own) = ellipsoid_rows.take().filter(|rows| !rows.is_empty()) {
            let more = scene.ellipsoids.len() - own.len();
            rows.extend(number(scene.sticks.len()));
            rows.extend(own);
            rows.extend(number(more));
        }
    }

    fn append_to(&self, scene: &mut Scene) {
        let count = self.scene.materials.len() as u32;
        let rows: Vec<u32> = (0..count).map(|row| self.material_row(scene, row)).collect();
        let row_of = |material: u32| rows.get(material as usize).copied().unwrap_or(0);
        scene.spheres.append(self.scene.spheres.clone(), &rows);
        scene.append_bodies(&self.scene, row_of);
    }

    /// The row in `scene` of a material of the sections, which is added if it is not there.
    fn material_row(&self, scene: &mut Scene, row: u32) -> u32 {
        let Some(material) = self.scene.materials.get(row as usize) else { return 0 };
        let found = scene.materials.iter().position(|own| own.name == material.name);
        let place = found.unwrap_or_else(|| {
            scene.materials.push(material.clone());
            scene.materials.len() - 1
        });
        place as u32
    }
}

/// Overrides settings with those of these names.
pub fn change(settings: &mut Settings, given: &Settings, keys: &[String]) {
    let named = SETTINGS.iter().filter(|setting| keys.iter().any(|key| key == setting.name));
    let value = |setting: &Setting| match given.paper() {
        Some(Paper { width, height, keeps_aspect }) if setting.name == "size" => {
            Value::Paper { width, height: (!keeps_aspect).then_some(height) }
        }
        _ => setting.get(given),
    };
    let values: Vec<_> = named.map(|setting| (setting.name, value(setting))).collect();
    settings.change(&values);
}
