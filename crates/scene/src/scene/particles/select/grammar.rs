//! Syntax trees of conditions, by recursive descent no deeper than [`MAX_DEPTH`].

use super::functions::Function;
use super::vocabulary::{Group, columns_of};
use super::words::{Sign, SpannedError, Word, Words};
use crate::scene::particles::VectorColumns;
use crate::suggest;
use std::ops::Range;

/// Maximum nesting of parentheses and signs, since the stack is finite.
const MAX_DEPTH: usize = 64;

/// A part of a condition, and its bytes in the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tree {
    pub(super) node: Node,
    pub(super) span: Range<usize>,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Number(f64),
    Word(String),
    Column(String),
    Text(String),
    Negative(Box<Tree>),
    /// Operands in order, evaluated from left to right.
    Arithmetic(Box<Tree>, Vec<(Sign, Tree)>),
    Call(Function, Vec<Tree>),
    /// The length of a vector with a name, and its components.
    Length(String, Vec<Tree>),
    Compare(Sign, Box<[Tree; 2]>),
    Not(Box<Tree>),
    All(Vec<Tree>),
    Any(Vec<Tree>),
    /// A word for a group of atoms, such as `protein`.
    Group(Group),
    /// A column, and the values of which it has one.
    OneOf(Box<Tree>, Vec<Value>),
    /// Particles within a distance of those of a condition; without these themselves if `others` is true.
    Within {
        distance: f64,
        others: bool,
        of: Box<Tree>,
    },
    /// Particles with the same residue or value of a column as one of those of a condition.
    Same {
        column: String,
        of: Box<Tree>,
    },
}

/// A value in a list, as in `name CA C*` or `resid 5 to 10`.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// A text, or a number as it is written.
    Text(String),
    /// The beginning of texts, before a `*`.
    Pattern(String),
    /// Numbers from the first to the second, both included.
    Range(f64, f64),
}

/// A parser: the words that are not parsed yet.
pub(super) struct Parser<'t> {
    pub(super) words: Vec<(Word, Range<usize>)>,
    /// Index of the next word.
    pub(super) next: usize,
    pub(super) text: &'t str,
    pub(super) depth: usize,
}

const COMPARISONS: [Sign; 6] =
    [Sign::Equal, Sign::NotEqual, Sign::Less, Sign::LessEqual, Sign::Greater, Sign::GreaterEqual];

/// Parses all words, as a condition.
pub(super) fn parse(words: Words, text: &str) -> Result<Tree, SpannedError> {
    let mut parser = Parser { words, next: 0, text, depth: 0 };
    let tree = parser.any()?;
    parser.end("expected `and`, `or` or an operator before this")?;
    Ok(tree)
}

/// Parses all words, as a number.
pub(super) fn parse_number(words: Words, text: &str) -> Result<Tree, SpannedError> {
    let mut parser = Parser { words, next: 0, text, depth: 0 };
    let tree = parser.sum()?;
    parser.end("expected an operator before this, as in `x + y`")?;
    Ok(tree)
}

fn unexpected_comma(span: Range<usize>) -> SpannedError {
    (span, "unexpected `,`".to_owned())
}

impl Parser<'_> {
    /// Refuses words that are left, with a message for those that are neither parentheses nor commas.
    fn end(&mut self, message: &str) -> Result<(), SpannedError> {
        match self.advance() {
            None => Ok(()),
            Some((Word::Sign(Sign::Close), span)) => Err((span, "unmatched `)`".to_owned())),
            Some((Word::Sign(Sign::Comma), span)) => Err(unexpected_comma(span)),
            Some((_, span)) => Err((span, message.to_owned())),
        }
    }

    /// Takes the next word if it is one of these operators.
    fn take(&mut self, signs: &[Sign]) -> Option<(Sign, Range<usize>)> {
        match self.peek(0)? {
            (Word::Sign(sign), span) if signs.contains(sign) => {
                let found = (*sign, span.clone());
                self.next += 1;
                Some(found)
            }
            _ => None,
        }
    }

    /// Returns the word that is `ahead` words after the next one.
    pub(super) fn peek(&self, ahead: usize) -> Option<&(Word, Range<usize>)> {
        self.words.get(self.next + ahead)
    }

    pub(super) fn advance(&mut self) -> Option<(Word, Range<usize>)> {
        let word = self.words.get(self.next).cloned();
        self.next += usize::from(word.is_some());
        word
    }

    pub(super) fn deeper(&mut self, span: &Range<usize>) -> Result<(), SpannedError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err((span.clone(), format!("more than {MAX_DEPTH} levels of nesting")));
        }
        Ok(())
    }

    fn any(&mut self) -> Result<Tree, SpannedError> {
        self.joined(Sign::Or, Node::Any, Self::all)
    }

    fn all(&mut self) -> Result<Tree, SpannedError> {
        self.joined(Sign::And, Node::All, Self::not)
    }

    /// Parses parts with an operator between them; a single part is returned itself.
    fn joined(
        &mut self,
        sign: Sign,
        node: fn(Vec<Tree>) -> Node,
        part: fn(&mut Self) -> Result<Tree, SpannedError>,
    ) -> Result<Tree, SpannedError> {
        let first = part(self)?;
        let mut span = first.span.clone();
        let mut parts = vec![first];
        while self.take(&[sign]).is_some() {
            let next = part(self)?;
            span.end = next.span.end;
            parts.push(next);
        }
        if parts.len() == 1 {
            return Ok(parts.remove(0));
        }
        Ok(Tree { node: node(parts), span })
    }

    pub(super) fn not(&mut self) -> Result<Tree, SpannedError> {
        let Some((_, span)) = self.take(&[Sign::Not]) else {
            return match self.group_or_list()? {
                Some(tree) => Ok(tree),
                None => self.comparison(),
            };
        };
        self.deeper(&span)?;
        let inner = self.not()?;
        self.depth -= 1;
        let span = span.start..inner.span.end;
        Ok(Tree { node: Node::Not(Box::new(inner)), span })
    }

    fn comparison(&mut self) -> Result<Tree, SpannedError> {
        let left = self.sum()?;
        let Some((sign, _)) = self.take(&COMPARISONS) else { return Ok(left) };
        let right = self.sum()?;
        if let Some((_, span)) = self.take(&COMPARISONS) {
            return Err((
                span,
                "comparisons cannot be chained: write `0 < z and z < 5`".to_owned(),
            ));
        }
        let span = left.span.start..right.span.end;
        Ok(Tree { node: Node::Compare(sign, Box::new([left, right])), span })
    }

    fn sum(&mut self) -> Result<Tree, SpannedError> {
        self.chain(&[Sign::Plus, Sign::Minus], Self::product)
    }

    fn product(&mut self) -> Result<Tree, SpannedError> {
        self.chain(&[Sign::Times, Sign::Divided], Self::power)
    }

    fn chain(
        &mut self,
        signs: &[Sign],
        part: fn(&mut Self) -> Result<Tree, SpannedError>,
    ) -> Result<Tree, SpannedError> {
        let first = part(self)?;
        let mut span = first.span.clone();
        let mut rest = Vec::new();
        while let Some((sign, _)) = self.take(signs) {
            let next = part(self)?;
            span.end = next.span.end;
            rest.push((sign, next));
        }
        if rest.is_empty() {
            return Ok(first);
        }
        Ok(Tree { node: Node::Arithmetic(Box::new(first), rest), span })
    }

    /// Parses an operand and its power, which binds before a sign: `-x^2` is `-(x^2)`, and `x^y^z` is `x^(y^z)`.
    fn power(&mut self) -> Result<Tree, SpannedError> {
        let base = self.operand()?;
        let Some((_, sign)) = self.take(&[Sign::Power]) else { return Ok(base) };
        self.deeper(&sign)?;
        let exponent = self.power()?;
        self.depth -= 1;
        let span = base.span.start..exponent.span.end;
        Ok(Tree { node: Node::Call(Function::Power, vec![base, exponent]), span })
    }

    fn operand(&mut self) -> Result<Tree, SpannedError> {
        let Some((word, span)) = self.advance() else {
            let end = self.text.len();
            return Err((end..end, "expected a number or a name here".to_owned()));
        };
        let node = match word {
            Word::Number(number) => Node::Number(number),
            Word::Bare(name) if self.is_call(&name, &span) => return self.call(&name, span),
            Word::Bare(name) => Node::Word(name),
            Word::Column(name) => Node::Column(name),
            Word::Text(text) => Node::Text(text),
            Word::Mixed(_, message) => return Err((span, message)),
            Word::Sign(Sign::Minus) => return self.negative(span),
            Word::Sign(Sign::Open) => return self.parentheses(span),
            Word::Sign(Sign::Comma) => return Err(unexpected_comma(span)),
            Word::Sign(_) => {
                return Err((span, "expected a number or a name before this".to_owned()));
            }
        };
        Ok(Tree { node, span })
    }

    fn negative(&mut self, sign: Range<usize>) -> Result<Tree, SpannedError> {
        self.deeper(&sign)?;
        let inner = self.power()?;
        self.depth -= 1;
        let span = sign.start..inner.span.end;
        Ok(Tree { node: Node::Negative(Box::new(inner)), span })
    }

    fn parentheses(&mut self, open: Range<usize>) -> Result<Tree, SpannedError> {
        self.deeper(&open)?;
        let inner = self.any()?;
        self.depth -= 1;
        let Some((_, close)) = self.take(&[Sign::Close]) else {
            return Err((open, "unclosed parenthesis".to_owned()));
        };
        Ok(Tree { span: open.start..close.end, ..inner })
    }

    /// Returns whether the word before the next one is called: a function before a parenthesis, or any name that
    /// touches one.
    fn is_call(&self, name: &str, span: &Range<usize>) -> bool {
        let follows = self.peek(0).filter(|(word, _)| *word == Word::Sign(Sign::Open));
        follows.is_some_and(|(_, open)| open.start == span.end || Function::named(name).is_some())
    }

    /// Parses the arguments of a function.
    fn call(&mut self, name: &str, span: Range<usize>) -> Result<Tree, SpannedError> {
        let Some(function) = Function::named(name) else {
            let help = suggest::help(name, Function::names(), "functions are");
            return Err((span, format!("no function is named `{name}`; {help}")));
        };
        let open = self.take(&[Sign::Open]).map_or(span.clone(), |(_, open)| open);
        self.deeper(&open)?;
        let mut arguments = vec![self.sum()?];
        while self.take(&[Sign::Comma]).is_some() {
            arguments.push(self.sum()?);
        }
        self.depth -= 1;
        let Some((_, close)) = self.take(&[Sign::Close]) else {
            return Err(match self.advance() {
                None => (open, "unclosed parenthesis".to_owned()),
                Some((_, span)) => {
                    (span, "expected an operator, `,` or `)` before this".to_owned())
                }
            });
        };
        let span = span.start..close.end;
        if function == Function::Norm
            && let Some((name, components)) = vector(&arguments)
        {
            return Ok(Tree { node: Node::Length(name, components), span });
        }
        match function.refuse(arguments.len()) {
            Some(what) => Err((span, format!("`{name}` takes {what}"))),
            None => Ok(Tree { node: Node::Call(function, arguments), span }),
        }
    }
}

/// Returns the name of a vector and its components, if there is nothing else.
fn vector(arguments: &[Tree]) -> Option<(String, Vec<Tree>)> {
    let [Tree { node: Node::Word(name) | Node::Column(name), span }] = arguments else {
        return None;
    };
    let VectorColumns(names) = name.parse().ok()?;
    let component = |name| Tree { node: Node::Column(name), span: span.clone() };
    Some((name.clone(), names.map(component).into()))
}

/// Appends the names of all columns of a condition or of an expression.
pub(super) fn collect(tree: &Tree, names: &mut Vec<String>) {
    match &tree.node {
        Node::Number(_) | Node::Text(_) => (),
        Node::Word(name) | Node::Column(name) => names.push(name.clone()),
        Node::Negative(inner) | Node::Not(inner) => collect(inner, names),
        Node::Compare(_, sides) => sides.iter().for_each(|side| collect(side, names)),
        Node::Arithmetic(first, rest) => {
            collect(first, names);
            for (_, operand) in rest {
                collect(operand, names);
            }
        }
        Node::All(parts) | Node::Any(parts) | Node::Call(_, parts) | Node::Length(_, parts) => {
            for part in parts {
                collect(part, names);
            }
        }
        Node::OneOf(column, _) => collect(column, names),
        Node::Group(group) => names.extend(group.columns().iter().map(|&name| name.to_owned())),
        Node::Within { of, .. } => collect(of, names),
        Node::Same { column, of } => {
            names.extend(columns_of(column));
            collect(of, names);
        }
    }
}
