//! Scripts for the viewer: files with one event per line.

use super::events::{Button, Modifiers};
use super::keys;
use super::viewer::SCALES;
use glam::DVec2;
use spherule_render::image::Format;
use spherule_render::scene::particles::{Fault, Selection};
use spherule_render::suggest;
use std::ffi::OsString;
use std::fmt::Write;
use std::path::PathBuf;

/// Default number of steps of a drag.
const STEPS: u32 = 16;

/// Maximum number of repetitions, and of steps after expanding them.
const MOST: usize = 1 << 20;

/// Commands of scripts and of the page, with their arguments and what they do.
pub(super) const COMMANDS: [(&str, &str, &str); 29] = [
    ("size", "640x360", "set the size of the image"),
    ("scale", "1.5", "set the display's scale factor"),
    ("key", "KEY", "press a key, such as c, F, ctrl+3, home"),
    ("click", "X,Y", "click; may be followed by ctrl, shift or alt"),
    ("double-click", "X,Y", "double click"),
    ("press", "X,Y", "start a drag; followed by the same words as drag, except steps=N"),
    ("move", "X,Y", "move the pointer"),
    ("release", "", "end the drag"),
    (
        "drag",
        "X,Y X,Y",
        "drag; may be followed by left, middle or right, ctrl, shift or alt, steps=N",
    ),
    ("wheel", "STEPS X,Y", "turn the wheel, forward if positive; may be followed by shift"),
    ("turn", "RIGHT UP", "orbit about the pivot by angles in degrees"),
    (
        "set",
        "OPTION [VALUE]...",
        "give an option of render, as in set color-by vx; several values give it repeatedly",
    ),
    ("camera", "'eye = [X,Y,Z], ...'", "place the camera by keys of [camera]"),
    ("unset", "OPTION", "take an option back"),
    ("frame", "N", "go to a frame, from 0"),
    ("hide", "TYPE", "hide a type of particles"),
    ("show", "TYPE", "show a hidden type again"),
    (
        "pick",
        "[CONDITION]...",
        "select the particles of conditions, as in pick 'q < 0'; without one, none",
    ),
    (
        "slice",
        "N DISTANCE",
        "move a slice, from 0, along its normal, to this distance from the origin",
    ),
    ("undo", "", "undo the last change"),
    ("redo", "", "do it again"),
    ("wait", "N", "wait until the image has N samples per pixel"),
    (
        "save",
        "FILE",
        "save the image, by its suffix: SUFFIXES, or as .toml a scene that renders to the same image",
    ),
    ("window", "FILE.png", "save the image as it is shown, a preview, too"),
    ("repeat", "N", "repeat the lines up to end N times; {} in a name is the count, from 000"),
    ("end", "", "end the lines that are repeated"),
    (
        "adapt",
        "",
        "from here on, choose sizes of previews by the clock as the page does, to measure",
    ),
    ("quit", "", "end the script"),
    ("hover", "X,Y", "tell what is at a point of the image"),
];

/// Returns the help for scripts.
pub(super) fn manual() -> String {
    let mut text =
        "Commands of scripts for --headless-script, one per line; # starts a comment:".to_owned();
    for (name, arguments, help) in COMMANDS {
        let help = help.replace("SUFFIXES", &Format::written_suffixes(&[]));
        // Writing to a string cannot fail.
        let _ = write!(text, "\n  {:<30} {help}", format!("{name} {arguments}"));
    }
    text
}

/// A step of a script.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    Size(u32, u32),
    Scale(f64),
    Key(String),
    Click {
        place: DVec2,
        held: Modifiers,
        double: bool,
    },
    Press {
        place: DVec2,
        button: Button,
        held: Modifiers,
    },
    /// The second press of a double click.
    PressAgain(DVec2),
    Move(DVec2),
    Release,
    Drag {
        from: DVec2,
        to: DVec2,
        button: Button,
        held: Modifiers,
        steps: u32,
    },
    Wheel {
        steps: f64,
        place: DVec2,
        held: Modifiers,
    },
    Turn(DVec2),
    /// Place the camera by keys of `[camera]`.
    Camera(String),
    /// Set an option to values; a flag has the value `None`.
    Set(String, Vec<Option<OsString>>),
    Frame(u64),
    Hide(String),
    Show(String),
    /// Select the particles of conditions, one condition after another.
    Pick(Vec<Selection>),
    /// Move a slice along its normal.
    Slice(usize, f64),
    Undo,
    Redo,
    Hover(DVec2),
    Wait(u32),
    Save(PathBuf),
    Window(PathBuf),
    Adapt,
    Quit,
}

/// Parses a script. Returns its steps with their line numbers.
pub(super) fn parse(text: &str) -> Result<Vec<(usize, Step)>, String> {
    let mut lines = Vec::new();
    for (row, line) in text.lines().enumerate() {
        let words = words(line).map_err(|error| format!("line {}: {error}", row + 1))?;
        if !words.is_empty() {
            lines.push((row + 1, words));
        }
    }
    let mut steps = Vec::new();
    let rest = block(&lines, 0, None, &mut steps)?;
    match rest.first() {
        Some((row, _)) => Err(format!("line {row}: `end` without `repeat`")),
        None => Ok(steps),
    }
}

/// Parses one command, as the page sends it.
pub(super) fn command(line: &str) -> Result<Step, String> {
    let words = words(line)?;
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    step(&words, None)
}

/// Returns the words of a line as a shell does: in quotes are spaces, and `#`, part of a word.
pub(super) fn words(line: &str) -> Result<Vec<String>, String> {
    shlex::split(line).ok_or_else(|| "a quote is not closed".to_owned())
}

type Lines<'l> = &'l [(usize, Vec<String>)];

/// Parses up to the `end` of a block, or of the file, and returns the rest.
fn block<'l>(
    mut lines: Lines<'l>,
    depth: usize,
    count: Option<usize>,
    steps: &mut Vec<(usize, Step)>,
) -> Result<Lines<'l>, String> {
    while let Some(((row, words), rest)) = lines.split_first() {
        let at = |message: String| format!("line {row}: {message}");
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        lines = match words[..] {
            ["end"] => return Ok(if depth == 0 { lines } else { rest }),
            ["repeat", times] => {
                let times = number::<usize>(times).map_err(at)?;
                let mut after = rest;
                for count in 0..times.max(1) {
                    after = block(rest, depth + 1, Some(count), steps)?;
                    if steps.len() > MOST {
                        return Err(at(format!("more than {MOST} steps")));
                    }
                }
                after
            }
            _ => {
                steps.push((*row, step(&words, count).map_err(at)?));
                rest
            }
        };
    }
    if depth > 0 { Err("the last `repeat` has no `end`".to_owned()) } else { Ok(lines) }
}

fn step(words: &[&str], count: Option<usize>) -> Result<Step, String> {
    Ok(match words {
        ["size", size] => {
            let (width, height) = pair(size, 'x')?;
            Step::Size(width, height)
        }
        ["scale", scale] => {
            let scale = finite(scale)?;
            if !SCALES.contains(&scale) {
                let (least, most) = (SCALES.start(), SCALES.end());
                return Err(format!("scale {scale} is out of range, {least} to {most}"));
            }
            Step::Scale(scale)
        }
        ["key", key] if keys::command(key).is_some() => Step::Key((*key).to_owned()),
        ["key", key] => {
            let near = suggest::question(key, keys::BINDINGS.iter().map(|binding| binding.0));
            return Err(format!("`{key}` is not a bound key{near}"));
        }
        ["click", at, held @ ..] => {
            Step::Click { place: place(at)?, held: Words::of(held)?.held, double: false }
        }
        ["double-click", at] => {
            Step::Click { place: place(at)?, held: Modifiers::default(), double: true }
        }
        ["press", at, how @ ..] => {
            let Words { button, held, .. } = Words::of(how)?;
            Step::Press { place: place(at)?, button, held }
        }
        ["move", at] => Step::Move(place(at)?),
        ["release"] => Step::Release,
        ["drag", from, to, how @ ..] => {
            let Words { button, held, steps } = Words::of(how)?;
            Step::Drag { from: place(from)?, to: place(to)?, button, held, steps }
        }
        ["wheel", steps, at, held @ ..] => {
            let held = Words::of(held)?.held;
            Step::Wheel { steps: finite(steps)?, place: place(at)?, held }
        }
        ["turn", right, up] => Step::Turn(DVec2::new(finite(right)?, finite(up)?)),
        ["camera", keys] => Step::Camera((*keys).to_owned()),
        ["set", name] => Step::Set((*name).to_owned(), vec![None]),
        ["set", name, values @ ..] => {
            let values = values.iter().map(|value| Some(OsString::from(value))).collect();
            Step::Set((*name).to_owned(), values)
        }
        ["unset", name] => Step::Set((*name).to_owned(), Vec::new()),
        ["frame", index] => Step::Frame(number(index)?),
        ["hide", name] => Step::Hide((*name).to_owned()),
        ["show", name] => Step::Show((*name).to_owned()),
        ["pick", conditions @ ..] => {
            let parse = |text: &&str| text.parse().map_err(|fault: Fault| fault.message);
            Step::Pick(conditions.iter().map(parse).collect::<Result<_, _>>()?)
        }
        ["slice", index, distance] => Step::Slice(number(index)?, finite(distance)?),
        ["undo"] => Step::Undo,
        ["redo"] => Step::Redo,
        ["hover", at] => Step::Hover(place(at)?),
        ["wait", samples] => Step::Wait(number::<u32>(samples)?.max(1)),
        ["save", name] => Step::Save(named(name, count)),
        ["window", name] => Step::Window(named(name, count)),
        ["adapt"] => Step::Adapt,
        ["quit"] => Step::Quit,
        [first, ..] => {
            let near = suggest::question(first, COMMANDS.map(|(name, ..)| name));
            return Err(format!("unknown command `{first}`; see spherule view --help{near}"));
        }
        [] => return Err("nothing".to_owned()),
    })
}

/// Parses the words after the points of a drag.
struct Words {
    button: Button,
    held: Modifiers,
    steps: u32,
}

impl Words {
    fn of(words: &[&str]) -> Result<Self, String> {
        let mut all = Self { button: Button::Left, held: Modifiers::default(), steps: STEPS };
        for word in words {
            match *word {
                "left" => all.button = Button::Left,
                "middle" => all.button = Button::Middle,
                "right" => all.button = Button::Right,
                "shift" => all.held.shift = true,
                "ctrl" => all.held.control = true,
                "alt" => all.held.alt = true,
                other => {
                    let steps = other.strip_prefix("steps=").ok_or_else(|| {
                        let words = ["left", "middle", "right", "shift", "ctrl", "alt"];
                        let near = suggest::question(other, words);
                        format!(
                            "`{other}` is neither a button, nor a modifier key, nor steps=N{near}"
                        )
                    })?;
                    all.steps = number::<u32>(steps)?.clamp(1, MOST as u32);
                }
            }
        }
        Ok(all)
    }
}

/// `{}` is the number of the repetition, from 0.
fn named(name: &str, count: Option<usize>) -> PathBuf {
    PathBuf::from(name.replace("{}", &format!("{:03}", count.unwrap_or(0))))
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("`{text}` is not a non-negative integer"))
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("`{text}` is not a number"))
}

fn pair<T: std::str::FromStr>(text: &str, between: char) -> Result<(T, T), String> {
    let parts =
        text.split_once(between).and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    parts.ok_or_else(|| format!("`{text}`: expected two numbers separated by {between}"))
}

fn place(text: &str) -> Result<DVec2, String> {
    let (x, y): (f64, f64) = pair(text, ',')?;
    let place = DVec2::new(x, y);
    if place.is_finite() { Ok(place) } else { Err(format!("`{text}` is not a position")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_read_and_repeated() {
        let text = "size 64x48 # small\n\nrepeat 2\n turn 10 0\n save a-{}.png\nend\nquit";
        let steps: Vec<Step> = parse(text).unwrap().into_iter().map(|(_, step)| step).collect();
        let turn = || Step::Turn(DVec2::new(10.0, 0.0));
        let save = |name: &str| Step::Save(PathBuf::from(name));
        let expected =
            [Step::Size(64, 48), turn(), save("a-000.png"), turn(), save("a-001.png"), Step::Quit];
        assert_eq!(steps, expected);
        let set = parse("set style 'H: color=red # x' \"O: color=blue\" # two").unwrap();
        let values = ["H: color=red # x", "O: color=blue"].map(|text| Some(text.into()));
        assert_eq!(set, [(1, Step::Set("style".into(), values.to_vec()))]);
        assert_eq!(command("unset cell"), Ok(Step::Set("cell".into(), vec![])));
        let drag = parse("drag 1,2 3.5,4 right ctrl steps=3").unwrap();
        let held = Modifiers { control: true, ..Modifiers::default() };
        let (from, to) = (DVec2::new(1.0, 2.0), DVec2::new(3.5, 4.0));
        let expected = Step::Drag { from, to, button: Button::Right, held, steps: 3 };
        assert_eq!(drag, [(1, expected)]);
    }

    #[test]
    fn errors_have_line_numbers() {
        for (text, line) in [
            ("wait 1\njump", "line 2"),
            ("key ctrl+alt+9", "line 1"),
            ("drag 1,2 3", "line 1"),
            ("scale 0", "line 1"),
            ("scale nan", "line 1"),
            ("press 1", "line 1"),
            ("drag 1,2 3,4 up", "line 1"),
            ("wheel nan 1,1", "line 1"),
            ("repeat 1000000\nrepeat 1000000\nquit\nend\nend", "line 2"),
            ("end", "line 1"),
            ("repeat 2\nquit", "repeat"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.contains(line), "{text}: {error}");
        }
        for (text, near) in
            [("kye c", "`key`"), ("key homee", "`home`"), ("drag 1,1 2,2 lfet", "`left`")]
        {
            let error = parse(text).unwrap_err();
            assert!(error.contains(near), "{text}: {error}");
        }
        for (name, arguments, _) in COMMANDS {
            let error = parse(&format!("{name} \"")).unwrap_err();
            assert!(error.contains("line 1"), "{name} {arguments}: {error}");
        }
    }
}
