//! Tokenizer of CIF files.

use crate::FileError;
use crate::lines::{Line, Lines};
use std::path::Path;
use std::sync::Arc;

/// Maximum length of a text field of several lines, in bytes.
const LONGEST: usize = 1 << 26;

/// A token of a CIF file.
#[derive(Debug, PartialEq)]
pub(super) enum Token<'t> {
    /// `loop_`.
    Loop,
    /// `data_`, `save_` and other keywords that begin or end a block.
    Block,
    /// The name of an item, in any case.
    Tag(&'t str),
    /// A value, without its quotes.
    Value(&'t [u8]),
}

/// Splits a file into tokens.
pub(super) struct Tokens {
    lines: Lines,
    number: usize,
    /// The current line, and the position in it.
    line: Vec<u8>,
    at: usize,
    /// The last token, and whether it was unquoted.
    word: Vec<u8>,
    bare: bool,
    ended: bool,
    /// True if the last token is returned again.
    again: bool,
}

impl Tokens {
    pub(super) fn new(lines: Lines) -> Self {
        Self {
            lines,
            number: 0,
            line: Vec::new(),
            at: 0,
            word: Vec::new(),
            bare: false,
            ended: false,
            again: false,
        }
    }

    /// Returns the next token, if there is one.
    pub(super) fn next(&mut self) -> Result<Option<Token<'_>>, FileError> {
        if !std::mem::take(&mut self.again) {
            self.ended = !self.advance()?;
        }
        Ok(if self.ended { None } else { Some(self.token()) })
    }

    /// Steps back, so that [`Tokens::next`] returns the last token again.
    pub(super) fn back(&mut self) {
        self.again = true;
    }

    /// Returns the tags that begin a loop, after `loop_`.
    pub(super) fn tags(&mut self) -> Result<Vec<String>, FileError> {
        let mut tags = Vec::new();
        while let Some(Token::Tag(tag)) = self.next()? {
            tags.push(tag.to_owned());
        }
        self.back();
        Ok(tags)
    }

    /// Returns the last token as it is in the file, without quotes.
    pub(super) fn word(&self) -> &[u8] {
        &self.word
    }

    /// Returns the line of the last token.
    pub(super) fn line(&self) -> Line<'_> {
        Line::new(self.lines.path(), self.number, &self.line)
    }

    /// Returns an error at the last token's line.
    pub(super) fn error(&self, message: impl Into<String>) -> FileError {
        self.line().whole(message)
    }

    pub(super) fn path(&self) -> &Arc<Path> {
        self.lines.path()
    }

    fn token(&self) -> Token<'_> {
        let word = &self.word[..];
        if !self.bare {
            return Token::Value(word);
        }
        let begins = |start: &[u8]| {
            word.get(..start.len()).is_some_and(|own| own.eq_ignore_ascii_case(start))
        };
        match std::str::from_utf8(word) {
            Ok(tag) if word[0] == b'_' => Token::Tag(tag),
            _ if word.eq_ignore_ascii_case(b"loop_") => Token::Loop,
            _ if begins(b"data_") || begins(b"save_") || begins(b"global_") || begins(b"stop_") => {
                Token::Block
            }
            _ => Token::Value(word),
        }
    }

    /// Moves to the next token. Returns whether there is one.
    fn advance(&mut self) -> Result<bool, FileError> {
        loop {
            while self.line.get(self.at).is_some_and(|byte| is_blank(*byte)) {
                self.at += 1;
            }
            match self.line.get(self.at) {
                None | Some(b'#') => {
                    if !self.next_line()? {
                        return Ok(false);
                    }
                    if self.line.first() == Some(&b';') {
                        self.text()?;
                        return Ok(true);
                    }
                }
                Some(&quote @ (b'"' | b'\'')) => return self.quoted(quote).map(|()| true),
                Some(_) => {
                    let rest = &self.line[self.at..];
                    let end = rest.iter().position(|byte| is_blank(*byte)).unwrap_or(rest.len());
                    self.word.clear();
                    self.word.extend_from_slice(&rest[..end]);
                    (self.at, self.bare) = (self.at + end, true);
                    return Ok(true);
                }
            }
        }
    }

    fn next_line(&mut self) -> Result<bool, FileError> {
        self.line.clear();
        self.at = 0;
        self.number += 1;
        let Some(line) = self.lines.next()? else { return Ok(false) };
        self.line.extend_from_slice(line.bytes);
        Ok(true)
    }

    /// Reads a quoted value: it ends with a quote before a blank.
    fn quoted(&mut self, quote: u8) -> Result<(), FileError> {
        let start = self.at + 1;
        let mut ends = memchr::memchr_iter(quote, &self.line[start..]);
        let is_end =
            |end: &usize| self.line.get(start + end + 1).is_none_or(|byte| is_blank(*byte));
        let Some(end) = ends.find(is_end) else {
            let error = self.line().error(self.at..self.line.len(), "this quote is not closed");
            return Err(error.with_help("a quoted value ends on its line"));
        };
        self.word.clear();
        self.word.extend_from_slice(&self.line[start..start + end]);
        (self.at, self.bare) = (start + end + 1, false);
        Ok(())
    }

    /// Reads a text field of several lines: from a `;` that begins a line to the next one.
    fn text(&mut self) -> Result<(), FileError> {
        let first = self.number;
        self.word.clear();
        self.word.extend_from_slice(&self.line[1..]);
        self.bare = false;
        loop {
            if !self.next_line()? {
                let message = format!("the text that begins at line {first} does not end");
                return Err(self.error(message).with_help("the file is cut off"));
            }
            if self.line.first() == Some(&b';') {
                self.at = 1;
                return Ok(());
            }
            if self.word.len() > LONGEST {
                let message = format!("the text that begins at line {first} is too long");
                return Err(self.error(message).with_help("close it by a line that begins with ;"));
            }
            self.word.push(b'\n');
            self.word.extend_from_slice(&self.line);
        }
    }
}

fn is_blank(byte: u8) -> bool {
    byte == b' ' || byte == b'\t' || byte == b'\r'
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ReadProgress;
    use crate::source::{Bytes, Source};

    fn words(text: &str) -> Result<Vec<String>, String> {
        let head = text.as_bytes().to_vec();
        let (reader, progress) = (Bytes::stream(std::io::empty()), ReadProgress::default());
        let source = Source { path: Path::new("c").into(), head, reader, progress };
        let mut tokens = Tokens::new(Lines::new(source));
        let mut words = Vec::new();
        while let Some(token) = tokens.next().map_err(|error| error.message)? {
            words.push(match token {
                Token::Value(value) => String::from_utf8_lossy(value).into_owned(),
                other => format!("{other:?}"),
            });
        }
        Ok(words)
    }

    #[test]
    fn tokens_follow_the_grammar_of_cif() {
        let text =
            "data_X #c\nLOOP_\n_a.b 'it''s' \"q # q\" x#y 'a' ''\n;one\n two\n; last\n;\n;\n";
        let expected = [
            "Block",
            "Loop",
            "Tag(\"_a.b\")",
            "it''s",
            "q # q",
            "x#y",
            "a",
            "",
            "one\n two",
            "last",
            "",
        ];
        assert_eq!(words(text), Ok(expected.map(str::to_owned).into()));
        assert_eq!(words("'_a' data"), Ok(vec!["_a".to_owned(), "data".to_owned()]));
    }

    #[test]
    fn unclosed_texts_are_reported() {
        assert_eq!(words("a 'b c"), Err("this quote is not closed".to_owned()));
        let message = "the text that begins at line 2 does not end";
        assert_eq!(words("a\n;b\nc"), Err(message.to_owned()));
    }
}
