//! The numbers of sixteen paths at once.

use super::plan::{ScatterDraw, choices, directions, lights};
use super::sampler::{OTHER, Points, Sampler, SamplerState};
use super::sobol::{Shuffled, block, shuffle_from};
use crate::lanes::{F32x16, MAX_LANES, U32x16};

/// Where sixteen paths are in the Sobol sequences that they draw from.
#[derive(Clone, Copy, Debug)]
pub struct Places {
    /// [`SamplerState`]'s place in the sequence of its seed.
    pub places: U32x16,
    /// The seeds.
    pub seeds: U32x16,
}

/// Sampler states of many paths, without the [`Places`]: few draws need more than those.
#[derive(Clone, Debug)]
pub struct SamplerStates {
    key: Vec<u64>,
    index: Vec<u32>,
}

/// The states of sixteen paths.
pub struct StartRow {
    key: [u64; MAX_LANES],
    index: [u32; MAX_LANES],
    /// Where they are in the Sobol sequences.
    pub places: Places,
}

/// Sampler states of sixteen paths.
#[derive(Clone, Copy, Debug)]
pub struct SamplerRow<'a> {
    places: Places,
    /// Indices of the paths among the states.
    paths: U32x16,
    states: &'a SamplerStates,
}

impl StartRow {
    fn of(each: &[SamplerState; MAX_LANES]) -> Self {
        Self {
            key: each.map(|state| state.key),
            index: each.map(|state| state.index),
            places: Places {
                places: U32x16::new(each.map(|state| state.shuffled.0)),
                seeds: U32x16::new(each.map(|state| state.key as u32)),
            },
        }
    }
}

impl SamplerState {
    /// The place in the Sobol sequence, and its seed.
    #[inline]
    pub fn sobol(&self) -> [u32; 2] {
        [self.shuffled.0, self.key as u32]
    }
}

impl SamplerStates {
    /// Room for so many paths, and for a whole row after the last.
    pub fn with_paths(count: usize) -> Self {
        Self { key: vec![0; count + MAX_LANES], index: vec![0; count + MAX_LANES] }
    }

    /// Writes the states of paths `first..first + 16`.
    #[inline(always)]
    pub fn set_row(&mut self, first: usize, row: &StartRow) {
        self.key[first..first + MAX_LANES].copy_from_slice(&row.key);
        self.index[first..first + MAX_LANES].copy_from_slice(&row.index);
    }

    /// Writes the state of a path.
    #[inline]
    pub fn set(&mut self, path: usize, state: &SamplerState) {
        (self.key[path], self.index[path]) = (state.key, state.index);
    }

    /// The state of a path, of which the place in the Sobol sequence is known.
    #[inline]
    pub fn state(&self, path: usize, place: u32) -> SamplerState {
        SamplerState { key: self.key[path], index: self.index[path], shuffled: Shuffled(place) }
    }
}

impl<'a> SamplerRow<'a> {
    /// Of the paths whose numbers are given, with all states, that are where `places` tells.
    #[inline(always)]
    pub fn new(places: Places, paths: U32x16, states: &'a SamplerStates) -> Self {
        Self { places, paths, states }
    }
}

/// The numbers of one scattering of each path; all in [0, 1).
#[derive(Clone, Copy, Debug)]
pub struct ScatterRow {
    /// The new directions.
    pub direction: [F32x16; 2],
    /// Which shares of the materials scatter.
    pub lobe: F32x16,
    /// Whether the paths go on.
    pub roulette: F32x16,
}

impl ScatterRow {
    /// Path by path.
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
    /// The states of the paths of sixteen of a pixel's samples from `first` on: [`Sampler::start`]
    /// for each.
    #[inline]
    pub fn start_row(&self, x: u32, y: u32, first: u32) -> StartRow {
        let start = self.start(x, y, first);
        let together = match self.points {
            Points::Sobol(_) => {
                block(u64::from(first) + MAX_LANES as u64 - 1).0 == block(u64::from(first)).0
            }
            Points::Stratified(_) | Points::Independent => false,
        };
        if !together {
            let each =
                std::array::from_fn(|lane| self.start(x, y, first.wrapping_add(lane as u32)));
            return StartRow::of(&each);
        }
        StartRow {
            key: [start.key; MAX_LANES],
            index: std::array::from_fn(|lane| start.index + lane as u32),
            places: Places {
                places: shuffle_from(start.index, start.key as u32),
                seeds: U32x16::splat(start.key as u32),
            },
        }
    }

    /// The camera rays' places in the picture: [`Sampler::pixel`] for each.
    #[inline(always)]
    pub fn pixel_row(&self, paths: &SamplerRow) -> [F32x16; 2] {
        let [_, _, x, y] = self.draw4_row(paths, 0);
        [x, y]
    }

    /// The camera rays' places on the lens: [`Sampler::lens`] for each.
    #[inline(always)]
    pub fn lens_row(&self, paths: &SamplerRow) -> [F32x16; 2] {
        let [u, v, ..] = self.draw4_row(paths, 1);
        [u, v]
    }

    /// [`Sampler::scatter`] for each. Numbers for lobes and Russian roulette are 0 unless they are
    /// asked for.
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

    /// What glass asks for: the lobes of [`Sampler::scatter`] for each.
    #[inline(always)]
    pub fn lobe_row(&self, paths: &SamplerRow, bounce: u32) -> F32x16 {
        self.draw4_row(paths, choices(bounce))[2]
    }

    /// The numbers from which [`LightDraw`](super::LightDraw)s are made, for each: those of
    /// [`Sampler::light`].
    #[inline(always)]
    pub fn light_row(&self, paths: &SamplerRow, bounce: u32) -> [F32x16; 4] {
        self.draw4_row(paths, lights(bounce))
    }

    /// Which caustic is looked for at scattering number `bounce`, and a place on its lamp, for each.
    #[inline(always)]
    pub fn caustic_row(&self, paths: &SamplerRow, bounce: u32) -> (F32x16, [F32x16; 2]) {
        let [u, v, which, _] = self.other_row(paths, lights(bounce));
        (which, [u, v])
    }

    /// [`Sampler::draw4`] for each, with [other](SamplerState::other) numbers.
    #[inline(always)]
    fn other_row(&self, paths: &SamplerRow, set: u32) -> [F32x16; 4] {
        if let Points::Sobol(sobol) = self.points {
            let Places { places, seeds } = paths.places;
            let seeds = seeds ^ U32x16::splat(OTHER as u32);
            if let Some(row) = sobol.draw4_row(places, set, seeds) {
                return row;
            }
        }
        self.draw4_each(paths, set, SamplerState::other)
    }

    /// [`Sampler::draw4`] for each.
    #[inline(always)]
    pub fn draw4_row(&self, paths: &SamplerRow, set: u32) -> [F32x16; 4] {
        if let Points::Sobol(sobol) = self.points {
            let Places { places, seeds } = paths.places;
            if let Some(row) = sobol.draw4_row(places, set, seeds) {
                return row;
            }
        }
        self.draw4_each(paths, set, |state| state)
    }

    /// The same, one by one.
    #[inline(never)]
    fn draw4_each(
        &self,
        paths: &SamplerRow,
        set: u32,
        of: impl Fn(SamplerState) -> SamplerState,
    ) -> [F32x16; 4] {
        let mut columns = [[0.0; MAX_LANES]; 4];
        let each = paths.paths.to_array().into_iter().zip(paths.places.places.to_array());
        for (lane, (path, place)) in each.enumerate() {
            let draw = self.draw4(&of(paths.states.state(path as usize, place)), set);
            columns.iter_mut().zip(draw).for_each(|(column, x)| column[lane] = x);
        }
        columns.map(F32x16::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::LightDraw;
    use crate::scene::SamplerKind;

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
                for (lane, place) in start.places.places.to_array().into_iter().enumerate() {
                    assert_eq!(states.state(3 + lane, place), row[lane], "{kind:?} {first}");
                    assert_eq!(start.places.seeds.to_array()[lane], row[lane].key as u32);
                }
                let paths = U32x16::new(std::array::from_fn(|lane| 3 + lane as u32));
                let together = &SamplerRow::new(start.places, paths, &states);
                let row = &row;
                for set in [0, 1, 5, 200] {
                    let rows = sampler.draw4_row(together, set).map(wide::f32x16::to_array);
                    for (lane, path) in row.iter().enumerate() {
                        assert_eq!(rows.map(|x| x[lane]), sampler.draw4(path, set), "{kind:?}");
                    }
                }
                for bounce in [0, 1, 2, 7] {
                    let one = sampler.scatter(&row[5], bounce);
                    assert_eq!(sampler.scatter_row(together, bounce, true).each()[5], one);
                    let plain = ScatterDraw { lobe: 0.0, roulette: 0.0, ..one };
                    assert_eq!(sampler.scatter_row(together, bounce, false).each()[5], plain);
                    assert_eq!(sampler.lobe_row(together, bounce).to_array()[5], one.lobe);
                    let light = sampler.light_row(together, bounce).map(|x| x.to_array()[5]);
                    assert_eq!(LightDraw::new(light), sampler.light(&row[5], bounce));
                }
                for bounce in [0, 3, 99] {
                    let (which, [u, v]) = sampler.caustic_row(together, bounce);
                    let each = [u, v, which].map(|x| x.to_array()[5]);
                    let [u, v, which, _] = sampler.draw4(&row[5].other(), lights(bounce));
                    assert_eq!(each, [u, v, which], "{kind:?} {bounce}");
                }
                let [x, y] = sampler.pixel_row(together).map(|x| x.to_array()[3]);
                assert_eq!([x, y], sampler.pixel(&row[3]));
                let [x, y] = sampler.lens_row(together).map(|x| x.to_array()[3]);
                assert_eq!([x, y], sampler.lens(&row[3]));
            }
        }
    }

    #[test]
    fn states_are_kept_by_path() {
        let sampler = Sampler::new(SamplerKind::Sobol, 4, 16);
        let mut states = SamplerStates::with_paths(3);
        let paths = [0, 1, 2].map(|path| sampler.start(path, 7, 70_000 + path));
        for (path, state) in paths.iter().enumerate() {
            states.set(path, state);
        }
        for (path, state) in paths.iter().enumerate() {
            let [place, seed] = state.sobol();
            assert_eq!(states.state(path, place), *state);
            // What a row of paths draws from is this place, in the sequence of this seed.
            let places = Places { places: U32x16::splat(place), seeds: U32x16::splat(seed) };
            let row = SamplerRow::new(places, U32x16::splat(path as u32), &states);
            let drawn = sampler.draw4_row(&row, 1).map(|x| x.to_array()[0]);
            assert_eq!(drawn, sampler.draw4(state, 1));
        }
    }
}
