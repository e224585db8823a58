//! Scenes: of particles with a style, of sections as in scene files, or of both.

use crate::errors::{KEYWORDS, error, of_file};
use crate::options::{ParticleTable, StyleTable};
use crate::pools::pool;
use crate::watch::Watcher;
use glam::DVec3;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use spherule::color::{self, Rgb};
use spherule::overlay::annotations;
use spherule::particles::{FileError, NumberColumn, ParticleFrame, ReadOptions};
use spherule::scene::particles::{
    Legend, Orientation, ParticleStyle, Particles, Shapes, UpReason, of_frame,
};
use spherule::scene::{
    Anchor, Axis, Camera, ColorBar, EnvironmentMap, Insets, Pose, Preset, SliceMode, SlicePlane,
    Spheres, text_without_columns, write,
};
use spherule::settings::SETTINGS;
use spherule::world::WorldError;
use spherule::world::framing::{self, View};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// The name of particles from arrays, in messages.
const ARRAYS: &str = "particles";

/// The column of rows in the user's arrays, which no expression can name.
const ROWS: &str = "\0rows";

/// A scene that Python holds.
#[pyclass(frozen, module = "spherule._spherule")]
pub(crate) struct Scene {
    scene: Arc<Mutex<spherule::Scene>>,
    /// Row in the user's arrays of each sphere, unless they are the same; spheres of sections follow. If particles are
    /// ellipsoids, numbers of sticks, rows of the ellipsoids and numbers of those of sections are next.
    rows: Option<Arc<[u32]>>,
}

/// A scene for work on other threads.
pub(crate) struct SharedScene {
    pub(crate) scene: Arc<Mutex<spherule::Scene>>,
    /// Row in the user's arrays of each sphere, unless they are the same.
    pub(crate) rows: Option<Arc<[u32]>>,
}

/// The text of a scene without its spheres, their places and radii, their materials, colors, and rows in the user's
/// arrays.
type SceneColumns<'py> = (
    String,
    [Bound<'py, PyArray1<f64>>; 4],
    Bound<'py, PyArray1<u32>>,
    Bound<'py, PyArray1<f32>>,
    Option<Bound<'py, PyArray1<u32>>>,
);

/// Sections as in a scene file.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct Sections {
    /// TOML.
    text: String,
    /// The folder of the files that it names.
    folder: PathBuf,
    /// The keys of each section that is given.
    keys: HashMap<String, Vec<String>>,
}

/// Options for the looks of particles, by the names that the program has for them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
struct ViewTable {
    preset: Option<String>,
    view: Option<String>,
    up: Option<String>,
    wrap: bool,
    replicate: Option<[u32; 3]>,
    show_cell: bool,
    /// The position of the color bar.
    color_bar: Option<String>,
    slices: Vec<String>,
    slice_mode: Option<String>,
}

/// The words of a [`ViewTable`], understood.
#[derive(Default)]
struct Staging {
    preset: Preset,
    view: Option<View>,
    up: Option<Axis>,
    wrap: bool,
    replicate: Option<[u32; 3]>,
    show_cell: bool,
    color_bar: Option<Anchor>,
    planes: Vec<SlicePlane>,
    slice_mode: SliceMode,
}

/// A scene, and the row in the user's arrays of each sphere, unless they are the same.
type Numbered = (spherule::Scene, Option<Vec<u32>>);

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
        sections: Sections,
        particles: Option<ParticleTable<'_>>,
        style: StyleTable,
        view: ViewTable,
    ) -> PyResult<Self> {
        let staging = Staging::of(&view).map_err(|message| error(py, &message))?;
        let given = sections.parse().map_err(|fault| fault.raise(py))?;
        let made = match particles {
            None => Work::placed(given, &staging),
            Some(table) => {
                let (frame, options) = table.frame(py)?;
                let style = style.style(py, options.radius_scale)?;
                let work = Work { frame, options, style, staging, given, keys: sections.keys };
                // Copies and orientation of many particles take a while.
                Watcher::default().run(py, pool(py, None)?, |_| work.scene())?.0
            }
        };
        let (scene, rows) = made.map_err(|fault| fault.raise(py))?;
        Ok(Self::of(scene, rows))
    }

    /// Reads a scene file.
    #[staticmethod]
    fn load(py: Python<'_>, path: PathBuf) -> PyResult<Self> {
        let read = move || Work::placed(spherule::Scene::load(&path)?, &Staging::default());
        let read = Watcher::default().run(py, pool(py, None)?, move |_| read())?.0;
        let (scene, rows) = read.map_err(|fault: Fault| fault.raise(py))?;
        Ok(Self::of(scene, rows))
    }

    /// Writes a scene file, and the files beside it.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| write(&self.lock(), &path)).map_err(|error| of_file(py, &error))
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
        Ok((text, places, material, color, rows))
    }

    /// The scene that `columns` describes.
    #[staticmethod]
    fn of_columns(
        py: Python<'_>,
        text: &str,
        places: [PyReadonlyArray1<'_, f64>; 4],
        material: PyReadonlyArray1<'_, u32>,
        color: PyReadonlyArray1<'_, f32>,
        rows: Option<PyReadonlyArray1<'_, u32>>,
    ) -> PyResult<Self> {
        let scene = spherule::Scene::parse(text, KEYWORDS, Path::new(""));
        let mut scene = scene.map_err(|error| of_file(py, &error))?;
        let [x, y, z, radius] = places.map(|column| column.as_array().to_vec());
        let material = material.as_array().to_vec();
        let color = color.as_array().to_vec();
        let color = color.as_chunks().0.iter().map(|&color| Rgb::from_array(color)).collect();
        scene.spheres = Spheres { x, y, z, radius, material, color };
        Ok(Self::of(scene, rows.map(|rows| rows.as_array().to_vec())))
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
    fn of(scene: spherule::Scene, rows: Option<Vec<u32>>) -> Self {
        Self { scene: Arc::new(Mutex::new(scene)), rows: rows.map(Arc::from) }
    }

    pub(crate) fn share(&self) -> SharedScene {
        SharedScene { scene: Arc::clone(&self.scene), rows: self.rows.clone() }
    }

    fn lock(&self) -> MutexGuard<'_, spherule::Scene> {
        self.scene.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Sections {
    fn parse(&self) -> Result<spherule::Scene, Fault> {
        Ok(spherule::Scene::parse(&self.text, KEYWORDS, &self.folder)?)
    }
}

impl Staging {
    fn of(table: &ViewTable) -> Result<Self, String> {
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
        let ViewTable { wrap, replicate, show_cell, .. } = *table;
        let presets = Preset::ALL.map(Preset::name);
        let preset = |name: &str| Preset::ALL.into_iter().find(|preset| preset.name() == name);
        let mode =
            |name: &str| SliceMode::ALL.iter().find(|(own, _)| *own == name).map(|(_, mode)| *mode);
        let axes: Vec<&str> = Axis::ALL.iter().map(|(name, _)| *name).collect();
        let view = table.view.as_deref().map(str::parse).transpose();
        let planes = table.slices.iter().map(|text| {
            text.parse::<SlicePlane>().map_err(|why| format!("slice \"{text}\": {why}"))
        });
        if replicate.is_some_and(|copies| copies.contains(&0)) {
            return Err("`replicate` must be three integers of at least 1, as in (2, 2, 1)".into());
        }
        Ok(Self {
            preset: word("preset", table.preset.as_ref(), preset, &presets)?.unwrap_or_default(),
            view: view.map_err(|why: String| format!("`view`: {why}"))?,
            up: word("up", table.up.as_ref(), Axis::named, &axes)?,
            wrap,
            replicate,
            show_cell,
            color_bar: word(
                "color_bar",
                table.color_bar.as_ref(),
                Anchor::named,
                &Anchor::ALL.map(|(name, _)| name),
            )?,
            planes: planes.collect::<Result<_, _>>()?,
            slice_mode: word(
                "slice_mode",
                table.slice_mode.as_ref(),
                mode,
                &SliceMode::ALL.map(|(name, _)| name),
            )?
            .unwrap_or_default(),
        })
    }
}

/// Particles, style and sections of a scene of particles.
struct Work {
    frame: ParticleFrame,
    options: ReadOptions,
    style: ParticleStyle,
    staging: Staging,
    /// The sections that are given.
    given: spherule::Scene,
    keys: HashMap<String, Vec<String>>,
}

impl Work {
    /// Completes a scene of sections alone, as the program does with a scene file.
    fn placed(mut scene: spherule::Scene, staging: &Staging) -> Result<Numbered, Fault> {
        let mut rows = None;
        let normals = staging.cut(&mut scene, None, &mut rows)?;
        framing::choose(&mut scene, staging.view, None, &normals);
        Ok((scene, rows))
    }

    /// Makes the scene in the order of the program: the preset, then slices, annotations, the look, settings, the
    /// camera, and lights that depend on it. Sections that are given replace what the preset has.
    fn scene(mut self) -> Result<Numbered, Fault> {
        let mut frame = std::mem::take(&mut self.frame);
        let count = frame.len();
        if self.renumbers() || has_undrawn_rows(&frame) || !frame.shapes.is_empty() {
            // Columns of numbers follow their rows through selections and copies.
            let values = (0..count).map(|row| row as f64).collect();
            frame.numbers.push(NumberColumn { name: ROWS.to_owned(), values });
        }
        let has = |section: &str| self.keys.contains_key(section);
        let Self { options, style, staging, given, .. } = &self;
        let path = Path::new(ARRAYS);
        let title = frame.title.clone();
        frame
            .add_derived_columns(&style.columns(), &style.bond_source())
            .and_then(|()| frame.find_bonds(&style.bond_source()))
            .map_err(|message| FileError::whole_file(path, message))?;
        let mut particles = of_frame(path, frame, options)?;
        particles.materials.clone_from(&given.materials);
        let legend = style.apply(path, &mut particles)?;
        let is_crystal = style.draws_crystal(&particles);
        let refused = |why: spherule::scene::particles::PeriodicError| {
            FileError::whole_file(path, why.to_string())
        };
        if staging.wrap {
            particles.wrap().map_err(refused)?;
        }
        if let Some(copies) = staging.replicate {
            particles.replicate(copies).map_err(refused)?;
        }
        let cell = particles.cell;
        if staging.show_cell && cell.is_none() {
            return Err(FileError::whole_file(path, "has no simulation cell to draw").into());
        }
        let own = particles.numbers.iter().position(|column| column.name == ROWS);
        let own = own.map(|column| particles.numbers.swap_remove(column).values);
        let mut rows: Option<Vec<u32>> =
            own.map(|values| values.into_iter().map(|row| row as u32).collect());
        let ellipsoids = rows.as_mut().map(|rows| take_ellipsoids(rows, &particles.shapes));
        let orientation = staging.orientation(&particles);
        let preset = staging.preset;
        let mut scene = preset.scene(particles, &title, &orientation);
        scene.slices.clone_from(&given.slices);
        let normals = staging.cut(&mut scene, cell.map(|cell| cell.bounds()), &mut rows)?;
        scene.annotations.clone_from(&given.annotations);
        staging.annotate(&mut scene, legend)?;
        if let Some(keys) = self.keys.get("look") {
            let has = |key: &str| keys.iter().any(|own| own == key);
            let look = &mut scene.look;
            if has("background") {
                look.background = given.look.background;
            }
            if has("depth_cue") {
                look.depth_cue = given.look.depth_cue;
            }
            if has("outline") {
                look.outline = given.look.outline;
            }
            look.cell = given.look.cell;
        }
        if staging.show_cell || is_crystal {
            scene.look.cell = cell;
        }
        if let Some(keys) = self.keys.get("render") {
            change(&mut scene.settings, &given.settings, keys);
        }
        let camera = self.keys.get("camera").map_or(&[][..], Vec::as_slice);
        set_camera(&mut scene.camera, &given.camera, camera);
        if !has_pose(camera) {
            framing::choose(&mut scene, staging.view, Some(&orientation), &normals);
        }
        self.append_bodies(&mut scene);
        if let Some(rows) = &mut rows {
            let added = scene.spheres.len() - rows.len();
            let mut next = count;
            let mut number = |more: usize| {
                next += more;
                (next - more..next).map(|row| row as u32)
            };
            rows.extend(number(added));
            if let Some(ellipsoids) = ellipsoids.filter(|rows| !rows.is_empty()) {
                let more = scene.ellipsoids.len() - ellipsoids.len();
                rows.extend(number(scene.sticks.len()));
                rows.extend(ellipsoids);
                rows.extend(number(more));
            }
        }
        if ["light", "environment", "ground"].into_iter().any(has) {
            scene.lights.clone_from(&given.lights);
            scene.environment = given.environment.clone();
            scene.ground = given.ground.clone().map(|mut ground| {
                ground.material = material_row(&mut scene, given, ground.material);
                ground
            });
        } else {
            // Lights follow the camera where it will be.
            let camera = scene.camera.clone();
            place(&mut scene)?;
            let vertical = framing::vertical(staging.view, &scene.camera, Some(&orientation));
            preset.light(&mut scene, vertical);
            scene.camera = camera;
        }
        scene.warnings.extend(given.warnings.iter().cloned());
        Ok((scene, rows))
    }

    /// Returns whether spheres may get other rows than their particles.
    fn renumbers(&self) -> bool {
        // Radii may be 0 after a factor: their rows are dropped.
        let scaled = self.options.radius_scale != 1.0;
        self.style.select.is_some() || self.staging.replicate.is_some() || scaled
    }

    /// Adds the bodies of the sections, and their materials.
    fn append_bodies(&self, scene: &mut spherule::Scene) {
        if self.given.is_empty() {
            return;
        }
        let count = self.given.materials.len() as u32;
        let rows: Vec<u32> = (0..count).map(|row| material_row(scene, &self.given, row)).collect();
        scene.spheres.append(self.given.spheres.clone(), &rows);
        let sticks = &self.given.sticks;
        for row in 0..sticks.len() {
            let material = rows.get(sticks.material[row] as usize).copied().unwrap_or(0);
            scene.sticks.push(sticks.ends(row), sticks.radius[row], material, sticks.colors[row]);
        }
        let given = &self.given.ellipsoids;
        for row in 0..given.len() {
            let material = rows.get(given.material[row] as usize).copied().unwrap_or(0);
            let (center, semi_axes) = (given.center[row], given.semi_axes[row]);
            let (orientation, color) = (given.orientation[row], given.color[row]);
            scene.ellipsoids.push(center, semi_axes, orientation, material, color);
        }
        let given = &self.given.cones;
        for row in 0..given.len() {
            let material = rows.get(given.material[row] as usize).copied().unwrap_or(0);
            let (apex, base) = (given.apex[row], given.base[row]);
            scene.cones.push(apex, base, given.radius[row], material, given.color[row]);
        }
    }
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

/// Returns whether a frame has rows that are not drawn: those of a file without a radius, and virtual sites.
fn has_undrawn_rows(frame: &ParticleFrame) -> bool {
    let invalid = |column: &Vec<f64>| !column.iter().all(|value| value.is_finite());
    frame.kinds.table.iter().any(|kind| kind.virtual_site)
        || frame.radius.iter().any(|radius| !(*radius > 0.0 && radius.is_finite()))
        || [&frame.x, &frame.y, &frame.z].into_iter().any(invalid)
}

/// The row in `scene` of a material of `given`, which is added if it is not there.
fn material_row(scene: &mut spherule::Scene, given: &spherule::Scene, row: u32) -> u32 {
    let Some(material) = given.materials.get(row as usize) else { return 0 };
    let found = scene.materials.iter().position(|own| own.name == material.name);
    let place = found.unwrap_or_else(|| {
        scene.materials.push(material.clone());
        scene.materials.len() - 1
    });
    place as u32
}

/// Overrides settings with those of these names.
pub(crate) fn change(
    settings: &mut spherule::scene::Settings,
    given: &spherule::scene::Settings,
    keys: &[String],
) {
    let named = SETTINGS.iter().filter(|setting| keys.iter().any(|key| key == setting.name));
    let values: Vec<_> = named.map(|setting| (setting.name, setting.get(given))).collect();
    settings.change(&values);
}

/// Returns whether a camera's place is among the keys.
fn has_pose(keys: &[String]) -> bool {
    keys.iter().any(|key| ["eye", "target", "direction"].contains(&key.as_str()))
}

/// Sets the properties of a camera that the keys name.
fn set_camera(camera: &mut Camera, given: &Camera, keys: &[String]) {
    let has = |names: &[&str]| keys.iter().any(|key| names.contains(&key.as_str()));
    if has(&["projection", "fov", "height"]) {
        camera.projection = given.projection;
    }
    if has_pose(keys) {
        (camera.pose, camera.up) = (given.pose, given.up);
    } else if has(&["margin"])
        && let (Pose::Fit { margin, .. }, Pose::Fit { margin: own, .. }) =
            (&mut camera.pose, given.pose)
    {
        *margin = own;
    }
    if has(&["up"]) {
        camera.up = given.up;
    }
    if has(&["aperture", "focus"]) {
        camera.lens = given.lens;
    }
    if has(&["near"]) {
        camera.near = given.near;
    }
    if has(&["insets"]) {
        camera.insets = given.insets;
    }
}

impl Staging {
    /// Cuts by the scene's slices and those of the options; returns the normals of those that cut anything. `rows` are
    /// those of the spheres that are left.
    fn cut(
        &self,
        scene: &mut spherule::Scene,
        cell: Option<[DVec3; 2]>,
        rows: &mut Option<Vec<u32>>,
    ) -> Result<Vec<DVec3>, Fault> {
        if !self.planes.is_empty() {
            let whole = cell.or_else(|| scene.bounds()).unwrap_or_default();
            let slices = self.planes.iter().map(|plane| plane.slice(whole, self.slice_mode));
            scene.slices.extend(slices);
        }
        if scene.slices.is_empty() {
            return Ok(Vec::new());
        }
        let normals = scene.cut_normals();
        let shown: Vec<u32> = scene.shown().map(|row| row as u32).collect();
        let dropped = scene.drop_cut();
        if dropped > 0 {
            let before = rows.take();
            let of = |row: u32| before.as_ref().map_or(row, |before| before[row as usize]);
            *rows = Some(shown.into_iter().map(of).collect());
        }
        if dropped > 0 && scene.framed().next().is_none() {
            let message = format!("the slices cut away all of its {dropped} spheres");
            let error = FileError::whole_file(Path::new(ARRAYS), message);
            return Err(error
                .with_help(
                    "a slice describes the side that is cut away; for the other side write z<10 \
                     instead of z>10",
                )
                .into());
        }
        Ok(normals)
    }

    fn orientation(&self, particles: &Particles) -> Orientation {
        let found = Orientation::of(particles);
        match self.up {
            Some(up) => Orientation { up, reason: UpReason::Chosen, ..found },
            None => found,
        }
    }

    fn annotate(&self, scene: &mut spherule::Scene, legend: Option<Legend>) -> Result<(), Fault> {
        let Some(position) = self.color_bar else { return Ok(()) };
        let Some(Legend { scale, label }) = legend else {
            return Err(Fault::Text(
                "`color_bar` needs colors that stand for numbers; give `values`, or `color_by` \
                 with the name of a column of numbers"
                    .to_owned(),
            ));
        };
        scene.annotations.color_bar = Some(ColorBar { scale, label, position });
        Ok(())
    }
}

/// Leaves room for annotations, and has the camera frame the cell that is drawn, as the program does once the picture's
/// size is known.
pub(crate) fn place(scene: &mut spherule::Scene) -> Result<(), WorldError> {
    if scene.camera.insets == Insets::default() {
        scene.camera.insets = annotations::insets(scene, false);
    }
    let corners = scene.look.cell.map_or_else(Vec::new, |cell| cell.corners().to_vec());
    if corners.is_empty() {
        return Ok(());
    }
    framing::include_points(scene, &corners)
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
