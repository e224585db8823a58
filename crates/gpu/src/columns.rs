//! Columns of paths, on a device.

use crate::device::Device;
use crate::error::DeviceError;
use crate::tree::Params;
use wgpu::BufferUsages as Usage;

/// Columns of a batch of paths.
pub(crate) struct Columns {
    /// Pixels and paths that fit.
    capacity: [usize; 2],
    pub(crate) params: wgpu::Buffer,
    pub(crate) pixels: wgpu::Buffer,
    pub(crate) rays: wgpu::Buffer,
    pub(crate) found: wgpu::Buffer,
    pub(crate) sequences: wgpu::Buffer,
    pub(crate) states: wgpu::Buffer,
    pub(crate) paths: wgpu::Buffer,
    pub(crate) paths_to_read: wgpu::Buffer,
    /// The number of paths that go on.
    pub(crate) alive: wgpu::Buffer,
    pub(crate) alive_to_read: wgpu::Buffer,
    pub(crate) shadows: ShadowColumns,
}

/// Columns of shadow rays.
pub(crate) struct ShadowColumns {
    /// The numbers of the kernel that traces them.
    pub(crate) params: wgpu::Buffer,
    pub(crate) rays: wgpu::Buffer,
    pub(crate) found: wgpu::Buffer,
    /// The light that they carry.
    pub(crate) lights: wgpu::Buffer,
}

impl Columns {
    /// Creates columns for so many pixels and paths, with so many shadow rays of each path beside its own rays.
    pub(crate) fn new(
        device: &Device,
        [pixels, paths]: [usize; 2],
        shadows: usize,
    ) -> Result<Self, DeviceError> {
        let buffer = |what, words: usize, usage| {
            device.buffer(what, (size_of::<u32>() * words) as u64, usage)
        };
        let column = |what, words| buffer(what, words * paths, Usage::STORAGE | Usage::COPY_SRC);
        let params = |what| {
            let bytes = size_of::<Params>() as u64;
            device.buffer(what, bytes, Usage::STORAGE | Usage::COPY_DST)
        };
        // Columns without rows cannot be bound.
        let shadow = |what, words, rays: usize| {
            buffer(what, words * if rays > 0 { rays * paths } else { 1 }, Usage::STORAGE)
        };
        let read = Usage::MAP_READ | Usage::COPY_DST;
        Ok(Self {
            capacity: [pixels, paths],
            params: params("numbers")?,
            pixels: buffer("pixels", pixels, Usage::STORAGE | Usage::COPY_DST)?,
            rays: column("rays", 12)?,
            found: column("answers", 1)?,
            sequences: column("samples", 2)?,
            states: column("states", 4)?,
            paths: column("paths", 4)?,
            paths_to_read: buffer("paths to read", 4 * paths, read)?,
            alive: buffer("count", 1, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)?,
            alive_to_read: buffer("count to read", 1, read)?,
            shadows: ShadowColumns {
                params: params("numbers of shadow rays")?,
                rays: shadow("shadow rays", 12, shadows)?,
                found: shadow("answers of shadow rays", 1, shadows)?,
                // Of ambient occlusion, too.
                lights: shadow("light", 4, shadows.max(1))?,
            },
        })
    }

    /// Returns whether so many pixels and paths fit.
    pub(crate) fn fit(&self, pixels: usize, paths: usize) -> bool {
        self.capacity[0] >= pixels && self.capacity[1] >= paths
    }
}
