//! Columns of paths, on a device.

use crate::device::{Device, Work, groups};
use crate::error::DeviceError;
use crate::tree::Params;
use spherule_render::shade::MaterialKind;
use spherule_render::world::DevicePixel;
use wgpu::BufferUsages as Usage;

/// Words of the head of a queue, as `queue.wgsl` describes it.
const HEAD: usize = 5;

/// Words of the sums of a pixel.
const SUMS: usize = size_of::<DevicePixel>() / size_of::<u32>();

/// Words of a kernel's numbers.
const PARAMS: usize = size_of::<Params>() / size_of::<u32>();

/// Glass spheres that a path may be in, as `interior.wgsl` has them.
const NESTING: usize = 8;

/// Kinds of materials that have queues: emissive ones count as diffuse.
const KINDS: usize = 5;

/// Bounces that a device is asked for at once.
pub(crate) const BOUNCES: usize = 8;

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
    /// Sums of pixels, and the samples of those that are not summed, with the number of these pixels.
    pub(crate) pixel_sums: wgpu::Buffer,
    pub(crate) pixel_sums_to_read: wgpu::Buffer,
    pub(crate) samples: wgpu::Buffer,
    pub(crate) samples_to_read: wgpu::Buffer,
    pub(crate) unsummed: wgpu::Buffer,
    /// Glass spheres that contain the paths.
    pub(crate) interiors: wgpu::Buffer,
    /// Queues of the paths of a bounce, and of those that go on.
    pub(crate) queues: [wgpu::Buffer; 2],
    /// Queues of the paths that have hit each kind of material, one after another.
    pub(crate) kind_queues: wgpu::Buffer,
    pub(crate) head_to_read: wgpu::Buffer,
    /// The head of a queue without rows.
    empty_head: wgpu::Buffer,
    /// Numbers of bounces, of which each gets its own.
    pub(crate) bounces: wgpu::Buffer,
    pub(crate) shadows: ShadowColumns,
    pub(crate) caustics: CausticColumns,
}

/// Columns of shadow rays.
pub(crate) struct ShadowColumns {
    pub(crate) queue: wgpu::Buffer,
    pub(crate) rays: wgpu::Buffer,
    pub(crate) found: wgpu::Buffer,
    /// The light that they carry.
    pub(crate) lights: wgpu::Buffer,
}

/// Columns of caustic samples, whose shadow rays come after the others.
pub(crate) struct CausticColumns {
    /// Specular bounces of each path since its last diffuse surface, and its first caustic sample.
    pub(crate) chains: wgpu::Buffer,
    /// Second segments of the samples, and the next sample of the path.
    pub(crate) seconds: wgpu::Buffer,
}

/// Words of a path's chain of specular bounces.
const CHAIN: usize = 16;

/// The needs of a job's paths that decide which columns they have.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Needs {
    /// Shadow rays of each path beside its own rays.
    pub(crate) shadows: usize,
    /// True if several glass spheres may contain a path.
    pub(crate) nested_glass: bool,
    /// True if surfaces sample caustics; those of a bounce have room for one for each path.
    pub(crate) caustics: bool,
}

impl Columns {
    /// Creates columns for so many pixels and paths.
    pub(crate) fn new(
        device: &Device,
        [pixels, paths]: [usize; 2],
        Needs { shadows, nested_glass, caustics }: Needs,
    ) -> Result<Self, DeviceError> {
        let buffer = |what, words: usize, usage| {
            device.buffer(what, (size_of::<u32>() * words) as u64, usage)
        };
        let column = |what, words| buffer(what, words * paths, Usage::STORAGE | Usage::COPY_SRC);
        let queue = |what, rows| {
            let usage = Usage::STORAGE | Usage::INDIRECT | Usage::COPY_SRC | Usage::COPY_DST;
            buffer(what, HEAD + rows, usage)
        };
        // Columns without rows cannot be bound.
        let shadow = |what, words, rays: usize| {
            buffer(what, words * if rays > 0 { rays * paths } else { 1 }, Usage::STORAGE)
        };
        let caustic =
            |what, words| buffer(what, words * if caustics { paths } else { 1 }, Usage::STORAGE);
        let shadows = shadows + usize::from(caustics);
        let read = Usage::MAP_READ | Usage::COPY_DST;
        let empty_head = buffer("head of a queue", HEAD, Usage::COPY_SRC | Usage::COPY_DST)?;
        device.write(&empty_head, bytemuck::bytes_of(&Self::head(0)));
        Ok(Self {
            capacity: [pixels, paths],
            params: buffer("numbers", PARAMS, Usage::STORAGE | Usage::COPY_DST)?,
            pixels: buffer("pixels", pixels, Usage::STORAGE | Usage::COPY_DST)?,
            rays: column("rays", 12)?,
            found: column("answers", 1)?,
            sequences: column("samples", 4)?,
            states: column("states", 16)?,
            paths: buffer("paths", 4 * paths, Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST)?,
            pixel_sums: buffer("sums", SUMS * pixels, Usage::STORAGE | Usage::COPY_SRC)?,
            pixel_sums_to_read: buffer("sums to read", SUMS * pixels, read)?,
            samples: buffer("samples", 4 * paths, Usage::STORAGE | Usage::COPY_SRC)?,
            samples_to_read: buffer("samples to read", 4 * paths, read)?,
            unsummed: buffer("number of pixels", 1, Usage::STORAGE | Usage::COPY_DST)?,
            queues: [queue("queue", paths)?, queue("queue", paths)?],
            kind_queues: queue("queues of materials", KINDS * (HEAD + paths) - HEAD)?,
            head_to_read: buffer("count to read", HEAD, read)?,
            interiors: buffer(
                "glass around paths",
                if nested_glass { NESTING * paths } else { 1 },
                Usage::STORAGE,
            )?,
            empty_head,
            bounces: buffer("bounces", PARAMS * BOUNCES, Usage::COPY_SRC | Usage::COPY_DST)?,
            shadows: ShadowColumns {
                queue: queue("queue of shadow rays", shadows.max(1) * paths)?,
                rays: shadow("shadow rays", 12, shadows)?,
                found: shadow("answers of shadow rays", 1, shadows)?,
                // Of ambient occlusion, too.
                lights: shadow("light", 4, shadows.max(1))?,
            },
            caustics: CausticColumns {
                chains: caustic("specular bounces", CHAIN)?,
                seconds: caustic("second segments", 12)?,
            },
        })
    }

    /// Returns whether so many pixels and paths fit.
    pub(crate) fn fit(&self, pixels: usize, paths: usize) -> bool {
        self.capacity[0] >= pixels && self.capacity[1] >= paths
    }

    /// Gives kernels the numbers of a bounce, by its place among those that were written, and a queue without shadow rays.
    pub(crate) fn set_bounce(&self, work: &mut Work, place: usize) {
        let bytes = self.params.size();
        work.copy(&self.bounces, bytes * place as u64, &self.params, bytes);
        self.clear(work, &self.shadows.queue);
    }

    /// Returns the number of words from the queue of a kind of material to that of the next.
    pub(crate) fn kind_stride(&self) -> usize {
        HEAD + self.capacity[1]
    }

    /// Returns the place of the queue of a kind of material in bytes.
    pub(crate) fn kind_offset(&self, kind: MaterialKind) -> u64 {
        (size_of::<u32>() * self.kind_stride() * kind as usize) as u64
    }

    /// Empties the queue of a kind of material.
    pub(crate) fn clear_kind(&self, work: &mut Work, kind: MaterialKind) {
        work.copy_to(&self.empty_head, &self.kind_queues, self.kind_offset(kind));
    }

    /// Empties a queue.
    pub(crate) fn clear(&self, work: &mut Work, queue: &wgpu::Buffer) {
        work.copy(&self.empty_head, 0, queue, self.empty_head.size());
    }

    /// Returns the head of a queue with so many rows.
    pub(crate) fn head(rows: usize) -> [u32; HEAD] {
        [groups(rows), 1, 1, rows as u32, 0]
    }
}
