//! The spheres of a part of the tree, in one of two places.
//!
//! What parts spheres writes them one after another to other memory, which is faster than exchanging them in place, and
//! leaves those of a side in the order in which they were.

use super::item::Item;

/// The spheres of a part, and as much memory beside them, or none where they are rarely parted.
pub(super) struct Segment<'a> {
    pub(super) items: &'a mut [Item],
    pub(super) spare: &'a mut [Item],
    /// True if `spare` is where they are to be when the tree is built.
    moved: bool,
}

impl<'a> Segment<'a> {
    /// Of items that are to stay where they are; `spare` is as long, or empty.
    pub(super) fn new(items: &'a mut [Item], spare: &'a mut [Item]) -> Self {
        Self { items, spare, moved: false }
    }

    pub(super) fn len(&self) -> usize {
        self.items.len()
    }

    /// Makes the spare memory, where the items have been written, that of the items.
    pub(super) fn exchange(&mut self) {
        std::mem::swap(&mut self.items, &mut self.spare);
        self.moved = !self.moved;
    }

    pub(super) fn split_at(self, place: usize) -> (Self, Self) {
        let Self { items, spare, moved } = self;
        let of_spare = place.min(spare.len());
        let (items, spare) = (items.split_at_mut(place), spare.split_at_mut(of_spare));
        let part = |items, spare| Self { items, spare, moved };
        (part(items.0, spare.0), part(items.1, spare.1))
    }

    /// The place where the items are to be in the end.
    pub(super) fn destination(self) -> &'a mut [Item] {
        if self.moved { self.spare } else { self.items }
    }

    /// Puts the items where they are to be in the end.
    pub(super) fn settle(self) -> &'a mut [Item] {
        if self.moved {
            self.spare.copy_from_slice(self.items);
        }
        self.destination()
    }
}
