//! The choices that all frames of a file have in common, as plain values: particles are pickled with them.

use pyo3::prelude::*;
use pyo3::types::PyDict;
use spherule::particles::Format;
use spherule::scene::particles::{FirstFrame, Orientation, UpReason};
use spherule::scene::{Axis, Camera, Projection};

/// Reasons why a direction is up, with their names.
const REASONS: [(&str, UpReason); 5] = [
    ("layer", UpReason::Layer),
    ("slab", UpReason::Slab),
    ("vacuum", UpReason::Vacuum),
    ("bed", UpReason::Bed),
    ("molecule", UpReason::Molecule),
];

/// The values.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct FirstFrameTable {
    up: String,
    /// `None` for the convention of the format.
    reason: Option<String>,
    parallel: bool,
    front: Option<String>,
    radius: Option<f64>,
    spheres: usize,
}

impl FirstFrameTable {
    /// The choices for particles that were read from a file of this format.
    pub(crate) fn first_frame(&self, format: Format) -> FirstFrame {
        let reason =
            |name: &str| REASONS.iter().find(|(own, _)| *own == name).map(|(_, reason)| *reason);
        let projection = if self.parallel {
            Projection::Orthographic { height: None }
        } else {
            Camera::LONG_LENS
        };
        let orientation = Orientation {
            up: Axis::named(&self.up).unwrap_or(Axis::Z),
            reason: self.reason.as_deref().and_then(reason).unwrap_or(UpReason::Convention(format)),
            projection,
            front: self.front.as_deref().and_then(Axis::named),
        };
        FirstFrame {
            orientation,
            guessed_radius: self.radius,
            spheres: self.spheres,
            arrow_sizes: None,
            arrow_limit: None,
        }
    }
}

/// Returns the values of the choices.
pub(crate) fn table<'py>(
    py: Python<'py>,
    first_frame: &FirstFrame,
) -> PyResult<Bound<'py, PyDict>> {
    let Orientation { up, reason, projection, front } = first_frame.orientation;
    let table = PyDict::new(py);
    table.set_item("up", up.name())?;
    let name = REASONS.iter().find(|(_, own)| *own == reason).map(|(name, _)| *name);
    table.set_item("reason", name)?;
    table.set_item("parallel", matches!(projection, Projection::Orthographic { .. }))?;
    table.set_item("front", front.map(Axis::name))?;
    table.set_item("radius", first_frame.guessed_radius)?;
    table.set_item("spheres", first_frame.spheres)?;
    Ok(table)
}
