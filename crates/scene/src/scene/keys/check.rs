//! Checks of the ranges of keys in scenes that were built in code.

use super::{EnvironmentKeys, GroundKeys, Key, Kind, Section, Visitor};
use crate::scene::{Camera, Light, NamedMaterial, Scene};
use std::fmt::Debug;

/// Checks that values are in range.
struct Checker<F> {
    /// The words for the key of a name.
    whose: F,
    result: Result<(), String>,
}

impl<F: Fn(&str) -> String> Visitor for Checker<F> {
    fn visit<T: Debug>(&mut self, key: Key, kind: impl Kind<T>, value: &mut T) {
        self.check(key.name, kind, value);
    }

    fn check<T: Debug>(&mut self, name: &str, kind: impl Kind<T>, value: &T) {
        if self.result.is_ok() && !kind.contains(value) {
            let (whose, value, range) = ((self.whose)(name), kind.brief(value), kind.words().range);
            self.result = Err(format!("{whose} is {value}, but must be {range}"));
        }
    }
}

/// Checks a section; `whose` puts the section into words, as in "the camera's `KEY`".
fn check(section: &impl Section, whose: impl Fn(&str) -> String) -> Result<(), String> {
    let mut checker = Checker { whose, result: Ok(()) };
    section.clone().visit(&mut checker);
    checker.result
}

/// Checks the ranges of a camera that was built in code.
///
/// # Errors
///
/// The message says what is out of range.
pub fn check_camera(camera: &Camera) -> Result<(), String> {
    check(camera, |key| format!("the camera's `{key}`"))
}

/// Checks the ranges of all sections of a scene that was built in code, but for settings, bodies and
/// annotations.
///
/// # Errors
///
/// The message says what is out of range.
pub fn check_sections(scene: &Scene) -> Result<(), String> {
    check_camera(&scene.camera)?;
    for NamedMaterial { name, material } in &scene.materials {
        check(material, |key| format!("`{key}` of the material \"{name}\""))?;
    }
    for light in &scene.lights {
        let whose = match light {
            Light::Sun { .. } => "a sun",
            Light::Point { .. } => "a point light",
        };
        check(light, |key| format!("the `{key}` of {whose}"))?;
    }
    for slice in &scene.slices {
        check(slice, |key| format!("the `{key}` of a slice"))?;
    }
    let environment =
        EnvironmentKeys { environment: scene.environment.clone(), file: String::new() };
    check(&environment, |key| format!("the environment's `{key}`"))?;
    if let Some(ground) = scene.ground.clone() {
        check(&GroundKeys { ground, material: None }, |key| format!("the ground's `{key}`"))?;
    }
    check(&scene.look, |key| format!("the look's `{key}`"))
}
