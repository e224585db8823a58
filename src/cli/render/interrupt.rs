//! Ctrl-C, and the signals that ask a program to end.

use std::sync::atomic::{AtomicBool, Ordering};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// From now on, the first signal sets this flag; the second ends the program at once.
///
/// Before the first call signals end the program as they always do: there is no picture yet that
/// could be saved.
pub(super) fn flag() -> &'static AtomicBool {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(i32::from(super::INTERRUPTED));
        }
    };
    // Without a handler, signals end the program as before.
    let _ = ctrlc::set_handler(handler);
    &INTERRUPTED
}
