//! Control of the image size for a constant frame rate.

use std::time::Duration;

/// Seconds that an image may take while the camera moves: initial value, maximum and minimum. The page needs as long to show
/// it, and a motion waits for half an image before, so that it is seen after 25 ms.
const BUDGET: f64 = 0.010;
const LARGEST: f64 = 0.014;
const SMALLEST: f64 = 0.008;

/// Maximum seconds between images, and the factors by which the budget falls after a late image and else
/// rises, so that one image in eighty is late (Robbins & Monro, "A Stochastic Approximation Method", The
/// Annals of Mathematical Statistics 1951).
const LATE: f64 = 0.025;
const FALL: f64 = 0.85;
const RISE: f64 = 1.002;

/// Initial estimates of pixels per second, without shadows and with them.
const GUESS: [f64; 2] = [8e6, 8e6];

/// Growth factor of the estimate with shadows for each preview without: they are tried again.
const RETRY: f64 = 1.01;

/// Minimum number of pixels of an image.
const LEAST: f64 = 1024.0;

/// Weight of the last measurement.
const WEIGHT: f64 = 0.4;

/// A preview while the camera moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moving {
    pub(super) size: (u32, u32),
    pub(super) shadows: bool,
}

/// Sizes of previews.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FrameRate {
    /// Always the size of the page's image, so that scripts have the same results on every machine.
    Whole,
    /// As large as the time budget allows; shadows are left out before pixels are.
    Measured {
        /// Pixels per second, without shadows and with them.
        rates: [f64; 2],
        /// Time budget of an image in seconds.
        budget: f64,
    },
}

impl FrameRate {
    /// Creates the control before any measurement.
    pub(super) fn measured() -> Self {
        Self::Measured { rates: GUESS, budget: BUDGET }
    }

    /// Records the render time of a preview.
    pub(super) fn record_time(&mut self, pixels: u64, shadows: bool, time: Duration) {
        if let Self::Measured { rates, .. } = self {
            if !shadows {
                rates[1] = (rates[1] * RETRY).min(rates[0]);
            }
            let rate = &mut rates[usize::from(shadows)];
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

    /// Returns the preview for a moving camera, of at most so many pixels.
    pub(super) fn moving(self, whole: (u32, u32), most: u64) -> Moving {
        match self {
            Self::Whole => Moving { size: whole, shadows: true },
            Self::Measured { rates, budget } => {
                let most = most as f64;
                let [plain, shadowed] = rates.map(|rate| shrunk(whole, (rate * budget).min(most)));
                let shadows = shadowed == shrunk(whole, most);
                Moving { size: if shadows { shadowed } else { plain }, shadows }
            }
        }
    }
}

fn pixels((width, height): (u32, u32)) -> f64 {
    f64::from(width) * f64::from(height)
}

/// Returns a size of about this many pixels, with the aspect ratio of the whole and no larger.
fn shrunk(whole: (u32, u32), count: f64) -> (u32, u32) {
    let factor = (count.max(LEAST) / pixels(whole)).sqrt();
    // A size close to the whole is rounded up.
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
    fn shadows_are_left_out_before_pixels() {
        let mut frame_rate = FrameRate::measured();
        let mut measure = |rate: u64, shadows: bool| {
            (0..20).for_each(|_| frame_rate.record_time(rate, shadows, Duration::from_secs(1)));
            frame_rate.moving(WHOLE, u64::MAX)
        };
        assert_eq!(measure(1_000_000_000, true), Moving { size: WHOLE, shadows: true });
        measure(1_000_000_000, false);
        assert_eq!(measure(1_000_000, true), Moving { size: WHOLE, shadows: false });
        let Moving { size, shadows } = measure(2_000_000, false);
        assert!(!shadows && (pixels(size) / (2e6 * BUDGET) - 1.0).abs() < 0.02, "{size:?}");
        assert_eq!(FrameRate::Whole.moving(WHOLE, u64::MAX), Moving { size: WHOLE, shadows: true });
        assert_eq!(shrunk((1, 1), 0.0), (1, 1));
        let Moving { size, .. } = FrameRate::measured().moving(WHOLE, 60_000);
        assert!((pixels(size) / 6e4 - 1.0).abs() < 0.02, "{size:?}");
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
}
