//! Radiance HDR (RGBE): read only, by the `image` crate, for environment maps.

use super::{
    Image,
    format::{claimed_area, damaged},
};
use image::{ImageDecoder, codecs::hdr::HdrDecoder};

/// Decodes a file and divides by its `EXPOSURE`, as Radiance's file format says.
pub(super) fn decode(bytes: &[u8]) -> Result<Image, String> {
    // Not strict: accepts the signature `#?RGBE` and unknown lines, as other readers do.
    let decoder = HdrDecoder::new_nonstrict(bytes).map_err(|error| damaged(&error))?;
    let (width, height) = decoder.dimensions();
    let area = claimed_area(width.into(), height.into(), size_of::<[f32; 3]>() as u64)?;
    let exposure = decoder.metadata().exposure.filter(|factor| factor.is_normal() && *factor > 0.0);
    let mut pixels = vec![[0.0_f32; 3]; area];
    decoder.read_image(bytemuck::cast_slice_mut(&mut pixels)).map_err(|error| damaged(&error))?;
    if let Some(exposure) = exposure {
        pixels.iter_mut().flatten().for_each(|value| *value /= exposure);
    }
    Ok(Image { width, height, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "FORMAT=32-bit_rle_rgbe\n";

    fn file(signature: &str, lines: &str, size: &str, data: &[u8]) -> Vec<u8> {
        [format!("{signature}\n{HEAD}{lines}\n{size}\n").as_bytes(), data].concat()
    }

    #[test]
    fn mantissas_and_exponents_give_radiance() {
        // 128 / 256 * 2^1 = 1; 64 / 256 * 2^3 = 2.
        let data = b"\x80\x40\0\x81\0\x40\x80\x83";
        let image = decode(&file("#?RADIANCE", "", "-Y 1 +X 2", data)).unwrap();
        assert_eq!(image.pixels, vec![[1.0, 0.5, 0.0], [0.0, 2.0, 4.0]]);
        assert_eq!(decode(&file("#?RGBE", "", "-Y 1 +X 2", data)), Ok(image));
    }

    #[test]
    fn radiance_is_divided_by_the_exposure() {
        let lines = "EXPOSURE=2\nEXPOSURE=4\n";
        let image = decode(&file("#?RADIANCE", lines, "-Y 1 +X 1", b"\x80\x40\0\x81")).unwrap();
        assert_eq!(image.pixels, vec![[0.125, 0.0625, 0.0]]);
    }

    #[test]
    fn bad_files_are_refused() {
        for (size, data) in [
            ("-Y 1 +X 2", &b"\x80\x40\0\x81"[..]),
            ("-Y 4000000000 +X 4000000000", b"\x80\x40\0\x81"),
            ("-Y 0 +X 1", b""),
            ("+X 1 -Y 1", b"\x80\x40\0\x81"),
            ("-Y 1 +X 2", b"\x01\x01\x01\x09"),
            ("nonsense", b""),
        ] {
            assert!(decode(&file("#?RADIANCE", "", size, data)).is_err(), "{size}");
        }
    }
}
