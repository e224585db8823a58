//! The tiles of a render, of which a device and the threads of the processor take passes.

use super::super::pass::PASS;
use crate::film::{Region, Tile};
use crate::world::DevicePixels;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};

/// Tiles that a device has followed and no thread has added up, above which the device waits: 88 MiB of sums.
const BACKLOG: usize = 4096;

/// Tiles, and the samples that they are to get.
pub(super) struct TileQueue<'a> {
    state: Mutex<State<'a>>,
    /// Told of each change.
    changed: Condvar,
}

#[derive(Default)]
struct State<'a> {
    /// Tiles that nobody has, by the first and last samples that they lack and then by place: a pass covers all tiles before
    /// the next begins.
    waiting: BTreeMap<[u32; 4], &'a mut Tile>,
    /// Paths that they lack.
    paths: u64,
    /// Tiles whose paths a device has followed: the next that threads take.
    found: Vec<Found<'a>>,
    /// Memory for what a device finds next.
    spare: Vec<DevicePixels>,
    /// Number of tiles that somebody has, or that are found.
    taken: usize,
    /// True if a thread has panicked: all others end.
    aborted: bool,
}

/// A tile whose paths a device has followed.
struct Found<'a> {
    tile: &'a mut Tile,
    end: u32,
    pass: Range<u32>,
    pixels: FoundPixels,
}

/// Results of a device for the pixels of a tile.
pub(super) struct FoundPixels {
    /// Results for all pixels of a batch.
    pub(super) all: Arc<DevicePixels>,
    /// The places of the tile's pixels among them.
    pub(super) own: Range<usize>,
    /// Flags of the tile's pixels which the device was not given; empty if it was given all.
    pub(super) left: Vec<bool>,
}

/// Tiles that somebody has, to take the samples of a pass. They go back to the queue unchanged unless the pass is
/// [finished](Taken::finish).
pub(super) struct Taken<'q, 'a> {
    queue: &'q TileQueue<'a>,
    pub(super) tiles: Vec<&'a mut Tile>,
    /// Ends of the samples that they are to get.
    ends: Vec<u32>,
    pub(super) pass: Range<u32>,
}

/// The next work of a thread.
pub(super) enum Work<'q, 'a> {
    /// A tile is to get what a device has found.
    Add(Taken<'q, 'a>, FoundPixels),
    /// Tiles are to be sampled.
    Sample(Taken<'q, 'a>),
}

impl<'a> TileQueue<'a> {
    /// Creates a queue of tiles with the samples that they are to get.
    pub(super) fn new(steps: impl Iterator<Item = (&'a mut Tile, Range<u32>)>) -> Self {
        let mut state = State::default();
        steps.for_each(|(tile, samples)| state.put(tile, samples));
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

    fn lock(&self) -> MutexGuard<'_, State<'a>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'s>(&self, state: MutexGuard<'s, State<'a>>) -> MutexGuard<'s, State<'a>> {
        self.changed.wait(state).unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the state, and tells all who wait.
    fn change(&self, change: impl FnOnce(&mut State<'a>)) {
        change(&mut self.lock());
        self.changed.notify_all();
    }

    /// Takes the next tiles, of about so many paths; `None` if none waits.
    pub(super) fn take(&self, paths: usize) -> Option<Taken<'_, 'a>> {
        self.lock().take(paths).map(|taken| self.taken(taken))
    }

    fn taken(&self, next: NextTiles<'a>) -> Taken<'_, 'a> {
        let NextTiles { tiles, ends, pass } = next;
        Taken { queue: self, tiles, ends, pass }
    }

    /// Takes the next tiles for a device, of about so many paths but no more than half of all unless these are `few`: others
    /// take tiles, too. Waits for tiles that somebody has. `None` if nothing is left.
    pub(super) fn next_batch(
        &self,
        [few, paths]: [usize; 2],
        cancelled: impl Fn() -> bool,
    ) -> Option<Taken<'_, 'a>> {
        let mut state = self.lock();
        loop {
            if state.aborted || cancelled() {
                return None;
            }
            if state.found.len() < BACKLOG {
                let half = usize::try_from(state.paths / 2).unwrap_or(usize::MAX);
                if let Some(taken) = state.take(paths.min(half.max(few))) {
                    return Some(self.taken(taken));
                }
                if state.taken == 0 {
                    return None;
                }
            }
            state = self.wait(state);
        }
    }

    /// Returns the next work of a thread that samples about so many paths at once. Waits for tiles that somebody has. `None`
    /// if nothing is left.
    pub(super) fn next_work(
        &self,
        paths: usize,
        cancelled: impl Fn() -> bool,
    ) -> Option<Work<'_, 'a>> {
        let mut state = self.lock();
        loop {
            if state.aborted {
                return None;
            }
            if let Some(Found { tile, end, pass, pixels }) = state.found.pop() {
                let next = NextTiles { tiles: vec![tile], ends: vec![end], pass };
                return Some(Work::Add(self.taken(next), pixels));
            }
            let taken = if cancelled() { None } else { state.take(paths) };
            if let Some(taken) = taken {
                return Some(Work::Sample(self.taken(taken)));
            }
            if state.taken == 0 {
                return None;
            }
            state = self.wait(state);
        }
    }

    /// Returns memory for what a device finds.
    pub(super) fn spare(&self) -> DevicePixels {
        self.lock().spare.pop().unwrap_or_default()
    }

    /// Takes back the memory of what a device has found, if no other tile needs it.
    pub(super) fn recycle(&self, found: FoundPixels) {
        if let Some(all) = Arc::into_inner(found.all) {
            self.lock().spare.push(all);
        }
    }
}

/// Tiles of the same pass.
struct NextTiles<'a> {
    tiles: Vec<&'a mut Tile>,
    /// Ends of the samples that they are to get.
    ends: Vec<u32>,
    pass: Range<u32>,
}

impl<'a> State<'a> {
    /// Adds a tile with the samples that it lacks, if any.
    fn put(&mut self, tile: &'a mut Tile, samples: Range<u32>) {
        if samples.is_empty() {
            return;
        }
        let Region { x, y, .. } = tile.region;
        self.paths += lacking(tile, &samples);
        self.waiting.insert([samples.start, samples.end, y, x], tile);
    }

    /// Takes tiles of the same pass with about so many paths, one at least.
    fn take(&mut self, most: usize) -> Option<NextTiles<'a>> {
        let next = |&[start, end, ..]: &[u32; 4]| next_pass(&(start..end));
        let pass = next(self.waiting.first_key_value()?.0);
        let (mut tiles, mut ends, mut paths) = (Vec::new(), Vec::new(), 0);
        while let Some(first) = self.waiting.first_entry() {
            paths += first.get().len() as usize * pass.len();
            if next(first.key()) != pass || (paths > most && !tiles.is_empty()) {
                break;
            }
            let ([start, end, ..], tile) = first.remove_entry();
            self.paths -= lacking(tile, &(start..end));
            tiles.push(tile);
            ends.push(end);
        }
        self.taken += tiles.len();
        Some(NextTiles { tiles, ends, pass })
    }
}

/// Returns the number of paths of so many samples of a tile.
fn lacking(tile: &Tile, samples: &Range<u32>) -> u64 {
    u64::from(tile.len()) * samples.len() as u64
}

/// Returns the first of the passes that samples are divided into, which end where those of the processor do.
fn next_pass(samples: &Range<u32>) -> Range<u32> {
    let end = (samples.start / PASS + 1).saturating_mul(PASS);
    samples.start..samples.end.min(end)
}

impl Taken<'_, '_> {
    /// Returns the number of samples of the pass.
    pub(super) fn samples(&self) -> u64 {
        self.tiles.iter().map(|tile| lacking(tile, &self.pass)).sum()
    }

    /// Gives the tiles back, which have the samples of the pass.
    pub(super) fn finish(mut self) {
        self.pass.start = self.pass.end;
    }

    /// Hands the tiles over to threads which add up what a device has found, one after another.
    pub(super) fn hand_over(mut self, found: impl Iterator<Item = FoundPixels>) {
        let (tiles, ends) = (std::mem::take(&mut self.tiles), std::mem::take(&mut self.ends));
        let all = tiles.into_iter().zip(ends).zip(found).map(|((tile, end), pixels)| {
            let pass = self.pass.clone();
            Found { tile, end, pass, pixels }
        });
        let all: Vec<Found> = all.collect();
        self.queue.change(|state| state.found.extend(all));
    }
}

impl Drop for Taken<'_, '_> {
    fn drop(&mut self) {
        let tiles = std::mem::take(&mut self.tiles);
        self.queue.change(|state| {
            state.taken -= tiles.len();
            state.aborted |= std::thread::panicking();
            for (tile, end) in tiles.into_iter().zip(&self.ends) {
                state.put(tile, self.pass.start..*end);
            }
        });
    }
}
