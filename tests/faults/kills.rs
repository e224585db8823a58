//! Renders that are killed, again and again, at random and while they write.

use crate::folder::Folder;
use crate::process::{names, samples, start};
use crate::seed;
use spherule::image::Image;
use spherule::sampling::mix;
use std::fs;
use std::os::unix::fs::MetadataExt;
use std::process::Child;
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Kills at least, and seconds for which it goes on; both end it.
const KILLS: u32 = 200;

/// Longest life of a program that may do nothing, in milliseconds.
const LIFE: u64 = 60;

/// Longest time from a moment to a kill, in microseconds: in it, checkpoints are begun and written.
const PAUSE: u64 = 6000;

const KEPT: &str = "render.checkpoint";

/// Renders, each of a second or so: plain, to an error, with statistics.
const RENDERS: [&[&str]; 3] = [
    &["--size", "96x64", "--spp", "160", "-o", "a.png"],
    &["--size", "96x64", "--until-error", "8%", "-o", "a.ppm"],
    &["--size", "64x48", "--spp", "48", "--layers", "variance,samples", "-o", "a.exr"],
];

/// What is random, as a function of the kills so far.
struct Chance(u64);

impl Chance {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 = mix(self.0.wrapping_add(1));
        self.0 % limit
    }
}

#[test]
fn killed_renders_come_to_the_same_bytes() {
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

/// Kills a render until it is through, and says how often.
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
        let child = start(&folder, &[&["render"], &args[..]].concat());
        if !kill(child, &folder, chance) {
            break;
        }
        kills += 1;
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
    // What killed programs left is gone, but for what a kill in the last moment left of the picture.
    let left: Vec<_> = names(&folder);
    let own = |name: &&String| !name.starts_with(&format!(".{output}-"));
    assert_eq!(left.iter().filter(own).collect::<Vec<_>>(), [output, KEPT]);
    kills
}

/// Kills a program at some moment; false if it came to its end before.
fn kill(mut child: Child, folder: &Folder, chance: &mut Chance) -> bool {
    let mut moment = Moment::any(folder, chance);
    while !moment.has_come(folder) {
        if let Some(status) = child.try_wait().expect("a program") {
            assert!(status.success(), "{status}");
            return false;
        }
        // On a machine that is busy, whoever only looks on is in the way.
        sleep(Duration::from_micros(200));
    }
    sleep(Duration::from_micros(chance.below(PAUSE)));
    child.kill().expect("a program that can be killed");
    !child.wait().expect("a program that ends").success()
}

/// When a program is killed.
enum Moment {
    /// After some time, which may be before it does anything.
    At(Instant),
    /// When a checkpoint was replaced so often: the first number is that of the last one. The next one
    /// is begun two milliseconds later, and nobody sees it before it takes the place of the last.
    After(Option<u64>, u64),
}

impl Moment {
    /// Most checkpoints in a life: however busy the machine is, a few lives come to an end.
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

/// Whether the checkpoint was replaced as often as is left.
fn replaced(folder: &Folder, last: &mut Option<u64>, left: &mut u64) -> bool {
    let now = number_of(folder);
    if *left > 0 && now != *last {
        (*last, *left) = (now, *left - 1);
    }
    *left == 0
}

/// What the system calls the file of the checkpoint.
fn number_of(folder: &Folder) -> Option<u64> {
    fs::metadata(folder.path(KEPT)).map(|file| file.ino()).ok()
}
