//! The processor level of this module, and what the processor has.

use pyo3::prelude::*;
use spherule_levels::Level;

/// The level that this module is compiled for, as `v3`.
#[pyfunction]
pub(crate) fn compiled_level() -> &'static str {
    Level::compiled().name()
}

/// The levels of packages, highest first.
#[pyfunction]
pub(crate) fn packaged_levels() -> Vec<&'static str> {
    Level::PACKAGED.iter().map(|level| level.name()).collect()
}

/// The instruction sets of a level that the processor lacks; `None` for an unknown level.
#[pyfunction]
pub(crate) fn missing_features(level: &str) -> Option<Vec<&'static str>> {
    Level::from_name(level).map(Level::missing)
}
