//! Undo and redo: what a viewer showed before.

use super::camera_control::CameraControl;
use super::content::{Content, LookChanges};
use spherule_render::scene::Settings;

/// Maximum number of states that are kept.
const MOST: usize = 200;

/// All that commands change.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct State {
    pub(super) content: Content,
    pub(super) control: CameraControl,
    pub(super) settings: Settings,
    pub(super) touched: LookChanges,
}

/// States before and after the current one.
#[derive(Clone, Debug, Default)]
pub(super) struct History {
    past: Vec<State>,
    future: Vec<State>,
    now: Option<State>,
    /// True if the last change was one of many small ones, as of a wheel.
    fine: bool,
}

impl History {
    /// Records a state, if it differs from the last. Successive fine changes are undone at once.
    pub(super) fn record(&mut self, state: State, fine: bool) {
        if self.now.as_ref() == Some(&state) {
            return;
        }
        let continues = fine && std::mem::replace(&mut self.fine, fine);
        if let Some(last) = self.now.replace(state).filter(|_| !continues) {
            self.past.push(last);
            let excess = self.past.len().saturating_sub(MOST);
            self.past.drain(..excess);
        }
        self.future.clear();
    }

    /// Starts anew with a state, which cannot be undone.
    pub(super) fn begin(&mut self, state: State) {
        *self = Self { now: Some(state), ..Self::default() };
    }

    /// Replaces the current state by what became of it.
    pub(super) fn amend(&mut self, state: State) {
        self.now = Some(state);
    }

    /// Returns the state before the current one, which becomes that.
    pub(super) fn undo(&mut self) -> Option<State> {
        let before = self.past.pop()?;
        self.future.extend(self.now.replace(before.clone()));
        self.fine = false;
        Some(before)
    }

    /// Returns the state that was undone last, which becomes the current one.
    pub(super) fn redo(&mut self) -> Option<State> {
        let after = self.future.pop()?;
        self.past.extend(self.now.replace(after.clone()));
        self.fine = false;
        Some(after)
    }

    /// Returns whether there are states to return to: by undo, and by redo.
    pub(super) fn reach(&self) -> [bool; 2] {
        [&self.past, &self.future].map(|states| !states.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use spherule_render::scene::Camera;

    fn state(spp: u32) -> State {
        State {
            content: Content::default(),
            control: CameraControl::new(Camera::default(), 1.0),
            settings: Settings { spp, ..Settings::default() },
            touched: LookChanges::default(),
        }
    }

    #[test]
    fn changes_are_undone_and_done_again() {
        let mut history = History::default();
        history.begin(state(1));
        history.record(state(1), false);
        assert_eq!(history.reach(), [false, false]);
        for (spp, fine) in [(2, false), (3, true), (4, true), (5, true), (6, false)] {
            history.record(state(spp), fine);
        }
        let spp = |state: Option<State>| state.map(|state| state.settings.spp);
        let undone: Vec<_> = (0..4).map(|_| spp(history.undo())).collect();
        assert_eq!(undone, [Some(5), Some(2), Some(1), None]);
        let done: Vec<_> = (0..4).map(|_| spp(history.redo())).collect();
        assert_eq!(done, [Some(2), Some(5), Some(6), None]);
        history.undo();
        history.record(state(7), false);
        assert_eq!(history.reach(), [true, false]);
    }

    #[test]
    fn old_states_are_forgotten() {
        let mut history = History::default();
        (0..1000).for_each(|spp| history.record(state(spp), false));
        assert_eq!((history.past.len(), history.past[0].settings.spp), (MOST, 799));
    }
}
