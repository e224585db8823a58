//! Words that select atoms as in VMD and `MDAnalysis`: groups such as `protein`, lists of values such as
//! `name CA CB`, and what depends on other particles: `within 5 of protein`, `same residue as name ZN`.

use super::grammar::{Node, Parser, Tree, Value};
use super::vocabulary::{self, Group};
use super::words::{Sign, SpannedError, Word};
use std::ops::Range;

/// Words that begin a condition on other particles or are part of one; never values unless they are quoted.
const RESERVED: [&str; 9] =
    ["within", "pbwithin", "exwithin", "around", "same", "byres", "of", "as", "to"];

fn is(word: &Word, name: &str) -> bool {
    matches!(word, Word::Bare(own) if own.eq_ignore_ascii_case(name))
}

impl Parser<'_> {
    /// Parses a condition that isn't a comparison, if the next words are one.
    pub(super) fn group_or_list(&mut self) -> Result<Option<Tree>, SpannedError> {
        let Some((word, span)) = self.peek(0).cloned() else { return Ok(None) };
        let name = match &word {
            Word::Bare(name) => name.to_ascii_lowercase(),
            Word::Column(_) => String::new(),
            _ => return Ok(None),
        };
        let follows = self.peek(1).map(|(word, _)| word);
        let is_operand = matches!(follows, Some(Word::Sign(sign)) if !BEGINS.contains(sign) && !ENDS.contains(sign));
        if is_operand && !self.negative_range() {
            return Ok(None);
        }
        let number_follows = matches!(follows, Some(Word::Number(_)));
        match name.as_str() {
            "within" | "pbwithin" | "exwithin" if number_follows => {
                self.within(span, name == "exwithin").map(Some)
            }
            "around" if number_follows => self.around(span).map(Some),
            "same" if matches!(follows, Some(Word::Bare(_) | Word::Column(_))) => {
                self.same(span).map(Some)
            }
            "byres"
                if follows.is_some_and(
                    |word| !matches!(word, Word::Sign(sign) if ENDS.contains(sign)),
                ) =>
            {
                self.next += 1;
                let of = self.inner(&span)?;
                let column = vocabulary::RESIDUE.to_owned();
                Ok(Some(Tree {
                    span: span.start..of.span.end,
                    node: Node::Same { column, of: Box::new(of) },
                }))
            }
            _ => {
                let group = Group::named(&name);
                let lists =
                    |word: &Word| Self::is_value(word) || matches!(word, Word::Sign(Sign::Minus));
                if let Some(group) = group.filter(|_| !follows.is_some_and(Self::is_value)) {
                    self.next += 1;
                    return Ok(Some(Tree { node: Node::Group(group), span }));
                }
                if group.is_none() && follows.is_some_and(lists) {
                    return self.list(word, span).map(Some);
                }
                Ok(None)
            }
        }
    }

    /// Returns whether a negative number that begins a range follows the next word.
    fn negative_range(&self) -> bool {
        let word = |ahead: usize| self.peek(ahead).map(|(word, _)| word);
        matches!((word(1), word(2)), (Some(Word::Sign(Sign::Minus)), Some(Word::Number(_))))
            && word(3).is_some_and(|word| is(word, "to"))
    }

    fn is_value(word: &Word) -> bool {
        match word {
            Word::Bare(name) => !RESERVED.iter().any(|own| own.eq_ignore_ascii_case(name)),
            Word::Number(_) | Word::Text(_) | Word::Mixed(..) => true,
            Word::Column(_) | Word::Sign(_) => false,
        }
    }

    /// Parses a condition on the particles that another one depends on: it binds like `not`.
    fn inner(&mut self, span: &Range<usize>) -> Result<Tree, SpannedError> {
        self.deeper(span)?;
        let inner = self.not()?;
        self.depth -= 1;
        Ok(inner)
    }

    /// Takes a word.
    fn expect(&mut self, name: &str, example: &str) -> Result<(), SpannedError> {
        let end = self.text.len();
        match self.advance() {
            Some((word, _)) if is(&word, name) => Ok(()),
            other => {
                let span = other.map_or(end..end, |(_, span)| span);
                Err((span, format!("expected `{name}` here, as in `{example}`")))
            }
        }
    }

    fn distance(&mut self) -> Result<f64, SpannedError> {
        match self.advance() {
            Some((Word::Number(distance), _)) if distance > 0.0 => Ok(distance),
            Some((_, span)) => Err((span, "a distance is more than 0".to_owned())),
            None => Err((0..0, "expected a distance".to_owned())),
        }
    }

    fn within(&mut self, span: Range<usize>, others: bool) -> Result<Tree, SpannedError> {
        self.next += 1;
        let distance = self.distance()?;
        self.expect("of", "within 5 of protein")?;
        let of = self.inner(&span)?;
        let span = span.start..of.span.end;
        Ok(Tree { node: Node::Within { distance, others, of: Box::new(of) }, span })
    }

    fn around(&mut self, span: Range<usize>) -> Result<Tree, SpannedError> {
        self.next += 1;
        let distance = self.distance()?;
        let of = self.inner(&span)?;
        let span = span.start..of.span.end;
        Ok(Tree { node: Node::Within { distance, others: true, of: Box::new(of) }, span })
    }

    fn same(&mut self, span: Range<usize>) -> Result<Tree, SpannedError> {
        self.next += 1;
        let column = match self.advance() {
            Some((Word::Bare(name) | Word::Column(name), _)) => name,
            _ => String::new(),
        };
        self.expect("as", "same residue as name CA")?;
        let of = self.inner(&span)?;
        let span = span.start..of.span.end;
        Ok(Tree { node: Node::Same { column, of: Box::new(of) }, span })
    }

    /// Parses a column and the values after it.
    fn list(&mut self, word: Word, span: Range<usize>) -> Result<Tree, SpannedError> {
        self.next += 1;
        let node = match word {
            Word::Column(name) => Node::Column(name),
            Word::Bare(name) => Node::Word(name),
            _ => return Err((span, "expected a name".to_owned())),
        };
        let column = Tree { node, span: span.clone() };
        let mut values = Vec::new();
        let mut end = span.end;
        while let Some((value, last)) = self.value()? {
            values.push(value);
            end = last;
        }
        Ok(Tree { node: Node::OneOf(Box::new(column), values), span: span.start..end })
    }

    /// Parses a value of a list, and returns the end of its bytes.
    fn value(&mut self) -> Result<Option<(Value, usize)>, SpannedError> {
        let Some((word, span)) = self.peek(0).cloned() else { return Ok(None) };
        if let Some(first) = self.number() {
            // From one number to another, in the words of VMD and of `MDAnalysis`.
            let end = self.words[self.next - 1].1.end;
            let between = self.peek(0).is_some_and(|(word, span)| match word {
                Word::Sign(Sign::Minus) => span.start == end,
                word => is(word, "to"),
            });
            if !between {
                return Ok(Some((Value::Text(self.text[span.start..end].to_owned()), end)));
            }
            self.next += 1;
            let end = self.text.len();
            let wrong = self.peek(0).map_or(end..end, |(_, span)| span.clone());
            let last = self.number().ok_or_else(|| (wrong, "expected a number here".to_owned()))?;
            return Ok(Some((Value::Range(first, last), self.words[self.next - 1].1.end)));
        }
        if !Self::is_value(&word) {
            return Ok(None);
        }
        self.next += 1;
        Ok(Some(match word {
            Word::Text(text) => (Value::Text(text), span.end),
            Word::Mixed(text, message) => {
                let range = text.split_once(':').map(|(low, high)| (low.parse(), high.parse()));
                match range {
                    Some((Ok(low), Ok(high))) => (Value::Range(low, high), span.end),
                    Some(_) => return Err((span, message)),
                    None => self.pattern(text, span),
                }
            }
            Word::Bare(text) => self.pattern(text, span),
            _ => return Ok(None),
        }))
    }

    /// Takes a number with its sign, if there is one.
    fn number(&mut self) -> Option<f64> {
        match (self.peek(0)?, self.peek(1)) {
            ((Word::Number(number), _), _) => {
                let number = *number;
                self.next += 1;
                Some(number)
            }
            ((Word::Sign(Sign::Minus), sign), Some((Word::Number(number), span)))
                if sign.end == span.start =>
            {
                let number = -number;
                self.next += 2;
                Some(number)
            }
            _ => None,
        }
    }

    /// Returns a text with the charge that follows it without a blank, as in `NA+`, or a pattern if a `*` does.
    fn pattern(&mut self, mut text: String, span: Range<usize>) -> (Value, usize) {
        let (mut signs, mut end) = (0, span.end);
        while let Some((Word::Sign(Sign::Plus | Sign::Minus), sign)) = self.peek(signs)
            && sign.start == end
        {
            (signs, end) = (signs + 1, sign.end);
        }
        if signs > 0
            && self
                .peek(signs)
                .is_none_or(|(_, next)| next.start > end || &self.text[next.clone()] == ")")
        {
            self.next += signs;
            text.push_str(&self.text[span.end..end]);
            return (Value::Text(text), end);
        }
        match self.peek(0) {
            Some((Word::Sign(Sign::Times), star)) if star.start == span.end => {
                let end = star.end;
                self.next += 1;
                (Value::Pattern(text), end)
            }
            _ => (Value::Text(text), span.end),
        }
    }
}

/// Operators that begin a condition.
const BEGINS: [Sign; 2] = [Sign::Open, Sign::Not];

/// Operators that end one.
const ENDS: [Sign; 3] = [Sign::And, Sign::Or, Sign::Close];
