//! Looking for light: one sample of a light for each of sixteen paths.

use super::Job;
use super::workspace::Workspace;
use crate::lanes::{F32x16, MAX_LANES};
use crate::sampling::{LightDraw, PathRow};
use crate::world::{Aim, LightRow, LightSample, Receiver};
use glam::Vec3;

/// The light samples of a row of paths.
pub(super) struct Look {
    /// All of them, where there is nothing but a sun.
    sun: Option<LightRow>,
    /// The paths' numbers, for [`LightDraw::new`].
    numbers: [[f32; MAX_LANES]; 4],
}

impl Look {
    /// For the first `count` of some paths, at scattering number `bounce`.
    #[inline(always)]
    pub(super) fn new(job: &Job, paths: &PathRow, bounce: u32, count: usize) -> Self {
        let numbers = job.sampler.light_row(paths, bounce);
        let [u, v, ..] = numbers;
        let sun = job.world.lights.lone_sun();
        Self {
            sun: sun.map(|sun| Aim::Sun(sun).sample_row([u, v], count)),
            numbers: numbers.map(F32x16::to_array),
        }
    }

    /// The sample of the path in `row`, whose lane this is, and the probability with which its light
    /// was chosen. The normal is on the side that is looked at.
    #[inline(always)]
    pub(super) fn sample(
        &self,
        job: &Job,
        work: &Workspace,
        (lane, row): (usize, usize),
        normal: Vec3,
    ) -> Option<(LightSample, f32)> {
        if let Some(sun) = &self.sun {
            return Some((sun.sample(lane), 1.0));
        }
        let lights = &job.world.lights;
        let draw = LightDraw::new(self.numbers.each_ref().map(|numbers| numbers[lane]));
        let (point, own) = (work.surface.point[row], work.hits.sphere[row]);
        let (light, probability) = lights.choose(&Receiver { point, normal, own }, draw.light)?;
        Some((lights.sample(job.world, light, (point, own), draw.point)?, probability))
    }
}
