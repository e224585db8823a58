//! Pictures of skies, as `sky.wgsl` has them.

use crate::materials::words;
use spherule_render::world::DevicePicture;

/// Rows before those of the parts, and rows of each part.
const HEAD: usize = 5;
const PART: usize = 2;

/// Returns the rows of a picture, of four words each; one if there is none.
pub(crate) fn rows(picture: Option<&DevicePicture>) -> Vec<[u32; 4]> {
    let Some(picture) = picture else { return vec![[0; 4]] };
    let (width, height) = (picture.image.width, picture.image.height);
    let axis = |[x, y, z]: [f32; 3]| [x, y, z, 0.0].map(f32::to_bits);
    let mut rows = vec![[0; 4]; HEAD + PART * picture.parts.len()];
    rows[0] = [width, height, picture.parts.len() as u32, picture.scale.to_bits()];
    rows[2] = axis(picture.axes.tangent.to_array());
    rows[3] = axis(picture.axes.bitangent.to_array());
    rows[4] = axis(picture.axes.normal.to_array());
    let pixels = rows.len();
    rows.extend(picture.image.pixels.iter().map(|&[r, g, b]| [r, g, b, 0.0].map(f32::to_bits)));
    let patches = rows.len();
    rows.extend(picture.rows.iter().map(|&[a, b, density]| [a, b, density, 0.0].map(f32::to_bits)));
    rows[1] = [pixels as u32, patches as u32, 0, 0];
    for (part, number) in picture.parts.iter().zip(0..) {
        let of = |cumulative: &[f32]| -> Vec<u32> {
            cumulative.iter().copied().map(f32::to_bits).collect()
        };
        let first = rows.len() as u32;
        rows.extend(words(&of(&part.rows)));
        let columns = rows.len() as u32;
        for column in &part.columns {
            rows.extend(words(&of(column)));
        }
        let each = (part.region[2] + 1).div_ceil(4);
        rows[HEAD + PART * number] = part.region;
        rows[HEAD + PART * number + 1] = [first, columns, each, 0];
    }
    rows
}
