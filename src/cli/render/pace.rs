//! The pace of a sequence: how many of its images are rendered, and the time left.

use indicatif::HumanDuration;
use std::time::{Duration, Instant};

/// The images of a sequence that this run renders.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    began: Instant,
    /// Number of images that are rendered or being rendered.
    begun: u64,
    /// Number of all; `None` if the input can be read only once.
    total: Option<u64>,
}

impl Pace {
    pub(super) fn new(total: Option<u64>) -> Self {
        Self { began: Instant::now(), begun: 0, total }
    }

    /// Counts the next image.
    pub(super) fn next(&mut self) {
        self.begun += 1;
    }

    /// Returns the place of the image, as in `13 of 24`.
    pub(super) fn place(&self) -> String {
        match self.total {
            Some(total) => format!("{} of {total}", self.begun),
            None => self.begun.to_string(),
        }
    }

    /// Returns the time left after the image, at the mean pace so far; `None` if there are no more, or if their number is unknown.
    pub(super) fn left(&self) -> Option<String> {
        let left = self.total?.checked_sub(self.begun).filter(|left| *left > 0)?;
        Some(time_left(self.began.elapsed(), self.begun, left))
    }
}

fn time_left(elapsed: Duration, done: u64, left: u64) -> String {
    let seconds = elapsed.as_secs_f64() * left as f64 / done.max(1) as f64;
    format!("{} left", HumanDuration(Duration::from_secs(seconds.round() as u64)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_times_follow_the_images() {
        let mut pace = Pace::new(Some(3));
        pace.next();
        assert_eq!(pace.place(), "1 of 3");
        assert!(pace.left().is_some());
        (0..2).for_each(|_| pace.next());
        assert_eq!((pace.place().as_str(), pace.left()), ("3 of 3", None));
        let mut stream = Pace::new(None);
        stream.next();
        assert_eq!((stream.place().as_str(), stream.left()), ("1", None));
        assert_eq!(time_left(Duration::from_secs(10), 5, 20), "40 seconds left");
    }
}
