//! Mutation of corpus files: accidental and malicious damage.

use crate::png;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::ops::Range;

/// Maximum length of a mutant, to bound the time of readers.
const LONGEST: usize = 1 << 19;

/// Replacements for numbers.
const NUMBERS: &str = "nan inf -inf 0 -0 -0.0 0.0 1 -1 0.5 1e308 -1e308 1e999 1e-320 1e-45 1e38 \
                       3.5e38 1e20 1e-20 1e-310 255 65535 65536 100000 4294967279 4294967280 \
                       4294967295 4294967296 2000000000 1000000000 9223372036854775807 \
                       9223372036854775808 18446744073709551615 18446744073709551616 0xffffffff \
                       99999999999999999999999999999999999999999999999999";

/// Bytes with and without a meaning to readers.
const WORDS: [&[u8]; 30] = [
    b"\0",
    b"\xff",
    b"\xff\xfe",
    b"\xef\xbb\xbf",
    b"\r\n",
    b"\r",
    b"\n",
    b"\n\n",
    b"\"",
    b"'",
    b"\"\"\"",
    b"'''",
    b"\\u0000",
    b"\\",
    b"#",
    b",",
    b";",
    b"\t",
    b"=",
    b"[",
    b"]",
    b"{",
    b"}",
    b"[[",
    b"]]",
    b".",
    b"\xc3",
    b"\xe2\x80\xa8",
    b" ",
    b"\x1f\x8b",
];

/// Numbers in headers of images.
const CLAIMS: [u32; 12] =
    [0, 1, 2, 255, 256, 0x3fff, 0x7fff, 0x8000, 0xffff, 0x7fff_ffff, 0x8000_0000, u32::MAX];

/// Kinds of damage: all; those that leave most lines readable; those to a number.
const KINDS: usize = 16;
const ABSURD: Range<usize> = 10..KINDS;
const NUMBER: Range<usize> = 13..KINDS;

/// A generator of mutants, determined by its seed.
pub(crate) struct Mutator(Xoshiro256PlusPlus);

impl Mutator {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// Returns a uniform number in `0..end`, for `end` above 0.
    pub(crate) fn below(&mut self, end: usize) -> usize {
        (self.0.next_u64() % end as u64) as usize
    }

    /// Returns a random element.
    pub(crate) fn one_of<'t, T>(&mut self, these: &'t [T]) -> &'t T {
        &these[self.below(these.len())]
    }

    /// Returns a mutant: one of the seeds with one or more kinds of damage.
    pub(crate) fn mutant(&mut self, seeds: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = self.one_of(seeds).clone();
        // Readers reject most damage early; extreme values get further.
        let kinds = self.one_of(&[0..KINDS, ABSURD, NUMBER]).clone();
        for _ in 0..=self.below(4) {
            self.damage(&mut bytes, seeds, kinds.clone());
            bytes.truncate(LONGEST);
        }
        if bytes.starts_with(b"\x89PNG") && self.below(4) > 0 {
            png::seal(&mut bytes);
        }
        bytes
    }

    fn damage(&mut self, bytes: &mut Vec<u8>, seeds: &[Vec<u8>], kinds: Range<usize>) {
        match kinds.start + self.below(kinds.len()) {
            0 => self.flip_bit(bytes),
            1 => self.put_word(bytes),
            2 => drop(bytes.drain(self.range(bytes))),
            3 => self.copy_range(bytes),
            4 => bytes.truncate(self.below(bytes.len() + 1)),
            5 => self.splice(bytes, seeds),
            6 => self.nest(bytes),
            7 => self.lengthen(bytes),
            8 => self.claim(bytes),
            9 => self.scramble(bytes),
            10 => self.swap_tokens(bytes),
            11 => self.repeat_line(bytes),
            12 => self.move_line(bytes, seeds),
            _ => self.replace_number(bytes),
        }
    }

    /// Returns a range of up to 64 bytes, or of any length.
    fn range(&mut self, bytes: &[u8]) -> Range<usize> {
        let start = self.below(bytes.len() + 1);
        let most = bytes.len() - start;
        let most = if self.below(4) > 0 { most.min(64) } else { most };
        start..start + self.below(most + 1)
    }

    fn flip_bit(&mut self, bytes: &mut [u8]) {
        if !bytes.is_empty() {
            let at = self.below(bytes.len());
            bytes[at] ^= 1 << self.below(8);
        }
    }

    fn put_word(&mut self, bytes: &mut Vec<u8>) {
        let at = self.below(bytes.len() + 1);
        let end = at + self.below(2).min(bytes.len() - at);
        bytes.splice(at..end, self.one_of(&WORDS).iter().copied());
    }

    fn copy_range(&mut self, bytes: &mut Vec<u8>) {
        let copy = bytes[self.range(bytes)].to_vec();
        let at = self.below(bytes.len() + 1);
        bytes.splice(at..at, copy);
    }

    /// Replaces a part by a part of another seed.
    fn splice(&mut self, bytes: &mut Vec<u8>, seeds: &[Vec<u8>]) {
        let other = self.one_of(seeds);
        let part = other[self.range(other)].to_vec();
        bytes.splice(self.range(bytes), part);
    }

    fn replace_number(&mut self, bytes: &mut Vec<u8>) {
        let numbers: Vec<_> = words(bytes, |byte| byte.is_ascii_digit() || b".-+e".contains(&byte));
        let has_digit =
            |word: &&Range<usize>| bytes[(*word).clone()].iter().any(u8::is_ascii_digit);
        let numbers: Vec<_> = numbers.iter().filter(has_digit).cloned().collect();
        if !numbers.is_empty() {
            let place = self.one_of(&numbers).clone();
            bytes.splice(place, self.number().into_bytes());
        }
    }

    /// Returns an extreme number, or one of any magnitude.
    fn number(&mut self) -> String {
        let magnitude = *self.one_of(&[10, 40, 310]);
        if self.below(2) == 0 {
            let numbers: Vec<_> = NUMBERS.split(' ').collect();
            (*self.one_of(&numbers)).to_owned()
        } else {
            let exponent = self.below(2 * magnitude + 1) as i32 - magnitude as i32;
            let sign = self.one_of(&["", "", "-"]);
            format!("{sign}{}.0e{exponent}", 1 + self.below(9))
        }
    }

    fn swap_tokens(&mut self, bytes: &mut Vec<u8>) {
        let tokens = words(bytes, |byte| byte.is_ascii_alphanumeric() || b"_.-+".contains(&byte));
        if tokens.len() > 1 {
            let at = self.below(tokens.len() - 1);
            let other = at + 1 + self.below(tokens.len() - at - 1);
            let [a, b] = [tokens[at].clone(), tokens[other].clone()];
            let swapped = [&bytes[b.clone()], &bytes[a.end..b.start], &bytes[a.clone()]].concat();
            bytes.splice(a.start..b.end, swapped);
        }
    }

    fn repeat_line(&mut self, bytes: &mut Vec<u8>) {
        let lines = words(bytes, |byte| byte != b'\n');
        if !lines.is_empty() {
            let line = self.one_of(&lines).clone();
            let copies = 1 << self.below(12);
            let copies = [&bytes[line.clone()], b"\n"].concat().repeat(copies);
            bytes.splice(line.start..line.start, copies.into_iter().take(LONGEST));
        }
    }

    /// Replaces a line by one of another seed.
    fn move_line(&mut self, bytes: &mut Vec<u8>, seeds: &[Vec<u8>]) {
        let other = self.one_of(seeds);
        let lines = words(other, |byte| byte != b'\n');
        let places = words(bytes, |byte| byte != b'\n');
        if !lines.is_empty() && !places.is_empty() {
            let line = other[self.one_of(&lines).clone()].to_vec();
            let place = self.one_of(&places).clone();
            let place = if self.below(2) == 0 { place } else { place.start..place.start };
            bytes.splice(place, [&line[..], b"\n"].concat());
        }
    }

    /// Inserts deeply nested brackets, quotes or keys.
    fn nest(&mut self, bytes: &mut Vec<u8>) {
        let pairs: [[&[u8]; 2]; 5] =
            [[b"[", b"]"], [b"{a=", b"}"], [b"a.", b""], [b"[[", b"]]"], [b"[{a=", b"}]"]];
        let [open, close] = *self.one_of(&pairs);
        let depth = *self.one_of(&[2, 50, 79, 80, 81, 200, 10_000, 60_000]);
        let at = self.below(bytes.len() + 1);
        bytes.splice(at..at, [open.repeat(depth), b"1".to_vec(), close.repeat(depth)].concat());
    }

    fn lengthen(&mut self, bytes: &mut Vec<u8>) {
        let at = self.below(bytes.len() + 1);
        let word = *self.one_of(&[&b"a"[..], b"9", b" ", b"0,", b"\"", b"x,", b"\xc3\xa4", b"-"]);
        let count = *self.one_of(&[100, 5_000, 70_000, 200_000]);
        bytes.splice(at..at, word.repeat(count));
    }

    /// Replaces a number of four or two bytes, in either byte order.
    fn claim(&mut self, bytes: &mut [u8]) {
        let claim = *self.one_of(&CLAIMS);
        let four = [claim.to_be_bytes(), claim.to_le_bytes()];
        let number = self.one_of(&four).as_slice();
        let number = if self.below(3) == 0 { &number[2..] } else { number };
        if bytes.len() >= number.len() {
            // Headers are at the front.
            let end = bytes.len() - number.len() + 1;
            let end = if self.below(2) == 0 { end.min(64) } else { end };
            let at = self.below(end);
            bytes[at..at + number.len()].copy_from_slice(number);
        }
    }

    fn scramble(&mut self, bytes: &mut [u8]) {
        let range = self.range(bytes);
        self.0.fill_bytes(&mut bytes[range]);
    }
}

/// Returns the longest runs of bytes of a kind.
fn words(bytes: &[u8], of_kind: impl Fn(u8) -> bool) -> Vec<Range<usize>> {
    let mut words = Vec::new();
    let mut start = 0;
    for run in bytes.chunk_by(|&a, &b| of_kind(a) == of_kind(b)) {
        if of_kind(run[0]) {
            words.push(start..start + run.len());
        }
        start += run.len();
    }
    words
}
