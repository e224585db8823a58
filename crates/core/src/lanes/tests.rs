use super::*;

const NAN: f32 = f32::NAN;
const VALUES: [f32; 16] = [
    1.0,
    -0.0,
    0.0,
    NAN,
    3.5,
    -2.0,
    1e-40,
    f32::INFINITY,
    -1.0,
    2.0,
    4.0,
    9.0,
    1e30,
    -1e30,
    0.1,
    7.0,
];
const OTHERS: [f32; 16] =
    [2.0, 0.0, NAN, 1.0, 3.5, 2.0, 1e-41, 1.0, -1.5, NAN, 0.3, 1e-9, 1e30, 1.0, 0.7, -7.0];

/// Every operation on `L` agrees bit by bit with the same on `f32`.
fn agrees_with_scalar<L: Lanes>() {
    for row in (0..16).step_by(L::WIDTH) {
        let (a, b) = (L::load(&VALUES[row..]), L::load(&OTHERS[row..]));
        let zero = L::splat(0.0);
        let masks = [
            a.lt(b),
            a.le(b),
            a.is_negative(),
            a.min(b).le(a.max(b)),
            zero.lt(a.mul_add(b, a)),
            L::select(a.lt(b), a, b).le(a.abs().sqrt()),
            !(a.lt(b)) & (a.le(b) | b.lt(zero)),
            (a / b - b * a).lt(-(a + b)),
        ];
        for lane in 0..L::WIDTH {
            let (x, y) = (VALUES[row + lane], OTHERS[row + lane]);
            let expected = [
                x.lt(y),
                x.le(y),
                Lanes::is_negative(x),
                Lanes::min(x, y).le(Lanes::max(x, y)),
                0.0_f32.lt(Lanes::mul_add(x, y, x)),
                f32::select(x.lt(y), x, y).le(x.abs().sqrt()),
                !(x.lt(y)) & (x.le(y) | y.lt(0.0)),
                (x / y - y * x).lt(-(x + y)),
            ];
            let got = masks.map(|mask| mask.bits() >> lane & 1 == 1);
            assert_eq!(got, expected, "width {} lane {lane}: {x} {y}", L::WIDTH);
        }
    }
}

#[test]
fn every_width_computes_what_one_lane_does() {
    agrees_with_scalar::<wide::f32x4>();
    agrees_with_scalar::<wide::f32x8>();
    agrees_with_scalar::<wide::f32x16>();
}

#[test]
fn min_and_max_drop_a_nan_on_the_left() {
    assert_eq!(Lanes::min(NAN, 2.0), 2.0);
    assert_eq!(Lanes::max(NAN, 2.0), 2.0);
}

#[test]
fn set_bits_come_in_order() {
    assert_eq!(set_bits(0b1010_0001_u32).collect::<Vec<_>>(), [0, 5, 7]);
    assert_eq!(set_bits(0_u32).count(), 0);
    assert_eq!(set_bits(u32::MAX).count(), 32);
}
