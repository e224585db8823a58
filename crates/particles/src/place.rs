//! Places in files where frames begin, so that readers start near the frame that is asked for.

use std::any::Any;
use std::fmt;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Maximum number of marks of a file: beyond, every other one is dropped.
const MOST: usize = 1 << 18;

/// Bytes between marks at first: to pass over so many takes less than a millisecond.
const SPACING: u64 = 1 << 16;

/// The place where a frame begins, with what its reader knows there of earlier frames.
#[derive(Clone)]
pub(crate) struct Place {
    /// Offset in bytes; 0 in formats that find each frame by its number, whose first mark serves for all.
    pub(crate) offset: u64,
    /// Number of lines before it, or of frames.
    pub(crate) number: u64,
    state: Option<Arc<dyn Any + Send + Sync>>,
}

impl Place {
    pub(crate) fn new(offset: u64, number: u64) -> Self {
        Self { offset, number, state: None }
    }

    /// Returns the place with what the reader knows of earlier frames.
    pub(crate) fn with_state<T: Any + Send + Sync>(self, state: &Arc<T>) -> Self {
        let state: Arc<dyn Any + Send + Sync> = state.clone();
        Self { state: Some(state), ..self }
    }

    /// Returns what the reader of this place knew of earlier frames.
    pub(crate) fn state<T: Any + Send + Sync>(&self) -> Option<Arc<T>> {
        self.state.clone()?.downcast().ok()
    }
}

/// A frame and its place.
#[derive(Clone)]
pub(crate) struct Mark {
    pub(crate) frame: u64,
    pub(crate) place: Place,
}

/// Marks of the frames of a file that were passed so far, in order. Clones share them.
#[derive(Clone, Default)]
pub(crate) struct FrameIndex(Arc<Mutex<Marks>>);

struct Marks {
    marks: Vec<Mark>,
    /// Least number of bytes between two marks.
    spacing: u64,
}

impl Default for Marks {
    fn default() -> Self {
        Self { marks: Vec::new(), spacing: SPACING }
    }
}

impl FrameIndex {
    /// Creates an index with a mark at least every so many bytes.
    #[cfg(test)]
    pub(crate) fn spaced(spacing: u64) -> Self {
        Self(Arc::new(Mutex::new(Marks { marks: Vec::new(), spacing })))
    }

    /// Notes where a frame begins, unless that is near the last mark or before it.
    pub(crate) fn note(&self, frame: u64, place: Place) {
        let mut own = self.lock();
        let far = |last: &Mark| {
            frame > last.frame && place.offset >= last.place.offset.saturating_add(own.spacing)
        };
        if own.marks.last().is_none_or(far) {
            own.marks.push(Mark { frame, place });
        }
        if own.marks.len() > MOST {
            let mut is_kept = false;
            own.marks.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
            own.spacing = own.spacing.saturating_mul(2);
        }
    }

    /// Returns the last mark that is not after this frame.
    pub(crate) fn before(&self, frame: u64) -> Option<Mark> {
        let own = self.lock();
        let after = own.marks.partition_point(|mark| mark.frame <= frame);
        own.marks.get(after.checked_sub(1)?).cloned()
    }

    fn lock(&self) -> MutexGuard<'_, Marks> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl fmt::Debug for FrameIndex {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        formatter.debug_tuple("FrameIndex").field(&self.lock().marks.len()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_few_and_the_last_one_before_a_frame_is_found() {
        let index = FrameIndex::default();
        assert!(index.before(7).is_none());
        let frames = 5 * MOST as u64;
        let length = SPACING / 2 + 1;
        for frame in 0..frames {
            index.note(frame, Place::new(frame * length, 10 * frame));
        }
        let own = index.lock();
        assert!(own.marks.len() <= MOST && own.marks.len() > MOST / 2, "{}", own.marks.len());
        let spacing = own.spacing;
        drop(own);
        for frame in [0, 1, 2, 999, 1_000_001, frames - 1, 2 * frames] {
            let Mark { frame: found, place } = index.before(frame).expect("a mark");
            assert!(found <= frame && (place.offset, place.number) == (found * length, 10 * found));
            let last = frame.min(frames - 1);
            assert!((last - found) * length <= 2 * spacing, "{frame} {found}");
        }
        // What was passed before is not noted again.
        let count = index.lock().marks.len();
        index.note(3, Place::new(3 * length, 30));
        assert_eq!(index.lock().marks.len(), count);
    }

    #[test]
    fn places_carry_what_readers_know() {
        let place = Place::new(3, 1).with_state(&Arc::new("units"));
        assert_eq!(place.state::<&str>().as_deref(), Some(&"units"));
        assert!(place.state::<u8>().is_none() && Place::new(3, 1).state::<&str>().is_none());
    }
}
