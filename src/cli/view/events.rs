//! Events, commands and actions of the viewer.

use glam::{DVec2, DVec3};
use spherule_render::scene::particles::Selection;

/// Events from a page or a script.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Event {
    /// The pointer moved to a position, in pixels from the top left corner.
    Pointer(DVec2),
    /// A button was pressed; `double` for the second press of a double click.
    Press { button: Button, held: Modifiers, double: bool },
    /// The pressed button was released.
    Release,
    /// The wheel turned by a number of steps, positive away from the user.
    Wheel(f64, Modifiers),
    /// A key was pressed, named as in [`super::keys::BINDINGS`].
    Key(String),
    /// The image's size changed, in pixels.
    Resize(u32, u32),
    /// The display's scale factor changed.
    Scale(f64),
}

/// Mouse buttons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Button {
    Left,
    Middle,
    Right,
}

/// Modifier keys.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Modifiers {
    pub(super) shift: bool,
    pub(super) control: bool,
    pub(super) alt: bool,
}

/// Commands of keys. Numbers are steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    /// A part of the page, which shows or hides it by itself.
    Page,
    Fit,
    Reset,
    /// One of the sides of `--view`.
    Side(&'static str),
    ToggleProjection,
    /// Steps to the right and upward.
    Turn(i8, i8),
    Roll(i8),
    Zoom(i8),
    Widen(i8),
    Open(i8),
    Expose(i8),
    Integrator,
    Sampler,
    Preset(i8),
    Background(i8),
    DepthCue,
    Outline,
    Hide,
    ShowAll,
    Color(i8),
    Slice,
    Frame(i64),
    Samples(i8),
    Undo,
    Redo,
    Save,
    Escape,
    Quit,
}

/// Actions that need the scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Action {
    /// Pick the sphere at a pixel, for a purpose.
    Pick((u32, u32), Purpose),
    /// Select the spheres of conditions.
    Select(Vec<Selection>),
    /// Fit everything into view, from a side or from the current direction.
    Frame(Option<&'static str>),
    /// Load the viewer's content.
    Load,
    Save,
    Quit,
}

/// Purposes of picking.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    /// Select it alone.
    Name,
    /// Select it beside others, or no longer.
    Add,
    Pivot,
    Focus,
    /// Tell what is there, and change nothing.
    Hover,
}

/// A picked sphere.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Picked {
    /// Description in one line.
    pub(super) text: String,
    pub(super) kind: Option<String>,
    /// Number of the particle in its file, or row of the sphere in the scene; `None` if the file has another word for it.
    pub(super) id: Option<f64>,
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// Hit point of the ray through the pixel.
    pub(super) point: DVec3,
}
