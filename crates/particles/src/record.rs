//! Splits rows of separated values into unquoted fields.

use csv_core::{ReadRecordResult, ReaderBuilder};

/// Fields of a line, without quotes.
#[derive(Default)]
pub(crate) struct Record {
    bytes: Vec<u8>,
    ends: Vec<usize>,
}

impl Record {
    /// Splits a line into fields; no field is longer than the line.
    pub(crate) fn read(&mut self, line: &[u8], separator: u8) {
        self.bytes.resize(line.len() + 1, 0);
        self.ends.resize(line.len() + 2, 0);
        let mut reader = ReaderBuilder::new().delimiter(separator).build();
        let (mut input, mut written, mut ended) = (line, 0, 0);
        loop {
            let (result, used, bytes, ends) =
                reader.read_record(input, &mut self.bytes[written..], &mut self.ends[ended..]);
            (input, written, ended) = (&input[used..], written + bytes, ended + ends);
            if result != ReadRecordResult::InputEmpty || used == 0 {
                break;
            }
        }
        self.ends.truncate(ended);
    }

    /// Returns the fields.
    pub(crate) fn fields(&self) -> impl Iterator<Item = &[u8]> {
        let starts = [0].into_iter().chain(self.ends.iter().copied());
        starts.zip(&self.ends).map(|(start, &end)| &self.bytes[start..end])
    }
}

/// Returns the names of a header.
pub(crate) fn header_names(line: &[u8]) -> Vec<String> {
    let mut record = Record::default();
    record.read(line, separator(line));
    record.fields().map(|field| String::from_utf8_lossy(field.trim_ascii()).into_owned()).collect()
}

/// Returns the separator of columns: the most frequent candidate.
pub(crate) fn separator(header: &[u8]) -> u8 {
    let count = |separator: &u8| header.split(|byte| byte == separator).count();
    // The last wins ties: a comma if there is no separator.
    [b'\t', b';', b','].into_iter().max_by_key(count).unwrap_or(b',')
}
