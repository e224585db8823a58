//! Events in a file, line by line: what a script does to a viewer.

use super::command::{Button, Held};
use super::keys;
use super::viewer::SCALES;
use glam::DVec2;
use spherule::image::Format;
use spherule::suggest;
use std::path::PathBuf;

/// Steps of a drag that does not say how many.
const STEPS: u32 = 16;

/// Most repetitions, and most lines that they make.
const MOST: usize = 1 << 20;

/// Words that begin a line.
const STEP_NAMES: [&str; 18] = [
    "size",
    "scale",
    "key",
    "click",
    "double-click",
    "press",
    "move",
    "release",
    "drag",
    "wheel",
    "turn",
    "wait",
    "save",
    "window",
    "repeat",
    "end",
    "adapt",
    "quit",
];

/// The manual of scripts.
pub(super) fn manual() -> String {
    MANUAL.replace("SUFFIXES", &Format::written_suffixes())
}

const MANUAL: &str = "\
A script for --headless-script is a file of lines; # begins a comment:
  size 640x360                   the window's size
  scale 1.5                      the display's scale, by which letters are larger
  key KEY                        such as c, F, ctrl+3, home
  click X,Y                      with ctrl, shift or alt after it, if held
  double-click X,Y
  press X,Y                      a drag begins, with what drag takes but steps=N after it
  move X,Y                       the pointer goes there
  release                        the drag ends
  drag X,Y X,Y                   with left, middle or right, ctrl, shift or alt, and steps=N, after it
  wheel STEPS X,Y                forward if positive; with shift after it, if held
  turn RIGHT UP                  degrees about the pivot
  wait N                         until the picture has N samples of each pixel
  save FILE                      the picture: SUFFIXES
  save FILE.toml                 the scene, which renders to the same picture
  window FILE.png                what the window shows, letters and all
  repeat N ... end               the lines between, N times; {} in a name is the count, from 000
  adapt                          sizes by the clock from here on, as in a window: to measure
  quit";

/// A line of a script.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Step {
    Size(u32, u32),
    Scale(f64),
    Key(String),
    Click { place: DVec2, held: Held, double: bool },
    Press { place: DVec2, button: Button, held: Held },
    Move(DVec2),
    Release,
    Drag { from: DVec2, to: DVec2, button: Button, held: Held, steps: u32 },
    Wheel { steps: f64, place: DVec2, held: Held },
    Turn(DVec2),
    Wait(u32),
    Save(PathBuf),
    Window(PathBuf),
    Adapt,
    Quit,
}

/// The steps of a script, each with the number of its line.
pub(super) fn parse(text: &str) -> Result<Vec<(usize, Step)>, String> {
    let lines = text.lines().enumerate().map(|(row, line)| (row + 1, words(line)));
    let lines: Vec<(usize, Vec<&str>)> = lines.filter(|(_, words)| !words.is_empty()).collect();
    let mut steps = Vec::new();
    let rest = block(&lines, 0, None, &mut steps)?;
    match rest.first() {
        Some((row, _)) => Err(format!("line {row}: `end` without `repeat`")),
        None => Ok(steps),
    }
}

fn words(line: &str) -> Vec<&str> {
    line.split('#').next().unwrap_or_default().split_whitespace().collect()
}

type Lines<'a, 'l> = &'l [(usize, Vec<&'a str>)];

/// Reads up to the `end` of a block, or of the file, and returns what follows.
fn block<'a, 'l>(
    mut lines: Lines<'a, 'l>,
    depth: usize,
    count: Option<usize>,
    steps: &mut Vec<(usize, Step)>,
) -> Result<Lines<'a, 'l>, String> {
    while let Some(((row, words), rest)) = lines.split_first() {
        let at = |message: String| format!("line {row}: {message}");
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
                steps.push((*row, step(words, count).map_err(at)?));
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
                return Err(format!("a scale of {scale}, but scales are {least} to {most}"));
            }
            Step::Scale(scale)
        }
        ["key", key] if keys::command(key).is_some() => Step::Key((*key).to_owned()),
        ["key", key] => {
            let near = suggest::question(key, keys::BINDINGS.iter().map(|binding| binding.0));
            return Err(format!("`{key}` is no key that does anything{near}"));
        }
        ["click", at, held @ ..] => {
            Step::Click { place: place(at)?, held: Words::of(held)?.held, double: false }
        }
        ["double-click", at] => {
            Step::Click { place: place(at)?, held: Held::default(), double: true }
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
        ["wait", samples] => Step::Wait(number::<u32>(samples)?.max(1)),
        ["save", name] => Step::Save(named(name, count)),
        ["window", name] => Step::Window(named(name, count)),
        ["adapt"] => Step::Adapt,
        ["quit"] => Step::Quit,
        [first, ..] => {
            let near = suggest::question(first, STEP_NAMES);
            return Err(format!("`{first}` begins no step; see spherule view --help{near}"));
        }
        [] => return Err("nothing".to_owned()),
    })
}

/// What may stand after the places of a drag.
struct Words {
    button: Button,
    held: Held,
    steps: u32,
}

impl Words {
    fn of(words: &[&str]) -> Result<Self, String> {
        let mut all = Self { button: Button::Left, held: Held::default(), steps: STEPS };
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
                        format!("`{other}` is no button, no key and no steps=N{near}")
                    })?;
                    all.steps = number::<u32>(steps)?.clamp(1, MOST as u32);
                }
            }
        }
        Ok(all)
    }
}

/// `{}` is how often the block was repeated before.
fn named(name: &str, count: Option<usize>) -> PathBuf {
    PathBuf::from(name.replace("{}", &format!("{:03}", count.unwrap_or(0))))
}

fn number<T: std::str::FromStr>(text: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("`{text}` is no whole number of 0 or more"))
}

fn finite(text: &str) -> Result<f64, String> {
    let number = text.parse().ok().filter(|number: &f64| number.is_finite());
    number.ok_or_else(|| format!("`{text}` is no number"))
}

fn pair<T: std::str::FromStr>(text: &str, between: char) -> Result<(T, T), String> {
    let parts =
        text.split_once(between).and_then(|(a, b)| Some((a.parse().ok()?, b.parse().ok()?)));
    parts.ok_or_else(|| format!("`{text}` should be two numbers with {between} between them"))
}

fn place(text: &str) -> Result<DVec2, String> {
    let (x, y): (f64, f64) = pair(text, ',')?;
    let place = DVec2::new(x, y);
    if place.is_finite() { Ok(place) } else { Err(format!("`{text}` is no place")) }
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
        let drag = parse("drag 1,2 3.5,4 right ctrl steps=3").unwrap();
        let held = Held { control: true, ..Held::default() };
        let (from, to) = (DVec2::new(1.0, 2.0), DVec2::new(3.5, 4.0));
        let expected = Step::Drag { from, to, button: Button::Right, held, steps: 3 };
        assert_eq!(drag, [(1, expected)]);
    }

    #[test]
    fn faults_are_told_with_their_line() {
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
        for name in
            STEP_NAMES.iter().filter(|name| !["repeat", "end", "double-click"].contains(name))
        {
            assert!(MANUAL.contains(&format!("\n  {name}")), "{name}");
        }
        assert!(MANUAL.lines().skip(1).all(|line| line.starts_with("  ")));
    }
}
