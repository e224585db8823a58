//! What paths take along from surface to surface.

use super::arrival::Arrival;
use super::block::{Block, floats};
use crate::lanes::{F32x16, Packing, U32x16};
use crate::sampling::Places;
use crate::vec3::Vec3;

/// What paths take along from surface to surface: a row for each, beside those of their rays.
#[derive(Clone, Debug, Default)]
pub struct Carried {
    columns: Block<COLUMNS>,
    /// Whether the last ones are kept.
    normals: bool,
}

/// Which paths they are.
const PLACE: usize = 0;
/// [`Places`]: two columns.
const NUMBERS: usize = 1;
/// Products of the weights so far, by channel.
const THROUGHPUT: usize = 3;
/// [`Arrival`].
const ARRIVAL: usize = 6;
/// Normals of the last surfaces, on the sides that were lit, for what the choice of a light depends
/// on.
const NORMAL: usize = 7;
const COLUMNS: usize = 10;

/// What sixteen paths take along.
#[derive(Clone, Copy, Debug)]
pub struct CarriedRow {
    /// Which paths they are.
    pub place: U32x16,
    /// Products of the weights so far, by channel.
    pub throughput: Vec3<F32x16>,
    /// Where in their sequences of samples they are.
    pub numbers: Places,
    /// How they came.
    pub arrival: Arrival<F32x16>,
    /// Normals of the last surfaces; anything where nobody asks.
    pub normal: Vec3<F32x16>,
}

impl Carried {
    /// With the normals of the last surfaces if somebody asks for them.
    pub(super) fn new(normals: bool) -> Self {
        Self { normals, ..Self::default() }
    }

    /// Which path is in row `i`.
    #[inline(always)]
    pub fn place(&self, i: usize) -> usize {
        self.columns.number(PLACE, i) as usize
    }

    /// The product of the weights so far of the path in row `i`.
    pub fn throughput(&self, i: usize) -> glam::Vec3 {
        self.columns.vector(THROUGHPUT, i)
    }

    /// Where the path in row `i` is in its Sobol sequence.
    pub(super) fn number(&self, i: usize) -> u32 {
        self.columns.number(NUMBERS, i)
    }

    /// How the path in row `i` came.
    pub(super) fn arrival(&self, i: usize) -> Arrival<f32> {
        Arrival(self.columns.float(ARRIVAL, i))
    }

    /// The normal of the last surface of the path in row `i`; anything where nobody asks.
    pub(super) fn last_normal(&self, i: usize) -> glam::Vec3 {
        self.columns.vector(NORMAL, i)
    }

    /// Row `i`, sixteen times.
    pub(super) fn one(&self, i: usize) -> CarriedRow {
        let CarriedRow { arrival, .. } = self.load(i);
        let number = |column| U32x16::splat(self.columns.number(column, i));
        let splat = |v: glam::Vec3| Vec3::splat(v.x, v.y, v.z);
        CarriedRow {
            place: number(PLACE),
            throughput: splat(self.throughput(i)),
            numbers: Places { places: number(NUMBERS), seeds: number(NUMBERS + 1) },
            arrival: Arrival(F32x16::splat(arrival.0.to_array()[0])),
            normal: splat(self.last_normal(i)),
        }
    }

    /// Rows `first..first + 16`.
    #[inline(always)]
    pub(super) fn load(&self, first: usize) -> CarriedRow {
        let columns = &self.columns;
        CarriedRow {
            place: columns.numbers(PLACE, first),
            throughput: columns.vectors(THROUGHPUT, first),
            numbers: self.numbers(first),
            arrival: Arrival(columns.floats(ARRIVAL, first)),
            normal: columns.vectors(NORMAL, first),
        }
    }

    /// Where the paths in rows `first..first + 16` are in their sequences of samples.
    #[inline(always)]
    fn numbers(&self, first: usize) -> Places {
        let [places, seeds] = [NUMBERS, NUMBERS + 1].map(|c| self.columns.numbers(c, first));
        Places { places, seeds }
    }

    /// Writes some lanes of a row to rows from `first` on, and anything to those up to sixteen.
    #[inline(always)]
    pub(super) fn pack(&mut self, first: usize, packing: &Packing, row: &CarriedRow) {
        let (numbers, throughput) = (&row.numbers, row.throughput.map(floats));
        let rows = [
            row.place,
            numbers.places,
            numbers.seeds,
            throughput.x,
            throughput.y,
            throughput.z,
            floats(row.arrival.0),
        ];
        self.columns.pack((PLACE, first), packing, rows);
        if self.normals {
            let Vec3 { x, y, z } = row.normal.map(floats);
            self.columns.pack((NORMAL, first), packing, [x, y, z]);
        }
    }

    /// Writes where the paths in rows `first..first + 16` are in their sequences of samples.
    #[inline(always)]
    pub(super) fn start(&mut self, first: usize, Places { places, seeds }: &Places) {
        self.columns.store(first, [(NUMBERS, *places), (NUMBERS + 1, *seeds)]);
    }

    /// Writes where the path in row `i` is in its sequence of samples: place and seed.
    #[inline]
    pub(super) fn start_one(&mut self, i: usize, [place, seed]: [u32; 2]) {
        self.columns.set(NUMBERS, i, place);
        self.columns.set(NUMBERS + 1, i, seed);
    }

    /// Lets the paths in rows `first..first + 16`, which have begun, leave the camera: their places
    /// are their rows.
    #[inline(always)]
    pub(super) fn leave_camera(&mut self, first: usize) -> CarriedRow {
        let one = F32x16::splat(1.0);
        let row = CarriedRow {
            place: U32x16::new(std::array::from_fn(|lane| (first + lane) as u32)),
            throughput: Vec3::new(one, one, one),
            numbers: self.numbers(first),
            arrival: Arrival::camera(),
            normal: Vec3::splat(0.0, 0.0, 0.0),
        };
        let (one, arrival) = (floats(one), floats(row.arrival.0));
        let throughput = [0, 1, 2].map(|channel| (THROUGHPUT + channel, one));
        self.columns.store(first, throughput);
        self.columns.store(first, [(PLACE, row.place), (ARRIVAL, arrival)]);
        row
    }

    /// Gives the path in a row another place.
    #[cfg(test)]
    pub(super) fn set_place(&mut self, i: usize, place: u32) {
        self.columns.set(PLACE, i, place);
    }
}
