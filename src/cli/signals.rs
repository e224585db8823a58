//! Handling of Ctrl-C and termination signals.

use signal_hook::consts::signal::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Set to stop a render: by a signal, or for a pause.
static STOP: AtomicBool = AtomicBool::new(false);

/// The first signal received; 0 for none.
static SIGNAL: AtomicUsize = AtomicUsize::new(0);

/// True if the next signal ends the program at once: after the first one, and while there is nothing to save.
static ARMED: AtomicBool = AtomicBool::new(false);

/// Registers the handlers.
static ONCE: std::sync::Once = std::sync::Once::new();

/// Base of a shell's exit code for a process ended by a signal.
const ENDED: u8 = 128;

/// Catches termination signals until [`release`]: the first one sets [`stop`], the second one ends the
/// program at once.
///
/// Before the first call, signals end the program as usual, because there is no image to save yet.
pub(super) fn catch() {
    ARMED.store(false, Ordering::SeqCst);
    // The order matters: a signal in between sets it again.
    ARMED.fetch_or(SIGNAL.load(Ordering::SeqCst) != 0, Ordering::SeqCst);
    ONCE.call_once(|| {
        for signal in terminating() {
            // Without a handler, signals end the program as usual. The order matters: the signal is stored
            // before it stops anything.
            let _ = flag::register_conditional_shutdown(signal, i32::from(ENDED) + signal, &ARMED)
                .and_then(|_| flag::register(signal, &ARMED))
                .and_then(|_| flag::register_usize(signal, &SIGNAL, signal as usize))
                .and_then(|_| flag::register(signal, &STOP));
        }
    });
}

/// Termination signals.
#[cfg(not(unix))]
fn terminating() -> Vec<i32> {
    vec![SIGINT, SIGTERM]
}

/// Termination signals. SIGHUP is not one of them if the program was started to ignore it, as by `nohup`.
#[cfg(unix)]
fn terminating() -> Vec<i32> {
    use signal_hook::consts::signal::SIGHUP;
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    let outlives = ignored.is_some_and(|mask| mask >> (SIGHUP - 1) & 1 == 1);
    if outlives { vec![SIGINT, SIGTERM] } else { vec![SIGINT, SIGTERM, SIGHUP] }
}

/// Returns the flag that stops a render.
pub(super) fn stop() -> &'static AtomicBool {
    &STOP
}

/// Ends a pause. Returns the exit code if the stop was not a pause but a signal.
pub(super) fn end_pause() -> Option<u8> {
    // The order matters: a signal in between sets both again.
    STOP.store(false, Ordering::SeqCst);
    let code = received();
    STOP.fetch_or(code.is_some(), Ordering::SeqCst);
    code
}

/// Ends [`catch`]: from now on any signal ends the program at once. Returns the exit code of a signal
/// received before.
pub(super) fn release() -> Option<u8> {
    ARMED.store(true, Ordering::SeqCst);
    received()
}

/// Returns the exit code for a received signal.
pub(super) fn received() -> Option<u8> {
    let signal = SIGNAL.load(Ordering::SeqCst);
    (signal != 0).then_some(ENDED + signal as u8)
}

/// Turns SIGXFSZ off: writing beyond the process's file size limit (`ulimit -f`) fails as on a full disk,
/// instead of ending the program.
pub(super) fn survive_large_files() {
    #[cfg(unix)]
    {
        static SEEN: AtomicBool = AtomicBool::new(false);
        // Without a handler, the signal ends the program as usual.
        let _ = flag::register(signal_hook::consts::signal::SIGXFSZ, &SEEN);
    }
}
