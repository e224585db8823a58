//! Reasons why columns cannot be used.

use crate::spheres::Spheres;

/// The reason why a tree cannot be built, or columns cannot be traced.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum QueryError {
    /// Columns differ in length.
    #[error("the columns differ in length: one has {expected} rows and another {found}")]
    Lengths {
        /// Length of the first column.
        expected: usize,
        /// Length of another column.
        found: usize,
    },
    /// Rows are numbers of 32 bits.
    #[error("{0} spheres are too many: at most {max} fit", max = Spheres::MAX)]
    TooMany(usize),
}
