//! Tests of integer arithmetic against closed forms.

use super::*;

#[test]
fn numbers_become_integers() {
    let lowest = |numbers: &[f32]| lowest_exponent(numbers);
    assert_eq!(lowest(&[0.0, 0.75, 4.0]), -2);
    assert_eq!(lowest(&[0.0, 1e-45]), -149);
    assert_eq!(lowest(&[f32::MAX, 0.0]), 104);
    assert_eq!(lowest(&[0.0]), 0);
    assert_eq!(to_integer(-0.75, -2), BigInt::from(-3));
    assert_eq!(to_integer(f32::MAX, 104), BigInt::from((1 << 24) - 1));
    assert_eq!(to_integer(0.0, 5), BigInt::ZERO);
}

#[test]
fn quotients_have_more_than_a_hundred_bits() {
    let third = quotient(BigInt::from(-1), &BigInt::from(3), 4);
    assert!((third.high + 16.0 / 3.0).abs() < 1e-15 && third.low != 0.0);
    // 3 (high + low) + 16 is the error; its evaluation is exact.
    let error = third.high.mul_add(3.0, 16.0) + 3.0 * third.low;
    assert!(error.abs() < 1e-30, "{error}");
    assert_eq!(quotient(BigInt::ZERO, &BigInt::from(3), 0), DoubleDouble::default());
    let huge = quotient(BigInt::from(3) << 900, &BigInt::from(4), -1000);
    assert_eq!(huge, DoubleDouble { high: 0.75 * (-100_f64).exp2(), low: 0.0 });
}

/// Rays along an axis, so that distances are powers of two.
#[test]
fn rational_distances_are_compared_with_numbers() {
    for (scale, length) in [(0, 0), (-140, 120), (100, -140)] {
        let [scale, length] = [scale, length].map(|exponent: i32| (exponent as f32).exp2());
        let ray = |x| Ray { origin: [-2.0 * scale, 0.0, 0.0], direction: [x, 0.0, 0.0] };
        let (ahead, around) = ([scale, 0.0, 0.0, scale], [-scale, 0.0, 0.0, 3.0 * scale]);
        let t = f64::from(2.0 * scale) / f64::from(length);
        let numbers = [t.next_down(), t, t.next_up(), -t, 0.0];
        let expected = [Ordering::Greater, Ordering::Equal, Ordering::Less, Ordering::Greater];
        for (ray, row) in [(ray(length), ahead), (ray(-length), around)] {
            let hit = ExactHit::new(Units::of(&ray, &[row]), &ray, row).unwrap();
            let found = numbers.map(|number| hit.compare_with(number));
            assert_eq!(found[..4], expected, "{ray:?}");
            assert_eq!(found[4], Ordering::Greater, "{ray:?}");
        }
    }
}

#[test]
fn roots_are_compared_with_numbers() {
    // From the center of a sphere of radius 1 along (1, 1, 0): t = 1 / sqrt(2).
    let ray = Ray { origin: [0.0; 3], direction: [1.0, 1.0, 0.0] };
    let row = [0.0, 0.0, 0.0, 1.0];
    let hit = ExactHit::new(Units::of(&ray, &[row]), &ray, row).unwrap();
    let half = 0.5_f64.sqrt();
    let order = half.mul_add(-half, 0.5).partial_cmp(&0.0).unwrap();
    assert_eq!(hit.compare_with(half), order);
    assert_eq!(hit.compare_with(half.next_up()), Ordering::Less);
    assert_eq!(hit.compare_with(half.next_down()), Ordering::Greater);
}

#[test]
fn distances_are_compared_beyond_the_first_places() {
    // Spheres at nearly equal distances: the centers differ by 2^-100 along the ray.
    let ray = Ray { origin: [0.0; 3], direction: [1.0, 0.25, 0.0] };
    let tiny = 100_f32.exp2().recip();
    let spheres = [[0.5, 0.0, 0.0, 0.25], [0.5, 0.0, tiny, 0.25], [0.5, 0.0, -tiny, 0.25]];
    let units = Units::of(&ray, &spheres);
    let [first, up, down] = spheres.map(|row| ExactHit::new(units, &ray, row).unwrap());
    assert_eq!(first.compare(&up), Ordering::Less);
    assert_eq!(down.compare(&first), Ordering::Greater);
    assert_eq!(up.compare(&down), Ordering::Equal);
}
