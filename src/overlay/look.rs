//! All that a scene says is drawn over its picture.

use super::{Ground, Matte, Overlay, Pen, draw_over};
use crate::image::Image;
use crate::scene::{Background, Look};

/// Fading of the farthest sphere.
const FADED: f32 = 0.85;

/// Rows of a picture in which a line of 1.5 pixels looks right.
const ROWS: f64 = 600.0;

impl Overlay<'_> {
    /// Draws a look over a picture, and takes sky and ground out of it if it is to be transparent:
    /// then it returns what is left. `ground` is what is known of the ground, if there is one and
    /// the background is transparent.
    pub fn draw_look(
        &self,
        image: &mut Image,
        look: &Look,
        ground: Option<Ground>,
    ) -> Option<Matte> {
        if let Background::Color(color) = look.background {
            self.replace_sky(image, color.to_array());
        }
        if look.depth_cue {
            self.fade(image, look.haze().to_array(), FADED);
        }
        let ink = look.ink().to_array();
        let mut matte = look.is_transparent().then(|| self.lift(image, ground));
        if look.outline {
            draw_over(image, matte.as_mut(), |image| self.draw_contours(image, ink));
        }
        if let Some(cell) = &look.cell {
            let rows = f64::from(self.world.camera.height);
            let pen = Pen { color: ink, width: (1.5 * rows / ROWS).max(1.0) };
            draw_over(image, matte.as_mut(), |image| self.draw_lines(image, &cell.edges(), pen));
        }
        matte
    }
}
