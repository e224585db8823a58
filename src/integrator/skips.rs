//! What a render leaves out where it would change nothing.

/// Which work is left out where the picture is the same without it: all of it, but to measure what
/// that saves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is one independent saving")]
pub struct Skips {
    /// Tests of camera rays against spheres, in tiles in which no sphere can be seen.
    pub empty_tiles: bool,
    /// Whole paths, in such tiles where all that can be seen is an environment that is everywhere
    /// the same.
    pub even_background: bool,
    /// Samples of the lens, where the camera has none.
    pub lens: bool,
    /// Samples of lights, where there is none.
    pub lights: bool,
    /// Tests against a ground, where there is none.
    pub plane: bool,
    /// Room in each path for the glass that it is in, where that is one sphere at most.
    pub glass: bool,
    /// The search for the nearest of the spheres that hide a light, once one is found.
    pub nearest_occluder: bool,
}

impl Skips {
    /// Everything is left out that may be.
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

impl Default for Skips {
    fn default() -> Self {
        Self::ALL
    }
}
