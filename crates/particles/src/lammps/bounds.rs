//! Simulation boxes of LAMMPS (<https://docs.lammps.org/Howto_triclinic.html>).

use crate::cell::Cell;
use glam::DVec3;

/// Returns the cell of a box with lower and upper corners and tilt factors `xy xz yz`.
pub(super) fn tilted(low: [f64; 3], high: [f64; 3], tilt: [f64; 3]) -> Cell {
    let [xy, xz, yz] = tilt;
    let vectors = [
        DVec3::new(high[0] - low[0], 0.0, 0.0),
        DVec3::new(xy, high[1] - low[1], 0.0),
        DVec3::new(xz, yz, high[2] - low[2]),
    ];
    Cell { origin: DVec3::from_array(low), vectors, periodic: [true; 3] }
}

/// Returns the cell of a dump's bounds, which enclose the tilted box.
pub(super) fn tilted_from_bounds(low: [f64; 3], high: [f64; 3], tilt: [f64; 3]) -> Cell {
    let [xy, xz, yz] = tilt;
    let [x_low, y_low, z_low] = low;
    let [x_high, y_high, z_high] = high;
    let least = |values: &[f64]| values.iter().copied().fold(0.0, f64::min);
    let greatest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    let tilts = [xy, xz, xy + xz];
    tilted(
        [x_low - least(&tilts), y_low - least(&[yz]), z_low],
        [x_high - greatest(&tilts), y_high - greatest(&[yz]), z_high],
        tilt,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_of_a_tilted_box_contain_its_corners() {
        for tilt in [[0.5, -0.25, 0.75], [-0.5, -0.25, -0.125], [0.0; 3], [0.5, -0.75, 0.0]] {
            let (low, high) = ([1.0, 2.0, 3.0], [4.0, 6.0, 8.0]);
            let cell = tilted(low, high, tilt);
            let corners = (0..8)
                .map(|corner| cell.cartesian([0, 1, 2].map(|axis| f64::from(corner >> axis & 1))));
            let (mut least, mut greatest) = (DVec3::MAX, DVec3::MIN);
            for corner in corners {
                (least, greatest) = (least.min(corner), greatest.max(corner));
            }
            let again = tilted_from_bounds(least.to_array(), greatest.to_array(), tilt);
            assert_eq!(again, cell, "{tilt:?}");
        }
    }
}
