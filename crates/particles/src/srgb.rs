//! Conversion of sRGB colors to linear ones.

use crate::Rgb;

/// Returns the linear value of an sRGB component, both 0..=1 (IEC 61966-2-1:1999).
pub fn linear_from_srgb(component: f32) -> f32 {
    if component <= 0.040_45 {
        component / 12.92
    } else {
        // The function of single precision is off by more than the rounding of its result.
        libm::pow(((component + 0.055) / 1.055).into(), 2.4) as f32
    }
}

/// Returns the linear color of an sRGB triple of bytes, such as `0xRR_GG_BB`.
pub fn srgb(hex: u32) -> Rgb {
    let component = |shift: u32| linear_from_srgb(((hex >> shift) & 0xFF) as f32 / 255.0);
    Rgb::new(component(16), component(8), component(0))
}
