//! Slopes in log-log space, and the positions where two curves reach the same value.

/// The positions where two falling curves reach the same value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EqualError {
    /// The smallest value that both reach.
    pub(super) value: f64,
    /// The position of each curve there.
    pub(super) places: [f64; 2],
}

/// Returns the slope of log y over log x, by least squares; `None` for fewer than two values of x.
pub(super) fn slope(points: &[(f64, f64)]) -> Option<f64> {
    let logs: Vec<_> = points.iter().map(|&(x, y)| (x.ln(), y.ln())).collect();
    let count = logs.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / count;
    let center = (mean(|at| at.0), mean(|at| at.1));
    let sum = |of: &dyn Fn(f64, f64) -> f64| {
        logs.iter().map(|&(x, y)| of(x - center.0, y - center.1)).sum::<f64>()
    };
    let (covariance, variance) = (sum(&|x, y| x * y), sum(&|x, _| x * x));
    (logs.len() > 1 && variance > 0.0).then(|| covariance / variance)
}

/// Finds where two curves first reach the smallest value that both reach. Points are interpolated
/// linearly in log-log space. Returns `None` if the curves have no value in common.
pub(super) fn equal(first: &[(f64, f64)], second: &[(f64, f64)]) -> Option<EqualError> {
    let least = |points: &[(f64, f64)]| points.iter().map(|at| at.1).fold(f64::INFINITY, f64::min);
    let value = least(first).max(least(second));
    Some(EqualError { value, places: [reaches(first, value)?, reaches(second, value)?] })
}

/// Finds where a falling curve, of places and values, first reaches the value; `None` if it never does, or begins below
/// it. Points are interpolated linearly in log-log space.
pub fn reaches(points: &[(f64, f64)], value: f64) -> Option<f64> {
    if points.first()?.1 <= value {
        return points.first().filter(|first| first.1 == value).map(|first| first.0);
    }
    let pair = points.windows(2).find(|pair| pair[1].1 <= value)?;
    let [(x0, y0), (x1, y1)] = [pair[0], pair[1]].map(|(x, y)| (x.ln(), y.ln()));
    Some((x0 + (x1 - x0) * (value.ln() - y0) / (y1 - y0)).exp())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(factor: f64, power: f64) -> Vec<(f64, f64)> {
        [1.0, 4.0, 16.0, 64.0].map(|x: f64| (x, factor * x.powf(power))).to_vec()
    }

    #[test]
    fn slopes_are_powers() {
        for power in [-0.5, -1.0, 0.75] {
            assert!((slope(&curve(3.0, power)).unwrap() - power).abs() < 1e-12);
        }
        assert_eq!(slope(&[(1.0, 2.0)]), None);
        assert_eq!(slope(&[(1.0, 2.0), (1.0, 3.0)]), None);
        assert_eq!(slope(&[]), None);
    }

    #[test]
    fn equal_errors_are_interpolated() {
        // Half the error is reached in a quarter of the time.
        let (slow, fast) = (curve(2.0, -0.5), curve(1.0, -0.5));
        let found = equal(&slow, &fast).unwrap();
        assert!((found.value - 0.25).abs() < 1e-12);
        assert!((found.places[0] / found.places[1] - 4.0).abs() < 1e-9);
        assert!((equal(&slow, &slow).unwrap().places[0] - 64.0).abs() < 1e-9);
        let lower = curve(0.01, -0.5);
        assert_eq!(equal(&slow, &lower), None);
        assert_eq!(equal(&slow, &[]), None);
    }
}
