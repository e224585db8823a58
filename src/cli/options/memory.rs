//! `--memory-limit`: an upper bound on memory.

use bytesize::ByteSize;
use spherule_render::memory;

/// Option that limits memory.
#[derive(Clone, Copy, Debug, clap::Args)]
pub(in crate::cli) struct MemoryArgs {
    /// Maximum memory, as in 500MB, 4GB or 4GiB; commands that would need more stop before they start
    /// [default: free memory, within the cgroup's limit]
    #[arg(long, value_name = "SIZE", allow_hyphen_values = true, value_parser = size)]
    memory_limit: Option<u64>,
}

impl MemoryArgs {
    /// Applies the limit to all later checks of memory.
    pub(in crate::cli) fn apply(self) {
        if let Some(bytes) = self.memory_limit {
            memory::limit_to(bytes);
        }
    }
}

/// Bytes.
fn size(text: &str) -> Result<u64, String> {
    let unit = text.ends_with(|last: char| last.is_ascii_alphabetic());
    let size = text.parse().ok().filter(|_| unit).map(|ByteSize(bytes)| bytes);
    size.filter(|&bytes| bytes > 0).ok_or_else(|| {
        "give a size greater than 0 with a unit, as in 500MB, 4GB (10^9 bytes) or 4GiB (2^30 bytes)"
            .to_owned()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_have_units() {
        assert_eq!(size("500MB"), Ok(500_000_000));
        assert_eq!(size("1.5 GiB"), Ok(3 << 29));
        assert_eq!(size("64kb"), Ok(64_000));
        for text in ["4", "", "0GB", "-1GB", "GB", "4XB", "NaNMB", "infGB", "1e99TB"] {
            assert!(size(text).is_err(), "{text}");
        }
    }
}
