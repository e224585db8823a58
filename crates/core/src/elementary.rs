//! Elementary functions that give the same bits on every platform.
//!
//! The standard library calls the functions of the system's library, whose last bits depend on its version
//! and on the processor that it finds at run time. An image must not: so everything that an image
//! shows calls these, of the crate `libm`, which are compiled with the program. They use no instruction
//! whose result varies; the roots and fused multiply-adds that they take from a processor that has them are
//! rounded as those in software are. `clippy.toml` forbids the standard library's.
//!
//! Functions that are exact or rounded correctly everywhere may be called as they are: `sqrt`, `mul_add`, `floor`,
//! `round`, `to_radians`, and `powi` with a constant exponent of at most 3.

use glam::{DQuat, DVec3};
pub use libm::{
    acos, asin, atan, atan2, cbrt, cos, exp, hypot, log as ln, log2, log10, pow, sin, sincos, tan,
};
pub use libm::{cbrtf, exp2f, log2f};

/// Two to an integer power, exactly; infinite or 0 beyond the range of double precision.
pub const fn power_of_two(exponent: i32) -> f64 {
    match exponent {
        1024.. => f64::INFINITY,
        -1022..1024 => f64::from_bits(((exponent + 1023) as u64) << 52),
        // Subnormal numbers have no hidden bit.
        -1074..-1022 => f64::from_bits(1 << (exponent + 1074)),
        _ => 0.0,
    }
}

/// Two to any power.
pub fn exp2(x: f64) -> f64 {
    libm::exp2(x)
}

/// Ten to an integer power, by multiplication: exact up to 22.
pub fn power_of_ten(exponent: u32) -> f64 {
    (0..exponent).fold(1.0, |power, _| power * 10.0)
}

/// The exponent of the greatest power of two that is not above a positive, finite number.
pub fn floor_log2(x: f64) -> i32 {
    match (x.to_bits() >> 52) as i32 {
        // Subnormal.
        0 => libm::ilogb(x),
        biased => biased - 1023,
    }
}

/// The exponent of the least power of two that is not below a positive, finite number.
pub fn ceil_log2(x: f64) -> i32 {
    let floor = floor_log2(x);
    if power_of_two(floor) < x { floor + 1 } else { floor }
}

/// Returns the rotation about a unit vector by an angle in radians.
pub fn rotation(axis: DVec3, angle: f64) -> DQuat {
    let (sine, cosine) = sincos(angle * 0.5);
    let v = axis * sine;
    DQuat::from_xyzw(v.x, v.y, v.z, cosine)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_of_two_are_exact_and_logarithms_are_rounded_to_them() {
        for exponent in -1074..=1023 {
            let power = power_of_two(exponent);
            let bits = if exponent < -1022 {
                1 << (exponent + 1074)
            } else {
                ((exponent + 1023) as u64) << 52
            };
            assert_eq!(power.to_bits(), bits, "{exponent}");
            assert_eq!((floor_log2(power), ceil_log2(power)), (exponent, exponent));
            if exponent > -1022 {
                let (below, above) = (power.next_down(), power.next_up());
                assert_eq!((floor_log2(below), ceil_log2(below)), (exponent - 1, exponent));
                assert_eq!((floor_log2(above), ceil_log2(above)), (exponent, exponent + 1));
            }
        }
        for (exponent, power) in [(1024, f64::INFINITY), (i32::MAX, f64::INFINITY), (-1075, 0.0)] {
            assert_eq!(power_of_two(exponent), power);
        }
        assert_eq!(power_of_two(i32::MIN), 0.0);
    }

    #[test]
    fn powers_of_ten_are_those_of_the_compiler() {
        assert_eq!([0, 1, 15, 22].map(power_of_ten), [1.0, 10.0, 1e15, 1e22]);
        assert!((power_of_ten(300) / 1e300 - 1.0).abs() < 1e-14);
    }

    /// The bits are those of both x86-64 and `AArch64`.
    #[test]
    fn functions_have_the_same_last_bits_everywhere() {
        for (place, (found, expected)) in [
            (sin(0.7), 0x3fe4_9d6e_6946_19b8),
            (cos(0.7), 0x3fe8_7996_529f_9d93),
            (tan(0.7), 0x3fea_f406_c2fc_78ae),
            (asin(0.7), 0x3fe8_d00e_692a_fd95),
            (acos(0.7), 0x3fe9_73e8_3f5d_5c9b),
            (atan(0.7), 0x3fe3_8b11_2d7b_d4ad),
            (atan2(0.7, -0.3), 0x3fff_9c6b_238c_6435),
            (exp(0.7), 0x4000_1c2a_6126_8987),
            (exp2(0.7), 0x3ff9_fdf8_bcce_533d),
            (ln(0.7), 0xbfd6_d3c3_24e1_3f50),
            (log2(0.7), 0xbfe0_7762_2896_7d13),
            (log10(0.7), 0xbfc3_d3d3_d21c_cf04),
            (pow(0.7, 2.4), 0x3fdb_30bc_b6ea_848e),
            (cbrt(0.7), 0x3fec_69b5_a72f_1a99),
            (hypot(0.7, 0.3), 0x3fe8_5ed7_614b_038c),
        ]
        .into_iter()
        .enumerate()
        {
            assert_eq!(f64::to_bits(found), expected, "function {place}: {found}");
        }
    }

    #[test]
    fn rotations_turn_by_the_right_hand_rule() {
        let turned = rotation(DVec3::Z, std::f64::consts::FRAC_PI_2) * DVec3::X;
        assert!(turned.distance(DVec3::Y) < 1e-15, "{turned}");
    }
}
