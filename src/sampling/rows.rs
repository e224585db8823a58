//! The numbers of sixteen paths at once.

use super::plan::{ScatterDraw, choices, directions, lights};
use super::sampler::{PathState, Points, Sampler};
use super::sobol::{block, shuffle_from};
use crate::lanes::{F32x16, MAX_LANES, U32x16};

/// Paths that draw together.
pub type PathRow = [PathState; MAX_LANES];

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
    /// The states of the paths of a pixel's samples from `first` on: [`Sampler::start`] for each.
    pub fn start_all(&self, x: u32, y: u32, first: u32, states: &mut [PathState]) {
        for (row, first) in states.chunks_mut(MAX_LANES).zip((first..).step_by(MAX_LANES)) {
            let start = self.start(x, y, first);
            let together = match self.points {
                Points::Sobol(_) => {
                    block(u64::from(first) + MAX_LANES as u64 - 1).0 == block(u64::from(first)).0
                }
                Points::Stratified(_) | Points::Independent => false,
            };
            if together {
                let places = shuffle_from(start.index, start.key as u32);
                for (lane, (state, shuffled)) in row.iter_mut().zip(places).enumerate() {
                    *state = PathState { index: start.index + lane as u32, shuffled, ..start };
                }
            } else {
                row.iter_mut()
                    .zip(first..)
                    .for_each(|(state, index)| *state = self.start(x, y, index));
            }
        }
    }

    /// The camera rays' places in the picture: [`Sampler::pixel`] for each.
    #[inline(always)]
    pub fn pixel_row(&self, paths: &PathRow) -> [F32x16; 2] {
        let [_, _, x, y] = self.draw4_row(paths, 0);
        [x, y]
    }

    /// The camera rays' places on the lens: [`Sampler::lens`] for each.
    #[inline(always)]
    pub fn lens_row(&self, paths: &PathRow) -> [F32x16; 2] {
        let [u, v, ..] = self.draw4_row(paths, 1);
        [u, v]
    }

    /// [`Sampler::scatter`] for each. Numbers for lobes and Russian roulette are 0 unless they are
    /// asked for.
    #[inline(always)]
    pub fn scatter_row(&self, paths: &PathRow, bounce: u32, choose: bool) -> ScatterRow {
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
    pub fn lobe_row(&self, paths: &PathRow, bounce: u32) -> F32x16 {
        self.draw4_row(paths, choices(bounce))[2]
    }

    /// The numbers from which [`LightDraw`](super::LightDraw)s are made, for each: those of
    /// [`Sampler::light`].
    #[inline(always)]
    pub fn light_row(&self, paths: &PathRow, bounce: u32) -> [F32x16; 4] {
        self.draw4_row(paths, lights(bounce))
    }

    /// [`Sampler::draw4`] for each.
    #[inline(always)]
    pub fn draw4_row(&self, paths: &PathRow, set: u32) -> [F32x16; 4] {
        if let Points::Sobol(sobol) = self.points {
            let places = U32x16::new(paths.map(|path| path.shuffled.0));
            let seeds = U32x16::new(paths.map(|path| path.key as u32));
            if let Some(row) = sobol.draw4_row(places, set, seeds) {
                return row;
            }
        }
        let mut columns = [[0.0; MAX_LANES]; 4];
        for (lane, path) in paths.iter().enumerate() {
            let draw = self.draw4(path, set);
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
                let mut paths = [sampler.start(0, 0, 0); 37];
                sampler.start_all(5, 6, first, &mut paths);
                for (path, index) in paths.iter().zip(first..) {
                    assert_eq!(*path, sampler.start(5, 6, index), "{kind:?} {index}");
                }
                let row: &PathRow = paths.first_chunk().expect("more than a row");
                for set in [0, 1, 5, 200] {
                    let rows = sampler.draw4_row(row, set).map(wide::f32x16::to_array);
                    for (lane, path) in row.iter().enumerate() {
                        assert_eq!(rows.map(|x| x[lane]), sampler.draw4(path, set), "{kind:?}");
                    }
                }
                for bounce in [0, 1, 2, 7] {
                    let one = sampler.scatter(&row[5], bounce);
                    assert_eq!(sampler.scatter_row(row, bounce, true).each()[5], one);
                    let plain = ScatterDraw { lobe: 0.0, roulette: 0.0, ..one };
                    assert_eq!(sampler.scatter_row(row, bounce, false).each()[5], plain);
                    assert_eq!(sampler.lobe_row(row, bounce).to_array()[5], one.lobe);
                    let light = sampler.light_row(row, bounce).map(|x| x.to_array()[5]);
                    assert_eq!(LightDraw::new(light), sampler.light(&row[5], bounce));
                }
                let [x, y] = sampler.pixel_row(row).map(|x| x.to_array()[3]);
                assert_eq!([x, y], sampler.pixel(&row[3]));
                let [x, y] = sampler.lens_row(row).map(|x| x.to_array()[3]);
                assert_eq!([x, y], sampler.lens(&row[3]));
            }
        }
    }
}
