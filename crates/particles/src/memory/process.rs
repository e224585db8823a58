//! Limits that a shell or a job sets for a process: `ulimit -v` and `ulimit -d`.
//!
//! They count reserved memory, including the stacks of threads, whether or not it is written to. An
//! allocation beyond them aborts the program, so they are checked before.

use super::{Bound, Left};
use std::fs;

/// Returns a number of bytes in `/proc/self/status` by its key, with the colon; `None` if it is missing.
pub(super) fn status(key: &str) -> Option<u64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix(key))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes << 10)
}

/// Returns whether the process has any such limit.
pub(super) fn is_limited() -> bool {
    limits().next().is_some()
}

/// Returns the bytes that each limit leaves.
pub(super) fn left() -> impl Iterator<Item = Left> {
    limits().filter_map(|(bound, limit)| {
        let key = if bound == Bound::Data { "VmData:" } else { "VmSize:" };
        Some(Left { bytes: limit.saturating_sub(status(key)?), bound })
    })
}

/// Returns the limits that are set, in bytes.
#[cfg(target_os = "linux")]
fn limits() -> impl Iterator<Item = (Bound, u64)> {
    use rustix::process::{Resource, getrlimit};
    [(Bound::AddressSpace, Resource::As), (Bound::Data, Resource::Data)]
        .into_iter()
        .filter_map(|(bound, resource)| Some((bound, getrlimit(resource).current?)))
}

/// Returns nothing: other systems don't report how much of a limit is used.
#[cfg(not(target_os = "linux"))]
fn limits() -> impl Iterator<Item = (Bound, u64)> {
    std::iter::empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn the_size_of_this_process_is_known() {
        let column = vec![1_u8; 1 << 27];
        for key in ["VmSize:", "VmData:", "VmHWM:"] {
            assert!(status(key).is_some_and(|bytes| bytes > column.len() as u64), "{key}");
        }
        assert_eq!(status("VmNothing:"), None);
    }
}
