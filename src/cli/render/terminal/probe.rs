//! Detection of the terminal's image protocol and size, by a query or from the environment.

/// Protocols for images in a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Protocol {
    /// Images of the Kitty graphics protocol.
    Kitty,
    /// Inline images of iTerm2.
    Iterm,
    /// DEC's sixels.
    Sixels,
    /// Half blocks, in 24-bit color or else in 256 colors.
    Blocks { true_color: bool },
}

/// The size of a terminal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Screen {
    /// Cells.
    pub(super) columns: u32,
    /// Cells.
    pub(super) rows: u32,
    /// Width and height of a cell, in pixels.
    pub(super) cell: [u32; 2],
}

/// A query for Kitty's protocol, and one for the terminal's attributes, which every terminal answers and so
/// marks the end of the answers.
#[cfg(unix)]
const QUESTION: &[u8] = b"\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\x1b[c";

/// Maximum length of the answer in bytes.
#[cfg(unix)]
const LONGEST: usize = 4096;

/// Terminals with iTerm's inline images, by their names in the environment.
const ITERM: [&str; 5] = ["iTerm", "WezTerm", "mintty", "rio", "WarpTerminal"];

/// Returns the best protocol of the terminal.
pub(super) fn protocol() -> Protocol {
    // Variables that are not valid Unicode are ignored.
    let variable = |name: &str| std::env::var(name).ok();
    chosen(&answer(), &variable)
}

/// Returns the protocol for an answer of the terminal and the environment variables.
fn chosen(answer: &[u8], variable: &impl Fn(&str) -> Option<String>) -> Protocol {
    let names = ["TERM_PROGRAM", "LC_TERMINAL"].into_iter().filter_map(variable);
    let named = names.into_iter().any(|name| ITERM.iter().any(|own| name.contains(own)));
    let konsole = variable("KONSOLE_VERSION").is_some_and(|version| !version.is_empty());
    if takes_kitty(answer) {
        Protocol::Kitty
    } else if named || konsole {
        Protocol::Iterm
    } else if takes_sixels(answer) {
        Protocol::Sixels
    } else {
        let colors = variable("COLORTERM").unwrap_or_default();
        Protocol::Blocks { true_color: ["truecolor", "24bit"].contains(&colors.as_str()) }
    }
}

fn takes_kitty(answer: &[u8]) -> bool {
    const YES: &[u8] = b"\x1b_Gi=31;OK\x1b\\";
    answer.windows(YES.len()).any(|part| part == YES)
}

/// Returns whether 4, sixels, is among the terminal's attributes: `ESC [ ? 62 ; 4 c`.
fn takes_sixels(answer: &[u8]) -> bool {
    let attributes = attributes(answer).unwrap_or_default();
    attributes.split(|byte| *byte == b';').skip(1).any(|attribute| attribute == b"4")
}

/// Returns the terminal's attributes, without delimiters; `None` if the answer has none yet.
fn attributes(answer: &[u8]) -> Option<&[u8]> {
    const START: &[u8] = b"\x1b[?";
    let start = answer.windows(START.len()).position(|part| part == START)? + START.len();
    let rest = &answer[start..];
    Some(&rest[..rest.iter().position(|byte| *byte == b'c')?])
}

/// Queries the terminal, and returns its answer within a second.
#[cfg(unix)]
fn answer() -> Vec<u8> {
    use rustix::termios::{OptionalActions, SpecialCodeIndex, tcgetattr, tcsetattr};
    use std::io::{Read, Write, stdin, stdout};
    use std::os::fd::AsFd;

    let mut answer = Vec::new();
    let input = stdin();
    let (Ok(before), Ok(own)) = (tcgetattr(&input), input.as_fd().try_clone_to_owned()) else {
        return answer;
    };
    let mut raw = before.clone();
    raw.make_raw();
    // Reading ends after a second without an answer.
    raw.special_codes[SpecialCodeIndex::VMIN] = 0;
    raw.special_codes[SpecialCodeIndex::VTIME] = 10;
    if tcsetattr(&input, OptionalActions::Flush, &raw).is_err() {
        return answer;
    }
    let mut output = stdout().lock();
    if output.write_all(QUESTION).and_then(|()| output.flush()).is_ok() {
        let mut file = std::fs::File::from(own);
        let mut bytes = [0; 256];
        while attributes(&answer).is_none() && answer.len() < LONGEST {
            match file.read(&mut bytes) {
                Ok(count) if count > 0 => answer.extend(&bytes[..count]),
                _ => break,
            }
        }
    }
    // Nothing can be done if the terminal is gone.
    let _ = tcsetattr(&input, OptionalActions::Flush, &before);
    answer
}

/// Returns no answer, on systems without termios.
#[cfg(not(unix))]
fn answer() -> Vec<u8> {
    Vec::new()
}

/// Returns the size of the terminal.
pub(super) fn screen() -> Screen {
    /// Default width and height of a cell in pixels.
    const CELL: [u32; 2] = [10, 20];
    let [columns, rows, width, height] = size();
    let default = |count: u32, default: u32| if count > 0 { count } else { default };
    let (columns, rows) = (default(columns, 80), default(rows, 24));
    let cell = [default(width / columns, CELL[0]), default(height / rows, CELL[1])];
    Screen { columns, rows, cell }
}

/// Columns and rows of cells, width and height in pixels; 0 if unknown.
#[cfg(unix)]
fn size() -> [u32; 4] {
    let size = rustix::termios::tcgetwinsize(std::io::stdout());
    size.map_or([0; 4], |size| {
        [size.ws_col, size.ws_row, size.ws_xpixel, size.ws_ypixel].map(u32::from)
    })
}

#[cfg(not(unix))]
fn size() -> [u32; 4] {
    let cells = ["COLUMNS", "LINES"]
        .map(|name| std::env::var(name).ok().and_then(|count| count.parse().ok()).unwrap_or(0));
    [cells[0], cells[1], 0, 0]
}

#[cfg(test)]
mod tests {
    use super::*;

    const KITTY: &[u8] = b"\x1b_Gi=31;OK\x1b\\\x1b[?62;c";
    const SIXELS: &[u8] = b"\x1b[?62;4;22c";
    const PLAIN: &[u8] = b"\x1b[?64;1;2;6;14c";

    fn with(answer: &[u8], variables: &[(&str, &str)]) -> Protocol {
        chosen(answer, &|name: &str| {
            let row = variables.iter().find(|(own, _)| *own == name);
            row.map(|(_, value)| (*value).to_owned())
        })
    }

    #[test]
    fn protocols_are_detected_by_answers_and_names() {
        let (few, many) =
            (Protocol::Blocks { true_color: false }, Protocol::Blocks { true_color: true });
        let wezterm = ("TERM_PROGRAM", "WezTerm");
        assert_eq!(with(KITTY, &[wezterm]), Protocol::Kitty);
        assert_eq!(with(SIXELS, &[wezterm]), Protocol::Iterm);
        assert_eq!(with(PLAIN, &[("LC_TERMINAL", "iTerm2")]), Protocol::Iterm);
        assert_eq!(with(PLAIN, &[("KONSOLE_VERSION", "250801")]), Protocol::Iterm);
        assert_eq!(with(SIXELS, &[("COLORTERM", "truecolor")]), Protocol::Sixels);
        assert_eq!(with(PLAIN, &[("COLORTERM", "truecolor")]), many);
        assert_eq!(with(PLAIN, &[("KONSOLE_VERSION", "")]), few);
        assert_eq!(with(b"", &[]), few);
    }

    #[test]
    fn answers_end_with_the_attributes() {
        assert_eq!(attributes(PLAIN), Some(&b"64;1;2;6;14"[..]));
        assert_eq!(attributes(&SIXELS[..8]), None);
        // A level of 4 or an attribute of 14 is no sign of sixels, and an error none of Kitty.
        assert!(!takes_sixels(b"\x1b[?4;14;24c") && takes_sixels(b"\x1b[?1;4c"));
        assert!(!takes_kitty(b"\x1b_Gi=31;EINVAL\x1b\\\x1b[?62c"));
    }
}
