//! Kernels beside the processor's stages: integers and floating-point numbers have the same bits.

#![allow(clippy::unwrap_used, reason = "tests fail so")]

use crate::common::{device, scene_folder};
use spherule_core::internals::bvh::UNKNOWN;
use spherule_core::internals::ray::{MISS, Rays};
use spherule_gpu::{DeviceTree, FirstStages, Integrator as DeviceIntegrator};
use spherule_render::World;
use spherule_render::bvh::{Tracer, Tree};
use spherule_render::integrator::device::device_job;
use spherule_render::integrator::elisions::Elisions;
use spherule_render::integrator::generate::generate;
use spherule_render::integrator::workspace::Workspace;
use spherule_render::integrator::{Job, ao, stages};
use spherule_render::scene::{Integrator, Lens, Scene};
use spherule_render::settings::{Filter, SamplerKind};
use std::ops::Range;
use std::sync::Arc;

/// Pixels, and samples of each; the latter from two blocks of the Sobol sequence.
const PIXELS: u32 = 200;
const SAMPLES: Range<u32> = 65_530..65_540;

/// Runs the stages of a scene on the device and on the processor, up to what `finish` does, and compares.
fn compare(
    change: impl Fn(&mut Scene),
    finish: impl Fn(&Job, &mut Workspace),
    check: impl Fn(&Job, &FirstStages, &mut Workspace),
) {
    let device = device();
    for (name, filter) in [
        ("weekend.toml", Filter::Gaussian),
        ("paper-grid-20.toml", Filter::Box),
        ("veach.toml", Filter::BlackmanHarris),
    ] {
        let mut scene = Scene::load(&scene_folder().join(name)).unwrap();
        let settings = &mut scene.settings;
        (settings.width, settings.height, settings.filter) = (40, 30, filter);
        (settings.seed, settings.integrator) = (0x0123_4567_89ab, Integrator::Ao { distance: 3.0 });
        settings.sampler = SamplerKind::Sobol;
        change(&mut scene);
        let world = World::build(&scene).unwrap();
        let settings = &scene.settings;
        let job = Job::new(&world, settings, settings.spp, Tracer::default(), Elisions::ALL);
        let pixels: Vec<(u32, u32)> = (0..PIXELS).map(|i| (i % 20 * 2, i / 20 * 3)).collect();
        let tree = Tree { bvh: &world.bvh, spheres: &world.spheres };
        let tree = Arc::new(DeviceTree::new(device, tree).unwrap());
        let paths = DeviceIntegrator::new(&tree, &world).unwrap();
        let job_numbers = device_job(&job).unwrap();
        let found = paths.first_stages(&job_numbers, &pixels, &SAMPLES).unwrap();
        let mut work = Workspace::new(&world, Elisions::ALL);
        generate(&job, pixels.iter().copied(), SAMPLES, &mut work);
        assert_eq!(work.len(), found.camera_rays.len());
        finish(&job, &mut work);
        check(&job, &found, &mut work);
        assert_eq!(device.fault(), None, "{name}");
    }
}

/// Returns a ray as kernels have it, without the bounds.
fn row(rays: &Rays, row: usize) -> [u32; 8] {
    let [x, y, z] = rays.origin.row(row).to_array().map(f32::to_bits);
    let [u, v, w] = rays.direction.row(row).to_array().map(f32::to_bits);
    [x, y, z, u, v, w, rays.own[row], rays.target[row]]
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn generated_samples_and_rays_are_the_processors() {
    let change = |scene: &mut Scene| {
        scene.camera.lens = Some(Lens { aperture: 0.25, focus: Some(7.0) });
    };
    compare(
        change,
        |_, _| (),
        |job, found, work| {
            for path in 0..work.len() {
                assert_eq!(found.camera_rays[path][..8], row(&work.rays, path), "{path}");
            }
            for (place, first) in (0..PIXELS).zip((0..).step_by(SAMPLES.len())) {
                let (x, y) = (place % 20 * 2, place / 20 * 3);
                let start = job.sampler.start_row(x, y, SAMPLES.start);
                let positions = start.positions.positions.to_array();
                let seeds = start.positions.seeds.to_array();
                for sample in 0..SAMPLES.len() {
                    let own = [positions[sample], seeds[sample]];
                    assert_eq!(found.sequences[first + sample][..2], own, "{place} {sample}");
                }
            }
        },
    );
}

#[test]
#[ignore = "needs a GPU, or Vulkan in software"]
fn hits_and_shadow_rays_are_the_processors() {
    let hits = |job: &Job, work: &mut Workspace| stages::intersect(job, work);
    compare(
        |_| (),
        hits,
        |job, found, work| {
            let (mut known, mut compared) = (0, 0);
            for path in 0..work.len() {
                let hit = work.hits.sphere[path];
                let is_sphere = (hit as usize) < job.world.spheres.len();
                if found.found[path] != UNKNOWN {
                    assert_eq!(found.found[path], if is_sphere { hit } else { MISS }, "{path}");
                    known += 1;
                }
            }
            assert!(known * 20 > work.len() * 19, "{known}");
            // Points, normals and directions: what shadow rays start from.
            let mut other = Workspace::new(job.world, job.elisions);
            let pixels = (0..PIXELS).map(|i| (i % 20 * 2, i / 20 * 3));
            generate(job, pixels, SAMPLES, &mut other);
            let Integrator::Ao { distance } = job.settings.integrator else { panic!("occlusion") };
            ao::integrate(job, &mut other, distance);
            let shadows = &other.shadow_queue;
            for shadow in 0..other.counters.shadow_rays as usize {
                let path = shadows.path[shadow] as usize;
                let ray = &found.next_rays[path];
                // Rays that are not traced, for the ground hides the sky or something is unknown.
                if f32::from_bits(ray[9]) >= 0.0 {
                    assert_eq!(ray[..8], row(&shadows.rays, shadow), "{path}");
                    compared += 1;
                }
            }
            assert!(compared > 100, "{compared} of {}", other.counters.shadow_rays);
        },
    );
}
