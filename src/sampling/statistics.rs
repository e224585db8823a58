//! Tests of goodness of fit for the tests of this module.

/// Upper quantile of the normal distribution for a significance of 1e-5.
const Z: f64 = 4.264_890_8;

/// Fails unless counts fit probabilities by Pearson's chi-squared test at a significance of 1e-5.
///
/// Cells that expect fewer than 5 are pooled. The probabilities must sum to 1.
pub(super) fn assert_chi_squared(observed: &[u64], probabilities: &[f64]) {
    let sum: f64 = probabilities.iter().sum();
    assert!((sum - 1.0).abs() < 1e-4, "the probabilities sum to {sum}");
    let count = observed.iter().sum::<u64>() as f64;
    let (mut statistic, mut cells) = (0.0, 0_u32);
    let mut pooled = (0.0, 0.0);
    let mut add = |observed: f64, expected: f64| {
        statistic += (observed - expected).powi(2) / expected;
        cells += 1;
    };
    for (&observed, &probability) in observed.iter().zip(probabilities) {
        let expected = probability * count;
        if expected < 5.0 {
            pooled = (pooled.0 + observed as f64, pooled.1 + expected);
        } else {
            add(observed as f64, expected);
        }
    }
    if pooled.1 > 0.0 {
        add(pooled.0, pooled.1);
    } else {
        assert!(pooled.0 == 0.0, "{} samples where none can be", pooled.0);
    }
    let limit = chi_squared_quantile(f64::from(cells - 1));
    assert!(statistic < limit, "chi-squared {statistic} >= {limit} of {cells} cells");
}

/// Wilson & Hilferty, "The Distribution of Chi-Square", PNAS 1931.
fn chi_squared_quantile(degrees: f64) -> f64 {
    let spread = 2.0 / (9.0 * degrees);
    degrees * (1.0 - spread + Z * spread.sqrt()).powi(3)
}

#[test]
fn quantile_of_the_tables() {
    // Exact values, from the incomplete gamma function; the approximation errs to the safe side.
    for (degrees, quantile) in [(15.0, 50.493_006), (63.0, 122.727_215), (255.0, 362.988_816)] {
        let approximation = chi_squared_quantile(degrees);
        assert!((1.0..1.015).contains(&(approximation / quantile)), "{degrees}: {approximation}");
    }
}

#[test]
#[should_panic(expected = "chi-squared")]
fn a_bias_is_found() {
    let observed: Vec<u64> = (0..64).map(|i| if i < 32 { 1050 } else { 950 }).collect();
    assert_chi_squared(&observed, &[1.0 / 64.0; 64]);
}
