//! Embree 4, loaded at run time: the few functions that spheres and rays need, behind safe ones.
//!
//! Prototypes follow Embree's headers of version 4.4 in its usual configuration: one level of
//! instances, and instance arrays, which add a column to hits. This is the only file with `unsafe`.
#![allow(unsafe_code, reason = "functions of another language are called here, and only here")]

mod packet;

use crate::rays::Rays;
use libloading::Library;
pub use packet::Call;
use packet::{Answers, Any, Arguments, Closest, Packet, Valid};
use std::ffi::{CString, c_char, c_void};
use std::mem::ManuallyDrop;
use std::path::Path;
use std::ptr;
use std::sync::atomic::{AtomicIsize, Ordering};

/// What can go wrong with Embree.
#[derive(Debug, thiserror::Error)]
pub enum EmbreeError {
    /// The library is not there, or lacks a function.
    #[error("cannot load Embree; `tools/peers/run` fetches a library that fits")]
    Load(#[from] libloading::Error),
    /// The library is of another major version, whose structures differ.
    #[error("this is Embree {0}; give `--embree` a library of version 4.4 or later 4.x")]
    Version(String),
    /// Embree refused, with its own error code.
    #[error("Embree failed at {1} with its error {0}")]
    Refused(u32, &'static str),
}

type Handle = *mut c_void;
type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;
/// A packet of rays of any width.
type Rows = *mut c_void;
type Single = unsafe extern "C" fn(Handle, Rows, *mut Arguments);
type Several = unsafe extern "C" fn(*const i32, Handle, Rows, *mut Arguments);

const SPHERE_POINT: u32 = 50;
const VERTEX_BUFFER: u32 = 1;
const FLOAT4: u32 = 0x9004;
const PROPERTY_MAJOR: u32 = 1;
const PROPERTY_MINOR: u32 = 2;
const SCENE_ROBUST: u32 = 1 << 2;

macro_rules! calls {
    ($($field:ident $symbol:literal: fn($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// Embree's functions.
        struct Calls {
            $($field: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Calls {
            fn load(library: &Library) -> Result<Self, libloading::Error> {
                // SAFETY: the types are those of Embree's headers.
                unsafe {
                    Ok(Self {
                        $($field: *library.get($symbol)?,)*
                    })
                }
            }
        }
    };
}

calls! {
    new_device "rtcNewDevice": fn(*const c_char) -> Handle;
    release_device "rtcReleaseDevice": fn(Handle);
    device_property "rtcGetDeviceProperty": fn(Handle, u32) -> isize;
    device_error "rtcGetDeviceError": fn(Handle) -> u32;
    monitor "rtcSetDeviceMemoryMonitorFunction": fn(Handle, Option<Monitor>, *mut c_void);
    new_scene "rtcNewScene": fn(Handle) -> Handle;
    scene_flags "rtcSetSceneFlags": fn(Handle, u32);
    scene_quality "rtcSetSceneBuildQuality": fn(Handle, u32);
    release_scene "rtcReleaseScene": fn(Handle);
    new_geometry "rtcNewGeometry": fn(Handle, u32) -> Handle;
    release_geometry "rtcReleaseGeometry": fn(Handle);
    new_buffer "rtcSetNewGeometryBuffer": fn(Handle, u32, u32, u32, usize, usize) -> *mut c_void;
    commit_geometry "rtcCommitGeometry": fn(Handle);
    attach_geometry "rtcAttachGeometry": fn(Handle, Handle) -> u32;
    commit_scene "rtcCommitScene": fn(Handle);
    intersect1 "rtcIntersect1": fn(Handle, Rows, *mut Arguments);
    intersect4 "rtcIntersect4": fn(*const i32, Handle, Rows, *mut Arguments);
    intersect8 "rtcIntersect8": fn(*const i32, Handle, Rows, *mut Arguments);
    intersect16 "rtcIntersect16": fn(*const i32, Handle, Rows, *mut Arguments);
    occluded1 "rtcOccluded1": fn(Handle, Rows, *mut Arguments);
    occluded4 "rtcOccluded4": fn(*const i32, Handle, Rows, *mut Arguments);
    occluded8 "rtcOccluded8": fn(*const i32, Handle, Rows, *mut Arguments);
    occluded16 "rtcOccluded16": fn(*const i32, Handle, Rows, *mut Arguments);
}

/// Bytes that Embree holds, as it tells.
#[derive(Debug, Default)]
struct Memory {
    now: AtomicIsize,
    peak: AtomicIsize,
}

/// Called by Embree, from any of its threads.
unsafe extern "C" fn count_bytes(memory: *mut c_void, bytes: isize, _post: bool) -> bool {
    // SAFETY: the pointer is that of `Device::memory`, which outlives the device.
    let memory = unsafe { &*memory.cast::<Memory>() };
    let now = memory.now.fetch_add(bytes, Ordering::Relaxed) + bytes;
    memory.peak.fetch_max(now, Ordering::Relaxed);
    true
}

/// How a scene is built.
#[derive(Clone, Copy, Debug)]
pub struct Build {
    /// Whether boxes are tested so that nothing is missed by rounding.
    pub robust: bool,
    /// Embree's build quality: 0 low, 1 medium, 2 high.
    pub quality: u32,
}

/// Embree with its threads.
pub struct Device {
    handle: Handle,
    calls: Calls,
    memory: Box<Memory>,
    /// Has the functions, and stays loaded: threads of its own may outlive a device.
    _library: ManuallyDrop<Library>,
}

/// Spheres with a tree over them.
pub struct Scene<'a> {
    handle: Handle,
    device: &'a Device,
}

impl Device {
    /// Loads the library and starts a device, configured by a string such as `threads=1`.
    ///
    /// # Errors
    /// The file is no Embree 4.4, or Embree does not run here.
    pub fn new(path: &Path, configuration: &str) -> Result<Self, EmbreeError> {
        // SAFETY: Embree does nothing harmful when it is loaded.
        let library = unsafe { Library::new(path)? };
        let calls = Calls::load(&library)?;
        let configuration: Vec<u8> = configuration.bytes().filter(|&byte| byte != 0).collect();
        let configuration = CString::new(configuration).unwrap_or_default();
        // SAFETY: the string lives during the call.
        let handle = unsafe { (calls.new_device)(configuration.as_ptr()) };
        let device =
            Self { handle, calls, memory: Box::default(), _library: ManuallyDrop::new(library) };
        device.check("rtcNewDevice")?;
        let (major, minor) = device.version();
        if major != 4 || minor < 4 {
            return Err(EmbreeError::Version(format!("{major}.{minor}")));
        }
        let memory = ptr::from_ref(&*device.memory).cast_mut().cast();
        // SAFETY: the counter is boxed and is dropped after the device is released.
        unsafe { (device.calls.monitor)(handle, Some(count_bytes), memory) };
        Ok(device)
    }

    /// Major and minor.
    pub fn version(&self) -> (isize, isize) {
        // SAFETY: the handle is that of a device.
        let property = |which| unsafe { (self.calls.device_property)(self.handle, which) };
        (property(PROPERTY_MAJOR), property(PROPERTY_MINOR))
    }

    /// Bytes held now, and the most since the device was started.
    pub fn bytes(&self) -> (usize, usize) {
        let read = |value: &AtomicIsize| value.load(Ordering::Relaxed).max(0) as usize;
        (read(&self.memory.now), read(&self.memory.peak))
    }

    /// Builds a tree over spheres of x, y, z and radius.
    ///
    /// # Errors
    /// Embree refuses.
    pub fn build(&self, spheres: &[[f32; 4]], build: Build) -> Result<Scene<'_>, EmbreeError> {
        let calls = &self.calls;
        // SAFETY: handles are those that Embree gave; the scene keeps the geometry.
        unsafe {
            let scene = Scene { handle: (calls.new_scene)(self.handle), device: self };
            self.check("rtcNewScene")?;
            (calls.scene_flags)(scene.handle, if build.robust { SCENE_ROBUST } else { 0 });
            (calls.scene_quality)(scene.handle, build.quality);
            let geometry = (calls.new_geometry)(self.handle, SPHERE_POINT);
            self.check("rtcNewGeometry")?;
            let filled = self.fill(geometry, spheres);
            if filled.is_ok() {
                (calls.commit_geometry)(geometry);
                (calls.attach_geometry)(scene.handle, geometry);
                (calls.commit_scene)(scene.handle);
            }
            (calls.release_geometry)(geometry);
            filled?;
            self.check("rtcCommitScene")?;
            Ok(scene)
        }
    }

    fn fill(&self, geometry: Handle, spheres: &[[f32; 4]]) -> Result<(), EmbreeError> {
        let (stride, count) = (size_of::<[f32; 4]>(), spheres.len());
        // SAFETY: Embree's buffer holds as many rows of four numbers as were asked for.
        unsafe {
            let new_buffer = self.calls.new_buffer;
            let buffer = new_buffer(geometry, VERTEX_BUFFER, 0, FLOAT4, stride, count);
            self.check("rtcSetNewGeometryBuffer")?;
            ptr::copy_nonoverlapping(spheres.as_ptr(), buffer.cast(), count);
        }
        Ok(())
    }

    fn check(&self, place: &'static str) -> Result<(), EmbreeError> {
        // SAFETY: no device is a device of its own to this function.
        match unsafe { (self.calls.device_error)(self.handle) } {
            0 => Ok(()),
            code => Err(EmbreeError::Refused(code, place)),
        }
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        if !self.handle.is_null() {
            // SAFETY: no scene outlives the device that it borrows.
            unsafe { (self.calls.release_device)(self.handle) };
        }
    }
}

impl Drop for Scene<'_> {
    fn drop(&mut self) {
        // SAFETY: the handle is used by nobody else.
        unsafe { (self.device.calls.release_scene)(self.handle) };
    }
}

impl Scene<'_> {
    /// The row of the sphere that each ray hits first, or [`spherule_core::NOTHING`], and its
    /// distance; `spheres` and `t` are as long as the columns of rays.
    pub fn intersect(&self, rays: &Rays, call: Call, spheres: &mut [u32], t: &mut [f32]) {
        let calls = &self.device.calls;
        let several = [calls.intersect4, calls.intersect8, calls.intersect16];
        self.dispatch(rays, call, calls.intersect1, several, Closest { spheres, t });
    }

    /// Whether each ray hits anything; `occluded` is as long as the columns of rays.
    pub fn occluded(&self, rays: &Rays, call: Call, occluded: &mut [bool]) {
        let calls = &self.device.calls;
        let several = [calls.occluded4, calls.occluded8, calls.occluded16];
        self.dispatch(rays, call, calls.occluded1, several, Any(occluded));
    }

    fn dispatch(
        &self,
        rays: &Rays,
        call: Call,
        single: Single,
        several: [Several; 3],
        answers: impl Answers,
    ) {
        match call.width {
            1 => self.trace_one(rays, call, single, answers),
            4 => self.trace::<4>(rays, call, several[0], answers),
            8 => self.trace::<8>(rays, call, several[1], answers),
            _ => self.trace::<16>(rays, call, several[2], answers),
        }
    }

    fn trace_one(&self, rays: &Rays, call: Call, single: Single, mut answers: impl Answers) {
        let mut arguments = Arguments::new(call);
        let mut packet = Packet::<1>::new();
        let (columns, bounds) = (rays.columns(), rays.bounds());
        for first in 0..rays.len() {
            packet.fill(&columns, bounds, first, 1);
            // SAFETY: scene and packet are valid; one ray's call reads and writes this layout.
            unsafe { single(self.handle, (&raw mut packet).cast(), &raw mut arguments) };
            answers.take(&packet, first, 1);
        }
    }

    fn trace<const N: usize>(
        &self,
        rays: &Rays,
        call: Call,
        several: Several,
        mut answers: impl Answers,
    ) {
        let mut arguments = Arguments::new(call);
        let mut packet = Packet::<N>::new();
        let (columns, bounds, count) = (rays.columns(), rays.bounds(), rays.len());
        for first in (0..count).step_by(N) {
            let filled = N.min(count - first);
            packet.fill(&columns, bounds, first, filled);
            let valid = Valid::<N>::first(filled);
            let rows = (&raw mut packet).cast();
            // SAFETY: scene, mask and packet are valid, and as wide and aligned as this call's.
            unsafe { several(valid.0.as_ptr(), self.handle, rows, &raw mut arguments) };
            answers.take(&packet, first, filled);
        }
    }
}
