//! Composition of scenes: particles or a scene, and all that is asked of it, become the scene that is drawn.
//!
//! The command line, the viewer and Python fill in one [`Request`]; what follows is the same for all of them:
//!
//! ```text
//! stage      style, cell, preset, slices, annotations, look, settings
//! choose     projection, side and margin of the camera
//! frame      its position, with room for annotations
//! light      lights and ground of the preset, which depend on the camera
//! ```
//!
//! [`place`] is all but the first, for an image whose size is known.

mod annotations;
mod camera;
mod descriptions;
mod digits;
mod marks;
mod sections;
mod survey;
mod template;

pub use self::annotations::{AnnotationRequest, Axes, Bar, LabelText, ink, notes, position};
pub use self::camera::{
    CameraRequest, Focus, LensRequest, LookAt, choose, corners, frame, leave_room, light,
    light_ahead, place, vertical, zoom,
};
pub use self::descriptions::{Descriptions, extent};
pub use self::marks::MeasureRequest;
pub use self::sections::{Sections, change};
pub use self::survey::Survey;
pub use self::template::{Template, Value};

use self::annotations::Facts;
use self::marks::Marks;
use crate::scene::particles::{
    Applied, ArrowSizes, Boundary, Category, Cell, Kinds, Legend, NumberColumn, Orientation,
    ParticleStyle, Particles, PeriodicError, Shapes, TextColumn, UpReason,
};
use crate::scene::{Axis, Background, Camera, FileError, Preset, Scene, SliceMode, SlicePlane};
use crate::settings;
use crate::world::WorldError;
use glam::DVec3;
use spherule_particles::internals::aliases;
use std::path::Path;

/// Name of a column of numbers that follows particles through selections, copies and slices: [`Staged::rows`] has
/// its values. No expression can name it.
pub const ROWS: &str = "\0rows";

/// All that is asked of a scene.
#[derive(Clone, Debug, Default)]
pub struct Request {
    /// The style of particles, by which they become bodies: selection, colors, radii, bonds, arrows.
    pub style: ParticleStyle,
    /// The cell of particles.
    pub cell: CellRequest,
    /// The direction of particles that is up; `None` to decide by them.
    pub up: Option<Axis>,
    /// Materials, look and lights: without one, those of [`Preset::default`] for particles, and a scene's own.
    pub preset: Option<Preset>,
    /// The camera that the preset's lights follow, if it is not the scene's.
    pub lit_from: Option<Camera>,
    /// The background, instead of the preset's or the scene's.
    pub background: Option<Background>,
    /// True to fade far particles, instead of the preset's choice or the scene's.
    pub depth_cue: Option<bool>,
    /// True to draw outlines, likewise.
    pub outline: Option<bool>,
    /// Planes that cut, after those of the scene.
    pub planes: Vec<SlicePlane>,
    /// The treatment of bodies by the planes.
    pub slice_mode: SliceMode,
    /// Annotations inside the image.
    pub annotations: AnnotationRequest,
    /// Names and values of settings, as [`crate::scene::Settings::change`] takes them.
    pub settings: Vec<(&'static str, settings::Value)>,
    /// The view.
    pub camera: CameraRequest,
    /// The lens.
    pub lens: LensRequest,
    /// Sections of a scene file beside particles.
    pub sections: Option<Sections>,
    /// True to keep [`Staged::labels`].
    pub keeps_labels: bool,
    /// True if [`Staged::rows`] follow spheres that slices drop.
    pub keeps_rows: bool,
}

/// Changes of the cell of particles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CellRequest {
    /// True to wrap particles into it.
    pub wrap: bool,
    /// Copies along its edges.
    pub copies: Option<[u32; 3]>,
    /// True to draw its edges.
    pub show: bool,
    /// Particles and bonds at its boundary.
    pub boundary: Boundary,
}

/// The file, title and frame of a composed scene.
#[derive(Clone, Copy, Debug)]
pub struct Subject<'a> {
    /// Its file, for messages.
    pub path: &'a Path,
    /// The title of a scene of particles.
    pub title: &'a str,
    /// The number of the frame, for labels that show it.
    pub frame: &'a Value,
}

/// Particles as read, or a scene.
#[derive(Clone, Debug)]
pub enum Content {
    /// Particles.
    Particles(Box<Particles>),
    /// A scene.
    Scene(Box<Scene>),
}

/// Properties that all images of a sequence share.
#[derive(Clone, Debug)]
pub struct Shared {
    /// The camera.
    pub camera: Camera,
    /// The orientation of the first frame that shows a sphere.
    pub orientation: Option<Orientation>,
    /// Height of the preset's ground, below all frames.
    pub ground: Option<f64>,
    /// The names that colors stand for in all frames, if they are asked for.
    pub categories: Option<Vec<Category>>,
}

/// Types and columns of the spheres of particles.
#[derive(Clone, Debug, Default)]
pub struct Labels {
    /// Their types.
    pub kinds: Kinds,
    /// Columns of numbers.
    pub numbers: Vec<NumberColumn>,
    /// Columns of texts.
    pub texts: Vec<TextColumn>,
}

impl Labels {
    /// Returns the type of a sphere, if it has one.
    pub fn kind(&self, row: usize) -> Option<&str> {
        self.kinds.kind(row).map(|kind| kind.name.as_str())
    }

    /// Returns the number of a sphere in its file, or its row if the file has no numbers; `None` if it has none that is a number.
    pub fn id(&self, row: usize) -> Option<f64> {
        let mut names = std::iter::once("id").chain(aliases::of("id"));
        let id = |name: &str| {
            let numbers = self.numbers.iter().find(|own| own.name.eq_ignore_ascii_case(name));
            if let Some(column) = numbers {
                return Some(column.values.get(row).copied().filter(|id| id.is_finite()));
            }
            let texts = self.texts.iter().find(|own| own.name.eq_ignore_ascii_case(name))?;
            Some((row < texts.codes.len()).then(|| texts.text(row).trim().parse().ok()).flatten())
        };
        let own = names.find_map(id);
        own.or_else(|| {
            Some(self.numbers.iter().find(|own| own.name == ROWS)?.values.get(row).copied())
        })
        .unwrap_or(Some(row as f64))
    }
}

/// A scene whose camera is not placed yet, and what is known of its particles.
#[derive(Clone, Debug)]
pub struct Staged {
    /// The scene.
    pub scene: Scene,
    /// The color scale, if colors stand for numbers: of several, the first.
    pub legend: Option<Legend>,
    /// Results of the style of particles.
    pub applied: Applied,
    /// The orientation of the particles, if the scene is of particles.
    pub orientation: Option<Orientation>,
    /// The names that colors stand for, if a legend of them is asked for.
    pub categories: Option<Vec<Category>>,
    /// The sizes of arrows, if there are any.
    pub arrow_sizes: Option<ArrowSizes>,
    /// Types and columns of particles, if they are kept.
    pub labels: Labels,
    /// Values of the column [`ROWS`] of each sphere; `None` if they are those of the particles.
    pub rows: Option<Vec<u32>>,
    /// Values of the column [`ROWS`] of each ellipsoid, if there is the column.
    pub ellipsoid_rows: Option<Vec<u32>>,
    /// The preset of materials and lights; `None` for a scene that has its own.
    pub preset: Option<Preset>,
    /// Normals of the slices that cut anything, toward what is cut away.
    pub normals: Vec<DVec3>,
    /// Number of particles in the first frame of a file with several, all of whose frames have the same samples.
    pub first_frame: Option<usize>,
    /// Center of the particle in focus, if the focus is a particle.
    focus: Option<DVec3>,
}

/// Why a scene is not composed; front ends word what depends on their options.
#[derive(Debug)]
pub enum Fault {
    /// Particles, or what is asked of them.
    File(FileError),
    /// The camera cannot be placed in the scene of this title.
    World(String, WorldError),
    /// A legend is asked for, but colors stand for numbers, or for nothing.
    Legend {
        /// True for numbers.
        numeric: bool,
    },
    /// Axes of a cell are asked for, but there is none.
    AxesOfCell,
    /// A label cannot be written.
    Label {
        /// Its row in [`AnnotationRequest::labels`].
        row: usize,
        /// Why.
        why: String,
    },
    /// Particles cannot be measured.
    Measure {
        /// The row in [`AnnotationRequest::measures`].
        row: usize,
        /// Why.
        why: String,
    },
    /// A margin is given to a camera that does not frame the scene.
    Margin,
    /// A focus is given to a pinhole.
    FocusOfPinhole,
    /// The focus is a particle, but there are none.
    FocusWithoutParticles,
    /// The particle in focus, by its id, is behind the camera.
    FocusBehindCamera(f64),
}

impl From<FileError> for Fault {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}

impl Request {
    /// Returns the name of what contradicts a camera that is used as it is.
    pub fn contradiction(&self) -> Option<&'static str> {
        let camera = &self.camera;
        camera.own.as_ref()?;
        let given = [
            ("view", camera.view.is_some()),
            ("look_at", camera.look_at.is_some() || self.style.framed.is_some()),
            ("zoom", camera.zoom.is_some()),
            ("roll", camera.roll.is_some()),
            ("projection", camera.projection.is_some()),
            ("margin", camera.margin.is_some()),
        ];
        given.into_iter().find(|(_, is_given)| *is_given).map(|(name, _)| name)
    }

    /// Returns the orientation of particles, with the direction that is asked for.
    pub fn orientation(&self, particles: &Particles) -> Orientation {
        let of_first = particles.first_frame.as_ref().map(|first| first.orientation);
        let found = of_first.or(particles.orientation);
        let found = found.unwrap_or_else(|| Orientation::of(particles));
        match self.up {
            Some(up) => Orientation { up, reason: UpReason::Chosen, ..found },
            None => found,
        }
    }
}

/// Composes a scene whose camera is not placed.
///
/// # Errors
/// A request that does not suit the content.
pub fn stage(
    request: &Request,
    subject: &Subject,
    content: Content,
    shared: Option<&Shared>,
) -> Result<Staged, Fault> {
    let (mut staged, mut facts, cell, shows_cell) = match content {
        Content::Particles(particles) => of_particles(request, subject, *particles, shared)?,
        Content::Scene(scene) => (of_scene(request, *scene), Facts::default(), None, false),
    };
    if let Some(sections) = &request.sections {
        staged.scene.slices.clone_from(&sections.scene.slices);
        staged.scene.annotations.clone_from(&sections.scene.annotations);
    }
    cut(request, subject, &mut staged, cell.as_ref().map(Cell::bounds))?;
    if let Some(shared) = shared {
        facts.categories.clone_from(&shared.categories);
    }
    annotations::add(request, subject, &mut staged.scene, staged.legend.as_ref(), &facts)?;
    staged.categories = facts.categories;
    let scene = &mut staged.scene;
    scene.camera.framed = camera::framed(request, scene);
    scene.look.background = request.background.unwrap_or(scene.look.background);
    scene.look.depth_cue = request.depth_cue.unwrap_or(scene.look.depth_cue);
    scene.look.outline = request.outline.unwrap_or(scene.look.outline);
    if let Some(sections) = &request.sections {
        sections.set_look(&mut scene.look);
    }
    if shows_cell {
        scene.look.cell = cell;
    }
    scene.settings.change(&request.settings);
    if let Some(sections) = &request.sections {
        sections.set_settings(&mut scene.settings);
    }
    annotations::set_resolution(scene);
    Ok(staged)
}

/// A scene of particles, their facts, their cell, and whether it is drawn.
type OfParticles = (Staged, Facts, Option<Cell>, bool);

fn of_particles(
    request: &Request,
    subject: &Subject,
    mut particles: Particles,
    shared: Option<&Shared>,
) -> Result<OfParticles, Fault> {
    let Subject { path, title, .. } = *subject;
    if let Some(sections) = &request.sections {
        particles.materials.clone_from(&sections.scene.materials);
    }
    let applied = request.style.apply(path, &mut particles)?;
    let mut facts = Facts::of(request, &particles, &applied);
    let shows_cell = request.cell.show || request.style.draws_crystal(&particles);
    repeat(request.cell, path, &mut particles)?;
    let cell = particles.frame.cell;
    let focus = camera::point_in_focus(request, path, &particles)?;
    let framed = particles.framed(path, &request.style)?;
    facts.marks = Marks::of(request, path, &particles)?;
    // Copies have made both larger.
    (facts.cell, facts.particles) = (cell, Some(particles.spheres.len()));
    let shared = shared.and_then(|shared| shared.orientation);
    let orientation = shared.unwrap_or_else(|| request.orientation(&particles));
    // All above is that of the particles of the file, without their images at the boundary.
    draw_boundary(request, path, &mut particles)?;
    let mut rows = take_rows(&mut particles);
    let ellipsoid_rows = rows.as_mut().map(|rows| take_ellipsoids(rows, &particles.frame.shapes));
    let arrow_sizes = particles.arrows.sizes;
    let first_frame = particles.first_frame.as_ref().map(|first| first.spheres);
    let mut labels = Labels::default();
    if request.keeps_labels {
        labels.kinds = std::mem::take(&mut particles.frame.kinds);
        labels.numbers = std::mem::take(&mut particles.frame.numbers);
        labels.texts = std::mem::take(&mut particles.frame.texts);
    }
    let preset = request.preset.unwrap_or_default();
    let mut scene = preset.scene(particles, title, &orientation);
    scene.camera.framed = framed;
    let staged = Staged {
        scene,
        legend: applied.legend().cloned(),
        applied,
        orientation: Some(orientation),
        categories: None,
        arrow_sizes,
        labels,
        rows,
        ellipsoid_rows,
        preset: Some(preset),
        normals: Vec::new(),
        first_frame,
        focus,
    };
    Ok((staged, facts, cell, shows_cell))
}

/// A scene with the materials and the look of the preset, if one is asked for.
fn of_scene(request: &Request, mut scene: Scene) -> Staged {
    if let Some(preset) = request.preset {
        preset.replace_materials(&mut scene);
        scene.look = crate::scene::Look { cell: scene.look.cell, ..preset.look() };
    }
    Staged {
        scene,
        legend: None,
        applied: Applied::default(),
        orientation: None,
        categories: None,
        arrow_sizes: None,
        labels: Labels::default(),
        rows: None,
        ellipsoid_rows: None,
        preset: request.preset,
        normals: Vec::new(),
        first_frame: None,
        focus: None,
    }
}

/// Wraps and replicates particles, and makes molecules whole.
///
/// # Errors
/// They have no cell, or are too many.
pub fn repeat(
    request: CellRequest,
    path: &Path,
    particles: &mut Particles,
) -> Result<(), FileError> {
    let refused = |error: PeriodicError| FileError::whole_file(path, error.to_string());
    if request.wrap {
        particles.wrap().map_err(refused)?;
    }
    if let Some(copies) = request.copies {
        particles.replicate(copies).map_err(refused)?;
    }
    particles.gather_molecules(request.boundary);
    if request.show && particles.frame.cell.is_none() {
        return Err(FileError::whole_file(path, "has no simulation cell to draw"));
    }
    Ok(())
}

/// Finds the polyhedra of particles, and draws the boundary of their cell.
fn draw_boundary(
    request: &Request,
    path: &Path,
    particles: &mut Particles,
) -> Result<(), FileError> {
    let polyhedra = request.style.find_polyhedra(path, particles)?;
    let drawn = particles.draw_boundary(request.cell.boundary, &polyhedra);
    drawn.map_err(|error| FileError::whole_file(path, error.to_string()))
}

/// Takes the column [`ROWS`], if there is one.
fn take_rows(particles: &mut Particles) -> Option<Vec<u32>> {
    let own = particles.frame.numbers.iter().position(|column| column.name == ROWS)?;
    let values = particles.frame.numbers.swap_remove(own).values;
    Some(values.into_iter().map(|row| row as u32).collect())
}

/// Takes the rows of particles that become ellipsoids.
fn take_ellipsoids(rows: &mut Vec<u32>, shapes: &Shapes) -> Vec<u32> {
    let numbered = || rows.iter().copied().enumerate();
    let ellipsoids = numbered().filter(|(at, _)| !shapes.is_sphere(*at)).map(|(_, row)| row);
    let ellipsoids = ellipsoids.collect();
    let spheres = numbered().filter(|(at, _)| shapes.is_sphere(*at)).map(|(_, row)| row).collect();
    *rows = spheres;
    ellipsoids
}

/// Cuts by the scene's slices and those of the request, whose percentages are of the cell if there is one.
fn cut(
    request: &Request,
    subject: &Subject,
    staged: &mut Staged,
    cell: Option<[DVec3; 2]>,
) -> Result<(), FileError> {
    let Staged { scene, rows, .. } = staged;
    if !request.planes.is_empty() {
        let whole = cell.or_else(|| scene.bounds()).unwrap_or_default();
        let slices = request.planes.iter().map(|plane| plane.slice(whole, request.slice_mode));
        scene.slices.extend(slices);
    }
    staged.normals = scene.cut_normals();
    if scene.slices.is_empty() {
        return Ok(());
    }
    let shown: Option<Vec<u32>> =
        request.keeps_rows.then(|| scene.shown().map(|row| row as u32).collect());
    let dropped = scene.drop_cut();
    if let (Some(shown), 1..) = (shown, dropped) {
        let before = rows.take();
        let of = |row: u32| before.as_ref().map_or(row, |before| before[row as usize]);
        *rows = Some(shown.into_iter().map(of).collect());
    }
    if dropped > 0 && scene.framed().next().is_none() && !request.style.allow_empty {
        let message = format!("the slices cut away all of its {dropped} spheres");
        return Err(FileError::whole_file(subject.path, message).with_help(
            "a slice describes the side that is cut away; for the other side write z<10 instead of z>10",
        ));
    }
    Ok(())
}
