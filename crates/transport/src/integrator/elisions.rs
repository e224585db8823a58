//! Elisions: work that may be omitted without changing the image.

/// Work that is omitted where the image is the same without it. All of it, except in measurements of
/// what each elision saves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is one independent saving")]
pub struct Elisions {
    /// Tests of camera rays against spheres, in tiles in which no sphere is visible.
    pub empty_tiles: bool,
    /// Whole paths, in such tiles where only a constant environment is visible.
    pub even_background: bool,
    /// Samples of the lens, if the camera has none.
    pub lens: bool,
    /// Light samples, if there is no light.
    pub lights: bool,
    /// Tests against the ground, if there is none.
    pub plane: bool,
    /// Interior lists of paths, if no path can be in more than one glass sphere.
    pub glass: bool,
    /// The search for the nearest occluder, once a shadow ray has found one.
    pub nearest_occluder: bool,
}

impl Elisions {
    /// Omits all of it.
    pub const ALL: Self = Self {
        empty_tiles: true,
        even_background: true,
        lens: true,
        lights: true,
        plane: true,
        glass: true,
        nearest_occluder: true,
    };
}

impl Default for Elisions {
    fn default() -> Self {
        Self::ALL
    }
}
