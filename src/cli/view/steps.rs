//! Execution of the steps of scripts and pages.

use super::content::LookChanges;
use super::events::{Action, Button, Event, Modifiers, Purpose};
use super::history::State;
use super::script::Step;
use super::viewer::Viewer;
use crate::cli::failure::Failure;
use crate::cli::help;
use glam::{DVec2, DVec3};
use spherule_render::scene::{Camera, Pose, Settings};
use std::ffi::OsString;
use std::path::Path;

/// Settings that change the image of a scene, and not the scene.
const OF_IMAGES: [&str; 7] =
    ["spp", "sampler", "integrator", "depth", "exposure", "tone", "denoise"];

impl Step {
    /// Returns whether pages do not have it: they write no files of this machine, and nothing waits for them.
    pub(super) fn is_of_scripts(&self) -> bool {
        matches!(self, Self::Wait(_) | Self::Save(_) | Self::Window(_) | Self::Adapt | Self::Quit)
    }

    /// Returns the steps that one of a whole gesture consists of.
    pub(super) fn parts(self) -> Vec<Self> {
        let press = |place, button, held| Self::Press { place, button, held };
        match self {
            Self::Click { place, held, double } => {
                let mut parts = vec![press(place, Button::Left, held), Self::Release];
                if double {
                    parts.extend([Self::PressAgain(place), Self::Release]);
                }
                parts
            }
            Self::Drag { from, to, button, held, steps } => {
                let moves = (1..=steps)
                    .map(|step| Self::Move(from.lerp(to, f64::from(step) / f64::from(steps))));
                let begin = std::iter::once(press(from, button, held));
                begin.chain(moves).chain([Self::Release]).collect()
            }
            step => vec![step],
        }
    }
}

impl Viewer {
    /// Executes a step, and returns the action that it needs, if any. Steps that are not the viewer's do nothing.
    ///
    /// # Errors
    /// An option does not exist, or its value cannot be understood.
    pub(super) fn step(&mut self, step: &Step) -> Result<Option<Action>, Failure> {
        let action = match step {
            Step::Size(width, height) => self.handle(Event::Resize(*width, *height)),
            Step::Scale(scale) => self.handle(Event::Scale(*scale)),
            Step::Key(key) => self.handle(Event::Key(key.clone())),
            Step::Press { place, button, held } => {
                self.handle(Event::Pointer(*place));
                self.handle(Event::Press { button: *button, held: *held, double: false })
            }
            Step::PressAgain(place) => {
                self.handle(Event::Pointer(*place));
                let held = Modifiers::default();
                self.handle(Event::Press { button: Button::Left, held, double: true })
            }
            Step::Move(place) => self.handle(Event::Pointer(*place)),
            Step::Release => self.handle(Event::Release),
            Step::Wheel { steps, place, held } => {
                self.handle(Event::Pointer(*place));
                self.handle(Event::Wheel(*steps, *held))
            }
            Step::Turn(degrees) => {
                self.orbit(*degrees);
                None
            }
            Step::Camera(keys) => self.place_camera(keys)?,
            Step::Set(name, values) => self.set_option(name, values)?,
            Step::Frame(frame) => Some(self.go_to_frame(*frame)),
            Step::Hide(name) => self.hide_type(name),
            Step::Show(name) => Some(self.show_type(name)),
            Step::Pick(selections) => Some(Action::Select(selections.clone())),
            Step::Slice(index, distance) => self.move_slice(*index, *distance)?,
            Step::Undo => self.undo(),
            Step::Redo => self.redo(),
            Step::Hover(place) => Some(Action::Pick(self.pixel(*place), Purpose::Hover)),
            Step::Click { .. }
            | Step::Drag { .. }
            | Step::Wait(_)
            | Step::Save(_)
            | Step::Window(_)
            | Step::Adapt
            | Step::Quit => None,
        };
        if !self.is_dragging() {
            self.history.record(self.state(), matches!(step, Step::Wheel { .. } | Step::Slice(..)));
        }
        Ok(action)
    }

    fn orbit(&mut self, degrees: DVec2) {
        self.control.orbit(degrees * std::f64::consts::PI / 180.0);
        self.change();
    }

    /// Places the camera by keys of `[camera]`.
    fn place_camera(&mut self, keys: &str) -> Result<Option<Action>, Failure> {
        if !Camera::is_line(Path::new(keys)) {
            return Err(Failure::View("camera: give keys, as in 'eye = [9, 2, 0]'".to_owned()));
        }
        let camera = Camera::read(Path::new(keys))?;
        let frames = matches!(camera.pose, Pose::Fit { .. });
        self.set_camera(camera);
        Ok(frames.then_some(Action::Frame(None)))
    }

    fn set_option(
        &mut self,
        name: &str,
        values: &[Option<OsString>],
    ) -> Result<Option<Action>, Failure> {
        let mut options = self.content.options.clone();
        options.set(name, values.iter().cloned())?;
        let name = name.trim_start_matches('-');
        match name {
            "preset" => (self.content.preset, self.touched) = (None, LookChanges::default()),
            "background" => self.touched.background = None,
            "depth-cue" => self.touched.depth_cue = None,
            "outline" => self.touched.outline = None,
            "color-by" | "colors" => self.content.color = None,
            _ => (),
        }
        let args = options.args()?;
        self.content.options = options;
        // Without a value it is that of the scene, which is composed anew.
        if OF_IMAGES.contains(&name) && values.iter().any(Option::is_some) {
            let settings = args.render.picture.settings.values().iter();
            let settings = settings.chain(args.render.encoding.display.values());
            let given: Vec<_> = settings.filter(|(own, _)| *own == name).copied().collect();
            self.settings.change(&given);
            if ["exposure", "tone"].contains(&name) {
                self.tone_map();
            } else {
                self.change();
            }
            return Ok(None);
        }
        self.takes_camera |= help::has("camera", name);
        self.takes_settings |= help::has("light", name) || help::has("error", name);
        Ok(Some(Action::Load))
    }

    /// Moves a slice along its normal: those of the option first, then those that were drawn.
    fn move_slice(&mut self, index: usize, distance: f64) -> Result<Option<Action>, Failure> {
        let given: Vec<Option<OsString>> = self.content.options.all("slice");
        if let Some(cut) =
            index.checked_sub(given.len()).and_then(|own| self.content.cuts.get_mut(own))
        {
            cut.point += cut.normal * (distance - cut.point.dot(cut.normal));
            return Ok(Some(Action::Load));
        }
        let Some(slice) = self.facts.slices.get(index).filter(|_| index < given.len()) else {
            return Err(Failure::View(format!("there is no slice {index}")));
        };
        let mut moved = given;
        moved[index] = Some(plane(slice.normal, distance).into());
        self.set_option("slice", &moved)
    }

    pub(super) fn undo(&mut self) -> Option<Action> {
        let state = self.history.undo();
        if state.is_none() {
            self.show_message("nothing to undo");
        }
        state.and_then(|state| self.restore(state))
    }

    pub(super) fn redo(&mut self) -> Option<Action> {
        let state = self.history.redo();
        if state.is_none() {
            self.show_message("nothing to do again");
        }
        state.and_then(|state| self.restore(state))
    }

    /// Returns what is undone and done again.
    pub(super) fn state(&self) -> State {
        State {
            content: self.content.clone(),
            control: self.control.clone(),
            // The size is the page's.
            settings: Settings { width: 0, height: 0, ..self.settings.clone() },
            touched: self.touched,
        }
    }

    /// Returns to a state, in an image of the current size.
    fn restore(&mut self, state: State) -> Option<Action> {
        let State { content, control, settings, touched } = state;
        let (width, height) = (self.settings.width, self.settings.height);
        self.settings = Settings { width, height, ..settings };
        (self.control, self.touched) = (control, touched);
        (self.takes_camera, self.takes_settings) = (false, false);
        self.change();
        let loads = self.content != content;
        self.content = content;
        loads.then_some(Action::Load)
    }
}

/// Returns a plane as the option has it.
fn plane(normal: DVec3, distance: f64) -> String {
    let axes = [("x", DVec3::X), ("y", DVec3::Y), ("z", DVec3::Z)];
    let along = |side: f64| axes.into_iter().find(|(_, axis)| normal == *axis * side);
    match (along(1.0), along(-1.0)) {
        (Some((name, _)), _) => format!("{name}>{distance}"),
        (_, Some((name, _))) => format!("{name}<{}", -distance),
        _ => format!("{},{},{},{distance}", normal.x, normal.y, normal.z),
    }
}
