use super::*;
use glam::{DMat3, DVec3};

/// The product of a matrix, by its rows, and a vector.
fn product(rows: [[f64; 3]; 3], vector: DVec3) -> DVec3 {
    DMat3::from_cols_array_2d(&rows).transpose() * vector
}

/// Linear colors as dichromats see them: Machado, Oliveira & Fernandes, "A Physiologically-based Model for Simulation of
/// Color Vision Deficiency", 2009, at severity 1.
const EYES: [[[f64; 3]; 3]; 3] = [
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    [
        [0.152_286, 1.052_583, -0.204_868],
        [0.114_503, 0.786_281, 0.099_216],
        [-0.003_882, -0.048_116, 1.051_998],
    ],
    [
        [0.367_322, 0.860_646, -0.227_968],
        [0.280_085, 0.672_501, 0.047_413],
        [-0.011_820, 0.042_940, 0.968_881],
    ],
];

/// CIE XYZ of linear sRGB, from the primaries and the white of IEC 61966-2-1.
const XYZ: [[f64; 3]; 3] = [
    [0.412_456_4, 0.357_576_1, 0.180_437_5],
    [0.212_672_9, 0.715_152_2, 0.072_175_0],
    [0.019_333_9, 0.119_192_0, 0.950_304_1],
];

/// CIELAB of a linear color.
fn lab(color: DVec3) -> [f64; 3] {
    let color = color.clamp(DVec3::ZERO, DVec3::ONE);
    let relative = product(XYZ, color) / product(XYZ, DVec3::ONE);
    let root = |t: f64| {
        if t > 216.0 / 24389.0 { t.cbrt() } else { (24389.0 / 27.0 * t + 16.0) / 116.0 }
    };
    let [x, y, z] = relative.to_array().map(root);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// The color difference CIEDE2000: Sharma, Wu & Dalal, "The CIEDE2000 Color-Difference Formula: Implementation Notes,
/// Supplementary Test Data, and Mathematical Observations", 2005.
fn difference(first: [f64; 3], second: [f64; 3]) -> f64 {
    let chroma = |[_, a, b]: [f64; 3]| f64::hypot(a, b);
    let excess = |chroma: f64| (chroma.powi(7) / (chroma.powi(7) + 25_f64.powi(7))).sqrt();
    let stretch = 1.5 - 0.5 * excess(f64::midpoint(chroma(first), chroma(second)));
    let [first, second] = [first, second].map(|[l, a, b]| [l, a * stretch, b]);
    let chromas = [first, second].map(chroma);
    let hues = [first, second].map(|[_, a, b]| b.atan2(a).to_degrees().rem_euclid(360.0));
    let turn = (hues[1] - hues[0] + 180.0).rem_euclid(360.0) - 180.0;
    let product = chromas[0] * chromas[1];
    let turn = if product == 0.0 { 0.0 } else { turn };
    let hue_step = 2.0 * product.sqrt() * (turn / 2.0).to_radians().sin();
    let hue = if product == 0.0 { hues[0] + hues[1] } else { hues[0] + turn / 2.0 };
    let lightness = f64::midpoint(first[0], second[0]);
    let chroma = f64::midpoint(chromas[0], chromas[1]);
    let wave = |factor: f64, offset: f64| (factor * hue + offset).to_radians().cos();
    let t = 1.0 - 0.17 * wave(1.0, -30.0) + 0.24 * wave(2.0, 0.0) + 0.32 * wave(3.0, 6.0)
        - 0.2 * wave(4.0, -63.0);
    let offset = (lightness - 50.0).powi(2);
    let l = (second[0] - first[0]) / (1.0 + 0.015 * offset / (20.0 + offset).sqrt());
    let c = (chromas[1] - chromas[0]) / (1.0 + 0.045 * chroma);
    let h = hue_step / (1.0 + 0.015 * chroma * t);
    let from_blue = (hue.rem_euclid(360.0) - 275.0) / 25.0;
    let rotation =
        -(60.0 * (-from_blue * from_blue).exp()).to_radians().sin() * 2.0 * excess(chroma);
    (l * l + c * c + h * h + rotation * c * h).sqrt()
}

/// Pairs of the paper's table 1.
#[test]
fn differences_are_those_of_the_paper() {
    for (first, second, expected) in [
        ([50.0, 2.6772, -79.7751], [50.0, 0.0, -82.7485], 2.0425),
        ([50.0, -1.3802, -84.2814], [50.0, 0.0, -82.7485], 1.0),
        ([50.0, 2.5, 0.0], [50.0, 0.0, -2.5], 4.3065),
        ([50.0, 2.5, 0.0], [73.0, 25.0, -18.0], 27.1492),
        ([60.2574, -34.0099, 36.2677], [60.4626, -34.1751, 39.4387], 1.2644),
        ([2.0776, 0.0795, -1.1350], [0.9033, -0.0636, -0.5514], 0.9082),
    ] {
        for found in [difference(first, second), difference(second, first)] {
            assert!((found - expected).abs() < 5e-5, "{first:?} {second:?}: {found}");
        }
    }
}

#[test]
fn no_two_colors_are_near_for_any_eyes() {
    for (count, least) in
        [(10, [17.34, 11.91, 12.62]), (20, [13.49, 9.66, 9.75]), (CATEGORIES, [12.70, 8.74, 8.69])]
    {
        for (eyes, least) in EYES.into_iter().zip(least) {
            let seen: Vec<[f64; 3]> =
                (0..count).map(|row| lab(product(eyes, category(row).as_dvec3()))).collect();
            for (row, color) in seen.iter().enumerate() {
                for (other, before) in seen[..row].iter().enumerate() {
                    let found = difference(*color, *before);
                    assert!(found > least, "{count}: {other} and {row} differ by {found}");
                }
            }
        }
    }
}

#[test]
fn colors_repeat_after_the_last() {
    assert_eq!(CATEGORIES, 30);
    assert_eq!(category(0), srgb(0x3F_90_DA));
    for index in 0..CATEGORIES {
        assert_eq!(category(index + CATEGORIES), category(index));
    }
}
