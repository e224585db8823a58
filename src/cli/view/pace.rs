//! How large pictures may be for the next one to be there in time.

use std::time::Duration;

/// Seconds that a picture may take while the camera moves: at first, at most, and at least. How much
/// of a thirtieth of a second that is depends on what else the machine does.
const BUDGET: f64 = 0.016;
const LARGEST: f64 = 0.026;
const SMALLEST: f64 = 0.012;

/// Seconds from picture to picture that are too many, and by which factors the budget then falls, or
/// else rises: so that one picture in eighty is late (Robbins & Monro, "A Stochastic Approximation
/// Method", The Annals of Mathematical Statistics 1951).
const LATE: f64 = 0.031;
const FALL: f64 = 0.85;
const RISE: f64 = 1.002;

/// Pixels in a second that are expected before anything was measured.
const GUESS: f64 = 2e6;

/// Least pixels of a picture.
const LEAST: f64 = 1024.0;

/// How much more pixels each picture of a camera at rest has than the one before.
const REFINED: f64 = 2.0;

/// Weight of the last measurement.
const WEIGHT: f64 = 0.4;

/// Sizes of pictures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Pace {
    /// All of the window, however long it takes: what scripts get is the same on every machine.
    Whole,
    /// As large as time allows.
    Measured {
        /// Pixels in a second.
        rate: f64,
        /// Seconds that a picture may take.
        budget: f64,
    },
}

impl Pace {
    /// One that has measured nothing yet.
    pub(super) fn measured() -> Self {
        Self::Measured { rate: GUESS, budget: BUDGET }
    }

    /// Takes note of how long pixels took.
    pub(super) fn learn(&mut self, pixels: u64, time: Duration) {
        if let Self::Measured { rate, .. } = self {
            let now = pixels as f64 / time.as_secs_f64().max(1e-6);
            // Too slow a picture is worse than too small a one.
            let weight = if now < *rate { 2.0 * WEIGHT } else { WEIGHT };
            *rate += weight * (now - *rate);
        }
    }

    /// Takes note of how long it took from one picture of a moving camera to the next, with all that
    /// comes between.
    pub(super) fn judge(&mut self, time: Duration) {
        if let Self::Measured { budget, .. } = self {
            let factor = if time.as_secs_f64() > LATE { FALL } else { RISE };
            *budget = (*budget * factor).clamp(SMALLEST, LARGEST);
        }
    }

    /// The size of a picture of a moving camera.
    pub(super) fn moving(self, whole: (u32, u32)) -> (u32, u32) {
        match self {
            Self::Whole => whole,
            Self::Measured { rate, budget } => shrunk(whole, rate * budget),
        }
    }
}

/// The size of the next picture of a camera at rest, after one of size `last`.
pub(super) fn refined(whole: (u32, u32), last: (u32, u32)) -> (u32, u32) {
    shrunk(whole, REFINED * pixels(last))
}

fn pixels((width, height): (u32, u32)) -> f64 {
    f64::from(width) * f64::from(height)
}

/// A size of about so many pixels, in the shape of the whole, and no larger.
fn shrunk(whole: (u32, u32), count: f64) -> (u32, u32) {
    let factor = (count.max(LEAST) / pixels(whole)).sqrt();
    // Nearly all of it is worth the rest.
    if factor > 0.8 {
        return whole;
    }
    let side = |side: u32| ((f64::from(side) * factor) as u32).max(1);
    (side(whole.0), side(whole.1))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: (u32, u32) = (1280, 720);

    #[test]
    fn sizes_follow_what_was_measured() {
        let mut pace = Pace::measured();
        for _ in 0..20 {
            pace.learn(1_000_000, Duration::from_secs(1));
        }
        let count = pixels(pace.moving(WHOLE));
        assert!((count / (1e6 * BUDGET) - 1.0).abs() < 0.02, "{count}");
        for _ in 0..20 {
            pace.learn(1_000_000_000, Duration::from_secs(1));
        }
        assert_eq!(pace.moving(WHOLE), WHOLE);
        assert_eq!(Pace::Whole.moving(WHOLE), WHOLE);
    }

    #[test]
    fn budgets_leave_room_for_what_else_happens() {
        let mut pace = Pace::measured();
        let budget = |pace: Pace| match pace {
            Pace::Measured { budget, .. } => budget,
            Pace::Whole => 0.0,
        };
        (0..1000).for_each(|_| pace.judge(Duration::from_millis(20)));
        assert_eq!(budget(pace), LARGEST);
        // Pictures take their budget, and one in twenty 15 ms more.
        let mut late = 0;
        for picture in 0..4000 {
            let more = if picture % 20 == 0 { 0.015 } else { 0.001 };
            let time = budget(pace) + more;
            late += u32::from(picture >= 1000 && time > LATE);
            pace.judge(Duration::from_secs_f64(time));
        }
        assert!((15..60).contains(&late), "{late}");
        (0..100).for_each(|_| pace.judge(Duration::from_secs(1)));
        assert_eq!(budget(pace), SMALLEST);
    }

    #[test]
    fn a_camera_at_rest_comes_to_the_whole_picture() {
        let mut pace = Pace::measured();
        pace.learn(0, Duration::from_secs(1));
        let mut size = pace.moving(WHOLE);
        let steps = (0..20).take_while(|_| {
            let before = size;
            size = refined(WHOLE, size);
            pixels(before) < pixels(size)
        });
        assert!(steps.count() < 12);
        assert_eq!(size, WHOLE);
        assert_eq!(shrunk((1, 1), 0.0), (1, 1));
    }
}
