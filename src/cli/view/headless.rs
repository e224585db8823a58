//! A viewer without a window, which runs a script.

use super::events::{Action, Event, Modifiers};
use super::frame_rate::FrameRate;
use super::load::{LoadedScene, Loader};
use super::loading::{Progress, ProgressReporter};
use super::save::{SavedImage, save_bar, save_picture, save_scene};
use super::script::Step;
use super::session::Session;
use super::times::Times;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::render::RenderSetup;
use glam::DVec2;
use spherule_render::atomic::write_atomically;
use spherule_render::image::{Compression, encode_codes};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// A viewer that loads and renders in the calling thread.
pub(super) struct Headless {
    session: Session,
    setup: Arc<RenderSetup<'static>>,
    loader: Loader,
    times: Times,
}

impl Headless {
    /// Loads the scene of the setup.
    pub(super) fn new(setup: RenderSetup<'static>) -> Result<Self, Failure> {
        let setup = Arc::new(setup);
        let (session, loader) = (Session::new(FrameRate::Whole), Loader::new(Arc::clone(&setup)));
        let mut own = Self { session, setup, loader, times: Times::default() };
        let stage = own.load()?;
        own.session.begin(stage, &own.setup);
        Ok(own)
    }

    /// Loads the viewer's content.
    fn load(&mut self) -> Result<LoadedScene, Failure> {
        let progress = Arc::new(Progress::default());
        let _watch = ProgressReporter::start(&progress, self.setup.report.quiet, |_| ());
        self.loader.load(&self.session.viewer.content, &progress)
    }

    /// Runs the steps of a script.
    pub(super) fn run(mut self, steps: &[(usize, Step)], json: bool) -> Result<(), Failure> {
        for (_, step) in steps {
            if !self.step(step)? {
                break;
            }
        }
        self.times.print(self.session.viewer.facts.spheres, json);
        Ok(())
    }

    /// Runs one step; returns false to end the script.
    fn step(&mut self, step: &Step) -> Result<bool, Failure> {
        match step {
            Step::Size(width, height) => return self.event(Event::Resize(*width, *height)),
            Step::Scale(scale) => return self.event(Event::Scale(*scale)),
            Step::Key(key) => return self.event(Event::Key(key.clone())),
            Step::Click { place, held, double } => self.click(*place, *held, *double)?,
            Step::Press { place, button, held } => {
                self.event(Event::Pointer(*place))?;
                return self.event(Event::Press { button: *button, held: *held, double: false });
            }
            Step::Move(place) => {
                self.event(Event::Pointer(*place))?;
                self.show_motion()?;
            }
            Step::Release => return self.event(Event::Release),
            Step::Drag { from, to, button, held, steps } => {
                self.event(Event::Pointer(*from))?;
                self.event(Event::Press { button: *button, held: *held, double: false })?;
                for step in 1..=*steps {
                    let place = from.lerp(*to, f64::from(step) / f64::from(*steps));
                    self.event(Event::Pointer(place))?;
                    self.show_motion()?;
                }
                self.event(Event::Release)?;
            }
            Step::Wheel { steps, place, held } => {
                self.event(Event::Pointer(*place))?;
                self.event(Event::Wheel(*steps, *held))?;
            }
            Step::Turn(degrees) => {
                let viewer = &mut self.session.viewer;
                viewer.control.orbit(degrees * std::f64::consts::PI / 180.0);
                viewer.change();
            }
            Step::Wait(samples) => self.wait(*samples)?,
            Step::Save(path) => self.save(path)?,
            Step::Window(path) => self.capture(path)?,
            Step::Adapt => self.session.viewer.frame_rate = FrameRate::measured(),
            Step::Quit => return Ok(false),
        }
        Ok(true)
    }

    /// Handles an event; returns false to end the viewer.
    fn event(&mut self, event: Event) -> Result<bool, Failure> {
        match self.session.viewer.handle(event) {
            None => (),
            Some(Action::Quit) => return Ok(false),
            Some(Action::Save) => {
                let path = self.setup.output.clone();
                self.wait(1)?;
                self.save(&path)?;
                self.save(&path.with_extension("toml"))?;
            }
            Some(Action::Load) => {
                self.session.drop_world();
                let stage = self.load()?;
                self.session.set(stage, &self.setup);
            }
            Some(Action::Frame(side)) => self.session.frame(side),
            Some(Action::Pick(pixel, purpose)) => {
                let viewer = &self.session.viewer;
                let (camera, settings) = (viewer.control.camera.clone(), viewer.settings.clone());
                let picked = match &mut self.session.renderer {
                    Some(renderer) => renderer.pick(&camera, &settings, pixel)?,
                    None => None,
                };
                if let Some(line) = self.session.picked(picked, purpose) {
                    output::print(line);
                }
            }
        }
        Ok(true)
    }

    fn click(&mut self, place: DVec2, held: Modifiers, double: bool) -> Result<(), Failure> {
        use super::events::Button::Left;
        self.event(Event::Pointer(place))?;
        self.event(Event::Press { button: Left, held, double: false })?;
        self.event(Event::Release)?;
        if double {
            self.event(Event::Press { button: Left, held, double })?;
            self.event(Event::Release)?;
        }
        Ok(())
    }

    /// Renders and draws the next contents of the window.
    fn render(&mut self) -> Result<bool, Failure> {
        let Some(request) = self.session.viewer.next_request() else { return Ok(false) };
        let Some(renderer) = &mut self.session.renderer else { return Ok(false) };
        let picture = renderer.render(&request, &AtomicBool::new(false))?;
        if let Some(picture) = picture {
            self.session.viewer.accept(picture);
        }
        Ok(true)
    }

    fn show_motion(&mut self) -> Result<(), Failure> {
        let start = Instant::now();
        self.render()?;
        self.session.canvas.draw(&self.session.viewer);
        let time = start.elapsed();
        self.session.viewer.frame_rate.record_interval(time);
        self.times.moving.push(time);
        Ok(())
    }

    fn wait(&mut self, samples: u32) -> Result<(), Failure> {
        self.session.viewer.settings.spp = samples;
        while self.session.viewer.sampled().is_none_or(|picture| picture.samples < samples) {
            if !self.render()? {
                break;
            }
        }
        Ok(())
    }

    /// Saves the image or the scene, by the suffix of the name.
    fn save(&mut self, path: &Path) -> Result<(), Failure> {
        if self.session.viewer.sampled().is_none() {
            self.wait(1)?;
        }
        let (Some(settings), Some(renderer)) =
            (self.session.viewer.settings_of_picture(), &self.session.renderer)
        else {
            return Ok(());
        };
        let viewer = &self.session.viewer;
        let Some(picture) = viewer.sampled() else { return Ok(()) };
        let seen = SavedImage {
            title: &viewer.facts.title,
            camera: &viewer.control.camera,
            settings: &settings,
            look: viewer.look(),
            picture,
        };
        if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml")) {
            return save_scene(&seen, &renderer.stage.scene, renderer.stage.origin.as_ref(), path);
        }
        save_picture(&seen, path)?;
        save_bar(&self.setup, &viewer.facts, &settings)
    }

    /// Writes the contents of the window.
    fn capture(&mut self, path: &Path) -> Result<(), Failure> {
        self.session.canvas.draw(&self.session.viewer);
        let canvas = &self.session.canvas;
        let size = (canvas.width, canvas.height);
        encode_codes(&canvas.codes(), size, Compression::default())
            .and_then(|file| write_atomically(path, |writer| writer.write_all(&file)))
            .map_err(|error| Failure::Write(path.to_owned(), error))
    }
}
