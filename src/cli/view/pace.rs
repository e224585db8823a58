//! Quality of the images that are sent, by the time until they are shown.

use std::time::Duration;

/// Qualities of JPEG files while the camera moves, best first.
const QUALITIES: [u8; 5] = [85, 75, 60, 45, 30];

/// Times until an image is shown above which the quality falls, and below which it rises.
const SLOW: Duration = Duration::from_millis(110);
const FAST: Duration = Duration::from_millis(55);

/// Number of fast images before the quality rises.
const PROOF: u32 = 8;

/// The state of the control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Pace {
    step: usize,
    fast: u32,
}

impl Pace {
    /// Records the time from sending an image until it was shown.
    pub(super) fn record(&mut self, time: Duration) {
        if time > SLOW {
            self.step = (self.step + 1).min(QUALITIES.len() - 1);
            self.fast = 0;
        } else if time < FAST {
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
        QUALITIES[self.step]
    }

    /// Quality of an image that refines.
    pub(super) fn resting(self) -> u8 {
        QUALITIES[self.step / 2]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slow_connections_get_smaller_files() {
        let mut pace = Pace::default();
        let [slow, fast] = [200, 20].map(Duration::from_millis);
        assert_eq!(pace.moving(), 85);
        (0..2).for_each(|_| pace.record(slow));
        assert_eq!((pace.moving(), pace.resting()), (60, 75));
        (0..100).for_each(|_| pace.record(slow));
        assert_eq!(pace.moving(), 30);
        (0..7).for_each(|_| pace.record(fast));
        assert_eq!(pace.moving(), 30);
        (0..100).for_each(|_| pace.record(fast));
        assert_eq!(pace, Pace { step: 0, ..pace });
        (0..100).for_each(|_| pace.record(Duration::from_millis(80)));
        assert_eq!(pace.moving(), 85);
    }
}
