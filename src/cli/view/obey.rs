//! What a viewer does when a key is pressed.

use super::command::{Action, Command};
use super::help;
use super::rig::Rig;
use super::viewer::{Touched, Viewer, WIDER};
use glam::DVec2;
use spherule::scene::{Background, Camera, Integrator, Pose, Preset, Rgb, SamplerKind, Settings};

/// Degrees.
const TURN: f64 = 15.0;
const ROLL: f64 = 5.0;

/// Factors.
const ZOOM: f64 = 0.8;
const OPEN: f64 = 1.25;

/// Stops.
const EXPOSURE: f64 = 1.0 / 3.0;

const BACKGROUNDS: [(&str, Background); 4] = [
    ("the sky", Background::Sky),
    ("white", Background::Color(Rgb::ONE)),
    ("black", Background::Color(Rgb::ZERO)),
    ("transparent", Background::Transparent),
];

const INTEGRATORS: [(&str, Integrator); 3] = [
    ("path", Integrator::Path),
    ("whitted", Integrator::Whitted { shadow_samples: 16 }),
    ("ao", Integrator::Ao { distance: f64::INFINITY }),
];

const SAMPLERS: [(&str, SamplerKind); 3] = [
    ("sobol", SamplerKind::Sobol),
    ("stratified", SamplerKind::Stratified),
    ("independent", SamplerKind::Independent),
];

/// Most samples of a pixel that can be asked for.
const MOST: u32 = 1 << 20;

impl Viewer {
    /// Does what a key says, and says what others have to do for it.
    pub(super) fn obey(&mut self, command: Command) -> Option<Action> {
        match command {
            Command::Help => self.next_page(),
            Command::Status => self.status = !self.status,
            Command::Escape if self.cutting => self.cutting = false,
            Command::Escape if self.help.is_some() => self.help = None,
            Command::Escape | Command::Quit => return Some(Action::Quit),
            Command::Slice => {
                self.cutting = true;
                self.say("drag a line: the side that is shaded goes");
            }
            Command::Fit => return Some(Action::Frame(None)),
            Command::Side(side) => return Some(Action::Frame(Some(side))),
            Command::Save => return Some(Action::Save),
            Command::Expose(steps) => self.expose(steps),
            Command::Integrator => self.next_integrator(),
            Command::Sampler => self.next_sampler(),
            Command::Samples(steps) => self.ask_for_samples(steps),
            Command::Preset(step) => return Some(self.next_preset(step)),
            Command::Background(step) => self.next_background(step),
            Command::DepthCue | Command::Outline => self.toggle(command),
            Command::Color(step) => return Some(self.next_color(step)),
            Command::Bar => self.toggle_bar(),
            Command::Frame(step) => return self.next_frame(step),
            Command::Hide => return self.hide(),
            Command::ShowAll => {
                self.content.hidden.clear();
                self.content.cuts.clear();
                self.say("everything is shown");
                return Some(Action::Load);
            }
            motion => self.steer(motion),
        }
        None
    }

    /// Tells something in the status line.
    pub(super) fn say(&mut self, message: impl Into<String>) {
        self.message = message.into();
    }

    /// Shows the first or the next page of the help, and nothing after the last.
    fn next_page(&mut self) {
        let size = (self.settings.width, self.settings.height);
        let next = self.help.map_or(0, |page| page + 1);
        self.help = (next < help::pages(size, self.scale)).then_some(next);
    }

    fn toggle_bar(&mut self) {
        self.bar = !self.bar;
        self.say(match (&self.facts.legend, self.facts.color_bar) {
            (None, _) => "no numbers are colored: press c",
            (_, true) => "the color bar is part of the picture",
            (_, false) if self.bar => "color bar: on",
            _ => "color bar: off",
        });
    }

    /// Moves the camera by steps.
    fn steer(&mut self, command: Command) {
        let rig = &mut self.rig;
        match command {
            Command::Reset => *rig = rig.with_camera(self.home.clone()),
            Command::Project => rig.project(),
            Command::Turn(x, y) => {
                rig.orbit(DVec2::new(f64::from(x), f64::from(y)) * TURN.to_radians());
            }
            Command::Roll(steps) => rig.roll(f64::from(steps) * ROLL.to_radians()),
            Command::Zoom(steps) => rig.zoom(ZOOM.powi(steps.into()), DVec2::ZERO),
            Command::Widen(steps) => rig.widen(WIDER.powi(steps.into())),
            Command::Open(steps) => rig.open(OPEN.powi(steps.into())),
            _ => return,
        }
        self.change();
    }

    /// Stands where everything is framed, or wherever it is told.
    pub(super) fn stand(&mut self, camera: Camera) {
        self.rig = self.rig.with_camera(camera);
        self.change();
    }

    /// The same picture, brighter or darker.
    fn expose(&mut self, steps: i8) {
        // In thirds, so that there and back is the same number.
        let thirds = (self.settings.exposure / EXPOSURE).round() + f64::from(steps);
        let exposures = Settings::EXPOSURES;
        let exposure = (thirds * EXPOSURE).clamp(*exposures.start(), *exposures.end());
        self.settings.exposure = exposure;
        self.say(format!("exposure {:+.2} stops", self.settings.exposure));
    }

    fn next_integrator(&mut self) {
        let same = |row: &(&str, Integrator)| {
            std::mem::discriminant(&row.1) == std::mem::discriminant(&self.settings.integrator)
        };
        let now = INTEGRATORS.iter().position(same).unwrap_or(0);
        let (name, integrator) = INTEGRATORS[(now + 1) % INTEGRATORS.len()];
        self.settings.integrator = integrator;
        self.say(format!("integrator {name}"));
        self.change();
    }

    fn next_sampler(&mut self) {
        let now = SAMPLERS.iter().position(|row| row.1 == self.settings.sampler).unwrap_or(0);
        let (name, sampler) = SAMPLERS[(now + 1) % SAMPLERS.len()];
        self.settings.sampler = sampler;
        self.say(format!("sampler {name}"));
        self.change();
    }

    fn ask_for_samples(&mut self, steps: i8) {
        let spp = self.settings.spp;
        self.settings.spp = if steps > 0 { (spp * 2).min(MOST) } else { (spp / 2).max(1) };
        self.say(format!("up to {} samples", self.settings.spp));
    }

    fn next_preset(&mut self, step: i8) -> Action {
        let now = self.content.preset.as_ref().map(|preset| preset.0);
        let next = cycled(&Preset::ALL, now.as_ref(), step).copied();
        let name = next.map_or("the scene's own look", Preset::name);
        self.say(name);
        self.touched = Touched::default();
        if let Some(preset) = next {
            self.settings.integrator = preset.integrator(self.facts.own_materials);
        }
        // Lights stand by the camera that looks now, level.
        let camera = Camera { up: self.rig.vertical(), ..self.rig.camera.clone() };
        self.content.preset = next.map(|preset| (preset, camera));
        Action::Load
    }

    fn next_background(&mut self, step: i8) {
        let now = self.look().background;
        let place = BACKGROUNDS.iter().position(|row| row.1 == now).unwrap_or(0) as i64;
        let next = (place + i64::from(step)).rem_euclid(BACKGROUNDS.len() as i64);
        let (name, background) = BACKGROUNDS[next as usize];
        self.touched.background = Some(background);
        self.say(format!("background: {name}"));
        self.change();
    }

    /// Turns a part of what is drawn over pictures on or off.
    fn toggle(&mut self, command: Command) {
        let look = self.look();
        let (name, on) = if command == Command::DepthCue {
            self.touched.depth_cue = Some(!look.depth_cue);
            ("what is far fades", !look.depth_cue)
        } else {
            self.touched.outline = Some(!look.outline);
            ("contours", !look.outline)
        };
        self.say(format!("{name}: {}", if on { "on" } else { "off" }));
        self.change();
    }

    fn next_color(&mut self, step: i8) -> Action {
        let next = cycled(&self.facts.columns, self.content.color.as_ref(), step).cloned();
        self.say(match &next {
            Some(column) => format!("colors by {column}"),
            None => "the usual colors".to_owned(),
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
            self.say("there are no more frames");
            return None;
        }
        self.content.frame = Some(next);
        self.say(format!("frame {next}"));
        Some(Action::Load)
    }

    fn hide(&mut self) -> Option<Action> {
        let Some(name) = self.named.take() else {
            self.say("click a sphere: its type is hidden then");
            return None;
        };
        self.say(format!("{name} is hidden; H shows all"));
        self.content.hidden.push(name);
        Some(Action::Load)
    }
}

/// The value after, or before, the one there is; none comes between the last and the first.
fn cycled<'a, T: PartialEq>(values: &'a [T], now: Option<&T>, step: i8) -> Option<&'a T> {
    let place = now.and_then(|now| values.iter().position(|value| value == now));
    let all = values.len() as i64 + 1;
    let next = (place.map_or(0, |place| place as i64 + 1) + i64::from(step)).rem_euclid(all);
    usize::try_from(next - 1).ok().and_then(|place| values.get(place))
}

impl Rig {
    /// The same way of moving with another camera.
    fn with_camera(&self, camera: Camera) -> Self {
        let distance = match camera.pose {
            Pose::LookAt { eye, target } => eye.distance(target),
            Pose::Fit { .. } => 1.0,
        };
        let mut rig = Self::new(camera, distance);
        rig.resize(self.size());
        rig
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_go_through_all_and_none() {
        let values = [1, 2, 3];
        let mut now = None;
        let seen: Vec<Option<i32>> = (0..5)
            .map(|_| {
                now = cycled(&values, now.as_ref(), 1).copied();
                now
            })
            .collect();
        assert_eq!(seen, [Some(1), Some(2), Some(3), None, Some(1)]);
        assert_eq!(cycled(&values, None, -1), Some(&3));
        assert_eq!(cycled(&values, Some(&1), -1), None);
        assert_eq!(cycled(&[] as &[i32], None, 1), None);
    }
}
