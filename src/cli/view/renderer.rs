//! Rendering of the viewer's images, and picking.

use super::camera_control::CameraControl;
use super::events::Picked;
use super::image::{OverlaidImage, Picture, Quality, RenderRequest};
use super::load::LoadedScene;
use super::overlay::OverlayCache;
use super::tonemap::ToneMapper;
use super::viewer::SELECTED;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::render::draw_annotations;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use spherule_render::World;
use spherule_render::bvh::builders::Builder;
use spherule_render::compose::{Descriptions, Labels};
use spherule_render::denoise::{Choice, Denoised, Denoiser, Judged};
use spherule_render::film::Region;
use spherule_render::image::Image;
use spherule_render::layers::{Layer, layers};
use spherule_render::noise::Noise;
use spherule_render::overlay::Canvas;
use spherule_render::render::{End, Options, Render, RenderError, ResumableRender, preview};
use spherule_render::scene::particles::{ParticleFrame, Particles, Selection};
use spherule_render::scene::{
    Annotations, Background, Camera, Denoise, Rgb, Scene, Settings, Spheres,
};
use spherule_render::trace::Tracer;
use std::collections::HashSet;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// The world, and the state of its current image.
pub(super) struct Renderer {
    pub(super) stage: LoadedScene,
    pub(super) tracer: Tracer,
    pub(super) builder: Builder,
    /// Camera, settings and background of the world, without its spheres.
    view: Scene,
    /// The render of the current camera and settings.
    refined: Option<Refined>,
    overlay: OverlayCache,
    tone_mapper: ToneMapper,
    /// The annotations of full-size images.
    annotations: Annotations,
}

/// A render that is refined.
struct Refined {
    camera: Camera,
    render: ResumableRender,
    /// `None` if its images are not denoised.
    denoiser: Option<Denoiser>,
}

/// A rendered image without overlays.
struct Plain {
    image: Image,
    noise: Option<Noise>,
    /// Error before denoising, if the image is denoised.
    before: Option<Noise>,
    rays: u64,
}

impl Renderer {
    pub(super) fn new(stage: LoadedScene, tracer: Tracer, builder: Builder) -> Self {
        let scene = stage.scene.read().unwrap_or_else(PoisonError::into_inner);
        let (annotations, look) = (scene.annotations.clone(), scene.look);
        drop(scene);
        Self {
            stage,
            tracer,
            builder,
            view: Scene { look, ..Scene::default() },
            refined: None,
            overlay: OverlayCache::default(),
            tone_mapper: ToneMapper::default(),
            annotations,
        }
    }

    /// Replaces the scene.
    pub(super) fn set(&mut self, stage: LoadedScene) {
        *self = Self::new(stage, self.tracer, self.builder);
    }

    /// Renders a requested image, continuing the last one if possible; `None` if cancelled.
    ///
    /// # Errors
    /// The camera sees nothing.
    pub(super) fn render(
        &mut self,
        request: &RenderRequest,
        cancel: &AtomicBool,
    ) -> Result<Option<Picture>, Failure> {
        self.set_camera(&request.camera, &request.settings)?;
        self.set_background(request.look.background);
        let start = Instant::now();
        let options = Options { tracer: self.tracer, cancel: Some(cancel), ..Options::default() };
        let plain = match request.quality {
            Quality::Preview { shadows } => self.preview(request, &options, shadows)?,
            Quality::Sampled => self.refine(request, &options)?,
        };
        self.stage.device.new_fault().iter().for_each(output::warn);
        let Some(Plain { image, noise, before, rays }) = plain else { return Ok(None) };
        let world = &mut self.stage.world;
        let mut drawn = None;
        if !request.look.is_plain() {
            drawn = self.overlay.draw(world, request, image.clone(), &options)?;
            if drawn.is_none() {
                return Ok(None);
            }
        }
        if request.whole && !self.annotations.is_empty() {
            let plain = || OverlaidImage { image: image.clone(), matte: None };
            let OverlaidImage { image, matte } = drawn.get_or_insert_with(plain);
            let mut canvas = Canvas { image, matte: matte.take() };
            let resolution = request.settings.dpi;
            let scene = (&self.annotations, &request.look);
            draw_annotations(scene, world, resolution, &mut canvas, false);
            *matte = canvas.matte;
        }
        let sampled = request.quality == Quality::Sampled;
        let mut picture = Picture {
            version: request.version,
            camera: request.camera.clone(),
            samples: if sampled { request.settings.spp } else { 0 },
            quality: request.quality,
            image,
            noise,
            before,
            drawn,
            rays,
            pixels: Arc::default(),
            elapsed: Duration::ZERO,
            started: start,
        };
        let (image, matte) = picture.visible();
        picture.pixels = Arc::new(self.tone_mapper.map(image, matte, request.display));
        picture.elapsed = start.elapsed();
        Ok(Some(picture))
    }

    /// Renders a preview; `None` if cancelled.
    fn preview(
        &self,
        request: &RenderRequest,
        options: &Options,
        shadows: bool,
    ) -> Result<Option<Plain>, RenderError> {
        let image = preview(&self.stage.world, &request.settings, options, shadows)?;
        let pixels = u64::from(request.settings.width) * u64::from(request.settings.height);
        Ok(image.map(|image| Plain { image, noise: None, before: None, rays: pixels }))
    }

    /// Adds samples to the last render, or begins anew, and denoises; `None` if cancelled.
    fn refine(
        &mut self,
        request: &RenderRequest,
        options: &Options,
    ) -> Result<Option<Plain>, RenderError> {
        let (world, settings) = (&self.stage.world, &request.settings);
        let features = choice(settings.denoise).is_some();
        let options = Options { statistics: true, features, ..*options };
        let extends = |refined: &mut Refined| {
            refined.camera == request.camera && refined.render.extend(settings).is_ok()
        };
        let begin = || {
            let render = ResumableRender::begin(world, settings, &options)?;
            let new = |choice| Denoiser::new(world, settings, &options, choice);
            let denoiser = choice(settings.denoise).map(new).transpose()?;
            Ok::<_, RenderError>(Refined { camera: request.camera.clone(), render, denoiser })
        };
        let refined = self.refined.take().and_then(|mut last| extends(&mut last).then_some(last));
        let Refined { render, denoiser, .. } = self.refined.insert(refined.map_or_else(begin, Ok)?);
        let before = render.totals().counters.rays();
        if render.run(world, &options) == End::Cancelled {
            return Ok(None);
        }
        let rays = render.totals().counters.rays() - before;
        if let Some(denoiser) = denoiser {
            let judged = denoiser.judge(world, render.film(), &options);
            let Some(Judged { denoised, before, noise }) = judged else { return Ok(None) };
            if let Some(Denoised { image, .. }) = denoised {
                return Ok(Some(Plain { image, noise: Some(noise), before: Some(before), rays }));
            }
        }
        let Render { image, noise, .. } = render.render();
        Ok(Some(Plain { image, noise, before: None, rays }))
    }

    /// Sets the camera of the world; rebuilds the world if the camera is too far away for its precision.
    fn set_camera(&mut self, camera: &Camera, settings: &Settings) -> Result<(), Failure> {
        let same = self.view.camera == *camera
            && (self.view.settings.width, self.view.settings.height)
                == (settings.width, settings.height);
        if same {
            return Ok(());
        }
        self.refined = None;
        self.overlay.invalidate();
        (self.view.camera, self.view.settings) = (camera.clone(), settings.clone());
        let title = self.stage.facts.title.clone();
        let failed = |error| Failure::World(title.clone(), error);
        if self.stage.world.set_camera(&self.view).map_err(failed)? {
            return Ok(());
        }
        let mut scene = self.stage.scene.write().unwrap_or_else(PoisonError::into_inner);
        (scene.camera, scene.settings) = (camera.clone(), settings.clone());
        scene.look.background = self.view.look.background;
        let built = match &self.stage.origin {
            None => World::build_with(&scene, self.builder),
            Some(origin) => {
                let spheres = origin.spheres()?;
                World::build_taking(&mut Scene { spheres, ..scene.clone() }, self.builder)
            }
        };
        self.stage.world = built.map_err(failed)?;
        self.stage.device.renew(&mut self.stage.world, &scene.settings);
        self.overlay = OverlayCache::default();
        Ok(())
    }

    /// Sets the background of the world.
    fn set_background(&mut self, background: Background) {
        if std::mem::replace(&mut self.view.look.background, background) != background {
            self.refined = None;
            self.stage.world.set_background(background);
        }
    }

    /// Picks the sphere at a pixel of the full-size image; `None` for ground and background.
    ///
    /// # Errors
    /// The camera sees nothing.
    pub(super) fn pick(
        &mut self,
        camera: &Camera,
        settings: &Settings,
        (x, y): (u32, u32),
    ) -> Result<Option<Picked>, Failure> {
        self.set_camera(camera, settings)?;
        let region = Region { x, y, width: 1, height: 1 };
        let options = Options { tracer: self.tracer, region: Some(region), ..Options::default() };
        let found = layers(&self.stage.world, settings, &options, &[Layer::Id])?;
        let row = found.pixels.first().map_or(usize::MAX, |pixel| pixel.id as usize);
        let Some((center, radius)) = self.sphere(row) else { return Ok(None) };
        let labels = &self.stage.labels;
        let id = labels.id(row);
        let kind = labels.kind(row).map(str::to_owned);
        let extent = self.stage.facts.size;
        let text = Descriptions::new(labels, extent).text(row, center, radius);
        let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let size = DVec2::new(f64::from(settings.width), f64::from(settings.height));
        let offset = (place - size / 2.0) / size.y;
        let ray = CameraControl::new(camera.clone(), extent).ray(offset * DVec2::new(1.0, -1.0));
        let point = intersect(ray, center, radius);
        Ok(Some(Picked { text, kind, id, center, radius, point }))
    }

    /// Returns the spheres of which conditions are true, one condition after another.
    ///
    /// # Errors
    /// A condition names no column there is, or they are true of more spheres than can be selected.
    pub(super) fn select(&mut self, selections: &[Selection]) -> Result<Vec<Picked>, Failure> {
        if selections.is_empty() {
            return Ok(Vec::new());
        }
        let spheres = self.spheres();
        let Labels { kinds, numbers, texts } = std::mem::take(&mut self.stage.labels);
        let count = numbers.len();
        let names = numbers.iter().map(|own| &own.name).chain(texts.iter().map(|own| &own.name));
        let columns = names.cloned().collect();
        let cell = self.stage.facts.cell;
        let frame =
            ParticleFrame { kinds, numbers, texts, columns, cell, ..ParticleFrame::default() };
        let mut particles = Particles { spheres, frame, ..Particles::default() };
        let mut rows = Vec::new();
        let mut fault = None;
        for selection in selections {
            match selection.matches(&mut particles) {
                Ok(chosen) => rows.extend((0..chosen.len()).filter(|&row| chosen[row])),
                Err(error) => fault = Some(error),
            }
        }
        let Particles { spheres, frame, .. } = particles;
        let ParticleFrame { kinds, mut numbers, texts, .. } = frame;
        numbers.truncate(count);
        self.stage.labels = Labels { kinds, numbers, texts };
        if let Some(fault) = fault {
            return Err(Failure::View(fault.message));
        }
        let mut seen = HashSet::new();
        rows.retain(|&row| seen.insert(row));
        if rows.len() > SELECTED {
            let count = rows.len();
            return Err(Failure::View(format!(
                "{count} particles; at most {SELECTED} can be selected, and `set style 'CONDITION: color=red'` colors all"
            )));
        }
        let labels = &self.stage.labels;
        let descriptions = Descriptions::new(labels, self.stage.facts.size);
        let picked = rows.into_iter().map(|row| {
            let (center, radius) = (spheres.center(row), spheres.radius[row]);
            let text = descriptions.text(row, center, radius);
            let kind = labels.kind(row).map(str::to_owned);
            Picked { text, kind, id: labels.id(row), center, radius, point: center }
        });
        Ok(picked.collect())
    }
}

impl Renderer {
    /// The spheres of the scene, likewise.
    fn spheres(&self) -> Spheres {
        if self.stage.origin.is_none() {
            let scene = self.stage.scene.read().unwrap_or_else(PoisonError::into_inner);
            return scene.spheres.clone();
        }
        let world = &self.stage.world;
        let mut places: Vec<usize> = (0..world.spheres.id.len()).collect();
        places.par_sort_unstable_by_key(|&place| world.spheres.id[place]);
        let mut spheres = Spheres::default();
        for place in places {
            let (center, radius) = world.sphere(place);
            spheres.push(center, radius, 0, Rgb::ONE);
        }
        spheres
    }

    /// Center and radius of a sphere of the scene; in the world's single precision if the scene has only a
    /// sketch.
    fn sphere(&self, row: usize) -> Option<(DVec3, f64)> {
        if self.stage.origin.is_none() {
            let scene = self.stage.scene.read().unwrap_or_else(PoisonError::into_inner);
            let there = row < scene.spheres.len();
            return there.then(|| (scene.spheres.center(row), scene.spheres.radius[row]));
        }
        let world = &self.stage.world;
        let place = world.spheres.id.par_iter().position_any(|&id| id as usize == row)?;
        Some(world.sphere(place))
    }
}

/// Returns the choice between denoised and unfiltered images; `None` if none is denoised.
fn choice(denoise: Denoise) -> Option<Choice> {
    match denoise {
        Denoise::On => Some(Choice::Always),
        Denoise::Auto => Some(Choice::UnlessWorse),
        Denoise::Off => None,
    }
}

/// Intersection of a ray with a sphere that it is known to hit.
fn intersect((origin, direction): (DVec3, DVec3), center: DVec3, radius: f64) -> DVec3 {
    let along = (center - origin).dot(direction);
    let across = (origin + direction * along).distance_squared(center);
    let half = (radius * radius - across).max(0.0).sqrt();
    let distance = if along > half { along - half } else { along + half };
    origin + direction * distance
}
