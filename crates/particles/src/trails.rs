//! Trails of trajectories: where particles were in the frames before.

use crate::{FileError, ParticleFrame, Trails, bonds::nearest_image, memory};
use glam::DVec3;
use std::collections::VecDeque;
use std::path::Path;

/// Positions in the last frames.
pub(crate) struct History {
    /// Number of frames that trails go back.
    most: usize,
    /// The last frame first.
    frames: VecDeque<[Vec<f64>; 3]>,
}

impl History {
    pub(crate) fn new(most: u32) -> Self {
        Self { most: most as usize, frames: VecDeque::new() }
    }

    /// Adds the trails to a frame, which becomes the last one. Trails end at a frame with another number of particles.
    pub(crate) fn add(&mut self, path: &Path, frame: &mut ParticleFrame) -> Result<(), FileError> {
        let count = frame.len();
        let same = self.frames.iter().take_while(|[x, ..]| x.len() == count);
        let steps = same.clone().count();
        // The trails, the copies of them that spheres and sticks are made from, and the frame itself for later ones.
        let need = (3 * steps + 1) as u64 * (count * size_of::<[f64; 3]>()) as u64;
        memory::check(need).map_err(|shortage| {
            FileError::whole_file(path, format!("its trails need {shortage}"))
        })?;
        let mut trails = Trails { steps: Vec::with_capacity(steps) };
        for [x, y, z] in same {
            let later = trails.steps.last();
            let mut step = [(); 3].map(|()| Vec::with_capacity(count));
            for row in 0..count {
                let from =
                    later.map_or(DVec3::ZERO, |[x, y, z]| DVec3::new(x[row], y[row], z[row]));
                let away = DVec3::new(x[row], y[row], z[row]) - frame.position(row) - from;
                let vector = from + nearest_image(away, frame.cell.as_ref());
                step.iter_mut()
                    .zip(vector.to_array())
                    .for_each(|(column, value)| column.push(value));
            }
            trails.steps.push(step);
        }
        self.frames.truncate(self.most - 1);
        self.frames.push_front([frame.x.clone(), frame.y.clone(), frame.z.clone()]);
        frame.trails = trails;
        Ok(())
    }
}
