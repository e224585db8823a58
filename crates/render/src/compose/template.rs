//! Templates of labels: text with fields in braces.

use crate::suggest;
use std::str::FromStr;

/// Maximum number of characters of a label.
const MAX_LENGTH: usize = 400;

/// Text with fields.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Template(Vec<Part>);

#[derive(Clone, Debug, PartialEq, Eq)]
enum Part {
    Text(String),
    Field {
        name: String,
        /// Number of decimals; `None` for as many as the number needs.
        decimals: Option<usize>,
    },
}

/// The value of a field.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// Text, which may be a number.
    Text(String),
    /// A number.
    Number(f64),
    /// A count.
    Whole(i64),
    /// The file does not have it; the reason.
    Missing(&'static str),
}

impl FromStr for Template {
    type Err = String;

    /// Parses text with `{field}` and `{field:.2}`; `{{` and `}}` are braces, `\n` is the end of a line.
    fn from_str(text: &str) -> Result<Self, String> {
        let mut parts = Vec::new();
        let mut plain = String::new();
        let mut letters = text.chars().peekable();
        while let Some(letter) = letters.next() {
            match letter {
                '{' | '}' if letters.next_if_eq(&letter).is_some() => plain.push(letter),
                '{' => {
                    let mut field = String::new();
                    let closed = letters.by_ref().any(|letter| {
                        field.push(letter);
                        letter == '}'
                    });
                    if !closed {
                        return Err(
                            "a field in braces is not closed: write {time}, or {{ for a brace"
                                .to_owned(),
                        );
                    }
                    field.pop();
                    parts.push(Part::Text(std::mem::take(&mut plain)));
                    parts.push(field_of(&field)?);
                }
                '}' => return Err("} closes no field: write }} for a brace".to_owned()),
                '\\' if letters.next_if_eq(&'n').is_some() => plain.push('\n'),
                '\n' => plain.push('\n'),
                letter if letter.is_control() => plain.push(' '),
                letter => plain.push(letter),
            }
        }
        parts.push(Part::Text(plain));
        Ok(Self(parts))
    }
}

fn field_of(text: &str) -> Result<Part, String> {
    let (name, format) = text.split_once(':').unwrap_or((text, ""));
    let decimals = match (format, format.strip_prefix('.')) {
        ("", _) => None,
        (_, Some(digits)) => Some(digits.parse().ok().filter(|count| *count <= 20)),
        _ => Some(None),
    };
    if decimals == Some(None) {
        return Err(format!(
            "the format of {{{text}}} is unknown: write decimals as in {{{name}:.2}}"
        ));
    }
    Ok(Part::Field { name: name.trim().to_owned(), decimals: decimals.flatten() })
}

impl Template {
    /// Returns the text with the values of its fields, of which the first with a name counts.
    ///
    /// # Errors
    /// A field is unknown, or has no value.
    pub fn expand(&self, fields: &[(String, Value)]) -> Result<String, String> {
        let mut text = String::new();
        for part in &self.0 {
            match part {
                Part::Text(plain) => text += plain,
                Part::Field { name, decimals } => {
                    let value = fields.iter().find(|(own, _)| own == name);
                    let (_, value) = value.ok_or_else(|| unknown(name, fields))?;
                    text += &formatted(name, value, *decimals)?;
                }
            }
        }
        Ok(text.chars().take(MAX_LENGTH).collect())
    }

    /// Returns the names of the fields.
    pub fn fields(&self) -> impl Iterator<Item = &str> {
        self.0.iter().filter_map(|part| match part {
            Part::Field { name, .. } => Some(name.as_str()),
            Part::Text(_) => None,
        })
    }

    /// Returns whether the text has a field.
    pub fn has(&self, field: &str) -> bool {
        self.fields().any(|name| name == field)
    }
}

fn unknown(name: &str, fields: &[(String, Value)]) -> String {
    let names = fields.iter().map(|(name, _)| name.as_str());
    format!("unknown field {{{name}}}; {}", suggest::help(name, names, "fields are"))
}

fn formatted(name: &str, value: &Value, decimals: Option<usize>) -> Result<String, String> {
    let number = match value {
        Value::Missing(why) => return Err(format!("{{{name}}} is not known: {why}")),
        Value::Text(text) => match (decimals, text.trim().parse::<f64>()) {
            (None, _) => return Ok(text.clone()),
            (Some(_), Ok(number)) => number,
            (Some(_), Err(_)) => {
                return Err(format!("{{{name}}} is not a number, and has no decimals"));
            }
        },
        Value::Whole(number) if decimals.is_none() => return Ok(minus(&number.to_string())),
        Value::Whole(number) => *number as f64,
        Value::Number(number) => *number,
    };
    let text = decimals.map_or_else(|| number.to_string(), |count| format!("{number:.count$}"));
    Ok(minus(&text))
}

/// Replaces the hyphen before a number by a minus sign.
fn minus(number: &str) -> String {
    number.replacen('-', "\u{2212}", 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn expand(template: &str) -> Result<String, String> {
        let fields = [
            ("time", Value::Number(0.300_000_1)),
            ("step", Value::Whole(-1200)),
            ("file", Value::Text("a.xyz".to_owned())),
            ("energy", Value::Text("-7.256".to_owned())),
            ("frame", Value::Missing("the input has no frames")),
        ];
        let fields = fields.map(|(name, value)| (name.to_owned(), value));
        template.parse::<Template>()?.expand(&fields)
    }

    #[test]
    fn fields_are_replaced() {
        for (template, expected) in [
            ("", ""),
            ("t = {time:.1} ps", "t = 0.3 ps"),
            ("{time}", "0.3000001"),
            ("{step}", "\u{2212}1200"),
            ("{step:.1}", "\u{2212}1200.0"),
            ("{ file }: {{x}}", "a.xyz: {x}"),
            ("E = {energy:.2}", "E = \u{2212}7.26"),
            ("{energy}", "-7.256"),
            ("a\\nb\tc", "a\nb c"),
        ] {
            assert_eq!(expand(template).as_deref(), Ok(expected), "{template}");
        }
    }

    #[test]
    fn mistakes_are_named() {
        for (template, part) in [
            ("{time", "not closed"),
            ("time}", "closes no field"),
            ("{time:2}", "{time:.2}"),
            ("{time:.x}", "{time:.2}"),
            ("{tme}", "`time`"),
            ("{pressure}", "time, step, file"),
            ("{frame}", "the input has no frames"),
            ("{file:.1}", "not a number"),
        ] {
            let error = expand(template).expect_err(template);
            assert!(error.contains(part), "{template}: {error}");
        }
    }
}
