//! Keys that several sections have.

use super::kinds::Optional;
use super::kinds::Str::Name;
use super::{Visitor, key};
use crate::scene::Rgb;
use crate::settings::Limits::Share;

/// The advice for a missing radius.
pub(in crate::scene) const RADIUS: &str = "radius = a number greater than 0";

/// Visits the key of a material, whose name is in quotes.
pub(super) fn material<V: Visitor>(keys: &mut V, name: &mut Option<String>, help: &'static str) {
    keys.visit(key("material", help).or("`default`"), Optional(Name), name);
}

/// Visits the key of the material of a body that is no sphere.
pub(in crate::scene) fn solid<V: Visitor>(keys: &mut V, name: &mut Option<String>) {
    material(keys, name, "material, not glass and not an emitter");
}

/// Visits the key of a body's color.
pub(in crate::scene) fn color<V: Visitor>(keys: &mut V, color: &mut Rgb) {
    keys.visit(key("color", "factor for the material's color"), Share, color);
}
