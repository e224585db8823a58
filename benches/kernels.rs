//! Intersection kernels: ray against sphere at every lane width, ray against eight boxes, and the
//! double-precision confirmation. All data fits in the first-level cache.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec3, Vec3 as Point};
use spherule_core::internals::conservative::{Chord, ConservativeRay};
use spherule_core::internals::intersect::confirm;
use spherule_core::internals::lanes::{F32x4, F32x8, F32x16, Lanes, Mask};
use spherule_core::internals::ray::{ExactRay, MISS, Rays};
use spherule_core::internals::slabs::{Planes, RaySlabs, Slabs};
use spherule_core::internals::vec3::Vec3;
use spherule_render::sampling::{stream, uniform_sphere, unit_pair};
use std::hint::black_box;

/// A kernel that counts the pairs of rays and spheres that pass a test.
type Kernel = fn(&[(Point, f32)], &Rays) -> u32;

const RAYS: usize = 16;
const SPHERES: usize = 512;

/// Returns spheres in the unit cube, and rays from outside that point into it.
fn data() -> (Vec<(Point, f32)>, Rays) {
    let point = |i: u64| {
        let ([x, y], [z, r]) = (unit_pair(stream(i, 0)), unit_pair(stream(i, 1)));
        (Point::new(x, y, z), 0.02 + 0.1 * r)
    };
    let spheres: Vec<_> = (0..SPHERES as u64).map(point).collect();
    let mut rays = Rays::with_capacity(RAYS);
    for i in 0..RAYS as u64 {
        let origin = Point::splat(0.5) + 2.0 * uniform_sphere(unit_pair(stream(9, i)));
        rays.push(origin, (point(1000 + i).0 - origin).normalize(), MISS);
    }
    (spheres, rays)
}

fn hits_by_filter<L: Lanes>(spheres: &[(Point, f32)], rays: &Rays) -> u32 {
    let mut hits = 0;
    for row in (0..RAYS).step_by(L::WIDTH) {
        let ray = ConservativeRay::new(rays.origin.load::<L>(row), rays.direction.load::<L>(row));
        for &(c, radius) in spheres {
            let center = Vec3::splat(c.x, c.y, c.z);
            let chord = Chord::new(&ray, center, L::splat(radius));
            hits += chord.may_hit(L::splat(f32::INFINITY)).bits().count_ones();
        }
    }
    hits
}

/// Returns bounding boxes of the spheres, eight at a time.
fn boxes(spheres: &[(Point, f32)]) -> Vec<Planes> {
    let planes = |eight: &[(Point, f32)]| {
        std::array::from_fn(|axis| {
            [-1.0, 1.0].map(|side| std::array::from_fn(|i| eight[i].0[axis] + side * eight[i].1))
        })
    };
    spheres.chunks_exact(8).map(planes).collect()
}

fn boxes_entered(boxes: &[Planes], rays: &Rays) -> u32 {
    let mut entered = 0;
    for row in 0..RAYS {
        let ray = RaySlabs::new(rays.origin.row(row), rays.direction.row(row));
        for planes in boxes {
            entered += ray.enters(planes, f32::INFINITY).0.count_ones();
        }
    }
    entered
}

fn hits_by_confirm(spheres: &[(DVec3, f64)], rays: &[ExactRay]) -> u32 {
    let hit = |ray: &ExactRay| {
        spheres
            .iter()
            .filter(|(center, radius)| confirm(ray, *center, *radius, || true).is_some())
            .count()
    };
    rays.iter().map(|ray| hit(ray) as u32).sum()
}

fn kernels(criterion: &mut Criterion) {
    let (spheres, rays) = data();
    let wide: Vec<_> = spheres.iter().map(|(c, r)| (c.as_dvec3(), f64::from(*r))).collect();
    let exact: Vec<_> = (0..RAYS).map(|row| rays.exact(row)).collect();
    let hits = hits_by_confirm(&wide, &exact);
    let boxes = boxes(&spheres);
    let entered = boxes_entered(&boxes, &rays);
    assert!(hits > 0 && entered > hits && entered < 3 * hits);

    let mut bench = |name: &str, expected: u32, kernels: [(&str, Kernel); 4]| {
        let mut group = criterion.benchmark_group(name);
        group.throughput(Throughput::Elements((RAYS * SPHERES) as u64));
        for (width, kernel) in kernels {
            assert_eq!(kernel(&spheres, &rays), expected, "{name}, {width} lanes");
            group.bench_function(width, |bencher| {
                bencher.iter(|| kernel(black_box(&spheres), black_box(&rays)));
            });
        }
    };
    // In this easy scene, the conservative test passes only true hits.
    bench(
        "sphere",
        hits,
        [
            ("1", hits_by_filter::<f32>),
            ("4", hits_by_filter::<F32x4>),
            ("8", hits_by_filter::<F32x8>),
            ("16", hits_by_filter::<F32x16>),
        ],
    );
    let mut group = criterion.benchmark_group("box");
    group.throughput(Throughput::Elements((RAYS * SPHERES) as u64));
    group.bench_function("8", |bencher| {
        bencher.iter(|| boxes_entered(black_box(&boxes), black_box(&rays)));
    });
    group.finish();
    let mut group = criterion.benchmark_group("exact");
    group.throughput(Throughput::Elements((RAYS * SPHERES) as u64));
    group.bench_function("1", |bencher| {
        bencher.iter(|| hits_by_confirm(black_box(&wide), black_box(&exact)));
    });
}

criterion_group!(benches, kernels);
criterion_main!(benches);
