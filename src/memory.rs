//! Whether there is memory for what a file or a command line asks for, before it is taken.
//!
//! Systems promise more memory than they have, and end programs that believe them. So whatever may
//! take gigabytes, spheres in their columns, the world with its tree, the sums of a film, pictures,
//! is held against what the system says is left, and refused in words if it is more.

use std::fmt;
use std::io::{self, Read};
use sysinfo::{MemoryRefreshKind, System};

/// Less than this is taken without a question: every machine has it, and asking takes longer.
const SMALL: u64 = 1 << 26;

/// More memory is needed than there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{} of memory, where {}", Size(*.need), Left(*.left))]
pub struct Shortage {
    /// Bytes that are needed.
    pub need: u64,
    /// Bytes that are left; `None` if the system does not tell, but refused them.
    pub left: Option<u64>,
}

/// Bytes that this process can still take without swapping, within the limit of its container;
/// `None` if the system does not tell.
pub fn left() -> Option<u64> {
    let mut system = System::new();
    system.refresh_memory_specifics(MemoryRefreshKind::nothing().with_ram());
    let whole = Some(system.available_memory()).filter(|&bytes| bytes > 0)?;
    // What a container has cached of files counts as used there, but is given up when needed.
    let within = system.cgroup_limits().map(|at| at.total_memory.saturating_sub(at.rss));
    Some(within.map_or(whole, |within| whole.min(within)))
}

/// Bytes of memory that this process has held at most until now; `None` if the system does not tell.
pub fn peak() -> Option<u64> {
    // What Linux calls the high-water mark, in KiB.
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kibibytes << 10)
}

/// Finds out whether `need` more bytes can be had.
///
/// # Errors
/// There are fewer.
pub fn check(need: u64) -> Result<(), Shortage> {
    if need <= SMALL {
        return Ok(());
    }
    let left = left();
    let enough = left.is_none_or(|left| need <= left) && reservable(need);
    if enough { Ok(()) } else { Err(Shortage { need, left }) }
}

/// Everything that a reader gives, up to a limit in bytes.
///
/// # Errors
/// There is more than that, or it cannot be read.
pub(crate) fn read_at_most(reader: impl Read, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    reader.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 <= limit {
        return Ok(bytes);
    }
    let message = format!("it is longer than {}", Size(limit));
    Err(io::Error::new(io::ErrorKind::FileTooLarge, message))
}

/// Whether an allocation of so many bytes would succeed: limits of the process (`ulimit -v`), and
/// systems that promise no more than they have, show in nothing else.
fn reservable(need: u64) -> bool {
    let probe = |bytes| Vec::<u8>::new().try_reserve_exact(bytes).is_ok();
    usize::try_from(need).is_ok_and(probe)
}

/// Bytes, for people.
struct Size(u64);

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

struct Left(Option<u64>);

impl fmt::Display for Left {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Some(bytes) => write!(formatter, "{} are left", Size(bytes)),
            None => formatter.write_str("less is left"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn little_is_always_there_and_absurd_amounts_never() {
        assert_eq!(check(0), Ok(()));
        assert_eq!(check(SMALL), Ok(()));
        for need in [1 << 60, u64::MAX] {
            assert!(check(need).is_err_and(|shortage| shortage.need == need));
        }
        assert!(reservable(SMALL) && !reservable(u64::MAX));
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn what_is_left_is_the_bound() {
        let left = left().expect("Linux tells");
        // Other processes may take or free some in between.
        assert!(check(left / 2).is_ok());
        assert!(check(left.saturating_mul(2)).is_err());
    }

    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_grows_with_what_is_held() {
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
    fn shortages_tell_both_amounts() {
        let shortage = Shortage { need: 192_000_000_000, left: Some(22_460_000_000) };
        assert_eq!(shortage.to_string(), "192.0 GB of memory, where 22.5 GB are left");
        let unknown = Shortage { need: 1_500_000, left: None };
        assert_eq!(unknown.to_string(), "1.5 MB of memory, where less is left");
    }
}
