//! Frame times of a moving camera.

use crate::cli::output;
use serde::Serialize;
use std::time::Duration;

/// Times between images while the camera moves (measured from the motion if the previous image was up to
/// date), and from the last motion to the first finer image.
#[derive(Clone, Debug, Default)]
pub(super) struct Times {
    pub(super) moving: Vec<Duration>,
    pub(super) rest: Vec<Duration>,
}

/// Statistics of times in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct TimeStatistics {
    count: usize,
    median_ms: f64,
    /// 99th percentile.
    p99_ms: f64,
}

#[derive(Serialize)]
struct Report {
    spheres: usize,
    moving: Option<TimeStatistics>,
    refined: Option<TimeStatistics>,
}

impl Times {
    /// Prints the statistics, if there are any.
    pub(super) fn print(&self, spheres: usize, json: bool) {
        let (moving, refined) = (spread(&self.moving), spread(&self.rest));
        if json {
            return output::print_json(&Report { spheres, moving, refined });
        }
        let line = |what: &str, spread: Option<TimeStatistics>| {
            if let Some(TimeStatistics { count, median_ms, p99_ms }) = spread {
                output::note(format_args!(
                    "{what}: {count} times, median {median_ms:.1} ms, 99th percentile {p99_ms:.1} ms"
                ));
            }
        };
        line("between images while moving", moving);
        line("from the last motion to a finer image", refined);
    }
}

fn spread(times: &[Duration]) -> Option<TimeStatistics> {
    let mut sorted = times.to_vec();
    sorted.sort_unstable();
    let of = |share: f64| {
        let place = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(place.saturating_sub(1)).map(|time| 1e3 * time.as_secs_f64())
    };
    Some(TimeStatistics { count: sorted.len(), median_ms: of(0.5)?, p99_ms: of(0.99)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_are_those_of_sorted_times() {
        let times: Vec<Duration> = (1..=200).rev().map(Duration::from_millis).collect();
        let expected = TimeStatistics { count: 200, median_ms: 100.0, p99_ms: 198.0 };
        assert_eq!(spread(&times), Some(expected));
        assert_eq!(spread(&[]), None);
    }
}
