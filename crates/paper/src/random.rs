//! Random numbers: a shared generator behind a lock, or one for each image row.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A random number generator.
pub(super) enum Random<'a> {
    /// A generator of one thread.
    Own(Xoshiro256PlusPlus),
    /// The generator of all threads, behind a lock: the paper's critical section.
    Shared(&'a Mutex<Xoshiro256PlusPlus>),
}

impl Random<'_> {
    /// Returns a generator for a seed.
    pub(super) fn sequence(seed: u64) -> Xoshiro256PlusPlus {
        Xoshiro256PlusPlus::seed_from_u64(seed)
    }

    /// Returns a uniform number in 0..1.
    pub(super) fn unit(&mut self) -> f64 {
        let bits = match self {
            Self::Own(sequence) => sequence.next_u64(),
            Self::Shared(sequence) => lock(sequence).next_u64(),
        };
        (bits >> 11) as f64 * 2.0_f64.powi(-53)
    }
}

/// Stratification of the unit square into equal cells. The number of columns is the largest divisor of
/// the number of cells up to its square root.
pub(super) struct Cells {
    columns: u32,
    rows: u32,
}

impl Cells {
    pub(super) fn new(count: u32) -> Self {
        let columns = (1..=count.isqrt()).rev().find(|n| count.is_multiple_of(*n)).unwrap_or(1);
        Self { columns, rows: count / columns }
    }

    pub(super) fn count(&self) -> u32 {
        self.columns * self.rows
    }

    /// Returns a random point in a cell.
    pub(super) fn jitter(&self, index: u32, random: &mut Random) -> [f64; 2] {
        let [column, row] = [index % self.columns, index / self.columns].map(f64::from);
        let x = (column + random.unit()) / f64::from(self.columns);
        [x, (row + random.unit()) / f64::from(self.rows)]
    }
}

/// Locks a mutex. Panics of other threads leave the data valid.
pub(super) fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
