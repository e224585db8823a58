//! Measures Embree beside Spherule: the same spheres and rays, in one run, by turns, one thread.

mod builds;
mod contest;
mod embree;
mod files;
mod levels;
mod options;
mod rays;
mod referee;
mod report;
mod scenes;

use builds::Builds;
use clap::Parser;
use contest::{Contest, Entry, Outcome};
use embree::{Device, EmbreeError, Scene};
use levels::Runner;
use options::Options;
use rays::{Class, Order, Rays, Seen};
use scenes::Columns;
use spherule_core::SphereTree;
use spherule_measure::workload::SphereScene;
use std::error::Error;
use std::fs;
use std::io::{Write, stderr, stdout};
use std::process::ExitCode;

fn main() -> ExitCode {
    match run(&Options::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            // There is nobody left to tell if this fails.
            let _ = writeln!(stderr(), "error: {error}");
            let mut cause = error.source();
            while let Some(error) = cause {
                let _ = writeln!(stderr(), "because: {error}");
                cause = error.source();
            }
            ExitCode::FAILURE
        }
    }
}

fn run(options: &Options) -> Result<(), Box<dyn Error>> {
    if options.serve {
        return levels::serve(options);
    }
    let runners = options.level.iter().map(|program| Runner::start(program, options));
    let mut runners = runners.collect::<Result<Vec<_>, _>>()?;
    let (mut outcomes, mut builds) = (Vec::new(), Vec::new());
    if let (Some(spheres), Some(rays)) = (&options.spheres, &options.rays) {
        let (spheres, rays) = (files::spheres(spheres)?, files::rays(rays)?);
        build(options, "file", &spheres, &mut builds)?;
        compare(options, "file", &spheres, |contest| {
            for (order, rays) in [(Order::File, &rays), (Order::Random, &rays.shuffled())] {
                outcomes.push(run_class(contest, options.query, order, rays, &mut [])?);
            }
            Ok(())
        })?;
    } else {
        for &scene in &options.scenes {
            let spheres = Columns::of(scene)?;
            build(options, scene.name, &spheres, &mut builds)?;
            compare(options, scene.name, &spheres, |contest| {
                trace(options, scene, contest, &mut runners, &mut outcomes)
            })?;
        }
    }
    report::write(&mut stdout().lock(), options, &outcomes, &builds)?;
    if let Some(path) = &options.json {
        let written = fs::write(path, json(options, &outcomes, &builds)?);
        written.map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    }
    Ok(())
}

/// Measures builds, if they are asked for.
fn build(
    options: &Options,
    name: &str,
    spheres: &Columns,
    builds: &mut Vec<Builds>,
) -> Result<(), Box<dyn Error>> {
    if !options.no_builds {
        writeln!(stderr(), "{name}: builds")?;
        builds.push(builds::measure(options, name, spheres, false)?);
        builds.push(builds::measure(options, name, &spheres.sorted(), true)?);
    }
    Ok(())
}

/// Builds both systems' trees over spheres, and calls `run` with them.
fn compare(
    options: &Options,
    name: &str,
    spheres: &Columns,
    run: impl FnOnce(&Contest) -> Result<(), Box<dyn Error>>,
) -> Result<(), Box<dyn Error>> {
    let Columns { x, y, z, radius } = spheres;
    let tree = SphereTree::from_columns(x, y, z, radius)?;
    let order = spheres.morton_order();
    let rows = |order: &mut dyn Iterator<Item = u32>| -> Vec<_> {
        order.map(|row| spheres.row(row as usize)).collect()
    };
    let (filed, sorted) = (rows(&mut (0..order.len() as u32)), rows(&mut order.iter().copied()));
    let devices = options.configuration.iter().map(|text| options.device(text, 1));
    let devices = devices.collect::<Result<Vec<_>, _>>()?;
    let build = |device| -> Result<[Scene<'_>; 2], EmbreeError> {
        let build = |rows: &[_]| Device::build(device, rows, options.build());
        Ok([build(&filed)?, build(&sorted)?])
    };
    let embree = devices.iter().map(build).collect::<Result<Vec<_>, _>>()?;
    run(&Contest {
        scene: name,
        spheres,
        tree: &tree,
        order: &order,
        hits_only: options.hits_only,
        embree: &embree,
        entries: &Entry::all(embree.len(), &options.calls),
        finalists: options.finalists,
        rounds: options.rounds,
    })
}

/// Measures all classes of rays in a scene.
fn trace(
    options: &Options,
    scene: SphereScene,
    contest: &Contest,
    runners: &mut [Runner],
    outcomes: &mut Vec<Outcome>,
) -> Result<(), Box<dyn Error>> {
    for runner in &mut *runners {
        runner.load(scene)?;
    }
    for &order in &options.orders {
        let side = options.side.next_multiple_of(4);
        let seen = Seen::new(scene.flat, contest.spheres, contest.tree, side, order)?;
        for &class in &options.classes {
            let rays = seen.rays(class, order);
            if rays.len() > 0 {
                outcomes.push(run_class(contest, class, order, &rays, runners)?);
            }
        }
    }
    Ok(())
}

/// Measures rays.
fn run_class(
    contest: &Contest,
    class: Class,
    order: Order,
    rays: &Rays,
    runners: &mut [Runner],
) -> Result<Outcome, Box<dyn Error>> {
    writeln!(stderr(), "{}: {} rays, {}", contest.scene, class.name(), order.name())?;
    for runner in &mut *runners {
        runner.make_rays(class, order, rays)?;
    }
    contest.run(class, order, rays, runners)
}

fn json(
    options: &Options,
    outcomes: &[Outcome],
    builds: &[Builds],
) -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(&serde_json::json!({
        "side": options.side.next_multiple_of(4),
        "orders": options.orders,
        "hits_only": options.hits_only,
        "rounds": options.rounds,
        "configuration": options.configuration,
        "quality": options.quality,
        "robust": options.robust,
        "outcomes": outcomes,
        "builds": builds,
    }))
}
