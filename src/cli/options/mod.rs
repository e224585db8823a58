//! Groups of options that commands share.

pub(super) mod picture;
pub(super) mod settings;
