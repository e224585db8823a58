//! Progress of a render that is saved in a file, without its sums.

use super::part::ImagePart;
use crate::film::Region;
use crate::scene::Settings;
use std::time::Duration;

/// Progress of a render that is saved in a file.
#[derive(Clone, Debug)]
pub struct Status {
    /// Settings of the whole render.
    pub settings: Settings,
    /// The rendered region of the image.
    pub region: Region,
    /// The samples and tiles of this file's part.
    pub part: ImagePart,
    /// True if sums of squares are kept.
    pub statistics: bool,
    /// Samples so far, of all pixels.
    pub samples: u64,
    /// Samples of the complete part; an upper limit if the render has a target.
    pub wanted: u64,
    /// True if the part is complete.
    pub complete: bool,
    /// Rendering time, without reading the scene and building the tree.
    pub elapsed: Duration,
}
