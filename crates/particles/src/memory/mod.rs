//! Checks that enough memory is available before a large allocation.
//!
//! Operating systems overcommit memory and kill programs that use it. So everything that may take
//! gigabytes (columns of spheres, the world with its tree, the film's sums, images) is first compared
//! with the memory that the system, its control groups and the user leave. If it doesn't fit, the user
//! gets an error message.

mod group;
mod process;

use std::fmt;
use std::io::{self, Read};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use sysinfo::{MemoryRefreshKind, ProcessRefreshKind, ProcessesToUpdate, System};

/// Allocations up to this size are not checked: every machine has it, and the check takes longer.
const SMALL: u64 = 1 << 26;

/// Maximum number of bytes that this process may use.
static LIMIT: AtomicU64 = AtomicU64::new(u64::MAX);

/// Error: not enough memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} of memory, where {}", Size(*.need), Available(*.left))]
pub struct Shortage {
    /// Bytes that are needed.
    pub need: u64,
    /// Available memory; `None` if it is unknown but the allocation failed.
    pub left: Option<Left>,
}

/// Available memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Left {
    /// Amount in bytes.
    pub bytes: u64,
    /// The limit that it comes from.
    pub bound: Bound,
}

/// The limit that bounds the memory of a process.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// The memory of the machine, minus what is in use.
    Machine,
    /// The limit of its container or of its job, version 1 or 2 of control groups.
    ControlGroup,
    /// The limit of [`limit_to`].
    Limit,
    /// The limit of the process's virtual memory (`RLIMIT_AS`, `ulimit -v`).
    AddressSpace,
    /// The limit of the process's data (`RLIMIT_DATA`, `ulimit -d`).
    Data,
}

impl Bound {
    /// Returns whether reserved memory counts, not only written pages.
    fn counts_reserved(self) -> bool {
        matches!(self, Self::AddressSpace | Self::Data)
    }
}

/// Limits the memory of this process to `bytes`. Allocations that grow with the input are checked
/// against it.
pub fn limit_to(bytes: u64) {
    LIMIT.store(bytes, Ordering::Relaxed);
}

/// Returns the memory that this process can allocate without swapping; `None` if it is unknown.
pub fn left() -> Option<Left> {
    bounds().min_by_key(|left| left.bytes)
}

/// Returns the memory that each limit leaves to this process.
fn bounds() -> impl Iterator<Item = Left> {
    let mut system = System::new();
    system.refresh_memory_specifics(MemoryRefreshKind::nothing().with_ram());
    let machine = Some(system.available_memory()).filter(|&bytes| bytes > 0);
    let limit = Some(LIMIT.load(Ordering::Relaxed)).filter(|&limit| limit < u64::MAX);
    let bounds = [
        (Bound::Machine, machine),
        (Bound::ControlGroup, group::left(Path::new("/"))),
        (Bound::Limit, limit.map(|limit| limit.saturating_sub(taken(&mut system)))),
    ];
    let left = bounds.into_iter().filter_map(|(bound, bytes)| Some(Left { bytes: bytes?, bound }));
    left.chain(process::left())
}

/// Returns the resident memory of this process in bytes; 0 if it is unknown.
pub fn resident() -> u64 {
    taken(&mut System::new())
}

/// Returns the resident memory of this process in bytes; 0 if it is unknown.
fn taken(system: &mut System) -> u64 {
    let Ok(process) = sysinfo::get_current_pid() else { return 0 };
    let memory = ProcessRefreshKind::nothing().with_memory().without_tasks();
    system.refresh_processes_specifics(ProcessesToUpdate::Some(&[process]), false, memory);
    system.process(process).map_or(0, sysinfo::Process::memory)
}

/// Returns the peak memory of this process in bytes; `None` if it is unknown.
pub fn peak() -> Option<u64> {
    // Linux calls it the high-water mark.
    process::status("VmHWM:")
}

/// Checks that `need` more bytes are available.
///
/// # Errors
/// Fewer bytes are available.
pub fn check(need: u64) -> Result<(), Shortage> {
    check_growth(need, need)
}

/// Checks that `need` more bytes are available for growing columns, which reserve `reserve` more bytes
/// at once when they are reallocated.
///
/// # Errors
/// Fewer bytes are available.
pub(crate) fn check_growth(need: u64, reserve: u64) -> Result<(), Shortage> {
    let limited = LIMIT.load(Ordering::Relaxed) < u64::MAX || process::is_limited();
    if need.max(reserve) <= SMALL && !limited {
        return Ok(());
    }
    let needed = |bound: Bound| if bound.counts_reserved() { reserve } else { need };
    let bounds: Vec<Left> = bounds().collect();
    let exceeded = bounds.iter().filter(|left| needed(left.bound) > left.bytes);
    if let Some(left) = exceeded.copied().min_by_key(|left| left.bytes) {
        return Err(Shortage { need: needed(left.bound), left: Some(left) });
    }
    if reservable(reserve) {
        return Ok(());
    }
    let left = bounds.into_iter().min_by_key(|left| left.bytes);
    Err(Shortage { need: reserve, left })
}

/// Reads a reader to its end, up to a limit in bytes.
///
/// # Errors
/// There are more bytes than that, or they cannot be read.
pub fn read_at_most(reader: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 <= limit {
        return Ok(bytes);
    }
    let message = format!("it is longer than {}", Size(limit));
    Err(io::Error::new(io::ErrorKind::FileTooLarge, message))
}

/// Returns whether an allocation of `need` bytes would succeed: systems without overcommitment report
/// their limit in no other way.
fn reservable(need: u64) -> bool {
    let probe = |bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok();
    usize::try_from(need).is_ok_and(probe)
}

/// A human-readable number of bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub u64);

impl fmt::Display for Size {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let bytes = self.0 as f64;
        let units = [("GB", 1e9), ("MB", 1e6)];
        match units.into_iter().find(|(_, unit)| bytes >= *unit) {
            Some((name, unit)) => write!(formatter, "{:.1} {name}", bytes / unit),
            None => write!(formatter, "{bytes} bytes"),
        }
    }
}

struct Available(Option<Left>);

impl fmt::Display for Available {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some(left) = self.0 else { return formatter.write_str("less is left") };
        let of = match left.bound {
            Bound::Machine => "",
            Bound::ControlGroup => " in the control group",
            Bound::Limit => " of the memory limit",
            Bound::AddressSpace => " of the limit of virtual memory (ulimit -v)",
            Bound::Data => " of the limit of the process's data (ulimit -d)",
        };
        match left.bytes {
            0 => write!(formatter, "none is left{of}"),
            bytes => write!(formatter, "{} are left{of}", Size(bytes)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_amounts_are_always_available_and_absurd_ones_never() {
        assert_eq!(check(0), Ok(()));
        assert_eq!(check(SMALL), Ok(()));
        for need in [1 << 60, u64::MAX] {
            assert!(check(need).is_err_and(|shortage| shortage.need == need));
        }
        assert!(reservable(SMALL) && !reservable(u64::MAX));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn remaining_memory_is_the_limit() {
        let left = left().expect("Linux tells").bytes;
        // Other processes may allocate or free some in between.
        assert!(check(left / 2).is_ok());
        assert!(check(left.saturating_mul(2)).is_err());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_grows_with_allocations() {
        let before = peak().expect("Linux tells");
        let held = vec![1_u8; before as usize + (1 << 20)];
        assert!(peak().is_some_and(|peak| peak >= held.len() as u64));
    }

    #[test]
    fn readers_are_read_up_to_the_limit() {
        assert_eq!(read_at_most(&b"abc"[..], 3).expect("not too long"), b"abc");
        assert!(read_at_most(&b"abcd"[..], 3).is_err());
        let message = read_at_most(io::repeat(0), 2_000_000).map_err(|error| error.to_string());
        assert_eq!(message, Err("it is longer than 2.0 MB".to_owned()));
    }

    #[test]
    fn shortages_state_both_amounts() {
        let message = |bytes, bound| {
            let left = Some(Left { bytes, bound });
            Shortage { need: 192_000_000_000, left }.to_string()
        };
        let machine = message(22_460_000_000, Bound::Machine);
        assert_eq!(machine, "192.0 GB of memory, where 22.5 GB are left");
        let group = message(22_460_000_000, Bound::ControlGroup);
        assert_eq!(group, machine.clone() + " in the control group");
        assert_eq!(message(22_460_000_000, Bound::Limit), machine + " of the memory limit");
        assert_eq!(
            message(0, Bound::Limit),
            "192.0 GB of memory, where none is left of the memory limit"
        );
        let space = message(22_460_000_000, Bound::AddressSpace);
        assert!(space.ends_with("22.5 GB are left of the limit of virtual memory (ulimit -v)"));
        assert!(message(1, Bound::Data).contains("(ulimit -d)"));
        let unknown = Shortage { need: 1_500_000, left: None };
        assert_eq!(unknown.to_string(), "1.5 MB of memory, where less is left");
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_memory_of_this_process_is_known() {
        let column = vec![1_u8; 1 << 27];
        let bytes = taken(&mut System::new());
        assert!(bytes > column.len() as u64 && bytes < 1 << 40, "{bytes}");
    }
}
