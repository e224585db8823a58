//! How long pictures of a moving camera took.

use crate::cli::output;
use serde::Serialize;
use std::time::Duration;

/// Times from one picture to the next while the camera moves, or from the motion if the picture before
/// was of all that had moved; and from the last motion to the first picture that is finer than those.
#[derive(Clone, Debug, Default)]
pub(super) struct Times {
    pub(super) moving: Vec<Duration>,
    pub(super) rest: Vec<Duration>,
}

/// Of some times, in milliseconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
struct Spread {
    count: usize,
    median_ms: f64,
    /// 99 of 100 are not above it.
    p99_ms: f64,
}

#[derive(Serialize)]
struct Report {
    spheres: usize,
    moving: Option<Spread>,
    refined: Option<Spread>,
}

impl Times {
    /// Tells them, if there are any.
    pub(super) fn tell(&self, spheres: usize, json: bool) {
        let (moving, refined) = (spread(&self.moving), spread(&self.rest));
        if json {
            return output::print_json(&Report { spheres, moving, refined });
        }
        let line = |what: &str, spread: Option<Spread>| {
            if let Some(Spread { count, median_ms, p99_ms }) = spread {
                output::note(format_args!(
                    "{what}: {count} times, {median_ms:.1} ms in the median, 99 % within \
                     {p99_ms:.1} ms"
                ));
            }
        };
        line("from picture to picture while moving", moving);
        line("from the last motion to a finer picture", refined);
    }
}

fn spread(times: &[Duration]) -> Option<Spread> {
    let mut sorted = times.to_vec();
    sorted.sort_unstable();
    let of = |share: f64| {
        let place = (share * sorted.len() as f64).ceil() as usize;
        sorted.get(place.saturating_sub(1)).map(|time| 1e3 * time.as_secs_f64())
    };
    Some(Spread { count: sorted.len(), median_ms: of(0.5)?, p99_ms: of(0.99)? })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spreads_are_those_of_sorted_times() {
        let times: Vec<Duration> = (1..=200).rev().map(Duration::from_millis).collect();
        let expected = Spread { count: 200, median_ms: 100.0, p99_ms: 198.0 };
        assert_eq!(spread(&times), Some(expected));
        assert_eq!(spread(&[]), None);
    }
}
