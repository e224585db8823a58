//! Rays as Embree takes them, filled from columns, and what it answers, put into columns.

use spherule_core::RayColumns;
use std::ffi::c_void;
use std::ptr;

const FLAG_COHERENT: u32 = 1 << 16;
const INVALID: u32 = u32::MAX;

/// How rays are handed over.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// Rays in each call: 1, 4, 8 or 16.
    pub width: usize,
    /// Whether the rays are said to go alike.
    pub coherent: bool,
}

/// `RTCIntersectArguments`, and `RTCOccludedArguments`, which is the same.
#[repr(C)]
pub(super) struct Arguments {
    flags: u32,
    feature_mask: u32,
    context: *mut c_void,
    filter: *mut c_void,
    callback: *mut c_void,
    minimal_width: f32,
}

/// `RTCRayHit`, `RTCRayHit4`, `RTCRayHit8` and `RTCRayHit16`; their first twelve columns are
/// `RTCRay`, `RTCRay4` and so on.
#[repr(C, align(64))]
pub(super) struct Packet<const N: usize> {
    origin_x: [f32; N],
    origin_y: [f32; N],
    origin_z: [f32; N],
    near: [f32; N],
    direction_x: [f32; N],
    direction_y: [f32; N],
    direction_z: [f32; N],
    time: [f32; N],
    far: [f32; N],
    mask: [u32; N],
    id: [u32; N],
    flags: [u32; N],
    normal: [[f32; N]; 3],
    surface: [[f32; N]; 2],
    primitive: [u32; N],
    geometry: [u32; N],
    instance: [u32; N],
    instance_primitive: [u32; N],
}

/// Which rays of a packet are there.
#[repr(C, align(64))]
pub(super) struct Valid<const N: usize>(pub(super) [i32; N]);

impl<const N: usize> Valid<N> {
    pub(super) fn first(count: usize) -> Self {
        Self(std::array::from_fn(|i| if i < count { -1 } else { 0 }))
    }
}

impl Arguments {
    pub(super) fn new(call: Call) -> Self {
        Self {
            flags: if call.coherent { FLAG_COHERENT } else { 0 },
            feature_mask: u32::MAX,
            context: ptr::null_mut(),
            filter: ptr::null_mut(),
            callback: ptr::null_mut(),
            minimal_width: 0.0,
        }
    }
}

impl<const N: usize> Packet<N> {
    pub(super) fn new() -> Self {
        Self {
            origin_x: [0.0; N],
            origin_y: [0.0; N],
            origin_z: [0.0; N],
            near: [0.0; N],
            direction_x: [0.0; N],
            direction_y: [0.0; N],
            direction_z: [1.0; N],
            time: [0.0; N],
            far: [f32::INFINITY; N],
            mask: [u32::MAX; N],
            id: [0; N],
            flags: [0; N],
            normal: [[0.0; N]; 3],
            surface: [[0.0; N]; 2],
            primitive: [INVALID; N],
            geometry: [INVALID; N],
            instance: [INVALID; N],
            instance_primitive: [INVALID; N],
        }
    }

    /// Fills the packet with `count` rays from the `first` on; `bounds` are the distances at which searches end, none if it
    /// is empty.
    pub(super) fn fill(&mut self, rays: &RayColumns, bounds: &[f32], first: usize, count: usize) {
        let copy = |to: &mut [f32; N], from: &[f32]| match from[first..].first_chunk::<N>() {
            Some(chunk) => *to = *chunk,
            None => to[..count].copy_from_slice(&from[first..][..count]),
        };
        copy(&mut self.origin_x, rays.origin[0]);
        copy(&mut self.origin_y, rays.origin[1]);
        copy(&mut self.origin_z, rays.origin[2]);
        copy(&mut self.direction_x, rays.direction[0]);
        copy(&mut self.direction_y, rays.direction[1]);
        copy(&mut self.direction_z, rays.direction[2]);
        if bounds.is_empty() {
            self.far = [f32::INFINITY; N];
        } else {
            copy(&mut self.far, bounds);
        }
        self.primitive = [INVALID; N];
        self.geometry = [INVALID; N];
    }
}

/// Where answers go.
pub(super) trait Answers {
    fn take<const N: usize>(&mut self, packet: &Packet<N>, first: usize, count: usize);
}

pub(super) struct Closest<'a> {
    pub(super) spheres: &'a mut [u32],
    pub(super) t: &'a mut [f32],
}

pub(super) struct Any<'a>(pub(super) &'a mut [bool]);

impl Answers for Closest<'_> {
    fn take<const N: usize>(&mut self, packet: &Packet<N>, first: usize, count: usize) {
        self.spheres[first..][..count].copy_from_slice(&packet.primitive[..count]);
        self.t[first..][..count].copy_from_slice(&packet.far[..count]);
    }
}

impl Answers for Any<'_> {
    fn take<const N: usize>(&mut self, packet: &Packet<N>, first: usize, count: usize) {
        // Embree makes the far end negative where something is hit.
        for (occluded, far) in self.0[first..].iter_mut().zip(&packet.far[..count]) {
            *occluded = *far < 0.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::mem::offset_of;

    /// Every column of Embree's structures has `N` numbers of 32 bits; the hit starts after twelve.
    fn columns_follow<const N: usize>() {
        let column = |offset: usize| offset / (4 * N);
        assert_eq!(column(offset_of!(Packet<N>, far)), 8);
        assert_eq!(column(offset_of!(Packet<N>, normal)), 12);
        assert_eq!(column(offset_of!(Packet<N>, primitive)), 17);
        assert_eq!(column(offset_of!(Packet<N>, instance_primitive)), 20);
    }

    #[test]
    fn packets_are_laid_out_as_in_the_headers() {
        columns_follow::<1>();
        columns_follow::<4>();
        columns_follow::<8>();
        columns_follow::<16>();
        // With instance arrays and without padding, RTCRayHit is 84 bytes, in 16s 96.
        assert!(size_of::<Packet<1>>() >= 96);
    }

    #[test]
    fn the_last_packet_takes_what_is_left() {
        let numbers: Vec<f32> = (0..6_u8).map(f32::from).collect();
        let rays = RayColumns { origin: [&numbers; 3], direction: [&numbers; 3] };
        let mut packet = Packet::<4>::new();
        packet.fill(&rays, &numbers, 4, 2);
        assert_eq!(packet.far[..2], [4.0, 5.0]);
        packet.fill(&rays, &[], 4, 2);
        assert_eq!((packet.origin_y[..2].to_vec(), packet.far[0]), (vec![4.0, 5.0], f32::INFINITY));
        assert_eq!(Valid::<4>::first(2).0, [-1, -1, 0, 0]);
        packet.primitive[..2].copy_from_slice(&[7, INVALID]);
        let (mut spheres, mut t) = ([0; 6], [0.0; 6]);
        Closest { spheres: &mut spheres, t: &mut t }.take(&packet, 4, 2);
        assert_eq!(spheres, [0, 0, 0, 0, 7, INVALID]);
    }
}
