//! Parts of a render as bytes, and their merge: for machines that share no memory.

use crate::errors::error;
use crate::scene::{Fault, Scene};
use crate::session::{RenderTable, Session, show};
use crate::watch::{Shared, Stop, Watcher};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use spherule::checkpoint::{self, Caption, Origin};
use spherule::split::{Merge, Part};
use std::ffi::OsString;
use std::fs;
use std::io;

/// Name of the file of a part, in a folder of its own.
const FILE: &str = "part";

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        Self::Text(format!("cannot store a part in the folder of temporary files: {error}"))
    }
}

/// Renders part `number` of `count`, from 1, and returns it as bytes.
#[pyfunction]
pub(crate) fn render_part<'py>(
    py: Python<'py>,
    scene: &Scene,
    table: RenderTable,
    number: u32,
    count: u32,
    stop: Option<&Stop>,
) -> PyResult<Bound<'py, PyBytes>> {
    let part = Part::new(number, count).ok_or_else(|| {
        error(py, &format!("there is no part {number} of {count}; parts are 1 to {count}"))
    })?;
    let (request, pool) = table.request(py)?;
    let scene = scene.share();
    let work = move |shared: &Shared| -> Result<Option<Vec<u8>>, Fault> {
        let mut session = Session::begin(&pool, &scene, request, false, Some(part))?;
        pool.install(|| {
            if !session.run(shared, None) {
                return Ok(None);
            }
            let Some(identity) = session.identity.take() else { return Ok(None) };
            let (folder, arguments) = (OsString::new(), Vec::new());
            let origin = Origin { scene: identity, folder, arguments, caption: Caption::default() };
            let folder = tempfile::tempdir()?;
            let path = folder.path().join(FILE);
            checkpoint::write(&path, &origin, &session.render)?;
            Ok(Some(fs::read(&path)?))
        })
    };
    let (bytes, interrupt) = Watcher::new(stop, None).run_outside(py, work)?;
    if let Some(interrupt) = interrupt {
        return Err(interrupt);
    }
    let bytes = bytes.map_err(|fault| fault.raise(py))?;
    let bytes = bytes.ok_or_else(|| error(py, &"the part was stopped before its end"))?;
    Ok(PyBytes::new(py, &bytes))
}

/// Merges all parts of a render of a scene to its picture.
#[pyfunction]
pub(crate) fn merge<'py>(
    py: Python<'py>,
    scene: &Scene,
    table: RenderTable,
    parts: Vec<Vec<u8>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (request, pool) = table.request(py)?;
    let scene = scene.share();
    let work = move |shared: &Shared| {
        let whole = pool.install(|| {
            let folder = tempfile::tempdir()?;
            let path = folder.path().join(FILE);
            let mut merge = Merge::default();
            let text = |why: &dyn std::fmt::Display| Fault::Text(why.to_string());
            for (number, bytes) in (1..).zip(&parts) {
                fs::write(&path, bytes)?;
                let (origin, render) = checkpoint::read(&path).map_err(|why| text(&why))?;
                merge
                    .add(&format!("part {number}"), &origin.scene, render)
                    .map_err(|why| text(&why))?;
            }
            Ok::<_, Fault>(merge.finish().map_err(|why| text(&why))?.0)
        })?;
        let mut session = Session::begin(&pool, &scene, request, false, Part::new(1, 1))?;
        session.render = whole;
        pool.install(|| session.show(&shared.cancel)).map(Some)
    };
    let (shown, interrupt) = Watcher::default().run_outside(py, work)?;
    show(py, shown, interrupt)
}
