//! Spheres that a generator makes, and what may be wrong with its parameters.

use crate::scene::{NamedMaterial, Spheres};
use thiserror::Error;

/// Spheres and their materials.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// The spheres; materials are rows of `materials`.
    pub spheres: Spheres,
    /// Materials; empty if all spheres have one material that the scene chooses.
    pub materials: Vec<NamedMaterial>,
}

/// A parameter that is out of range, or that asks for too many spheres.
#[derive(Clone, Debug, Error, PartialEq, Eq)]
#[error("{parameter}: {message}")]
pub struct GenerateError {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// Requirement that the parameter violates.
    pub message: String,
}

/// Returns an error unless the condition holds.
pub(super) fn require(
    condition: bool,
    parameter: &'static str,
    message: impl Into<String>,
) -> Result<(), GenerateError> {
    if condition { Ok(()) } else { Err(GenerateError { parameter, message: message.into() }) }
}

/// Returns an error unless the radius is finite and more than 0.
pub(super) fn require_radius(radius: f64) -> Result<(), GenerateError> {
    require(radius.is_finite() && radius > 0.0, "radius", "must be finite and more than 0")
}

/// Returns an error unless the pair is a range of radii.
pub(super) fn require_radii([least, greatest]: [f64; 2]) -> Result<(), GenerateError> {
    let message = "must be [least, greatest], finite, more than 0 and in this order";
    require(least > 0.0 && least <= greatest && greatest.is_finite(), "radius", message)
}

/// Reserves memory for `count` spheres, after checking the count.
pub(super) fn reserve_spheres(
    count: u64,
    parameter: &'static str,
) -> Result<Spheres, GenerateError> {
    let most = Spheres::MAX;
    let message = if count == u64::MAX {
        format!("asks for more than 1e19 spheres; a scene holds at most {most}")
    } else {
        format!("asks for {count} spheres; a scene holds 1 to {most}")
    };
    require((1..=most).contains(&count), parameter, message)?;
    let mut spheres = Spheres::default();
    let reserved = usize::try_from(count).is_ok_and(|count| spheres.try_reserve(count).is_ok());
    require(reserved, parameter, format!("asks for {count} spheres, more than memory holds"))?;
    Ok(spheres)
}
