//! Control of the image size for a constant frame rate.

use std::time::Duration;

/// Seconds that an image may take while the camera moves: initial value, maximum and minimum. The fraction of
/// a thirtieth of a second depends on the machine's load.
const BUDGET: f64 = 0.016;
const LARGEST: f64 = 0.026;
const SMALLEST: f64 = 0.012;

/// Maximum seconds between images, and the factors by which the budget falls after a late image and else
/// rises, so that one image in eighty is late (Robbins & Monro, "A Stochastic Approximation Method", The
/// Annals of Mathematical Statistics 1951).
const LATE: f64 = 0.031;
const FALL: f64 = 0.85;
const RISE: f64 = 1.002;

/// Initial estimate of pixels per second.
const GUESS: f64 = 2e6;

/// Minimum number of pixels of an image.
const LEAST: f64 = 1024.0;

/// Growth factor of pixels from image to image for a camera at rest.
const REFINED: f64 = 2.0;

/// Weight of the last measurement.
const WEIGHT: f64 = 0.4;

/// Image sizes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FrameRate {
    /// Always the size of the window, so that scripts have the same results on every machine.
    Whole,
    /// As large as the time budget allows.
    Measured {
        /// Pixels per second.
        rate: f64,
        /// Time budget of an image in seconds.
        budget: f64,
    },
}

impl FrameRate {
    /// Creates the control before any measurement.
    pub(super) fn measured() -> Self {
        Self::Measured { rate: GUESS, budget: BUDGET }
    }

    /// Records the render time of an image.
    pub(super) fn record_time(&mut self, pixels: u64, time: Duration) {
        if let Self::Measured { rate, .. } = self {
            let now = pixels as f64 / time.as_secs_f64().max(1e-6);
            // A late image is worse than a small one.
            let weight = if now < *rate { 2.0 * WEIGHT } else { WEIGHT };
            *rate += weight * (now - *rate);
        }
    }

    /// Records the total time between two images of a moving camera.
    pub(super) fn record_interval(&mut self, time: Duration) {
        if let Self::Measured { budget, .. } = self {
            let factor = if time.as_secs_f64() > LATE { FALL } else { RISE };
            *budget = (*budget * factor).clamp(SMALLEST, LARGEST);
        }
    }

    /// Returns the size of an image for a moving camera.
    pub(super) fn moving(self, whole: (u32, u32)) -> (u32, u32) {
        match self {
            Self::Whole => whole,
            Self::Measured { rate, budget } => shrunk(whole, rate * budget),
        }
    }
}

/// Returns the size of the next image for a camera at rest, after one of size `last`.
pub(super) fn refined(whole: (u32, u32), last: (u32, u32)) -> (u32, u32) {
    shrunk(whole, REFINED * pixels(last))
}

fn pixels((width, height): (u32, u32)) -> f64 {
    f64::from(width) * f64::from(height)
}

/// Returns a size of about this many pixels, with the aspect ratio of the window and no larger.
fn shrunk(whole: (u32, u32), count: f64) -> (u32, u32) {
    let factor = (count.max(LEAST) / pixels(whole)).sqrt();
    // A size close to the window's is rounded up.
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
    fn sizes_follow_measured_times() {
        let mut frame_rate = FrameRate::measured();
        for _ in 0..20 {
            frame_rate.record_time(1_000_000, Duration::from_secs(1));
        }
        let count = pixels(frame_rate.moving(WHOLE));
        assert!((count / (1e6 * BUDGET) - 1.0).abs() < 0.02, "{count}");
        for _ in 0..20 {
            frame_rate.record_time(1_000_000_000, Duration::from_secs(1));
        }
        assert_eq!(frame_rate.moving(WHOLE), WHOLE);
        assert_eq!(FrameRate::Whole.moving(WHOLE), WHOLE);
    }

    #[test]
    fn budgets_leave_time_for_other_work() {
        let mut frame_rate = FrameRate::measured();
        let budget = |frame_rate: FrameRate| match frame_rate {
            FrameRate::Measured { budget, .. } => budget,
            FrameRate::Whole => 0.0,
        };
        (0..1000).for_each(|_| frame_rate.record_interval(Duration::from_millis(20)));
        assert_eq!(budget(frame_rate), LARGEST);
        // Pictures take their budget, and one in twenty 15 ms more.
        let mut late = 0;
        for picture in 0..4000 {
            let more = if picture % 20 == 0 { 0.015 } else { 0.001 };
            let time = budget(frame_rate) + more;
            late += u32::from(picture >= 1000 && time > LATE);
            frame_rate.record_interval(Duration::from_secs_f64(time));
        }
        assert!((15..60).contains(&late), "{late}");
        (0..100).for_each(|_| frame_rate.record_interval(Duration::from_secs(1)));
        assert_eq!(budget(frame_rate), SMALLEST);
    }

    #[test]
    fn a_still_camera_reaches_full_resolution() {
        let mut frame_rate = FrameRate::measured();
        frame_rate.record_time(0, Duration::from_secs(1));
        let mut size = frame_rate.moving(WHOLE);
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
