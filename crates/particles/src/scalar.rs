//! Numbers in binary files.

/// A numeric type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F16,
    F32,
    F64,
}

/// Byte order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Least significant byte first.
    Little,
    /// Most significant byte first.
    Big,
}

impl Scalar {
    /// Returns the size of a number in bytes.
    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 | Self::F16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// Reads the number at the beginning of `bytes`; returns NaN if there are too few. Whole numbers
    /// beyond 2^53 are rounded.
    #[inline]
    pub(crate) fn read(self, bytes: &[u8], order: Order) -> f64 {
        let mut word = [0; 8];
        let size = self.size();
        let Some(bytes) = bytes.get(..size) else { return f64::NAN };
        word[..size].copy_from_slice(bytes);
        if order == Order::Big {
            word[..size].reverse();
        }
        let word = u64::from_le_bytes(word);
        match self {
            Self::I8 => f64::from(word as i8),
            Self::U8 => f64::from(word as u8),
            Self::I16 => f64::from(word as i16),
            Self::U16 => f64::from(word as u16),
            Self::I32 => f64::from(word as i32),
            Self::U32 => f64::from(word as u32),
            Self::I64 => word as i64 as f64,
            Self::U64 => word as f64,
            Self::F16 => half(word as u16),
            Self::F32 => f64::from(f32::from_bits(word as u32)),
            Self::F64 => f64::from_bits(word),
        }
    }
}

/// Returns the value of a half-precision number (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (bits >> 10 & 0x1F, f64::from(bits & 0x3FF));
    // Powers of two are exact.
    let size = match exponent {
        0 => fraction * f64::from_bits((1023 - 24) << 52),
        0x1F if fraction == 0.0 => f64::INFINITY,
        0x1F => f64::NAN,
        _ => (1024.0 + fraction) * f64::from_bits((1023 - 25 + u64::from(exponent)) << 52),
    };
    if bits >> 15 == 1 { -size } else { size }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_in_both_byte_orders() {
        for (scalar, little, expected) in [
            (Scalar::I8, &[0xFE][..], -2.0),
            (Scalar::U8, &[0xFE], 254.0),
            (Scalar::I16, &(-300_i16).to_le_bytes(), -300.0),
            (Scalar::U16, &60_000_u16.to_le_bytes(), 60_000.0),
            (Scalar::I32, &(-70_000_i32).to_le_bytes(), -70_000.0),
            (Scalar::U32, &u32::MAX.to_le_bytes(), 4_294_967_295.0),
            (Scalar::I64, &(-(1_i64 << 40)).to_le_bytes(), -1_099_511_627_776.0),
            (Scalar::U64, &(1_u64 << 63).to_le_bytes(), 9_223_372_036_854_775_808.0),
            (Scalar::F16, &0xC100_u16.to_le_bytes(), -2.5),
            (Scalar::F16, &0x3555_u16.to_le_bytes(), 1365.0 / 4096.0),
            (Scalar::F16, &1_u16.to_le_bytes(), 1.0 / f64::from(1 << 24)),
            (Scalar::F16, &0x7BFF_u16.to_le_bytes(), 65_504.0),
            (Scalar::F16, &0xFC00_u16.to_le_bytes(), f64::NEG_INFINITY),
            (Scalar::F32, &0.1_f32.to_le_bytes(), f64::from(0.1_f32)),
            (Scalar::F64, &0.1_f64.to_le_bytes(), 0.1),
        ] {
            let big: Vec<u8> = little.iter().rev().copied().collect();
            assert_eq!(scalar.read(little, Order::Little), expected, "{scalar:?}");
            assert_eq!(scalar.read(&big, Order::Big), expected, "{scalar:?}");
            assert!(scalar.read(&little[1..], Order::Little).is_nan(), "{scalar:?}");
        }
    }
}
