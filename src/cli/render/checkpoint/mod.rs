//! Checkpoints of unfinished renders: the command line that they store, their files, and resuming.

pub(super) mod invocation;
pub(super) mod resume;
pub(super) mod writer;
