//! `spherule info`: prints the contents of a scene or a particle file, and its memory.

mod columns;
mod particles;
mod rows;

use self::particles::ParticleInfo;
use self::rows::RowInfo;
use super::contents::{BodyCounts, dropped, found, plural};
use super::failure::Failure;
use super::files::Files;
use super::options::particles::ParticleArgs;
use super::options::{lists, slices};
use super::source::Source;
use super::{devices, output};
use indicatif::{BinaryBytes, HumanCount};
use serde::Serialize;
use spherule_render::World;
use spherule_render::film::Region;
use spherule_render::scene::particles::ReadOptions;
use spherule_render::scene::{NamedMaterial, Projection, Scene};
use spherule_render::shade::MaterialKind;
use std::path::PathBuf;
use std::process::ExitCode;

/// Examples at the end of `--help`.
pub(super) const EXAMPLES: &str = "\
Examples:
  spherule info scene.toml
  spherule info particles.csv --json
  spherule info trajectory.xyz --frame last --rows 3";

/// Arguments of `spherule info`.
#[derive(Debug, clap::Args)]
pub(in crate::cli) struct Args {
    /// Scene (.toml), particle file (any other name), or - to read particles from standard input
    #[arg(required_unless_present = "devices")]
    scene: Option<PathBuf>,
    #[command(flatten)]
    particles: ParticleArgs,
    /// List GPUs, their limits, and what a test of their arithmetic finds
    #[arg(long, conflicts_with_all = ["scene", "rows"])]
    devices: bool,
    /// List the first and last N particles of a particle file
    #[arg(long, value_name = "N")]
    rows: Option<usize>,
    /// Print one JSON object to standard output
    #[arg(long)]
    json: bool,
    /// Also print the work that a render skips because the scene does not need it
    #[arg(short, long)]
    verbose: bool,
}

/// Contents of a scene, with lengths in its own unit.
#[derive(Serialize)]
struct Info {
    file: String,
    title: String,
    /// Null for scenes.
    particles: Option<ParticleInfo>,
    #[serde(flatten)]
    bodies: BodyCounts,
    dropped_spheres: u64,
    /// Lower and upper corner; null without spheres.
    bounds: Option<[[f64; 3]; 2]>,
    /// Minimum and maximum; null without spheres.
    radius: Option<[f64; 2]>,
    /// Slices.
    slices: Vec<String>,
    materials: Vec<MaterialInfo>,
    ground: bool,
    lights: LightInfo,
    environment: &'static str,
    camera: CameraInfo,
    settings: lists::List,
    memory: MemoryInfo,
    found: Vec<String>,
    skipped: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct MaterialInfo {
    name: String,
    kind: &'static str,
    #[serde(flatten)]
    bodies: BodyCounts,
}

#[derive(Serialize)]
struct LightInfo {
    emissive_spheres: usize,
    points: usize,
    suns: usize,
    sampled_environment: bool,
}

#[derive(Serialize)]
struct CameraInfo {
    projection: &'static str,
    eye: [f64; 3],
    lens: bool,
}

#[derive(Serialize)]
struct MemoryInfo {
    sphere_bytes: usize,
    tree_bytes: usize,
    tree_nodes: usize,
    bytes_per_sphere: f64,
}

/// Maximum number of materials that are listed.
const SHOWN: usize = 12;

/// Loads the scene and prints its contents.
pub(in crate::cli) fn run(args: &Args) -> Result<ExitCode, Failure> {
    let Some(file) = &args.scene else {
        devices::list(args.json);
        return Ok(ExitCode::SUCCESS);
    };
    args.particles.refuse_frames("info")?;
    let mut files = Files::new("info");
    files.reads_particles(file, &args.particles);
    files.check()?;
    let source = Source::of_path("info", file, &args.particles)?;
    let (scene, particles) = load(&source, args.rows)?;
    let world =
        World::build(&scene).map_err(|error| Failure::World(source.name().into_owned(), error))?;
    let info = Info { particles, ..Info::new(&source, &scene, &world) };
    if args.json {
        output::print_json(&info);
    } else {
        info.print(args.verbose);
    }
    Ok(ExitCode::SUCCESS)
}

/// Loads the scene, and the summary of a particle file.
fn load(source: &Source, rows: Option<usize>) -> Result<(Scene, Option<ParticleInfo>), Failure> {
    let Source::Particles(path, options) = source else {
        if rows.is_some() {
            let message = "--rows is only for particle files";
            return Err(Failure::usage("info", message));
        }
        return Ok((source.load()?, None));
    };
    let mut options = ReadOptions::clone(options);
    options.columns.rest = Some(columns::VALUES);
    let particles = spherule_render::scene::particles::read(path, &options)?;
    let mut info = ParticleInfo::new(path, &options, &particles);
    info.rows = rows.map(|count| RowInfo::new(&particles, count));
    Ok((Scene::of_particles(particles, &source.title(&Scene::default())), Some(info)))
}

impl Info {
    fn new(source: &Source, scene: &Scene, world: &World) -> Self {
        let (width, height) = (scene.settings.width, scene.settings.height);
        Self {
            file: source.name().into_owned(),
            title: source.title(scene).into_owned(),
            particles: None,
            bodies: BodyCounts::of(scene.body_rows()),
            dropped_spheres: world.features.vanished + world.features.hidden,
            bounds: scene.bounds().map(|ends| ends.map(|end| end.to_array())),
            radius: radii(scene),
            slices: scene.slices.iter().map(slices::text).collect(),
            materials: materials(scene),
            ground: scene.ground.is_some(),
            lights: LightInfo::new(world),
            environment: scene.environment.map.kind(),
            camera: CameraInfo::new(scene, world),
            settings: lists::of_settings(&scene.settings, Region { x: 0, y: 0, width, height }),
            memory: MemoryInfo::new(world),
            found: found(world),
            skipped: world.features.skipped(),
            warnings: scene.warnings.iter().cloned().chain(dropped(world)).collect(),
        }
    }

    fn print(&self, verbose: bool) {
        output::print(format_args!("{}: {}", self.file, self.title));
        self.particles.iter().for_each(ParticleInfo::print);
        output::print(format_args!("spheres      {}", HumanCount(self.bodies.0[0])));
        for (kind, count) in self.bodies.besides_spheres() {
            let name = format!("{}s", kind.name());
            output::print(format_args!("{name:<12} {}", HumanCount(count)));
        }
        if let Some([low, high]) = self.bounds {
            output::print(format_args!("bounds       {low:?} to {high:?}"));
        }
        if let Some([least, greatest]) = self.radius {
            output::print(format_args!("radius       {least} to {greatest}"));
        }
        for slice in &self.slices {
            output::print(format_args!("cut away     {slice}"));
        }
        for material in self.materials.iter().take(SHOWN) {
            let MaterialInfo { name, kind, bodies } = material;
            output::print(format_args!("material     {name}: {kind}, {bodies}"));
        }
        if self.materials.len() > SHOWN {
            let more = self.materials.len() - SHOWN;
            output::print(format_args!("material     and {more} more; --json lists all"));
        }
        let yes = if self.ground { "yes" } else { "no" };
        output::print(format_args!("ground       {yes}"));
        output::print(format_args!("lights       {}", self.lights.text()));
        output::print(format_args!("environment  {}", self.environment));
        output::print(format_args!("camera       {}", self.camera.text()));
        output::print(format_args!("memory       {}", self.memory.text()));
        output::print(format_args!("found        {}", self.found.join(", ")));
        for skipped in self.skipped.iter().filter(|_| verbose) {
            output::print(format_args!("skipped      {skipped}"));
        }
        self.warnings.iter().for_each(output::warn);
    }
}

impl LightInfo {
    fn new(world: &World) -> Self {
        Self {
            emissive_spheres: world.lights.emitters.len(),
            points: world.lights.points.len(),
            suns: world.lights.suns.len(),
            sampled_environment: world.lights.sky_parts > 0,
        }
    }

    fn text(&self) -> String {
        let counts = [
            (self.emissive_spheres, "emissive sphere"),
            (self.points, "point"),
            (self.suns, "sun"),
            (usize::from(self.sampled_environment), "sampled environment"),
        ];
        let present = counts.iter().filter(|(count, _)| *count > 0);
        let texts: Vec<String> = present.map(|&(count, noun)| plural(count as u64, noun)).collect();
        if texts.is_empty() { "none to sample".to_owned() } else { texts.join(", ") }
    }
}

impl CameraInfo {
    fn new(scene: &Scene, world: &World) -> Self {
        let projection = match scene.camera.projection {
            Projection::Perspective { .. } => "perspective",
            Projection::Orthographic { .. } => "orthographic",
        };
        let eye = world.transform.user_point(world.camera.eye);
        Self { projection, eye: eye.to_array(), lens: world.camera.has_lens() }
    }

    fn text(&self) -> String {
        let lens = if self.lens { ", with a lens" } else { "" };
        format!("{} from {:?}{lens}", self.projection, self.eye)
    }
}

impl MemoryInfo {
    fn new(world: &World) -> Self {
        let (sphere_bytes, tree_bytes) =
            (world.spheres.bytes() + world.appearance.bytes(), world.bvh.bytes());
        let total = (sphere_bytes + tree_bytes) as f64;
        Self {
            sphere_bytes,
            tree_bytes,
            tree_nodes: world.bvh.len(),
            bytes_per_sphere: total / world.spheres.len().max(1) as f64,
        }
    }

    fn text(&self) -> String {
        format!(
            "{} for spheres, {} for the tree of {}, {:.1} bytes per sphere",
            BinaryBytes(self.sphere_bytes as u64),
            BinaryBytes(self.tree_bytes as u64),
            plural(self.tree_nodes as u64, "node"),
            self.bytes_per_sphere
        )
    }
}

fn radii(scene: &Scene) -> Option<[f64; 2]> {
    let pairs = scene.spheres.radius.iter().map(|&radius| [radius; 2]);
    pairs.reduce(|[least, greatest], [radius, _]| [least.min(radius), greatest.max(radius)])
}

fn materials(scene: &Scene) -> Vec<MaterialInfo> {
    let info = |named: &NamedMaterial| MaterialInfo {
        name: named.name.clone(),
        kind: MaterialKind::of(&named.material).name(),
        bodies: BodyCounts::default(),
    };
    let mut infos: Vec<MaterialInfo> = scene.materials.iter().map(info).collect();
    for row in 0..scene.spheres.len() {
        infos[scene.spheres.material_of(row) as usize].bodies.0[0] += 1;
    }
    for bodies in scene.other_bodies() {
        let kind = bodies.kind() as usize;
        bodies.materials().iter().for_each(|&row| infos[row as usize].bodies.0[kind] += 1);
    }
    infos
}
