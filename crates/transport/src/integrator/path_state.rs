//! Path states: the data that a path carries from bounce to bounce.

use super::columns::{WordColumns, float_bits};
use crate::lanes::{F32x16, Lanes, Packing, U32x16};
use crate::sampling::SobolPositions;
use crate::vec3::Vec3;

/// States of paths that are alive, in columns, with one row per ray.
#[derive(Clone, Debug, Default)]
pub struct PathStates {
    columns: WordColumns<COLUMNS>,
    /// True if normals of the last surfaces are stored.
    normals: bool,
}

/// Index of the path.
const PATH: usize = 0;
/// Position in the sample sequence, as [`SobolPositions`]: two columns.
const SEQUENCE: usize = 1;
/// Throughput, by channel.
const THROUGHPUT: usize = 3;
/// [`PreviousBounce`].
const PREVIOUS: usize = 6;
/// Normal of the last surface, on the side that was lit; the choice of a light depends on it.
const NORMAL: usize = 7;
const COLUMNS: usize = 10;

/// States of sixteen paths.
#[derive(Clone, Copy, Debug)]
pub struct PathStateRow {
    /// Indices of the paths.
    pub path: U32x16,
    /// Throughput, by channel: the product of the BSDF weights so far.
    pub throughput: Vec3<F32x16>,
    /// Positions in the sample sequences.
    pub sequence: SobolPositions,
    /// Previous bounces, for MIS weights.
    pub previous: PreviousBounce<F32x16>,
    /// Normals of the last surfaces; arbitrary if they are not stored.
    pub normal: Vec3<F32x16>,
}

impl PathStates {
    /// Creates columns, with normals of the last surfaces if `normals`.
    pub(super) fn new(normals: bool) -> Self {
        Self { normals, ..Self::default() }
    }

    /// Returns the index of the path in row `i`.
    #[inline(always)]
    pub fn path(&self, i: usize) -> usize {
        self.columns.word(PATH, i) as usize
    }

    /// Returns the throughput of the path in row `i`.
    pub fn throughput(&self, i: usize) -> glam::Vec3 {
        self.columns.vector(THROUGHPUT, i)
    }

    /// Returns the place in the Sobol sequence of the path in row `i`.
    pub(super) fn sequence_place(&self, i: usize) -> u32 {
        self.columns.word(SEQUENCE, i)
    }

    /// Returns the previous bounce of the path in row `i`.
    pub(super) fn previous(&self, i: usize) -> PreviousBounce<f32> {
        PreviousBounce(self.columns.float(PREVIOUS, i))
    }

    /// Returns the normal of the last surface of the path in row `i`; arbitrary if it is not stored.
    pub(super) fn last_normal(&self, i: usize) -> glam::Vec3 {
        self.columns.vector(NORMAL, i)
    }

    /// Broadcasts row `i` to all lanes.
    pub(super) fn broadcast(&self, i: usize) -> PathStateRow {
        let PathStateRow { previous, .. } = self.load(i);
        let word = |column| U32x16::splat(self.columns.word(column, i));
        let splat = |v: glam::Vec3| Vec3::splat(v.x, v.y, v.z);
        PathStateRow {
            path: word(PATH),
            throughput: splat(self.throughput(i)),
            sequence: SobolPositions { positions: word(SEQUENCE), seeds: word(SEQUENCE + 1) },
            previous: PreviousBounce(F32x16::splat(previous.0.to_array()[0])),
            normal: splat(self.last_normal(i)),
        }
    }

    /// Loads rows `first..first + 16`.
    #[inline(always)]
    pub(super) fn load(&self, first: usize) -> PathStateRow {
        let columns = &self.columns;
        PathStateRow {
            path: columns.words(PATH, first),
            throughput: columns.vectors(THROUGHPUT, first),
            sequence: self.sequence(first),
            previous: PreviousBounce(columns.floats(PREVIOUS, first)),
            normal: columns.vectors(NORMAL, first),
        }
    }

    /// Loads the positions in the sample sequences of rows `first..first + 16`.
    #[inline(always)]
    fn sequence(&self, first: usize) -> SobolPositions {
        let [positions, seeds] = [SEQUENCE, SEQUENCE + 1].map(|c| self.columns.words(c, first));
        SobolPositions { positions, seeds }
    }

    /// Writes the lanes of a row that `packing` selects to rows from `first` on; the rest of sixteen
    /// rows gets arbitrary values.
    #[inline(always)]
    pub(super) fn pack(&mut self, first: usize, packing: &Packing, row: &PathStateRow) {
        let (sequence, throughput) = (&row.sequence, row.throughput.map(float_bits));
        let rows = [
            row.path,
            sequence.positions,
            sequence.seeds,
            throughput.x,
            throughput.y,
            throughput.z,
            float_bits(row.previous.0),
        ];
        self.columns.pack(PATH, first, packing, rows);
        if self.normals {
            let Vec3 { x, y, z } = row.normal.map(float_bits);
            self.columns.pack(NORMAL, first, packing, [x, y, z]);
        }
    }

    /// Writes the positions in the sample sequences of rows `first..first + 16`.
    #[inline(always)]
    pub(super) fn set_sequence(
        &mut self,
        first: usize,
        SobolPositions { positions, seeds }: &SobolPositions,
    ) {
        self.columns.store(first, [(SEQUENCE, *positions), (SEQUENCE + 1, *seeds)]);
    }

    /// Initializes the states of rows `first..first + 16`, whose samples have been started: the indices
    /// of the paths are their rows.
    #[inline(always)]
    pub(super) fn init_camera(&mut self, first: usize) -> PathStateRow {
        let one = F32x16::splat(1.0);
        let row = PathStateRow {
            path: U32x16::new(std::array::from_fn(|lane| (first + lane) as u32)),
            throughput: Vec3::new(one, one, one),
            sequence: self.sequence(first),
            previous: PreviousBounce::camera(),
            normal: Vec3::splat(0.0, 0.0, 0.0),
        };
        let (one, previous) = (float_bits(one), float_bits(row.previous.0));
        let throughput = [0, 1, 2].map(|channel| (THROUGHPUT + channel, one));
        self.columns.store(first, throughput);
        self.columns.store(first, [(PATH, row.path), (PREVIOUS, previous)]);
        row
    }

    /// Sets all channels of the throughput of the path in row `i`.
    pub(super) fn set_throughput(&mut self, i: usize, throughput: f32) {
        for channel in 0..3 {
            self.columns.set(THROUGHPUT + channel, i, throughput.to_bits());
        }
    }

    /// Sets the index of the path in a row.
    #[cfg(test)]
    pub(super) fn set_path(&mut self, i: usize, path: u32) {
        self.columns.set(PATH, i, path);
    }
}

/// The previous bounce of a path, or of a row of them: decides the MIS weight of light that the ray
/// hits.
///
/// The value is the density of the ray's direction by solid angle. It is negative if the last surface
/// was diffuse: there light samples alone count for lights that are not close. It is infinite if no
/// light sample could have found the direction, from the camera or a specular surface, and negative
/// infinity if the path has met only specular surfaces since the camera. The largest finite values stand
/// for infinite ones where a specular surface has sampled the lights in the mirrored direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PreviousBounce<L>(pub L);

impl<L: Lanes> PreviousBounce<L> {
    /// Returns the value of camera rays.
    #[inline(always)]
    pub fn camera() -> Self {
        Self(L::splat(f32::NEG_INFINITY))
    }

    /// Returns the densities; infinite if no light sample could have found the direction.
    #[inline(always)]
    pub fn density(self) -> L {
        self.0.abs()
    }

    /// Returns the lanes in which a light sample could have found the direction.
    #[inline(always)]
    pub fn light_sampled(self) -> L::Mask {
        self.density().lt(L::splat(f32::MAX))
    }

    /// Returns the lanes in which the last surface was diffuse.
    #[inline(always)]
    pub fn after_diffuse(self) -> L::Mask {
        self.0.lt(L::splat(0.0)) & self.light_sampled()
    }

    /// Returns the lanes whose paths have met only specular surfaces since the camera.
    #[inline(always)]
    pub fn specular_only(self) -> L::Mask {
        self.0.le(L::splat(-f32::MAX))
    }

    /// Returns the lanes in which the last surface mirrored the ray, and sampled the lights in its
    /// direction.
    #[inline(always)]
    pub fn mirrored_light_sampled(self) -> L::Mask {
        let density = self.density();
        density.lt(L::splat(f32::INFINITY)) & L::splat(f32::MAX).le(density)
    }

    /// Marks lanes in which the last surface mirrored the ray, and sampled the lights in its direction.
    #[inline(always)]
    pub fn with_mirrored_light(self, lanes: L::Mask) -> Self {
        let marked = self.0.max(L::splat(-f32::MAX)).min(L::splat(f32::MAX));
        Self(L::select(lanes, marked, self.0))
    }

    /// Returns the value after one more bounce with these densities, 0 for specular ones.
    #[inline(always)]
    pub fn next(self, density: L, diffuse: bool) -> Self {
        let infinite = L::splat(f32::INFINITY);
        let mirrored = L::select(self.specular_only(), -infinite, infinite);
        let scattered = L::splat(0.0).lt(density);
        Self(L::select(scattered, if diffuse { -density } else { density }, mirrored))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_value_encodes_the_previous_bounce() {
        let properties = |previous: PreviousBounce<f32>| {
            (
                previous.light_sampled(),
                previous.after_diffuse(),
                previous.specular_only(),
                previous.density(),
            )
        };
        let none = f32::INFINITY;
        let camera = PreviousBounce::camera();
        assert_eq!(properties(camera), (false, false, true, none));
        assert_eq!(properties(camera.next(0.0, false)), (false, false, true, none));
        let rough = camera.next(2.0, false);
        assert_eq!(properties(rough), (true, false, false, 2.0));
        assert_eq!(properties(rough.next(0.0, false)), (false, false, false, none));
        let even = rough.next(3.0, true);
        assert_eq!(properties(even), (true, true, false, 3.0));
        assert_eq!(properties(even.next(0.0, false)), (false, false, false, none));
        let mirrored = |previous: PreviousBounce<f32>| {
            let marked = previous.next(0.0, false).with_mirrored_light(true);
            assert!(marked.mirrored_light_sampled() && !previous.mirrored_light_sampled());
            properties(marked)
        };
        assert_eq!(mirrored(camera), (false, false, true, f32::MAX));
        assert_eq!(mirrored(rough), (false, false, false, f32::MAX));
    }
}
