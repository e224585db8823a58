//! Mattes: images without their background, with the coverage of spheres and their shadows.

use super::{GroundLayers, Overlay};
use crate::image::{Image, tone};

/// Coverage of each pixel by what is not background, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct Matte {
    /// Fraction covered by spheres, 0..=1.
    pub coverage: Vec<f32>,
    /// Fraction of the background's light that shadows remove, 0..=1; empty without ground.
    pub shadow: Vec<f32>,
}

impl Matte {
    /// Returns alpha for blending of linear values, as in compositors: a background times 1 - alpha is
    /// as much darker as the ground in the shadow.
    pub fn linear(&self) -> Vec<f32> {
        self.alpha(|shadow| shadow)
    }

    /// Returns alpha for blending of sRGB codes, as in browsers and presentations: black over white
    /// gets the code of white in the shadow.
    pub fn encoded(&self) -> Vec<f32> {
        self.alpha(|shadow| 1.0 - tone::srgb_encode(f64::from(1.0 - shadow)) as f32)
    }

    fn alpha(&self, darkness: impl Fn(f32) -> f32) -> Vec<f32> {
        let through = |row: usize| self.shadow.get(row).map_or(1.0, |&dark| 1.0 - darkness(dark));
        let alpha = |(row, covered): (usize, &f32)| 1.0 - (1.0 - covered) * through(row);
        self.coverage.iter().enumerate().map(alpha).collect()
    }
}

impl Overlay<'_> {
    /// Removes environment and ground from a picture: the result has the light of spheres,
    /// premultiplied by their coverage. `ground` is the ground's light and shadow, if there is a
    /// ground.
    pub fn remove_background(&self, image: &mut Image, ground: Option<GroundLayers>) -> Matte {
        let width = self.region.width as usize;
        let mut coverage = Vec::with_capacity(image.pixels.len());
        for (row, (pixel, seen)) in image.pixels.iter_mut().zip(&self.layers.pixels).enumerate() {
            let covered = (seen.coverage - seen.ground).clamp(0.0, 1.0);
            coverage.push(covered);
            let behind = match &ground {
                Some(ground) => ground.lit.pixels[row],
                None => self.sky(row % width, row / width),
            };
            let rest = |i: usize| (pixel[i] - (1.0 - covered) * behind[i]).max(0.0);
            *pixel = if covered > 0.0 { std::array::from_fn(rest) } else { [0.0; 3] };
        }
        Matte { coverage, shadow: ground.map_or_else(Vec::new, |ground| ground.shadow) }
    }
}

/// Draws over an image and its matte: `draw` must be able to draw over any image.
pub fn draw_over(image: &mut Image, matte: Option<&mut Matte>, draw: impl Fn(&mut Image)) {
    draw(image);
    if let Some(matte) = matte {
        draw_alpha(&mut matte.coverage, (image.width, image.height), draw);
    }
}

/// Increases the alpha of an image of this size by what `draw` draws over any image.
///
/// The coverage is computed from drawings over black and over white.
pub fn draw_alpha(alpha: &mut [f32], (width, height): (u32, u32), draw: impl Fn(&mut Image)) {
    let over = |paper: f32| {
        let mut image = Image { width, height, pixels: vec![[paper; 3]; alpha.len()] };
        draw(&mut image);
        image.pixels
    };
    let (black, white) = (over(0.0), over(1.0));
    for (alpha, (black, white)) in alpha.iter_mut().zip(black.iter().zip(&white)) {
        *alpha = 1.0 - (1.0 - *alpha) * (white[1] - black[1]).clamp(0.0, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The alpha of a shadow for blending of codes is 1 minus the code of the remaining light.
    #[test]
    fn shadows_are_encoded_as_the_light_that_they_leave() {
        let matte = Matte { coverage: vec![0.0, 0.5, 0.0], shadow: vec![0.5, 0.0, 1.0] };
        assert_eq!(matte.linear(), [0.5, 0.5, 1.0]);
        for (found, expected) in matte.encoded().into_iter().zip([1.0 - 0.735_357, 0.5, 1.0]) {
            assert!((found - expected).abs() < 1e-5, "{found} {expected}");
        }
    }
}
