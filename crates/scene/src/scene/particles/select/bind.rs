//! Binding names to columns, and evaluating conditions on rows.

use super::functions::Function;
use super::grammar::{Node, Tree, Value};
use super::spatial;
use super::vocabulary::Group;
use super::words::{Sign, SpannedError};
use crate::scene::particles::Codes;
use crate::scene::particles::Particles;
use crate::scene::particles::style::{Column, unknown};
use crate::suggest;
use rayon::prelude::*;
use std::borrow::Cow;

/// A condition, bound to columns.
enum Truth<'p> {
    Any(Vec<Self>),
    All(Vec<Self>),
    Not(Box<Self>),
    Compare(Sign, Number<'p>, Number<'p>),
    /// Result of the comparison for each text of a column.
    Texts(Cow<'p, Codes>, Vec<bool>),
    /// True for numbers in one of these ranges.
    Ranges(Cow<'p, [f64]>, Vec<[f64; 2]>),
    /// Result for each row.
    Rows(Vec<bool>),
}

/// A numeric expression, bound to columns.
enum Number<'p> {
    Constant(f64),
    Column(Cow<'p, [f64]>),
    /// Number of each text of a column; NaN if it is not a number.
    Texts(Cow<'p, Codes>, Vec<f64>),
    Negative(Box<Self>),
    Arithmetic(Box<Self>, Vec<(Sign, Self)>),
    Call(Function, Vec<Self>),
}

/// Evaluates the condition for each row.
pub(super) fn rows(tree: &Tree, particles: &Particles) -> Result<Vec<bool>, SpannedError> {
    let truth = truth(tree, particles)?;
    Ok(truth.rows(particles.spheres.len()))
}

/// Evaluates the number for each row.
pub(super) fn numbers(tree: &Tree, particles: &Particles) -> Result<Vec<f64>, SpannedError> {
    let number = number(tree, particles, "only columns of numbers can be computed with")?;
    Ok((0..particles.spheres.len()).into_par_iter().map(|row| number.at(row)).collect())
}

impl Truth<'_> {
    fn rows(self, count: usize) -> Vec<bool> {
        if let Self::Rows(rows) = self {
            return rows;
        }
        (0..count).into_par_iter().map(|row| self.at(row)).collect()
    }

    fn at(&self, row: usize) -> bool {
        match self {
            Self::Any(parts) => parts.iter().any(|part| part.at(row)),
            Self::All(parts) => parts.iter().all(|part| part.at(row)),
            Self::Not(inner) => !inner.at(row),
            Self::Compare(sign, left, right) => compare(*sign, left.at(row), right.at(row)),
            Self::Texts(codes, truths) => truths[codes.code(row) as usize],
            Self::Ranges(values, ranges) => {
                let value = values[row];
                ranges.iter().any(|[low, high]| (*low..=*high).contains(&value))
            }
            Self::Rows(rows) => rows[row],
        }
    }
}

fn compare(sign: Sign, left: f64, right: f64) -> bool {
    match sign {
        Sign::Equal => left == right,
        Sign::NotEqual => left != right,
        Sign::Less => left < right,
        Sign::LessEqual => left <= right,
        Sign::Greater => left > right,
        _ => left >= right,
    }
}

impl Number<'_> {
    fn at(&self, row: usize) -> f64 {
        match self {
            Self::Constant(number) => *number,
            Self::Column(values) => values[row],
            Self::Texts(codes, numbers) => numbers[codes.code(row) as usize],
            Self::Negative(inner) => -inner.at(row),
            Self::Arithmetic(first, rest) => {
                rest.iter().fold(first.at(row), |left, (sign, right)| {
                    let right = right.at(row);
                    match sign {
                        Sign::Plus => left + right,
                        Sign::Minus => left - right,
                        Sign::Times => left * right,
                        _ => left / right,
                    }
                })
            }
            Self::Call(function, numbers) => {
                function.of(numbers.iter().map(|number| number.at(row)))
            }
        }
    }
}

/// Returns a message about the first text of the condition that no particle has.
pub(super) fn absent(tree: &Tree, particles: &Particles) -> Option<String> {
    match &tree.node {
        Node::Any(parts) | Node::All(parts) => {
            parts.iter().find_map(|part| absent(part, particles))
        }
        Node::Not(inner) | Node::Within { of: inner, .. } | Node::Same { of: inner, .. } => {
            absent(inner, particles)
        }
        Node::OneOf(column, values) => {
            let Some(Column::Texts { names, .. }) = column_of(column, particles) else {
                return None;
            };
            let missing = |value: &Value| {
                let text = value.text().filter(|_| !fits_any(value, &names))?.to_owned();
                let known = names.iter().copied();
                let help = suggest::help(&text, known, "there are");
                Some(format!("no particle has `{text}`; {help}"))
            };
            values.iter().find_map(missing)
        }
        Node::Compare(_, sides) => {
            let [left, right] = &**sides;
            [(left, right), (right, left)].into_iter().find_map(|(column, other)| {
                let (Node::Word(text) | Node::Text(text)) = &other.node else { return None };
                let Some(Column::Texts { names, .. }) = column_of(column, particles) else {
                    return None;
                };
                let known = names.iter().copied();
                (!names.contains(&text.as_str())).then(|| {
                    format!("no particle has `{text}`; {}", suggest::help(text, known, "there are"))
                })
            })
        }
        _ => None,
    }
}

fn truth<'p>(tree: &Tree, particles: &'p Particles) -> Result<Truth<'p>, SpannedError> {
    let all = |parts: &[Tree]| {
        parts.iter().map(|part| truth(part, particles)).collect::<Result<_, SpannedError>>()
    };
    match &tree.node {
        Node::Any(parts) => Ok(Truth::Any(all(parts)?)),
        Node::All(parts) => Ok(Truth::All(all(parts)?)),
        Node::Not(inner) => Ok(Truth::Not(Box::new(truth(inner, particles)?))),
        Node::Compare(sign, sides) => comparison(*sign, sides, particles),
        Node::OneOf(column, values) => one_of(column, values, particles),
        Node::Group(group) => {
            let rows = group.rows(particles).map_err(|message| (tree.span.clone(), message))?;
            Ok(Truth::Rows(rows))
        }
        Node::Within { distance, others, of } => {
            let of = truth(of, particles)?.rows(particles.spheres.len());
            let rows = spatial::within(particles, &of, *distance, *others);
            rows.map(Truth::Rows).map_err(|message| (tree.span.clone(), message))
        }
        Node::Same { column, of } => {
            let of = truth(of, particles)?.rows(particles.spheres.len());
            let rows = spatial::same(particles, &of, column).map_err(|message| {
                let message = message.unwrap_or_else(|| unknown(particles, column));
                (tree.span.clone(), message)
            })?;
            Ok(Truth::Rows(rows))
        }
        Node::Word(word) if Column::find(particles, word).is_none() => {
            let help = suggest::help(word, Group::words(), "words are");
            Err((
                tree.span.clone(),
                format!("`{word}` is no condition; {help}; or compare a column, as in `z > 10`"),
            ))
        }
        _ => Err((tree.span.clone(), "expected a comparison, as in `z > 10`".to_owned())),
    }
}

impl Value {
    /// Returns the text or the beginning of a pattern.
    fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) | Self::Pattern(text) => Some(text),
            Self::Range(..) => None,
        }
    }

    /// Returns whether a text is this value.
    fn fits(&self, name: &str) -> bool {
        match self {
            Self::Text(text) => name == text,
            Self::Pattern(start) => name.starts_with(start),
            Self::Range(low, high) => {
                name.parse().is_ok_and(|number: f64| (*low..=*high).contains(&number))
            }
        }
    }
}

fn fits_any(value: &Value, names: &[&str]) -> bool {
    names.iter().any(|name| value.fits(name))
}

/// Binds a list of values of a column.
fn one_of<'p>(
    column: &Tree,
    values: &[Value],
    particles: &'p Particles,
) -> Result<Truth<'p>, SpannedError> {
    let (Node::Word(name) | Node::Column(name)) = &column.node else {
        return Err((column.span.clone(), "expected the name of a column".to_owned()));
    };
    match Column::find(particles, name) {
        Some(Column::Texts { names, codes }) => {
            let truths = names.iter().map(|name| values.iter().any(|value| value.fits(name)));
            Ok(Truth::Texts(codes, truths.collect()))
        }
        Some(Column::Numbers(numbers)) => {
            let range = |value: &Value| match value {
                Value::Range(low, high) => Ok([*low, *high]),
                Value::Text(text) | Value::Pattern(text) => {
                    text.parse().map(|number: f64| [number; 2]).map_err(|_| {
                        let message = format!("`{text}` is not a number, but `{name}` has numbers");
                        (column.span.clone(), message)
                    })
                }
            };
            Ok(Truth::Ranges(numbers, values.iter().map(range).collect::<Result<_, _>>()?))
        }
        None => Err((column.span.clone(), unknown(particles, name))),
    }
}

fn comparison<'p>(
    sign: Sign,
    [left, right]: &[Tree; 2],
    particles: &'p Particles,
) -> Result<Truth<'p>, SpannedError> {
    for (column, other) in [(left, right), (right, left)] {
        let (Node::Word(text) | Node::Text(text)) = &other.node else { continue };
        let Some(Column::Texts { names, codes }) = column_of(column, particles) else { continue };
        if !matches!(sign, Sign::Equal | Sign::NotEqual) {
            let span = left.span.start..right.span.end;
            return Err((span, "texts can only be compared by `==` or `!=`".to_owned()));
        }
        // The case of a word is checked; a text in quotes is taken literally.
        if matches!(other.node, Node::Word(_))
            && let [one, ..] = suggest::other_case(text, names.iter().copied())[..]
        {
            let message = format!("no particle has `{text}` in this column; did you mean `{one}`?");
            return Err((other.span.clone(), format!("{message} (or write '{text}' in quotes)")));
        }
        let truths = names.iter().map(|name| (name == text) == (sign == Sign::Equal));
        return Ok(Truth::Texts(codes, truths.collect()));
    }
    let help = "compare it with a word or a text in quotes";
    Ok(Truth::Compare(sign, number(left, particles, help)?, number(right, particles, help)?))
}

/// Returns the column that a word names.
fn column_of<'p>(tree: &Tree, particles: &'p Particles) -> Option<Column<'p>> {
    match &tree.node {
        Node::Word(name) | Node::Column(name) => Column::find(particles, name),
        _ => None,
    }
}

/// Binds a number; `help` says what to do about a column of texts.
fn number<'p>(
    tree: &Tree,
    particles: &'p Particles,
    help: &str,
) -> Result<Number<'p>, SpannedError> {
    let wrong = |message: &str| Err((tree.span.clone(), message.to_owned()));
    match &tree.node {
        Node::Number(number) => Ok(Number::Constant(*number)),
        Node::Word(name) | Node::Column(name) => {
            column(name, particles, help).map_err(|message| (tree.span.clone(), message))
        }
        Node::Text(_) => wrong("only a column of texts can be compared with a text"),
        Node::Negative(inner) => Ok(Number::Negative(Box::new(number(inner, particles, help)?))),
        Node::Arithmetic(first, rest) => {
            let first = number(first, particles, help)?;
            let rest = rest.iter().map(|(sign, part)| Ok((*sign, number(part, particles, help)?)));
            Ok(Number::Arithmetic(Box::new(first), rest.collect::<Result<_, SpannedError>>()?))
        }
        Node::Call(function, parts) => {
            let parts = parts.iter().map(|part| number(part, particles, help));
            Ok(Number::Call(*function, parts.collect::<Result<_, _>>()?))
        }
        Node::Length(name, components) => {
            let bound = components.iter().map(|part| number(part, particles, help)).collect();
            match bound {
                Ok(components) => Ok(Number::Call(Function::Norm, components)),
                Err(_) if Column::find(particles, name).is_some() => Err((
                    tree.span.clone(),
                    format!(
                        "`{name}` is a number and no vector: write `abs({name})`, or three numbers as in \
                         `norm(x, y, z)`"
                    ),
                )),
                Err(fault) => Err(fault),
            }
        }
        _ => wrong("expected a number, but this is a condition"),
    }
}

fn column<'p>(name: &str, particles: &'p Particles, help: &str) -> Result<Number<'p>, String> {
    match Column::find(particles, name) {
        Some(Column::Numbers(values)) => Ok(Number::Column(values)),
        Some(Column::Texts { names, codes }) => {
            let number = |name: &&str| name.parse().unwrap_or(f64::NAN);
            let numbers: Vec<f64> = names.iter().map(number).collect();
            if numbers.iter().all(|number| number.is_nan()) {
                return Err(format!("the column `{name}` holds texts: {help}"));
            }
            Ok(Number::Texts(codes, numbers))
        }
        None => Err(unknown(particles, name)),
    }
}
