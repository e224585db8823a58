//! Exact queries of a [`SphereTree`] on a device.

use crate::device::Device;
use crate::error::DeviceError;
use crate::tree::{Answered, DeviceTree, unknown};
use spherule_core::internals::ray::Hits as Scaled;
use spherule_core::{Hits, QueryError, RayColumns, SphereTree};
use std::sync::Arc;

/// A tree of spheres on a device: its answers are those of the [`SphereTree`], bit for bit.
pub struct DeviceSpheres<'a> {
    spheres: &'a SphereTree,
    tree: DeviceTree,
}

impl<'a> DeviceSpheres<'a> {
    /// Copies a tree to a device.
    ///
    /// # Errors
    /// It does not fit, or the device fails.
    pub fn new(device: &Arc<Device>, spheres: &'a SphereTree) -> Result<Self, DeviceError> {
        Ok(Self { spheres, tree: DeviceTree::new(device, spheres.parts())? })
    }

    /// Finds the first hit of each ray, as [`SphereTree::intersect_columns`]. If the device fails the processor does
    /// it, and [`Device::fault`] tells.
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn intersect_columns(&self, rays: &RayColumns, hits: Hits) -> Result<Answered, QueryError> {
        let (scaled, bounds) = self.spheres.scaled_rays(rays, hits.t)?;
        let count = hits.t.len() as u64;
        let Ok(found) = self.tree.find(&scaled, &bounds, false) else {
            let exact = self.spheres.intersect_columns(rays, hits)?.exact;
            return Ok(Answered { rays: count, unknown: count, exact, ..Answered::default() });
        };
        let unheld = count_unheld(&bounds, hits.t);
        let exact = self.spheres.intersect_found(rays, hits, &found)?.exact;
        Ok(Answered {
            rays: count,
            unknown: unknown(&found) + unheld,
            exact,
            ..Answered::default()
        })
    }

    /// Finds whether each ray hits anything nearer than its bound in `t`, as [`SphereTree::occluded_columns`];
    /// otherwise as [`DeviceSpheres::intersect_columns`].
    ///
    /// # Errors
    /// Columns of different lengths.
    pub fn occluded_columns(
        &self,
        rays: &RayColumns,
        t: &[f64],
        occluded: &mut [bool],
    ) -> Result<Answered, QueryError> {
        let (scaled, bounds) = self.spheres.scaled_rays(rays, t)?;
        let count = t.len() as u64;
        let Ok(found) = self.tree.find(&scaled, &bounds, true) else {
            let exact = self.spheres.occluded_columns(rays, t, occluded)?.exact;
            return Ok(Answered { rays: count, unknown: count, exact, ..Answered::default() });
        };
        let exact = self.spheres.occluded_found(rays, t, occluded, &found)?.exact;
        Ok(Answered {
            rays: count,
            unknown: unknown(&found) + count_unheld(&bounds, t),
            exact,
            ..Answered::default()
        })
    }
}

/// Returns the number of rays that single precision does not hold, so that only the processor can trace them.
fn count_unheld(scaled: &Scaled, bounds: &[f64]) -> u64 {
    scaled.t.iter().zip(bounds).filter(|(scaled, bound)| **scaled < 0.0 && **bound >= 0.0).count()
        as u64
}
