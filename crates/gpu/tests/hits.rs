//! Hits of the device beside those of the processor: bit for bit, on all stress regimes and all workloads.

#![allow(clippy::unwrap_used, reason = "tests fail so")]
#![allow(clippy::print_stdout, reason = "the table of docs/gpu.md, with --nocapture")]

use crate::common::device;
use spherule_core::internals::bvh::builders::{Builder, build};
use spherule_core::internals::bvh::{Bvh, Tracer, Tree, UNKNOWN};
use spherule_core::internals::random::Random;
use spherule_core::internals::ray::{Hits as Found, MISS, Rays};
use spherule_core::internals::spheres::Spheres;
use spherule_core::{Hits, NOTHING, RayColumns, SphereTree};
use spherule_gpu::{Answered, Device, DeviceError, DeviceSpheres, DeviceTree};
use spherule_measure::stress::rays::Ray;
use spherule_measure::stress::{REGIMES, sample};
use spherule_measure::workload::{Class, SphereScene, Views};
use std::sync::Arc;

/// Rays in columns.
struct Columns([Vec<f32>; 6]);

impl Columns {
    fn new(rays: &[Ray]) -> Self {
        let column = |of: &dyn Fn(&Ray) -> f32| rays.iter().map(of).collect::<Vec<f32>>();
        Self(std::array::from_fn(|i| {
            column(&|ray| if i < 3 { ray.origin[i] } else { ray.direction[i - 3] })
        }))
    }

    fn view(&self) -> RayColumns<'_> {
        let [x, y, z, u, v, w] = &self.0;
        RayColumns { origin: [x, y, z], direction: [u, v, w] }
    }
}

/// Compares all answers of a tree on the device with its own.
fn compare(device: &Arc<Device>, spheres: &[[f32; 4]], rays: &[Ray], bounds: &[f64]) -> Answered {
    let tree = SphereTree::from_rows(spheres).unwrap();
    let on_device = DeviceSpheres::new(device, &tree).unwrap();
    let columns = Columns::new(rays);
    let columns = columns.view();
    let mut own = (bounds.to_vec(), vec![NOTHING; rays.len()]);
    let hits = Hits { t: &mut own.0, sphere: &mut own.1, surface: None };
    tree.intersect_columns(&columns, hits).unwrap();
    let mut others = (bounds.to_vec(), vec![7; rays.len()]);
    let hits = Hits { t: &mut others.0, sphere: &mut others.1, surface: None };
    let answered = on_device.intersect_columns(&columns, hits).unwrap();
    for (row, ray) in rays.iter().enumerate() {
        let pair = |hits: &(Vec<f64>, Vec<u32>)| (hits.0[row].to_bits(), hits.1[row]);
        assert_eq!(pair(&others), pair(&own), "{ray:?} among {spheres:?}");
    }
    let mut hidden = [vec![false; rays.len()], vec![true; rays.len()]];
    tree.occluded_columns(&columns, bounds, &mut hidden[0]).unwrap();
    on_device.occluded_columns(&columns, bounds, &mut hidden[1]).unwrap();
    assert_eq!(hidden[0], hidden[1]);
    assert_eq!(device.fault(), None);
    answered
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn hits_are_the_processors_on_all_stress_regimes() {
    let device = device();
    for (number, regime) in REGIMES.iter().enumerate() {
        let mut random = Random::new(number as u64);
        let mut all = Answered::default();
        for scene in 0..12 {
            let (spheres, rays) = sample(regime, 200, &mut random);
            let bounds: Vec<f64> = (0..rays.len())
                .map(|_| if scene % 2 == 0 { f64::INFINITY } else { random.decades([-1.0, 3.0]) })
                .collect();
            all += compare(device, &spheres, &rays, &bounds);
        }
        println!("{:20} {:6} rays, {:6} unknown", regime.name, all.rays, all.unknown);
        assert_eq!(all.rays, 2400);
    }
}

/// A tree over spheres, in the renderer's units.
fn build_tree(mut spheres: Spheres) -> (Spheres, Bvh) {
    let bvh = build(&mut spheres, Builder::default());
    (spheres, bvh)
}

/// Compares answers of a renderer's tree on the device with those of the processor; returns how many were unknown.
fn compare_tree(
    on_device: &DeviceTree,
    tree: Tree,
    rays: &Rays,
    start: &Found,
    any: bool,
) -> Answered {
    let (mut own, mut others) = (start.clone(), start.clone());
    if any {
        Tracer::default().occluded(tree, rays, &mut own);
    } else {
        Tracer::default().closest(tree, rays, &mut own);
    }
    let answered = if any {
        on_device.occluded(tree, rays, &mut others)
    } else {
        on_device.closest(tree, rays, &mut others)
    };
    for row in 0..rays.len() {
        let ray = rays.exact(row);
        if any {
            assert_eq!(others.sphere[row] == MISS, own.sphere[row] == MISS, "{row} {ray:?}");
        } else {
            let pair = |hits: &Found| (hits.t[row].to_bits(), hits.sphere[row]);
            assert_eq!(pair(&others), pair(&own), "{row} {ray:?} {}", rays.own[row]);
        }
    }
    answered
}

/// Compares all classes of rays of a workload.
fn compare_workload(device: &Arc<Device>, scene: SphereScene, side: u32, cut: Option<u64>) {
    let (spheres, bvh) = build_tree(scene.spheres().unwrap());
    let tree = Tree { bvh: &bvh, spheres: &spheres };
    let on_device = match cut {
        Some(most) => DeviceTree::cut(device, tree, most).unwrap(),
        None => DeviceTree::new(device, tree).unwrap(),
    };
    let views = Views::new(scene, tree, side);
    for class in Class::ALL {
        let rays = views.rays(class);
        let start = Found::with_capacity(rays.len());
        let answered = compare_tree(&on_device, tree, rays, &start, class.is_any());
        let share = answered.unknown as f64 / answered.rays.max(1) as f64;
        let visits = on_device.visits(rays, &start, class.is_any()).unwrap();
        let mean = |kind: usize| {
            let sum: f64 = visits.iter().map(|visits| f64::from(visits[kind])).sum();
            sum / visits.len() as f64
        };
        let (name, nodes, leaves) = (class.name(), mean(0), mean(1));
        println!(
            "{:12} {name:10} {:6} rays, {share:.1e} unknown, {nodes:.1} nodes, {leaves:.1} leaves",
            scene.name,
            rays.len()
        );
        assert!((0.5..200.0).contains(&nodes) && leaves < nodes * 8.0, "{nodes} {leaves}");
        assert_eq!(answered.rays, rays.len() as u64);
        assert!(share < 0.05, "{} {}: {share}", scene.name, class.name());
    }
    assert_eq!(device.fault(), None);
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn hits_are_the_processors_on_the_workloads() {
    let device = device();
    for scene in SphereScene::ALL.iter().filter(|scene| scene.count <= 1_000_188) {
        compare_workload(device, *scene, 96, None);
    }
}

#[test]
#[ignore = "needs a GPU, gigabytes and minutes"]
fn hits_are_the_processors_on_ten_million_spheres() {
    let device = device();
    compare_workload(device, SphereScene::VOLUME10M, 128, None);
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn columns_are_cut_where_they_do_not_fit_and_what_does_not_fit_at_all_is_refused() {
    let device = device();
    // 10 000 spheres of 16 bytes in columns of 4096, and rays in many batches.
    compare_workload(device, SphereScene::VOLUME10K, 48, Some(1 << 16));
    let (spheres, bvh) = build_tree(SphereScene::VOLUME10K.spheres().unwrap());
    let tree = Tree { bvh: &bvh, spheres: &spheres };
    let refused = DeviceTree::cut(device, tree, 1 << 15).err();
    let what = "10000 spheres".to_owned();
    assert_eq!(refused, Some(DeviceError::Memory { what }));
    assert_eq!(device.fault(), None);
}

/// Spheres, some of which contain, touch or equal others.
fn crowd(random: &mut Random) -> Spheres {
    let mut spheres = Spheres::with_capacity(300);
    let mut rows: Vec<(glam::Vec3, f32)> = Vec::new();
    for id in 0..300 {
        let (center, radius) = match id % 10 {
            0 => (random.in_cube().as_vec3() * 0.5, 0.3),
            1 => rows[random.index(rows.len())],
            2 => {
                let (center, radius) = rows[random.index(rows.len())];
                (center + (random.direction() * f64::from(radius)).as_vec3() * 0.5, radius * 0.5)
            }
            _ => (random.in_cube().as_vec3() * 0.9, 0.05 * random.unit() as f32 + 1e-4),
        };
        rows.push((center, radius));
        spheres.push(center, radius, id);
    }
    spheres
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn rays_from_surfaces_and_toward_lights_hit_what_they_hit_on_the_processor() {
    let device = device();
    let mut random = Random::new(8);
    let (mut all, mut answers) = (Answered::default(), [0; 2]);
    for _ in 0..6 {
        let (spheres, bvh) = build_tree(crowd(&mut random));
        let tree = Tree { bvh: &bvh, spheres: &spheres };
        let on_device = DeviceTree::new(device, tree).unwrap();
        let mut rays = Rays::with_capacity(1500);
        let mut start = Found::with_capacity(1500);
        for row in 0..1500 {
            let own = random.index(spheres.len());
            let (center, radius) = spheres.exact(own);
            let (normal, direction) = (random.direction(), random.direction().as_vec3());
            let from_surface = row % 4 != 0;
            let origin = if from_surface { center + normal * radius } else { random.in_cube() };
            let own = if from_surface { own as u32 } else { MISS };
            rays.push(origin.as_vec3(), direction, own);
            let cosine = direction.as_dvec3().dot(normal);
            if from_surface && cosine < 0.0 {
                start.set(row, -2.0 * radius * cosine, own);
            } else if row % 5 == 0 {
                start.t[row] = random.unit();
            }
        }
        let mut shadow = rays.clone();
        let mut open = start.clone();
        for row in 0..1500 {
            open.sphere[row] = if row % 50 == 0 { 3 } else { MISS };
            shadow.target[row] = random.index(spheres.len()) as u32;
        }
        all += compare_tree(&on_device, tree, &rays, &start, false);
        all += compare_tree(&on_device, tree, &shadow, &open, true);
        let found = on_device.find(&rays, &start, false).unwrap();
        answers[0] += found.iter().filter(|&&sphere| sphere < UNKNOWN).count();
        answers[1] += found.iter().filter(|&&sphere| sphere == MISS).count();
    }
    assert!(answers[0] > 1000 && answers[1] > 1000, "{answers:?}");
    assert!(all.unknown * 4 < all.rays, "{all:?}");
    assert_eq!(device.fault(), None);
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn rays_out_of_range_are_unknown_and_trees_without_spheres_are_missed() {
    let device = device();
    let spheres = Spheres::from_columns(&[0.5], &[0.0], &[0.0], &[0.25]);
    let (spheres, bvh) = build_tree(spheres);
    let tree = Tree { bvh: &bvh, spheres: &spheres };
    let on_device = DeviceTree::new(device, tree).unwrap();
    let x = glam::Vec3::X;
    let mut rays = Rays::with_capacity(8);
    for (origin, direction) in [
        (-x, x),
        (-x, -x),
        (x * -2e6, x),
        (-x, x * 0.1),
        (-x, x * 8.0),
        (-x, x * f32::NAN),
        (x * f32::INFINITY, x),
        (-x, x * 0.0),
    ] {
        rays.push(origin, direction, MISS);
    }
    let start = Found::with_capacity(8);
    let found = on_device.find(&rays, &start, false).unwrap();
    let [u, m] = [UNKNOWN, MISS];
    assert_eq!(found, [0, m, u, u, u, u, u, u]);
    assert_eq!(on_device.find(&rays, &start, true).unwrap(), found);
    let (nothing, no_tree) = build_tree(Spheres::default());
    let empty = DeviceTree::new(device, Tree { bvh: &no_tree, spheres: &nothing }).unwrap();
    assert_eq!(empty.find(&rays, &start, false).unwrap(), [MISS; 8]);
}
