//! Hard scenes: degenerate, huge, tiny, far away, nested, empty, unlimited.

mod degenerate;
mod equality;
mod invalid;
mod limits;
mod surfaces;
mod transforms;
