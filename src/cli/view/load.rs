//! From what the viewer wants to show to a world.

use super::content::Content;
use super::viewer::Facts;
use crate::cli::failure::Failure;
use crate::cli::render::Job;
use crate::cli::source::Source;
use crate::cli::views::scene_of_particles;
use glam::DVec3;
use spherule::World;
use spherule::scene::particles::{
    self, Codes, Coloring, ColumnColors, FrameChoice, Kind, Kinds, Looks, NumberColumn, Particles,
    ReadOptions, Role, TextColumn,
};
use spherule::scene::{Scene, Spheres};
use spherule::world::framing;
use std::collections::HashSet;
use std::path::Path;
use std::sync::{Arc, RwLock};

/// Values of columns that are read though nothing asks for them yet: of 200 000 particles, 20
/// columns.
const VALUES: usize = 4_000_000;

/// Bytes of a file that is gone through to count its frames.
const SHORT: u64 = 1 << 26;

/// Columns that there are without a file's.
const USUAL: [&str; 5] = ["x", "y", "z", "radius", "type"];

/// What was read, as it was read.
pub(super) struct Base {
    particles: Particles,
    /// All of a scene file but its spheres; `None` for a file of particles.
    scene: Option<Scene>,
    frame: Option<u64>,
    frames: Option<u64>,
    /// Whether columns that are not there can be read from the file.
    more_columns: bool,
}

/// What is to be seen, and what is known of it.
pub(super) struct Stage {
    /// With its spheres, as it is saved.
    pub(super) scene: Arc<RwLock<Scene>>,
    pub(super) world: World,
    pub(super) labels: Labels,
    pub(super) facts: Facts,
    pub(super) warnings: Vec<String>,
}

/// What is known of spheres besides where they are.
#[derive(Default)]
pub(super) struct Labels {
    kinds: Kinds,
    numbers: Vec<NumberColumn>,
    texts: Vec<TextColumn>,
}

impl Base {
    /// Reads what a job speaks of. `before` is what was read last, which may be known to do.
    pub(super) fn load(
        job: &Job,
        content: &Content,
        before: Option<Self>,
    ) -> Result<Self, Failure> {
        let has_color = |base: &Self| {
            content
                .color
                .as_ref()
                .is_none_or(|name| !base.more_columns || base.particles.can_color_by(name))
        };
        let enough = |base: &Self| base.frame == content.frame && has_color(base);
        let frames = before.as_ref().and_then(|base| base.frames);
        if let Some(base) = before.filter(enough) {
            return Ok(base);
        }
        let Source::Particles(path, options) = &job.source else {
            job.views.refuse_cells()?;
            return Ok(Self::of_scene(job.source.load()?));
        };
        let mut options = ReadOptions::clone(options);
        if let Some(frame) = content.frame {
            options.frame = FrameChoice::Index(frame);
        }
        options.columns.wanted.extend(content.color.clone());
        options.columns.rest = Some(VALUES);
        let mut particles = particles::read(path, &options)?;
        let more_columns = path.is_file() && has_many_values(&particles);
        let select = Looks { select: job.looks.select.clone(), ..Looks::default() };
        select.apply(path, &mut particles)?;
        job.views.repeat(path, &mut particles)?;
        let frames = frames.or_else(|| count(path, &options, content.frame.is_some()));
        Ok(Self { particles, scene: None, frame: content.frame, frames, more_columns })
    }

    /// A scene's spheres as particles whose types are materials.
    fn of_scene(mut scene: Scene) -> Self {
        let spheres = std::mem::take(&mut scene.spheres);
        let kind = |name: &String| Kind { name: name.clone(), element: None, virtual_site: false };
        let table = scene.materials.iter().map(|material| kind(&material.name)).collect();
        let codes = (0..spheres.len()).map(|row| spheres.material_of(row)).collect();
        let kinds = Kinds { table, codes: Codes::Words(codes) };
        let particles = Particles { spheres, kinds, ..Particles::default() };
        Self { particles, scene: Some(scene), frame: None, frames: None, more_columns: false }
    }

    /// Makes what was read look as it is to look, and builds its world.
    pub(super) fn stage(&self, job: &Job, content: &Content) -> Result<Stage, Failure> {
        let mut particles = self.particles.clone();
        dress(job, content, &mut particles)?;
        let cell = particles.cell;
        let labels = Labels {
            kinds: particles.kinds.clone(),
            numbers: std::mem::take(&mut particles.numbers),
            texts: std::mem::take(&mut particles.texts),
        };
        let mut scene = if let Some(scene) = &self.scene {
            Scene { spheres: particles.spheres, ..scene.clone() }
        } else {
            let preset = content.preset.as_ref().map(|(preset, _)| *preset);
            let title = job.source.title(&Scene::default()).into_owned();
            scene_of_particles(preset.or(job.style.preset()), particles, &title)
        };
        let cuts = job.slices.cut(
            &mut scene,
            Path::new(&*job.source.name()),
            cell.map(|cell| cell.bounds()),
            false,
        )?;
        job.style.set(&mut scene);
        job.views.show_cell(&mut scene, cell.as_ref());
        job.picture.replace(&mut scene.settings);
        job.views.frame(&mut scene, None, &cuts)?;
        let failed = |error| Failure::World(job.source.name().into_owned(), error);
        let up = scene.camera.up;
        framing::hold(&mut scene, &[]).map_err(failed)?;
        // The way that is up, not that of the picture, which leans: the camera turns about it.
        scene.camera.up = up;
        if let Some((preset, camera)) = &content.preset {
            let home = std::mem::replace(&mut scene.camera, camera.clone());
            if self.scene.is_some() {
                preset.replace_materials(&mut scene);
            }
            preset.light(&mut scene);
            scene.camera = home;
            scene.look = job.style.look(Some(*preset), scene.look);
        } else {
            job.style.light(&mut scene);
        }
        let samples = u64::from(scene.settings.width) * u64::from(scene.settings.height) * 64;
        let builder = job.builder(scene.spheres.len(), samples);
        let world = World::build_with(&scene, builder).map_err(failed)?;
        let facts = self.facts(&scene, &labels, job);
        let warnings = std::mem::take(&mut scene.warnings);
        Ok(Stage { scene: Arc::new(RwLock::new(scene)), world, labels, facts, warnings })
    }

    fn facts(&self, scene: &Scene, labels: &Labels, job: &Job) -> Facts {
        let own = other_columns(&self.particles);
        let own = own.filter(|name| self.more_columns || self.particles.can_color_by(name));
        let usual = USUAL.into_iter().filter(|name| *name != "type" || labels.has_types());
        Facts {
            title: job.source.title(scene).into_owned(),
            spheres: scene.spheres.len(),
            types: labels.kinds.table.iter().map(|kind| kind.name.clone()).collect(),
            columns: own.chain(usual).map(str::to_owned).collect(),
            frame: self.frame.unwrap_or(0),
            frames: self.frames,
            size: size(&scene.spheres),
            look: scene.look,
            own_materials: self.scene.is_none()
                && (job.looks.types.iter().any(|look| look.material.is_some())
                    || self.particles.material_names.iter().any(|name| !name.is_empty())),
        }
    }
}

impl Labels {
    fn has_types(&self) -> bool {
        !self.kinds.codes.is_empty() && !self.kinds.table.is_empty()
    }

    /// The type of a sphere, if it has one.
    pub(super) fn kind(&self, row: usize) -> Option<&str> {
        self.kinds.kind(row).map(|kind| kind.name.as_str())
    }

    /// The sphere's number in its file, if it is not its row.
    pub(super) fn id(&self, row: usize) -> Option<f64> {
        let column = self.numbers.iter().find(|column| column.name == "id")?;
        column.values.get(row).copied()
    }

    /// What the columns of the file say of a sphere.
    pub(super) fn columns(&self, row: usize) -> impl Iterator<Item = String> {
        let numbers = self.numbers.iter().filter(|column| column.name != "id");
        let numbers = numbers.filter_map(move |column| {
            column.values.get(row).map(|value| format!("{} = {value}", column.name))
        });
        let texts = self.texts.iter().filter(move |column| row < column.codes.len());
        numbers.chain(texts.map(move |column| format!("{} = {}", column.name, column.text(row))))
    }
}

/// Drops what is not drawn, and colors the rest.
fn dress(job: &Job, content: &Content, particles: &mut Particles) -> Result<(), Failure> {
    let condition = content.condition();
    if condition.is_some() && !particles.numbers.iter().any(|column| column.name == "id") {
        let values = (0..particles.spheres.len()).map(|row| row as f64).collect();
        particles.numbers.push(NumberColumn { name: "id".to_owned(), values });
    }
    let select = condition.and_then(|text| text.parse().ok());
    let coloring = content
        .color
        .clone()
        .map(|column| Coloring::Column(ColumnColors { column, ..ColumnColors::default() }));
    let coloring = coloring.unwrap_or_else(|| job.looks.coloring.clone());
    let looks = Looks { select, coloring, types: job.looks.types.clone(), allow_empty: false };
    let name = job.source.name();
    looks.apply(Path::new(name.as_ref()), particles)?;
    Ok(())
}

/// Whether particles have more values than are read though nothing asks for them.
fn has_many_values(particles: &Particles) -> bool {
    other_columns(particles).count().saturating_mul(particles.spheres.len()) > VALUES
}

/// Names of the columns of a file that positions, radii and types were not read from.
fn other_columns(particles: &Particles) -> impl Iterator<Item = &str> {
    let shapes = [Role::X, Role::Y, Role::Z, Role::Radius, Role::Diameter, Role::Kind];
    let roles = particles.roles.iter().filter(|(role, _)| shapes.contains(role));
    let roles: HashSet<&str> = roles.map(|(_, name)| name.as_str()).collect();
    let own = particles.columns.iter().map(String::as_str);
    own.filter(move |name| !roles.contains(name) && !USUAL.contains(name))
}

/// Number of frames of a file, if that is known soon or someone wants to see others. Standard input
/// has one: it can be read only once.
fn count(path: &Path, options: &ReadOptions, asked: bool) -> Option<u64> {
    if path.as_os_str() == "-" {
        return Some(1);
    }
    let short = path.metadata().is_ok_and(|data| data.is_file() && (asked || data.len() < SHORT));
    short.then(|| particles::count_frames(path, options).ok()).flatten()
}

/// Half the diagonal of the box about all spheres.
fn size(spheres: &Spheres) -> f64 {
    let rows = || (0..spheres.len()).map(|row| (spheres.center(row), spheres.radius[row]));
    let low = rows().fold(DVec3::INFINITY, |low, (center, radius)| low.min(center - radius));
    let high = rows().fold(DVec3::NEG_INFINITY, |high, (center, radius)| high.max(center + radius));
    let size = (high - low).length() / 2.0;
    if size.is_finite() && size > 0.0 { size } else { 1.0 }
}
