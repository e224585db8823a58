//! Options for simulation cells, cameras and overlays.

mod camera;
mod lens;

use self::camera::UpArg;
use self::lens::LensArgs;
use super::lists::{self, List};
use super::names::{self, Names};
use super::values;
use super::with_text::{self, WithText};
use crate::cli::failure::Failure;
use clap::value_parser;
use spherule_render::compose::{CameraRequest, CellRequest, LensRequest, LookAt};
use spherule_render::scene::particles::{Boundary, Orientation, Outside, Selection, UpReason};
use spherule_render::scene::{Axis, Camera, FileError, Projection, Scene};
use spherule_render::world::framing::view::{self, View};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

/// Projections, with their default parameters.
const PROJECTIONS: Names<Projection> = Names(&[
    ("perspective", Camera::LONG_LENS, "Closer objects appear larger"),
    (
        "orthographic",
        Projection::Orthographic { height: None },
        "Parallel rays: size does not depend on \
                                                                 distance",
    ),
]);

/// The camera that frames all of a scene from a side of `--view`, and the direction that is up there; `None`
/// for another word.
pub(in crate::cli) fn from_side(
    side: &str,
    scene: &Scene,
    orientation: Option<&Orientation>,
) -> Option<(Camera, Axis)> {
    let view: View = side.parse().ok()?;
    Some((view.camera(scene, orientation), view::up_of_sides(orientation)))
}

/// Range of the number of images of a turntable.
const PICTURES: std::ops::RangeInclusive<i64> = 1..=100_000;

/// Words of `--complete`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Completion {
    /// For crystals
    Auto,
    /// Complete the cell
    Yes,
    /// Draw particles where they are
    No,
}

impl Completion {
    fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Yes => "yes",
            Self::No => "no",
        }
    }
}

/// Options for the simulation cell and the camera.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Cell and view")]
pub(in crate::cli) struct ViewArgs {
    /// Wrap particles into the cell along its periodic directions
    #[arg(long)]
    wrap: bool,
    /// Replicate the cell NA, NB and NC times along its edges
    #[arg(long, value_name = "NA,NB,NC", value_parser = values::copies)]
    replicate: Option<[u32; 3]>,
    /// Draw particles on faces, edges and corners of the cell on the opposite ones, too [default: auto, which does so for
    /// crystals: files of CIF, POSCAR, XSF and CFG with at most 1000 atoms, and extended XYZ and ASE trajectories of a
    /// single frame with at most 100, in a cell that is periodic in all directions]
    #[arg(long, value_name = "auto|yes|no", value_enum)]
    complete: Option<Completion>,
    /// Bonds that leave the cell: molecules, which are whole if their centers are in the cell; whole, with the particles at their
    /// other ends; none; or their halves inside [default: molecules in a completed cell, or else halves]
    #[arg(
        long,
        value_name = "molecules|whole|none|halves",
        value_parser = |name: &str| values::named(&Outside::ALL, name, "treatments of bonds are")
    )]
    outside: Option<Outside>,
    /// Draw the cell's edges
    #[arg(long)]
    cell: bool,
    /// Direction of particles that is up in the image: x, y, z, -x, -y, -z, or auto, which decides by the
    /// particles, their cell and the file format [default: auto]
    #[arg(long, value_name = "AXIS", allow_hyphen_values = true, value_parser = camera::up)]
    up: Option<UpArg>,
    /// Place the camera to show everything from a direction: auto (along the principal axis of least extent), x, y, z (from
    /// that end of the axis), -x, -y, -z, iso, azimuth and elevation in degrees as in 30,20, or a vector as in 1,1,0. 0,0
    /// looks from x if z is up, and 90,0 from y, as in matplotlib
    #[arg(long, value_name = "DIRECTION", allow_hyphen_values = true, value_parser = |text: &str| text.parse::<View>())]
    view: Option<View>,
    /// Turn the camera to particles for which EXPR is true (as for --select), or to a point X,Y,Z, and frame them: particles as
    /// large as possible, or all around the point [default: all particles]
    #[arg(
        long,
        value_name = "EXPR|X,Y,Z",
        allow_hyphen_values = true,
        value_parser = |text: &str| text.parse::<WithText<LookAt>>()
    )]
    look_at: Option<WithText<LookAt>>,
    /// Magnification about the middle of what is framed: 2 is twice as large, from the same place [default: 1]
    #[arg(long, value_name = "FACTOR", allow_hyphen_values = true, value_parser = camera::zoom)]
    zoom: Option<f64>,
    /// Roll the camera clockwise about its view axis, so that the image turns counterclockwise, in degrees
    #[arg(
        long,
        value_name = "DEGREES",
        allow_hyphen_values = true,
        conflicts_with = "turntable",
        value_parser = values::finite
    )]
    roll: Option<f64>,
    /// Take the camera and its lens from a scene file, as the viewer saves it, or from keys of its [camera], as in
    /// 'eye = [9, 2, 0], target = [0, 0, 0]'
    #[arg(long, value_name = "FILE")]
    camera: Option<PathBuf>,
    /// Place the lights of the preset as for this camera, given as for --camera, and not as for the image's
    #[arg(long, value_name = "FILE")]
    lit_from: Option<PathBuf>,
    /// Camera projection
    #[arg(long, value_parser = names::parser(&PROJECTIONS))]
    projection: Option<Projection>,
    /// Margin around the particles as a fraction of the image, 0 to 0.9, when the camera shows everything
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true, value_parser = camera::margin)]
    margin: Option<f64>,
    /// Render N images of a full turn around the axis that is up, NAME-000.png and so on; with a range of
    /// frames, they are spread evenly over the N images
    #[arg(long, value_name = "N", value_parser = value_parser!(u32).range(PICTURES))]
    turntable: Option<u32>,
    #[command(flatten)]
    lens: LensArgs,
}

impl ViewArgs {
    /// Number of images of the turntable; `None` without one.
    pub(in crate::cli) fn turntable(&self) -> Option<u32> {
        self.turntable
    }

    /// Returns whether an option needs a particle file with a cell.
    pub(in crate::cli) fn needs_cell(&self) -> bool {
        let boundary = self.complete.is_some() || self.outside.is_some();
        self.wrap || self.cell || self.replicate.is_some() || boundary
    }

    /// Returns whether `--up` is given, which needs a particle file.
    pub(in crate::cli) fn sets_up(&self) -> bool {
        self.up.is_some()
    }

    /// Settings for the image's metadata.
    pub(in crate::cli) fn list(&self) -> List {
        let mut list = List::new();
        lists::put(&mut list, "wrap", self.wrap.then_some(true));
        lists::put(&mut list, "replicate", self.replicate.map(|[a, b, c]| format!("{a},{b},{c}")));
        lists::put(&mut list, "complete", self.complete.map(Completion::name));
        lists::put(&mut list, "outside", self.outside.map(Outside::name));
        lists::put(&mut list, "cell", self.cell.then_some(true));
        lists::put(&mut list, "up", self.up.map(UpArg::name));
        lists::put(&mut list, "view", self.view.map(|view| view.to_string()));
        with_text::insert(&mut list, "look_at", &self.look_at);
        lists::put(&mut list, "zoom", self.zoom);
        lists::put(&mut list, "roll", self.roll);
        // Folders are private.
        let name = self.camera.as_deref().and_then(|path| match self.camera_file() {
            Some(file) => file.file_name(),
            None => Some(path.as_os_str()),
        });
        lists::put(&mut list, "camera", name.map(|name| name.to_string_lossy().into_owned()));
        let name = self.lit_from.as_deref().map(|path| {
            if Camera::is_line(path) {
                path.as_os_str()
            } else {
                path.file_name().unwrap_or_default()
            }
        });
        lists::put(&mut list, "lit_from", name.map(|name| name.to_string_lossy().into_owned()));
        let projection = self.projection.map(|projection| PROJECTIONS.name(&projection));
        lists::put(&mut list, "projection", projection);
        lists::put(&mut list, "margin", self.margin);
        list.extend(self.lens.list());
        list
    }

    /// Returns the lens that is asked for.
    pub(in crate::cli) fn lens(&self) -> LensRequest {
        self.lens.request()
    }

    /// Returns whether a focus is given that the scene's camera ignores.
    pub(in crate::cli) fn has_idle_focus(&self, scene: &Scene) -> bool {
        self.lens.is_idle(scene)
    }

    /// Rejects options that apply only to particle files.
    pub(in crate::cli) fn refuse_cells(&self) -> Result<(), Failure> {
        if self.needs_cell() {
            let message =
                "--wrap, --replicate, --complete, --outside and --cell need a particle file";
            return Err(Failure::usage("render", message));
        }
        Ok(())
    }

    /// Returns what is done to the cell.
    pub(in crate::cli) fn cell(&self) -> CellRequest {
        let complete = match self.complete {
            None | Some(Completion::Auto) => None,
            Some(word) => Some(word == Completion::Yes),
        };
        let boundary = Boundary { complete, outside: self.outside };
        CellRequest { wrap: self.wrap, copies: self.replicate, show: self.cell, boundary }
    }

    /// Returns the direction that is up, if one is chosen.
    pub(in crate::cli) fn up(&self) -> Option<Axis> {
        self.up.and_then(|up| up.0)
    }

    /// Returns the view that is asked for.
    pub(in crate::cli) fn camera(&self) -> Result<CameraRequest, FileError> {
        let Self { view, projection, margin, turntable, zoom, roll, .. } = *self;
        let own = self.camera.as_deref().map(Camera::read).transpose()?;
        let look_at = match self.look_at.as_deref() {
            Some(LookAt::Point(point)) => Some(*point),
            Some(LookAt::Selection(_)) | None => None,
        };
        let turns = turntable.is_some();
        Ok(CameraRequest { own, view, look_at, zoom, roll, projection, margin, turns })
    }

    /// Returns the camera that the preset's lights follow, if it is not the image's.
    pub(in crate::cli) fn lit_from(&self) -> Result<Option<Camera>, FileError> {
        self.lit_from.as_deref().map(Camera::read).transpose()
    }

    /// Returns the selection of the particles that are framed.
    pub(in crate::cli) fn framed(&self) -> Option<Selection> {
        match self.look_at.as_deref() {
            Some(LookAt::Selection(selection)) => Some(selection.clone()),
            Some(LookAt::Point(_)) | None => None,
        }
    }

    /// Returns the file that the camera is taken from.
    pub(in crate::cli) fn camera_file(&self) -> Option<&Path> {
        self.camera.as_deref().filter(|path| !Camera::is_line(path))
    }

    /// Returns a sentence on what is up and why; `None` if the view does not depend on it.
    pub(in crate::cli) fn explain_up(&self, orientation: &Orientation) -> Option<String> {
        let reason = orientation.reason;
        let up = match self.view {
            Some(View::Auto) if !reason.is_evident() => return None,
            Some(view) if view.is_from_side() => orientation.up_of_sides(),
            _ => orientation.up,
        };
        let chosen = reason == UpReason::Chosen;
        (!chosen).then(|| format!("{} is up: {reason}; --up chooses another direction", up.name()))
    }

    /// Angle of an image of the turntable, in radians.
    pub(in crate::cli) fn angle(&self, turn: u32) -> f64 {
        TAU * f64::from(turn) / f64::from(self.turntable.unwrap_or(1))
    }
}
