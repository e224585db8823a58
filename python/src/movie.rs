//! Movies: frames that share camera and colors, and the video that they become.

use crate::encode::{image, tone};
use crate::errors::error;
use crate::pools::pool;
use crate::scene::{Scene, SceneArguments, Work};
use crate::watch::Watcher;
use numpy::PyReadonlyArray3;
use pyo3::prelude::*;
use spherule::compose::Survey;
use spherule::image::WriteOptions;
use spherule::video::{self, Container, VideoError};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

/// Frames that share the camera, the meaning of colors, and the choices by the first of them, as those of a sequence of the
/// program do. All of them, or the first, are surveyed before their scenes are made.
#[pyclass(frozen, module = "spherule._spherule")]
#[derive(Default)]
pub(crate) struct FrameSequence {
    survey: Arc<Mutex<Option<Survey>>>,
}

#[pymethods]
impl FrameSequence {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Surveys a frame; the arguments are those of `Scene`.
    fn survey(&self, py: Python<'_>, arguments: SceneArguments<'_>) -> PyResult<()> {
        let work = Work::of_frame(py, arguments)?;
        let survey = Arc::clone(&self.survey);
        let added = Watcher::default().run(py, pool(py, None)?, move |_| {
            work.survey(&mut survey.lock().unwrap_or_else(PoisonError::into_inner))
        })?;
        added.0.map_err(|fault| fault.raise(py))
    }

    /// Makes the scene of a frame.
    fn scene(&self, py: Python<'_>, arguments: SceneArguments<'_>) -> PyResult<Scene> {
        let work = Work::of_frame(py, arguments)?;
        let survey = Arc::clone(&self.survey);
        let made = Watcher::default().run(py, pool(py, None)?, move |_| {
            let mut survey = survey.lock().unwrap_or_else(PoisonError::into_inner);
            work.scene_of(survey.get_or_insert_default())
        })?;
        Ok(Scene::of(made.0.map_err(|fault| fault.raise(py))?))
    }
}

/// A video that is written picture by picture.
#[pyclass(frozen, module = "spherule._spherule")]
pub(crate) struct Video {
    path: PathBuf,
    video: Mutex<Option<video::Video>>,
}

#[pymethods]
impl Video {
    #[new]
    fn new(py: Python<'_>, path: PathBuf, fps: f64) -> PyResult<Self> {
        let Some(container) = Container::of_suffix(&path) else {
            let names = Container::SUFFIXES.map(|(suffix, _)| format!(".{suffix}")).join(", ");
            let path = path.display();
            let message = format!(
                "{path}: videos are named {names}, and numbered pictures as in frame-%04d.png"
            );
            return Err(error(py, &message));
        };
        let opened = video::Video::new(&path, container, Some(fps));
        let video = Mutex::new(Some(opened.map_err(|why| of_video(py, &path, why))?));
        Ok(Self { path, video })
    }

    /// Adds a picture of the same size as the first one.
    fn add(
        &self,
        py: Python<'_>,
        pixels: PyReadonlyArray3<'_, f32>,
        exposure: f64,
        filmic: bool,
    ) -> PyResult<()> {
        let image = image(&pixels).map_err(|why| error(py, &why))?;
        let options = WriteOptions { exposure, tone: tone(filmic), ..WriteOptions::default() };
        let added = py.detach(|| {
            let mut video = self.video.lock().unwrap_or_else(PoisonError::into_inner);
            video.as_mut().map_or(Ok(()), |video| video.add(&image, &options))
        });
        added.map_err(|why| of_video(py, &self.path, why))
    }

    /// Gives the video its name.
    fn finish(&self, py: Python<'_>) -> PyResult<()> {
        let video = self.video.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(video) = video else { return Ok(()) };
        let finished = py.detach(|| video.finish());
        finished.map(|_| ()).map_err(|why| of_video(py, &self.path, why))
    }

    /// Ends the encoder, and leaves nothing of the video.
    fn discard(&self) {
        *self.video.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }
}

fn of_video(py: Python<'_>, path: &Path, why: VideoError) -> PyErr {
    let path = path.display();
    match why {
        VideoError::Write(why) => why.into(),
        VideoError::Missing(_) => {
            let else_ = "or save numbered pictures, as in frame-%04d.png";
            error(py, &format!("{path}: {why}, {else_}"))
        }
        why => error(py, &format!("{path}: {why}")),
    }
}
