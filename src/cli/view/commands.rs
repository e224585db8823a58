//! Execution of the viewer's commands.

use super::camera_control::CameraControl;
use super::content::LookChanges;
use super::events::{Action, Command};
use super::viewer::{Viewer, WIDER};
use glam::DVec2;
use spherule_render::scene::{Background, Camera, Pose, Preset, Rgb, Settings};
use spherule_render::settings::{INTEGRATORS, Names, SAMPLERS};

/// Angles of commands, in degrees.
const TURN: f64 = 15.0;
const ROLL: f64 = 5.0;

/// Factors of commands.
const ZOOM: f64 = 0.8;
const OPEN: f64 = 1.25;

/// Stops.
const EXPOSURE: f64 = 1.0 / 3.0;

const BACKGROUNDS: [(&str, Background); 4] = [
    ("sky", Background::Sky),
    ("white", Background::Color(Rgb::ONE)),
    ("black", Background::Color(Rgb::ZERO)),
    ("transparent", Background::Transparent),
];

/// Maximum number of samples per pixel.
const MOST: u32 = 1 << 20;

impl Viewer {
    /// Executes a command, and returns the action that it needs, if any.
    pub(super) fn execute(&mut self, command: Command) -> Option<Action> {
        match command {
            Command::Page => (),
            Command::Escape if self.cutting => self.cutting = false,
            Command::Escape if !self.picked.is_empty() => self.picked.clear(),
            Command::Escape | Command::Quit => return Some(Action::Quit),
            Command::Slice => {
                self.cutting = true;
                self.show_message("drag a line; the shaded side is cut away");
            }
            Command::Fit => return Some(Action::Frame(None)),
            Command::Side(side) => return Some(Action::Frame(Some(side))),
            Command::Save => return Some(Action::Save),
            Command::Expose(steps) => self.change_exposure(steps),
            Command::Integrator => self.next_integrator(),
            Command::Sampler => self.next_sampler(),
            Command::Samples(steps) => self.change_samples(steps),
            Command::Preset(step) => return Some(self.next_preset(step)),
            Command::Background(step) => self.next_background(step),
            Command::DepthCue | Command::Outline => self.toggle(command),
            Command::Color(step) => return Some(self.next_color(step)),
            Command::Frame(step) => return self.next_frame(step),
            Command::Undo => return self.undo(),
            Command::Redo => return self.redo(),
            Command::Hide => return self.hide(),
            Command::ShowAll => {
                self.content.hidden.clear();
                self.content.cuts.clear();
                self.show_message("everything is visible");
                return Some(Action::Load);
            }
            motion => self.move_camera(motion),
        }
        None
    }

    /// Shows a message in the status line.
    pub(super) fn show_message(&mut self, message: impl Into<String>) {
        self.message = message.into();
    }

    /// Moves the camera.
    fn move_camera(&mut self, command: Command) {
        let control = &mut self.control;
        match command {
            Command::Reset => *control = control.with_camera(self.home.clone()),
            Command::ToggleProjection => control.toggle_projection(),
            Command::Turn(x, y) => {
                control.orbit(DVec2::new(f64::from(x), f64::from(y)) * TURN.to_radians());
            }
            Command::Roll(steps) => control.roll(f64::from(steps) * ROLL.to_radians()),
            Command::Zoom(steps) => control.zoom(ZOOM.powi(steps.into()), DVec2::ZERO),
            Command::Widen(steps) => control.scale_field_of_view(WIDER.powi(steps.into())),
            Command::Open(steps) => control.scale_aperture(OPEN.powi(steps.into())),
            _ => return,
        }
        self.change();
    }

    /// Sets the camera.
    pub(super) fn set_camera(&mut self, camera: Camera) {
        self.control = self.control.with_camera(camera);
        self.change();
    }

    /// Changes the exposure.
    fn change_exposure(&mut self, steps: i8) {
        // In thirds of a stop, so that a step back restores the same number.
        let thirds = (self.settings.exposure / EXPOSURE).round() + f64::from(steps);
        let exposures = Settings::EXPOSURES;
        let exposure = (thirds * EXPOSURE).clamp(*exposures.start(), *exposures.end());
        self.settings.exposure = exposure;
        self.tone_map();
        self.show_message(format!("exposure {:+.2} stops", self.settings.exposure));
    }

    fn next_integrator(&mut self) {
        let (name, integrator) = next(&INTEGRATORS, &self.settings.integrator);
        self.settings.integrator = integrator;
        self.show_message(format!("integrator {name}"));
        self.change();
    }

    fn next_sampler(&mut self) {
        let (name, sampler) = next(&SAMPLERS, &self.settings.sampler);
        self.settings.sampler = sampler;
        self.show_message(format!("sampler {name}"));
        self.change();
    }

    fn change_samples(&mut self, steps: i8) {
        let spp = self.settings.spp;
        self.settings.spp = if steps > 0 { (spp * 2).min(MOST) } else { (spp / 2).max(1) };
        self.show_message(format!("up to {} samples", self.settings.spp));
    }

    fn next_preset(&mut self, step: i8) -> Action {
        let now = self.content.preset.as_ref().map(|preset| preset.0).or(self.facts.preset);
        let next = match next_value(&Preset::ALL, now.as_ref(), step) {
            // Particles always have a preset.
            None if self.facts.preset.is_some() => next_value(&Preset::ALL, None, step),
            next => next,
        };
        let next = next.copied();
        let name = next.map_or("style of the scene", Preset::name);
        self.show_message(name);
        self.touched = LookChanges::default();
        if let Some(preset) = next {
            self.settings.integrator = preset.integrator(self.facts.own_materials);
        }
        // Lights are placed for the current camera, without its roll.
        let camera = Camera { up: self.control.vertical(), ..self.control.camera.clone() };
        self.content.preset = next.map(|preset| (preset, camera));
        Action::Load
    }

    fn next_background(&mut self, step: i8) {
        let now = self.look().background;
        let place = BACKGROUNDS.iter().position(|row| row.1 == now).unwrap_or(0) as i64;
        let next = (place + i64::from(step)).rem_euclid(BACKGROUNDS.len() as i64);
        let (name, background) = BACKGROUNDS[next as usize];
        self.touched.background = Some(background);
        self.show_message(format!("background: {name}"));
        self.change();
    }

    /// Turns a part of the overlays on or off.
    fn toggle(&mut self, command: Command) {
        let look = self.look();
        let (name, on) = if command == Command::DepthCue {
            self.touched.depth_cue = Some(!look.depth_cue);
            ("depth cue", !look.depth_cue)
        } else {
            self.touched.outline = Some(!look.outline);
            ("contours", !look.outline)
        };
        self.show_message(format!("{name}: {}", if on { "on" } else { "off" }));
        self.change();
    }

    fn next_color(&mut self, step: i8) -> Action {
        let next = next_value(&self.facts.columns, self.content.color.as_ref(), step).cloned();
        self.show_message(match &next {
            Some(column) => format!("color by {column}"),
            None => "default colors".to_owned(),
        });
        self.content.color = next;
        Action::Load
    }

    fn next_frame(&mut self, step: i64) -> Option<Action> {
        let last = self.facts.frames.map_or(u64::MAX, |count| count.saturating_sub(1));
        let now = self.content.frame.unwrap_or(self.facts.frame);
        let next = match step {
            i64::MAX if self.facts.frames.is_none() => now,
            step => now.saturating_add_signed(step).min(last),
        };
        if next == now {
            self.show_message("no more frames");
            return None;
        }
        Some(self.go_to_frame(next))
    }

    /// Goes to a frame, from 0; to the last one if there are not as many.
    pub(super) fn go_to_frame(&mut self, frame: u64) -> Action {
        let last = self.facts.frames.map_or(u64::MAX, |count| count.saturating_sub(1));
        let frame = frame.min(last);
        self.content.frame = Some(frame);
        self.show_message(format!("frame {frame}"));
        Action::Load
    }

    fn hide(&mut self) -> Option<Action> {
        let Some(name) = self.named.take() else {
            self.show_message("click a sphere to hide its type");
            return None;
        };
        self.hide_type(&name)
    }

    /// Hides a type.
    pub(super) fn hide_type(&mut self, name: &str) -> Option<Action> {
        if !self.facts.types.iter().any(|own| own == name) {
            self.show_message(format!("there is no type {name}"));
            return None;
        }
        self.content.hidden.retain(|own| own != name);
        self.content.hidden.push(name.to_owned());
        self.show_message(format!("{name} hidden; press H to show all"));
        Some(Action::Load)
    }

    /// Shows a hidden type again.
    pub(super) fn show_type(&mut self, name: &str) -> Action {
        self.content.hidden.retain(|own| own != name);
        self.show_message(format!("{name} shown"));
        Action::Load
    }
}

/// Returns the value after this one, and its name.
fn next<T: Clone>(names: &Names<T>, now: &T) -> (&'static str, T) {
    let name = names.name(now);
    let row = names.0.iter().position(|row| row.0 == name).map_or(0, |row| row + 1);
    let (name, value, _) = &names.0[row % names.0.len()];
    (name, value.clone())
}

/// Returns the next or previous value; `None` is between the last and the first.
fn next_value<'a, T: PartialEq>(values: &'a [T], now: Option<&T>, step: i8) -> Option<&'a T> {
    let place = now.and_then(|now| values.iter().position(|value| value == now));
    let all = values.len() as i64 + 1;
    let next = (place.map_or(0, |place| place as i64 + 1) + i64::from(step)).rem_euclid(all);
    usize::try_from(next - 1).ok().and_then(|place| values.get(place))
}

impl CameraControl {
    /// Replaces the camera, with the same controls.
    fn with_camera(&self, camera: Camera) -> Self {
        let distance = match camera.pose {
            Pose::LookAt { eye, target } => eye.distance(target),
            Pose::Fit { .. } => 1.0,
        };
        let mut control = Self::new(camera, distance);
        control.resize(self.size());
        control
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_include_all_values_and_none() {
        let values = [1, 2, 3];
        let mut now = None;
        let seen: Vec<Option<i32>> = (0..5)
            .map(|_| {
                now = next_value(&values, now.as_ref(), 1).copied();
                now
            })
            .collect();
        assert_eq!(seen, [Some(1), Some(2), Some(3), None, Some(1)]);
        assert_eq!(next_value(&values, None, -1), Some(&3));
        assert_eq!(next_value(&values, Some(&1), -1), None);
        assert_eq!(next_value(&[] as &[i32], None, 1), None);
    }
}
