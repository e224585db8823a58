//! Files that a command reads and writes, checked for conflicts before the work begins.
//!
//! An output never replaces an input or another output: files are compared by their identity, not by
//! their names ([`FileIdentity`]). Files that are in the way only because of an earlier run are replaced, as
//! usual.

use super::failure::Failure;
use super::options::particles::ParticleArgs;
use spherule_render::atomic::FileIdentity;
use spherule_render::scene;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::path::{Path, PathBuf};

/// Name of standard input and standard output among files.
pub(super) const STREAM: &str = "-";

/// Files that a command reads and writes.
#[derive(Clone, Debug)]
pub(super) struct Files {
    command: &'static str,
    uses: Vec<FileUse>,
}

/// A file of a command.
#[derive(Clone, Debug)]
struct FileUse {
    /// The option of an output, as in `--output`, or a description of an input, as in `the scene`.
    name: String,
    path: PathBuf,
    access: Access,
    identity: Option<FileIdentity>,
}

/// Access of a command to a file. A checkpoint that is resumed into itself is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Access {
    Read,
    Write,
}

impl Files {
    /// Creates the list, with standard output if it goes to a file.
    pub(super) fn new(command: &'static str) -> Self {
        let mut files = Self { command, uses: Vec::new() };
        files.add("standard output", Path::new(STREAM), Access::Write, streams::output());
        files
    }

    /// Adds an input; `-` is standard input. `name` describes it, as in `the particle file`.
    pub(super) fn reads(&mut self, name: &str, path: &Path) {
        let identity = if path == Path::new(STREAM) { streams::input() } else { identity(path) };
        self.add(name, path, Access::Read, identity);
    }

    /// Adds a scene or a particle file, and the files that a scene names.
    pub(super) fn reads_scene(&mut self, path: &Path) {
        if !super::source::is_scene(path) {
            return self.reads("the particle file", path);
        }
        self.reads("the scene", path);
        let name = format!("which the scene {} reads", path.display());
        for file in scene::included_files(path) {
            self.reads(&name, &file);
        }
    }

    /// Adds a file of particles or a scene, and the topology of a trajectory.
    pub(super) fn reads_particles(&mut self, path: &Path, args: &ParticleArgs) {
        self.reads_scene(path);
        if let Some(topology) = args.topology() {
            self.reads("the topology", topology);
        }
    }

    /// Adds an output. `option` is the option that names it, as in `--output`. What is called `-` goes to
    /// standard output, which is an output already.
    pub(super) fn writes(&mut self, option: &str, path: &Path) {
        if path != Path::new(STREAM) {
            self.add(option, path, Access::Write, identity(path));
        }
    }

    /// Rejects an output that is the same file as an input or another output.
    pub(super) fn check(&self) -> Result<(), Failure> {
        let mut known: HashMap<&FileIdentity, &FileUse> = HashMap::new();
        let outputs = self.uses.iter().filter(|file| file.access == Access::Write);
        for file in outputs.chain(self.uses.iter().filter(|file| file.access == Access::Read)) {
            let Some(identity) = &file.identity else { continue };
            match known.entry(identity) {
                Entry::Vacant(place) => _ = place.insert(file),
                Entry::Occupied(place) if file.access == Access::Write => {
                    return Err(self.refuse(&two_outputs(place.get(), file)));
                }
                Entry::Occupied(place) if place.get().access == Access::Write => {
                    return Err(self.refuse(&output_over_input(place.get(), file)));
                }
                // Files may be read more than once.
                Entry::Occupied(_) => (),
            }
        }
        Ok(())
    }

    /// Rejects an additional output that is the same file as one of the list.
    pub(super) fn check_output(&self, option: &str, path: &Path) -> Result<(), Failure> {
        let mut files = self.clone();
        files.writes(option, path);
        files.check()
    }

    fn add(&mut self, name: &str, path: &Path, access: Access, identity: Option<FileIdentity>) {
        let (name, path) = (name.to_owned(), path.to_owned());
        self.uses.push(FileUse { name, path, access, identity });
    }

    fn refuse(&self, message: &str) -> Failure {
        Failure::usage(self.command, message)
    }
}

impl FileUse {
    fn is_stream(&self) -> bool {
        self.path == Path::new(STREAM)
    }
}

fn two_outputs(first: &FileUse, second: &FileUse) -> String {
    let (name, path) = (&second.name, second.path.display());
    if first.is_stream() {
        return format!(
            "standard output goes to {path}, which {name} replaces; give one of them another file"
        );
    }
    let (other, other_path) = (&first.name, first.path.display());
    format!(
        "{other} {other_path} and {name} {path} are the same file; give one of them another name"
    )
}

fn output_over_input(output: &FileUse, input: &FileUse) -> String {
    let (input_name, input_path) = (&input.name, input.path.display());
    if output.is_stream() {
        return format!("standard output goes to {input_path}, {input_name}; give it another file");
    }
    let (name, path) = (&output.name, output.path.display());
    if input.is_stream() {
        return format!(
            "{name} {path} would replace the file that standard input comes from; give {name} \
             another name"
        );
    }
    format!("{name} {path} would replace {input_path}, {input_name}; give {name} another name")
}

/// Identity of a file; `None` also on errors, which are reported when the file is opened.
fn identity(path: &Path) -> Option<FileIdentity> {
    FileIdentity::of(path).ok().flatten()
}

#[cfg(unix)]
mod streams {
    use spherule_render::atomic::FileIdentity;
    use std::fs::File;
    use std::io::{stdin, stdout};
    use std::os::fd::AsFd;

    pub(super) fn input() -> Option<FileIdentity> {
        of(stdin())
    }

    pub(super) fn output() -> Option<FileIdentity> {
        of(stdout())
    }

    fn of(stream: impl AsFd) -> Option<FileIdentity> {
        let file = File::from(stream.as_fd().try_clone_to_owned().ok()?);
        FileIdentity::of_open(&file).ok().flatten()
    }
}

#[cfg(not(unix))]
mod streams {
    use spherule_render::atomic::FileIdentity;

    pub(super) fn input() -> Option<FileIdentity> {
        None
    }

    pub(super) fn output() -> Option<FileIdentity> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    fn refused(files: &Files) -> Option<String> {
        files.check().err().map(|failure| failure.to_string())
    }

    #[test]
    fn outputs_differ_from_inputs_and_each_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        fs::write(path("sky.exr"), "").unwrap();
        fs::write(path("a.toml"), "[environment]\nkind = \"picture\"\nfile = \"sky.exr\"\n")
            .unwrap();
        let files = |outputs: &[(&str, &str)]| {
            let mut files = Files::new("render");
            files.reads_scene(&path("a.toml"));
            for (option, name) in outputs {
                files.writes(option, &path(name));
            }
            files
        };
        let other = ("--color-bar", "b.png");
        assert_eq!(refused(&files(&[("--output", "a.png"), other])), None);
        let twice = refused(&files(&[("--output", "./b.png"), other])).unwrap();
        assert!(twice.contains("--output") && twice.contains("--color-bar"), "{twice}");
        for input in ["sky.exr", "a.toml"] {
            let over = refused(&files(&[other, ("--output", input)])).unwrap();
            assert!(over.contains("--output") && over.contains(input), "{over}");
        }
    }

    #[test]
    fn inputs_may_be_read_twice_and_devices_written_twice() {
        let folder = tempfile::tempdir().unwrap();
        let mut files = Files::new("compare");
        files.reads("the picture", &folder.path().join("a.png"));
        files.reads("the reference", &folder.path().join("a.png"));
        if cfg!(unix) {
            files.writes("--csv", Path::new("/dev/null"));
            files.writes("--plot", Path::new("/dev/null"));
        }
        assert_eq!(refused(&files), None);
    }
}
