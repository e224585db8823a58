//! Integrators: estimate radiance along camera rays by wavefront path tracing.
//!
//! A batch of paths passes one stage after the other, in loops over columns. All three integrators
//! start with [`generate`], alternate [`stages::intersect`] with shading, one kernel per kind of
//! material, and leave the radiance of each path in [`workspace::Paths`]. A stage whose queue is empty
//! does nothing.

pub mod ao;
mod caustics;
pub mod clock;
pub mod columns;
pub mod counters;
pub mod device;
mod direct_light;
pub mod elisions;
mod emission;
pub mod features;
pub mod generate;
mod glass;
mod interior;
mod job;
pub mod light_images;
pub mod material_queues;
pub mod material_table;
mod mirrored_light;
pub mod near_misses;
mod next_rays;
pub mod path;
pub mod path_state;
pub mod preview;
pub mod probe_batch;
mod roulette;
mod seen_lights;
pub mod shading_row;
pub mod shadow_queue;
pub mod stages;
pub mod surface;
pub mod whitted;
pub mod workspace;

pub use job::Job;
pub use seen_lights::SeenLights;

use crate::scene::Integrator;
use workspace::Workspace;

impl Job<'_> {
    /// Follows the generated paths to their ends.
    pub fn integrate(&self, work: &mut Workspace) {
        match self.settings.integrator {
            Integrator::Path => path::integrate(self, work),
            Integrator::Whitted { shadow_samples } => {
                whitted::integrate(self, work, shadow_samples);
            }
            Integrator::Ao { distance } => ao::integrate(self, work, distance),
        }
    }
}
