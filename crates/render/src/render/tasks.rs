//! Durations of a render's tasks, and the speedup that more threads would give.

use super::schedule::{Pass, parts};
use serde::{Deserialize, Serialize};
use std::time::Duration;

/// Statistics of a render's division into tasks: a task is the work of one thread between two requests
/// for work, during which it waits for no other thread.
///
/// No thread is idle before all tasks are started (Graham, "Bounds on Multiprocessing Timing
/// Anomalies", SIAM Journal on Applied Mathematics 1969). So if the last task to end takes `d`, and
/// tasks that start after it take `a` in total, a render on `n` threads takes its work over `n` and at
/// most `d (1 - 1 / n) - a / n` longer, as far as memory bandwidth suffices. So passes are recorded by
/// about how many passes follow them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tasks {
    /// Number of tasks.
    pub count: u64,
    /// Duration of the longest task.
    pub longest: Duration,
    /// Sum of all durations.
    pub total: Duration,
    /// Longest duration of a task that is never divided, for any number of threads.
    whole: Duration,
    /// Passes by the number of passes after them: 0, 1, 2, 3 and 4, 5 and 6, 7 to 10, 11 to 14, and so
    /// on; last, all others.
    waves: [Wave; WAVES],
}

const WAVES: usize = 28;

/// Passes that are followed by similar numbers of passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
struct Wave {
    /// Longest duration of a whole pass, as if all its parts took as long as its longest.
    longest: Duration,
    total: Duration,
}

impl Wave {
    /// Returns the index of the wave of a pass that is followed by `left` others.
    fn of(left: usize) -> usize {
        let rank = left + 1;
        let octave = rank.ilog2() as usize;
        (2 * octave + (((2 * rank) >> octave) & 1)).min(WAVES - 1)
    }

    /// Returns the maximum number of passes that follow one of a wave.
    fn most(wave: usize) -> usize {
        if wave < WAVES - 1 { ((3 + wave % 2) << (wave / 2)).div_ceil(2) - 2 } else { usize::MAX }
    }
}

impl Tasks {
    /// Adds a task of a pass, or of `None` if it is never divided.
    pub(super) fn push(&mut self, time: Duration, of: Option<Pass>) {
        self.count += 1;
        self.longest = self.longest.max(time);
        self.total += time;
        let Some(Pass { left, parts }) = of else {
            self.whole = self.whole.max(time);
            return;
        };
        let wave = &mut self.waves[Wave::of(left)];
        wave.longest = wave.longest.max(time * parts);
        wave.total += time;
    }

    /// Adds the tasks of another part of the render, as if both were rendered at once.
    pub(super) fn add(&mut self, other: &Self) {
        self.count = self.count.saturating_add(other.count);
        self.longest = self.longest.max(other.longest);
        self.total = self.total.saturating_add(other.total);
        self.whole = self.whole.max(other.whole);
        for (wave, more) in self.waves.iter_mut().zip(other.waves) {
            wave.longest = wave.longest.max(more.longest);
            wave.total = wave.total.saturating_add(more.total);
        }
    }

    /// Returns all recorded times.
    pub(super) fn times(&self) -> impl Iterator<Item = Duration> {
        let waves = self.waves.into_iter().flat_map(|wave| [wave.longest, wave.total]);
        waves.chain([self.longest, self.total, self.whole])
    }

    /// Returns the minimum efficiency on this number of threads, 0..=1: speedup over threads. Passes
    /// count as divided for these threads, into parts of equal duration.
    pub fn efficiency(&self, threads: u32) -> f64 {
        let (ideal, alone) = (self.total / threads, 1.0 - 1.0 / f64::from(threads));
        let (mut after, mut late) = (Duration::ZERO, self.whole.mul_f64(alone));
        for (i, wave) in self.waves.iter().enumerate() {
            let longest = wave.longest / parts(Wave::most(i), threads as usize);
            late = late.max(longest.mul_f64(alone).saturating_sub(after / threads));
            after += wave.total;
        }
        if self.total.is_zero() { 1.0 } else { ideal.div_duration_f64(ideal + late) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tasks by the number of passes after theirs, and milliseconds.
    fn of(tasks: &[(Option<usize>, u64)]) -> Tasks {
        let mut all = Tasks::default();
        for &(left, time) in tasks {
            let pass = left.map(|left| Pass { left, parts: 1 });
            all.push(Duration::from_millis(time), pass);
        }
        all
    }

    fn near(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-9
    }

    #[test]
    fn one_long_task_bounds_the_efficiency() {
        assert_eq!(Tasks::default().efficiency(64), 1.0);
        assert_eq!(of(&[(None, 10); 100]).efficiency(1), 1.0);
        // 100 ms of work each and 9 ms more.
        assert!(near(of(&[(None, 10); 100]).efficiency(10), 100.0 / 109.0));
    }

    #[test]
    fn work_after_a_long_pass_is_for_other_threads() {
        let last = of(&[(Some(1 << 20), 990), (None, 5), (Some(0), 5)]);
        assert!(near(last.efficiency(10), 100.0 / 990.5));
        // As if both were rendered at once.
        let mut both = last;
        both.add(&last);
        assert_eq!((both.count, both.total), (6, 2 * last.total));
        assert!(near(both.efficiency(10), 200.0 / 1090.0));
    }

    #[test]
    fn the_last_passes_are_divided() {
        // Into four and into two parts, as for two threads.
        assert!(near(of(&[(Some(0), 40)]).efficiency(2), 20.0 / 25.0));
        assert!(near(of(&[(Some(9), 40)]).efficiency(2), 20.0 / 30.0));
        let mut parts = Tasks::default();
        (0..4)
            .for_each(|_| parts.push(Duration::from_millis(10), Some(Pass { left: 0, parts: 4 })));
        assert!(near(parts.efficiency(2), 20.0 / 25.0));
    }

    #[test]
    fn passes_are_in_the_right_wave() {
        for left in 0..1 << 16 {
            let wave = Wave::of(left);
            assert!(left <= Wave::most(wave), "{left}");
            assert!(wave == 0 || left > Wave::most(wave - 1), "{left}");
        }
    }
}
