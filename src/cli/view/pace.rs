//! Quality and size of the images that are sent, by the time until they are shown.

use std::time::Duration;

/// An image while the camera moves.
struct Level {
    /// Quality of the JPEG file.
    quality: u8,
    /// Maximum number of pixels.
    pixels: u64,
}

/// Images while the camera moves, best first. A file of the last one has some 3 KB.
const LEVELS: [Level; 8] = [
    Level { quality: 85, pixels: u64::MAX },
    Level { quality: 75, pixels: u64::MAX },
    Level { quality: 60, pixels: 2_000_000 },
    Level { quality: 50, pixels: 1_000_000 },
    Level { quality: 50, pixels: 500_000 },
    Level { quality: 50, pixels: 250_000 },
    Level { quality: 45, pixels: 120_000 },
    Level { quality: 40, pixels: 60_000 },
];

/// Times until an image is shown, beyond what any image takes on this way, above which images become smaller, and below which
/// they become larger.
const SLOW: Duration = Duration::from_millis(45);
const FAST: Duration = Duration::from_millis(20);

/// Maximum time that any image is taken to need, and its growth with each of the smallest images: the way may become longer.
const FARTHEST: Duration = Duration::from_millis(400);
const DRIFT: f64 = 1.01;

/// Number of fast images before they become larger.
const PROOF: u32 = 8;

/// The state of the control.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Pace {
    step: usize,
    fast: u32,
    /// The shortest time until an image was shown: the length of the way.
    least: Option<Duration>,
}

impl Pace {
    /// Records the time from sending an image until it was shown.
    pub(super) fn record(&mut self, time: Duration) {
        // The smallest images tell whether the way has become longer; others wait for each other.
        let drift = if self.step + 1 == LEVELS.len() { DRIFT } else { 1.0 };
        let least = self.least.map_or(time, |least| least.mul_f64(drift)).min(time).min(FARTHEST);
        self.least = Some(least);
        let beyond = time.saturating_sub(least);
        if beyond > SLOW {
            self.step = (self.step + 1).min(LEVELS.len() - 1);
            self.fast = 0;
        } else if beyond < FAST {
            self.fast += 1;
            if self.fast >= PROOF {
                (self.step, self.fast) = (self.step.saturating_sub(1), 0);
            }
        } else {
            self.fast = 0;
        }
    }

    /// Quality of an image while the camera moves.
    pub(super) fn moving(self) -> u8 {
        LEVELS[self.step].quality
    }

    /// Maximum number of pixels of an image while the camera moves.
    pub(super) fn pixels(self) -> u64 {
        LEVELS[self.step].pixels
    }

    /// Quality of an image that refines.
    pub(super) fn resting(self) -> u8 {
        LEVELS[self.step / 2].quality
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_connections_get_smaller_files() {
        let mut pace = Pace::default();
        let [slow, fast] = [200, 20].map(Duration::from_millis);
        pace.record(fast);
        assert_eq!((pace.moving(), pace.pixels()), (85, u64::MAX));
        (0..2).for_each(|_| pace.record(slow));
        assert_eq!((pace.moving(), pace.resting()), (60, 75));
        (0..30).for_each(|_| pace.record(slow));
        assert_eq!((pace.moving(), pace.pixels()), (40, 60_000));
        (0..7).for_each(|_| pace.record(fast));
        assert_eq!(pace.moving(), 40);
        (0..100).for_each(|_| pace.record(fast));
        assert_eq!(pace, Pace { step: 0, ..pace });
    }

    #[test]
    fn long_ways_are_no_reason_for_smaller_files() {
        let mut pace = Pace::default();
        (0..100).for_each(|_| pace.record(Duration::from_millis(150)));
        assert_eq!((pace.moving(), pace.pixels()), (85, u64::MAX));
        // A way that becomes longer is so at last.
        (0..300).for_each(|_| pace.record(Duration::from_millis(250)));
        assert_eq!(pace.moving(), 85);
    }
}
