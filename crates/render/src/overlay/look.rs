//! All overlays of a scene's look.

use super::{GroundLayers, Matte, Overlay, Pen, draw_over};
use crate::image::Image;
use crate::scene::Look;

/// Opacity of the depth cue at the farthest sphere.
const MAX_FADE: f32 = 0.75;

/// Height of an image in which lines are 1.5 pixels wide.
const ROWS: f64 = 600.0;

impl Overlay<'_> {
    /// Draws a look over a picture. If the look is transparent, removes environment and ground, and
    /// returns the matte. `ground` is the ground's light and shadow, if there is a ground and the
    /// background is transparent.
    pub fn draw_look(
        &self,
        image: &mut Image,
        look: &Look,
        ground: Option<GroundLayers>,
    ) -> Option<Matte> {
        if look.depth_cue {
            self.fade(image, look.haze().to_array(), MAX_FADE);
        }
        let ink = look.ink().to_array();
        let mut matte = look.is_transparent().then(|| self.remove_background(image, ground));
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
