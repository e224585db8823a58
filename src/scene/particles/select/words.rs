//! A condition cut into words and signs.

use std::ops::Range;

/// A place in a condition, and what is wrong there.
pub(super) type Wrong = (Range<usize>, String);

/// What a condition is made of.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Word {
    Number(f64),
    /// A column's name, or a text.
    Bare(String),
    /// A column's name in backticks.
    Column(String),
    /// A text in quotes.
    Text(String),
    Sign(Sign),
}

/// Signs, and words that are as good as signs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sign {
    Or,
    And,
    Not,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Plus,
    Minus,
    Times,
    Divided,
    Open,
    Close,
}

/// Signs, the longer of two that begin alike in front.
const SIGNS: [(&str, Sign); 15] = [
    ("==", Sign::Equal),
    ("!=", Sign::NotEqual),
    ("<=", Sign::LessEqual),
    (">=", Sign::GreaterEqual),
    ("&&", Sign::And),
    ("||", Sign::Or),
    ("<", Sign::Less),
    (">", Sign::Greater),
    ("!", Sign::Not),
    ("+", Sign::Plus),
    ("-", Sign::Minus),
    ("*", Sign::Times),
    ("/", Sign::Divided),
    ("(", Sign::Open),
    (")", Sign::Close),
];

/// All words, with their bytes; the last has those after the end.
pub(super) type Words = Vec<(Word, Range<usize>)>;

/// The words of a condition, and its length.
pub(super) fn words(text: &str) -> Result<(Words, usize), Wrong> {
    let mut words = Vec::new();
    let mut at = 0;
    loop {
        let rest = &text[at..];
        at += rest.len() - rest.trim_start().len();
        let rest = rest.trim_start();
        if rest.is_empty() {
            return Ok((words, text.len()));
        }
        let (word, length) = word(rest).map_err(|(length, message)| (at..at + length, message))?;
        words.push((word, at..at + length));
        at += length;
    }
}

/// The first word, and how many bytes it takes; or what is wrong with so many.
fn word(rest: &str) -> Result<(Word, usize), (usize, String)> {
    let first = rest.chars().next().unwrap_or(' ');
    if matches!(first, '"' | '\'' | '`') {
        return quoted(rest, first);
    }
    let fraction = first == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit());
    if first.is_ascii_digit() || fraction {
        return number(rest);
    }
    if let Some((sign, meaning)) = SIGNS.iter().find(|(sign, _)| rest.starts_with(sign)) {
        return Ok((Word::Sign(*meaning), sign.len()));
    }
    let length = rest.find(|c| !is_of_name(c)).unwrap_or(rest.len());
    let name = &rest[..length];
    match name.to_ascii_lowercase().as_str() {
        "" if first == '=' => Err((1, "one `=`, but equal is `==`".to_owned())),
        "" => Err((first.len_utf8(), format!("`{first}` means nothing here"))),
        "or" => Ok((Word::Sign(Sign::Or), length)),
        "and" => Ok((Word::Sign(Sign::And), length)),
        "not" => Ok((Word::Sign(Sign::Not), length)),
        _ => Ok((Word::Bare(name.to_owned()), length)),
    }
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || "_.:[]".contains(c)
}

fn quoted(rest: &str, quote: char) -> Result<(Word, usize), (usize, String)> {
    let Some(length) = rest[1..].find(quote) else {
        return Err((rest.len(), format!("a `{quote}` is opened and never closed")));
    };
    let text = rest[1..=length].to_owned();
    Ok((if quote == '`' { Word::Column(text) } else { Word::Text(text) }, length + 2))
}

fn number(rest: &str) -> Result<(Word, usize), (usize, String)> {
    let mut length = rest.find(|c| !is_of_name(c)).unwrap_or(rest.len());
    // The sign of an exponent.
    let exponent = rest[..length].ends_with(['e', 'E']);
    if exponent && rest[length..].starts_with(['+', '-']) {
        let after = &rest[length + 1..];
        length += 1 + after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
    }
    let number = rest[..length].parse().ok().filter(|number: &f64| number.is_finite());
    number.map(|number| (Word::Number(number), length)).ok_or_else(|| {
        let text = &rest[..length];
        (length, format!("`{text}` is no number; names like this go in backticks, texts in quotes"))
    })
}
