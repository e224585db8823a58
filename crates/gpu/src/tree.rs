//! Trees and spheres on a device, and queries of rays in the tree's units.

use crate::device::Device;
use crate::error::DeviceError;
use crate::nodes;
use crate::stages::Kernel;
use crate::times::{QueryStage, QueryTimes, Stopwatch};
use spherule_core::internals::bvh::{Any, Closest, Query, Tracer, Tree, UNKNOWN, decide_found};
use spherule_core::internals::ray::{Hits, MISS, Rays};
use spherule_core::internals::spheres::{LEAF, SphereBlock, Spheres};
use std::sync::{Arc, Mutex, PoisonError};

/// Columns that the spheres may be cut into.
const BRICKS: usize = 4;

/// Rays of one dispatch at most.
const QUEUED_RAYS: usize = 1 << 20;

/// Words of a sphere and of a ray.
const SPHERE: usize = 4;
const RAY: usize = 12;

/// The bit of a radius of what is never hit: where there is no sphere, or an equal one before it.
const NONE: u32 = 1 << 31;

/// A distance that counts as infinite.
pub(crate) const FAR: f32 = (1_u128 << 100) as f32;

/// Numbers of rays that were asked about, and of those that the processor decided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Answered {
    /// Rays.
    pub rays: u64,
    /// Rays that the device did not know the answer of.
    pub unknown: u64,
    /// Decisions that were made on integers, by the processor.
    pub exact: u64,
    /// Paths that the device followed, the rays of which are among the others.
    pub paths: u64,
    /// Paths that it did not know the radiance of, so that the processor followed them, too.
    pub unknown_paths: u64,
}

impl std::ops::AddAssign for Answered {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.unknown += other.unknown;
        self.exact += other.exact;
        self.paths += other.paths;
        self.unknown_paths += other.unknown_paths;
    }
}

/// The numbers that a kernel gets, as `params.wgsl` has them.
#[repr(C)]
#[derive(Clone, Copy, Default, bytemuck::Pod, bytemuck::Zeroable)]
pub(crate) struct Params {
    pub(crate) zero: u32,
    pub(crate) count: u32,
    pub(crate) brick_bits: u32,
    pub(crate) nodes: u32,
    pub(crate) first_sample: u32,
    pub(crate) samples: u32,
    pub(crate) bounce: u32,
    pub(crate) shadows: u32,
    pub(crate) first_shadow: u32,
    pub(crate) caustics: u32,
    pub(crate) kind_stride: u32,
}

/// Buffers of one dispatch.
struct Lane {
    /// Rays that fit.
    capacity: usize,
    params: wgpu::Buffer,
    rays: wgpu::Buffer,
    found: wgpu::Buffer,
    copy: wgpu::Buffer,
}

/// A tree and its spheres on a device. Queries may come from many threads.
pub struct DeviceTree {
    device: Arc<Device>,
    /// Numbers of nodes and of spheres.
    size: [usize; 2],
    /// True if single precision holds the spheres; the processor answers all otherwise.
    single: bool,
    columns: Vec<wgpu::Buffer>,
    brick_bits: u32,
    /// True if there is more than one column of spheres.
    is_cut: bool,
    batch: usize,
    /// Buffers that no query uses now.
    lanes: Mutex<Vec<Lane>>,
    /// Sums over all queries.
    tally: Mutex<Answered>,
}

impl DeviceTree {
    /// Copies a tree to a device.
    ///
    /// # Errors
    /// It does not fit, or the device fails.
    pub fn new(device: &Arc<Device>, tree: Tree) -> Result<Self, DeviceError> {
        Self::cut(device, tree, device.summary().max_binding)
    }

    /// Copies a tree in columns of at most so many bytes, for tests.
    #[doc(hidden)]
    pub fn cut(device: &Arc<Device>, tree: Tree, most: u64) -> Result<Self, DeviceError> {
        device.check()?;
        let bytes = size_of::<[u32; SPHERE]>();
        let rows = tree.spheres.blocks().len() * LEAF;
        let brick_bits = (most / bytes as u64).max(LEAF as u64).ilog2().min(30);
        if rows > BRICKS << brick_bits {
            let what = format!("{} spheres", tree.spheres.len());
            return Err(DeviceError::Memory { what });
        }
        let mut columns =
            vec![device.filled("nodes", bytemuck::cast_slice(&nodes::rows(tree.bvh)))?];
        let spheres = sphere_rows(tree.spheres);
        let mut bricks = spheres.chunks(1 << brick_bits);
        for _ in 0..BRICKS {
            let brick = bricks.next().unwrap_or_default();
            columns.push(device.filled("spheres", bytemuck::cast_slice(brick))?);
        }
        Ok(Self {
            device: Arc::clone(device),
            size: size(tree),
            single: tree.spheres.precise.is_empty(),
            columns,
            brick_bits,
            is_cut: rows > 1 << brick_bits,
            batch: QUEUED_RAYS.min(most as usize / size_of::<[u32; RAY]>()),
            lanes: Mutex::default(),
            tally: Mutex::default(),
        })
    }

    /// The device.
    pub fn device(&self) -> &Device {
        &self.device
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.columns.iter().map(wgpu::Buffer::size).sum()
    }

    /// Finds the first hit of each ray in the tree, which is the one that was copied, as [`Tracer::closest`]. If the
    /// device fails the processor does it, and [`Device::fault`] tells.
    pub fn closest(&self, tree: Tree, rays: &Rays, hits: &mut Hits) -> Answered {
        self.query::<Closest>(tree, rays, hits, Tracer::closest)
    }

    /// Finds whether each ray hits anything, as [`Tracer::occluded`]; otherwise as [`DeviceTree::closest`].
    pub fn occluded(&self, tree: Tree, rays: &Rays, hits: &mut Hits) -> Answered {
        self.query::<Any>(tree, rays, hits, Tracer::occluded)
    }

    /// Returns sums over all queries so far.
    pub fn tally(&self) -> Answered {
        *self.tally.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Measures the stages of a query, by waiting for each. The hits are those of [`DeviceTree::closest`], or of
    /// [`DeviceTree::occluded`] if any hit will do.
    ///
    /// # Errors
    /// The device fails.
    #[doc(hidden)]
    pub fn timed(
        &self,
        tree: Tree,
        rays: &Rays,
        hits: &mut Hits,
        any: bool,
    ) -> Result<(Answered, QueryTimes), DeviceError> {
        let mut watch = Stopwatch::start();
        let kernel = self.hits(any, false);
        let found = self.run(kernel, rays, hits, &mut watch)?;
        let exact = if any {
            decide_found::<Any>(tree, rays, hits, |row| found[row])
        } else {
            decide_found::<Closest>(tree, rays, hits, |row| found[row])
        };
        watch.end(QueryStage::Decide, &self.device)?;
        let answered = Answered {
            rays: rays.len() as u64,
            unknown: unknown(&found),
            exact,
            ..Answered::default()
        };
        Ok((self.counted(answered), watch.times()))
    }

    /// Returns the numbers of kernels for so many rays or paths.
    pub(crate) fn params(&self, count: usize) -> Params {
        Params {
            count: count as u32,
            brick_bits: self.brick_bits,
            nodes: self.size[0] as u32,
            ..Params::default()
        }
    }

    /// Returns the kernel that searches this tree: for any hit if `any`, and for the visits of it if `counts`.
    pub(crate) fn hits(&self, any: bool, counts: bool) -> Kernel {
        Kernel::Hits { any, counts, cut: self.is_cut, queued: false }
    }

    /// Returns the kernel that searches this tree for rays in a queue.
    pub(crate) fn queued_hits(&self, any: bool) -> Kernel {
        Kernel::Hits { any, counts: false, cut: self.is_cut, queued: true }
    }

    /// Returns the kernel that searches again for those of the rays whose answer is not known, in double precision; `None` after
    /// measurements, and if the device's double precision is not the processor's.
    pub(crate) fn hits_again(&self, kernel: Kernel) -> Option<Kernel> {
        let Kernel::Hits { any, counts: false, cut, queued } = kernel else { return None };
        let doubles = self.device.lacks_for_paths().is_none();
        doubles.then_some(Kernel::HitsAgain { any, cut, queued })
    }

    /// Returns whether single precision holds the spheres.
    pub(crate) fn is_single(&self) -> bool {
        self.single
    }

    /// Returns the nodes.
    pub(crate) fn nodes(&self) -> &wgpu::Buffer {
        &self.columns[0]
    }

    /// Returns the columns of spheres.
    pub(crate) fn spheres(&self) -> Vec<&wgpu::Buffer> {
        self.columns[1..].iter().collect()
    }

    /// Adds what became of paths to the sums.
    pub(crate) fn count_paths(&self, answered: Answered) {
        self.counted(answered);
    }

    fn query<Q: Query>(
        &self,
        tree: Tree,
        rays: &Rays,
        hits: &mut Hits,
        otherwise: fn(Tracer, Tree, &Rays, &mut Hits) -> u64,
    ) -> Answered {
        let count = rays.len() as u64;
        let found = (size(tree) == self.size).then(|| self.find(rays, hits, Q::ANY));
        let Some(Ok(found)) = found else {
            let exact = otherwise(Tracer::default(), tree, rays, hits);
            return self.counted(Answered {
                rays: count,
                unknown: count,
                exact,
                ..Answered::default()
            });
        };
        let exact = decide_found::<Q>(tree, rays, hits, |row| found[row]);
        self.counted(Answered {
            rays: count,
            unknown: unknown(&found),
            exact,
            ..Answered::default()
        })
    }

    /// Adds what a query was answered to the sums.
    fn counted(&self, answered: Answered) -> Answered {
        *self.tally.lock().unwrap_or_else(PoisonError::into_inner) += answered;
        answered
    }

    /// Returns what the device knows of each ray: the row of the sphere that it hits first, or of any, [`MISS`] or
    /// [`UNKNOWN`].
    ///
    /// # Errors
    /// The device fails.
    pub fn find(&self, rays: &Rays, hits: &Hits, any: bool) -> Result<Vec<u32>, DeviceError> {
        self.run(self.hits(any, false), rays, hits, &mut Stopwatch::off())
    }

    /// Returns how many nodes and leaves the search for the hit of each ray visits on the device; 65 535 at most. For
    /// measurements.
    ///
    /// # Errors
    /// The device fails.
    #[doc(hidden)]
    pub fn visits(
        &self,
        rays: &Rays,
        hits: &Hits,
        any: bool,
    ) -> Result<Vec<[u16; 2]>, DeviceError> {
        let kernel = self.hits(any, true);
        let visits = self.run(kernel, rays, hits, &mut Stopwatch::off())?;
        Ok(visits.into_iter().map(|both| [both as u16, (both >> 16) as u16]).collect())
    }

    fn run(
        &self,
        kernel: Kernel,
        rays: &Rays,
        hits: &Hits,
        watch: &mut Stopwatch,
    ) -> Result<Vec<u32>, DeviceError> {
        self.device.check()?;
        let mut found = vec![UNKNOWN; rays.len()];
        if rays.is_empty() || !self.single || !rays.precise.is_empty() {
            return Ok(found);
        }
        let lane = self.take_lane(rays.len().min(self.batch))?;
        let mut rows = Vec::with_capacity(RAY * rays.len().min(self.batch));
        for first in (0..rays.len()).step_by(self.batch) {
            let batch = first..rays.len().min(first + self.batch);
            rows.clear();
            rows.extend(batch.clone().flat_map(|row| ray_row(rays, hits, row, kernel.is_any())));
            watch.end(QueryStage::Pack, &self.device)?;
            self.ask(kernel, &lane, &rows, &mut found[batch], watch)?;
        }
        // Not after a fault: what is left of such buffers is unknown.
        self.lanes.lock().unwrap_or_else(PoisonError::into_inner).push(lane);
        Ok(found)
    }

    /// Returns buffers for so many rays, of a former query or new ones.
    fn take_lane(&self, rays: usize) -> Result<Lane, DeviceError> {
        let fits = |lane: &Lane| lane.capacity >= rays;
        let mut idle = self.lanes.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(place) = idle.iter().position(fits) {
            return Ok(idle.swap_remove(place));
        }
        // Those that are too small would never be used again.
        idle.clear();
        drop(idle);
        self.lane(rays.next_power_of_two().min(self.batch))
    }

    /// Returns new buffers for so many rays.
    fn lane(&self, rays: usize) -> Result<Lane, DeviceError> {
        use wgpu::BufferUsages as Usage;
        let words = |words: usize| (size_of::<u32>() * words) as u64;
        let buffer = |what, bytes, usage| self.device.buffer(what, bytes, usage);
        let params =
            buffer("numbers", size_of::<Params>() as u64, Usage::STORAGE | Usage::COPY_DST)?;
        let column = buffer("rays", words(RAY * rays), Usage::STORAGE | Usage::COPY_DST)?;
        let found = buffer("answers", words(rays), Usage::STORAGE | Usage::COPY_SRC)?;
        let copy = buffer("answers to read", words(rays), Usage::MAP_READ | Usage::COPY_DST)?;
        self.device.check()?;
        Ok(Lane { capacity: rays, params, rays: column, found, copy })
    }

    /// Asks the device about some rays.
    fn ask(
        &self,
        kernel: Kernel,
        lane: &Lane,
        rows: &[u32],
        found: &mut [u32],
        watch: &mut Stopwatch,
    ) -> Result<(), DeviceError> {
        let params = self.params(found.len());
        self.device.write(&lane.params, bytemuck::bytes_of(&params));
        self.device.write(&lane.rays, bytemuck::cast_slice(rows));
        watch.end(QueryStage::Upload, &self.device)?;
        let bytes = size_of_val(found) as u64;
        let again = self.hits_again(kernel);
        let kernel = self.device.compiled(kernel)?;
        let mut buffers = vec![&lane.params];
        buffers.extend(&self.columns);
        buffers.extend([&lane.rays, &lane.found]);
        let bound = self.device.bind(kernel, &buffers);
        let run = |bound| self.device.dispatch(bound, found.len(), &lane.found, &lane.copy, bytes);
        let mut submitted = run(&bound);
        if let Some(again) = again {
            let again = self.device.compiled(again)?;
            submitted = run(&self.device.bind(again, &buffers));
        }
        watch.end(QueryStage::Kernel, &self.device)?;
        // Of the first search: after it, few rays are left.
        watch.clock(|| self.device.clock(&bound, found.len()))?;
        self.device.read(&lane.copy, bytes, submitted, |view| {
            bytemuck::cast_slice_mut(found).copy_from_slice(view);
        })?;
        watch.end(QueryStage::Read, &self.device)
    }
}

impl std::fmt::Debug for DeviceTree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [nodes, spheres] = self.size;
        f.debug_struct("DeviceTree")
            .field("device", &self.device)
            .field("nodes", &nodes)
            .field("spheres", &spheres)
            .finish_non_exhaustive()
    }
}

/// Returns the numbers of nodes and of spheres of a tree.
fn size(tree: Tree) -> [usize; 2] {
    [tree.bvh.len(), tree.spheres.len()]
}

/// Returns the number of answers that are not known.
pub(crate) fn unknown(found: &[u32]) -> u64 {
    found.iter().filter(|&&sphere| sphere == UNKNOWN).count() as u64
}

/// Returns the spheres of blocks one by one. Of those that coincide, only the first in the user's order is ever hit: the
/// others are as if they were not there.
fn sphere_rows(spheres: &Spheres) -> Vec<[u32; SPHERE]> {
    let sphere = |block: &SphereBlock, lane: usize| {
        // Not -0: equal spheres are equal bits.
        let number = |x: f32| (x + 0.0).to_bits();
        let radius = block.radius[lane];
        let radius = if radius.is_nan() { NONE } else { radius.to_bits() };
        [number(block.x[lane]), number(block.y[lane]), number(block.z[lane]), radius]
    };
    let blocks = spheres.blocks().iter();
    let mut rows: Vec<_> =
        blocks.flat_map(|block| (0..LEAF).map(move |lane| sphere(block, lane))).collect();
    for row in spheres.later_of_equals() {
        rows[row as usize][SPHERE - 1] |= NONE;
    }
    rows
}

/// Returns a ray as the kernel reads it.
fn ray_row(rays: &Rays, hits: &Hits, row: usize, any: bool) -> [u32; RAY] {
    let [x, y, z] = rays.origin.row(row).to_array().map(f32::to_bits);
    let [u, v, w] = rays.direction.row(row).to_array().map(f32::to_bits);
    let done = any && hits.sphere[row] != MISS;
    let [low, high] = if done { [-1.0; 2] } else { bounds(hits.t[row]) }.map(f32::to_bits);
    [x, y, z, u, v, w, rays.own[row], rays.target[row], low, high, 0, 0]
}

/// Returns finite numbers around a distance at which a search ends; below 0 if there is nothing to search.
fn bounds(t: f64) -> [f32; 2] {
    let rounded = t as f32;
    let low = if f64::from(rounded) > t { rounded.next_down() } else { rounded };
    let high = if f64::from(rounded) < t { rounded.next_up() } else { rounded };
    // Numbers that a device may flush to 0 are none for the lower bound, and normal ones for the upper.
    let low = if low < FAR.recip() { -1.0 } else { low.min(FAR) };
    let high = if t < 0.0 { -1.0 } else { high.clamp(FAR.recip(), FAR) };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_around_distances_and_finite() {
        for t in [0.0, 1e-300, 1e-40, 1e-20, 0.1, 1.0 / 3.0, 2.0, 1e20, 1e29] {
            let [low, high] = bounds(t).map(f64::from);
            assert!(low <= t && t <= high, "{t}: {low} {high}");
            assert!(high > 0.0 && (low < 0.0 || low.is_normal()));
        }
        assert_eq!(bounds(f64::INFINITY), [FAR; 2]);
        assert_eq!(bounds(-1.0), [-1.0; 2]);
        assert_eq!(bounds(1.5), [1.5; 2]);
    }
}
