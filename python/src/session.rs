//! Renders: from a scene to pictures, in one step or refined step by step.

use crate::encode::{Drawn, Matte};
use crate::errors::error;
use crate::pools::pool;
use crate::scene::{Fault, Scene, SharedScene};
use crate::watch::{Shared, Stop, Watcher};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use rayon::ThreadPool;
use spherule::World;
use spherule::compose::{self, Descriptions};
use spherule::denoise::{Asked, Choice, Denoiser, Judged, choose};
use spherule::graphics::Figure;
use spherule::image::Format;
use spherule::layers::{Layer, Layers, layers};
use spherule::overlay::{Canvas, annotations};
use spherule::particles::internals::memory;
use spherule::render::{
    End, Film, Judge, Noise, Options, Region, Render, RenderError, ResumableRender, Statistics,
};
use spherule::scene::{Annotations, Identity, Look, Settings, Tone};
use spherule::split::Part;
use std::mem::take;
use std::num::NonZeroU16;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Settings for a render, as the section `[render]` of a scene file.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct RenderTable {
    /// TOML of the section.
    text: String,
    keys: Vec<String>,
    /// Names of layers.
    layers: Vec<String>,
    threads: Option<usize>,
}

/// Settings and layers of a requested render.
#[derive(Clone)]
pub(crate) struct Request {
    settings: Settings,
    keys: Vec<String>,
    layers: Vec<Layer>,
}

impl RenderTable {
    /// Understands the table, and returns its pool of threads.
    pub(crate) fn request(&self, py: Python<'_>) -> PyResult<(Request, Arc<ThreadPool>)> {
        let given = spherule::Scene::parse(&self.text, crate::errors::KEYWORDS, Path::new(""));
        let given = given.map_err(|error| crate::errors::of_file(py, &error))?;
        let layer = |name: &String| {
            Layer::ALL.into_iter().find(|layer| layer.name() == name).ok_or_else(|| {
                let names = Layer::ALL.map(Layer::name).join(", ");
                error(py, &format!("unknown layer \"{name}\"; layers are {names}"))
            })
        };
        let layers = self.layers.iter().map(layer).collect::<PyResult<_>>()?;
        let request = Request { settings: given.settings, keys: self.keys.clone(), layers };
        Ok((request, pool(py, self.threads)?))
    }
}

impl From<RenderError> for Fault {
    fn from(error: RenderError) -> Self {
        Self::Text(error.to_string())
    }
}

/// Bytes per pixel of the finished picture: with alpha, and of the look.
const FINISHED: u64 = 48;

/// Refuses a picture that does not fit into memory.
fn check_memory(region: Region, layers: &[Layer], denoised: bool) -> Result<(), Fault> {
    let Region { width, height, .. } = region;
    let finished = u64::from(width) * u64::from(height) * FINISHED;
    let statistics = denoised || layers.iter().any(|layer| layer.is_statistic());
    let traced = layers.iter().any(|layer| !layer.is_statistic());
    let layers = if traced { Layers::bytes(region) } else { 0 };
    let denoising = if denoised { Denoiser::bytes(region) } else { 0 };
    let need = Film::bytes(region, statistics) + layers + denoising + finished;
    memory::check(need).map_err(|shortage| {
        let size = format!("`size` is ({width}, {height}), but such a picture");
        Fault::Text(format!("{size} needs {shortage}; make it smaller, or render it in parts"))
    })
}

/// A render that goes on until its end or a signal, and all that its pictures need.
pub(crate) struct Session {
    world: World,
    title: String,
    look: Look,
    annotations: Annotations,
    settings: Settings,
    region: Region,
    denoiser: Option<Denoiser>,
    layers: Vec<Layer>,
    /// Row in the user's arrays of each sphere, unless they are the same.
    rows: Option<Arc<[u32]>>,
    pub(crate) render: ResumableRender,
    /// Memory of the picture. The system takes a while to give that of a large one, so it is asked for while the render
    /// runs: who interrupts does not wait for it.
    memory: Option<JoinHandle<Vec<[f32; 3]>>>,
    /// Identity of the scene, for parts.
    pub(crate) identity: Option<Identity>,
}

/// A picture and its facts.
pub(crate) struct Shown {
    render: Render,
    title: String,
    settings: Settings,
    matte: Option<spherule::overlay::Matte>,
    /// The annotations, if there are any.
    drawn: Option<Drawn>,
    /// The error of the picture, before and after denoising.
    judged: Option<(Noise, Noise)>,
    denoised: bool,
    /// False if finishing it was cancelled: it is not denoised, and has no layers of camera rays.
    finished: bool,
    named: Vec<Layer>,
    layers: Layers,
    warnings: Vec<String>,
}

impl Session {
    /// Builds the world of a scene with the threads of a pool; of one that is `taken` its spheres move there. It is not
    /// called from the pool: see [`Watcher::run_outside`].
    pub(crate) fn begin(
        pool: &ThreadPool,
        shared: &SharedScene,
        request: Request,
        taken: bool,
        part: Option<Part>,
    ) -> Result<Self, Fault> {
        let mut scene = shared.scene.lock().unwrap_or_else(PoisonError::into_inner);
        let kept = (scene.settings.clone(), scene.camera.clone());
        let locked = &mut *scene;
        let begun = pool.install(|| Self::begin_with(locked, shared, request, taken, part));
        (scene.settings, scene.camera) = kept;
        begun
    }

    fn begin_with(
        scene: &mut spherule::Scene,
        shared: &SharedScene,
        request: Request,
        taken: bool,
        part: Option<Part>,
    ) -> Result<Self, Fault> {
        let Request { settings, keys, layers } = request;
        compose::change(&mut scene.settings, &settings, &keys);
        compose::frame(scene, false, None)?;
        let Settings { width, height, .. } = scene.settings;
        let region = Region { x: 0, y: 0, width, height };
        let spp = keys.iter().any(|key| key == "spp");
        let asked = Asked { part: part.is_some(), spp, first_frame: shared.first_frame };
        let choice = choose(scene, region, scene.spheres.len(), asked);
        let settings = scene.settings.clone();
        let identity = part.is_some().then(|| Identity::of(scene));
        let samples = u64::from(width) * u64::from(height) * u64::from(settings.spp);
        let statistics = choice.is_some() || layers.iter().any(|layer| layer.is_statistic());
        check_memory(region, &layers, choice.is_some())?;
        let builder = World::builder(scene.spheres.len(), samples);
        let world = if taken {
            World::build_taking(scene, builder)?
        } else {
            World::build_with(scene, builder)?
        };
        let options = Options { region: Some(region), statistics, ..Options::default() };
        let denoiser = |choice: Choice| Denoiser::new(&world, &settings, &options, choice);
        let denoiser = choice.map(denoiser).transpose()?;
        let whole = spherule::render::ImagePart::whole(region, settings.spp);
        let image_part = match part {
            Some(part) => {
                part.of_image(&whole, None).map_err(|why| Fault::Text(why.to_string()))?
            }
            None => whole,
        };
        let render = ResumableRender::begin_part(&world, &settings, &options, image_part)?;
        let (title, look) = (scene.title.clone(), scene.look);
        let annotations = scene.annotations.clone();
        // Other numbers than 0, which would be pages that nobody has touched.
        let pixels = width as usize * height as usize;
        let memory = part.is_none().then(|| thread::spawn(move || vec![[f32::NAN; 3]; pixels]));
        Ok(Self {
            world,
            title,
            look,
            annotations,
            settings,
            region,
            denoiser,
            layers,
            rows: shared.rows.clone(),
            render,
            memory,
            identity,
        })
    }

    /// Renders until the end, or for some time; returns whether it is the end.
    pub(crate) fn run(&mut self, shared: &Shared, slice: Option<Duration>) -> bool {
        shared.keeps.store(true, Ordering::SeqCst);
        let pause = AtomicBool::new(false);
        let until = slice.map(|slice| Instant::now() + slice);
        let show = |progress| {
            shared.show(progress);
            let due = until.is_some_and(|until| until <= Instant::now());
            if due || shared.cancel.load(Ordering::SeqCst) {
                pause.store(true, Ordering::SeqCst);
            }
        };
        let (world, denoiser) = (&self.world, self.denoiser.as_ref());
        // Without a pause, the watcher's flag ends the render by itself: at once, not after the next report.
        let cancel = if slice.is_some() { &pause } else { &shared.cancel };
        let options = Options {
            cancel: Some(cancel),
            progress: Some(&show),
            features: denoiser.is_some(),
            ..Options::default()
        };
        let judged = |film: &Film| denoiser?.noise(world, film, &options);
        let judge = denoiser.is_some().then_some(&judged as &Judge);
        let end = self.render.run(world, &Options { judge, ..options });
        end != End::Cancelled
    }

    /// Finishes the picture so far: denoised, with layers, look and annotations. Once the flag is set, it is neither
    /// denoised nor are there layers of camera rays, since these take longer than who interrupts wants to wait.
    pub(crate) fn show(&mut self, cancel: &AtomicBool) -> Result<Shown, Fault> {
        let stopped = || cancel.load(Ordering::SeqCst);
        let has_statistics = self.layers.iter().any(|layer| layer.is_statistic());
        let statistics =
            has_statistics.then(|| Statistics::of(self.render.film(), &Options::default()));
        let memory = self.memory.take().and_then(|memory| memory.join().ok()).unwrap_or_default();
        let mut render = Render { statistics, ..self.render.unmeasured(memory) };
        let judged = self.denoiser.as_ref().filter(|_| !stopped()).and_then(|denoiser| {
            let options = self.finishing(cancel);
            denoiser.judge(&self.world, self.render.film(), &options)
        });
        let errors = judged.as_ref().map(|judged| (judged.before, judged.noise));
        if errors.is_none() && !stopped() {
            render.noise = self.render.noise();
        }
        let mut is_denoised = false;
        if let Some(Judged { denoised: Some(denoised), .. }) = judged {
            is_denoised = true;
            render.image = denoised.image;
        }
        let (named, layers) = self.layers(&mut render, cancel)?;
        let mut warnings = Vec::new();
        let mut canvas = Canvas::with_look(
            &self.look,
            &mut self.world,
            &self.settings,
            self.region,
            &mut render,
            cancel,
        )?;
        let mut drawn = None;
        if !self.annotations.is_empty() {
            let resolution = self.settings.dpi;
            let made =
                annotations::draw(&self.annotations, &self.world, &self.look, resolution, false);
            drawn = Some(Drawn::over(&mut canvas, made.drawing));
            if !made.fits {
                warnings.push(
                    "annotations overlap: make the picture larger, or use fewer or a smaller \
                     `lettering`"
                        .to_owned(),
                );
            }
        }
        let matte = canvas.matte;
        let finished = !stopped();
        let (title, settings) = (self.title.clone(), self.settings.clone());
        Ok(Shown {
            render,
            title,
            settings,
            matte,
            drawn,
            judged: errors,
            denoised: is_denoised,
            finished,
            named,
            layers,
            warnings,
        })
    }

    fn finishing<'a>(&self, cancel: &'a AtomicBool) -> Options<'a> {
        Options { region: Some(self.region), cancel: Some(cancel), ..Options::default() }
    }

    /// Traces the layers that were asked for, and takes the statistics of a render; returns the layers that there are.
    fn layers(
        &self,
        render: &mut Render,
        cancel: &AtomicBool,
    ) -> Result<(Vec<Layer>, Layers), Fault> {
        let Region { width, height, .. } = self.region;
        let mut made = Layers { width, height, pixels: Vec::new(), statistics: None };
        let mut named = self.layers.clone();
        if self.layers.iter().any(|layer| !layer.is_statistic()) {
            // No more samples than the image has, so that an interrupted render ends soon.
            let spp = render.samples.most.max(1);
            let settings = Settings { spp, ..self.settings.clone() };
            made = layers(&self.world, &settings, &self.finishing(cancel), &self.layers)?;
            if cancel.load(Ordering::SeqCst) {
                named.retain(|layer| layer.is_statistic());
            }
        }
        if let Some(rows) = &self.rows {
            for pixel in &mut made.pixels {
                pixel.id = rows.get(pixel.id as usize).copied().unwrap_or(pixel.id);
            }
        }
        made.statistics = render.statistics.take();
        Ok((named, made))
    }
}

impl Shown {
    /// The picture as a table for the class `Picture`.
    fn table(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let Self { render, title, settings, matte, drawn, judged, denoised, warnings, .. } = self;
        let (named, mut layers) = (self.named, self.layers);
        let Settings { width, height, .. } = settings;
        let size = (height as usize, width as usize);
        let table = PyDict::new(py);
        table.set_item("sampled", render.sampled_share())?;
        let pixels = match &matte {
            None => PyArray1::from_vec(py, render.image.pixels.into_flattened())
                .reshape([size.0, size.1, 3])?,
            Some(matte) => {
                let alpha = matte.linear();
                let rows = render.image.pixels.iter().zip(&alpha);
                let values = rows.flat_map(|(&[r, g, b], &a)| [r, g, b, a]).collect();
                PyArray1::from_vec(py, values).reshape([size.0, size.1, 4])?
            }
        };
        table.set_item("pixels", pixels)?;
        table.set_item("matte", matte.map(Matte::of))?;
        table.set_item("drawn", drawn)?;
        table.set_item("title", title)?;
        table.set_item("dpi", settings.dpi.map(NonZeroU16::get))?;
        table.set_item("exposure", settings.exposure)?;
        table.set_item("tone", if settings.tone == Tone::Filmic { "filmic" } else { "linear" })?;
        table.set_item("spp", (render.samples.least, render.samples.most))?;
        table.set_item("samples", render.samples.total)?;
        let noise = judged.map(|(_, noise)| noise).or(render.noise);
        table.set_item("error", noise.map(|noise| noise.error))?;
        table.set_item("error_bound", noise.map(|noise| noise.bound))?;
        table.set_item("denoised", denoised)?;
        table.set_item("complete", render.complete && self.finished)?;
        table.set_item("seconds", render.elapsed.as_secs_f64())?;
        table.set_item("rays", render.counters.rays())?;
        table.set_item("warnings", warnings)?;
        let arrays = PyDict::new(py);
        for layer in named {
            if !arrays.contains(layer.name())? {
                arrays.set_item(layer.name(), take_layer(py, layer, &mut layers, size)?)?;
            }
        }
        table.set_item("layers", arrays)?;
        Ok(table)
    }
}

/// Takes a layer as an array of a value or three per pixel; statistics, which are columns already, are not copied.
fn take_layer<'py>(
    py: Python<'py>,
    layer: Layer,
    layers: &mut Layers,
    (height, width): (usize, usize),
) -> PyResult<Bound<'py, PyAny>> {
    let Layers { pixels, statistics, .. } = layers;
    let triples = |values: Vec<[f32; 3]>| {
        let array = PyArray1::from_vec(py, values.into_flattened());
        Ok(array.reshape([height, width, 3])?.into_any())
    };
    let floats =
        |values: Vec<f32>| Ok(PyArray1::from_vec(py, values).reshape([height, width])?.into_any());
    let whole =
        |values: Vec<u32>| Ok(PyArray1::from_vec(py, values).reshape([height, width])?.into_any());
    let missing = || PyRuntimeError::new_err("the render has no statistics");
    match layer {
        Layer::Albedo => triples(pixels.iter().map(|pixel| pixel.albedo).collect()),
        Layer::Normal => triples(pixels.iter().map(|pixel| pixel.normal).collect()),
        Layer::Depth => floats(pixels.iter().map(|pixel| pixel.depth).collect()),
        Layer::Coverage => floats(pixels.iter().map(|pixel| pixel.coverage).collect()),
        Layer::Id => whole(pixels.iter().map(|pixel| pixel.id).collect()),
        Layer::Variance => {
            triples(take(&mut statistics.as_mut().ok_or_else(missing)?.variance.pixels))
        }
        _ => whole(take(&mut statistics.as_mut().ok_or_else(missing)?.samples)),
    }
}

/// The picture of an interrupted or finished session; the interrupt itself if there is nothing to show.
pub(crate) fn show(
    py: Python<'_>,
    shown: Result<Option<Shown>, Fault>,
    interrupt: Option<PyErr>,
) -> PyResult<Bound<'_, PyDict>> {
    let shown = shown.map_err(|fault| fault.raise(py))?;
    match (shown, interrupt) {
        (Some(shown), None) => shown.table(py),
        (Some(shown), Some(interrupt)) => {
            // An exception of the progress report is not a wish to see the picture so far.
            if !interrupt.is_instance_of::<pyo3::exceptions::PyKeyboardInterrupt>(py) {
                return Err(interrupt);
            }
            let table = shown.table(py)?;
            table.set_item("complete", false)?;
            Ok(table)
        }
        (None, Some(interrupt)) => Err(interrupt),
        (None, None) => Err(error(py, &"stopped before the first sample: there is no picture")),
    }
}

/// Renders a scene; of one that is `taken` the spheres are gone afterwards. Frames of a movie that are scenes have the number of
/// samples of the first one, which has `first_frame` particles.
#[pyfunction]
#[pyo3(signature = (scene, table, taken, stop, report, first_frame=None))]
pub(crate) fn render<'py>(
    py: Python<'py>,
    scene: &Scene,
    table: RenderTable,
    taken: bool,
    stop: Option<&Stop>,
    report: Option<Bound<'py, PyAny>>,
    first_frame: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let (request, pool) = table.request(py)?;
    let mut scene = scene.share();
    scene.first_frame = scene.first_frame.or(first_frame);
    let work = move |shared: &Shared| {
        let mut session = Session::begin(&pool, &scene, request, taken, None)?;
        pool.install(|| {
            session.run(shared, None);
            if session.render.samples().total == 0 {
                return Ok(None);
            }
            let shown = session.show(&shared.cancel);
            // Large pictures take a while to give their memory back; nobody waits for that.
            rayon::spawn(move || drop(session));
            shown.map(Some)
        })
    };
    let (shown, interrupt) = Watcher::new(stop, report).run_outside(py, work)?;
    show(py, shown, interrupt)
}

/// Returns the page of HTML of a PNG file that the settings render, with the names of its particles.
pub(crate) fn page(
    pool: &ThreadPool,
    shared: &SharedScene,
    request: &Request,
    file: Vec<u8>,
) -> Result<String, Fault> {
    let mut scene = shared.scene.lock().unwrap_or_else(PoisonError::into_inner);
    let kept = (scene.settings.clone(), scene.camera.clone());
    let locked = &mut *scene;
    let made = pool.install(|| {
        compose::change(&mut locked.settings, &request.settings, &request.keys);
        compose::frame(locked, false, None)?;
        let Settings { width, height, .. } = locked.settings;
        let samples = u64::from(width) * u64::from(height);
        let world = World::build_with(locked, World::builder(locked.spheres.len(), samples))?;
        let descriptions = Descriptions::new(&shared.labels, compose::extent(locked));
        let mut figure = Figure::new(&locked.title, false);
        let options = Options::default();
        let numbers = descriptions.numbers(&world, &locked.settings, &options, &mut figure)?;
        figure.add(Format::Png, file, (width, height), &numbers);
        Ok(figure.file())
    });
    (scene.settings, scene.camera) = kept;
    made
}

/// A render that is refined step by step.
#[pyclass(frozen, module = "spherule._spherule")]
pub(crate) struct Refinement {
    session: Arc<Mutex<Option<Session>>>,
    pool: Arc<ThreadPool>,
}

/// Begins a render that is refined step by step.
#[pyfunction]
pub(crate) fn refine(py: Python<'_>, scene: &Scene, table: RenderTable) -> PyResult<Refinement> {
    let (request, pool) = table.request(py)?;
    let scene = scene.share();
    let own = Arc::clone(&pool);
    let work = move |_: &Shared| Session::begin(&own, &scene, request, false, None);
    let (session, _) = Watcher::default().run_outside(py, work)?;
    let session = session.map_err(|fault| fault.raise(py))?;
    Ok(Refinement { session: Arc::new(Mutex::new(Some(session))), pool })
}

#[pymethods]
impl Refinement {
    /// Renders for some seconds and returns the picture so far; `None` after the end.
    fn step<'py>(
        &self,
        py: Python<'py>,
        seconds: f64,
        stop: Option<&Stop>,
    ) -> PyResult<Option<Bound<'py, PyDict>>> {
        let slice = Duration::try_from_secs_f64(seconds)
            .map_err(|_| error(py, &format!("`seconds` is {seconds}, but must be 0 or more")))?;
        let state = Arc::clone(&self.session);
        let pool = Arc::clone(&self.pool);
        let work = move |shared: &Shared| {
            let mut state = state.lock().unwrap_or_else(PoisonError::into_inner);
            let Some(session) = state.as_mut() else { return Ok(None) };
            let (shown, ended) = pool.install(|| {
                let done = session.run(shared, Some(slice));
                let cancelled = shared.cancel.load(Ordering::SeqCst);
                (session.show(&shared.cancel), done || cancelled)
            });
            let shown = shown?;
            if ended {
                *state = None;
            }
            Ok(Some(shown))
        };
        let (shown, interrupt) = Watcher::new(stop, None).run_outside(py, work)?;
        if let Ok(None) = shown {
            return interrupt.map_or(Ok(None), Err);
        }
        show(py, shown, interrupt).map(Some)
    }
}
