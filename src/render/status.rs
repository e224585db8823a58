//! Progress of a render that is kept in a file, without its sums.

use super::part::ImagePart;
use crate::film::Region;
use crate::scene::Settings;
use std::time::Duration;

/// Progress of a render that is kept in a file.
#[derive(Clone, Debug)]
pub struct Status {
    /// Settings of the whole render.
    pub settings: Settings,
    /// The part of the picture that the whole render renders.
    pub region: Region,
    /// The samples and tiles that this file is to have.
    pub part: ImagePart,
    /// Whether sums of squares are kept.
    pub statistics: bool,
    /// Samples that there are, of all pixels.
    pub samples: u64,
    /// Samples that there are to be; at most so many where the render has a target.
    pub wanted: u64,
    /// Whether all that was asked for is there.
    pub complete: bool,
    /// Time that rendering has taken, without reading the scene and building the tree.
    pub elapsed: Duration,
}
