//! Albums, files of all images of a render: videos, and figures, pages of HTML that are turned or played.

use super::prepare::Prepared;
use super::setup::RenderSetup;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::picture_file::AlbumKind;
use crate::cli::write_file::{check_destination, write_file};
use spherule_render::compose::Descriptions;
use spherule_render::graphics::Figure;
use spherule_render::image::{Channel, Image, WriteOptions};
use spherule_render::render::Options;
use spherule_render::video::Video;

/// A file of all images, while they are added.
pub(super) enum Album {
    Video(Box<Video>),
    /// A page, once it has an image.
    Figure(Option<Figure>),
}

impl Album {
    /// Begins the file of a render, if all its images are in one.
    pub(super) fn begin(setup: &RenderSetup) -> Result<Option<Self>, Failure> {
        let (path, fps) = (&setup.output, setup.sequence.fps);
        match setup.album {
            None => Ok(None),
            Some(AlbumKind::Figure) => check_destination(path).map(|()| Some(Self::Figure(None))),
            Some(AlbumKind::Video(container)) => match Video::new(path, container, fps) {
                Ok(video) => Ok(Some(Self::Video(Box::new(video)))),
                Err(error) => Err(Failure::video(path, fps, error)),
            },
        }
    }

    /// Adds an image.
    pub(super) fn add(
        &mut self,
        setup: &RenderSetup,
        prepared: &Prepared,
        image: &Image,
        channels: &[Channel],
        options: &WriteOptions,
    ) -> Result<(), Failure> {
        let figure = match self {
            Self::Video(video) => {
                let added = video.add(image, options);
                return added.map_err(|error| Failure::video(&setup.output, None, error));
            }
            Self::Figure(figure) => figure,
        };
        let is_turn = setup.views.turntable().is_some();
        let figure = figure.get_or_insert_with(|| Figure::new(&prepared.title, is_turn));
        let file = image.encode(setup.format, channels, options)?;
        let region = Some(prepared.region);
        let seen = Options { tracer: setup.tracer, region, ..Options::default() };
        let descriptions = Descriptions::new(&prepared.labels, prepared.extent);
        let settings = &prepared.scene.settings;
        let numbers = descriptions.numbers(&prepared.world, settings, &seen, figure)?;
        figure.add(setup.format, file, (image.width, image.height), &numbers);
        Ok(())
    }

    /// Completes the file, and prints a message about it; a page without an image is not written.
    pub(super) fn finish(self, setup: &RenderSetup) -> Result<(), Failure> {
        let summary = match self {
            Self::Video(video) => {
                video.finish().map_err(|error| Failure::video(&setup.output, None, error))?
            }
            Self::Figure(None) => return Ok(()),
            Self::Figure(Some(figure)) => {
                let page = figure.file();
                write_file(&setup.output, page.as_bytes())?;
                let megabytes = page.len() as f64 / 1e6;
                let (path, count) = (setup.output.display(), figure.len());
                let images = if count == 1 { "image" } else { "images" };
                format!("{path}: page with {count} {images}, {megabytes:.1} MB")
            }
        };
        if !setup.report.quiet {
            output::print(summary);
        }
        Ok(())
    }
}
