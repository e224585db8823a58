//! Tone mapping: from linear radiance to the codes of a display, and back.
//!
//! Exposure scales radiance, a tone curve maps it to display-linear values in 0..=1, the sRGB curve
//! encodes these, and codes are the nearest integers. NaN becomes code 0 and positive infinity the
//! largest code.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use spherule_core::internals::elementary::{exp2, pow};
use std::ops::RangeInclusive;

/// Exposures in stops.
pub const EXPOSURES: RangeInclusive<f64> = -100.0..=100.0;

/// A tone curve, from linear radiance to display-linear 0..=1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Tone {
    /// Clips at 1.
    Linear,
    /// A filmic curve that compresses highlights.
    Filmic,
}

/// Returns the sRGB code, 0..=1, of a display-linear value in 0..=1 (IEC 61966-2-1:1999).
///
/// Below 0 the curve's linear part continues, above 1 its power law.
pub fn srgb_encode(linear: f64) -> f64 {
    if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * pow(linear, 1.0 / 2.4) - 0.055 }
}

/// Returns the display-linear value, 0..=1, of an sRGB code in 0..=1: the inverse of [`srgb_encode`].
pub fn srgb_decode(code: f64) -> f64 {
    if code <= 0.040_45 { code / 12.92 } else { pow((code + 0.055) / 1.055, 2.4) }
}

/// Applies a filmic curve: increases midtones and compresses highlights; 0 at 0, increasing, at most 1.
///
/// `radiance` is 0 or more. This is Narkowicz's fit of the ACES reference transform ("ACES Filmic Tone
/// Mapping Curve", 2016), divided by its limit 2.51 / 2.43: the published curve exceeds 1 at 7.2 and is
/// clamped there, which would make bright highlights flat.
pub fn filmic(radiance: f64) -> f64 {
    // For larger values the curve is 1 to nine digits; squaring infinity would give NaN.
    let x = radiance.min(1e9);
    (2.43 / 2.51) * (x * (2.51 * x + 0.03)) / (x * (2.43 * x + 0.59) + 0.14)
}

/// Exposure and tone curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DisplayTransform {
    gain: f64,
    tone: Tone,
}

impl DisplayTransform {
    /// Creates a transform that multiplies radiance by `2^exposure` before the tone curve; `exposure`
    /// is in stops; `None` outside of [`EXPOSURES`].
    pub fn new(exposure: f64, tone: Tone) -> Option<Self> {
        EXPOSURES.contains(&exposure).then(|| Self { gain: exp2(exposure), tone })
    }

    /// Returns the transform of the nearest exposure in range; NaN counts as 0.
    pub fn nearest(exposure: f64, tone: Tone) -> Self {
        let (least, most) = (*EXPOSURES.start(), *EXPOSURES.end());
        let exposure = if exposure.is_nan() { 0.0 } else { exposure.clamp(least, most) };
        Self { gain: exp2(exposure), tone }
    }

    /// Returns the display-linear value, 0..=1, of a radiance; 0 for negative values and NaN.
    pub fn apply(&self, radiance: f32) -> f64 {
        // The maximum of NaN and 0 is 0.
        let exposed = (f64::from(radiance) * self.gain).max(0.0);
        match self.tone {
            Tone::Linear => exposed.min(1.0),
            Tone::Filmic => filmic(exposed),
        }
    }

    /// Returns the sRGB code of a radiance, rounded to the nearest of `0..=maximum`.
    pub fn code(&self, radiance: f32, maximum: u16) -> u16 {
        (srgb_encode(self.apply(radiance)) * f64::from(maximum)).round() as u16
    }
}

/// A table for [`DisplayTransform::code`] with codes of 8 bits: the least radiance of each code.
#[derive(Clone, Debug, PartialEq)]
pub struct Codes8 {
    /// Code `i + 1` starts at the radiance with the bits `least[i]`. Bits of nonnegative floats have
    /// the order of the floats.
    least: [u32; 255],
    /// The code of the least radiance with these leading bits.
    first: Vec<u8>,
}

/// Low bits that [`Codes8`] considers only near the boundary between two codes.
const FINE: u32 = 19;

impl Codes8 {
    /// Creates the table of a transform.
    pub fn new(transform: DisplayTransform) -> Self {
        let code = |bits: u32| transform.code(f32::from_bits(bits), 255);
        let infinity = f32::INFINITY.to_bits();
        let least = std::array::from_fn(|i| {
            let (mut low, mut high) = (0, infinity + 1);
            while low < high {
                let middle = low + (high - low) / 2;
                if usize::from(code(middle)) > i { high = middle } else { low = middle + 1 }
            }
            low
        });
        let first = (0..=infinity >> FINE).map(|bits| code(bits << FINE) as u8).collect();
        Self { least, first }
    }

    /// Returns the code of a radiance, 0..=255.
    #[inline]
    pub fn code(&self, radiance: f32) -> u8 {
        // The maximum of NaN and 0 is 0; that of -0 and 0 may be either, and their sum is 0.
        let bits = (radiance.max(0.0) + 0.0).to_bits();
        let mut code = self.first.get((bits >> FINE) as usize).copied().unwrap_or(0);
        while self.least.get(usize::from(code)).is_some_and(|least| bits >= *least) {
            code += 1;
        }
        code
    }
}

/// Minimum number of pixels for which creating [`Codes8`] takes less time than it saves.
const TABLE_PIXELS: usize = 1 << 13;

/// Returns the codes of pixels, `0..=maximum`.
pub fn codes(pixels: &[[f32; 3]], transform: DisplayTransform, maximum: u16) -> Vec<[u16; 3]> {
    let each = pixels.par_iter().with_min_len(1 << 12);
    if maximum == u16::from(u8::MAX) && pixels.len() >= TABLE_PIXELS {
        let table = Codes8::new(transform);
        return each.map(|pixel| pixel.map(|value| u16::from(table.code(value)))).collect();
    }
    each.map(|pixel| pixel.map(|value| transform.code(value, maximum))).collect()
}

/// Returns the linear value of every code in `0..=maximum`; `maximum` is 1 or more.
pub fn decode_table(maximum: u16) -> Vec<f32> {
    (0..=maximum).map(|code| srgb_decode(f64::from(code) / f64::from(maximum)) as f32).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLAIN: DisplayTransform = DisplayTransform { gain: 1.0, tone: Tone::Linear };

    #[test]
    fn known_values_of_the_srgb_curve() {
        for (linear, code) in [(0.0, 0), (0.18, 118), (0.214_041_14, 128), (0.5, 188), (1.0, 255)] {
            assert_eq!(PLAIN.code(linear, 255), code, "{linear}");
        }
        assert!((srgb_decode(0.5) - 0.214_041_140_482_232_55).abs() < 1e-15);
        assert!((srgb_encode(0.003_130_8) - 0.040_449_936).abs() < 1e-15);
        // The two pieces meet, except for the rounding of the standard's constants.
        assert!((srgb_encode(0.003_130_800_1) - srgb_encode(0.003_130_8)).abs() < 1e-7);
        assert!((srgb_decode(0.040_450_001) - srgb_decode(0.040_45)).abs() < 1e-7);
    }

    #[test]
    fn every_code_survives_decoding_and_encoding() {
        for maximum in [1, 255, 1023, u16::MAX] {
            let table = decode_table(maximum);
            assert_eq!(table.len(), usize::from(maximum) + 1);
            for (code, &value) in table.iter().enumerate() {
                assert_eq!(usize::from(PLAIN.code(value, maximum)), code);
            }
        }
    }

    #[test]
    fn rounding_is_to_the_nearest_code() {
        for code in 0..255_u16 {
            let middle = srgb_decode((f64::from(code) + 0.5) / 255.0);
            assert_eq!(PLAIN.code((middle * 0.999_99) as f32, 255), code);
            assert_eq!(PLAIN.code((middle * 1.000_01) as f32, 255), code + 1);
        }
    }

    #[test]
    fn tone_curves_increase_from_0_and_stay_in_range() {
        for tone in [Tone::Linear, Tone::Filmic] {
            let transform = DisplayTransform::new(0.0, tone).unwrap();
            assert_eq!(transform.apply(0.0), 0.0);
            let values: Vec<_> = (-300..=300).map(|i| (0.1 * i as f32).exp2()).collect();
            for pair in values.windows(2) {
                let (low, high) = (transform.apply(pair[0]), transform.apply(pair[1]));
                assert!(low <= high && high <= 1.0, "{tone:?} {pair:?}");
            }
        }
        assert!((1..100).all(|i| filmic(f64::from(i)) < filmic(f64::from(i + 1))));
        assert!(filmic(1e6) < 1.0);
        // Narkowicz: 1 becomes 0.8038 before the division.
        assert!((filmic(1.0) * 2.51 / 2.43 - 2.54 / 3.16).abs() < 1e-12);
    }

    #[test]
    fn tables_give_the_same_codes() {
        for (exposure, tone) in [(0.0, Tone::Linear), (-7.3, Tone::Filmic), (100.0, Tone::Linear)] {
            let transform = DisplayTransform::new(exposure, tone).unwrap();
            let table = Codes8::new(transform);
            let odd = [-1.0, -0.0, f32::NAN, f32::INFINITY, f32::MAX, f32::MIN_POSITIVE];
            let ends = table.least.iter().flat_map(|&bits| [bits.saturating_sub(1), bits]);
            let all = (0..=u16::MAX).map(|bits| u32::from(bits) << 15).chain(ends);
            for radiance in all.map(f32::from_bits).chain(odd) {
                let code = transform.code(radiance, 255);
                assert_eq!(u16::from(table.code(radiance)), code, "{radiance} {tone:?}");
            }
        }
    }

    #[test]
    fn a_stop_doubles() {
        assert_eq!(DisplayTransform::new(1.0, Tone::Linear).unwrap().apply(0.25), 0.5);
        assert_eq!(DisplayTransform::new(-2.0, Tone::Linear).unwrap().apply(1.0), 0.25);
    }

    #[test]
    fn values_out_of_range_are_clamped() {
        for tone in [Tone::Linear, Tone::Filmic] {
            for exposure in [f64::NAN, f64::INFINITY, -3000.0, -100.1, 100.1] {
                assert!(DisplayTransform::new(exposure, tone).is_none(), "{exposure}");
                assert_eq!(DisplayTransform::nearest(exposure, tone).code(0.0, 255), 0);
            }
            for exposure in [-100.0, -3.0, 0.0, 5.0, 100.0] {
                let transform = DisplayTransform::new(exposure, tone).unwrap();
                assert_eq!(transform.code(f32::NAN, 255), 0);
                assert_eq!(transform.code(f32::NEG_INFINITY, 255), 0);
                assert_eq!(transform.code(-1.0, 65535), 0);
            }
            let transform = DisplayTransform::new(0.0, tone).unwrap();
            assert_eq!(transform.code(f32::INFINITY, 255), 255);
            assert_eq!(transform.code(f32::MAX, 65535), 65535);
        }
    }
}
