//! The viewer's state: it handles events, requests images, and holds what the page shows. It uses no clock,
//! threads or files, so that a page, a script and a test behave in the same way.

use super::camera_control::CameraControl;
use super::content::{Content, CutPlane, LookChanges};
use super::events::{Action, Button, Event, Modifiers, Picked, Purpose};
use super::frame_rate::FrameRate;
use super::history::History;
use super::image::Picture;
use super::keys;
use super::loading::Loading;
use super::tonemap::{DisplaySettings, ToneMapper};
use glam::{DVec2, DVec3};
use spherule_render::elementary::pow;
use spherule_render::scene::particles::{Cell, Legend, Orientation};
use spherule_render::scene::{Camera, Denoise, Look, Preset, Settings, Slice};
use std::sync::Arc;

/// Minimum and maximum side of the image in pixels.
const SIDES: (u32, u32) = (16, 16_384);

/// Maximum number of selected spheres: all of them are marked in each image.
pub(super) const SELECTED: usize = 1000;

/// Range of display scales.
pub(super) const SCALES: std::ops::RangeInclusive<f64> = 0.25..=8.0;

/// Maximum movement of the pointer during a click, in pixels.
const CLICK: f64 = 4.0;

/// Angle of orbit for a drag over the height of the image, in radians.
const TURN: f64 = 4.0;

/// Factors of the distance for a step of the wheel, and for a drag over the height of the image.
const WHEEL: f64 = 0.88;
const DRAG: f64 = 8.0;

/// Factor of the field of view for a step of the wheel.
pub(super) const WIDER: f64 = 1.1;

/// Facts about the viewer's content.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Facts {
    pub(super) title: String,
    /// Number of visible spheres.
    pub(super) spheres: usize,
    /// Names of types that can be hidden.
    pub(super) types: Vec<String>,
    /// Columns that can be colored by.
    pub(super) columns: Vec<String>,
    /// The trajectory frame, from 0, if selected by number, and the number of frames.
    pub(super) frame: u64,
    pub(super) frames: Option<u64>,
    /// Radius of the bounding sphere of the scene.
    pub(super) size: f64,
    /// True if the camera frames everything.
    pub(super) framed: bool,
    /// The camera that the preset's lights follow.
    pub(super) lit_from: Camera,
    /// The scene's look and settings.
    pub(super) look: Look,
    pub(super) settings: Settings,
    /// The preset of the command line, or the default one of particles.
    pub(super) preset: Option<Preset>,
    /// The orientation of the particles, if the scene is of particles.
    pub(super) orientation: Option<Orientation>,
    /// True if particles have their own materials, which presets do not replace.
    pub(super) own_materials: bool,
    /// The color scale, if colors represent numbers, and whether the image has its own color bar.
    pub(super) legend: Option<Legend>,
    pub(super) color_bar: bool,
    /// The slices of the option, and the bounding box of the spheres before them.
    pub(super) slices: Vec<Slice>,
    pub(super) bounds: [DVec3; 2],
    /// The cell of the particles, and the symbol of their unit of length.
    pub(super) cell: Option<Cell>,
    pub(super) unit: &'static str,
}

/// Current action of the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    /// A button was pressed here, and the pointer has not moved yet.
    Click(DVec2, Button, Modifiers),
    Turn,
    Pan,
    Zoom,
    Roll,
    /// A slice that starts here.
    CutPlane(DVec2),
}

/// State of the viewer.
#[derive(Clone, Debug)]
pub(super) struct Viewer {
    pub(super) control: CameraControl,
    pub(super) home: Camera,
    /// Settings with the size of the page's image, and the final number of samples.
    pub(super) settings: Settings,
    pub(super) content: Content,
    pub(super) touched: LookChanges,
    pub(super) facts: Facts,
    pub(super) frame_rate: FrameRate,
    /// Maximum number of pixels of previews, by the connection.
    pub(super) most_pixels: u64,
    /// Type of the last clicked sphere.
    pub(super) named: Option<String>,
    /// Selected spheres, at most [`SELECTED`], in the order of their selection.
    pub(super) picked: Vec<Picked>,
    /// Message to the user.
    pub(super) message: String,
    pub(super) history: History,
    /// True if the camera and the settings of the content that is loaded next are taken.
    pub(super) takes_camera: bool,
    pub(super) takes_settings: bool,
    pub(super) tone_mapper: ToneMapper,
    /// The display's scale.
    pub(super) scale: f64,
    /// Progress of loading, if it takes long.
    pub(super) loading: Option<Loading>,
    /// True if the next drag is a slice.
    pub(super) cutting: bool,
    pub(super) shown: Option<Arc<Picture>>,
    /// Version of the view, which grows with every change.
    pub(super) version: u64,
    pointer: DVec2,
    drag: Option<Drag>,
}

impl Viewer {
    /// Creates the viewer of a scene whose camera is placed by its eye.
    pub(super) fn new(camera: &Camera, settings: &Settings, frame_rate: FrameRate) -> Self {
        Self {
            control: CameraControl::new(camera.clone(), 1.0),
            home: camera.clone(),
            settings: Settings { until_error: None, time: None, ..settings.clone() },
            content: Content::default(),
            touched: LookChanges::default(),
            facts: Facts::default(),
            frame_rate,
            most_pixels: u64::MAX,
            named: None,
            picked: Vec::new(),
            message: String::new(),
            history: History::default(),
            takes_camera: false,
            takes_settings: false,
            tone_mapper: ToneMapper::default(),
            scale: 1.0,
            loading: None,
            cutting: false,
            shown: None,
            version: 0,
            pointer: DVec2::ZERO,
            drag: None,
        }
    }

    /// Sets the facts about new content.
    pub(super) fn loaded(&mut self, facts: Facts) {
        self.control.resize(facts.size);
        self.facts = facts;
        self.loading = None;
        self.change();
    }

    /// Shows the current image with other display settings.
    pub(super) fn tone_map(&mut self) {
        if let Some(picture) = &mut self.shown {
            let display = DisplaySettings::of(&self.settings);
            let (image, matte) = picture.visible();
            let pixels = Arc::new(self.tone_mapper.map(image, matte, display));
            Arc::make_mut(picture).pixels = pixels;
        }
    }

    /// Starts a new version: refinement starts anew.
    pub(super) fn change(&mut self) {
        self.version += 1;
    }

    /// Returns the current look.
    pub(super) fn look(&self) -> Look {
        let (own, touched) = (self.facts.look, self.touched);
        Look {
            background: touched.background.unwrap_or(own.background),
            depth_cue: touched.depth_cue.unwrap_or(own.depth_cue),
            outline: touched.outline.unwrap_or(own.outline),
            cell: own.cell,
        }
    }

    /// Returns the current image if it is up to date and no preview.
    pub(super) fn sampled(&self) -> Option<&Arc<Picture>> {
        let current =
            |picture: &&Arc<Picture>| picture.version == self.version && picture.samples > 0;
        self.shown.as_ref().filter(current)
    }

    /// Returns the settings that render the current image, if it is no preview.
    pub(super) fn settings_of_picture(&self) -> Option<Settings> {
        self.sampled().map(|picture| {
            let denoise = if picture.before.is_some() { Denoise::On } else { Denoise::Off };
            Settings { spp: picture.samples, denoise, ..self.settings.clone() }
        })
    }

    /// Returns whether the pointer is moving the camera.
    pub(super) fn is_dragging(&self) -> bool {
        matches!(self.drag, Some(Drag::Turn | Drag::Pan | Drag::Zoom | Drag::Roll))
    }

    /// Returns whether the next drag is a slice.
    pub(super) fn is_cutting(&self) -> bool {
        self.cutting || matches!(self.drag, Some(Drag::CutPlane(_)))
    }

    /// Handles an event, and returns the action that it needs, if any.
    pub(super) fn handle(&mut self, event: Event) -> Option<Action> {
        match event {
            Event::Pointer(place) => self.point(place),
            Event::Press { button, held, double } => return self.press(button, held, double),
            Event::Release => return self.release(),
            Event::Wheel(steps, held) if held.shift => {
                self.control.scale_field_of_view(pow(WIDER, -steps));
                self.change();
            }
            Event::Wheel(steps, _) => {
                self.control.zoom(pow(WHEEL, steps), self.to_image_heights(self.pointer));
                self.change();
            }
            Event::Key(key) => {
                return keys::command(&key).and_then(|command| self.execute(command));
            }
            Event::Resize(width, height) => {
                let side = |side: u32| side.clamp(SIDES.0, SIDES.1);
                (self.settings.width, self.settings.height) = (side(width), side(height));
                self.change();
            }
            Event::Scale(scale) => {
                self.scale = scale.clamp(*SCALES.start(), *SCALES.end());
            }
        }
        None
    }

    /// Converts a position to units of the image's height from its center, to the right and upward.
    fn to_image_heights(&self, place: DVec2) -> DVec2 {
        let size = DVec2::new(f64::from(self.settings.width), f64::from(self.settings.height));
        let offset = (place - size / 2.0) / size.y;
        DVec2::new(offset.x, -offset.y)
    }

    fn point(&mut self, place: DVec2) {
        let moved = self.to_image_heights(place) - self.to_image_heights(self.pointer);
        if let Some(Drag::Click(start, button, held)) = self.drag {
            if place.distance(start) <= CLICK * self.scale.max(1.0) {
                return;
            }
            self.drag = Some(drag_of(button, held));
        }
        self.pointer = place;
        match self.drag {
            Some(Drag::Turn) => self.control.orbit(DVec2::new(moved.x, -moved.y) * TURN),
            Some(Drag::Pan) => self.control.pan(moved),
            Some(Drag::Zoom) => self.control.zoom(pow(DRAG, -moved.y), DVec2::ZERO),
            Some(Drag::Roll) => self.control.roll(-moved.x * TURN),
            Some(Drag::Click(..) | Drag::CutPlane(_)) | None => return,
        }
        self.change();
    }

    fn press(&mut self, button: Button, held: Modifiers, double: bool) -> Option<Action> {
        if std::mem::take(&mut self.cutting) {
            self.drag = Some(Drag::CutPlane(self.pointer));
            return None;
        }
        if double && button == Button::Left {
            return Some(Action::Pick(self.pixel(self.pointer), Purpose::Pivot));
        }
        self.drag = Some(Drag::Click(self.pointer, button, held));
        None
    }

    fn release(&mut self) -> Option<Action> {
        match self.drag.take()? {
            Drag::Click(place, Button::Left, held) => {
                let purpose = match held {
                    Modifiers { control: true, .. } => Purpose::Focus,
                    Modifiers { shift: true, .. } => Purpose::Add,
                    _ => Purpose::Name,
                };
                Some(Action::Pick(self.pixel(place), purpose))
            }
            Drag::CutPlane(start) => self.cut_off(start),
            _ => None,
        }
    }

    /// Returns the pixel at a place in the image.
    pub(super) fn pixel(&self, place: DVec2) -> (u32, u32) {
        let last =
            DVec2::new(f64::from(self.settings.width), f64::from(self.settings.height)) - 1.0;
        let place = place.clamp(DVec2::ZERO, last);
        (place.x as u32, place.y as u32)
    }

    /// Adds a slice that cuts away the right side of the line from `start` to the pointer.
    fn cut_off(&mut self, start: DVec2) -> Option<Action> {
        let [a, b] =
            [start, self.pointer].map(|place| self.control.ray(self.to_image_heights(place)));
        // In perspective both rays start at the eye; in orthographic projection they are parallel.
        let across = (b.0 + b.1) - (a.0 + a.1);
        let normal = a.1.cross(across).try_normalize()?;
        self.content.cuts.push(CutPlane { normal, point: a.0 });
        self.show_message("cut; press H to undo");
        Some(Action::Load)
    }
}

fn drag_of(button: Button, held: Modifiers) -> Drag {
    match button {
        _ if held.alt => Drag::Roll,
        _ if held.control => Drag::Zoom,
        _ if held.shift => Drag::Pan,
        Button::Right => Drag::Pan,
        Button::Left | Button::Middle => Drag::Turn,
    }
}
