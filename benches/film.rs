//! Work around tracing: random numbers of each sampler, and accumulation of samples into pixels. All data
//! fits in the second-level cache.

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use spherule_render::film::{Film, Region, TILE};
use spherule_render::sampling::Sampler;
use spherule_render::scene::{Rgb, SamplerKind};
use std::hint::black_box;

/// Samples per pixel.
const SPP: u32 = 16;

/// Sets of four numbers for each sample: pixel and lens, and two bounces.
const SETS: u32 = 3;

/// Returns the sum of the numbers of a tile.
fn numbers(sampler: &Sampler) -> f64 {
    let mut sum = 0.0;
    for (x, y) in (0..TILE).flat_map(|y| (0..TILE).map(move |x| (x, y))) {
        for index in 0..SPP {
            let path = sampler.start(x, y, index);
            for set in 0..SETS {
                sum += sampler.draw4(&path, set).iter().map(|&x| f64::from(x)).sum::<f64>();
            }
        }
    }
    sum
}

fn samplers(criterion: &mut Criterion) {
    let count = u64::from(TILE * TILE * SPP * SETS * 4);
    let mut group = criterion.benchmark_group("sampler");
    group.throughput(Throughput::Elements(count));
    for kind in [SamplerKind::Sobol, SamplerKind::Stratified, SamplerKind::Independent] {
        let sampler = Sampler::new(kind, 1, SPP);
        let mean = numbers(&sampler) / count as f64;
        // The mean of this many independent numbers is off by more than 0.005 in one of ten million cases.
        assert!((mean - 0.5).abs() < 0.005, "{kind:?}: {mean}");
        group.bench_function(BenchmarkId::from_parameter(format!("{kind:?}")), |bencher| {
            bencher.iter(|| numbers(black_box(&sampler)));
        });
    }
}

fn film(criterion: &mut Criterion) {
    let samples = vec![Rgb::new(0.25, 0.5, 0.75); (TILE * TILE * SPP) as usize];
    let region = Region { x: 0, y: 0, width: TILE, height: TILE };
    let mut film = Film::new(region, false).expect("a region");
    assert_eq!(film.tiles[0].add(&samples, SPP), 0);
    assert!(film.resolve().pixels.iter().all(|pixel| *pixel == [0.25, 0.5, 0.75]));
    let mut group = criterion.benchmark_group("film");
    group.throughput(Throughput::Elements(samples.len() as u64));
    group.bench_function("add", |bencher| {
        bencher.iter(|| film.tiles[0].add(black_box(&samples), SPP));
    });
    group.throughput(Throughput::Elements(u64::from(TILE * TILE)));
    group.bench_function("resolve", |bencher| bencher.iter(|| black_box(&film).resolve()));
}

criterion_group!(benches, samplers, film);
criterion_main!(benches);
