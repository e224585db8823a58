//! Decodes the compressed positions of XTC: whole multiples of a precision, as differences within a box that
//! adapts to them, in as few bits as the box needs (GROMACS, `libxdrf.cpp`).

/// Edges of the boxes of differences: the box of index `i` has at most 2^i places.
const EDGES: [u32; 73] = [
    0, 0, 0, 0, 0, 0, 0, 0, 0, 8, 10, 12, 16, 20, 25, 32, 40, 50, 64, 80, 101, 128, 161, 203, 256,
    322, 406, 512, 645, 812, 1024, 1290, 1625, 2048, 2580, 3250, 4096, 5060, 6501, 8192, 10321,
    13003, 16384, 20642, 26007, 32768, 41285, 52015, 65536, 82570, 104_031, 131_072, 165_140,
    208_063, 262_144, 330_280, 416_127, 524_287, 660_561, 832_255, 1_048_576, 1_321_122, 1_664_510,
    2_097_152, 2_642_245, 3_329_021, 4_194_304, 5_284_491, 6_658_042, 8_388_607, 10_568_983,
    13_316_085, 16_777_216,
];

/// Index of the least box.
const LEAST: usize = 9;

/// Edge beyond which the coordinates of a position are stored one by one.
const LARGE: u32 = 0xFF_FFFF;

/// What is wrong with compressed positions.
pub(super) type Fault = &'static str;

const ENDED: Fault = "its compressed positions end early";

/// What precedes the compressed bits.
pub(super) struct Packing {
    /// Least and greatest coordinates.
    pub(super) low: [i32; 3],
    pub(super) high: [i32; 3],
    /// Index in [`EDGES`] of the first box of differences.
    pub(super) edge: i32,
}

/// Calls `push` with each of `count` positions.
pub(super) fn decode<E: From<Fault>>(
    packing: &Packing,
    bytes: &[u8],
    count: u64,
    mut push: impl FnMut([i32; 3]) -> Result<(), E>,
) -> Result<(), E> {
    let whole = Whole::new(packing)?;
    let mut edge = check_edge(i64::from(packing.edge))?;
    let mut bits = Bits { bytes, at: 0 };
    let (mut done, mut run) = (0, 0);
    while done < count {
        let mut previous = whole.read(&mut bits)?;
        let mut change = 0;
        if bits.take(1)? == 1 {
            let code = bits.take(5)?;
            // The number of positions that follow as differences is a third of a multiple of three.
            change = i64::from(code % 3) - 1;
            run = u64::from(code / 3);
        }
        done += 1 + run;
        if done > count {
            return Err(E::from("it has more positions than atoms"));
        }
        if run == 0 {
            push(previous)?;
        }
        let size = EDGES[edge];
        for place in 0..run {
            let difference = bits.triple(edge as u32, [size; 3])?;
            let middle = (size / 2) as i32;
            let position = std::array::from_fn(|axis| {
                previous[axis].wrapping_add(difference[axis]).wrapping_sub(middle)
            });
            // The first two positions are swapped: in water, the oxygen lies between the hydrogens.
            if place == 0 {
                push(position)?;
                push(previous)?;
            } else {
                push(position)?;
            }
            previous = position;
        }
        edge = check_edge(edge as i64 + change)?;
    }
    Ok(())
}

fn check_edge(edge: i64) -> Result<usize, Fault> {
    let edge = usize::try_from(edge).ok().filter(|edge| (LEAST..EDGES.len()).contains(edge));
    edge.ok_or("the box of its compressed positions has an impossible size")
}

/// How positions that are not differences are stored.
struct Whole {
    low: [i32; 3],
    sizes: [u32; 3],
    /// Bits of all three coordinates, or of each.
    bits: Result<u32, [u32; 3]>,
}

impl Whole {
    fn new(packing: &Packing) -> Result<Self, Fault> {
        let mut sizes = [0; 3];
        for (axis, size) in sizes.iter_mut().enumerate() {
            let extent = i64::from(packing.high[axis]) - i64::from(packing.low[axis]) + 1;
            let extent = u32::try_from(extent).ok().filter(|&extent| extent > 0);
            *size = extent.ok_or("the range of its compressed positions is impossible")?;
        }
        let bits = if sizes.iter().any(|&size| size > LARGE) {
            Err(sizes.map(|size| u32::BITS - size.leading_zeros()))
        } else {
            let places: u128 = sizes.iter().map(|&size| u128::from(size)).product();
            Ok(u128::BITS - places.leading_zeros())
        };
        Ok(Self { low: packing.low, sizes, bits })
    }

    #[inline]
    fn read(&self, bits: &mut Bits) -> Result<[i32; 3], Fault> {
        let offset = match self.bits {
            Ok(all) => bits.triple(all, self.sizes)?,
            Err([x, y, z]) => {
                [bits.take(x)?, bits.take(y)?, bits.take(z)?].map(|value| value as i32)
            }
        };
        Ok(std::array::from_fn(|axis| self.low[axis].wrapping_add(offset[axis])))
    }
}

/// Reader of bits, the most significant of each byte first.
struct Bits<'b> {
    bytes: &'b [u8],
    /// Number of bits that were read.
    at: usize,
}

impl Bits<'_> {
    /// Returns the next bits at the top of a word: up to 57 of them are valid. Bits beyond the end are zero.
    #[inline]
    fn peek(&self) -> u64 {
        let rest = self.bytes.get(self.at / 8..).unwrap_or_default();
        let word = match rest.first_chunk::<8>() {
            Some(word) => u64::from_be_bytes(*word),
            None => rest.iter().rev().fold(0, |word, &byte| word >> 8 | u64::from(byte) << 56),
        };
        word << (self.at % 8)
    }

    /// Moves past bits; an error if there are not so many.
    #[inline]
    fn pass(&mut self, count: u32) -> Result<(), Fault> {
        self.at += count as usize;
        if self.at <= self.bytes.len().saturating_mul(8) { Ok(()) } else { Err(ENDED) }
    }

    /// Returns the next bits, 1 to 32 of them, as a number.
    #[inline]
    fn take(&mut self, count: u32) -> Result<u32, Fault> {
        let word = self.peek() >> (u64::BITS - count);
        self.pass(count)?;
        Ok(word as u32)
    }

    /// Returns three numbers below `sizes` that are digits of one number of so many bits, whose bytes come
    /// with the least significant one first; the last may be incomplete.
    #[inline]
    fn triple(&mut self, count: u32, sizes: [u32; 3]) -> Result<[i32; 3], Fault> {
        let [_, y, z] = sizes.map(u64::from);
        if count <= 56 {
            let whole = count / 8 * 8;
            let word = self.peek();
            self.pass(count)?;
            let low = word.swap_bytes() & ((1 << whole) - 1);
            let high = (word << whole).checked_shr(u64::BITS - (count - whole)).unwrap_or(0);
            let number = low | high << whole;
            let (rest, last) = (number / z, number % z);
            return Ok([rest / y, rest % y, last].map(|digit| digit as i32));
        }
        let mut number = 0_u128;
        for shift in (0..count).step_by(8) {
            number |= u128::from(self.take((count - shift).min(8))?) << shift;
        }
        let (y, z) = (u128::from(y), u128::from(z));
        let (rest, last) = (number / z, number % z);
        Ok([rest / y, rest % y, last].map(|digit| digit as i32))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Writer of bits, the reverse of [`Bits`].
    #[derive(Default)]
    struct Written {
        bytes: Vec<u8>,
        count: usize,
    }

    impl Written {
        fn put(&mut self, value: u32, count: u32) {
            for bit in (0..count).rev() {
                if self.count.is_multiple_of(8) {
                    self.bytes.push(0);
                }
                let last = self.bytes.len() - 1;
                self.bytes[last] |= ((value >> bit & 1) as u8) << (7 - self.count % 8);
                self.count += 1;
            }
        }

        fn put_triple(&mut self, digits: [u32; 3], count: u32, sizes: [u32; 3]) {
            let [x, y, z] = digits.map(u128::from);
            let number = (x * u128::from(sizes[1]) + y) * u128::from(sizes[2]) + z;
            for shift in (0..count).step_by(8) {
                self.put((number >> shift) as u8 as u32, (count - shift).min(8));
            }
        }
    }

    proptest! {
        #[test]
        fn digits_are_those_that_were_written(
            before in 0_u32..32,
            sizes in [1_u32..=LARGE, 1_u32..=LARGE, 1_u32..=LARGE],
            parts in [0.0..1.0, 0.0..1.0, 0.0..1.0_f64],
        ) {
            let digits = [0, 1, 2].map(|axis| (f64::from(sizes[axis]) * parts[axis]) as u32);
            let places: u128 = sizes.iter().map(|&size| u128::from(size)).product();
            let count = u128::BITS - places.leading_zeros();
            let mut written = Written::default();
            written.put(0x5555_5555 & ((1 << before) - 1), before);
            written.put_triple(digits, count, sizes);
            written.put(0b101, 3);
            let mut bits = Bits { bytes: &written.bytes, at: before as usize };
            prop_assert_eq!(bits.triple(count, sizes), Ok(digits.map(|digit| digit as i32)));
            prop_assert_eq!(bits.take(3), Ok(0b101));
        }

        #[test]
        fn any_bytes_end_without_a_panic(
            bytes in prop::collection::vec(any::<u8>(), 0..200),
            low in any::<[i32; 3]>(),
            high in any::<[i32; 3]>(),
            edge in -3..80,
            count in 0_u64..1000,
        ) {
            let mut pushed = 0;
            let push = |_| {
                pushed += 1;
                Ok::<(), Fault>(())
            };
            let decoded = decode(&Packing { low, high, edge }, &bytes, count, push);
            prop_assert!(pushed <= count && (decoded.is_err() || pushed == count));
        }
    }

    #[test]
    fn boxes_have_at_most_as_many_places_as_their_bits() {
        for (bits, edge) in EDGES.into_iter().enumerate().skip(LEAST) {
            let places = u128::from(edge).pow(3);
            assert!(places <= 1 << bits, "{bits}");
            // And nearly so many, but for 5060 in place of 5160, an old slip that is the format now.
            assert!(u128::from(edge + 2).pow(3) > 1 << bits || edge == 5060, "{bits}");
        }
    }

    #[test]
    fn runs_swap_their_first_two_positions() {
        let packing = Packing { low: [-5, 0, 7], high: [4, 9, 16], edge: 9 };
        let mut written = Written::default();
        // 1000 places take 10 bits. A run of two differences, and then a larger box.
        written.put_triple([5, 1, 2], 10, [10; 3]);
        written.put(1, 1);
        written.put(2 * 3 + 2, 5);
        written.put_triple([5, 4, 3], 9, [8; 3]);
        written.put_triple([4, 4, 7], 9, [8; 3]);
        // The run goes on where nothing is said.
        written.put_triple([0, 0, 0], 10, [10; 3]);
        written.put(0, 1);
        written.put_triple([5, 5, 5], 10, [10; 3]);
        written.put_triple([4, 5, 5], 10, [10; 3]);
        let mut positions = Vec::new();
        let push = |position| {
            positions.push(position);
            Ok::<(), Fault>(())
        };
        assert_eq!(decode(&packing, &written.bytes, 6, push), Ok(()));
        let first = [[1, 1, 8], [0, 1, 9], [1, 1, 11]];
        let second = [[-5, 0, 7], [-5, 0, 7], [-6, 0, 7]];
        assert_eq!(positions, [first, second].concat());
        let refused = |count, bytes: &[u8]| {
            decode::<Fault>(&packing, bytes, count, |_| Ok(())).err().unwrap_or_default()
        };
        assert_eq!(refused(5, &written.bytes), "it has more positions than atoms");
        assert_eq!(refused(6, &written.bytes[..4]), ENDED);
        assert_eq!(refused(60, &written.bytes), ENDED);
    }
}
