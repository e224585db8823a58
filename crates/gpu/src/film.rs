//! Sums of pixels, which a device adds up.

use crate::columns::Columns;
use crate::device::{Device, Size};
use crate::error::DeviceError;
use crate::stages::Kernel;
use spherule_render::world::{DevicePath, DevicePixel, DevicePixels};

/// Adds up the paths of so many samples of each pixel, and reads the sums, and the samples of the pixels that the device
/// does not sum.
pub(crate) fn add_up(
    device: &Device,
    columns: &Columns,
    [pixels, samples]: [usize; 2],
    found: &mut DevicePixels,
) -> Result<(), DeviceError> {
    device.write(&columns.unsummed, &0_u32.to_ne_bytes());
    let Columns { params, paths, pixel_sums, samples: left, unsummed, .. } = columns;
    let mut work = device.work();
    let buffers = [params, paths, pixel_sums, left, unsummed];
    work.run(Kernel::Film, &buffers, Size::Rows(pixels))?;
    found.pixels.resize(pixels, DevicePixel::default());
    let rows: &mut [u8] = bytemuck::cast_slice_mut(&mut found.pixels);
    let to_read = &columns.pixel_sums_to_read;
    let bytes = rows.len() as u64;
    work.copy(pixel_sums, 0, to_read, bytes);
    device.read(to_read, bytes, work.submit(), |view| rows.copy_from_slice(view))?;
    let unsummed = found.pixels.iter().filter(|pixel| pixel.place().is_some()).count();
    found.samples.resize(unsummed * samples, DevicePath::default());
    if unsummed == 0 {
        return Ok(());
    }
    let rows = bytemuck::cast_slice_mut(&mut found.samples);
    device.read_rows(left, &columns.samples_to_read, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::columns::Needs;
    use crate::tree::Params;
    use spherule_core::internals::random::Random;
    use spherule_render::film::Sums;
    use spherule_render::scene::Rgb;

    const PIXELS: usize = 400;
    const SAMPLES: usize = 16;

    /// Returns samples of a pixel as kernels have them: of one size, of any, some black, or some invalid or unknown.
    fn samples(pixel: usize, random: &mut Random) -> [[u32; 4]; SAMPLES] {
        let decades = if pixel.is_multiple_of(2) { [-1.0, 1.0] } else { [-30.0, 5.0] };
        let mut rows = [[0; 4]; SAMPLES];
        for row in &mut rows {
            let black = pixel.is_multiple_of(3) && random.coin();
            let mut number = || if black { 0 } else { (random.decades(decades) as f32).to_bits() };
            *row = [number(), number(), number(), 2 + (3 << 16)];
        }
        match pixel % 20 {
            0 => rows[3][3] |= 1,
            1 => rows[15][1] = (-1.0_f32).to_bits(),
            2 => rows[0][0] = f32::INFINITY.to_bits(),
            3 => rows[7][2] = f32::NAN.to_bits(),
            4 => rows[5][0] = 1,
            _ => {}
        }
        rows
    }

    #[test]
    #[ignore = "needs a GPU, or Vulkan in software"]
    fn sums_are_the_processors_or_left_to_it() {
        let device = Device::best(true).unwrap();
        assert_eq!(device.lacks_for_paths(), None);
        let mut random = Random::new(3);
        let rows: Vec<_> = (0..PIXELS).map(|pixel| samples(pixel, &mut random)).collect();
        let columns = Columns::new(&device, [PIXELS, PIXELS * SAMPLES], Needs::default()).unwrap();
        device.write(&columns.paths, bytemuck::cast_slice(&rows));
        let (count, samples) = ((PIXELS * SAMPLES) as u32, SAMPLES as u32);
        let params = Params { count, samples, ..Params::default() };
        device.write(&columns.params, bytemuck::bytes_of(&params));
        let mut found = DevicePixels::default();
        add_up(&device, &columns, [PIXELS, SAMPLES], &mut found).unwrap();
        let (mut summed, mut left) = (0, 0);
        for (pixel, rows) in found.pixels.iter().zip(&rows) {
            if let Some(place) = pixel.place() {
                let copy = &found.samples[place * SAMPLES..][..SAMPLES];
                assert_eq!(bytemuck::cast_slice::<_, u32>(copy), rows.as_flattened());
                left += 1;
                continue;
            }
            let radiance = rows.map(|[x, y, z, _]| Rgb::from([x, y, z].map(f32::from_bits)));
            assert!(radiance.iter().all(|sample| sample.min_element() >= 0.0));
            let (mut own, mut other) = (Sums::new(1, true), Sums::new(1, true));
            own.add(&radiance, samples);
            let (total, squares) = pixel.sums();
            other.add_exact(0, total, squares);
            assert!(own.means(samples).eq(other.means(samples)));
            assert!(own.variances(samples).eq(other.variances(samples)));
            assert_eq!((pixel.bounce_rays(), pixel.shadow_rays()), (16, 48));
            summed += 1;
        }
        assert!(summed > PIXELS / 4 && left >= PIXELS / 4, "{summed} {left}");
    }
}
