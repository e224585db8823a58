//! Splits a text file into lines, in large blocks. Lines end with LF, CR LF, or CR alone, mixed as they may be.

pub(crate) use super::line::Line;
use super::line::end_lines;
use crate::{FileError, place::Place, source::Bytes, source::Source};
use memchr::{memchr, memchr_iter};
use std::any::Any;
use std::io::{self, Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// Maximum length of a line in bytes: a longer one indicates that the file is not text.
pub(crate) const LONGEST: usize = 1 << 20;

/// Bytes per read; an incomplete line moves to the front of the buffer before each read.
const BLOCK: usize = 1 << 18;

/// Reader of a file's lines.
pub(crate) struct Lines {
    path: Arc<Path>,
    reader: Bytes,
    /// Number of bytes of the file that were read.
    read: u64,
    /// Bytes of the file; `start..end` is not yet consumed.
    buffer: Vec<u8>,
    start: usize,
    end: usize,
    /// Offset up to which lone carriage returns are newlines: those at the end wait for the byte after them.
    settled: usize,
    ended: bool,
    number: usize,
    /// Offset of the last line; `returned` is true if it ended with a carriage return.
    last: usize,
    returned: bool,
}

impl Lines {
    pub(crate) fn new(source: Source) -> Self {
        let Source { path, mut head, reader, .. } = source;
        let read = head.len() as u64;
        if head.starts_with(b"\xEF\xBB\xBF") {
            head.drain(..3);
        }
        let settled = end_lines(&mut head);
        let end = head.len();
        Self {
            path,
            reader,
            read,
            buffer: head,
            start: 0,
            end,
            settled,
            ended: false,
            number: 0,
            last: 0,
            returned: false,
        }
    }

    /// Returns the next line, if there is one.
    pub(crate) fn next(&mut self) -> Result<Option<Line<'_>>, FileError> {
        let range = self.advance()?;
        Ok(range.map(|range| Line::new(&self.path, self.number, &self.buffer[range])))
    }

    /// Returns the next line, or an error that the file ends before `what`.
    pub(crate) fn require(&mut self, what: &str) -> Result<Line<'_>, FileError> {
        match self.advance()? {
            Some(range) => Ok(Line::new(&self.path, self.number, &self.buffer[range])),
            None => Err(self.ended(format!("the file ends before {what}"))),
        }
    }

    /// Returns the line of a row, or an error that the file ends before all `count` of `what` were read.
    pub(crate) fn row(
        &mut self,
        row: u64,
        count: u64,
        what: &str,
        help: &str,
    ) -> Result<Line<'_>, FileError> {
        let range = self.advance()?.ok_or_else(|| {
            self.ended(format!("the file ends after {row} of {count} {what}")).with_help(help)
        })?;
        Ok(Line::new(&self.path, self.number, &self.buffer[range]))
    }

    /// Moves past the next line, and returns its range in the buffer.
    fn advance(&mut self) -> Result<Option<Range<usize>>, FileError> {
        self.number += 1;
        let Some(mut range) = self.find()? else {
            self.last = self.start;
            return Ok(None);
        };
        self.last = range.start;
        self.returned = self.buffer[range.clone()].last() == Some(&b'\r');
        range.end -= usize::from(self.returned);
        Ok(Some(range))
    }

    /// Returns the line ending of the last line.
    pub(crate) fn ending(&self) -> &'static [u8] {
        if self.returned { b"\r\n" } else { b"\n" }
    }

    /// Steps back, so that [`Lines::next`] returns the last line again.
    pub(crate) fn back(&mut self) {
        self.start = self.last;
        self.number -= 1;
    }

    /// Skips blank lines. Returns whether another line follows, which is not consumed.
    pub(crate) fn more(&mut self) -> Result<bool, FileError> {
        while let Some(line) = self.next()? {
            if !line.is_blank() {
                self.back();
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Returns up to a block of the following bytes without consuming them.
    pub(crate) fn ahead(&mut self) -> Result<&[u8], FileError> {
        while self.end - self.start < BLOCK / 4 && self.fill()? {}
        Ok(&self.buffer[self.start..self.end])
    }

    /// Skips up to `count` lines without parsing them. Returns the number of skipped lines.
    pub(crate) fn skip(&mut self, count: u64) -> Result<u64, FileError> {
        let mut passed = 0;
        while passed < count {
            let rest = &self.buffer[self.start..self.end];
            let wanted = usize::try_from(count - passed - 1).unwrap_or(usize::MAX);
            if let Some(newline) = memchr_iter(b'\n', rest).nth(wanted) {
                self.start += newline + 1;
                passed = count;
                break;
            }
            passed += memchr_iter(b'\n', rest).count() as u64;
            let newline = memchr::memrchr(b'\n', rest).map_or(0, |newline| newline + 1);
            self.start += newline;
            if !self.fill()? {
                passed += u64::from(self.start < self.end);
                self.start = self.end;
                break;
            }
        }
        self.number += passed as usize;
        Ok(passed)
    }

    /// Returns the range of the next line in the buffer and moves past it.
    fn find(&mut self) -> Result<Option<Range<usize>>, FileError> {
        let mut looked = 0;
        loop {
            let rest = &self.buffer[self.start..self.end];
            if let Some(newline) = memchr(b'\n', &rest[looked..]) {
                let line = self.start..self.start + looked + newline;
                self.start = line.end + 1;
                return Ok(Some(line));
            }
            looked = self.settled.saturating_sub(self.start);
            if !self.fill()? {
                let line = self.start..self.end;
                self.start = self.end;
                return Ok(Some(line).filter(|line| !line.is_empty()));
            }
        }
    }

    /// Appends more bytes to the buffer. Returns whether there were any.
    fn fill(&mut self) -> Result<bool, FileError> {
        if self.ended {
            return Ok(false);
        }
        if self.end - self.start >= LONGEST {
            let message = format!("line {} is longer than {LONGEST} bytes", self.number.max(1));
            return Err(FileError::whole_file(&self.path, message)
                .with_help("a file of particles has one line for each particle"));
        }
        self.buffer.copy_within(self.start..self.end, 0);
        self.settled = self.settled.saturating_sub(self.start);
        (self.start, self.end) = (0, self.end - self.start);
        if self.buffer.len() < self.end + BLOCK {
            self.buffer.resize(self.end + BLOCK, 0);
        }
        let length = loop {
            match self.reader.read(&mut self.buffer[self.end..]) {
                Err(error) if error.kind() == io::ErrorKind::Interrupted => (),
                outcome => break outcome.map_err(|error| self.failed(&error))?,
            }
        };
        self.end += length;
        self.read += length as u64;
        self.settled += end_lines(&mut self.buffer[self.settled..self.end]);
        self.ended = length == 0;
        Ok(!self.ended)
    }

    /// Returns the place of the next line; `None` if the bytes can be read only once.
    pub(crate) fn place(&self) -> Option<Place> {
        let offset = self.read - (self.end - self.start) as u64;
        matches!(self.reader, Bytes::File(_)).then(|| Place::new(offset, self.number as u64))
    }

    /// Starts at the place of a line, if the bytes can be read again. Returns whether it did.
    pub(crate) fn start_at(&mut self, place: &Place) -> Result<bool, FileError> {
        let Bytes::File(file) = &mut self.reader else { return Ok(false) };
        self.number = place.number as usize;
        if let Err(error) = file.seek(SeekFrom::Start(place.offset)) {
            return Err(self.failed(&error));
        }
        self.read = place.offset;
        (self.start, self.end, self.settled, self.last) = (0, 0, 0, 0);
        (self.ended, self.returned) = (false, false);
        Ok(true)
    }

    /// Starts at the place of a line, with what its reader knew there of earlier frames. Returns whether it did.
    pub(crate) fn start_with<T: Any + Send + Sync>(
        &mut self,
        place: &Place,
        known: &mut Arc<T>,
    ) -> Result<bool, FileError> {
        let Some(state) = place.state() else { return Ok(false) };
        let started = self.start_at(place)?;
        if started {
            *known = state;
        }
        Ok(started)
    }

    /// Returns an error after the last line.
    pub(crate) fn ended(&self, message: impl Into<String>) -> FileError {
        let error = FileError::at(&self.path, "", self.number, 0..0, message);
        FileError { cut_off: true, ..error }
    }

    fn failed(&self, error: &io::Error) -> FileError {
        let message = format!("cannot be read at line {}: {error}", self.number.max(1));
        let cut_off = error.kind() == io::ErrorKind::UnexpectedEof;
        FileError { cut_off, ..FileError::whole_file(&self.path, message) }
    }

    pub(crate) fn path(&self) -> &Arc<Path> {
        &self.path
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ReadProgress;

    /// Reader that returns a few bytes at a time, as pipes do.
    struct SmallReads(Vec<u8>, usize);

    impl Read for SmallReads {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let length = self.1.min(self.0.len()).min(buffer.len());
            buffer[..length].copy_from_slice(&self.0[..length]);
            self.0.drain(..length);
            Ok(length)
        }
    }

    fn lines(text: &str, drop: usize) -> Lines {
        let reader = Bytes::stream(SmallReads(text.as_bytes().to_vec(), drop));
        let progress = ReadProgress::default();
        Lines::new(Source { path: Path::new("p").into(), head: Vec::new(), reader, progress })
    }

    #[test]
    fn lines_do_not_depend_on_block_boundaries() {
        let text = "a\r\n\nbcd\n\u{e4}\nlast";
        for drop in 1..12 {
            let mut lines = lines(text, drop);
            let mut all = Vec::new();
            while let Some(line) = lines.next().expect("lines") {
                all.push((line.number_in_file(), line.text().into_owned()));
            }
            let expected = ["a", "", "bcd", "\u{e4}", "last"].map(str::to_owned);
            assert_eq!(all, (1..).zip(expected).collect::<Vec<_>>(), "{drop}");
            assert!(lines.next().expect("no fault").is_none());
        }
    }

    #[test]
    fn carriage_returns_alone_end_lines() {
        for (text, expected) in [
            ("a\rb\r", &["a", "b"][..]),
            ("a\r\rb", &["a", "", "b"]),
            ("a\nb\rc\r\nd", &["a", "b", "c", "d"]),
            // Those of a newline that was converted twice belong to it.
            ("a\r\r\nb\r\r\r\n", &["a\r", "b\r\r"]),
            ("\r\ra", &["", "", "a"]),
        ] {
            for drop in 1..9 {
                let mut read = lines(text, drop);
                let mut all = Vec::new();
                while let Some(line) = read.next().expect("lines") {
                    all.push(line.text().into_owned());
                }
                assert_eq!(all, expected, "{drop} {text:?}");
                let mut skipped = lines(text, drop);
                assert_eq!(
                    skipped.skip(9).expect("lines"),
                    expected.len() as u64,
                    "{drop} {text:?}"
                );
            }
        }
    }

    #[test]
    fn skipping_equals_reading() {
        for drop in 1..8 {
            for count in 0..7 {
                let mut lines = lines("1\n22\n333\n4444\n5", drop);
                assert_eq!(lines.skip(count).expect("lines"), count.min(5));
                let next = lines.next().expect("a line");
                let next = next.map(|line| (line.text().into_owned(), line.number_in_file()));
                let expected = ["1", "22", "333", "4444", "5"].get(count as usize);
                let expected = expected.map(|text| ((*text).to_owned(), count as usize + 1));
                assert_eq!(next, expected, "{drop} {count}");
            }
        }
    }

    #[test]
    fn returned_lines_are_read_again() {
        let mut lines = lines("one\ntwo\n", 3);
        for _ in 0..3 {
            assert_eq!(lines.next().expect("a line").map(|line| line.number_in_file()), Some(1));
            lines.back();
        }
        assert_eq!(lines.skip(9).expect("lines"), 2);
    }

    #[test]
    fn endless_lines_are_errors() {
        let mut lines = lines(&"1".repeat(LONGEST + BLOCK), BLOCK);
        let error = lines.next().err().expect("a fault");
        assert!(error.message.contains("longer than"), "{error}");
        for (length, fits) in [(LONGEST - 1, true), (LONGEST, false)] {
            let mut lines = self::lines(&("1".repeat(length) + "\n"), BLOCK);
            let read = lines.next().ok().flatten().map(|line| line.bytes.len());
            assert_eq!(read, fits.then_some(length));
        }
    }

    #[test]
    fn the_next_bytes_can_be_peeked() {
        let text = "1".repeat(60_000) + "\n" + &"2".repeat(200_000);
        let mut long = lines(&text, 70_000);
        assert!(long.ahead().expect("bytes").len() >= BLOCK / 4);
        assert_eq!(long.next().expect("a line").map(|line| line.bytes.len()), Some(60_000));
        let ahead = long.ahead().expect("bytes");
        assert!(ahead.len() >= BLOCK / 4 && ahead.iter().all(|byte| *byte == b'2'));
        assert_eq!(long.next().expect("a line").map(|line| line.bytes.len()), Some(200_000));
        assert_eq!(lines("a\nb", 1).ahead().expect("bytes"), b"a\nb");
    }

    /// Reader that returns errors of these kinds, then these bytes.
    struct Fails(&'static [u8], Vec<io::ErrorKind>);

    impl Read for Fails {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            if let Some(kind) = self.1.pop() {
                return Err(kind.into());
            }
            self.0.read(buffer)
        }
    }

    fn failing(kinds: &[io::ErrorKind]) -> Lines {
        let reader = Bytes::stream(Fails(b"one\ntwo\n", kinds.to_vec()));
        let progress = ReadProgress::default();
        Lines::new(Source { path: Path::new("p").into(), head: Vec::new(), reader, progress })
    }

    #[test]
    fn interrupted_reads_are_repeated_and_other_errors_reported() {
        let mut lines = failing(&[io::ErrorKind::Interrupted; 3]);
        assert_eq!(lines.skip(9).expect("lines"), 2);
        for (kind, cut_off) in
            [(io::ErrorKind::UnexpectedEof, true), (io::ErrorKind::PermissionDenied, false)]
        {
            let error = failing(&[kind]).next().err().expect("a fault");
            assert_eq!(error.cut_off, cut_off, "{error}");
        }
        assert!(failing(&[]).ended("too short").cut_off);
    }
}
