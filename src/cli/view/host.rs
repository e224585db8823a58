//! The session that pages look at: one thread holds the viewer, handles what pages and workers send, and tells pages what
//! to show. It knows nothing of connections.

use super::client::{Client, Reply, Shot};
use super::content::{Content, LookChanges};
use super::events::{Action, Purpose};
use super::file_render::{FileRender, Wanted};
use super::frame_rate::FrameRate;
use super::image::{Picture, RenderRequest};
use super::listen::Call;
use super::load::{LoadedScene, Origin};
use super::loading::Loading;
use super::options::Options;
use super::plot::Course;
use super::save::{Saved, encode_picture, raw_picture, save_scene};
use super::scratch::Scratch;
use super::script::{self, Step};
use super::sent_file::{LARGEST, SentFiles};
use super::session;
use super::state::{drawn, remade, state};
use super::viewer::Viewer;
use super::worker::{Message, Workers};
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::render::RenderSetup;
use crate::cli::signals;
use serde_json::{Value, json};
use spherule_render::image::Format;
use spherule_render::scene::{Camera, Header, Scene, Settings};
use std::collections::{HashSet, VecDeque};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::sync::{Arc, RwLock};
use std::thread;
use std::time::{Duration, Instant};

/// Maximum number of inputs that are handled before pages are told.
const BATCH: usize = 64;

/// Maximum number of commands that wait for the first scene.
const EARLY: usize = 1000;

/// Time after which the first image of a version is rendered although the last one is not shown yet; and although the page
/// shows none, since others may.
const INTERVAL: Duration = Duration::from_millis(33);
const LONGEST: Duration = Duration::from_millis(500);

/// Time between two states that pages are told while the camera moves.
const PAUSE: Duration = Duration::from_millis(100);

/// Time between two looks for a signal, while there are temporary files.
const WATCH: Duration = Duration::from_millis(200);

/// Size of the image before a page says its own.
const SIZE: (u32, u32) = (1280, 720);

/// Inputs of the session.
pub(super) enum Input {
    Call(Call),
    Message(Message),
    /// No page will come any more.
    End,
}

impl From<Call> for Input {
    fn from(call: Call) -> Self {
        Self::Call(call)
    }
}

/// The commands that a version of the view follows.
struct Followed {
    version: u64,
    /// Number of commands of the steering page before it.
    heard: u64,
    /// Time of the last of them.
    at: Instant,
}

/// The session.
pub(super) struct Host {
    viewer: Viewer,
    workers: Workers,
    /// The scene to save; `None` until one is loaded.
    scene: Option<Arc<RwLock<Scene>>>,
    /// Source of its spheres, if it has only a sketch of them.
    origin: Option<Origin>,
    /// The last loaded content.
    loaded: Content,
    /// Content to return to if loading fails, if its world was dropped to free memory.
    fallback: Option<Content>,
    clients: Vec<(u64, Arc<Client>)>,
    /// The page whose commands are heeded.
    steering: Option<u64>,
    /// Commands that wait for the first scene.
    early: Vec<(u64, String)>,
    /// Downloads that wait for an image.
    wanted: Vec<(u64, String)>,
    /// Files that are rendered for pages.
    files: Vec<(u64, FileRender)>,
    /// Ends the measurement of all frames, if there is one.
    plotting: Arc<AtomicBool>,
    /// Temporary files.
    scratch: Scratch,
    /// Files that pages send, if they may.
    sent: Option<SentFiles>,
    /// Number of selections whose spheres are sought, and marks of pages that wait for them.
    selecting: usize,
    marks: Vec<(u64, String)>,
    greeting: String,
    /// Warnings that were printed.
    warned: HashSet<String>,
    /// The state that pages know.
    told: String,
    told_at: Instant,
    /// True if the last command moved the pointer or the camera.
    moves: bool,
    /// Number of commands of the steering page, and what versions of the view follow, in their order.
    heard: u64,
    versions: VecDeque<Followed>,
    /// Number of the last image, and the image.
    shots: u64,
    last: Option<Arc<Shot>>,
    /// Time of the last image while the camera moves.
    moved: Option<Instant>,
    /// Number of requested images that are not done, and the time of the last request for the first image of a version.
    rendering: usize,
    requested: Instant,
    /// Time after which something is due without an input.
    pause: Option<Duration>,
}

impl Host {
    /// Starts the threads that load and render.
    ///
    /// # Errors
    /// The threads cannot be started.
    pub(super) fn start(
        setup: &RenderSetup,
        options: Options,
        greeting: String,
        inputs: &SyncSender<Input>,
    ) -> Result<Self, Failure> {
        let sender = inputs.clone();
        let notify = move |message| sender.send(Input::Message(message)).is_ok();
        let workers = Workers::start(setup, notify)?;
        let settings = Settings { width: SIZE.0, height: SIZE.1, ..Settings::default() };
        let mut viewer = Viewer::new(&Camera::default(), &settings, FrameRate::measured());
        let sent = options.file.is_none().then(SentFiles::default);
        viewer.content.options = options;
        viewer.loading = Some(Loading::of(&setup.source.name()));
        workers.load(&viewer.content);
        Ok(Self {
            viewer,
            workers,
            scene: None,
            origin: None,
            loaded: Content::default(),
            fallback: None,
            clients: Vec::new(),
            steering: None,
            early: Vec::new(),
            wanted: Vec::new(),
            files: Vec::new(),
            plotting: Arc::default(),
            scratch: Scratch::default(),
            sent,
            selecting: 0,
            marks: Vec::new(),
            greeting,
            warned: HashSet::new(),
            told: String::new(),
            told_at: Instant::now(),
            moves: false,
            heard: 0,
            versions: VecDeque::new(),
            shots: 0,
            last: None,
            moved: None,
            rendering: 0,
            requested: Instant::now(),
            pause: None,
        })
    }

    /// Handles inputs until their end.
    ///
    /// # Errors
    /// The first scene cannot be loaded.
    pub(super) fn run(mut self, inputs: &Receiver<Input>) -> Result<(), Failure> {
        loop {
            let first = match self.pause {
                Some(pause) => inputs.recv_timeout(pause),
                None => inputs.recv().map_err(RecvTimeoutError::from),
            };
            let first = match first {
                Ok(first) => Some(first),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return Ok(()),
            };
            for input in first.into_iter().chain(inputs.try_iter().take(BATCH)) {
                match input {
                    Input::Call(call) => self.hear(call),
                    Input::Message(Message::Loaded(Err(failure))) if self.scene.is_none() => {
                        return Err(failure);
                    }
                    Input::Message(message) => self.receive(message),
                    Input::End => return Ok(()),
                }
            }
            self.update();
            if self.scratch.is_used() {
                self.wake_after(WATCH);
                if signals::received().is_some() {
                    self.files.iter().for_each(|(_, file)| file.cancel());
                    return Ok(());
                }
            }
        }
    }

    /// Handles what a page does.
    fn hear(&mut self, call: Call) {
        match call {
            Call::Joined(number, client) => {
                client.reply(Reply::Text(self.greeting.clone()));
                if !self.told.is_empty() {
                    client.state(self.told.clone());
                }
                self.last.iter().for_each(|shot| client.show(Arc::clone(shot)));
                self.clients.push((number, client));
                self.steering.get_or_insert(number);
            }
            Call::Left(number) => {
                self.clients.retain(|(own, _)| *own != number);
                self.cancel_files(number);
                if self.steering == Some(number) {
                    self.heard = 0;
                    self.steering = self.clients.first().map(|(number, _)| *number);
                }
            }
            Call::Shown => (),
            Call::Bytes(number, bytes) => {
                if let Err(message) = self.take_bytes(number, &bytes) {
                    self.tell(number, &json!({ "error": message }).to_string());
                }
            }
            Call::Line(number, line) => {
                if let Err(message) = self.obey(number, &line) {
                    self.tell(number, &json!({ "error": message }).to_string());
                }
            }
        }
    }

    /// Executes a command of a page.
    fn obey(&mut self, number: u64, line: &str) -> Result<(), String> {
        if line == "steer" {
            (self.steering, self.heard) = (Some(number), 0);
            return Ok(());
        }
        if let Some(mark) = line.strip_prefix("mark ") {
            self.marks.push((number, mark.to_owned()));
            self.tell_marks();
            return Ok(());
        }
        if let Some(words) = line.strip_prefix("download ") {
            return match words.split_whitespace().collect::<Vec<_>>()[..] {
                ["cancel"] => {
                    self.cancel_files(number);
                    Ok(())
                }
                [suffix, ref choices @ ..] if !choices.is_empty() => {
                    self.render_file(number, suffix, choices)
                }
                _ => self.download(number, words.trim()),
            };
        }
        match &script::words(line)?.iter().map(String::as_str).collect::<Vec<_>>()[..] {
            ["open", name, size] if self.steering == Some(number) => {
                let size =
                    size.parse().map_err(|_| format!("`{size}` is not a number of bytes"))?;
                return self.receive_file(number, name, size);
            }
            ["plot"] => return self.plot(number, false),
            ["plot", "periodic"] => return self.plot(number, true),
            _ => (),
        }
        let step = script::command(line)?;
        if step.is_of_scripts() {
            let name = line.split_whitespace().next().unwrap_or_default();
            let instead = "a page has `download png`, and ends by being closed";
            return Err(format!("`{name}` is a command of scripts alone; {instead}"));
        }
        let looks = matches!(step, Step::Hover(_));
        if !looks && self.steering != Some(number) {
            return Err("another page steers".to_owned());
        }
        if self.scene.is_none() && !matches!(step, Step::Size(..) | Step::Scale(_)) {
            if self.early.len() < EARLY {
                self.early.push((number, line.to_owned()));
            }
            return Ok(());
        }
        self.heard += u64::from(!looks);
        if !looks {
            self.moves = matches!(step, Step::Move(_) | Step::Wheel { .. } | Step::Turn(_));
        }
        let resized = matches!(step, Step::Size(..));
        for step in step.parts() {
            let action = self.viewer.step(&step).map_err(|failure| failure.brief())?;
            if let Some(action) = action {
                self.act(number, &action)?;
            }
        }
        if resized {
            self.fit();
        }
        Ok(())
    }

    /// Tells pages that their commands before a mark are done, and what they did.
    fn tell_marks(&mut self) {
        if self.selecting == 0 {
            for (number, mark) in std::mem::take(&mut self.marks) {
                if let Some((_, client)) = self.clients.iter().find(|(own, _)| *own == number) {
                    client.mark(json!({ "state": self.facts(), "mark": mark }).to_string());
                }
            }
        }
    }

    /// Frames everything in an image of another shape, unless the camera was moved.
    fn fit(&mut self) {
        let viewer = &mut self.viewer;
        if let Some(scene) = &self.scene
            && viewer.facts.framed
            && viewer.control.camera == viewer.home
        {
            session::frame(viewer, scene, None);
            viewer.home = viewer.control.camera.clone();
            viewer.history.amend(viewer.state());
        }
    }

    fn act(&mut self, number: u64, action: &Action) -> Result<(), String> {
        match action {
            // Pages come and go; the program ends by a signal.
            Action::Quit => (),
            Action::Load => self.load(),
            Action::Save => return self.download(number, "png"),
            Action::Frame(side) => {
                if let Some(scene) = &self.scene {
                    session::frame(&mut self.viewer, scene, *side);
                }
            }
            Action::Pick(pixel, purpose) => {
                let at = (self.viewer.control.camera.clone(), self.viewer.settings.clone());
                self.workers.pick(at, *pixel, *purpose);
            }
            Action::Select(selections) => {
                self.selecting += 1;
                self.workers.select(selections.clone(), number);
            }
        }
        Ok(())
    }

    /// Requests the viewer's content. A large world is dropped first if it can be read again.
    fn load(&mut self) {
        if self.origin.as_ref().is_some_and(Origin::is_readable) {
            self.fallback = Some(self.loaded.clone());
        }
        if self.fallback.is_some() {
            self.workers.replace(&self.viewer.content);
        } else {
            self.workers.load(&self.viewer.content);
        }
    }

    /// Handles what a worker has done.
    fn receive(&mut self, message: Message) {
        match message {
            Message::Loading(loading) => self.viewer.loading = Some(loading),
            Message::Counted(frames) => self.viewer.facts.frames = Some(frames),
            Message::Loaded(Ok(stage)) => self.set(*stage),
            Message::Loaded(Err(failure)) => {
                // The visible content is the last loaded one.
                self.viewer.content = self.loaded.clone();
                self.viewer.history.amend(self.viewer.state());
                self.viewer.loading = None;
                self.show_error(&failure);
                if let Some(content) = self.fallback.take() {
                    self.workers.load(&content);
                }
            }
            Message::Picture(picture) => {
                self.rendering = self.rendering.saturating_sub(1);
                match picture {
                    Ok(Some(picture)) => self.show(*picture),
                    Ok(None) => (),
                    Err(failure) => self.show_error(&failure),
                }
            }
            Message::Picked(Ok(picked), Purpose::Hover) => {
                let text = json!({ "hover": picked.map(|picked| picked.text) }).to_string();
                self.tell_all(&text);
            }
            Message::Picked(Ok(picked), purpose) => {
                if let Some(line) = session::picked_by(&mut self.viewer, picked, purpose) {
                    output::print(line);
                }
            }
            Message::Picked(Err(failure), _) => self.show_error(&failure),
            Message::Selected(selected, page) => {
                self.selecting = self.selecting.saturating_sub(1);
                match selected {
                    Ok(picked) => session::select(&mut self.viewer, picked),
                    Err(failure) => {
                        self.tell(page, &json!({ "error": failure.brief() }).to_string());
                    }
                }
            }
        }
    }

    /// Shows loaded content. What was warned of before is not printed again.
    fn set(&mut self, stage: LoadedScene) {
        let new = stage.warnings.iter().filter(|text| self.warned.insert((*text).clone()));
        new.for_each(output::warn);
        let before = self.scene.replace(Arc::clone(&stage.scene));
        if before.is_none() {
            let Settings { width, height, .. } = self.viewer.settings;
            session::begin(&mut self.viewer, &stage);
            let settings = &mut self.viewer.settings;
            (settings.width, settings.height) = (width, height);
            self.fit();
        } else {
            session::set(&mut self.viewer, &stage);
            if self.loaded.options.file != stage.content.options.file {
                self.fit();
            }
        }
        if let Some(warning) = stage.warnings.first() {
            self.viewer.show_message(warning.clone());
        }
        self.origin.clone_from(&stage.origin);
        self.loaded.clone_from(&stage.content);
        self.fallback = None;
        self.workers.set(Box::new(stage));
        for (number, line) in std::mem::take(&mut self.early) {
            self.hear(Call::Line(number, line));
        }
    }

    /// Shows an image to all pages.
    fn show(&mut self, picture: Picture) {
        let moving = self.viewer.is_dragging() && picture.samples == 0;
        let now = Instant::now();
        if let Some(before) = std::mem::replace(&mut self.moved, moving.then_some(now)) {
            self.viewer.frame_rate.record_interval(now - before);
        }
        self.viewer.accept(picture);
    }

    /// Sends pages the image of the viewer, if it is another one.
    fn send_image(&mut self) {
        let Some(picture) = &self.viewer.shown else { return };
        if self.last.as_ref().is_some_and(|shot| Arc::ptr_eq(&shot.picture, picture)) {
            return;
        }
        let finished = picture.samples >= self.viewer.settings.spp;
        let finished = finished.then(|| Saved::of(&self.viewer)).flatten();
        self.shots += 1;
        while self.versions.get(1).is_some_and(|next| next.version <= picture.version) {
            self.versions.pop_front();
        }
        let followed = self.versions.front();
        let (heard, asked) = followed.map_or((0, picture.started), |own| (own.heard, own.at));
        let drawn = drawn(&self.viewer);
        let shot = Shot::new(Arc::clone(picture), self.shots, heard, asked, finished, drawn);
        let shot = Arc::new(shot);
        self.clients.iter().for_each(|(_, client)| client.show(Arc::clone(&shot)));
        self.last = Some(shot);
    }

    fn show_error(&mut self, failure: &Failure) {
        let message = failure.brief();
        output::warn(&message);
        self.viewer.show_message(message);
    }

    /// Requests the next image, and tells pages what is new. Nothing is rendered that nobody sees.
    fn update(&mut self) {
        self.pause = None;
        match self.versions.back_mut() {
            Some(last) if last.version == self.viewer.version => last.heard = self.heard,
            _ => self.versions.push_back(Followed {
                version: self.viewer.version,
                heard: self.heard,
                at: Instant::now(),
            }),
        }
        let steering = self.clients.iter().find(|(number, _)| self.steering == Some(*number));
        self.viewer.most_pixels = steering.map_or(u64::MAX, |(_, client)| client.pixels());
        if self.scene.is_some() {
            // While another frame of the file is read, better images of this one would take its time.
            let plays = self.viewer.content.frame != self.loaded.frame;
            let is_wanted =
                |request: &RenderRequest| !self.clients.is_empty() && (request.first || !plays);
            let request = self.viewer.next_request().filter(is_wanted);
            match request {
                Some(request) if request.first && !self.is_due() => {
                    self.workers.request_image(None);
                }
                request => {
                    if request.as_ref().is_some_and(|request| request.first) {
                        self.requested = Instant::now();
                    }
                    self.rendering += usize::from(self.workers.request_image(request));
                }
            }
        }
        self.send_image();
        self.tell_marks();
        self.tell_state();
        if self.viewer.sampled().is_some() && !self.is_loading() {
            for (number, suffix) in std::mem::take(&mut self.wanted) {
                if let Err(message) = self.download(number, &suffix) {
                    self.tell(number, &json!({ "error": message }).to_string());
                }
            }
        }
    }

    /// Tells pages the state, if it is another one: while the camera moves, not with each motion, since it takes them as long
    /// as an image.
    fn tell_state(&mut self) {
        let left = PAUSE.saturating_sub(self.told_at.elapsed());
        if self.moves && !left.is_zero() {
            return self.wake_after(left);
        }
        let told = json!({ "state": self.facts() }).to_string();
        if told != self.told {
            self.clients.iter().for_each(|(_, client)| client.state(told.clone()));
            (self.told, self.told_at) = (told, Instant::now());
        }
    }

    /// Returns whether the first image of a version may be rendered: the camera is then where it is when the page can show it.
    /// Images that wait for each other are older, and take the browser's time; on a long way, several are sent.
    fn is_due(&mut self) -> bool {
        if self.rendering > 0 {
            return false;
        }
        let passed = self.requested.elapsed();
        let client = self.clients.iter().find(|(number, _)| self.steering == Some(*number));
        let ready = client.is_none_or(|(_, client)| client.is_ready(passed >= INTERVAL));
        if ready || passed >= LONGEST {
            return true;
        }
        let next = if passed < INTERVAL { INTERVAL } else { LONGEST };
        self.wake_after(next.saturating_sub(passed));
        false
    }

    /// Goes on after this time, without an input.
    fn wake_after(&mut self, time: Duration) {
        self.pause = Some(self.pause.map_or(time, |pause| pause.min(time)));
    }

    /// Returns the state that pages are told.
    fn facts(&self) -> Value {
        let mut facts = state(&self.viewer);
        facts["pages"] = json!(self.clients.len());
        facts["opens"] = json!(self.sent.is_some().then_some(LARGEST));
        facts["picture"] = json!(self.shots);
        facts["busy"] = json!(self.is_loading());
        facts["sampled"] = json!(self.viewer.sampled().map_or(0, |picture| picture.samples));
        facts
    }

    /// Returns whether the content is not shown yet.
    fn is_loading(&self) -> bool {
        self.viewer.content != self.loaded
    }

    fn tell(&self, number: u64, text: &str) {
        let client = self.clients.iter().find(|(own, _)| *own == number);
        if let Some((_, client)) = client {
            client.reply(Reply::Text(text.to_owned()));
        }
    }

    fn tell_all(&self, text: &str) {
        for (_, client) in &self.clients {
            client.reply(Reply::Text(text.to_owned()));
        }
    }

    /// Renders a file for a page, as it chooses, while looking goes on.
    fn render_file(&mut self, number: u64, suffix: &str, choices: &[&str]) -> Result<(), String> {
        let Some((_, client)) = self.clients.iter().find(|(own, _)| *own == number) else {
            return Ok(());
        };
        self.files.retain(|(_, file)| !file.has_ended());
        if self.files.iter().any(|(own, _)| *own == number) {
            return Err("a file is being rendered; wait for it, or cancel it".to_owned());
        }
        Format::of_suffix(Path::new(&format!("view.{suffix}")))
            .map_err(|error| error.to_string())?;
        let Some(scene) = self.scene.as_ref().filter(|_| !self.is_loading()) else {
            return Err("the scene is being loaded; try again".to_owned());
        };
        let viewer = &self.viewer;
        let remade = remade(viewer);
        let is_scene = remade.is_none();
        let options = remade.unwrap_or_default();
        if options.file.as_ref().is_some_and(|file| file == "-") {
            return Err("standard input can be read only once; write it to a file".to_owned());
        }
        let mut wanted = Wanted { options, suffix: suffix.to_owned() };
        let Settings { width, height, spp, .. } = viewer.settings;
        let mut all = vec![format!("size={width}x{height}")];
        if !choices
            .iter()
            .any(|choice| choice.starts_with("until-error=") || choice.starts_with("spp="))
        {
            all.push(format!("spp={spp}"));
        }
        let all: Vec<&str> =
            all.iter().map(String::as_str).chain(choices.iter().copied()).collect();
        wanted.choose(&all)?;
        let header = (viewer.facts.title.clone(), viewer.control.camera.clone());
        let (settings, look) = (viewer.settings.clone(), viewer.look());
        let (scene, origin) = (Arc::clone(scene), self.origin.clone());
        let client = Arc::clone(client);
        let file = FileRender::default();
        let place = self.scratch.place()?;
        file.start(wanted, client, place, move |folder, options| {
            if is_scene {
                let path = folder.join("view.toml");
                let (title, camera) = (&*header.0, &header.1);
                let header = Header { title, camera, settings: &settings, look: &look };
                save_scene(&header, &scene, origin.as_ref(), &path)?;
                options.file = Some(path.into());
            }
            Ok(())
        });
        self.files.push((number, file));
        Ok(())
    }

    /// Tells a page what the selected particles measure in each frame, as it becomes known.
    fn plot(&mut self, number: u64, periodic: bool) -> Result<(), String> {
        let Some((_, client)) = self.clients.iter().find(|(own, _)| *own == number) else {
            return Ok(());
        };
        let viewer = &self.viewer;
        let ids: Option<Vec<f64>> = viewer.picked.iter().map(|own| own.id).collect();
        let ids = ids.filter(|ids| (2..=4).contains(&ids.len()));
        let (Some(ids), Some(frames)) = (ids, viewer.facts.frames.filter(|frames| *frames > 1))
        else {
            return Err("select two to four particles of a file with several frames".to_owned());
        };
        let (content, unit) = (self.loaded.clone(), viewer.facts.unit.to_owned());
        let course = Course { content, ids, periodic, frames, unit };
        self.plotting.store(true, Ordering::Relaxed);
        self.plotting = course.measure(Arc::clone(client));
        Ok(())
    }

    /// Begins to receive a file from a page.
    fn receive_file(&mut self, number: u64, name: &str, size: u64) -> Result<(), String> {
        let Some(sent) = &mut self.sent else {
            return Err("start `spherule view` without a file to open others".to_owned());
        };
        sent.begin(number, name, size, &self.scratch.place()?)?;
        self.take_bytes(number, &[])
    }

    /// Adds bytes to the file that a page sends, and opens it once it is whole.
    fn take_bytes(&mut self, number: u64, bytes: &[u8]) -> Result<(), String> {
        let Some(sent) = &mut self.sent else { return Ok(()) };
        if let Some(path) = sent.take(number, bytes)? {
            let viewer = &mut self.viewer;
            viewer.content =
                Content { options: viewer.content.options.of_sent(path), ..Content::default() };
            (viewer.takes_camera, viewer.takes_settings) = (true, true);
            viewer.touched = LookChanges::default();
            viewer.history.record(viewer.state(), false);
            self.load();
        }
        Ok(())
    }

    /// Ends the renders of files for a page.
    fn cancel_files(&mut self, number: u64) {
        let own = self.files.iter().filter(|(own, _)| *own == number);
        own.for_each(|(_, file)| file.cancel());
    }

    /// Sends a page the image as a file, with the suffix `toml` its scene, or with `raw` its numbers; once there is one, if
    /// there is none yet.
    fn download(&mut self, number: u64, suffix: &str) -> Result<(), String> {
        let Some((_, client)) = self.clients.iter().find(|(own, _)| *own == number) else {
            return Ok(());
        };
        let saved = Saved::of(&self.viewer).filter(|_| !self.is_loading());
        let (Some(saved), Some(scene)) = (saved, &self.scene) else {
            self.wanted.push((number, suffix.to_owned()));
            return Ok(());
        };
        if suffix == "raw" {
            let (header, pixels) = raw_picture(&saved.seen())?;
            client.reply(Reply::File(header, pixels));
            return Ok(());
        }
        let (client, scene, origin) = (Arc::clone(client), Arc::clone(scene), self.origin.clone());
        let suffix = suffix.to_owned();
        let format = Format::of_suffix(Path::new(&format!("view.{suffix}")));
        if suffix != "toml"
            && let Err(error) = &format
        {
            return Err(error.to_string());
        }
        // Large scenes take seconds.
        thread::spawn(move || {
            let files = match format {
                Ok(format) => encode_picture(&saved.seen(), format)
                    .map(|file| vec![(format!("view.{suffix}"), file)]),
                Err(_) => scene_files(&saved, &scene, origin.as_ref()),
            };
            match files {
                Ok(files) => files.into_iter().for_each(|(name, file)| {
                    client.reply(Reply::File(json!({ "file": name }).to_string(), file));
                }),
                Err(failure) => {
                    client.reply(Reply::Text(json!({ "error": failure.brief() }).to_string()));
                }
            }
        });
        Ok(())
    }
}

/// Returns the files of a scene with their names.
fn scene_files(
    saved: &Saved,
    scene: &RwLock<Scene>,
    origin: Option<&Origin>,
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let failed = |error| Failure::Write("view.toml".into(), error);
    let folder = tempfile::tempdir().map_err(failed)?;
    save_scene(&saved.header(), scene, origin, &folder.path().join("view.toml"))?;
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder.path()).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        files.push((name, std::fs::read(entry.path()).map_err(failed)?));
    }
    files.sort();
    Ok(files)
}
