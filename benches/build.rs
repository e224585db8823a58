//! BVH construction: million spheres per second of each builder, for the paper's fields and for volumes, on
//! all threads of the machine (set `RAYON_NUM_THREADS` for fewer).

use criterion::{BatchSize, BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use spherule_core::internals::bvh::builders::{Builder, build};
use spherule_core::internals::elementary::{ceil_log2, power_of_two};
use spherule_core::internals::spheres::Spheres;
use spherule_render::scene::generate::{Field, Generator, Volume};
use std::hint::black_box;
use std::time::Duration;

/// Returns generated spheres, scaled as in a world by a power of two to coordinates of about 1.
fn spheres(generator: &Generator) -> Spheres {
    let from = generator.generate(1).expect("parameters are valid").spheres;
    let reach = (0..from.len()).map(|i| from.center(i).abs().max_element()).fold(0.0, f64::max);
    let scale = power_of_two(-ceil_log2(reach));
    let column = |values: &[f64]| values.iter().map(|x| (x * scale) as f32).collect::<Vec<_>>();
    let [x, y, z] = [column(&from.x), column(&from.y), column(&from.z)];
    Spheres::from_columns(&x, &y, &z, &column(&from.radius))
}

fn builders(criterion: &mut Criterion) {
    let field = |count| Generator::Field(Field { count, ..Field::default() });
    let volume = Generator::Volume(Volume { count: 1_000_000, ..Volume::default() });
    let scenes = [
        ("field400", field(20)),
        ("field2500", field(50)),
        ("field250k", field(500)),
        ("volume1m", volume),
    ];
    for (name, generator) in scenes {
        let spheres = spheres(&generator);
        let mut group = criterion.benchmark_group(name);
        group.sample_size(10).warm_up_time(Duration::from_millis(500));
        group.throughput(Throughput::Elements(spheres.len() as u64));
        for builder in Builder::ALL {
            let id = BenchmarkId::from_parameter(format!("{builder:?}"));
            group.bench_function(id, |bencher| {
                let fresh = || spheres.clone();
                let built = |mut spheres| black_box((build(&mut spheres, builder), spheres));
                bencher.iter_batched(fresh, built, BatchSize::LargeInput);
            });
        }
        group.finish();
    }
}

criterion_group!(benches, builders);
criterion_main!(benches);
