//! Regions of a picture's patches, and the search for the sun among them.

use std::f64::consts::PI;

/// Greatest extent of a sun along each axis, in radians.
const EXTENT: f64 = 12.0 * PI / 180.0;

/// Least part of the picture's light that makes a region a light of its own.
const SHARE: f64 = 1.0 / 16.0;

/// A sun grows by neighbors that are at least so bright, in proportion to its mean.
const CONTRAST: f64 = 1.0 / 32.0;

/// A rectangle of patches; columns wrap around.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Region {
    pub(super) column: usize,
    pub(super) row: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

/// The patches of a picture, for the search.
pub(super) struct Grid<'a> {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Integral of luminance over the solid angle of a patch, by column and row.
    pub(super) light: &'a dyn Fn(usize, usize) -> f64,
    /// Solid angle of the patches of a row.
    pub(super) solid_angle: &'a dyn Fn(usize) -> f64,
}

impl Region {
    /// Returns the position in the region of a patch of a picture that is `across` patches wide; `None`
    /// if it is outside.
    #[inline(always)]
    pub(super) fn position(
        &self,
        across: usize,
        (column, row): (usize, usize),
    ) -> Option<(usize, usize)> {
        let wrapped = if column < self.column { column + across } else { column };
        let (x, y) = (wrapped - self.column, row.wrapping_sub(self.row));
        (x < self.width && y < self.height).then_some((x, y))
    }

    /// Returns the patches by column and row.
    pub(super) fn patches(&self, across: usize) -> impl Iterator<Item = (usize, usize)> {
        let Self { column, row, width, height } = *self;
        let columns = move |y| (0..width).map(move |x| ((column + x) % across, row + y));
        (0..height).flat_map(columns)
    }
}

impl Grid<'_> {
    /// Returns the sun: a small region about the brightest patch with a significant part of the light,
    /// which is `total`. `None` if there is none.
    pub(super) fn sun(&self, total: f64) -> Option<Region> {
        let mut sun = self.brightest().filter(|sun| self.is_small(sun))?;
        while let Some(larger) = self.grown(&sun) {
            sun = larger;
        }
        let all = Region { column: 0, row: 0, width: self.width, height: self.height };
        (sun != all && self.light_of(&sun) > SHARE * total).then_some(sun)
    }

    fn brightest(&self) -> Option<Region> {
        let mut greatest = (0.0, None);
        for row in 0..self.height {
            for column in 0..self.width {
                let radiance = (self.light)(column, row) / (self.solid_angle)(row);
                if radiance > greatest.0 {
                    greatest = (radiance, Some(Region { column, row, width: 1, height: 1 }));
                }
            }
        }
        greatest.1
    }

    /// Returns the region with the brightest of the strips beside it; `None` if that is much darker or
    /// makes it too large.
    fn grown(&self, sun: &Region) -> Option<Region> {
        let &Region { column, row, width, height } = sun;
        let left = (column + self.width - 1) % self.width;
        let mut beside = Vec::with_capacity(4);
        if width < self.width {
            let right = (column + width) % self.width;
            let wider = Region { width: width + 1, ..*sun };
            beside.push((
                Region { column: left, width: 1, ..*sun },
                Region { column: left, ..wider },
            ));
            beside.push((Region { column: right, width: 1, ..*sun }, wider));
        }
        let higher = Region { height: height + 1, ..*sun };
        if row > 0 {
            beside.push((
                Region { row: row - 1, height: 1, ..*sun },
                Region { row: row - 1, ..higher },
            ));
        }
        if row + height < self.height {
            beside.push((Region { row: row + height, height: 1, ..*sun }, higher));
        }
        beside.retain(|(_, larger)| self.is_small(larger));
        let least = CONTRAST * self.radiance(sun);
        let bright = beside.into_iter().map(|(strip, larger)| (self.radiance(&strip), larger));
        let brightest = bright.reduce(|a, b| if b.0 > a.0 { b } else { a });
        brightest.filter(|(radiance, _)| *radiance >= least).map(|(_, larger)| larger)
    }

    fn light_of(&self, region: &Region) -> f64 {
        region.patches(self.width).map(|(column, row)| (self.light)(column, row)).sum()
    }

    /// Returns the mean luminance of a region.
    fn radiance(&self, region: &Region) -> f64 {
        let solid_angle: f64 =
            region.patches(self.width).map(|(_, row)| (self.solid_angle)(row)).sum();
        self.light_of(region) / solid_angle
    }

    fn is_small(&self, region: &Region) -> bool {
        let step = PI / (self.height - 1) as f64;
        let rows = region.row..region.row + region.height;
        // The width of a patch is its solid angle over its height.
        let widest = rows.map(|row| (self.solid_angle)(row) / step).fold(0.0, f64::max);
        step * region.height as f64 <= EXTENT && widest * region.width as f64 <= EXTENT
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WIDTH: usize = 72;
    const HEIGHT: usize = 37;

    /// Returns the sun of a picture that is 0.01 elsewhere than in `bright` patches.
    fn sun(radiance: f64, bright: &[(usize, usize)]) -> Option<Region> {
        let solid_angle = |row: usize| {
            let middle = (row as f64).clamp(0.25, HEIGHT as f64 - 1.25) / (HEIGHT - 1) as f64;
            let step = PI / (HEIGHT - 1) as f64;
            let height = if row == 0 || row == HEIGHT - 1 { step / 2.0 } else { step };
            (middle * PI).sin() * height * 2.0 * PI / WIDTH as f64
        };
        let light = |column, row| {
            let lit = bright.contains(&(column, row));
            solid_angle(row) * if lit { radiance } else { 0.01 }
        };
        let grid = Grid { width: WIDTH, height: HEIGHT, light: &light, solid_angle: &solid_angle };
        let all = Region { column: 0, row: 0, width: WIDTH, height: HEIGHT };
        grid.sun(grid.light_of(&all))
    }

    #[test]
    fn small_bright_regions_are_suns() {
        let one = Region { column: 20, row: 9, width: 1, height: 1 };
        assert_eq!(sun(10.0, &[(20, 9)]), Some(one));
        assert_eq!(sun(10.0, &[(20, 9), (21, 9)]), Some(Region { width: 2, ..one }));
        let four = [(20, 9), (21, 9), (20, 10), (21, 10)];
        assert_eq!(sun(10.0, &four), Some(Region { width: 2, height: 2, ..one }));
        // Around the seam, and at the pole.
        let seam = Region { column: WIDTH - 1, width: 2, ..one };
        assert_eq!(sun(10.0, &[(0, 9), (WIDTH - 1, 9)]), Some(seam));
        let pole: Vec<_> = (0..WIDTH).map(|column| (column, 0)).collect();
        let polar =
            sun(100.0, &pole).map(|Region { column: _, row, width, height }| (row, width, height));
        assert_eq!(polar, Some((0, WIDTH, 1)));
    }

    #[test]
    fn even_light_and_faint_suns_are_none() {
        assert_eq!(sun(0.01, &[]), None);
        assert_eq!(sun(0.1, &[(20, 9)]), None);
        assert_eq!(sun(0.0, &[]), None);
    }

    #[test]
    fn positions_wrap_around() {
        let region = Region { column: 70, row: 3, width: 4, height: 2 };
        assert_eq!(region.position(72, (1, 4)), Some((3, 1)));
        assert_eq!(region.position(72, (70, 3)), Some((0, 0)));
        assert_eq!(region.position(72, (2, 4)), None);
        assert_eq!(region.position(72, (71, 2)), None);
        for patch in region.patches(72) {
            let (x, y) = region.position(72, patch).expect("it is one of them");
            assert_eq!(((70 + x) % 72, 3 + y), patch);
        }
    }
}
