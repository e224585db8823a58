//! Groups of options that commands share, and the parsers of their values.

pub(super) mod annotations;
pub(super) mod appearance;
pub(super) mod checkpoints;
pub(super) mod frames;
pub(super) mod image;
pub(super) mod lists;
pub(super) mod memory;
pub(super) mod names;
pub(super) mod part;
pub(super) mod particles;
pub(super) mod sequences;
pub(super) mod settings;
pub(super) mod slices;
pub(super) mod style;
pub(super) mod values;
pub(super) mod views;
mod with_text;
