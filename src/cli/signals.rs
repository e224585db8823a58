//! Ctrl-C, and the signals that ask a program to end.

use signal_hook::consts::signal::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Set when a render is to stop: by a signal, or for a pause.
static STOP: AtomicBool = AtomicBool::new(false);

/// The first signal that came; 0 for none.
static SIGNAL: AtomicUsize = AtomicUsize::new(0);

/// True if the next signal ends the program at once: after the first one, and while nothing is lost
/// by it.
static ARMED: AtomicBool = AtomicBool::new(false);

/// Registers the handlers.
static ONCE: std::sync::Once = std::sync::Once::new();

/// What a shell reports of a process that a signal ended, less the signal's number.
const ENDED: u8 = 128;

/// From now on until [`release`], the first signal that asks the program to end sets [`stop`]; the second
/// ends it at once.
///
/// Before the first call signals end the program as they always do: there is no picture yet that
/// could be saved.
pub(super) fn catch() {
    ARMED.store(false, Ordering::SeqCst);
    // In this order: a signal that comes in between sets it again.
    ARMED.fetch_or(SIGNAL.load(Ordering::SeqCst) != 0, Ordering::SeqCst);
    ONCE.call_once(|| {
        for signal in terminating() {
            // Without a handler, signals end the program as before. The order counts: a signal is
            // known by the time that it stops anything.
            let _ = flag::register_conditional_shutdown(signal, i32::from(ENDED) + signal, &ARMED)
                .and_then(|_| flag::register(signal, &ARMED))
                .and_then(|_| flag::register_usize(signal, &SIGNAL, signal as usize))
                .and_then(|_| flag::register(signal, &STOP));
        }
    });
}

/// Signals that ask a program to end.
#[cfg(not(unix))]
fn terminating() -> Vec<i32> {
    vec![SIGINT, SIGTERM]
}

/// Signals that ask a program to end. That the terminal was closed is none if it was started to
/// outlive that, as by `nohup`.
#[cfg(unix)]
fn terminating() -> Vec<i32> {
    use signal_hook::consts::signal::SIGHUP;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    let outlives = ignored.is_some_and(|mask| mask >> (SIGHUP - 1) & 1 == 1);
    if outlives { vec![SIGINT, SIGTERM] } else { vec![SIGINT, SIGTERM, SIGHUP] }
}

/// What stops a render.
pub(super) fn stop() -> &'static AtomicBool {
    &STOP
}

/// Ends a pause. The code to exit with if it is none, but a signal came.
pub(super) fn go_on() -> Option<u8> {
    // In this order: a signal that comes in between sets both again.
    STOP.store(false, Ordering::SeqCst);
    let code = received();
    STOP.fetch_or(code.is_some(), Ordering::SeqCst);
    code
}

/// Ends [`catch`]: from now on any signal ends the program at once, for there is nothing to save, or the
/// program waits for someone else. Returns the exit code that a signal asks for which came before.
pub(super) fn release() -> Option<u8> {
    ARMED.store(true, Ordering::SeqCst);
    received()
}

/// The exit code that a signal asks for, if one came.
pub(super) fn received() -> Option<u8> {
    let signal = SIGNAL.load(Ordering::SeqCst);
    (signal != 0).then_some(ENDED + signal as u8)
}

/// Has files that grow beyond the limit of the process (`ulimit -f`) fail, as on a full disk,
/// instead of ending the program.
pub(super) fn survive_large_files() {
    #[cfg(unix)]
    {
        static SEEN: AtomicBool = AtomicBool::new(false);
        // Without a handler, the signal ends the program as before.
        let _ = flag::register(signal_hook::consts::signal::SIGXFSZ, &SEEN);
    }
}
