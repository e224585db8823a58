//! How particle files are repeated and framed on the command line, and what is drawn over pictures.

mod camera;
mod over;
mod periodic;
mod style;

use self::camera::View;
pub(super) use self::camera::corners;
pub(super) use self::over::{Canvas, draw_over, settings_of_layers};
pub(super) use self::style::{StyleArgs, scene_of_particles};
use super::names::Names;
use super::settings::List;
use clap::value_parser;
use serde_json::json;
use spherule::scene::{Camera, Projection, Scene};

/// Projections, with their usual parameters.
const PROJECTIONS: Names<Projection> = Names(&[
    ("perspective", Projection::Perspective { fov: 40.0 }, "What is nearer is larger"),
    ("orthographic", Projection::Orthographic { height: None }, "Parallel rays: sizes compare"),
]);

/// The camera that frames all of a scene from a side of `--view`; `None` for another word.
pub(super) fn from_side(side: &str, scene: &Scene) -> Option<Camera> {
    camera::view(side).ok().map(|view| camera::of_view(view, scene))
}

/// Pictures of a turn: a day of film, at most.
const PICTURES: std::ops::RangeInclusive<i64> = 1..=100_000;

/// What is in the picture.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Cell and view")]
pub(super) struct ViewArgs {
    /// Move particles into the cell, along the edges that the simulation repeats along
    #[arg(long)]
    wrap: bool,
    /// So many copies of the cell along each of its edges
    #[arg(long, value_name = "NA,NB,NC", value_parser = periodic::copies)]
    replicate: Option<[u32; 3]>,
    /// Draw the cell's edges
    #[arg(long)]
    cell: bool,
    /// Frame everything from a side: auto (broadside, by the principal axes), x, y, z (from that
    /// end of the axis), -x, -y, -z, or iso
    #[arg(long, value_name = "SIDE", allow_hyphen_values = true, value_parser = camera::view)]
    view: Option<View>,
    /// How directions become pixels
    #[arg(long, value_parser = PROJECTIONS.parser())]
    projection: Option<Projection>,
    /// Share of the picture left free at its edges, 0 to 0.9, where the camera frames everything
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true, value_parser = camera::margin)]
    margin: Option<f64>,
    /// Render N pictures of a full turn around the vertical axis, NAME-000.png and so on; with many
    /// frames, they are spread evenly over the N pictures
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(PICTURES))]
    turntable: Option<u32>,
}

impl ViewArgs {
    /// Pictures around the vertical axis; `None` for one from where the camera stands.
    pub(super) fn turntable(&self) -> Option<u32> {
        self.turntable
    }

    /// Whether the file of particles is to be changed, or its cell drawn.
    pub(super) fn needs_cell(&self) -> bool {
        self.wrap || self.cell || self.replicate.is_some()
    }

    /// What makes the picture, for its file.
    pub(super) fn list(&self) -> List {
        let mut list = List::new();
        if self.wrap {
            list.insert("wrap".to_owned(), json!(true));
        }
        if let Some([a, b, c]) = self.replicate {
            list.insert("replicate".to_owned(), json!(format!("{a},{b},{c}")));
        }
        if self.cell {
            list.insert("cell".to_owned(), json!(true));
        }
        if let Some(view) = self.view {
            list.insert("view".to_owned(), json!(view.name()));
        }
        if let Some(projection) = self.projection {
            list.insert("projection".to_owned(), json!(PROJECTIONS.name(&projection)));
        }
        if let Some(margin) = self.margin {
            list.insert("margin".to_owned(), json!(margin));
        }
        list
    }
}
