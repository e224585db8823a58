//! What can happen to a viewer, and what it can be told to do.

use glam::DVec2;

/// What happens to a viewer, from a window or a script.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Event {
    /// The pointer is here, in pixels from the top left corner.
    Pointer(DVec2),
    /// A button goes down; for the second time in a short while, if `double`.
    Press { button: Button, held: Held, double: bool },
    /// The button that went down comes up.
    Release,
    /// The wheel turns by so many steps, away from the user if positive.
    Wheel(f64, Held),
    /// A key, as [`super::keys::BINDINGS`] has them.
    Key(String),
    /// The window has this size, in pixels.
    Resize(u32, u32),
    /// The display's scale, by which letters are larger.
    Scale(f64),
    /// The window is to close.
    #[cfg(feature = "view")]
    Close,
}

/// A button of the mouse.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Button {
    Left,
    Middle,
    Right,
}

/// Keys that are held down meanwhile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Held {
    pub(super) shift: bool,
    pub(super) control: bool,
    pub(super) alt: bool,
}

/// What a key does. Numbers are steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    Help,
    Fit,
    Reset,
    /// One of the sides of `--view`.
    Side(&'static str),
    Project,
    /// To the right and upward.
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
    Bar,
    Slice,
    Frame(i64),
    Samples(i8),
    Status,
    Save,
    Escape,
    Quit,
}

/// What only those can do who have the scene.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Action {
    /// Say which sphere is at this pixel, and do with it what the purpose is.
    Pick((u32, u32), Purpose),
    /// Frame everything from a side, or from where the camera stands.
    Frame(Option<&'static str>),
    /// Load what the viewer wants to show.
    Load,
    Save,
    Quit,
}

/// Why someone wants to know what is at a pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    Name,
    Pivot,
    Focus,
}
