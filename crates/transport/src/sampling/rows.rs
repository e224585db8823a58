//! Random numbers of sixteen paths at once.

use super::hash::stream;
use super::plan::{ScatterDraw, choices, directions, lights};
use super::sampler::{ALTERNATE, Points, Sampler, SamplerState};
use super::sobol::{Shuffled, block, shuffle_from, shuffle_row};
use crate::lanes::{F32x16, MAX_LANES, U32x16};

/// Positions of sixteen paths in their Sobol sequences.
#[derive(Clone, Copy, Debug)]
pub struct SobolPositions {
    /// Positions in the sequences of the seeds, as in [`SamplerState`].
    pub positions: U32x16,
    /// Seeds of the sequences.
    pub seeds: U32x16,
}

/// Sampler states of many paths, without the [`SobolPositions`]: few draws need more than these.
#[derive(Clone, Debug)]
pub struct SamplerStates {
    key: Vec<u64>,
    index: Vec<u32>,
}

/// The states of sixteen paths.
pub struct StartRow {
    key: [u64; MAX_LANES],
    index: [u32; MAX_LANES],
    /// Positions in the Sobol sequences.
    pub positions: SobolPositions,
}

/// Samples of sixteen paths, of any pixels.
#[derive(Clone, Debug, Default)]
pub struct SampleRow {
    /// Columns of the pixels.
    pub x: [u32; MAX_LANES],
    /// Rows of the pixels.
    pub y: [u32; MAX_LANES],
    index: [u32; MAX_LANES],
    /// Seeds of the samplers.
    seed: [u64; MAX_LANES],
}

impl SampleRow {
    /// Sets a lane: sample `index` of the pixel in column `x` and row `y`.
    #[inline]
    pub fn set(&mut self, lane: usize, x: u32, y: u32, index: u32, sampler: &Sampler) {
        (self.x[lane], self.y[lane], self.index[lane]) = (x, y, index);
        self.seed[lane] = sampler.seed;
    }
}

/// Sampler states of a row of sixteen paths.
#[derive(Clone, Copy, Debug)]
pub struct SamplerRow<'a> {
    positions: SobolPositions,
    /// Indices of the paths among the states.
    paths: U32x16,
    states: &'a SamplerStates,
}

impl StartRow {
    fn of(each: &[SamplerState; MAX_LANES]) -> Self {
        Self {
            key: each.map(|state| state.key),
            index: each.map(|state| state.index),
            positions: SobolPositions {
                positions: U32x16::new(each.map(|state| state.shuffled.0)),
                seeds: U32x16::new(each.map(|state| state.key as u32)),
            },
        }
    }
}

impl SamplerStates {
    /// Creates states for `count` paths, and for a whole row after the last.
    pub fn with_paths(count: usize) -> Self {
        Self { key: vec![0; count + MAX_LANES], index: vec![0; count + MAX_LANES] }
    }

    /// Writes the states of paths `first..first + 16`.
    #[inline(always)]
    pub fn set_row(&mut self, first: usize, row: &StartRow) {
        self.key[first..first + MAX_LANES].copy_from_slice(&row.key);
        self.index[first..first + MAX_LANES].copy_from_slice(&row.index);
    }

    /// Returns the state of a path, whose position in the Sobol sequence is given.
    #[inline]
    pub fn state(&self, path: usize, position: u32) -> SamplerState {
        SamplerState { key: self.key[path], index: self.index[path], shuffled: Shuffled(position) }
    }
}

impl<'a> SamplerRow<'a> {
    /// Creates a row from the paths' positions, their indices, and all states.
    #[inline(always)]
    pub fn new(positions: SobolPositions, paths: U32x16, states: &'a SamplerStates) -> Self {
        Self { positions, paths, states }
    }
}

/// The numbers of one bounce of each path; all in [0, 1).
#[derive(Clone, Copy, Debug)]
pub struct ScatterRow {
    /// For the new directions.
    pub direction: [F32x16; 2],
    /// For the choice of the lobes.
    pub lobe: F32x16,
    /// For Russian roulette.
    pub roulette: F32x16,
}

impl ScatterRow {
    /// Returns the numbers path by path.
    #[inline(always)]
    pub fn each(&self) -> [ScatterDraw; MAX_LANES] {
        let [u, v] = self.direction.map(F32x16::to_array);
        let (lobe, roulette) = (self.lobe.to_array(), self.roulette.to_array());
        std::array::from_fn(|lane| ScatterDraw {
            direction: [u[lane], v[lane]],
            lobe: lobe[lane],
            roulette: roulette[lane],
        })
    }
}

impl Sampler {
    /// Returns the states of sixteen of a pixel's samples from `first` on: [`Sampler::start`] for each.
    #[inline]
    pub fn start_row(&self, x: u32, y: u32, first: u32) -> StartRow {
        let start = self.start(x, y, first);
        let one_block = match self.points {
            Points::Sobol(_) => {
                block(u64::from(first) + MAX_LANES as u64 - 1).0 == block(u64::from(first)).0
            }
            Points::Stratified(_) | Points::Independent => false,
        };
        if !one_block {
            let each =
                std::array::from_fn(|lane| self.start(x, y, first.wrapping_add(lane as u32)));
            return StartRow::of(&each);
        }
        StartRow {
            key: [start.key; MAX_LANES],
            index: std::array::from_fn(|lane| start.index + lane as u32),
            positions: SobolPositions {
                positions: shuffle_from(start.index, start.key as u32),
                seeds: U32x16::splat(start.key as u32),
            },
        }
    }

    /// Returns the states of sixteen samples, [`Sampler::start`] for each; their samplers may be replicas
    /// of this one.
    #[inline]
    pub fn start_samples(&self, samples: &SampleRow) -> StartRow {
        let SampleRow { x, y, index, seed } = samples;
        if !matches!(self.points, Points::Sobol(_)) {
            return StartRow::of(&std::array::from_fn(|lane| {
                let sampler = Self { seed: seed[lane], points: self.points };
                sampler.start(x[lane], y[lane], index[lane])
            }));
        }
        let blocks = index.map(|index| block(u64::from(index)));
        let key = std::array::from_fn(|lane| {
            let pixel = stream(seed[lane], u64::from(y[lane]) << 32 | u64::from(x[lane]));
            stream(pixel, blocks[lane].0)
        });
        let (index, seeds) = (blocks.map(|(_, index)| index), key.map(|key: u64| key as u32));
        let seeds = U32x16::new(seeds);
        let positions = SobolPositions { positions: shuffle_row(U32x16::new(index), seeds), seeds };
        StartRow { key, index, positions }
    }

    /// Returns the camera rays' positions in their pixels: [`Sampler::pixel`] for each.
    #[inline(always)]
    pub fn pixel_row(&self, paths: &SamplerRow) -> [F32x16; 2] {
        let [_, _, x, y] = self.draw4_row(paths, 0);
        [x, y]
    }

    /// Returns the camera rays' positions on the lens: [`Sampler::lens`] for each.
    #[inline(always)]
    pub fn lens_row(&self, paths: &SamplerRow) -> [F32x16; 2] {
        let [u, v, ..] = self.draw4_row(paths, 1);
        [u, v]
    }

    /// [`Sampler::scatter`] for each. Numbers for lobes and Russian roulette are 0 unless `choose` is
    /// true.
    #[inline(always)]
    pub fn scatter_row(&self, paths: &SamplerRow, bounce: u32, choose: bool) -> ScatterRow {
        let first = self.draw4_row(paths, directions(bounce));
        let second = match (choose, choices(bounce)) {
            (false, _) => [F32x16::splat(0.0); 4],
            (true, set) if set == directions(bounce) => first,
            (true, set) => self.draw4_row(paths, set),
        };
        let ([u, v, ..], [_, _, lobe, roulette]) = (first, second);
        ScatterRow { direction: [u, v], lobe, roulette }
    }

    /// Returns the numbers that glass needs: the lobes of [`Sampler::scatter`] for each.
    #[inline(always)]
    pub fn lobe_row(&self, paths: &SamplerRow, bounce: u32) -> F32x16 {
        self.draw4_row(paths, choices(bounce))[2]
    }

    /// Returns the numbers of [`LightDraw`](super::LightDraw)s for each: those of [`Sampler::light`].
    #[inline(always)]
    pub fn light_row(&self, paths: &SamplerRow, bounce: u32) -> [F32x16; 4] {
        self.draw4_row(paths, lights(bounce))
    }

    /// Returns the numbers of [`LightDraw`](super::LightDraw)s for caustics at bounce number `bounce`,
    /// for each: for the choice of a caustic and for a point on its light.
    #[inline(always)]
    pub fn caustic_row(&self, paths: &SamplerRow, bounce: u32) -> [F32x16; 4] {
        self.alternate_row(paths, lights(bounce))
    }

    /// Returns the numbers of further places of camera rays in their pixels.
    #[inline(always)]
    pub fn image_row(&self, paths: &SamplerRow) -> [F32x16; 4] {
        self.alternate_row(paths, 0)
    }

    /// [`Sampler::draw4`] for each, with [alternate](SamplerState::alternate) numbers.
    #[inline(never)]
    fn alternate_row(&self, paths: &SamplerRow, set: u32) -> [F32x16; 4] {
        if let Points::Sobol(sobol) = self.points {
            let SobolPositions { positions, seeds } = paths.positions;
            let seeds = seeds ^ U32x16::splat(ALTERNATE as u32);
            if let Some(row) = sobol.draw4_row(positions, set, seeds) {
                return row;
            }
        }
        self.draw4_each(paths, set, SamplerState::alternate)
    }

    /// [`Sampler::draw4`] for each.
    #[inline(never)]
    pub fn draw4_row(&self, paths: &SamplerRow, set: u32) -> [F32x16; 4] {
        if let Points::Sobol(sobol) = self.points {
            let SobolPositions { positions, seeds } = paths.positions;
            if let Some(row) = sobol.draw4_row(positions, set, seeds) {
                return row;
            }
        }
        self.draw4_each(paths, set, |state| state)
    }

    /// Calls [`Sampler::draw4`] one by one.
    #[inline(never)]
    fn draw4_each(
        &self,
        paths: &SamplerRow,
        set: u32,
        of: impl Fn(SamplerState) -> SamplerState,
    ) -> [F32x16; 4] {
        let mut columns = [[0.0; MAX_LANES]; 4];
        let each = paths.paths.to_array().into_iter().zip(paths.positions.positions.to_array());
        for (lane, (path, position)) in each.enumerate() {
            let draw = self.draw4(&of(paths.states.state(path as usize, position)), set);
            columns.iter_mut().zip(draw).for_each(|(column, x)| column[lane] = x);
        }
        columns.map(F32x16::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::LightDraw;
    use crate::settings::SamplerKind;

    #[test]
    fn rows_are_what_their_paths_are() {
        for kind in [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent] {
            let sampler = Sampler::new(kind, 4, 16);
            for first in [0, 3, 65_520, 65_530, u32::MAX - 40] {
                let row: [SamplerState; 16] =
                    std::array::from_fn(|lane| sampler.start(5, 6, first + lane as u32));
                let start = sampler.start_row(5, 6, first);
                let mut states = SamplerStates::with_paths(20);
                states.set_row(3, &start);
                for (lane, position) in start.positions.positions.to_array().into_iter().enumerate()
                {
                    assert_eq!(states.state(3 + lane, position), row[lane], "{kind:?} {first}");
                    assert_eq!(start.positions.seeds.to_array()[lane], row[lane].key as u32);
                }
                let paths = U32x16::new(std::array::from_fn(|lane| 3 + lane as u32));
                let sixteen = &SamplerRow::new(start.positions, paths, &states);
                let row = &row;
                for set in [0, 1, 5, 200] {
                    let rows = sampler.draw4_row(sixteen, set).map(wide::f32x16::to_array);
                    for (lane, path) in row.iter().enumerate() {
                        assert_eq!(rows.map(|x| x[lane]), sampler.draw4(path, set), "{kind:?}");
                    }
                }
                for bounce in [0, 1, 2, 7] {
                    let one = sampler.scatter(&row[5], bounce);
                    assert_eq!(sampler.scatter_row(sixteen, bounce, true).each()[5], one);
                    let plain = ScatterDraw { lobe: 0.0, roulette: 0.0, ..one };
                    assert_eq!(sampler.scatter_row(sixteen, bounce, false).each()[5], plain);
                    assert_eq!(sampler.lobe_row(sixteen, bounce).to_array()[5], one.lobe);
                    let light = sampler.light_row(sixteen, bounce).map(|x| x.to_array()[5]);
                    assert_eq!(LightDraw::new(light), sampler.light(&row[5], bounce));
                }
                for bounce in [0, 3, 99] {
                    let each = sampler.caustic_row(sixteen, bounce).map(|x| x.to_array()[5]);
                    let numbers = sampler.draw4(&row[5].alternate(), lights(bounce));
                    assert_eq!(each, numbers, "{kind:?} {bounce}");
                }
                let [x, y] = sampler.pixel_row(sixteen).map(|x| x.to_array()[3]);
                assert_eq!([x, y], sampler.pixel(&row[3]));
                let [x, y] = sampler.lens_row(sixteen).map(|x| x.to_array()[3]);
                assert_eq!([x, y], sampler.lens(&row[3]));
            }
        }
    }

    #[test]
    fn samples_of_different_pixels_start_together() {
        for kind in [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent] {
            let sampler = Sampler::new(kind, 4, 16);
            let path = |lane: u32| (lane % 5, 7 * lane, 9000 * lane);
            let replica = |lane: u32| sampler.replica(u64::from(lane / 9));
            let mut samples = SampleRow::default();
            for lane in 0..16 {
                let (x, y, index) = path(lane);
                samples.set(lane as usize, x, y, index, &replica(lane));
            }
            let expected = StartRow::of(&std::array::from_fn(|lane| {
                let (x, y, index) = path(lane as u32);
                replica(lane as u32).start(x, y, index)
            }));
            let start = sampler.start_samples(&samples);
            assert_eq!((start.key, start.index), (expected.key, expected.index), "{kind:?}");
            let [a, b] = [start, expected].map(|row| row.positions);
            assert_eq!(a.positions.to_array(), b.positions.to_array(), "{kind:?}");
            assert_eq!(a.seeds.to_array(), b.seeds.to_array(), "{kind:?}");
        }
    }

    #[test]
    fn states_are_kept_by_path() {
        let sampler = Sampler::new(SamplerKind::Sobol, 4, 16);
        let mut samples = SampleRow::default();
        (0..3).for_each(|i| samples.set(i as usize, i, 7, 70_000 + i, &sampler));
        let start = sampler.start_samples(&samples);
        let mut states = SamplerStates::with_paths(3);
        states.set_row(0, &start);
        let SobolPositions { positions, seeds } = start.positions;
        let sequences = positions.to_array().into_iter().zip(seeds.to_array());
        for (path, (position, seed)) in sequences.enumerate().take(3) {
            let state = &sampler.start(path as u32, 7, 70_000 + path as u32);
            assert_eq!(states.state(path, position), *state);
            // A row of paths draws from this position, in the sequence of this seed.
            let positions =
                SobolPositions { positions: U32x16::splat(position), seeds: U32x16::splat(seed) };
            let row = SamplerRow::new(positions, U32x16::splat(path as u32), &states);
            let drawn = sampler.draw4_row(&row, 1).map(|x| x.to_array()[0]);
            assert_eq!(drawn, sampler.draw4(state, 1));
        }
    }
}
