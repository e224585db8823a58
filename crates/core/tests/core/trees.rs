//! Trees of every builder: sound, shallow, small, functions of the spheres alone, and not spoiled
//! by a few spheres that are unlike the others.

use glam::Vec3;
use spherule_core::internals::bvh::Bvh;
use spherule_core::internals::bvh::builders::{Builder, build};
use spherule_core::internals::random::numbered;
use spherule_core::internals::spheres::{LEAF, Spheres};

/// Number `k` of sphere `i`, in [0, 1).
fn number(i: usize, k: u64) -> f32 {
    numbered(i as u64, k)
}

fn point(i: usize) -> Vec3 {
    Vec3::new(number(i, 1), number(i, 2), number(i, 3)) * 2.0 - 1.0
}

fn normal(i: usize, k: u64) -> f32 {
    let [a, b] = [k, k + 8].map(|k| number(i, k));
    (-2.0 * (1.0 - a).ln()).sqrt() * (std::f32::consts::TAU * b).cos()
}

fn spheres(rows: &[(Vec3, f32)]) -> Spheres {
    let column = |f: fn(&(Vec3, f32)) -> f32| rows.iter().map(f).collect::<Vec<_>>();
    let [x, y, z] = [column(|s| s.0.x), column(|s| s.0.y), column(|s| s.0.z)];
    Spheres::from_columns(&x, &y, &z, &column(|s| s.1))
}

fn many(count: usize, sphere: impl Fn(usize) -> (Vec3, f32)) -> Vec<(Vec3, f32)> {
    (0..count).map(sphere).collect()
}

fn cloud(count: usize) -> Vec<(Vec3, f32)> {
    many(count, |i| (point(i), 0.2 / (count as f32).cbrt()))
}

/// Scenes that are hard for builders, without crowds of coincident spheres.
fn scenes() -> Vec<(&'static str, Vec<(Vec3, f32)>)> {
    let halves = |i: usize| 0.5_f32.powi(i as i32);
    let mut scenes = vec![
        ("cloud", cloud(5000)),
        ("line", many(3000, |i| (Vec3::Y * (i as f32 / 3000.0), 1e-4))),
        ("diagonal", many(3000, |i| (Vec3::splat(i as f32 / 3000.0), 1e-4))),
        ("decades", many(4000, |i| (point(i) * 10_f32.powf(-30.0 * number(i, 4)), 1e-33))),
        ("radii", many(4000, |i| (point(i), 0.5 * 10_f32.powf(-37.0 * number(i, 4))))),
        (
            "halving",
            many(1160, |i| (Vec3::X * halves(i / 8), halves(i / 8 + 4) * (1.0 + (i % 8) as f32))),
        ),
        ("corner", many(1160, |i| (point(i) * halves(i / 8), 1e-38))),
        ("denormal", many(900, |i| (point(i) * 1e-42, 1e-44))),
        ("shells", many(900, |i| (Vec3::ZERO, 0.5 + 1e-5 * i as f32))),
        ("places", many(900, |i| (point(i % 30), 0.1 + 1e-4 * i as f32))),
        ("crowds", many(900, |i| (point(i % 9), 0.1 + 1e-4 * i as f32))),
        (
            "lattice",
            many(4096, |i| {
                (Vec3::new((i % 16) as f32, (i / 16 % 16) as f32, (i / 256) as f32) / 16.0, 0.03)
            }),
        ),
        ("leaf and one", cloud(LEAF + 1)),
        ("one", cloud(1)),
        ("none", cloud(0)),
    ];
    let dust = many(3000, |i| (point(i) * 1e-6, 1e-8));
    scenes.push(("giant and dust", [dust, vec![(Vec3::new(0.0, -0.5, 0.0), 0.5)]].concat()));
    scenes
}

/// The tree, and the rows in its order.
fn built(rows: &[(Vec3, f32)], builder: Builder) -> (Bvh, Vec<u32>) {
    let mut spheres = spheres(rows);
    let bvh = build(&mut spheres, builder);
    bvh.validate(&spheres).unwrap_or_else(|error| panic!("{builder:?}: {error}"));
    (bvh, spheres.id)
}

fn for_all(test: impl Fn(&str, &[(Vec3, f32)], Builder)) {
    for (name, rows) in scenes() {
        for builder in Builder::ALL {
            test(&format!("{name}, {builder:?}"), &rows, builder);
        }
    }
}

#[test]
fn trees_hold_every_sphere_and_are_shallow() {
    for_all(|name, rows, builder| {
        let (bvh, mut ids) = built(rows, builder);
        ids.sort_unstable();
        assert!(ids.into_iter().eq(0..rows.len() as u32), "{name}");
        assert_eq!(bvh.is_empty(), rows.is_empty(), "{name}");
    });
}

#[test]
fn the_first_of_coincident_spheres_is_kept() {
    for builder in Builder::ALL {
        let crowd = many(500, |_| (Vec3::splat(0.25), 0.5));
        assert_eq!(built(&crowd, builder).1, [0], "{builder:?}");
    }
}

/// However many threads there are, whatever the order of rows.
#[test]
fn trees_are_functions_of_the_spheres() {
    let in_pool = |threads, rows: &[_], builder| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| built(rows, builder))
    };
    let mut scenes = scenes();
    scenes.push(("large cloud", cloud(60_000)));
    for (name, rows) in scenes {
        // One-to-one: no scene has a multiple of 7919 spheres.
        let from = |i: usize| i * 7919 % rows.len();
        let shuffled: Vec<_> = (0..rows.len()).map(|i| rows[from(i)]).collect();
        for builder in Builder::ALL {
            let (tree, ids) = in_pool(1, &rows, builder);
            for threads in [2, 7] {
                let other = in_pool(threads, &rows, builder);
                assert!(other == (tree.clone(), ids.clone()), "{name}, {builder:?}, {threads}");
            }
            let (other, other_ids) = in_pool(2, &shuffled, builder);
            let other_ids = other_ids.into_iter().map(|id| from(id as usize) as u32);
            assert!(other == tree && other_ids.eq(ids), "{name}, {builder:?}, shuffled");
        }
    }
}

#[test]
fn trees_are_small() {
    for rows in [cloud(100_000), many(50_000, |i| (point(i), 0.005 * normal(i, 7).exp()))] {
        for builder in Builder::ALL {
            let each = built(&rows, builder).0.bytes() as f64 / rows.len() as f64;
            assert!(each < 7.5, "{builder:?} takes {each} bytes for a sphere");
        }
    }
}

/// Returns the expected number of nodes and blocks that a ray visits, times the area of the box.
fn weight(bvh: &Bvh) -> f64 {
    let size = bvh.bounds().map_or(Vec3::ZERO, |bounds| bounds.high - bounds.low);
    let area = size.x * size.y + size.y * size.z + size.z * size.x;
    (bvh.cost().nodes + bvh.cost().spheres / LEAF as f64) * f64::from(area)
}

#[test]
fn the_surface_area_heuristic_is_not_spoiled_by_giants() {
    let small = cloud(20_000);
    let alone = weight(&built(&small, Builder::SurfaceArea).0);
    for giants in [
        vec![(Vec3::new(0.0, -101.0, 0.0), 100.0)],
        vec![(Vec3::ZERO, 1.0)],
        many(5, |i| (point(i + 77), 0.7)),
    ] {
        let (bvh, _) = built(&[small.clone(), giants.clone()].concat(), Builder::SurfaceArea);
        let size = bvh.bounds().map_or(Vec3::ZERO, |bounds| bounds.high - bounds.low);
        let area = size.x * size.y + size.y * size.z + size.z * size.x;
        // The root, and the leaf of the giants.
        let least = 2.0 * f64::from(area);
        let more = (weight(&bvh) - least) / alone;
        assert!(more < 1.1, "{giants:?}: {more} times as much");
    }
}

/// The heuristic pays for spheres of different sizes.
#[test]
fn the_surface_area_heuristic_beats_the_median() {
    let place = |i| 0.2 * Vec3::new(normal(i, 1), normal(i, 2), normal(i, 3));
    let rows = many(30_000, |i| (place(i), 0.002 * (1.2 * normal(i, 7)).exp()));
    let [median, best] =
        [Builder::Median, Builder::SurfaceArea].map(|builder| weight(&built(&rows, builder).0));
    assert!(best < 0.95 * median, "{best} and {median}");
}
