//! Words and operators of a condition (the lexer).

use std::ops::Range;

/// The bytes of an error in a condition, and its message.
pub(super) type SpannedError = (Range<usize>, String);

/// A word of a condition.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Word {
    Number(f64),
    /// The name of a column, or a text.
    Bare(String),
    /// The name of a column, in backticks.
    Column(String),
    /// A text in quotes.
    Text(String),
    /// A text that begins like a number, such as `5:10` or `1HB`, which only lists of values may hold, and the
    /// error anywhere else.
    Mixed(String, String),
    Sign(Sign),
}

/// Operators and parentheses, and keywords that are operators.
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
    Power,
    Comma,
    Open,
    Close,
}

/// All operators in symbols; of two with the same beginning, the longer comes first.
const SIGNS: [(&str, Sign); 18] = [
    ("==", Sign::Equal),
    ("!=", Sign::NotEqual),
    ("<=", Sign::LessEqual),
    (">=", Sign::GreaterEqual),
    ("&&", Sign::And),
    ("||", Sign::Or),
    ("**", Sign::Power),
    ("<", Sign::Less),
    (">", Sign::Greater),
    ("!", Sign::Not),
    ("+", Sign::Plus),
    ("-", Sign::Minus),
    ("*", Sign::Times),
    ("/", Sign::Divided),
    ("^", Sign::Power),
    (",", Sign::Comma),
    ("(", Sign::Open),
    (")", Sign::Close),
];

/// Words with their bytes.
pub(super) type Words = Vec<(Word, Range<usize>)>;

/// Splits a condition into words.
pub(super) fn words(text: &str) -> Result<Words, SpannedError> {
    let mut words = Vec::new();
    let mut at = 0;
    loop {
        let rest = &text[at..];
        at += rest.len() - rest.trim_start().len();
        let rest = rest.trim_start();
        if rest.is_empty() {
            return Ok(words);
        }
        let (word, length) = word(rest).map_err(|(length, message)| (at..at + length, message))?;
        words.push((word, at..at + length));
        at += length;
    }
}

/// Returns the first word and its length in bytes, or the length of the faulty part and a message.
fn word(rest: &str) -> Result<(Word, usize), (usize, String)> {
    let first = rest.chars().next().unwrap_or(' ');
    if matches!(first, '"' | '\'' | '`') {
        return quoted(rest, first);
    }
    let fraction = first == '.' && rest[1..].starts_with(|c: char| c.is_ascii_digit());
    if first.is_ascii_digit() || fraction {
        return Ok(number(rest));
    }
    if let Some((sign, meaning)) = SIGNS.iter().find(|(sign, _)| rest.starts_with(sign)) {
        return Ok((Word::Sign(*meaning), sign.len()));
    }
    let mut length = rest.find(|c| !is_name_char(c)).unwrap_or(rest.len());
    // Names of atoms of nucleic acids end with primes.
    let primes = rest[length..].len() - rest[length..].trim_start_matches('\'').len();
    if length > 0 && primes <= 2 && !rest[length + primes..].starts_with(is_name_char) {
        length += primes;
    }
    let name = &rest[..length];
    match name.to_ascii_lowercase().as_str() {
        "" if first == '=' => Err((1, "use `==` for equality".to_owned())),
        "" => Err((first.len_utf8(), format!("unexpected `{first}`"))),
        "or" => Ok((Word::Sign(Sign::Or), length)),
        "and" => Ok((Word::Sign(Sign::And), length)),
        "not" => Ok((Word::Sign(Sign::Not), length)),
        _ => Ok((Word::Bare(name.to_owned()), length)),
    }
}

fn is_name_char(c: char) -> bool {
    c.is_alphanumeric() || "_.:[]".contains(c)
}

fn quoted(rest: &str, quote: char) -> Result<(Word, usize), (usize, String)> {
    let Some(length) = rest[1..].find(quote) else {
        return Err((rest.len(), format!("unclosed `{quote}`")));
    };
    let text = rest[1..=length].to_owned();
    Ok((if quote == '`' { Word::Column(text) } else { Word::Text(text) }, length + 2))
}

fn number(rest: &str) -> (Word, usize) {
    let mut length = rest.find(|c| !is_name_char(c)).unwrap_or(rest.len());
    length += rest[length..].len() - rest[length..].trim_start_matches('\'').len();
    // The sign of an exponent.
    let exponent = rest[..length].ends_with(['e', 'E']);
    if exponent && rest[length..].starts_with(['+', '-']) {
        let after = &rest[length + 1..];
        length += 1 + after.find(|c: char| !c.is_ascii_digit()).unwrap_or(after.len());
    }
    let number = rest[..length].parse().ok().filter(|number: &f64| number.is_finite());
    number.map_or_else(
        || {
            let text = rest[..length].trim_end_matches(['+', '-']).to_owned();
            let length = text.len();
            let message = format!(
                "`{text}` is not a number; write names like this in backticks, texts in quotes"
            );
            (Word::Mixed(text, message), length)
        },
        |number| (Word::Number(number), length),
    )
}
