//! What keys and mouse do: one table for the viewer, and one for its help and the manual.

use super::command::Command;

/// Keys, as events and scripts write them, and what they do. Where OVITO or Blender have a key for
/// something, it is theirs.
pub(super) const BINDINGS: [(&str, Command); 59] = [
    ("?", Command::Help),
    ("f1", Command::Help),
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
    ("5", Command::Project),
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
    ("k", Command::Bar),
    ("x", Command::Slice),
    ("right", Command::Frame(1)),
    ("left", Command::Frame(-1)),
    ("page-down", Command::Frame(10)),
    ("page-up", Command::Frame(-10)),
    ("ctrl+right", Command::Frame(i64::MAX)),
    ("ctrl+left", Command::Frame(i64::MIN)),
    ("]", Command::Samples(1)),
    ("[", Command::Samples(-1)),
    ("tab", Command::Status),
    ("s", Command::Save),
    ("ctrl+s", Command::Save),
    ("esc", Command::Escape),
    ("q", Command::Quit),
    ("ctrl+q", Command::Quit),
    ("ctrl+w", Command::Quit),
];

/// Keys and gestures, and what they do, in words.
pub(super) const HELP: [(&str, &str); 36] = [
    ("left or middle drag", "turn about the pivot"),
    ("right drag, shift+drag", "move across"),
    ("wheel, ctrl+drag", "nearer, farther; the wheel, toward the pointer"),
    ("alt+drag, shift+wheel", "roll; field of view"),
    ("click", "name the sphere, on standard output too"),
    ("double click", "turn about this sphere from now on"),
    ("ctrl+click", "sharpen the lens on this sphere"),
    ("home a", "fit everything into the picture"),
    ("r", "back to the camera of the beginning"),
    ("1 3 7", "from the front, the right, above"),
    ("ctrl+1 ctrl+3 ctrl+7", "from behind, the left, below"),
    ("9 0", "broadside by the principal axes; from a corner"),
    ("5", "parallel or central projection"),
    ("4 6 8 2", "turn by 15 degrees"),
    (", .", "roll by 5 degrees"),
    ("+ = -", "nearer, farther"),
    ("f F", "narrower, wider field of view"),
    ("l L", "open, close the lens"),
    ("e E", "brighter, darker by a third of a stop"),
    ("i", "next integrator"),
    ("m", "next sampler"),
    ("p P", "next, last look, as --preset has them"),
    ("b B", "next, last background: sky, a color, none"),
    ("d o", "fade what is far; contours; on and off"),
    ("c C", "color by the next, the last column"),
    ("h delete", "hide the type of the sphere that was clicked"),
    ("k", "color bar on, off"),
    ("x", "then a drag: cut off the side that is shaded"),
    ("H", "show all types, and what was cut off"),
    ("right left", "next, last frame"),
    ("page-down page-up", "ten frames on, back"),
    ("ctrl+right ctrl+left", "last, first frame"),
    ("] [", "twice, half as many samples in the end"),
    ("tab", "status line on, off"),
    ("s ctrl+s", "save the picture and its scene"),
    ("? f1 esc q ctrl+q ctrl+w", "this help, page by page; close it, quit"),
];

/// What a key does, if anything.
pub(super) fn command(key: &str) -> Option<Command> {
    BINDINGS.iter().find(|binding| binding.0 == key).map(|binding| binding.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two columns of them are in a window of 960 pixels.
    #[test]
    fn explanations_are_short() {
        for (keys, what) in HELP {
            assert!(keys.len() <= 26 && what.len() <= 47, "{what}");
        }
    }

    #[test]
    fn every_key_is_bound_once_and_explained() {
        for (place, (key, _)) in BINDINGS.iter().enumerate() {
            assert!(BINDINGS[..place].iter().all(|other| other.0 != *key), "{key}");
            assert!(HELP.iter().any(|(keys, _)| keys.split(' ').any(|own| own == *key)), "{key}");
        }
    }
}
