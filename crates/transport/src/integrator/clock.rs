//! Times of the stages of a task, from one reading of the clock per stage and batch.

use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// A stage of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Generate camera rays.
    Generate,
    /// Trace camera rays and next rays.
    Trace,
    /// Compute points and normals, and fill the material queues.
    Surface,
    /// Evaluate and sample materials and lights.
    Shade,
    /// Trace shadow rays.
    Shadow,
    /// Add samples to the film.
    Film,
}

impl Stage {
    /// All stages, in the order of a path's life.
    pub const ALL: [Self; 6] =
        [Self::Generate, Self::Trace, Self::Surface, Self::Shade, Self::Shadow, Self::Film];

    /// Returns the name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Generate => "generate",
            Self::Trace => "trace",
            Self::Surface => "surface",
            Self::Shade => "shade",
            Self::Shadow => "shadow",
            Self::Film => "film",
        }
    }
}

/// Time spent in each stage; the sum over tasks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Times([Duration; Stage::ALL.len()]);

impl Times {
    /// Returns the time of one stage.
    pub fn of(&self, stage: Stage) -> Duration {
        self.0[stage as usize]
    }

    /// Returns the time of all stages.
    pub fn total(&self) -> Duration {
        self.0.iter().sum()
    }

    /// Returns the time of the longest stage.
    pub fn longest(&self) -> Duration {
        self.0.into_iter().max().unwrap_or_default()
    }

    /// Adds the times of another task.
    pub fn add(&mut self, other: &Self) {
        for (time, more) in self.0.iter_mut().zip(other.0) {
            *time += more;
        }
    }
}

/// A stopwatch for stages.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    last: Instant,
    times: Times,
}

impl Clock {
    /// Starts now.
    pub fn new() -> Self {
        Self { last: Instant::now(), times: Times::default() }
    }

    /// Discards the time since the last reading.
    pub fn restart(&mut self) {
        self.last = Instant::now();
    }

    /// Adds the time since the last reading to the stage that ends.
    pub fn end(&mut self, stage: Stage) {
        let now = Instant::now();
        self.times.0[stage as usize] += now - self.last;
        self.last = now;
    }

    /// Returns the times measured so far, and resets them.
    pub fn take(&mut self) -> Times {
        std::mem::take(&mut self.times)
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stage_times_sum_to_the_total() {
        let mut clock = Clock::new();
        let begin = clock.last;
        std::thread::sleep(Duration::from_millis(2));
        clock.end(Stage::Trace);
        clock.end(Stage::Shade);
        let span = clock.last - begin;
        let times = clock.take();
        assert_eq!(times.total(), span);
        assert!(times.of(Stage::Trace) >= Duration::from_millis(2));
        assert_eq!(times.of(Stage::Film), Duration::ZERO);
        assert_eq!(clock.take(), Times::default());
    }
}
