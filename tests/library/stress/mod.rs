//! Scenes made to break a renderer: degenerate, gigantic, tiny, far away, nested, empty, endless.

mod degenerate;
mod equality;
mod invalid;
mod limits;
mod surfaces;
mod transforms;
