//! Scenes: of particles with a style, of sections as in scene files, or of both.

use crate::errors::{KEYWORDS, error, of_file};
use crate::options::{ParticleTable, StyleTable};
use crate::pools::pool;
use crate::session::{RenderTable, page};
use crate::watch::{self, Watcher};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use spherule::color::{self, Rgb};
use spherule::compose::{
    self, AnnotationRequest, CameraRequest, CellRequest, Content, Labels, LookAt, ROWS, Request,
    Shared, Staged, Subject, Survey, Value,
};
use spherule::particles::{FileError, NumberColumn, ParticleFrame, ReadOptions};
use spherule::scene::particles::{
    Boundary, FirstFrame, Outside, ParticleStyle, Particles, TrajectoryReader, of_frame_in,
};
use spherule::scene::{
    Anchor, Axis, Camera, EnvironmentMap, Preset, SliceMode, SlicePlane, Spheres,
    text_without_columns, write,
};
use spherule::world::WorldError;
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The name of particles from arrays, in messages.
const ARRAYS: &str = "particles";

/// Why particles cannot be looked at.
const LOOK_AT: &str = "`look_at` needs particles for a selection; give a point, as in (1, 2, 3)";

/// A scene that Python holds.
#[pyclass(frozen, module = "spherule._spherule")]
pub(crate) struct Scene {
    held: Arc<Mutex<spherule::Scene>>,
    /// Row in the user's arrays of each sphere, unless they are the same; spheres of sections follow. If particles are
    /// ellipsoids, numbers of sticks, rows of the ellipsoids and numbers of those of sections are next.
    rows: Option<Arc<[u32]>>,
    /// Number of particles in the first frame of the file, if it has several.
    first_frame: Option<usize>,
    /// Types and columns of the spheres, if it is of particles.
    labels: Arc<Labels>,
}

/// A scene for work on other threads.
pub(crate) struct SharedScene {
    pub(crate) scene: Arc<Mutex<spherule::Scene>>,
    /// Row in the user's arrays of each sphere, unless they are the same.
    pub(crate) rows: Option<Arc<[u32]>>,
    /// Number of particles in the first frame of the file, if it has several.
    pub(crate) first_frame: Option<usize>,
    pub(crate) labels: Arc<Labels>,
}

/// The text of a scene without its spheres, their places and radii, their materials, colors, rows in the user's
/// arrays, and the number of particles in the first frame of its file.
type SceneColumns<'py> = (
    String,
    [Bound<'py, PyArray1<f64>>; 4],
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<f32>>,
    Option<Bound<'py, PyArray1<u32>>>,
    Option<usize>,
);

/// Sections as in a scene file.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Sections<'py> {
    /// TOML.
    text: String,
    /// The folder of the files that it names.
    folder: PathBuf,
    /// The keys of each section that is given.
    keys: HashMap<String, Vec<String>>,
    /// Corners of more triangles like the last of the text.
    triangles: Option<PyReadonlyArray1<'py, f64>>,
}

/// Options for the looks of particles, by the names that the program has for them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ViewTable {
    preset: Option<String>,
    view: Option<String>,
    look_at: Option<String>,
    zoom: Option<f64>,
    roll: Option<f64>,
    /// A scene file that the camera is taken from.
    camera: Option<PathBuf>,
    up: Option<String>,
    wrap: bool,
    replicate: Option<[u32; 3]>,
    complete: Option<bool>,
    outside: Option<String>,
    show_cell: bool,
    /// The position of the color bar.
    color_bar: Option<String>,
    /// Annotations as options of the program have them: the position, perhaps after something else.
    legend: Option<String>,
    axes: Option<String>,
    scale_bar: Option<String>,
    labels: Vec<String>,
    measures: Vec<String>,
    slices: Vec<String>,
    slice_mode: Option<String>,
}

/// The arguments of a scene of particles.
pub(crate) type SceneArguments<'py> = (Sections<'py>, ParticleTable<'py>, StyleTable, ViewTable);

/// A scene, and facts about its particles.
pub(crate) struct Numbered {
    scene: spherule::Scene,
    /// Row in the user's arrays of each sphere, unless they are the same.
    rows: Option<Vec<u32>>,
    /// Number of particles in the first frame of the file, if it has several.
    first_frame: Option<usize>,
    labels: Labels,
}

/// Why there is no scene.
pub(crate) enum Fault {
    File(FileError),
    Text(String),
}

impl From<FileError> for Fault {
    fn from(error: FileError) -> Self {
        Self::File(error)
    }
}

impl From<String> for Fault {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<WorldError> for Fault {
    fn from(error: WorldError) -> Self {
        Self::Text(error.to_string())
    }
}

impl From<compose::Fault> for Fault {
    fn from(fault: compose::Fault) -> Self {
        match fault {
            compose::Fault::File(error) => Self::File(error),
            compose::Fault::World(_, error) => error.into(),
            compose::Fault::Legend { .. } => Self::Text(
                "`legend` needs particles whose colors stand for elements, types or the texts of `color_by`; use \
                 `color_bar` for numbers"
                    .to_owned(),
            ),
            compose::Fault::AxesOfCell => {
                Self::Text("`axes` of the cell need particles with a `cell`".to_owned())
            }
            compose::Fault::Label { row, why } => Self::Text(format!("label[{row}]: {why}")),
            compose::Fault::Measure { row, why } => Self::Text(format!("measure[{row}]: {why}")),
            // No argument asks for more.
            other => Self::Text(format!("{other:?}")),
        }
    }
}

impl Fault {
    pub(crate) fn raise(&self, py: Python<'_>) -> PyErr {
        match self {
            Self::File(error) => of_file(py, error),
            Self::Text(text) => error(py, text),
        }
    }
}

#[pymethods]
impl Scene {
    #[new]
    fn new(
        py: Python<'_>,
        sections: Sections<'_>,
        particles: Option<ParticleTable<'_>>,
        style: StyleTable,
        view: ViewTable,
    ) -> PyResult<Self> {
        let mut request = view.request().map_err(|fault| fault.raise(py))?;
        let given = sections.parse().map_err(|fault| fault.raise(py))?;
        let made = match particles {
            None if request.style.framed.is_some() => Err(LOOK_AT.to_owned().into()),
            None => complete(given, &request),
            Some(table) => {
                let sections = compose::Sections { scene: given, keys: sections.keys };
                request.sections = Some(sections);
                let work = Work::of(py, table, style, request)?;
                // Copies and orientation of many particles take a while.
                Watcher::default().run(py, pool(py, None)?, |_| work.scene())?.0
            }
        };
        Ok(Self::of(made.map_err(|fault| fault.raise(py))?))
    }

    /// Reads a scene file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = move || complete(spherule::Scene::load(&path)?, &Request::default());
        let read = Watcher::default().run(py, pool(py, None)?, move |_| read())?.0;
        Ok(Self::of(read.map_err(|fault: Fault| fault.raise(py))?))
    }

    /// Writes a scene file, and the files beside it.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write(&self.lock(), &path)).map_err(|error| of_file(py, &error))
    }

    /// The page of HTML of a PNG file that the settings render, with the names of its particles.
    fn page(&self, py: Python<'_>, table: RenderTable, file: Vec<u8>) -> PyResult<String> {
        let (request, pool) = table.request(py)?;
        let scene = self.share();
        let work = move |_: &watch::Shared| page(&pool, &scene, &request, file);
        let (page, _) = Watcher::default().run_outside(py, work)?;
        page.map_err(|fault| fault.raise(py))
    }

    /// All of the scene, as `of_columns` takes it.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<SceneColumns<'py>> {
        let (text, spheres) = py
            .detach(|| {
                let scene = self.lock();
                if let EnvironmentMap::Picture { .. } = scene.environment.map {
                    return Err(
                        "a scene with a picture as its environment cannot be pickled: save \
                                it to a file"
                            .to_owned(),
                    );
                }
                Ok((text_without_columns(&scene)?, scene.spheres.clone()))
            })
            .map_err(|why| error(py, &why))?;
        let column = |values| PyArray1::from_vec(py, values);
        let colors: Vec<[f32; 3]> = spheres.color.iter().map(Rgb::to_array).collect();
        let material = PyArray1::from_vec(py, spheres.material);
        let places = [spheres.x, spheres.y, spheres.z, spheres.radius].map(column);
        let color = PyArray1::from_vec(py, colors.into_flattened());
        let rows = self.rows.as_ref().map(|rows| PyArray1::from_slice(py, rows));
        Ok((text, places, material, color, rows, self.first_frame))
    }

    /// The scene that `columns` describes.
    #[staticmethod]
    #[pyo3(signature = (text, places, material, color, rows, first_frame=None))]
    fn of_columns(
        py: Python<'_>,
        text: &str,
        places: [PyReadonlyArray1<'_, f64>; 4],
        material: PyReadonlyArray1<'_, u32>,
        color: PyReadonlyArray1<'_, f32>,
        rows: Option<PyReadonlyArray1<'_, u32>>,
        first_frame: Option<usize>,
    ) -> PyResult<Self> {
        let scene = spherule::Scene::parse(text, KEYWORDS, Path::new(""));
        let mut scene = scene.map_err(|error| of_file(py, &error))?;
        let [x, y, z, radius] = places.map(|column| column.as_array().to_vec());
        let material = material.as_array().to_vec();
        let color = color.as_array().to_vec();
        let color = color.as_chunks().0.iter().map(|&color| Rgb::from_array(color)).collect();
        scene.spheres = Spheres { x, y, z, radius, material, color };
        let rows = rows.map(|rows| rows.as_array().to_vec());
        Ok(Self::of(Numbered { scene, rows, first_frame, labels: Labels::default() }))
    }

    /// The number of spheres and ellipsoids.
    fn __len__(&self, py: Python<'_>) -> usize {
        py.detach(|| {
            let scene = self.lock();
            scene.spheres.len() + scene.ellipsoids.len()
        })
    }

    #[getter]
    fn title(&self, py: Python<'_>) -> String {
        py.detach(|| self.lock().title.clone())
    }

    /// Width and height in pixels.
    #[getter]
    fn size(&self, py: Python<'_>) -> (u32, u32) {
        let (width, height) = py.detach(|| {
            let scene = self.lock();
            (scene.settings.width, scene.settings.height)
        });
        (width, height)
    }

    #[getter]
    fn warnings(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.lock().warnings.clone())
    }

    /// The lower and the upper corner of the box of all spheres and ellipsoids.
    #[getter]
    fn bounds(&self, py: Python<'_>) -> Option<([f64; 3], [f64; 3])> {
        let [low, high] = py.detach(|| self.lock().bounds())?;
        Some((low.to_array(), high.to_array()))
    }

    #[getter]
    fn materials(&self, py: Python<'_>) -> Vec<String> {
        py.detach(|| self.lock().materials.iter().map(|row| row.name.clone()).collect())
    }
}

impl Scene {
    pub(crate) fn of(Numbered { scene, rows, first_frame, labels }: Numbered) -> Self {
        let (held, rows) = (Arc::new(Mutex::new(scene)), rows.map(Arc::from));
        Self { held, rows, first_frame, labels: Arc::new(labels) }
    }

    pub(crate) fn share(&self) -> SharedScene {
        SharedScene {
            scene: Arc::clone(&self.held),
            rows: self.rows.clone(),
            first_frame: self.first_frame,
            labels: Arc::clone(&self.labels),
        }
    }

    fn lock(&self) -> MutexGuard<'_, spherule::Scene> {
        self.held.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Sections<'_> {
    fn parse(&self) -> Result<spherule::Scene, Fault> {
        let mut scene = spherule::Scene::parse(&self.text, KEYWORDS, &self.folder)?;
        let triangles = &mut scene.triangles;
        let last = triangles.material.last().copied().zip(triangles.color.last().copied());
        let numbers = self.triangles.as_ref().and_then(|numbers| numbers.as_slice().ok());
        if let (Some(numbers), Some((material, color))) = (numbers, last) {
            for corners in numbers.as_chunks::<3>().0.as_chunks::<3>().0 {
                triangles.push(corners.map(Into::into), material, color);
            }
        }
        Ok(scene)
    }
}

impl ViewTable {
    fn request(&self) -> Result<Request, Fault> {
        fn word<T>(
            name: &str,
            word: Option<&String>,
            find: impl Fn(&str) -> Option<T>,
            all: &[&str],
        ) -> Result<Option<T>, String> {
            let Some(word) = word else { return Ok(None) };
            let refused = || format!("`{name}` is \"{word}\", but must be {}", all.join(", "));
            find(word).map(Some).ok_or_else(refused)
        }
        let Self { wrap, replicate: copies, complete, show_cell: show, .. } = *self;
        let outside = |name: &str| {
            Outside::ALL.iter().find(|(own, _)| *own == name).map(|(_, outside)| *outside)
        };
        let treatments = Outside::ALL.map(|(name, _)| name);
        let outside = word("outside", self.outside.as_ref(), outside, &treatments)?;
        let boundary = Boundary { complete, outside };
        let presets = Preset::ALL.map(Preset::name);
        let preset = |name: &str| Preset::ALL.into_iter().find(|preset| preset.name() == name);
        let mode =
            |name: &str| SliceMode::ALL.iter().find(|(own, _)| *own == name).map(|(_, mode)| *mode);
        let axes: Vec<&str> = Axis::ALL.iter().map(|(name, _)| *name).collect();
        let view = self.view.as_deref().map(str::parse).transpose();
        let planes = self.slices.iter().map(|text| {
            text.parse::<SlicePlane>().map_err(|why| format!("slice \"{text}\": {why}"))
        });
        if copies.is_some_and(|copies| copies.contains(&0)) {
            let message = "`replicate` must be three integers of at least 1, as in (2, 2, 1)";
            return Err(message.to_owned().into());
        }
        let bar = word(
            "color_bar",
            self.color_bar.as_ref(),
            Anchor::named,
            &Anchor::ALL.map(|(name, _)| name),
        )?;
        let annotations = AnnotationRequest {
            color_bar: bar,
            legend: annotation("legend", self.legend.as_ref(), compose::position)?,
            axes: annotation("axes", self.axes.as_ref(), str::parse)?,
            scale_bar: annotation("scale_bar", self.scale_bar.as_ref(), str::parse)?,
            labels: rows("label", &self.labels)?,
            measures: rows("measure", &self.measures)?,
            ..AnnotationRequest::default()
        };
        let modes = SliceMode::ALL.map(|(name, _)| name);
        let look_at = self.look_at.as_deref().map(str::parse).transpose();
        let (framed, look_at) = match look_at.map_err(|why: String| format!("`look_at`: {why}"))? {
            Some(LookAt::Selection(selection)) => (Some(selection), None),
            Some(LookAt::Point(point)) => (None, Some(point)),
            None => (None, None),
        };
        let zoom = self.zoom.map(compose::zoom).transpose();
        if let Some(roll) = self.roll.filter(|roll| !roll.is_finite()) {
            return Err(format!("`roll` is {roll}, but must be degrees").into());
        }
        let request = Request {
            style: ParticleStyle { framed, ..ParticleStyle::default() },
            preset: word("preset", self.preset.as_ref(), preset, &presets)?,
            camera: CameraRequest {
                own: self.camera.as_deref().map(Camera::read).transpose()?,
                view: view.map_err(|why: String| format!("`view`: {why}"))?,
                look_at,
                zoom: zoom.map_err(|why| format!("`zoom`: {why}"))?,
                roll: self.roll,
                ..CameraRequest::default()
            },
            up: word("up", self.up.as_ref(), Axis::named, &axes)?,
            cell: CellRequest { wrap, copies, show, boundary },
            annotations,
            planes: planes.collect::<Result<_, _>>()?,
            slice_mode: word("slice_mode", self.slice_mode.as_ref(), mode, &modes)?
                .unwrap_or_default(),
            keeps_rows: true,
            keeps_labels: true,
            ..Request::default()
        };
        match request.contradiction() {
            Some(name) => Err(format!("`camera` says all of the camera; remove `{name}`").into()),
            None => Ok(request),
        }
    }
}

/// Parses an annotation, which has this name.
fn annotation<T>(
    name: &str,
    text: Option<&String>,
    parse: impl Fn(&str) -> Result<T, String>,
) -> Result<Option<T>, String> {
    let parsed = text.map(|text| parse(text)).transpose();
    parsed.map_err(|why| format!("`{name}`: {why}"))
}

/// Parses annotations of which there may be several, which have this name.
fn rows<T: FromStr<Err = String>>(name: &str, texts: &[String]) -> Result<Vec<T>, String> {
    let parse =
        |(row, text): (usize, &String)| text.parse().map_err(|why| format!("{name}[{row}]: {why}"));
    texts.iter().enumerate().map(parse).collect()
}

/// The name of arrays in messages, and the title of their scene.
fn subject(title: &str) -> Subject<'_> {
    Subject { path: Path::new(ARRAYS), title, frame: &Value::Missing("arrays have none") }
}

/// Completes a scene of sections alone, as the program does with a scene file.
fn complete(scene: spherule::Scene, request: &Request) -> Result<Numbered, Fault> {
    let content = Content::Scene(Box::new(scene));
    let mut staged = compose::stage(request, &subject(""), content, None)?;
    compose::choose(request, &mut staged)?;
    let Staged { scene, rows, labels, .. } = staged;
    Ok(Numbered { scene, rows, first_frame: None, labels })
}

/// Particles, style and sections of a scene of particles.
pub(crate) struct Work {
    frame: ParticleFrame,
    first_frame: Option<FirstFrame>,
    options: ReadOptions,
    /// With the sections that are given.
    request: Request,
}

impl Work {
    pub(crate) fn of(
        py: Python<'_>,
        mut table: ParticleTable<'_>,
        style: StyleTable,
        mut request: Request,
    ) -> PyResult<Self> {
        let first_frame = table.first_frame.take();
        let (frame, options) = table.frame(py)?;
        let first_frame = first_frame.map(|first| first.first_frame(frame.format));
        let framed = request.style.framed.take();
        let also_read = request.annotations.columns();
        let style = style.style(py, options.radius_scale)?;
        request.style = ParticleStyle { framed, also_read, ..style };
        if request.annotations.color_bar.is_some() {
            request.style.coloring.prefer_map();
        }
        Ok(Self { frame, first_frame, options, request })
    }

    /// The work of a frame of a sequence, in which single frames may be empty; `arguments` are those of [`Scene`].
    pub(crate) fn of_frame(
        py: Python<'_>,
        (sections, table, style, view): SceneArguments<'_>,
    ) -> PyResult<Self> {
        let mut request = view.request().map_err(|fault| fault.raise(py))?;
        let scene = sections.parse().map_err(|fault| fault.raise(py))?;
        request.sections = Some(compose::Sections { scene, keys: sections.keys });
        let mut work = Self::of(py, table, style, request)?;
        (work.options.allow_empty, work.request.style.allow_empty) = (true, true);
        Ok(work)
    }

    /// Makes the scene, whose camera is not placed: its size may change. Sections that are given replace what the preset
    /// has.
    fn scene(mut self) -> Result<Numbered, Fault> {
        let count = self.frame.len();
        let (title, particles) = self.particles(None)?;
        let mut staged = stage(&self.request, &title, particles, None)?;
        compose::choose(&self.request, &mut staged)?;
        append_bodies(&self.request, &mut staged, count);
        compose::light_ahead(&self.request, &mut staged)?;
        Ok(self.numbered(staged))
    }

    /// Surveys the frame of a sequence.
    pub(crate) fn survey(mut self, survey: &mut Option<Survey>) -> Result<(), Fault> {
        let count = self.frame.len();
        let first_frame = self.first_frame.take();
        let new = || Survey::new(TrajectoryReader::of_first(first_frame));
        let survey = survey.get_or_insert_with(new);
        let (title, particles) = self.particles(Some(survey))?;
        let request = survey.begin_frame(&self.request, &particles);
        let mut staged = stage(&request, &title, particles, None)?;
        append_bodies(&self.request, &mut staged, count);
        Ok(survey.add(&self.request, staged)?)
    }

    /// Makes the scene of the frame of a sequence, with what all frames share.
    pub(crate) fn scene_of(mut self, survey: &mut Survey) -> Result<Numbered, Fault> {
        survey.check(Path::new(ARRAYS), &self.request.style)?;
        let count = self.frame.len();
        survey.fix_colors(&mut self.request.style);
        survey.fix_arrows(self.request.style.arrows.as_mut());
        let shared = survey.shared(&self.request, None)?;
        let (title, particles) = self.particles(Some(survey))?;
        let mut staged = stage(&self.request, &title, particles, Some(&shared))?;
        append_bodies(&self.request, &mut staged, count);
        compose::place(&self.request, &mut staged, Some(&shared), None)?;
        Ok(self.numbered(staged))
    }

    /// Takes the title and the particles, by the choices of a sequence if they are of one.
    fn particles(&mut self, survey: Option<&mut Survey>) -> Result<(String, Particles), Fault> {
        let renumbers = self.renumbers();
        let mut frame = std::mem::take(&mut self.frame);
        let Self { options, request, .. } = self;
        if renumbers || has_undrawn_rows(&frame) || !frame.shapes.is_empty() {
            // Columns of numbers follow their rows through selections and copies.
            let values = (0..frame.len()).map(|row| row as f64).collect();
            frame.numbers.push(NumberColumn { name: ROWS.to_owned(), values });
        }
        let path = Path::new(ARRAYS);
        let title = frame.title.clone();
        let columns = [request.style.columns(), options.columns.wanted.clone()].concat();
        let bonds = request.style.bond_source();
        frame
            .add_derived_columns(&columns, &bonds)
            .and_then(|()| frame.find_bonds(&bonds))
            .map_err(|message| FileError::whole_file(path, message))?;
        let particles = match survey {
            None => of_frame_in(path, frame, options, self.first_frame.take())?,
            Some(survey) => {
                survey.add_first(path, &frame, options, request.style.arrows.as_ref());
                survey.particles(path, frame, options)?
            }
        };
        Ok((title, particles))
    }

    /// The finished scene, with the warnings of its sections.
    fn numbered(&self, mut staged: Staged) -> Numbered {
        if let Some(sections) = &self.request.sections {
            staged.scene.warnings.extend(sections.scene.warnings.iter().cloned());
        }
        let Staged { scene, rows, first_frame, labels, .. } = staged;
        Numbered { scene, rows, first_frame, labels }
    }

    /// Returns whether spheres may get other rows than their particles.
    fn renumbers(&self) -> bool {
        // Radii may be 0 after a factor: their rows are dropped.
        let scaled = self.options.radius_scale != 1.0;
        let Request { style, cell: CellRequest { copies, boundary, .. }, .. } = &self.request;
        let has_images = self.frame.cell.is_some()
            && (boundary.complete.unwrap_or_else(|| self.frame.has_crystal_cell())
                || boundary.outside == Some(Outside::Whole)
                || !style.polyhedra.is_empty());
        let drops = style.select.is_some() || !style.styles.is_empty();
        drops || copies.is_some() || scaled || has_images
    }
}

/// Composes the scene of particles. Colors that a bar is asked for stand for numbers.
fn stage(
    request: &Request,
    title: &str,
    particles: Particles,
    shared: Option<&Shared>,
) -> Result<Staged, Fault> {
    let content = Content::Particles(Box::new(particles));
    let staged = compose::stage(request, &subject(title), content, shared)?;
    let is_empty = request.style.allow_empty && staged.scene.is_empty();
    if request.annotations.color_bar.is_some() && staged.legend.is_none() && !is_empty {
        return Err(Fault::Text(
            "`color_bar` needs colors that stand for numbers; give `values`, or `color_by` with the \
             name of a column of numbers"
                .to_owned(),
        ));
    }
    Ok(staged)
}

/// Appends the bodies of sections to those of `count` particles.
fn append_bodies(request: &Request, staged: &mut Staged, count: usize) {
    if let Some(sections) = &request.sections {
        sections.append_bodies(staged, count);
    }
}

/// Returns whether a frame has rows that are not drawn: those of a file without a radius, and virtual sites.
fn has_undrawn_rows(frame: &ParticleFrame) -> bool {
    let invalid = |column: &Vec<f64>| !column.iter().all(|value| value.is_finite());
    frame.kinds.table.iter().any(|kind| kind.virtual_site)
        || frame.radius.iter().any(|radius| !(*radius > 0.0 && radius.is_finite()))
        || [&frame.x, &frame.y, &frame.z].into_iter().any(invalid)
}

/// The linear color that a name or `#rrggbb` stands for; `None` if it is neither.
#[pyfunction]
pub(crate) fn color_of(text: &str) -> Option<[f32; 3]> {
    color::parse(text).map(|color| color.to_array())
}

/// The linear color of three sRGB values, 0 to 1.
#[pyfunction]
pub(crate) fn linear_color(encoded: [f32; 3]) -> [f32; 3] {
    encoded.map(color::linear_from_srgb)
}
