//! Adapters and devices.

use crate::error::DeviceError;
use crate::probe::{self, Probe};
use crate::stages::Kernel;
use std::sync::{Arc, Mutex, OnceLock, PoisonError, mpsc};
use std::time::Duration;

/// The longest that one dispatch may take; longer is a device that hangs.
const PATIENCE: Duration = Duration::from_secs(120);

/// Storage buffers that the kernels of queries bind at once, and those of paths.
const STORAGE_BUFFERS: u32 = 8;
const PATH_BUFFERS: u32 = 23;

/// What kernels of paths need beside: double precision, and its bits as integers.
const FOR_PATHS: wgpu::Features = wgpu::Features::SHADER_F64.union(wgpu::Features::SHADER_INT64);

/// A point in the sequence of what a device was asked for.
pub(crate) type Submitted = wgpu::SubmissionIndex;

/// A clock.
const FOR_MEASUREMENTS: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY;

/// An adapter: a GPU as a driver offers it, or a processor that a driver makes one of.
#[derive(Clone, Debug)]
pub struct AdapterSummary {
    /// The name.
    pub name: String,
    /// The interface by which it is reached.
    pub backend: String,
    /// Kind of device: discrete, integrated, virtual, or software.
    pub kind: &'static str,
    /// The driver and its version.
    pub driver: String,
    /// The most bytes of one buffer.
    pub max_buffer: u64,
    /// The most bytes of a buffer that a kernel reads.
    pub max_binding: u64,
    /// The most buffers that a kernel reads.
    pub max_storage_buffers: u32,
    /// The sizes of groups of lanes.
    pub subgroups: [u32; 2],
}

impl AdapterSummary {
    fn of(adapter: &wgpu::Adapter) -> Self {
        let (info, limits) = (adapter.get_info(), adapter.limits());
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete GPU",
            wgpu::DeviceType::IntegratedGpu => "integrated GPU",
            wgpu::DeviceType::VirtualGpu => "virtual GPU",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "other",
        };
        let driver = format!("{} {}", info.driver, info.driver_info).trim().to_owned();
        Self {
            name: info.name,
            backend: info.backend.to_string(),
            kind,
            driver,
            max_buffer: limits.max_buffer_size,
            max_binding: limits.max_storage_buffer_binding_size,
            max_storage_buffers: limits.max_storage_buffers_per_shader_stage,
            subgroups: [info.subgroup_min_size, info.subgroup_max_size],
        }
    }

    /// Returns true for a processor that a driver makes a GPU of.
    pub fn is_software(&self) -> bool {
        self.kind == "software"
    }
}

/// The adapters of this machine.
pub struct Adapters(Vec<wgpu::Adapter>);

impl Adapters {
    /// Finds all adapters; those that are not software first.
    pub fn find() -> Self {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = wgpu::Backends::PRIMARY;
        // Kernels of this crate write the sizes of others, and no larger ones than were dispatched before.
        descriptor.flags.remove(wgpu::InstanceFlags::VALIDATION_INDIRECT_CALL);
        let instance = wgpu::Instance::new(descriptor);
        let mut adapters = pollster::block_on(instance.enumerate_adapters(wgpu::Backends::PRIMARY));
        let rank = |adapter: &wgpu::Adapter| match adapter.get_info().device_type {
            wgpu::DeviceType::DiscreteGpu => 0,
            wgpu::DeviceType::IntegratedGpu => 1,
            wgpu::DeviceType::VirtualGpu => 2,
            wgpu::DeviceType::Other => 3,
            wgpu::DeviceType::Cpu => 4,
        };
        adapters.sort_by_key(rank);
        Self(adapters)
    }

    /// Returns what is known of each.
    pub fn summaries(&self) -> Vec<AdapterSummary> {
        self.0.iter().map(AdapterSummary::of).collect()
    }

    /// Opens the device of an adapter, by its place in the list, and tests its arithmetic.
    ///
    /// # Errors
    /// There is no such adapter, the driver refuses, or the arithmetic is not good enough.
    pub fn open(&self, place: usize) -> Result<Device, DeviceError> {
        Device::open(self.0.get(place).ok_or(DeviceError::NoAdapter)?)
    }
}

/// The first thing that went wrong, as the driver told it, from any thread.
#[derive(Clone, Default)]
struct Faults(Arc<Mutex<Option<DeviceError>>>);

impl Faults {
    fn add(&self, error: DeviceError) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }

    fn get(&self) -> Option<DeviceError> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }
}

/// A device that answers queries.
pub struct Device {
    summary: AdapterSummary,
    probe: Probe,
    handle: wgpu::Device,
    queue: wgpu::Queue,
    faults: Faults,
    /// The kernels, once they are compiled.
    kernels: [OnceLock<Result<wgpu::ComputePipeline, DeviceError>>; Kernel::COUNT],
}

impl Device {
    /// Opens the best device of this machine; software counts only if `software` allows it.
    ///
    /// # Errors
    /// There is none, or it cannot be used.
    pub fn best(software: bool) -> Result<Self, DeviceError> {
        let adapters = Adapters::find();
        let usable = |summary: &AdapterSummary| software || !summary.is_software();
        let place = adapters.summaries().iter().position(usable).ok_or(DeviceError::NoAdapter)?;
        adapters.open(place)
    }

    fn open(adapter: &wgpu::Adapter) -> Result<Self, DeviceError> {
        let summary = AdapterSummary::of(adapter);
        let refused =
            |reason: String| DeviceError::Refused { adapter: summary.name.clone(), reason };
        if summary.max_storage_buffers < STORAGE_BUFFERS {
            let most = summary.max_storage_buffers;
            let reason =
                format!("its kernels read {most} buffers, but {STORAGE_BUFFERS} are needed");
            return Err(refused(reason));
        }
        let descriptor = wgpu::DeviceDescriptor {
            required_limits: adapter.limits(),
            required_features: adapter.features() & (FOR_PATHS | FOR_MEASUREMENTS),
            ..wgpu::DeviceDescriptor::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| refused(error.to_string()))?;
        let faults = Faults::default();
        let lost = faults.clone();
        device.set_device_lost_callback(move |reason, message| {
            lost.add(DeviceError::Lost(first_line(&message, &format!("{reason:?}"))));
        });
        let failed = faults.clone();
        device.on_uncaptured_error(Arc::new(move |error| failed.add(of_driver(&error))));
        let (probe, kernels) = (Probe::default(), [const { OnceLock::new() }; Kernel::COUNT]);
        let mut opened = Self { summary, probe, handle: device, queue, faults, kernels };
        opened.probe = probe::run(&opened)?;
        match opened.probe.broken() {
            None => Ok(opened),
            Some(what) => Err(DeviceError::Inexact { adapter: opened.summary.name, what }),
        }
    }

    /// Name, kind and limits of the adapter.
    pub fn summary(&self) -> &AdapterSummary {
        &self.summary
    }

    /// Results of the test of its arithmetic.
    pub fn probe(&self) -> &Probe {
        &self.probe
    }

    /// The first thing that went wrong, after which nothing is answered any more.
    pub fn fault(&self) -> Option<DeviceError> {
        self.faults.get()
    }

    /// Takes the device away, as a driver does that crashes. For tests.
    #[doc(hidden)]
    pub fn destroy(&self) {
        self.handle.destroy();
        self.faults.add(DeviceError::Lost("it was destroyed".to_owned()));
    }

    /// Notes what has gone wrong, unless something has before.
    pub(crate) fn fail(&self, error: DeviceError) {
        self.faults.add(error);
    }

    /// Returns nothing if nothing has gone wrong so far.
    pub(crate) fn check(&self) -> Result<(), DeviceError> {
        self.fault().map_or(Ok(()), Err)
    }

    /// Returns a buffer for kernels.
    pub(crate) fn buffer(
        &self,
        what: &str,
        bytes: u64,
        usage: wgpu::BufferUsages,
    ) -> Result<wgpu::Buffer, DeviceError> {
        let binding = usage.contains(wgpu::BufferUsages::STORAGE);
        let most =
            self.summary.max_buffer.min(if binding { self.summary.max_binding } else { u64::MAX });
        let memory = || DeviceError::Memory { what: format!("{what}, {bytes} bytes") };
        if bytes > most {
            return Err(memory());
        }
        let scope = self.handle.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let buffer = self.handle.create_buffer(&wgpu::BufferDescriptor {
            label: Some(what),
            size: bytes,
            usage,
            mapped_at_creation: false,
        });
        if pollster::block_on(scope.pop()).is_some() {
            return Err(memory());
        }
        self.check()?;
        Ok(buffer)
    }

    /// Returns a buffer that holds these bytes; at least one row of them.
    pub(crate) fn filled(&self, what: &str, bytes: &[u8]) -> Result<wgpu::Buffer, DeviceError> {
        /// Bytes that are written at once, so that what the driver keeps until then stays small.
        const PIECE: usize = 1 << 24;
        let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST;
        let buffer = self.buffer(what, bytes.len().max(16) as u64, usage)?;
        for (piece, offset) in bytes.chunks(PIECE).zip((0_u64..).step_by(PIECE)) {
            self.queue.write_buffer(&buffer, offset, piece);
            if bytes.len() > PIECE {
                self.finish()?;
            }
        }
        self.check()?;
        Ok(buffer)
    }

    /// Writes bytes to the start of a buffer.
    pub(crate) fn write(&self, buffer: &wgpu::Buffer, bytes: &[u8]) {
        self.queue.write_buffer(buffer, 0, bytes);
    }

    /// Compiles a kernel; `constants` are its overrides.
    pub(crate) fn kernel(
        &self,
        name: &str,
        source: &str,
        constants: &[(&str, f64)],
    ) -> Result<wgpu::ComputePipeline, DeviceError> {
        let module = self.handle.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(name),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let pipeline = self.handle.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(name),
            layout: None,
            module: &module,
            entry_point: Some("main"),
            compilation_options: wgpu::PipelineCompilationOptions {
                constants,
                ..wgpu::PipelineCompilationOptions::default()
            },
            cache: None,
        });
        self.check()?;
        Ok(pipeline)
    }

    /// Returns a kernel, which is compiled when it is first used.
    pub(crate) fn compiled(&self, kernel: Kernel) -> Result<&wgpu::ComputePipeline, DeviceError> {
        let place = &self.kernels[kernel.place()];
        place.get_or_init(|| kernel.compile(self)).as_ref().map_err(Clone::clone)
    }

    /// Returns whether kernels may use double precision, and its bits.
    pub(crate) fn has_doubles(&self) -> bool {
        self.handle.features().contains(FOR_PATHS)
    }

    /// Returns why the device cannot follow whole paths, if so: what its arithmetic lacks.
    pub fn lacks_for_paths(&self) -> Option<String> {
        if self.summary.max_storage_buffers < PATH_BUFFERS {
            let most = self.summary.max_storage_buffers;
            return Some(format!("its kernels read {most} buffers, but {PATH_BUFFERS} are needed"));
        }
        self.probe.lacks_for_paths().map(str::to_owned)
    }

    /// Binds buffers to a kernel, in their order.
    pub(crate) fn bind<'a>(
        &self,
        kernel: &'a wgpu::ComputePipeline,
        buffers: &[&wgpu::Buffer],
    ) -> BoundKernel<'a> {
        let entries: Vec<_> = (0..)
            .zip(buffers)
            .map(|(binding, buffer)| wgpu::BindGroupEntry {
                binding,
                resource: buffer.as_entire_binding(),
            })
            .collect();
        let group = self.handle.create_bind_group(&wgpu::BindGroupDescriptor {
            label: None,
            layout: &kernel.get_bind_group_layout(0),
            entries: &entries,
        });
        BoundKernel { kernel, group }
    }

    /// Returns a list of work, to which kernels and copies are added.
    pub(crate) fn work(&self) -> Work<'_> {
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        Work { device: self, encoder: self.handle.create_command_encoder(&descriptor) }
    }

    fn submit(&self, record: impl FnOnce(&mut wgpu::CommandEncoder)) -> Submitted {
        let mut encoder =
            self.handle.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        record(&mut encoder);
        self.queue.submit([encoder.finish()])
    }

    /// Runs a kernel in groups of 64 invocations, and copies the first bytes of a buffer to another.
    pub(crate) fn dispatch(
        &self,
        kernel: &BoundKernel,
        invocations: usize,
        from: &wgpu::Buffer,
        to: &wgpu::Buffer,
        bytes: u64,
    ) -> Submitted {
        self.submit(|encoder| {
            pass(encoder, kernel, Size::Rows(invocations), None);
            encoder.copy_buffer_to_buffer(from, 0, to, 0, bytes);
        })
    }

    /// Returns how long a kernel takes by the device's own clock: the median of runs in a row, so that the device is awake.
    /// `None` if it has no clock, and then does not run it.
    pub(crate) fn clock(
        &self,
        kernel: &BoundKernel,
        invocations: usize,
    ) -> Result<Option<Duration>, DeviceError> {
        const RUNS: usize = 15;
        const BYTES: u64 = size_of::<[[u64; 2]; RUNS]>() as u64;
        if !self.handle.features().contains(FOR_MEASUREMENTS) {
            return Ok(None);
        }
        let set = self.handle.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("starts and ends"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * RUNS as u32,
        });
        let usage = wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC;
        let ticks = self.buffer("ticks", BYTES, usage)?;
        let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
        let copy = self.buffer("ticks to read", BYTES, usage)?;
        let submitted = self.submit(|encoder| {
            for run in 0..RUNS as u32 {
                let ticks = Some((&set, 2 * run));
                pass(encoder, kernel, Size::Rows(invocations), ticks);
            }
            encoder.resolve_query_set(&set, 0..2 * RUNS as u32, &ticks, 0);
            encoder.copy_buffer_to_buffer(&ticks, 0, &copy, 0, BYTES);
        });
        let mut read = [[0_u64; 2]; RUNS];
        self.read(&copy, BYTES, submitted, |view| read = bytemuck::pod_read_unaligned(view))?;
        let mut ticks = read.map(|[start, end]| end.saturating_sub(start));
        ticks.sort_unstable();
        let nanoseconds = ticks[RUNS / 2] as f64 * f64::from(self.queue.get_timestamp_period());
        Ok(Some(Duration::from_secs_f64(1e-9 * nanoseconds)))
    }

    /// Reads the first bytes of a buffer, by way of one that can be read.
    pub(crate) fn read_rows(
        &self,
        buffer: &wgpu::Buffer,
        copy: &wgpu::Buffer,
        rows: &mut [u8],
    ) -> Result<(), DeviceError> {
        let bytes = rows.len() as u64;
        let mut work = self.work();
        work.copy(buffer, 0, copy, bytes);
        self.read(copy, bytes, work.submit(), |view| rows.copy_from_slice(view))
    }

    /// Waits for all that the device was asked to do, writes to buffers included.
    pub(crate) fn finish(&self) -> Result<(), DeviceError> {
        self.wait(self.queue.submit([]))
    }

    /// Waits for what was submitted until then.
    fn wait(&self, submitted: Submitted) -> Result<(), DeviceError> {
        let submission_index = Some(submitted);
        let wait = wgpu::PollType::Wait { submission_index, timeout: Some(PATIENCE) };
        if let Err(error) = self.handle.poll(wait) {
            self.faults.add(DeviceError::Lost(error.to_string()));
        }
        self.check()
    }

    /// Hands over the first bytes of a buffer that can be mapped, once what was submitted until then is done.
    pub(crate) fn read(
        &self,
        buffer: &wgpu::Buffer,
        bytes: u64,
        submitted: Submitted,
        mut take: impl FnMut(&[u8]),
    ) -> Result<(), DeviceError> {
        let (told, mapped) = mpsc::channel();
        buffer.map_async(wgpu::MapMode::Read, 0..bytes, move |mapped| {
            // Nobody listens after a fault.
            let _ = told.send(mapped);
        });
        self.wait(submitted)?;
        // Another thread that waits may be the one that tells.
        let lost = match mapped.recv_timeout(PATIENCE) {
            Ok(Ok(())) => match buffer.get_mapped_range(0..bytes) {
                Ok(view) => {
                    take(&view);
                    None
                }
                Err(error) => Some(error.to_string()),
            },
            Ok(Err(error)) => Some(error.to_string()),
            Err(error) => Some(error.to_string()),
        };
        if let Some(error) = lost {
            self.faults.add(DeviceError::Lost(error));
        }
        buffer.unmap();
        self.check()
    }
}

impl std::fmt::Debug for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Device")
            .field("summary", &self.summary)
            .field("fault", &self.fault())
            .finish_non_exhaustive()
    }
}

/// A kernel and the buffers that it is bound to.
#[derive(Debug)]
pub(crate) struct BoundKernel<'a> {
    kernel: &'a wgpu::ComputePipeline,
    group: wgpu::BindGroup,
}

/// Rows that a kernel runs for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Size<'a> {
    /// So many.
    Rows(usize),
    /// Those in a queue, as `queue.wgsl` describes it.
    Queue(&'a wgpu::Buffer),
    /// Those in a queue that begins at a byte of the buffer.
    QueueAt(&'a wgpu::Buffer, u64),
}

/// Work for a device, in order.
pub(crate) struct Work<'a> {
    device: &'a Device,
    encoder: wgpu::CommandEncoder,
}

impl Work<'_> {
    /// Adds a kernel over these buffers.
    pub(crate) fn run(
        &mut self,
        kernel: Kernel,
        buffers: &[&wgpu::Buffer],
        size: Size,
    ) -> Result<(), DeviceError> {
        let kernel = self.device.compiled(kernel)?;
        pass(&mut self.encoder, &self.device.bind(kernel, buffers), size, None);
        Ok(())
    }

    /// Adds a copy of bytes of a buffer, from an offset on, to the start of another.
    pub(crate) fn copy(&mut self, from: &wgpu::Buffer, offset: u64, to: &wgpu::Buffer, bytes: u64) {
        self.encoder.copy_buffer_to_buffer(from, offset, to, 0, bytes);
    }

    /// Adds a copy of a buffer to another, from an offset on.
    pub(crate) fn copy_to(&mut self, from: &wgpu::Buffer, to: &wgpu::Buffer, offset: u64) {
        self.encoder.copy_buffer_to_buffer(from, 0, to, offset, from.size());
    }

    /// Asks for all of it.
    pub(crate) fn submit(self) -> Submitted {
        self.device.queue.submit([self.encoder.finish()])
    }
}

/// Returns the number of groups of 64 invocations for so many rows.
pub(crate) fn groups(rows: usize) -> u32 {
    rows.div_ceil(64) as u32
}

/// Adds a kernel in groups of 64 invocations to what is asked for, and has its start and end written if there is a
/// place for them.
fn pass(
    encoder: &mut wgpu::CommandEncoder,
    kernel: &BoundKernel,
    size: Size,
    ticks: Option<(&wgpu::QuerySet, u32)>,
) {
    let timestamp_writes = ticks.map(|(query_set, place)| wgpu::ComputePassTimestampWrites {
        query_set,
        beginning_of_pass_write_index: Some(place),
        end_of_pass_write_index: Some(place + 1),
    });
    let mut pass =
        encoder.begin_compute_pass(&wgpu::ComputePassDescriptor { label: None, timestamp_writes });
    pass.set_pipeline(kernel.kernel);
    pass.set_bind_group(0, &kernel.group, &[]);
    match size {
        Size::Rows(rows) => pass.dispatch_workgroups(groups(rows), 1, 1),
        Size::Queue(queue) => pass.dispatch_workgroups_indirect(queue, 0),
        Size::QueueAt(queues, offset) => pass.dispatch_workgroups_indirect(queues, offset),
    }
}

/// The first line of a message, or something in its place.
fn first_line(message: &str, otherwise: &str) -> String {
    let line = message.lines().map(str::trim).find(|line| !line.is_empty());
    line.unwrap_or(otherwise).trim_end_matches('.').to_owned()
}

fn of_driver(error: &wgpu::Error) -> DeviceError {
    match error {
        wgpu::Error::OutOfMemory { .. } => {
            DeviceError::Memory { what: "what it was asked to do".to_owned() }
        }
        wgpu::Error::Validation { description, .. } | wgpu::Error::Internal { description, .. } => {
            DeviceError::Failed(first_line(description, "for no reason that it tells"))
        }
    }
}
