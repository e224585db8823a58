//! Queues of caustics: queries waiting for a full row, and first segments of shadow rays.

use crate::integrator::shadow_queue::{SHADOW_QUEUE_SIZE, ShadowRay};
use crate::lanes::{F32x16, MAX_LANES, Packing, U32x16, set_bits};
use crate::ray::{Hits, MISS, Rays};
use crate::vec3::Vec3;
use crate::world::{CausticQuery, CausticSample};

/// Capacity: an incomplete row, and two full ones.
const ROOM: usize = 3 * MAX_LANES;

/// Caustic queries waiting for a full row.
#[derive(Default)]
pub(super) struct QueryQueue {
    /// Sphere that the point lies on, path, code of the specular sphere and the caustic path, and emitter.
    numbers: [Vec<u32>; 4],
    /// Expected number of samples of the choice, sample point on the emitter (2 columns), throughput, point, normal, and
    /// local direction toward the origin of the ray (3 columns each).
    values: [Vec<f32>; 15],
    len: usize,
}

/// A row of queries.
#[derive(Clone, Copy)]
pub(super) struct QueryRow {
    pub(super) own: [u32; MAX_LANES],
    pub(super) path: [u32; MAX_LANES],
    pub(super) code: [u32; MAX_LANES],
    pub(super) emitter: [u32; MAX_LANES],
    pub(super) rate: F32x16,
    pub(super) place: [F32x16; 2],
    pub(super) throughput: Vec3<F32x16>,
    pub(super) point: Vec3<F32x16>,
    pub(super) normal: Vec3<F32x16>,
    pub(super) outgoing: Vec3<F32x16>,
}

impl QueryQueue {
    pub(super) fn new() -> Self {
        let numbers = [(); 4].map(|()| vec![0; ROOM]);
        Self { numbers, values: [(); 15].map(|()| vec![0.0; ROOM]), len: 0 }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Appends some lanes of a row. The queue must hold less than a row.
    #[inline(always)]
    pub(super) fn push(&mut self, row: &QueryRow, lanes: u32) {
        let packing = Packing::new(lanes);
        let numbers = [row.own, row.path, row.code, row.emitter];
        for (column, row) in self.numbers.iter_mut().zip(numbers) {
            packing.store_numbers(U32x16::new(row), &mut column[self.len..]);
        }
        let [u, v] = row.place;
        let vectors = [row.throughput, row.point, row.normal, row.outgoing];
        let vectors = vectors.into_iter().flat_map(|Vec3 { x, y, z }| [x, y, z]);
        let values = [row.rate, u, v].into_iter().chain(vectors);
        for (column, row) in self.values.iter_mut().zip(values) {
            packing.store(row, &mut column[self.len..]);
        }
        self.len += packing.count();
    }

    /// Takes at most a row off the queue; returns it with its valid lanes.
    pub(super) fn take(&mut self) -> (QueryRow, u32) {
        let count = self.len.min(MAX_LANES);
        let [mut own, path, code, emitter] = self.numbers.each_ref().map(|column| *first(column));
        // Kernels read the materials of all lanes.
        let last = own[0];
        own[count..].fill(last);
        let value = |i: usize| F32x16::new(*first(&self.values[i]));
        let vector = |i: usize| Vec3::new(value(i), value(i + 1), value(i + 2));
        let row = QueryRow {
            own,
            path,
            code,
            emitter,
            rate: value(0),
            place: [value(1), value(2)],
            throughput: vector(3),
            point: vector(6),
            normal: vector(9),
            outgoing: vector(12),
        };
        self.numbers.iter_mut().for_each(|column| column.copy_within(count..self.len, 0));
        self.values.iter_mut().for_each(|column| column.copy_within(count..self.len, 0));
        self.len -= count;
        (row, (1 << count) - 1)
    }
}

fn first<T>(column: &[T]) -> &[T; MAX_LANES] {
    column.first_chunk().expect("columns hold whole rows")
}

/// A segment of a camera ray, to a specular sphere.
#[derive(Clone, Copy)]
pub(in crate::integrator) struct CameraSegment {
    pub(in crate::integrator) origin: glam::Vec3,
    pub(in crate::integrator) direction: glam::Vec3,
    pub(in crate::integrator) length: f64,
}

/// First segments of shadow rays, from surfaces to specular spheres.
#[derive(Default)]
pub(super) struct FirstSegments {
    pub(super) rays: Rays,
    pub(super) hits: Hits,
    /// Second segments, from the spheres to emitters.
    pub(super) second: Vec<ShadowRay>,
}

impl FirstSegments {
    pub(super) fn new() -> Self {
        Self {
            rays: Rays::with_capacity(SHADOW_QUEUE_SIZE),
            hits: Hits::with_capacity(SHADOW_QUEUE_SIZE),
            second: Vec::with_capacity(SHADOW_QUEUE_SIZE),
        }
    }

    /// Returns whether there is room for another row.
    pub(super) fn has_room(&self) -> bool {
        self.second.len() + MAX_LANES <= SHADOW_QUEUE_SIZE
    }

    pub(super) fn clear(&mut self) {
        self.rays.truncate(0);
        self.second.clear();
    }

    /// Appends a segment from the camera to the sphere at which the second one starts. There must
    /// be room for it.
    pub(super) fn push(&mut self, first: &CameraSegment, second: &ShadowRay) {
        let row = self.rays.len();
        self.rays.push(first.origin, first.direction, MISS);
        self.rays.target[row] = second.start.1;
        self.hits.set(row, first.length, MISS);
        self.second.push(*second);
    }

    /// Appends the rays in `lanes` of the samples of a row of queries, with the light that arrives
    /// if they are not occluded.
    pub(super) fn push_row(
        &mut self,
        query: &CausticQuery,
        sample: &CausticSample,
        row: &QueryRow,
        light: Vec3<F32x16>,
        lanes: u32,
    ) {
        let first = self.rays.len();
        self.rays.append_packed(&Packing::new(lanes), (query.point, sample.toward), &row.own);
        let one = |v: Vec3<F32x16>, lane: usize| -> glam::Vec3 {
            v.map(|row| row.to_array()[lane]).into()
        };
        for (place, lane) in (first..).zip(set_bits(lanes)) {
            let sphere = query.pairs.sphere[lane];
            self.rays.target[place] = sphere;
            self.hits.set(place, sample.length[0][lane], MISS);
            self.second.push(ShadowRay {
                start: (one(sample.exit, lane), sphere),
                direction: one(sample.toward_emitter, lane),
                end: (sample.length[1][lane], query.pairs.emitter[lane]),
                path: row.path[lane],
                light: one(light, lane),
            });
        }
    }
}
