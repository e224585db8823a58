//! Renders that are killed repeatedly, at random times and while they write.

use crate::folder::Folder;
use crate::long::{names, samples, start};
use crate::process::{Process, wait_for};
use crate::seed;
use spherule_render::image::Image;
use spherule_render::sampling::mix;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Minimum number of kills and seconds of the test, both of which must be reached.
const KILLS: u32 = 60;

/// Maximum number of kills until a render of about a second is complete.
const MOST_KILLS: u32 = 1000;

/// Maximum time until a kill that may precede all work, in milliseconds.
const LIFE: u64 = 60;

/// Maximum delay from a checkpoint to a kill, in microseconds, in which further checkpoints are written.
const PAUSE: u64 = 6000;

const KEPT: &str = "render.checkpoint";

/// Renders of about a second: plain, to an error, with statistics.
const RENDERS: [&[&str]; 3] = [
    &["--size", "96x64", "--spp", "160", "-o", "a.png"],
    &["--size", "96x64", "--until-error", "8%", "-o", "a.ppm"],
    &["--size", "64x48", "--spp", "48", "--layers", "variance,samples", "-o", "a.exr"],
];

/// A random number generator, seeded by the number of kills so far.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = mix(self.0.wrapping_add(1));
        self.0 % limit
    }
}

#[test]
fn killed_renders_resume_to_the_same_bytes() {
    let mut chance = Chance(seed::seed("SPHERULE_FAULT_SEED"));
    let longer = Duration::from_secs(seed::number("SPHERULE_FAULT_SECONDS").unwrap_or(0));
    let (begin, mut kills) = (Instant::now(), 0);
    for round in 0.. {
        kills += kill_through(RENDERS[round % RENDERS.len()], &mut chance);
        if round + 1 >= RENDERS.len() && kills >= KILLS && begin.elapsed() >= longer {
            break;
        }
    }
}

/// Kills and resumes a render until it completes, and returns the number of kills.
fn kill_through(render: &[&str], chance: &mut Chance) -> u32 {
    let folder = Folder::new();
    let output = *render.last().expect("a name");
    let straight = [&["render", "--quiet"], render].concat();
    folder.succeed(&straight);
    let expected = folder.read(output);
    fs::remove_file(folder.path(output)).expect("a picture");
    let (mut kills, mut least) = (0, 0);
    loop {
        let threads = format!("--threads={}", 1 + chance.below(3));
        let kept = folder.path(KEPT).exists();
        let begun = ["--resume", KEPT, "--quiet", "--checkpoint-every=2ms", &threads];
        let fresh = ["--checkpoint", KEPT, "--checkpoint-every=2ms", &threads];
        let args = if kept { begun.to_vec() } else { [&straight[1..], &fresh].concat() };
        let process = start(&folder, &[&["render"], &args[..]].concat());
        if !kill(process, &folder, chance) {
            break;
        }
        kills += 1;
        assert!(kills < MOST_KILLS, "{render:?} does not go on");
        if folder.path(KEPT).exists() {
            let now = samples(&folder.path(KEPT));
            assert!(now >= least, "{now} samples after {least}");
            least = now;
        }
        if folder.path(output).exists() {
            Image::read(folder.path(output)).expect("a picture that is whole");
        }
    }
    assert!(folder.read(output) == expected, "{render:?}: other bytes after {kills} kills");
    // Temporary files of killed programs are removed, except one of the image after a kill at the end.
    let left: Vec<_> = names(&folder);
    let own = |name: &&String| !name.starts_with(&format!(".{output}-"));
    assert_eq!(left.iter().filter(own).collect::<Vec<_>>(), [output, KEPT]);
    kills
}

/// Kills a program at some moment; returns false if it ended before.
fn kill(mut process: Process, folder: &Folder, chance: &mut Chance) -> bool {
    let mut moment = Moment::any(folder, chance);
    let mut status = None;
    wait_for("a checkpoint or the end of the render", || {
        status = process.status();
        status.is_some() || moment.has_come(folder)
    });
    if let Some(status) = status {
        assert!(status.success(), "{status}");
        return false;
    }
    sleep(Duration::from_micros(chance.below(PAUSE)));
    !process.kill().success()
}

/// The moment at which a program is killed.
enum Moment {
    /// At a time, which may precede all work.
    At(Instant),
    /// After a number of replacements of the checkpoint, with the file number of the last one. Writing of the
    /// next one starts two milliseconds later, in an unnamed file until it replaces the last one.
    After(Option<u64>, u64),
}

impl Moment {
    /// Maximum number of checkpoints before a kill, so that some renders complete on a busy machine.
    const MOST: u64 = 6;

    fn any(folder: &Folder, chance: &mut Chance) -> Self {
        let (last, count) = (number_of(folder), chance.below(Self::MOST));
        match chance.below(8) {
            0 => Self::At(Instant::now() + Duration::from_millis(chance.below(LIFE))),
            _ => Self::After(last, count),
        }
    }

    fn has_come(&mut self, folder: &Folder) -> bool {
        match self {
            Self::At(moment) => Instant::now() >= *moment,
            Self::After(last, left) => replaced(folder, last, left),
        }
    }
}

/// Returns whether the remaining number of replacements has been reached.
fn replaced(folder: &Folder, last: &mut Option<u64>, left: &mut u64) -> bool {
    let now = number_of(folder);
    if *left > 0 && now != *last {
        (*last, *left) = (now, *left - 1);
    }
    *left == 0
}

/// Returns the system's number of the checkpoint's file.
fn number_of(folder: &Folder) -> Option<u64> {
    fs::metadata(folder.path(KEPT)).map(|file| file.ino()).ok()
}
