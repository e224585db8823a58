//! Options for slices: planes that cut spheres away.

use super::lists::List;
use super::values;
use serde_json::json;
use spherule_render::scene::{Slice, SliceMode, SlicePlane};

/// Options for slices.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Slices")]
pub(in crate::cli) struct SliceArgs {
    /// Cut away the side of a plane where a condition is true, as in 'z>10', 'x+y<3' or 'z>50%', percent of
    /// the cell or else of the bounding box of all spheres; also z=50%, or a normal and a distance
    /// NX,NY,NZ,D, which cut away the side that the normal points to; may be repeated
    #[arg(long = "slice", value_name = "PLANE", allow_hyphen_values = true, value_parser = |text: &str| text.parse::<SlicePlane>())]
    planes: Vec<SlicePlane>,
    /// Treatment of spheres: remove drops spheres whose centers are cut away, caps cuts spheres and closes
    /// them with flat caps of their own color, hide makes spheres whose centers are cut away invisible to the
    /// camera but keeps their shadows [default: remove]
    #[arg(long, value_name = "MODE", requires = "planes", value_parser = |name: &str| values::named(&SliceMode::ALL, name, "modes are"))]
    slice_mode: Option<SliceMode>,
}

impl SliceArgs {
    /// Returns the planes that cut.
    pub(in crate::cli) fn planes(&self) -> &[SlicePlane] {
        &self.planes
    }

    /// Returns the treatment of spheres.
    pub(in crate::cli) fn mode(&self) -> SliceMode {
        self.slice_mode.unwrap_or_default()
    }

    /// Settings for the image's metadata.
    pub(in crate::cli) fn list(&self) -> List {
        let mut list = List::new();
        if !self.planes.is_empty() {
            let planes: Vec<&str> = self.planes.iter().map(SlicePlane::text).collect();
            list.insert("slice".to_owned(), json!(planes.join("; ")));
            list.insert("slice_mode".to_owned(), json!(self.mode().name()));
        }
        list
    }
}

/// Text of a slice: `beyond 10 along [0.0, 0.0, 1.0]: caps`.
pub(in crate::cli) fn text(slice: &Slice) -> String {
    let Slice { normal, distance, mode } = slice;
    format!("beyond {distance} along {:?}: {}", normal.to_array(), mode.name())
}
