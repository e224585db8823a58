//! Who makes the pictures that the viewer orders, and knows what is at a pixel.

use super::develop::{Developed, Developer};
use super::digits;
use super::load::Stage;
use super::over::{Drawn, Over};
use super::picture::{Order, Picture};
use super::rig::Rig;
use crate::cli::failure::Failure;
use crate::cli::render::draw_bar;
use crate::cli::views::Canvas;
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use spherule::World;
use spherule::bvh::builders::Builder;
use spherule::film::Region;
use spherule::layers::{Layer, layers};
use spherule::render::{End, Options, RenderError, Unfinished};
use spherule::scene::{Camera, ColorBar, Scene, Settings};
use spherule::trace::Tracer;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// The world, and the picture that is being made of it.
pub(super) struct Studio {
    pub(super) stage: Stage,
    pub(super) tracer: Tracer,
    pub(super) builder: Builder,
    /// The camera and settings that the world has, without its spheres.
    aimed: Scene,
    /// Of the camera, by these settings.
    film: Option<(Camera, Unfinished)>,
    over: Over,
    developer: Developer,
    /// Drawn into whole pictures.
    color_bar: Option<ColorBar>,
}

/// What is at a pixel.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Picked {
    /// What there is to say of it, in a line.
    pub(super) text: String,
    pub(super) kind: Option<String>,
    /// Where the ray through the pixel meets it.
    pub(super) point: DVec3,
}

impl Studio {
    pub(super) fn new(stage: Stage, tracer: Tracer, builder: Builder) -> Self {
        let scene = stage.scene.read().unwrap_or_else(PoisonError::into_inner);
        let color_bar = scene.color_bar.clone();
        drop(scene);
        Self {
            stage,
            tracer,
            builder,
            aimed: Scene::default(),
            film: None,
            over: Over::default(),
            developer: Developer::default(),
            color_bar,
        }
    }

    /// Goes on with another scene.
    pub(super) fn set(&mut self, stage: Stage) {
        *self = Self::new(stage, self.tracer, self.builder);
    }

    /// Makes the picture that is ordered, from the last one if that was of the same; nothing if it is
    /// cancelled.
    ///
    /// # Errors
    /// The camera sees nothing.
    pub(super) fn expose(
        &mut self,
        order: &Order,
        cancel: &AtomicBool,
    ) -> Result<Option<Picture>, Failure> {
        self.aim(&order.camera, &order.settings)?;
        let start = Instant::now();
        let options = Options { tracer: self.tracer, cancel: Some(cancel), ..Options::default() };
        let mut film = self.film.take().filter(|(camera, _)| *camera == order.camera);
        let goes_on = |(_, film): &mut (Camera, Unfinished)| film.raise(&order.settings).is_ok();
        film = film.and_then(|mut film| goes_on(&mut film).then_some(film));
        let world = &mut self.stage.world;
        let begin = || {
            let film = Unfinished::begin(world, &order.settings, &options)?;
            Ok::<_, RenderError>((order.camera.clone(), film))
        };
        let (_, film) = self.film.insert(film.map_or_else(begin, Ok)?);
        let before = film.totals().counters.rays();
        if film.run(world, &options) == End::Cancelled {
            return Ok(None);
        }
        let (image, rays) = (film.film().resolve(), film.totals().counters.rays() - before);
        let mut drawn = None;
        if !order.look.is_plain() {
            drawn = self.over.draw(world, order, image.clone(), &options)?;
            if drawn.is_none() {
                return Ok(None);
            }
        }
        let whole = (order.settings.width, order.settings.height) == order.print.size;
        if let Some(bar) = self.color_bar.as_ref().filter(|_| whole) {
            let plain = || Drawn { image: image.clone(), matte: None };
            let Drawn { image, matte } = drawn.get_or_insert_with(plain);
            let mut canvas = Canvas { image, matte: matte.take() };
            draw_bar(bar, &mut canvas, order.look.ink())?;
            *matte = canvas.matte;
        }
        let (version, samples) = (order.version, order.settings.spp);
        let mut picture = Picture {
            version,
            samples,
            image,
            drawn,
            rays,
            developed: None,
            elapsed: Duration::ZERO,
        };
        let (width, height) = order.print.size;
        let mut pixels = vec![0; width as usize * height as usize];
        self.developer.develop(picture.seen(), order.print, &mut pixels);
        picture.developed = Some(Arc::new(Developed { print: order.print, pixels }));
        picture.elapsed = start.elapsed();
        Ok(Some(picture))
    }

    /// Lets the camera into the world; where it is too far away for that, builds the world for it.
    fn aim(&mut self, camera: &Camera, settings: &Settings) -> Result<(), Failure> {
        let same = self.aimed.camera == *camera
            && (self.aimed.settings.width, self.aimed.settings.height)
                == (settings.width, settings.height);
        if same {
            return Ok(());
        }
        self.film = None;
        self.over.move_on();
        (self.aimed.camera, self.aimed.settings) = (camera.clone(), settings.clone());
        let title = self.stage.facts.title.clone();
        let failed = |error| Failure::World(title.clone(), error);
        if self.stage.world.look(&self.aimed).map_err(failed)? {
            return Ok(());
        }
        let mut scene = self.stage.scene.write().unwrap_or_else(PoisonError::into_inner);
        (scene.camera, scene.settings) = (camera.clone(), settings.clone());
        let built = match &self.stage.origin {
            None => World::build_with(&scene, self.builder),
            Some(origin) => {
                let spheres = origin.spheres()?;
                World::build_taking(&mut Scene { spheres, ..scene.clone() }, self.builder)
            }
        };
        self.stage.world = built.map_err(failed)?;
        self.over = Over::default();
        Ok(())
    }

    /// What is at a pixel of the whole picture, if anything but the ground and the sky.
    ///
    /// # Errors
    /// The camera sees nothing.
    pub(super) fn pick(
        &mut self,
        camera: &Camera,
        settings: &Settings,
        (x, y): (u32, u32),
    ) -> Result<Option<Picked>, Failure> {
        self.aim(camera, settings)?;
        let region = Region { x, y, width: 1, height: 1 };
        let options = Options { tracer: self.tracer, region: Some(region), ..Options::default() };
        let found = layers(&self.stage.world, settings, &options, &[Layer::Id])?;
        let row = found.pixels.first().map_or(usize::MAX, |pixel| pixel.id as usize);
        let Some((center, radius)) = self.sphere(row) else { return Ok(None) };
        let labels = &self.stage.labels;
        let id = labels.id(row).unwrap_or(row as f64);
        let kind = labels.kind(row).map(str::to_owned);
        let extent = self.stage.facts.size;
        let [a, b, c] = center.to_array().map(|value| digits::length(value, extent));
        let length = digits::value(radius, extent);
        let named = kind.as_ref().map_or(String::new(), |kind| format!("type {kind}, "));
        let mut text = format!("sphere {id}: {named}at {a} {b} {c}, radius {length}");
        for column in labels.columns(row) {
            text += ", ";
            text += &column;
        }
        let place = DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5);
        let size = DVec2::new(f64::from(settings.width), f64::from(settings.height));
        let offset = (place - size / 2.0) / size.y;
        let ray = Rig::new(camera.clone(), extent).ray(offset * DVec2::new(1.0, -1.0));
        Ok(Some(Picked { text, kind, point: meet(ray, center, radius) }))
    }
}

impl Studio {
    /// Center and radius of a row of the scene, from the world where the scene has only a sketch: the
    /// world's numbers are of single precision.
    fn sphere(&self, row: usize) -> Option<(DVec3, f64)> {
        if self.stage.origin.is_none() {
            let scene = self.stage.scene.read().unwrap_or_else(PoisonError::into_inner);
            let there = row < scene.spheres.len();
            return there.then(|| (scene.spheres.center(row), scene.spheres.radius[row]));
        }
        let World { spheres, frame, .. } = &self.stage.world;
        let place = spheres.id.par_iter().position_any(|&id| id as usize == row)?;
        let (center, radius) = spheres.exact(place);
        Some((center / frame.scale + frame.shift, radius / frame.scale))
    }
}

/// Where a ray meets a sphere that it is known to meet.
fn meet((origin, direction): (DVec3, DVec3), center: DVec3, radius: f64) -> DVec3 {
    let along = (center - origin).dot(direction);
    let across = (origin + direction * along).distance_squared(center);
    let half = (radius * radius - across).max(0.0).sqrt();
    let distance = if along > half { along - half } else { along + half };
    origin + direction * distance
}
