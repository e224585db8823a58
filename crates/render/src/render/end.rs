//! Reasons why a render ends.

use serde::{Deserialize, Serialize};

/// The reason why a render ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum End {
    /// Every pixel has the maximum number of samples.
    Samples,
    /// The error is below the target.
    Error,
    /// The time limit is reached.
    Time,
    /// It was cancelled, or never started.
    Cancelled,
}
