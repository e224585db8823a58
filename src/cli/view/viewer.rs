//! The viewer without a window: what happens goes in, what is to be rendered comes out, and pictures
//! become what the window shows. It knows no clock, no threads and no files, so that a window, a
//! script and a test see the same.

use super::command::{Action, Button, Event, Held, Purpose};
use super::content::{Content, Cut};
use super::keys;
use super::loading::Loading;
use super::pace::Pace;
use super::picture::Picture;
use super::rig::Rig;
use glam::DVec2;
use spherule::scene::particles::Legend;
use spherule::scene::{Background, Camera, Look, Settings};

/// Least and most pixels on a side of the window.
const SIDES: (u32, u32) = (16, 16_384);

/// Scales of displays.
pub(super) const SCALES: std::ops::RangeInclusive<f64> = 0.25..=8.0;

/// Pixels that the pointer may move in a click.
const CLICK: f64 = 4.0;

/// Radians that a drag over the height of the window turns by.
const TURN: f64 = 4.0;

/// Factor on the distance for a step of the wheel, and for a drag over the height of the window.
const WHEEL: f64 = 0.88;
const DRAG: f64 = 8.0;

/// Factor on the field of view for a step of the wheel.
pub(super) const WIDER: f64 = 1.1;

/// What the viewer knows of what it shows.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Facts {
    pub(super) title: String,
    /// Spheres that are drawn.
    pub(super) spheres: usize,
    /// Names by which spheres can be hidden.
    pub(super) types: Vec<String>,
    /// Columns by which spheres can be colored.
    pub(super) columns: Vec<String>,
    /// The frame of a trajectory, from 0, if it was chosen by number, and how many there are.
    pub(super) frame: u64,
    pub(super) frames: Option<u64>,
    /// Radius of the ball about all spheres.
    pub(super) size: f64,
    /// What the scene says is drawn over its pictures.
    pub(super) look: Look,
    /// True if particles have materials of their own, which looks do not replace.
    pub(super) own_materials: bool,
    /// The numbers that colors stand for, if they stand for any, and whether the picture has a color
    /// bar of its own.
    pub(super) legend: Option<Legend>,
    pub(super) color_bar: bool,
}

/// What was changed of the scene's look by keys.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Touched {
    pub(super) background: Option<Background>,
    pub(super) depth_cue: Option<bool>,
    pub(super) outline: Option<bool>,
}

/// What the pointer does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Drag {
    /// A button went down here and nothing was moved yet.
    Click(DVec2, Button, Held),
    Turn,
    Pan,
    Zoom,
    Roll,
    /// A cut that begins here.
    Cut(DVec2),
}

/// The viewer.
#[derive(Clone, Debug)]
pub(super) struct Viewer {
    pub(super) rig: Rig,
    pub(super) home: Camera,
    /// With the size of the window, and the samples at which the picture is finished.
    pub(super) settings: Settings,
    pub(super) content: Content,
    pub(super) touched: Touched,
    pub(super) facts: Facts,
    pub(super) pace: Pace,
    /// Of the sphere that was named last, its type.
    pub(super) named: Option<String>,
    /// What was done last, for the status line.
    pub(super) message: String,
    /// The page of the help that is shown, from 0.
    pub(super) help: Option<usize>,
    pub(super) status: bool,
    /// True if a color bar is shown where the picture has none.
    pub(super) bar: bool,
    /// The display's scale.
    pub(super) scale: f64,
    /// Progress of what is being loaded, if it takes a while.
    pub(super) loading: Option<Loading>,
    /// Whether the next drag cuts.
    pub(super) cutting: bool,
    pub(super) shown: Option<Picture>,
    /// Root of the mean squared error by the mean, estimated.
    pub(super) noise: Option<f64>,
    /// Grows with every change of what is to be seen.
    pub(super) version: u64,
    /// A picture of half as many samples, for the noise.
    pub(super) half: Option<Picture>,
    pointer: DVec2,
    drag: Option<Drag>,
}

impl Viewer {
    /// A viewer of a scene whose camera is placed by its eye.
    pub(super) fn new(camera: &Camera, settings: &Settings, pace: Pace) -> Self {
        Self {
            rig: Rig::new(camera.clone(), 1.0),
            home: camera.clone(),
            settings: Settings { until_error: None, time: None, ..settings.clone() },
            content: Content::default(),
            touched: Touched::default(),
            facts: Facts::default(),
            pace,
            named: None,
            message: "press ? for help".to_owned(),
            help: None,
            status: true,
            bar: true,
            scale: 1.0,
            loading: None,
            cutting: false,
            shown: None,
            noise: None,
            version: 0,
            half: None,
            pointer: DVec2::ZERO,
            drag: None,
        }
    }

    /// Takes note of what there is to see now.
    pub(super) fn loaded(&mut self, facts: Facts) {
        self.rig.resize(facts.size);
        self.facts = facts;
        self.loading = None;
        self.change();
    }

    /// What is shown is not what it was: pictures begin anew.
    pub(super) fn change(&mut self) {
        self.version += 1;
    }

    /// What is drawn over pictures.
    pub(super) fn look(&self) -> Look {
        let (own, touched) = (self.facts.look, self.touched);
        Look {
            background: touched.background.unwrap_or(own.background),
            depth_cue: touched.depth_cue.unwrap_or(own.depth_cue),
            outline: touched.outline.unwrap_or(own.outline),
            cell: own.cell,
        }
    }

    /// What is shown, if it is the whole picture of what is to be seen now.
    pub(super) fn whole(&self) -> Option<&Picture> {
        let whole = (self.settings.width, self.settings.height);
        let now = |picture: &&Picture| picture.version == self.version && picture.size() == whole;
        self.shown.as_ref().filter(now)
    }

    /// The settings by which a render makes the whole picture that is shown.
    pub(super) fn settings_of_picture(&self) -> Option<Settings> {
        self.whole().map(|picture| Settings { spp: picture.samples, ..self.settings.clone() })
    }

    /// Whether the pointer is moving the camera.
    #[cfg(feature = "view")]
    pub(super) fn is_dragging(&self) -> bool {
        matches!(self.drag, Some(Drag::Turn | Drag::Pan | Drag::Zoom | Drag::Roll))
    }

    /// The line from where a cut begins to where it would end now.
    pub(super) fn cut(&self) -> Option<[DVec2; 2]> {
        match self.drag {
            Some(Drag::Cut(start)) => Some([start, self.pointer]),
            _ => None,
        }
    }

    /// Takes in what happened, and says what others have to do for it.
    pub(super) fn handle(&mut self, event: Event) -> Option<Action> {
        match event {
            Event::Pointer(place) => self.point(place),
            Event::Press { button, held, double } => return self.press(button, held, double),
            Event::Release => return self.release(),
            Event::Wheel(steps, held) if held.shift => {
                self.rig.widen(WIDER.powf(-steps));
                self.change();
            }
            Event::Wheel(steps, _) => {
                self.rig.zoom(WHEEL.powf(steps), self.in_heights(self.pointer));
                self.change();
            }
            Event::Key(key) => return keys::command(&key).and_then(|command| self.obey(command)),
            Event::Resize(width, height) => {
                let side = |side: u32| side.clamp(SIDES.0, SIDES.1);
                (self.settings.width, self.settings.height) = (side(width), side(height));
                self.change();
            }
            Event::Scale(scale) => {
                self.scale = scale.clamp(*SCALES.start(), *SCALES.end());
            }
            #[cfg(feature = "view")]
            Event::Close => return Some(Action::Quit),
        }
        None
    }

    /// A place in heights of the picture from its middle, to the right and upward.
    fn in_heights(&self, place: DVec2) -> DVec2 {
        let size = DVec2::new(f64::from(self.settings.width), f64::from(self.settings.height));
        let offset = (place - size / 2.0) / size.y;
        DVec2::new(offset.x, -offset.y)
    }

    fn point(&mut self, place: DVec2) {
        let moved = self.in_heights(place) - self.in_heights(self.pointer);
        if let Some(Drag::Click(start, button, held)) = self.drag {
            if place.distance(start) <= CLICK * self.scale.max(1.0) {
                return;
            }
            self.drag = Some(drag_of(button, held));
        }
        self.pointer = place;
        match self.drag {
            Some(Drag::Turn) => self.rig.orbit(DVec2::new(moved.x, -moved.y) * TURN),
            Some(Drag::Pan) => self.rig.pan(moved),
            Some(Drag::Zoom) => self.rig.zoom(DRAG.powf(-moved.y), DVec2::ZERO),
            Some(Drag::Roll) => self.rig.roll(-moved.x * TURN),
            Some(Drag::Click(..) | Drag::Cut(_)) | None => return,
        }
        self.change();
    }

    fn press(&mut self, button: Button, held: Held, double: bool) -> Option<Action> {
        if std::mem::take(&mut self.cutting) {
            self.drag = Some(Drag::Cut(self.pointer));
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
                let purpose = if held.control { Purpose::Focus } else { Purpose::Name };
                Some(Action::Pick(self.pixel(place), purpose))
            }
            Drag::Cut(start) => self.cut_off(start),
            _ => None,
        }
    }

    fn pixel(&self, place: DVec2) -> (u32, u32) {
        let last =
            DVec2::new(f64::from(self.settings.width), f64::from(self.settings.height)) - 1.0;
        let place = place.clamp(DVec2::ZERO, last);
        (place.x as u32, place.y as u32)
    }

    /// Cuts off what is to the right of the way from `start` to the pointer.
    fn cut_off(&mut self, start: DVec2) -> Option<Action> {
        let [a, b] = [start, self.pointer].map(|place| self.rig.ray(self.in_heights(place)));
        // In perspective both rays start at the eye, in parallel projection they go the same way.
        let across = (b.0 + b.1) - (a.0 + a.1);
        let normal = a.1.cross(across).try_normalize()?;
        self.content.cuts.push(Cut { normal, point: a.0 });
        self.say("cut; H undoes it");
        Some(Action::Load)
    }
}

fn drag_of(button: Button, held: Held) -> Drag {
    match button {
        _ if held.alt => Drag::Roll,
        _ if held.control => Drag::Zoom,
        _ if held.shift => Drag::Pan,
        Button::Right => Drag::Pan,
        Button::Left | Button::Middle => Drag::Turn,
    }
}
