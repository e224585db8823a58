//! Colors as screens show them, made linear.

use super::Rgb;

/// The linear value of an sRGB component, both 0..=1 (IEC 61966-2-1:1999).
pub fn linear_from_srgb(component: f32) -> f32 {
    if component <= 0.040_45 { component / 12.92 } else { ((component + 0.055) / 1.055).powf(2.4) }
}

/// The linear color of an sRGB triple of bytes, written as in `0xRR_GG_BB`.
pub fn srgb(hex: u32) -> Rgb {
    let component = |shift: u32| linear_from_srgb(((hex >> shift) & 0xFF) as f32 / 255.0);
    Rgb::new(component(16), component(8), component(0))
}

/// The color that a scene file writes as `#rrggbb`; `None` if `text` is anything else.
pub(crate) fn parse_hex(text: &str) -> Option<Rgb> {
    let digits = text.strip_prefix('#')?;
    let valid = digits.len() == 6 && digits.bytes().all(|byte| byte.is_ascii_hexdigit());
    valid.then(|| u32::from_str_radix(digits, 16).ok().map(srgb)).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hex_colors_are_linear() {
        assert_eq!(parse_hex("#ffffff"), Some(Rgb::ONE));
        assert_eq!(parse_hex("#000000"), Some(Rgb::ZERO));
        let gray = parse_hex("#BCbcBC").unwrap_or_default();
        assert!((gray.x - 0.502_886_5).abs() < 1e-5, "{gray}");
        assert_eq!(gray.x, gray.z);
    }

    #[test]
    fn other_texts_are_no_colors() {
        for text in ["ffffff", "#fff", "#ggffff", "#+12345", "", "#", "#fffffff", "#ä1234"] {
            assert_eq!(parse_hex(text), None, "{text}");
        }
    }
}
