//! Key bindings, and the help for keys and mouse.

use super::events::Command;

/// Key bindings, with the names of keys in events and scripts. Keys are those of OVITO or Blender, where they
/// have one.
pub(super) const BINDINGS: [(&str, Command); 62] = [
    ("?", Command::Page),
    ("f1", Command::Page),
    ("home", Command::Fit),
    ("a", Command::Fit),
    ("r", Command::Reset),
    ("1", Command::Side("-y")),
    ("ctrl+1", Command::Side("y")),
    ("3", Command::Side("x")),
    ("ctrl+3", Command::Side("-x")),
    ("7", Command::Side("z")),
    ("ctrl+7", Command::Side("-z")),
    ("0", Command::Side("iso")),
    ("9", Command::Side("auto")),
    ("5", Command::ToggleProjection),
    ("4", Command::Turn(-1, 0)),
    ("6", Command::Turn(1, 0)),
    ("8", Command::Turn(0, 1)),
    ("2", Command::Turn(0, -1)),
    (",", Command::Roll(-1)),
    (".", Command::Roll(1)),
    ("+", Command::Zoom(1)),
    ("=", Command::Zoom(1)),
    ("-", Command::Zoom(-1)),
    ("f", Command::Widen(-1)),
    ("F", Command::Widen(1)),
    ("l", Command::Open(1)),
    ("L", Command::Open(-1)),
    ("e", Command::Expose(1)),
    ("E", Command::Expose(-1)),
    ("i", Command::Integrator),
    ("m", Command::Sampler),
    ("p", Command::Preset(1)),
    ("P", Command::Preset(-1)),
    ("b", Command::Background(1)),
    ("B", Command::Background(-1)),
    ("d", Command::DepthCue),
    ("o", Command::Outline),
    ("h", Command::Hide),
    ("delete", Command::Hide),
    ("H", Command::ShowAll),
    ("c", Command::Color(1)),
    ("C", Command::Color(-1)),
    ("k", Command::Page),
    ("x", Command::Slice),
    ("right", Command::Frame(1)),
    ("left", Command::Frame(-1)),
    ("page-down", Command::Frame(10)),
    ("page-up", Command::Frame(-10)),
    ("ctrl+right", Command::Frame(i64::MAX)),
    ("ctrl+left", Command::Frame(i64::MIN)),
    ("]", Command::Samples(1)),
    ("[", Command::Samples(-1)),
    ("tab", Command::Page),
    ("ctrl+z", Command::Undo),
    ("ctrl+y", Command::Redo),
    ("ctrl+shift+z", Command::Redo),
    ("s", Command::Save),
    ("ctrl+s", Command::Save),
    ("esc", Command::Escape),
    ("q", Command::Quit),
    ("ctrl+q", Command::Quit),
    ("ctrl+w", Command::Quit),
];

/// Keys and gestures with explanations.
pub(super) const HELP: [(&str, &str); 40] = [
    ("left or middle drag", "orbit about the pivot"),
    ("right drag, shift+drag", "pan"),
    ("wheel, ctrl+drag", "zoom; the wheel, toward the pointer"),
    ("alt+drag, shift+wheel", "roll; field of view"),
    ("click", "select the sphere, and tell what it is, also on standard output"),
    ("shift+click", "select several spheres; two to four are measured"),
    ("double click", "make this sphere the pivot"),
    ("ctrl+click", "focus the lens on this sphere"),
    ("home a", "fit everything into view"),
    ("r", "reset the camera"),
    ("1 3 7", "front, right, top view"),
    ("ctrl+1 ctrl+3 ctrl+7", "back, left, bottom view"),
    ("9 0", "view by the principal axes; isometric view"),
    ("5", "perspective or orthographic projection"),
    ("4 6 8 2", "orbit by 15 degrees"),
    (", .", "roll by 5 degrees"),
    ("+ = -", "zoom in, out"),
    ("f F", "decrease, increase the field of view"),
    ("l L", "increase, decrease the aperture"),
    ("e E", "increase, decrease exposure by 1/3 stop"),
    ("i", "next integrator"),
    ("m", "next sampler"),
    ("p P", "next, previous preset, as --preset"),
    ("b B", "next, previous background"),
    ("d o", "depth cue; contours; on, off"),
    ("c C", "color by the next, previous column"),
    ("h delete", "hide the type of the clicked sphere"),
    ("k", "color bar on, off"),
    ("x", "then drag: cut away the shaded side"),
    ("H", "show all types, and what was cut away"),
    ("right left", "next, previous frame"),
    ("page-down page-up", "ten frames forward, back"),
    ("ctrl+right ctrl+left", "last, first frame"),
    ("] [", "double, halve the samples per pixel"),
    ("tab", "panel on, off"),
    ("ctrl+z", "undo"),
    ("ctrl+y ctrl+shift+z", "redo"),
    ("s ctrl+s", "save the image and its scene"),
    ("? f1", "this help"),
    ("esc q ctrl+q ctrl+w", "end a script"),
];

/// Returns the command of a key.
pub(super) fn command(key: &str) -> Option<Command> {
    BINDINGS.iter().find(|binding| binding.0 == key).map(|binding| binding.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_key_is_bound_once_and_explained() {
        for (place, (key, _)) in BINDINGS.iter().enumerate() {
            assert!(BINDINGS[..place].iter().all(|other| other.0 != *key), "{key}");
            assert!(HELP.iter().any(|(keys, _)| keys.split(' ').any(|own| own == *key)), "{key}");
        }
    }
}
