//! Loading of the viewer's content: reads particles or a scene, applies colors and materials, and builds the
//! world.

use super::content::Content;
use super::loading::{Progress, Step};
use super::viewer::Facts;
use crate::cli::devices::Attached;
use crate::cli::failure::Failure;
use crate::cli::render::{RenderSetup, VALUES, check_legend, frame_number};
use crate::cli::source::Source;
use glam::DVec3;
use rayon::prelude::*;
use spherule_render::World;
use spherule_render::compose::{self, CellRequest, Labels, Request, Staged, Subject, Value};
use spherule_render::scene::particles::{
    ArrowSizes, Codes, Coloring, ColumnColors, FrameChoice, Kind, Kinds, Model, NumberColumn,
    ParticleFrame, ParticleStyle, Particles, ReadOptions, Role, Selection, TrajectoryReader,
};
use spherule_render::scene::{Pose, Rgb, Scene, Spheres};
use spherule_render::world::framing;
use std::collections::HashSet;
use std::fs::Metadata;
use std::path::Path;
use std::sync::{Arc, OnceLock, RwLock};
use std::time::{Duration, Instant, SystemTime};

/// Maximum length in bytes of a file whose frames are counted at once.
const SHORT: u64 = 1 << 26;

/// Columns that every file has.
const USUAL: [&str; 5] = ["x", "y", "z", "radius", "type"];

/// Number of spheres from which no second copy is kept, so that they are read again if necessary. Tests, which are not optimized,
/// reach it sooner.
const MANY: usize = if cfg!(debug_assertions) { 1 << 16 } else { 1 << 20 };

/// Time after a scene within which the next one shows that frames play: most of them are seen as previews alone, for which the tree
/// that is built fastest is best.
const PLAYING: Duration = Duration::from_secs(1);

/// Number of spheres in the sketch of a large scene, which is used if only the outline matters.
const SKETCH: usize = 100_000;

/// Error for many spheres that cannot be read again from standard input.
const READ_ONCE: &str = "standard input can be read only once, and has too many spheres to keep a copy; \
                         write it to a file";

/// Particles or a scene as read, before looks are applied.
pub(super) struct Base {
    particles: Particles,
    /// The scene file without its spheres; `None` for a particle file.
    scene: Option<Scene>,
    frame: Option<u64>,
    /// True if missing columns can be read from the file.
    more_columns: bool,
}

/// A scene that is shown, its world, and the facts about it.
pub(super) struct LoadedScene {
    /// The scene with its spheres or with a sketch of them.
    pub(super) scene: Arc<RwLock<Scene>>,
    pub(super) world: World,
    /// Source of the spheres, if the scene has only a sketch of them.
    pub(super) origin: Option<Origin>,
    pub(super) content: Content,
    /// Samples per pixel of the options.
    pub(super) samples: Option<u32>,
    pub(super) labels: Labels,
    pub(super) facts: Facts,
    pub(super) warnings: Vec<String>,
    /// The device that follows paths.
    pub(super) device: Attached,
}

/// Data needed to read a stage's spheres again.
#[derive(Clone)]
pub(super) struct Origin {
    source: Source,
    content: Content,
    /// Modification time and length of the file when it was read.
    stamp: Option<(SystemTime, u64)>,
}

impl Base {
    /// Reads the setup's source. `before` was read last, and is returned if it is sufficient.
    pub(super) fn load(
        setup: &RenderSetup,
        content: &Content,
        before: Option<Self>,
        trajectory: &mut TrajectoryReader,
        progress: &Progress,
    ) -> Result<Self, Failure> {
        let has_color = |base: &Self| {
            let known = |name: &String| base.particles.can_color_by(name);
            let wanted = match &setup.source {
                Source::Particles(_, options) => options.columns.wanted.as_slice(),
                _ => &[],
            };
            !base.more_columns || content.color.iter().chain(wanted).all(known)
        };
        let enough = |base: &Self| base.frame == content.frame && has_color(base);
        if let Some(base) = before.filter(enough) {
            return Ok(base);
        }
        progress.begin(Step::reading(&setup.source.name()));
        let Source::Particles(path, options) = &setup.source else {
            setup.views.refuse_cells()?;
            return Ok(Self::of_scene(setup.source.load()?));
        };
        let mut options = ReadOptions::clone(options);
        if let Some(frame) = content.frame {
            options.frame = FrameChoice::Index(frame);
        }
        options.columns.wanted.extend(content.color.clone());
        options.columns.rest = Some(VALUES);
        options.progress = progress.read.clone();
        let mut particles = trajectory.read(path, &options, setup.request.style.arrows.as_ref())?;
        let more_columns = path.is_file() && has_many_values(&particles);
        // All else is applied to the particles of each picture.
        let (select, model) = (setup.request.style.select.clone(), Some(Model::SpaceFilling));
        let select = ParticleStyle { select, model, ..ParticleStyle::default() };
        select.apply(path, &mut particles)?;
        compose::repeat(setup.request.cell, path, &mut particles)?;
        Ok(Self { particles, scene: None, frame: content.frame, more_columns })
    }

    /// Converts a scene's spheres to particles whose types are materials.
    fn of_scene(mut scene: Scene) -> Self {
        let spheres = std::mem::take(&mut scene.spheres);
        let kind = |name: &String| Kind { name: name.clone(), ..Kind::default() };
        let table = scene.materials.iter().map(|material| kind(&material.name)).collect();
        let codes = if spheres.material.is_empty() {
            Codes::Bytes(vec![0; spheres.len()])
        } else {
            Codes::Words(spheres.material.clone())
        };
        let kinds = Kinds { table, codes };
        let frame = ParticleFrame { kinds, ..ParticleFrame::default() };
        let particles = Particles { spheres, frame, ..Particles::default() };
        Self { particles, scene: Some(scene), frame: None, more_columns: false }
    }

    /// Returns the facts for the viewer, without those that depend on colors and materials.
    fn facts(&self, setup: &RenderSetup) -> Facts {
        let own = other_columns(&self.particles);
        let own = own.filter(|name| self.more_columns || self.particles.can_color_by(name));
        let has_types = !self.particles.frame.kinds.codes.is_empty();
        let default = USUAL.into_iter().filter(|name| *name != "type" || has_types);
        Facts {
            columns: own.chain(default).map(str::to_owned).collect(),
            frame: self.frame.unwrap_or(0),
            bounds: bounds(&self.particles.spheres),
            cell: self.particles.frame.cell,
            unit: self.particles.frame.unit.symbol(),
            own_materials: self.scene.is_none()
                && (setup
                    .request
                    .style
                    .types
                    .iter()
                    .any(|look| look.properties.material.is_some())
                    || self.particles.material_names.iter().any(|name| !name.is_empty())),
            ..Facts::default()
        }
    }
}

/// Composes the scene of the content: that of the command line, without what is hidden, and with the colors and the
/// preset that are chosen since.
fn stage(
    setup: &RenderSetup,
    content: &Content,
    arrow_sizes: Option<ArrowSizes>,
    mut particles: Particles,
    scene: Option<Scene>,
) -> Result<(Request, Staged), Failure> {
    let mut request = Request {
        style: restyled(setup, content, arrow_sizes, &mut particles),
        // They are wrapped and replicated as they are read.
        cell: CellRequest { wrap: false, copies: None, ..setup.request.cell },
        keeps_labels: true,
        ..setup.request.clone()
    };
    if let Some((preset, camera)) = &content.preset {
        request.preset = Some(*preset);
        request.lit_from = Some(camera.clone());
    }
    let name = setup.source.name();
    let title = setup.source.title(&Scene::default()).into_owned();
    let frame = content.frame.or(setup.frame);
    let frame =
        frame.map_or_else(|| frame_number(setup), |number| Ok(Value::Whole(number as i64)))?;
    let subject = Subject { path: Path::new(&*name), title: &title, frame: &frame };
    let staged = if let Some(scene) = scene {
        let applied = request.style.apply(subject.path, &mut particles)?;
        let legend = applied.legend().cloned();
        let Particles { spheres, frame, .. } = particles;
        let ParticleFrame { kinds, numbers, texts, .. } = frame;
        let scene = compose::Content::Scene(Box::new(Scene { spheres, ..scene }));
        let staged = compose::stage(&request, &subject, scene, None);
        let labels = Labels { kinds, numbers, texts };
        staged.map(|mut staged| {
            (staged.legend, staged.labels) = (legend, labels);
            staged
        })
    } else {
        compose::stage(&request, &subject, compose::Content::Particles(Box::new(particles)), None)
    };
    Ok((request, staged.map_err(|fault| setup.refuse(fault))?))
}

/// All that reading depends on beside the frame and the colors.
#[derive(PartialEq)]
struct Reading {
    source: Source,
    select: Option<Selection>,
    cell: CellRequest,
    arrows: bool,
}

impl Reading {
    fn of(setup: &RenderSetup) -> Self {
        let mut source = setup.source.clone();
        if let Source::Particles(_, options) = &mut source {
            options.columns.wanted.clear();
        }
        let Request { style, cell, .. } = &setup.request;
        Self { source, select: style.select.clone(), cell: *cell, arrows: style.arrows.is_some() }
    }
}

/// Loads one stage after another, and keeps what was read last unless it is large.
#[derive(Default)]
pub(super) struct Loader {
    /// The last thing that was read, if any.
    reading: Option<Reading>,
    base: Option<Base>,
    /// The choices that all frames have in common.
    trajectory: TrajectoryReader,
    /// Sizes of the arrows of the first frame that had some: those of others compare with them.
    arrow_sizes: Option<ArrowSizes>,
    /// Number of frames of the file, once it is known.
    frames: Arc<OnceLock<u64>>,
    counts: bool,
    /// Time when the last scene was loaded.
    loaded: Option<Instant>,
}

impl Loader {
    /// Returns what counts the frames of the last content, unless that was returned before or they are known.
    pub(super) fn count(&mut self) -> Option<impl FnOnce() -> Option<u64> + Send + use<>> {
        let frames = Arc::clone(&self.frames);
        let source = self.reading.as_ref().map(|reading| reading.source.clone());
        let Some(Source::Particles(path, options)) = source else { return None };
        if frames.get().is_some() || std::mem::replace(&mut self.counts, true) {
            return None;
        }
        let count = self.trajectory.counter(&path, &options);
        Some(move || {
            let count = count().ok()?;
            Some(*frames.get_or_init(|| count))
        })
    }

    /// Reads the source if necessary, applies colors and materials, and builds the world.
    pub(super) fn load(
        &mut self,
        content: &Content,
        progress: &Progress,
    ) -> Result<LoadedScene, Failure> {
        let args = content.options.args()?;
        let setup = &RenderSetup::new(&args.render)?;
        let reading = Reading::of(setup);
        let first = self.reading.is_none();
        let same = self.reading.as_ref() == Some(&reading);
        let kept = same && self.base.is_some();
        if !(first || kept) && is_standard_input(&setup.source) {
            return Err(Failure::View(READ_ONCE.to_owned()));
        }
        if !same {
            *self = Self { reading: Some(reading), ..Self::default() };
        }
        let stamp = stamp(&setup.source);
        let read = Base::load(setup, content, self.base.take(), &mut self.trajectory, progress)?;
        let facts = read.facts(setup);
        if self.frames.get().is_none()
            && let Source::Particles(path, options) = &setup.source
            && let Some(count) = count_at_once(path, options, &mut self.trajectory)
        {
            self.frames.get_or_init(|| count);
        }
        let many = read.particles.spheres.len() > MANY;
        let (particles, scene) = if many {
            (read.particles, read.scene)
        } else {
            let parts = (read.particles.clone(), read.scene.clone());
            self.base = Some(read);
            parts
        };
        let (request, mut staged) = stage(setup, content, self.arrow_sizes, particles, scene)?;
        self.arrow_sizes = self.arrow_sizes.or(staged.arrow_sizes);
        if first {
            check_legend(setup, staged.legend.as_ref())?;
        }
        compose::place(&request, &mut staged, None, None).map_err(|fault| setup.refuse(fault))?;
        let Staged { mut scene, labels, legend, orientation, .. } = staged;
        let failed = |error| Failure::World(setup.source.name().into_owned(), error);
        let camera = &setup.request.camera;
        let framed = matches!(scene.camera.pose, Pose::Fit { .. })
            && (camera.look_at.is_none() && camera.zoom.is_none() && camera.margin.is_none())
            && setup.request.style.framed.is_none();
        framing::include_points(&mut scene, &[]).map_err(failed)?;
        let count = scene.spheres.len();
        // Those of a scene file are before them.
        let planes = request.planes.len().min(scene.slices.len());
        let facts = Facts {
            title: setup.source.title(&scene).into_owned(),
            spheres: count,
            types: labels.kinds.table.iter().map(|kind| kind.name.clone()).collect(),
            size: compose::extent(&scene),
            slices: scene.slices[scene.slices.len() - planes..].to_vec(),
            framed,
            lit_from: request.lit_from.clone().unwrap_or_else(|| scene.camera.clone()),
            look: scene.look,
            settings: scene.settings.clone(),
            preset: setup.preset(),
            orientation,
            color_bar: scene.annotations.color_bar.is_some(),
            legend,
            frames: self.frames.get().copied(),
            ..facts
        };
        progress.begin(Step::Building(count));
        let plays = self.loaded.is_some_and(|time| time.elapsed() < PLAYING);
        let pixels = u64::from(scene.settings.width) * u64::from(scene.settings.height);
        let samples = if plays { 0 } else { 64 * pixels };
        let builder = setup.builder(count, samples);
        let mut world = if many {
            let sketch = sketch(&scene.spheres);
            let world = World::build_taking(&mut scene, builder).map_err(failed)?;
            scene.spheres = sketch;
            world
        } else {
            World::build_with(&scene, builder).map_err(failed)?
        };
        let origin = || Origin { source: setup.source.clone(), content: content.clone(), stamp };
        let origin = many.then(origin);
        let mut warnings = std::mem::take(&mut scene.warnings);
        let device = Attached::to(&mut world, &scene.settings, setup.speed.device);
        warnings.extend(device.refusal());
        let scene = Arc::new(RwLock::new(scene));
        self.loaded = Some(Instant::now());
        Ok(LoadedScene {
            scene,
            world,
            origin,
            content: content.clone(),
            samples: setup.picture.settings.spp(),
            labels,
            facts,
            warnings,
            device,
        })
    }
}

/// Visits the particles of so many frames, without hidden ones, until the visitor returns false.
///
/// # Errors
/// A frame cannot be read.
pub(super) fn visit_frames(
    content: &Content,
    frames: u64,
    mut visit: impl FnMut(Particles) -> bool,
) -> Result<(), Failure> {
    let args = content.options.args()?;
    let setup = RenderSetup::new(&args.render)?;
    let mut trajectory = TrajectoryReader::default();
    for frame in 0..frames {
        let content = Content { frame: Some(frame), ..Content::default() };
        let read = Base::load(&setup, &content, None, &mut trajectory, &Progress::default())?;
        if !visit(read.particles) {
            break;
        }
    }
    Ok(())
}

impl Origin {
    /// Returns whether the spheres can be read again, as far as is known in advance.
    pub(super) fn is_readable(&self) -> bool {
        !is_standard_input(&self.source) && self.stamp == stamp(&self.source)
    }

    /// Reads the spheres of the stage again.
    ///
    /// # Errors
    /// The file cannot be read twice, has changed, or cannot be read any more.
    pub(super) fn spheres(&self) -> Result<Spheres, Failure> {
        let name = self.source.name();
        let failed = |why: &str| Err(Failure::View(format!("{name}: {why}")));
        if is_standard_input(&self.source) {
            return Err(Failure::View(READ_ONCE.to_owned()));
        }
        if self.stamp != stamp(&self.source) {
            return failed("the file has changed since it was read; open it again");
        }
        let args = self.content.options.args()?;
        let setup = RenderSetup::new(&args.render)?;
        let base = Base::load(
            &setup,
            &self.content,
            None,
            &mut TrajectoryReader::default(),
            &Progress::default(),
        )?;
        let (_, staged) = stage(&setup, &self.content, None, base.particles, base.scene)?;
        Ok(staged.scene.spheres)
    }
}

fn is_standard_input(source: &Source) -> bool {
    matches!(source, Source::Particles(path, _) if path.as_os_str() == "-")
}

/// Modification time and length of a source's file; `None` for other sources.
fn stamp(source: &Source) -> Option<(SystemTime, u64)> {
    let (Source::Particles(path, _) | Source::Toml(path)) = source else { return None };
    let data = path.metadata().ok().filter(Metadata::is_file)?;
    Some((data.modified().ok()?, data.len()))
}

/// Returns the lower and upper corner of the box of all spheres.
fn bounds(spheres: &Spheres) -> [DVec3; 2] {
    let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    let with = |[low, high]: [DVec3; 2], row: usize| {
        let (center, radius) = (spheres.center(row), spheres.radius[row]);
        [low.min(center - radius), high.max(center + radius)]
    };
    let join = |a: [DVec3; 2], b: [DVec3; 2]| [a[0].min(b[0]), a[1].max(b[1])];
    let all = (0..spheres.len()).into_par_iter().fold(|| none, with).reduce(|| none, join);
    if spheres.is_empty() { [DVec3::ZERO; 2] } else { all }
}

/// Returns a sketch of many spheres: those that extend farthest in some directions, and others in even steps.
fn sketch(spheres: &Spheres) -> Spheres {
    let count = spheres.len();
    let signs = [-1.0, 0.0, 1.0];
    let directions = signs.into_iter().flat_map(|x| {
        signs.into_iter().flat_map(move |y| signs.map(|z| DVec3::new(x, y, z).normalize_or_zero()))
    });
    let farthest = |direction: DVec3| {
        let reach = |row: usize| spheres.center(row).dot(direction) + spheres.radius[row];
        (0..count).into_par_iter().max_by(|&a, &b| reach(a).total_cmp(&reach(b)))
    };
    let mut rows: Vec<usize> = directions.filter_map(farthest).collect();
    rows.extend((0..count).step_by(count.div_ceil(SKETCH).max(1)));
    let mut some = Spheres::default();
    for row in rows {
        some.push(spheres.center(row), spheres.radius[row], 0, Rgb::ONE);
    }
    some
}

/// Returns the style of the command line, without hidden particles, and with the colors that are chosen.
fn restyled(
    setup: &RenderSetup,
    content: &Content,
    arrow_sizes: Option<ArrowSizes>,
    particles: &mut Particles,
) -> ParticleStyle {
    let condition = content.condition();
    if condition.is_some() && !particles.frame.numbers.iter().any(|column| column.name == "id") {
        let values = (0..particles.spheres.len()).map(|row| row as f64).collect();
        particles.frame.numbers.push(NumberColumn { name: "id".to_owned(), values });
    }
    let select = condition.and_then(|text| text.parse().ok());
    let coloring = content
        .color
        .clone()
        .map(|column| Coloring::Column(ColumnColors { column, ..ColumnColors::default() }));
    let coloring = coloring.unwrap_or_else(|| setup.request.style.coloring.clone());
    let style = setup.request.style.clone();
    let mut style = ParticleStyle { select, coloring, allow_empty: false, ..style };
    if let (Some(arrows), Some(sizes)) = (&mut style.arrows, arrow_sizes) {
        arrows.fix(sizes);
    }
    style
}

/// Returns whether particles have more values than are read in advance.
fn has_many_values(particles: &Particles) -> bool {
    other_columns(particles).count().saturating_mul(particles.spheres.len()) > VALUES
}

/// Names of the columns other than positions, radii and types.
fn other_columns(particles: &Particles) -> impl Iterator<Item = &str> {
    let shapes = [Role::X, Role::Y, Role::Z, Role::Radius, Role::Diameter, Role::Kind];
    let roles = particles.frame.roles.iter().filter(|(role, _)| shapes.contains(role));
    let roles: HashSet<&str> = roles.map(|(_, name)| name.as_str()).collect();
    let own = particles.frame.columns.iter().map(String::as_str);
    own.filter(move |name| !roles.contains(name) && !USUAL.contains(name))
}

/// Number of frames of a file, if it is fast to count. Standard input has one, because it can be read only once.
fn count_at_once(
    path: &Path,
    options: &ReadOptions,
    trajectory: &mut TrajectoryReader,
) -> Option<u64> {
    if path.as_os_str() == "-" {
        return Some(1);
    }
    let short = path.metadata().is_ok_and(|data| data.is_file() && data.len() < SHORT);
    short.then(|| trajectory.counter(path, options)().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::render::PlacedScene;
    use crate::cli::view::options::Options;
    use rand_xoshiro::SplitMix64;
    use rand_xoshiro::rand_core::{Rng, SeedableRng};
    use spherule_render::scene::text_without_columns;

    /// Options, of which one of a line may be given.
    const GROUPS: [&[&str]; 17] = [
        &["--wrap"],
        &["--cell"],
        &["--up=x", "--up=-y", "--up=z"],
        &["--view=auto", "--view=iso", "--view=-x", "--view=z"],
        &["--projection=orthographic"],
        &["--margin=0.3"],
        &["--aperture=0.2", "--aperture=0.1 --focus=9", "--aperture=0.1 --focus=id:2"],
        &[
            "--preset=chalk",
            "--preset=studio",
            "--preset=cloudy",
            "--preset=glossy",
            "--preset=outline",
            "--preset=ghost",
            "--preset=x-ray",
        ],
        &["--background=#204060", "--background=sky"],
        &["--select=z>1.5"],
        &[
            "--color-by=tags",
            "--color-by=z --color-bar=left",
            "--colors=cpk --legend",
            "--color-by=species --legend=top",
        ],
        &["--model=ball-and-stick", "--model=licorice --bond-radius=0.1", "--bonds=*-*<3"],
        &["--opacity=0.5", "--translucent=z>2"],
        &["--type=Cu:color=teal,radius=0.9"],
        &[
            "--slice=z>60%",
            "--slice=x>2 --slice-mode=caps",
            "--slice=y<1 --slice-mode=hide",
            "--slice=z>90%",
        ],
        &["--axes", "--axes=cell", "--scale-bar=2:bottom", "--label={particles} --text-size=0.05"],
        &["--integrator=ao", "--depth=1 --exposure=1"],
    ];

    /// The scene of the command line and that of the viewer, as texts and columns, or their errors.
    fn scenes(options: &[&str]) -> [Result<(String, Spheres), String>; 2] {
        let words = options.iter().flat_map(|option| option.split(' '));
        let path = "tests/data/particles/surface.extxyz";
        let words: Vec<&str> =
            [path, "--size=64x48", "--spp=4", "--denoise=off"].into_iter().chain(words).collect();
        let options = Options::parse(&words);
        let args = options.args().expect("options");
        let setup = RenderSetup::new(&args.render).expect("a setup");
        let described = |scene: &Scene| {
            (text_without_columns(scene).expect("no picture"), scene.spheres.clone())
        };
        let rendered = PlacedScene::load(&setup, None).and_then(|placed| {
            let mut scene = placed.scene;
            let failed = |error| Failure::World(String::new(), error);
            framing::include_points(&mut scene, &[]).map_err(failed)?;
            Ok(described(&scene))
        });
        let content = Content { options, ..Content::default() };
        let seen = Loader::default().load(&content, &Progress::default());
        let seen = seen.map(|loaded| described(&loaded.scene.read().expect("no panic")));
        [rendered, seen].map(|scene| scene.map_err(|error| error.to_string()))
    }

    #[test]
    fn viewers_show_the_scene_that_is_rendered() {
        let each = GROUPS.iter().flat_map(|group| group.iter().map(|option| vec![*option]));
        let mut cases: Vec<Vec<&str>> = each.collect();
        let mut random = SplitMix64::seed_from_u64(5);
        let mut below = |count: usize| (random.next_u64() % count as u64) as usize;
        for _ in 0..200 {
            let mut some = Vec::new();
            for group in GROUPS {
                if below(5) < 2 {
                    some.push(group[below(group.len())]);
                }
            }
            cases.push(some);
        }
        let mut agreed = 0;
        for case in cases {
            let [rendered, seen] = scenes(&case);
            agreed += u32::from(rendered.is_ok());
            assert_eq!(rendered, seen, "{case:?}");
        }
        assert!(agreed > 150, "{agreed}");
    }
}
