//! Memory limits of control groups: containers and cluster jobs may use only part of the machine's memory.
//!
//! Groups are nested and of version 1 or 2. Each may have a limit; the one that leaves the least memory
//! counts (Linux, "Documentation/admin-guide/cgroup-v2.rst" and "cgroup-v1/memory").

use std::fs;
use std::path::{Path, PathBuf};

/// File names of a version of control groups.
struct Version {
    /// Controller name in the list of a process's groups.
    controller: &'static str,
    limit: &'static str,
    used: &'static str,
    /// Keys of `memory.stat`: file cache, and shared memory, the part of it that cannot be reclaimed.
    cached: &'static str,
    shared: &'static str,
}

const FIRST: Version = Version {
    controller: "memory",
    limit: "memory.limit_in_bytes",
    used: "memory.usage_in_bytes",
    cached: "total_cache",
    shared: "total_shmem",
};

const SECOND: Version = Version {
    controller: "",
    limit: "memory.max",
    used: "memory.current",
    cached: "file",
    shared: "shmem",
};

/// Returns the bytes that this process can still allocate within the limits of its control groups;
/// `None` if there are no limits. `root` is the root of the file system.
pub(super) fn left(root: &Path) -> Option<u64> {
    let mounts = fs::read_to_string(root.join("proc/self/mountinfo")).ok()?;
    let groups = fs::read_to_string(root.join("proc/self/cgroup")).ok()?;
    let mounts = mounts.lines().filter_map(Mount::read);
    mounts.filter_map(|mount| mount.left(root, mount.group(&groups)?)).min()
}

/// Mount point of control groups.
struct Mount {
    version: &'static Version,
    /// Group that is mounted at `folder`.
    top: PathBuf,
    folder: PathBuf,
}

impl Mount {
    /// Parses a line of `mountinfo`: the fourth field is the mounted root, the fifth the mount point.
    /// The file system type follows a dash, and its options end the line.
    fn read(line: &str) -> Option<Self> {
        let (place, kind) = line.split_once(" - ")?;
        let mut place = place.split(' ').skip(3);
        let (top, folder) = (place.next()?.into(), place.next()?.into());
        let mut kind = kind.split(' ');
        let version = match (kind.next()?, kind.next_back()?) {
            ("cgroup2", _) => &SECOND,
            ("cgroup", options) if options.split(',').any(|option| option == "memory") => &FIRST,
            _ => return None,
        };
        Some(Self { version, top, folder })
    }

    /// Returns the group of this process from the lines of `/proc/self/cgroup`: a number, controllers,
    /// the group.
    fn group<'a>(&self, lines: &'a str) -> Option<&'a Path> {
        lines.lines().find_map(|line| {
            let mut fields = line.splitn(3, ':').skip(1);
            let (controllers, group) = (fields.next()?, fields.next()?);
            let mine = controllers.split(',').any(|name| name == self.version.controller);
            mine.then_some(Path::new(group))
        })
    }

    /// Returns the memory left by the group and its visible ancestors.
    fn left(&self, root: &Path, group: &Path) -> Option<u64> {
        let relative = |path: &Path| path.strip_prefix("/").unwrap_or(path).to_owned();
        let top = root.join(relative(&self.folder));
        // Within a container, the group may have its name on the host.
        let inside = group.strip_prefix(&self.top).map_or_else(|_| PathBuf::new(), relative);
        inside.ancestors().filter_map(|part| self.version.left(&top.join(part))).min()
    }
}

impl Version {
    /// Returns the memory left in one group: its limit minus its usage, without cached files.
    fn left(&self, folder: &Path) -> Option<u64> {
        let number = |name: &str| fs::read_to_string(folder.join(name)).ok()?.trim().parse().ok();
        let (limit, used): (u64, u64) = (number(self.limit)?, number(self.used)?);
        let statistics = fs::read_to_string(folder.join("memory.stat")).unwrap_or_default();
        let known = |key: &str| {
            let value = |line: &str| line.strip_prefix(key)?.strip_prefix(' ')?.parse().ok();
            statistics.lines().find_map(value).unwrap_or(0_u64)
        };
        let given_up = known(self.cached).saturating_sub(known(self.shared));
        Some(limit.saturating_sub(used.saturating_sub(given_up)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tempfile::TempDir;

    const MOUNTS: &str = "\
31 23 0:28 / /sys/fs/cgroup rw,relatime - tmpfs tmpfs rw,mode=755
32 31 0:29 / /sys/fs/cgroup/cpu rw,relatime shared:4 - cgroup cgroup rw,cpu
35 31 0:32 / /sys/fs/cgroup/memory rw,relatime - cgroup cgroup rw,memory
41 31 0:38 / /sys/fs/cgroup/unified rw,relatime - cgroup2 cgroup2 rw,nsdelegate
";

    fn machine(files: &[(&str, &str)]) -> TempDir {
        let root = tempfile::tempdir().expect("a folder");
        for (path, text) in files {
            let path = root.path().join(path);
            fs::create_dir_all(path.parent().expect("a folder")).expect("it can be made");
            fs::write(path, text).expect("it can be written");
        }
        root
    }

    #[test]
    fn the_tightest_of_nested_groups_counts() {
        let job = "sys/fs/cgroup/unified/slurm/job_7";
        let root = machine(&[
            ("proc/self/mountinfo", MOUNTS),
            ("proc/self/cgroup", "4:memory:/\n0::/slurm/job_7/step_0\n"),
            (&format!("{job}/step_0/memory.max"), "max\n"),
            (&format!("{job}/step_0/memory.current"), "100\n"),
            (&format!("{job}/memory.max"), "5000\n"),
            (&format!("{job}/memory.current"), "1100\n"),
            (&format!("{job}/memory.stat"), "anon 100\nfile 1000\nshmem 200\nfile_mapped 7\n"),
            ("sys/fs/cgroup/unified/slurm/memory.max", "9000\n"),
            ("sys/fs/cgroup/unified/slurm/memory.current", "1000\n"),
        ]);
        // 800 of 1100 used bytes are file cache that can be reclaimed.
        assert_eq!(left(root.path()), Some(4700));
    }

    #[test]
    fn the_first_version_is_supported() {
        let memory = "sys/fs/cgroup/memory";
        let root = machine(&[
            ("proc/self/mountinfo", MOUNTS),
            ("proc/self/cgroup", "4:cpu,cpuacct:/other\n3:memory:/a\n0::/\n"),
            (&format!("{memory}/memory.limit_in_bytes"), "9223372036854771712\n"),
            (&format!("{memory}/memory.usage_in_bytes"), "12\n"),
            (&format!("{memory}/a/memory.limit_in_bytes"), "1000\n"),
            (&format!("{memory}/a/memory.usage_in_bytes"), "1000\n"),
            (&format!("{memory}/a/memory.stat"), "cache 7\ntotal_cache 600\ntotal_shmem 0\n"),
        ]);
        assert_eq!(left(root.path()), Some(600));
    }

    #[test]
    fn containers_see_their_own_group_at_the_top() {
        let mounts = "31 23 0:28 /docker/12ab /sys/fs/cgroup ro - cgroup2 cgroup rw\n";
        for group in ["0::/docker/12ab/inner", "0::/inner", "0::/"] {
            let root = machine(&[
                ("proc/self/mountinfo", mounts),
                ("proc/self/cgroup", group),
                ("sys/fs/cgroup/memory.max", "300"),
                ("sys/fs/cgroup/memory.current", "100"),
            ]);
            assert_eq!(left(root.path()), Some(200), "{group}");
        }
    }

    #[test]
    fn groups_without_limits_have_none() {
        assert_eq!(left(machine(&[]).path()), None);
        let files =
            [("proc/self/mountinfo", MOUNTS), ("proc/self/cgroup", "0::/\nnonsense\n4:memory\n")];
        assert_eq!(left(machine(&files).path()), None);
    }
}
