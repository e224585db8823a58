//! Timing: contestants run in turns, and each turn is long enough for the clock's resolution.

use crate::report::Spread;
use std::time::Instant;

/// Times in seconds, by contestant and round.
#[derive(Clone, Debug, PartialEq)]
pub struct Times(Vec<Vec<f64>>);

impl Times {
    /// Runs `rounds` rounds, in each of which every contestant has one turn. `turn` gets the
    /// contestant's index and returns its time in seconds.
    ///
    /// # Errors
    /// The first error of a turn.
    pub fn measure<E>(
        rounds: u32,
        contestants: usize,
        mut turn: impl FnMut(usize) -> Result<f64, E>,
    ) -> Result<Self, E> {
        let mut times = vec![Vec::new(); contestants];
        for _ in 0..rounds.max(1) {
            for (contestant, times) in times.iter_mut().enumerate() {
                times.push(turn(contestant)?);
            }
        }
        Ok(Self(times))
    }

    /// Returns the seconds of a contestant.
    pub fn seconds(&self, contestant: usize) -> Spread {
        Spread::from_values(&self.0[contestant])
    }

    /// Returns the speedup of a contestant over another one. It is computed for each round, so that
    /// load that slows both down cancels.
    pub fn ratio(&self, contestant: usize, other: usize) -> Spread {
        let pairs = self.0[contestant].iter().zip(&self.0[other]);
        Spread::from_values(&pairs.map(|(own, other)| other / own).collect::<Vec<_>>())
    }
}

/// Repeats `run` until `least` seconds have passed, at least once. Returns the mean time of a run in
/// seconds, and the last result.
pub fn clock<T>(least: f64, mut run: impl FnMut() -> T) -> (f64, T) {
    let start = Instant::now();
    let mut runs = 1;
    let mut result = run();
    while start.elapsed().as_secs_f64() < least {
        result = run();
        runs += 1;
    }
    (start.elapsed().as_secs_f64() / f64::from(runs), result)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contestants_take_turns() {
        let mut order = Vec::new();
        let turn = |contestant| {
            order.push(contestant);
            Ok::<_, ()>((1 + contestant) as f64 * order.len() as f64)
        };
        let times = Times::measure(3, 2, turn).unwrap();
        assert_eq!(order, [0, 1, 0, 1, 0, 1]);
        assert_eq!(times.seconds(0), Spread { median: 3.0, least: 1.0, greatest: 5.0 });
        // 1 to 4, 3 to 8, 5 to 12.
        assert_eq!(times.ratio(1, 0).median, 3.0 / 8.0);
        assert_eq!(Times::measure(2, 1, |_| Err(7)), Err(7));
    }

    #[test]
    fn short_runs_are_repeated() {
        let mut runs = 0;
        let (seconds, last) = clock(0.01, || {
            runs += 1;
            runs
        });
        assert!(last > 1 && seconds > 0.0 && seconds < 0.01);
        assert_eq!(clock(0.0, || 5).1, 5);
    }
}
