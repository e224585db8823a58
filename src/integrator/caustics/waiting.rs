//! Who waits to look for a caustic, until there is a row of them.

use crate::lanes::{F32x16, MAX_LANES, Packing, U32x16};
use crate::vec3::Vec3;

/// Room for a row less one, and another.
const ROOM: usize = 3 * MAX_LANES;

/// Columns of those who wait.
#[derive(Default)]
pub(super) struct Waiting {
    /// What they are on, which paths they are, and which ways of which pairs they look for.
    numbers: [Vec<u32>; 3],
    /// Probability of the choice, place on the lamp, and each in three columns, what arrives of unit
    /// irradiance, the point and the normal.
    values: [Vec<f32>; 12],
    len: usize,
}

/// A row of those who wait.
#[derive(Clone, Copy)]
pub(super) struct Row {
    pub(super) own: [u32; MAX_LANES],
    pub(super) path: [u32; MAX_LANES],
    pub(super) code: [u32; MAX_LANES],
    pub(super) probability: F32x16,
    pub(super) place: [F32x16; 2],
    pub(super) factor: Vec3<F32x16>,
    pub(super) point: Vec3<F32x16>,
    pub(super) normal: Vec3<F32x16>,
}

impl Waiting {
    pub(super) fn new() -> Self {
        let numbers = [(); 3].map(|()| vec![0; ROOM]);
        Self { numbers, values: [(); 12].map(|()| vec![0.0; ROOM]), len: 0 }
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Appends some lanes of a row; there are less than a row before.
    #[inline(always)]
    pub(super) fn push(&mut self, row: &Row, lanes: u32) {
        let packing = Packing::new(lanes);
        for (column, row) in self.numbers.iter_mut().zip([row.own, row.path, row.code]) {
            packing.store_numbers(U32x16::new(row), &mut column[self.len..]);
        }
        let ([u, v], Vec3 { x, y, z }) = (row.place, row.factor);
        let (point, normal) = (row.point, row.normal);
        let ends = [point.x, point.y, point.z, normal.x, normal.y, normal.z];
        let values = [row.probability, u, v, x, y, z].into_iter().chain(ends);
        for (column, row) in self.values.iter_mut().zip(values) {
            packing.store(row, &mut column[self.len..]);
        }
        self.len += packing.count();
    }

    /// Takes a row, or what there is, and which lanes those are.
    pub(super) fn take(&mut self) -> (Row, u32) {
        let count = self.len.min(MAX_LANES);
        let [own, path, code] = self.numbers.each_ref().map(|column| *first(column));
        let value = |i: usize| F32x16::new(*first(&self.values[i]));
        let vector = |i: usize| Vec3::new(value(i), value(i + 1), value(i + 2));
        let row = Row {
            own,
            path,
            code,
            probability: value(0),
            place: [value(1), value(2)],
            factor: vector(3),
            point: vector(6),
            normal: vector(9),
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
