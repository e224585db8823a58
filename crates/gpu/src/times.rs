//! Times of the stages of queries, for measurements.

use crate::device::Device;
use crate::error::DeviceError;
use std::time::{Duration, Instant};

/// A stage of a query.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueryStage {
    /// Arranges rays as the kernel reads them, on the processor.
    Pack,
    /// Copies rays to the device.
    Upload,
    /// Runs the kernel.
    Kernel,
    /// Copies answers from the device.
    Read,
    /// Decides unknown rays, and computes distances, on the processor.
    Decide,
}

impl QueryStage {
    /// All stages, in order.
    pub const ALL: [Self; 5] = [Self::Pack, Self::Upload, Self::Kernel, Self::Read, Self::Decide];

    /// Returns the name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pack => "pack",
            Self::Upload => "upload",
            Self::Kernel => "kernel",
            Self::Read => "read",
            Self::Decide => "decide",
        }
    }
}

/// Times of the stages of a query, each of which was waited for.
#[derive(Clone, Copy, Debug, Default)]
pub struct QueryTimes {
    stages: [Duration; QueryStage::ALL.len()],
    /// Of the kernel, by the device's clock; zero if it has none.
    clock: Duration,
}

impl QueryTimes {
    /// Returns the seconds of a stage.
    pub fn seconds(&self, stage: QueryStage) -> f64 {
        self.stages[stage as usize].as_secs_f64()
    }

    /// Returns the seconds of the kernel by the device's clock, without what it takes to start it; if the device has no
    /// clock, those of the stage.
    pub fn kernel_seconds(&self) -> f64 {
        if self.clock.is_zero() {
            self.seconds(QueryStage::Kernel)
        } else {
            self.clock.as_secs_f64()
        }
    }

    /// Returns the seconds of all stages.
    pub fn total(&self) -> f64 {
        self.stages.iter().sum::<Duration>().as_secs_f64()
    }
}

/// Measures stages; or does nothing, so that they overlap.
pub(crate) struct Stopwatch(Option<(Instant, QueryTimes)>);

impl Stopwatch {
    /// Measures nothing.
    pub(crate) fn off() -> Self {
        Self(None)
    }

    /// Measures from now on.
    pub(crate) fn start() -> Self {
        Self(Some((Instant::now(), QueryTimes::default())))
    }

    /// Ends a stage, of which the device does all that it was asked to before.
    pub(crate) fn end(&mut self, stage: QueryStage, device: &Device) -> Result<(), DeviceError> {
        let Some((from, times)) = &mut self.0 else { return Ok(()) };
        device.finish()?;
        let now = Instant::now();
        times.stages[stage as usize] += now - *from;
        *from = now;
        Ok(())
    }

    /// Runs a measurement of the kernel that counts for no stage, if anything is measured.
    pub(crate) fn clock(
        &mut self,
        measure: impl FnOnce() -> Result<Option<Duration>, DeviceError>,
    ) -> Result<(), DeviceError> {
        let Some((from, times)) = &mut self.0 else { return Ok(()) };
        times.clock += measure()?.unwrap_or_default();
        *from = Instant::now();
        Ok(())
    }

    /// Returns the times.
    pub(crate) fn times(self) -> QueryTimes {
        self.0.map(|(_, times)| times).unwrap_or_default()
    }
}
