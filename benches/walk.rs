//! Ray traversal: brute force, single and interleaved rays, packets of 4, 8 and 16 rays, and the automatic
//! choice, for four classes of rays; also without the exact decision, to measure its cost. Rays are generated
//! beforehand, and hits are compared with those of single rays.

#![allow(clippy::disallowed_methods, reason = "scenes that are only timed")]

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use glam::Vec3;
use spherule_core::internals::bvh::builders::{Builder, build};
use spherule_core::internals::bvh::{Any, Closest, Query, Traversal, Tree, Unverified, trace};
use spherule_core::internals::bvh::{Bounds, Bvh};
use spherule_core::internals::lanes::{F32x4, F32x8, F32x16, Lanes};
use spherule_core::internals::ray::{Hits, MISS, Rays};
use spherule_core::internals::spheres::Spheres;
use spherule_render::sampling::{Basis, cosine_hemisphere, stream, unit_pair};
use spherule_render::scene::generate::{Field, Generator, Volume};
use std::hint::black_box;
use std::time::Duration;

/// Width and height in pixels of the image whose rays are traced.
const SIDE: u32 = 256;

/// A traversal to measure.
type Walk = fn(&Case, Traversal, &Rays) -> Hits;

struct Case {
    name: &'static str,
    spheres: Spheres,
    bvh: Bvh,
}

/// Returns generated spheres, scaled as in a world by a power of two to coordinates of about 1.
fn case(name: &'static str, generator: &Generator) -> Case {
    let from = generator.generate(1).expect("parameters are valid").spheres;
    let reach = (0..from.len()).map(|i| from.center(i).abs().max_element()).fold(0.0, f64::max);
    let scale = (-reach.log2().ceil()).exp2();
    let column = |values: &[f64]| values.iter().map(|x| (x * scale) as f32).collect::<Vec<_>>();
    let mut spheres = Spheres::from_columns(
        &column(&from.x),
        &column(&from.y),
        &column(&from.z),
        &column(&from.radius),
    );
    let bvh = build(&mut spheres, Builder::default());
    bvh.validate(&spheres).expect("the tree is sound");
    Case { name, spheres, bvh }
}

fn closest<L: Lanes>(case: &Case, traversal: Traversal, rays: &Rays) -> Hits {
    run::<L, Closest>(case, traversal, rays)
}

fn run<L: Lanes, Q: Query>(case: &Case, traversal: Traversal, rays: &Rays) -> Hits {
    let mut hits = Hits::with_capacity(rays.len());
    trace::<L, Q>(traversal, Tree { bvh: &case.bvh, spheres: &case.spheres }, rays, &mut hits);
    hits
}

/// Returns camera rays from a corner, in blocks of 4 x 4 pixels.
fn camera(case: &Case) -> Rays {
    let Bounds { low, high } = case.bvh.bounds().expect("there are spheres");
    let (middle, size) = ((low + high) / 2.0, (high - low).length());
    let forward = Vec3::new(-0.5, -0.6, -0.6).normalize();
    let eye = middle - forward * size;
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let mut rays = Rays::with_capacity((SIDE * SIDE) as usize);
    for i in 0..SIDE * SIDE {
        let (block, inside) = (i / 16, i % 16);
        let x = block % (SIDE / 4) * 4 + inside % 4;
        let y = block / (SIDE / 4) * 4 + inside / 4;
        let across = |p: u32| (p as f32 + 0.5) / SIDE as f32 - 0.5;
        let direction = forward + right * across(x) - up * across(y);
        rays.push(eye, direction.normalize(), MISS);
    }
    rays
}

/// Returns rays from visible points, toward a light or cosine-distributed.
fn secondary(case: &Case, toward: Option<Vec3>) -> Rays {
    let primary = camera(case);
    let hits = closest::<f32>(case, Traversal::Single, &primary);
    let mut rays = Rays::with_capacity(primary.len());
    for row in (0..primary.len()).filter(|&row| hits.sphere[row] != MISS) {
        let sphere = hits.sphere[row] as usize;
        let center = case.spheres.center(sphere).as_dvec3();
        let normal = (primary.exact(row).at(hits.t[row]) - center).normalize();
        let point = (center + normal * f64::from(case.spheres.radius(sphere))).as_vec3();
        let direction = toward.unwrap_or_else(|| {
            let u = unit_pair(stream(2, row as u64));
            Basis::new(normal.as_vec3()).to_world(cosine_hemisphere(u)).normalize()
        });
        if direction.dot(normal.as_vec3()) > 0.0 {
            rays.push(point, direction, sphere as u32);
        }
    }
    rays
}

fn bench_class<Q: Query>(criterion: &mut Criterion, case: &Case, class: &str, rays: &Rays) {
    let mut group = criterion.benchmark_group(format!("{}/{class}", case.name));
    group.throughput(Throughput::Elements(rays.len() as u64)).sample_size(10);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    let expected = run::<f32, Q>(case, Traversal::Single, rays);
    let mut bench = |name: &str, walk: Walk, traversal| {
        let missed = |hits: &Hits, row: usize| hits.sphere[row] == MISS;
        let same = |hits: &Hits| {
            if Q::ANY {
                (0..rays.len()).all(|row| missed(hits, row) == missed(&expected, row))
            } else {
                hits.sphere == expected.sphere && hits.t == expected.t
            }
        };
        assert!(same(&walk(case, traversal, rays)), "{name} differs from single rays");
        group.bench_function(BenchmarkId::from_parameter(name), |bencher| {
            bencher.iter(|| walk(black_box(case), traversal, black_box(rays)));
        });
    };
    if case.spheres.len() <= 1000 {
        bench("brute-16", run::<F32x16, Q>, Traversal::Brute);
    }
    bench("single", run::<f32, Q>, Traversal::Single);
    bench("stream", run::<f32, Q>, Traversal::Stream);
    bench("packet-4", run::<F32x4, Q>, Traversal::Packet);
    bench("packet-8", run::<F32x8, Q>, Traversal::Packet);
    bench("packet-16", run::<F32x16, Q>, Traversal::Packet);
    bench("auto", run::<F32x16, Q>, Traversal::Auto);
    // The cost of exactness: the same traversal without it. Few hits differ in easy scenes.
    let rough = run::<F32x16, Unverified<Q>>;
    let hits = rough(case, Traversal::Auto, rays);
    let differ = (0..rays.len())
        .filter(|&row| (hits.sphere[row] == MISS) != (expected.sphere[row] == MISS))
        .count();
    assert!(differ * 1000 <= rays.len(), "without exactness, {differ} rays differ");
    group.bench_function(BenchmarkId::from_parameter("rough"), |bencher| {
        bencher.iter(|| rough(black_box(case), Traversal::Auto, black_box(rays)));
    });
}

fn walks(criterion: &mut Criterion) {
    let field = Generator::Field(Field { count: 20, ..Field::default() });
    let volume = Generator::Volume(Volume { count: 100_000, ..Volume::default() });
    for case in [case("field400", &field), case("volume100k", &volume)] {
        let light = Vec3::new(0.5, 1.0, 0.3).normalize();
        bench_class::<Closest>(criterion, &case, "camera", &camera(&case));
        bench_class::<Any>(criterion, &case, "shadow", &secondary(&case, Some(light)));
        bench_class::<Any>(criterion, &case, "occlusion", &secondary(&case, None));
        bench_class::<Closest>(criterion, &case, "diffuse", &secondary(&case, None));
    }
}

criterion_group!(benches, walks);
criterion_main!(benches);
