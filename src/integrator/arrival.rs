//! How paths came to where they are.

use crate::lanes::Lanes;

/// How a path, or a row of them, came to its last point, which decides how the light that it finds
/// there counts.
///
/// It is the density of the last direction by solid angle, which tells two things more. It is
/// negative where the last surface was diffuse: there light samples alone count for lights that are
/// not close. It is infinite where no light sample could have found the direction, from the camera,
/// a mirror or glass, and negative then if there were only these since the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival<L>(pub L);

impl<L: Lanes> Arrival<L> {
    /// At the first hit.
    #[inline(always)]
    pub fn camera() -> Self {
        Self(L::splat(f32::NEG_INFINITY))
    }

    /// Densities; infinite where no light sample could have found the direction.
    #[inline(always)]
    pub fn density(self) -> L {
        self.0.abs()
    }

    /// Where a light sample could have found the direction as well.
    #[inline(always)]
    pub fn sampled(self) -> L::Mask {
        self.density().lt(L::splat(f32::INFINITY))
    }

    /// Where the last surface was diffuse.
    #[inline(always)]
    pub fn diffuse(self) -> L::Mask {
        self.0.lt(L::splat(0.0)) & self.sampled()
    }

    /// Where there were only mirrors and glass since the camera.
    #[inline(always)]
    pub fn unscattered(self) -> L::Mask {
        self.0.le(L::splat(f32::NEG_INFINITY))
    }

    /// After one surface more, which has sent paths on with these densities: 0 for mirrors and
    /// glass.
    #[inline(always)]
    pub fn onward(self, density: L, diffuse: bool) -> Self {
        let infinite = L::splat(f32::INFINITY);
        let mirrored = L::select(self.unscattered(), -infinite, infinite);
        let scattered = L::splat(0.0).lt(density);
        Self(L::select(scattered, if diffuse { -density } else { density }, mirrored))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_number_says_all() {
        let told = |arrival: Arrival<f32>| {
            (arrival.sampled(), arrival.diffuse(), arrival.unscattered(), arrival.density())
        };
        let none = f32::INFINITY;
        let camera = Arrival::camera();
        assert_eq!(told(camera), (false, false, true, none));
        assert_eq!(told(camera.onward(0.0, false)), (false, false, true, none));
        let rough = camera.onward(2.0, false);
        assert_eq!(told(rough), (true, false, false, 2.0));
        assert_eq!(told(rough.onward(0.0, false)), (false, false, false, none));
        let even = rough.onward(3.0, true);
        assert_eq!(told(even), (true, true, false, 3.0));
        assert_eq!(told(even.onward(0.0, false)), (false, false, false, none));
    }
}
