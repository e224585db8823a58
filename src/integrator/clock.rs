//! Where a task's time goes: by stage, and by looking at the clock once per stage and batch.

use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// What a task is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Making camera rays.
    Generate,
    /// Finding what camera rays and paths hit.
    Trace,
    /// Solving for points and normals, and sorting by material.
    Surface,
    /// Evaluating and sampling materials and lights.
    Shade,
    /// Finding what shadow rays hit.
    Shadow,
    /// Adding samples to the picture.
    Film,
}

impl Stage {
    /// In the order of a path's life.
    pub const ALL: [Self; 6] =
        [Self::Generate, Self::Trace, Self::Surface, Self::Shade, Self::Shadow, Self::Film];

    /// What it is called in reports.
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

/// Time spent in each stage, by [`Stage`]; of several tasks, the sum.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Times([Duration; Stage::ALL.len()]);

impl Times {
    /// Of one stage.
    pub fn of(&self, stage: Stage) -> Duration {
        self.0[stage as usize]
    }

    /// Of all stages.
    pub fn total(&self) -> Duration {
        self.0.iter().sum()
    }

    /// Of the stage that took longest.
    pub(crate) fn longest(&self) -> Duration {
        self.0.into_iter().max().unwrap_or_default()
    }

    /// Adds what another task took.
    pub fn add(&mut self, other: &Self) {
        for (time, more) in self.0.iter_mut().zip(other.0) {
            *time += more;
        }
    }
}

/// A clock that tells how long ago it was looked at.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    last: Instant,
    times: Times,
}

impl Clock {
    /// Begins now.
    pub fn new() -> Self {
        Self { last: Instant::now(), times: Times::default() }
    }

    /// Forgets the time since it was looked at last.
    pub fn restart(&mut self) {
        self.last = Instant::now();
    }

    /// Gives the time since it was looked at last to the stage that ends.
    pub fn end(&mut self, stage: Stage) {
        let now = Instant::now();
        self.times.0[stage as usize] += now - self.last;
        self.last = now;
    }

    /// What has been measured, which it forgets.
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
    fn every_moment_belongs_to_one_stage() {
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
