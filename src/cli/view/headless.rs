//! A viewer without a page, which runs a script.

use super::events::{Action, Purpose};
use super::frame_rate::FrameRate;
use super::load::{LoadedScene, Loader, Origin};
use super::loading::{Progress, ProgressReporter};
use super::options::Options;
use super::renderer::Renderer;
use super::save::{SavedImage, save_bar, save_picture, save_scene};
use super::script::Step;
use super::session;
use super::times::Times;
use super::viewer::Viewer;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::render::RenderSetup;
use spherule_render::atomic::write_atomically;
use spherule_render::image::{Compression, encode_codes};
use spherule_render::scene::{Camera, Header, Settings};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

/// A viewer that loads and renders in the calling thread.
pub(super) struct Headless<'a> {
    viewer: Viewer,
    /// `None` if the world was dropped to make room for the next.
    renderer: Option<Renderer>,
    setup: RenderSetup<'a>,
    loader: Loader,
    times: Times,
}

impl<'a> Headless<'a> {
    /// Loads the scene of the setup, which has these options.
    pub(super) fn new(setup: RenderSetup<'a>, options: Options) -> Result<Self, Failure> {
        let mut viewer = Viewer::new(&Camera::default(), &Settings::default(), FrameRate::Whole);
        viewer.content.options = options;
        let (loader, times) = (Loader::default(), Times::default());
        let mut own = Self { viewer, renderer: None, setup, loader, times };
        let stage = own.load()?;
        session::begin(&mut own.viewer, &stage);
        stage.warnings.iter().for_each(output::warn);
        own.render_scene(stage);
        Ok(own)
    }

    /// Loads the viewer's content.
    fn load(&mut self) -> Result<LoadedScene, Failure> {
        let progress = Arc::new(Progress::default());
        let _watch = ProgressReporter::start(&progress, self.setup.report.quiet, |_| ());
        self.loader.load(&self.viewer.content, &progress)
    }

    /// Sets the scene that is rendered.
    fn render_scene(&mut self, stage: LoadedScene) {
        if let Some(renderer) = &mut self.renderer {
            return renderer.set(stage);
        }
        let Settings { width, height, spp, .. } = self.viewer.settings;
        let samples = u64::from(width) * u64::from(height) * u64::from(spp);
        let builder = self.setup.builder(self.viewer.facts.spheres, samples);
        self.renderer = Some(Renderer::new(stage, self.setup.tracer, builder));
    }

    /// Runs the steps of a script.
    pub(super) fn run(mut self, steps: &[(usize, Step)], json: bool) -> Result<(), Failure> {
        let parts = steps.iter().flat_map(|(_, step)| step.clone().parts());
        for step in parts {
            if !self.step(&step)? {
                break;
            }
        }
        self.times.print(self.viewer.facts.spheres, json);
        Ok(())
    }

    /// Runs one step; returns false to end the script.
    fn step(&mut self, step: &Step) -> Result<bool, Failure> {
        match step {
            Step::Wait(samples) => self.wait(*samples)?,
            Step::Save(path) => self.save(path)?,
            Step::Window(path) => self.capture(path)?,
            Step::Adapt => self.viewer.frame_rate = FrameRate::measured(),
            Step::Quit => return Ok(false),
            _ => (),
        }
        match self.viewer.step(step)? {
            None => (),
            Some(Action::Quit) => return Ok(false),
            Some(Action::Save) => {
                let path = self.setup.output.clone();
                self.wait(1)?;
                self.save(&path)?;
                self.save(&path.with_extension("toml"))?;
            }
            Some(Action::Load) => {
                // Memory may not be sufficient for two large worlds.
                let is_large = |renderer: &mut Renderer| {
                    renderer.stage.origin.as_ref().is_some_and(Origin::is_readable)
                };
                drop(self.renderer.take_if(is_large));
                let stage = self.load()?;
                session::set(&mut self.viewer, &stage);
                self.render_scene(stage);
            }
            Some(Action::Frame(side)) => {
                if let Some(renderer) = &self.renderer {
                    session::frame(&mut self.viewer, &renderer.stage.scene, side);
                }
            }
            Some(Action::Pick(pixel, purpose)) => self.pick(pixel, purpose)?,
            Some(Action::Select(selections)) => {
                if let Some(renderer) = &mut self.renderer {
                    session::select(&mut self.viewer, renderer.select(&selections)?);
                }
            }
        }
        if matches!(step, Step::Move(_)) {
            self.show_motion()?;
        }
        Ok(true)
    }

    fn pick(&mut self, pixel: (u32, u32), purpose: Purpose) -> Result<(), Failure> {
        let (camera, settings) = (&self.viewer.control.camera, &self.viewer.settings);
        let picked = match &mut self.renderer {
            Some(renderer) => renderer.pick(camera, settings, pixel)?,
            None => None,
        };
        if let Some(line) = session::picked_by(&mut self.viewer, picked, purpose) {
            output::print(line);
        }
        Ok(())
    }

    /// Renders the next image.
    fn render(&mut self) -> Result<bool, Failure> {
        let Some(request) = self.viewer.next_request() else { return Ok(false) };
        let Some(renderer) = &mut self.renderer else { return Ok(false) };
        let picture = renderer.render(&request, &AtomicBool::new(false))?;
        if let Some(picture) = picture {
            self.viewer.accept(picture);
        }
        Ok(true)
    }

    fn show_motion(&mut self) -> Result<(), Failure> {
        let start = Instant::now();
        self.render()?;
        let time = start.elapsed();
        self.viewer.frame_rate.record_interval(time);
        self.times.moving.push(time);
        Ok(())
    }

    fn wait(&mut self, samples: u32) -> Result<(), Failure> {
        self.viewer.settings.spp = samples;
        while self.viewer.sampled().is_none_or(|picture| picture.samples < samples) {
            if !self.render()? {
                break;
            }
        }
        Ok(())
    }

    /// Saves the image or the scene, by the suffix of the name.
    fn save(&mut self, path: &Path) -> Result<(), Failure> {
        if self.viewer.sampled().is_none() {
            self.wait(1)?;
        }
        let (Some(settings), Some(renderer)) = (self.viewer.settings_of_picture(), &self.renderer)
        else {
            return Ok(());
        };
        let viewer = &self.viewer;
        let Some(picture) = viewer.sampled() else { return Ok(()) };
        let seen = SavedImage {
            title: &viewer.facts.title,
            camera: &viewer.control.camera,
            settings: &settings,
            look: viewer.look(),
            picture,
        };
        if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml")) {
            let SavedImage { title, camera, settings, ref look, .. } = seen;
            let header = Header { title, camera, settings, look };
            return save_scene(
                &header,
                &renderer.stage.scene,
                renderer.stage.origin.as_ref(),
                path,
            );
        }
        save_picture(&seen, path)?;
        save_bar(&self.setup, &viewer.facts, &settings)
    }

    /// Writes the image as it is shown.
    fn capture(&mut self, path: &Path) -> Result<(), Failure> {
        if self.viewer.shown.is_none() {
            self.render()?;
        }
        let Some(picture) = &self.viewer.shown else { return Ok(()) };
        let channels = |pixel: &u32| [16, 8, 0].map(|shift| (pixel >> shift) as u8);
        let codes: Vec<u8> = picture.pixels.iter().flat_map(channels).collect();
        encode_codes(&codes, picture.size(), Compression::default())
            .and_then(|file| write_atomically(path, |writer| writer.write_all(&file)))
            .map_err(|error| Failure::Write(path.to_owned(), error))
    }
}
