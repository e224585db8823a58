use super::*;
use crate::sampling::statistics::assert_chi_squared;
use std::collections::HashSet;

const KINDS: [SamplerKind; 3] =
    [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent];

/// Sets among the Sobol dimensions, at their end and beyond.
const SETS: [u32; 6] = [0, 1, 2, 63, 64, 8193];

fn bits(numbers: [f32; 4]) -> [u32; 4] {
    numbers.map(f32::to_bits)
}

#[test]
fn a_state_is_small() {
    assert!(size_of::<SamplerState>() <= 16);
}

#[test]
fn every_number_is_in_the_unit_interval() {
    for kind in KINDS {
        for spp in [0, 1, 7, 16] {
            let sampler = Sampler::new(kind, 1, spp);
            for index in (0..40).chain([65_535, 65_536, u32::MAX]) {
                let path = sampler.start(65_534, index, index);
                let pair = sampler.split(&path, u32::MAX, spp).pair(index);
                let numbers = SETS.into_iter().flat_map(|set| sampler.draw4(&path, set));
                for number in numbers.chain(pair) {
                    assert!((0.0..1.0).contains(&number), "{kind:?} {spp} {index}: {number}");
                }
            }
        }
    }
}

#[test]
fn numbers_do_not_depend_on_the_order_of_calls() {
    for kind in KINDS {
        let sampler = Sampler::new(kind, 5, 12);
        let path = sampler.start(3, 4, 5);
        let forward: Vec<_> = SETS.iter().map(|&set| bits(sampler.draw4(&path, set))).collect();
        sampler.split(&path, 0, 4).pair(0);
        let again = Sampler::new(kind, 5, 12);
        let mut backward: Vec<_> =
            SETS.iter().rev().map(|&set| bits(again.draw4(&again.start(3, 4, 5), set))).collect();
        backward.reverse();
        assert_eq!(forward, backward, "{kind:?}");
    }
}

#[test]
fn seeds_pixels_samples_and_sets_differ() {
    for kind in KINDS {
        let mut seen = HashSet::new();
        for (seed, x, y, index) in
            [(0, 0, 0, 0), (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)]
        {
            let sampler = Sampler::new(kind, seed, 16);
            // Also the samples beyond the tables of Sobol points and beyond the strata.
            for round in [0, 16, 65_536] {
                let path = sampler.start(x, y, index + round);
                assert!(SETS.iter().all(|&set| seen.insert(bits(sampler.draw4(&path, set)))));
                for event in 0..2 {
                    for i in 0..4 {
                        let [u, v] = sampler.split(&path, event, 4).pair(i);
                        assert!(seen.insert(bits([u, v, -1.0, -1.0])), "{kind:?} {event} {i}");
                    }
                }
            }
        }
    }
}

#[test]
fn pixels_are_uniform_and_independent() {
    for kind in KINDS {
        let sampler = Sampler::new(kind, 9, 16);
        // The last set is beyond the Sobol dimensions.
        for (set, index) in [(0, 0), (1, 3), (64, 15)] {
            let mut observed = vec![0_u64; 1296];
            for pixel in 0..40_000 {
                let numbers = sampler.draw4(&sampler.start(pixel % 200, pixel / 200, index), set);
                let cell =
                    numbers.iter().fold(0, |cell, number| cell * 6 + (number * 6.0) as usize);
                observed[cell] += 1;
            }
            assert_chi_squared(&observed, &[1.0 / 1296.0; 1296]);
        }
    }
}

#[test]
fn mean_and_variance_are_those_of_uniform_numbers() {
    const PIXELS: u32 = 20_000;
    for kind in KINDS {
        let sampler = Sampler::new(kind, 2, 4);
        let numbers = (0..PIXELS).flat_map(|x| sampler.draw4(&sampler.start(x, 0, 1), 2));
        let (mut sum, mut squares) = (0.0, 0.0);
        for number in numbers.map(f64::from) {
            sum += number;
            squares += (number - 0.5).powi(2);
        }
        let count = 4.0 * f64::from(PIXELS);
        // Standard deviations of one number and of its squared deviation.
        assert!((sum / count - 0.5).abs() < 5.0 * (1.0 / 12.0 / count).sqrt(), "{kind:?}");
        assert!((squares / count - 1.0 / 12.0).abs() < 5.0 * (1.0 / 180.0 / count).sqrt());
    }
}

fn is_stratified(points: impl Iterator<Item = [f32; 2]>, columns: u32, rows: u32) -> bool {
    let mut cells: Vec<u32> = points
        .map(|[u, v]| (u * columns as f32) as u32 * rows + (v * rows as f32) as u32)
        .collect();
    cells.sort_unstable();
    cells.into_iter().eq(0..columns * rows)
}

#[test]
fn stratified_pairs_have_one_sample_per_cell() {
    for (columns, rows) in [(4, 4), (3, 4)] {
        let spp = columns * rows;
        let sampler = Sampler::new(SamplerKind::Stratified, 3, spp);
        for set in SETS {
            for first in [0, spp] {
                let draws =
                    || (0..spp).map(|i| sampler.draw4(&sampler.start(8, 9, first + i), set));
                assert!(is_stratified(draws().map(|[u, v, _, _]| [u, v]), columns, rows));
                assert!(is_stratified(draws().map(|[_, _, u, v]| [u, v]), columns, rows));
            }
        }
    }
}

#[test]
fn sobol_points_are_stratified_in_every_projection() {
    let sampler = Sampler::new(SamplerKind::Sobol, 3, 0);
    for first in [0, 64, 65_536 - 64, 65_536] {
        for set in [0, 1, 7, 63] {
            let points = |a: usize, b: usize| {
                (0..64).map(move |i| {
                    let numbers = sampler.draw4(&sampler.start(8, 9, first + i), set);
                    [numbers[a], numbers[b]]
                })
            };
            for dimension in 0..4 {
                assert!(is_stratified(points(dimension, dimension).map(|[u, _]| [u, 0.0]), 64, 1));
            }
            if set == 0 {
                // The first two dimensions are a (0, 2)-sequence: every elementary interval.
                for bits in 0..=6 {
                    assert!(is_stratified(points(0, 1), 1 << bits, 64 >> bits), "{bits}");
                }
            }
        }
    }
}

#[test]
fn splits_are_stratified_within_a_path() {
    for (kind, count, columns) in [
        (SamplerKind::Sobol, 16, &[1, 2, 4, 8, 16][..]),
        (SamplerKind::Stratified, 16, &[4]),
        (SamplerKind::Stratified, 12, &[3]),
    ] {
        let sampler = Sampler::new(kind, 3, 4);
        for index in [0, 3, 4095, 70_000] {
            let path = sampler.start(8, 9, index);
            for &columns in columns {
                let points = (0..count).map(|i| sampler.split(&path, 2, count).pair(i));
                assert!(is_stratified(points, columns, count / columns), "{kind:?} {index}");
            }
        }
    }
}

#[test]
fn sobol_splits_are_stratified_over_the_pixel() {
    let sampler = Sampler::new(SamplerKind::Sobol, 3, 8);
    let points = || {
        (0..8).flat_map(|index| {
            let path = sampler.start(1, 2, index);
            (0..8).map(move |i| sampler.split(&path, 0, 8).pair(i))
        })
    };
    for bits in 0..=6 {
        assert!(is_stratified(points(), 1 << bits, 64 >> bits), "{bits}");
    }
}

/// Returns a smooth integrand over the unit square, with mean and variance.
fn smooth([u, v]: [f32; 2]) -> f64 {
    f64::from(u + v).exp()
}

/// Returns the root mean square error of the mean of 256 samples, over pixels.
fn error(kind: SamplerKind, pair: impl Fn(&Sampler, &SamplerState) -> [f32; 2]) -> f64 {
    const PIXELS: u32 = 100;
    let mean = (1.0_f64.exp() - 1.0).powi(2);
    let sampler = Sampler::new(kind, 17, 256);
    let squares = (0..PIXELS).map(|x| {
        let values = (0..256).map(|index| smooth(pair(&sampler, &sampler.start(x, 7, index))));
        (values.sum::<f64>() / 256.0 - mean).powi(2)
    });
    (squares.sum::<f64>() / f64::from(PIXELS)).sqrt()
}

#[test]
fn well_distributed_points_beat_random_ones() {
    let moment = |k: f64| ((k.exp() - 1.0) / k).powi(2);
    let random = ((moment(2.0) - moment(1.0).powi(2)) / 256.0).sqrt();
    let first = |sampler: &Sampler, path: &SamplerState| {
        let [u, v, _, _] = sampler.draw4(path, 0);
        [u, v]
    };
    let second = |sampler: &Sampler, path: &SamplerState| {
        let [_, _, u, v] = sampler.draw4(path, 0);
        [u, v]
    };
    let beyond = |sampler: &Sampler, path: &SamplerState| {
        let [u, v, _, _] = sampler.draw4(path, 64);
        [u, v]
    };
    // The error of independent samples is known to 7 % from 100 pixels.
    for ratio in [
        error(SamplerKind::Independent, first) / random,
        error(SamplerKind::Independent, second) / random,
        error(SamplerKind::Sobol, beyond) / random,
    ] {
        assert!((ratio - 1.0).abs() < 0.3, "{ratio}");
    }
    for ratio in [
        random / error(SamplerKind::Sobol, first),
        random / error(SamplerKind::Sobol, second),
        random / error(SamplerKind::Stratified, first),
        random / error(SamplerKind::Stratified, second),
    ] {
        assert!(ratio > 5.0, "{ratio}");
    }
}

#[test]
fn a_row_of_a_split_is_its_points() {
    for kind in KINDS {
        let sampler = Sampler::new(kind, 3, 16);
        for (count, first) in [(50, 16), (50, 48), (7, 0), (1, 0), (1 << 20, 65_530)] {
            let split = sampler.split(&sampler.start(5, 6, 7), 8, count);
            let lanes = 16.min(count - first);
            let row = split.row(first, lanes as usize).map(F32x16::to_array);
            for lane in 0..lanes {
                let point = row.map(|numbers| numbers[lane as usize]);
                assert_eq!(point, split.pair(first + lane), "{kind:?} {count} {first} {lane}");
            }
        }
    }
}

#[test]
fn replicas_are_independent() {
    for kind in KINDS {
        let sampler = Sampler::new(kind, 5, 16);
        let mut seen = HashSet::new();
        for sampler in
            [sampler, sampler.replica(0), sampler.replica(1), sampler.replica(0).replica(0)]
        {
            assert!(seen.insert(bits(sampler.draw4(&sampler.start(3, 4, 5), 0))), "{kind:?}");
        }
        let again = sampler.replica(1);
        assert!(!seen.insert(bits(again.draw4(&again.start(3, 4, 5), 0))), "{kind:?}");
    }
}

/// Two keys with the same numbers would make two pixels equal.
#[test]
fn every_bit_of_a_key_counts() {
    for kind in KINDS {
        let sampler = Sampler::new(kind, 5, 16);
        let path = sampler.start(3, 4, 5);
        let mut replicas = HashSet::from([sampler.replica(0).seed]);
        let mut splits = HashSet::from([sampler.split(&path, 1, 4).key]);
        let mut beyond = HashSet::from([bits(sampler.draw4(&path, 64))]);
        let mut others = HashSet::from([path.alternate().key]);
        for bit in 0..64 {
            let seed = sampler.seed ^ 1 << bit;
            let path = SamplerState { key: path.key ^ 1 << bit, ..path };
            assert!(replicas.insert(Sampler { seed, ..sampler }.replica(0).seed), "{bit}");
            assert!(splits.insert(sampler.split(&path, 1, 4).key), "{kind:?} {bit}");
            assert!(beyond.insert(bits(sampler.draw4(&path, 64))), "{kind:?} {bit}");
            assert!(others.insert(path.alternate().key), "{bit}");
        }
    }
}

#[test]
fn debug_output_names_the_points_without_their_tables() {
    let text = format!("{:?}", Sampler::new(SamplerKind::Sobol, 5, 16));
    assert!(text.contains("Sobol { .. }") && text.len() < 200, "{text}");
}
