//! Conversion of window events to viewer events.

use crate::cli::view::events::{Button, Event, Modifiers};
use glam::DVec2;
use std::time::{Duration, Instant};
use winit::event::{ElementState, KeyEvent, MouseButton, MouseScrollDelta, WindowEvent};
use winit::keyboard::{Key, ModifiersState, NamedKey};

/// Maximum time and distance in pixels between the clicks of a double click.
const DOUBLE: (Duration, f64) = (Duration::from_millis(400), 6.0);

/// Pixels per step of a smooth wheel.
const NOTCH: f64 = 40.0;

/// State of pointer, buttons and modifier keys.
#[derive(Default)]
pub(super) struct Input {
    held: Modifiers,
    pointer: DVec2,
    click: Option<(Instant, DVec2)>,
    down: Option<MouseButton>,
}

impl Input {
    /// Converts a window event, if the viewer handles it.
    pub(super) fn event(&mut self, event: &WindowEvent) -> Option<Event> {
        match event {
            WindowEvent::CloseRequested => Some(Event::Close),
            WindowEvent::Resized(size) => Some(Event::Resize(size.width, size.height)),
            WindowEvent::ScaleFactorChanged { scale_factor, .. } => {
                Some(Event::Scale(*scale_factor))
            }
            WindowEvent::ModifiersChanged(modifiers) => {
                self.held = held(modifiers.state());
                None
            }
            WindowEvent::CursorMoved { position, .. } => {
                self.pointer = DVec2::new(position.x, position.y);
                Some(Event::Pointer(self.pointer))
            }
            WindowEvent::MouseInput { state, button, .. } => self.button(*state, *button),
            WindowEvent::MouseWheel { delta, .. } => {
                let steps = match delta {
                    MouseScrollDelta::LineDelta(x, y) => f64::from(if *y == 0.0 { *x } else { *y }),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / NOTCH,
                };
                Some(Event::Wheel(steps, self.held))
            }
            WindowEvent::KeyboardInput { event, .. } if event.state.is_pressed() => self.key(event),
            _ => None,
        }
    }

    /// Tracks one button at a time; others are ignored meanwhile.
    fn button(&mut self, state: ElementState, own: MouseButton) -> Option<Event> {
        if state == ElementState::Released {
            return (self.down.take_if(|down| *down == own)).map(|_| Event::Release);
        }
        let button = match own {
            MouseButton::Left => Button::Left,
            MouseButton::Middle => Button::Middle,
            MouseButton::Right => Button::Right,
            _ => return None,
        };
        if self.down.is_some() {
            return None;
        }
        self.down = Some(own);
        let again = |(at, place): (Instant, DVec2)| {
            at.elapsed() < DOUBLE.0 && place.distance(self.pointer) < DOUBLE.1
        };
        let double = self.click.take().is_some_and(again);
        self.click = (!double).then(|| (Instant::now(), self.pointer));
        Some(Event::Press { button, held: self.held, double })
    }

    fn key(&self, event: &KeyEvent) -> Option<Event> {
        let name = match &event.logical_key {
            Key::Character(text) => text.as_str(),
            Key::Named(named) => match named {
                NamedKey::ArrowLeft => "left",
                NamedKey::ArrowRight => "right",
                NamedKey::PageUp => "page-up",
                NamedKey::PageDown => "page-down",
                NamedKey::Home => "home",
                NamedKey::Tab => "tab",
                NamedKey::Escape => "esc",
                NamedKey::Delete => "delete",
                NamedKey::F1 => "f1",
                _ => return None,
            },
            _ => return None,
        };
        let control = if self.held.control { "ctrl+" } else { "" };
        Some(Event::Key(format!("{control}{name}")))
    }
}

fn held(state: ModifiersState) -> Modifiers {
    Modifiers { shift: state.shift_key(), control: state.control_key(), alt: state.alt_key() }
}
