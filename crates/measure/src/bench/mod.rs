//! Benchmarks of `spherule bench`.
//!
//! A measurement is a function from [`Options`] to a [`Report`](crate::report::Report). Contestants
//! run in turns ([`rounds`]), so that other load on the machine affects all of them equally. Reports
//! give the median, the minimum and the maximum. Results are compared, and a difference is an error,
//! since the time of a wrong result is meaningless.

pub mod build;
pub mod convergence;
mod error;
pub mod paper;
pub mod roulette;
pub mod rounds;
pub mod scenes;
pub mod skips;
pub mod threads;
pub mod traversal;

pub use error::BenchError;

use std::path::PathBuf;

/// Options of a measurement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// Names of scenes; empty for the measurement's default.
    pub scenes: Vec<String>,
    /// Number of turns of each contestant.
    pub rounds: u32,
    /// Maximum number of threads to compare; other measurements use the current pool.
    pub threads: usize,
    /// Folder for reference images; `None` to render them each time.
    pub references: Option<PathBuf>,
    /// Amount of work.
    pub effort: Effort,
    /// Size of the images of the paper's tables.
    pub scale: paper::Scale,
}

/// Amount of work that a measurement does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effort {
    /// About a second, for tests. The numbers are meaningless.
    Quick,
    /// About a minute.
    Usual,
    /// Full scale, without a time limit.
    Full,
}

/// A callback that receives a short description of the current measurement.
pub type Progress<'a> = &'a (dyn Fn(&str) + Sync);

impl Options {
    /// Returns the value for the effort, from `[quick, usual, full]`.
    pub fn pick<T>(&self, [quick, usual, full]: [T; 3]) -> T {
        match self.effort {
            Effort::Quick => quick,
            Effort::Usual => usual,
            Effort::Full => full,
        }
    }

    /// Returns the scenes in `all` that were given by name, in the order given; `usual` if none was.
    ///
    /// # Errors
    /// A name is unknown.
    pub fn choose<T: Clone>(
        &self,
        all: &[T],
        usual: &[T],
        name: impl Fn(&T) -> &str,
    ) -> Result<Vec<T>, BenchError> {
        if self.scenes.is_empty() {
            return Ok(usual.to_vec());
        }
        let find = |wanted: &String| {
            let unknown = || BenchError::UnknownScene {
                name: wanted.clone(),
                known: all.iter().map(&name).collect::<Vec<_>>().join(", "),
            };
            all.iter().find(|one| name(one) == wanted).cloned().ok_or_else(unknown)
        };
        self.scenes.iter().map(find).collect()
    }

    /// The options as names and values, for a report.
    pub fn settings(&self) -> Vec<(String, String)> {
        let effort = self.pick(["quick: the numbers are meaningless", "usual", "full"]);
        let scenes = if self.scenes.is_empty() { "usual" } else { &self.scenes.join(", ") };
        let pairs = [("rounds", self.rounds.to_string()), ("effort", effort.to_owned())];
        let pairs = pairs.into_iter().chain([("scenes", scenes.to_owned())]);
        pairs.map(|(name, value)| (name.to_owned(), value)).collect()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::paper::Scale;
    use super::*;

    /// Options with the least effort.
    pub(crate) fn quick(scenes: &[&str]) -> Options {
        let scenes = scenes.iter().map(|&name| name.to_owned()).collect();
        Options {
            scenes,
            rounds: 2,
            threads: 2,
            references: None,
            effort: Effort::Quick,
            scale: Scale::default(),
        }
    }

    #[test]
    fn scenes_are_chosen_by_name() {
        let all = ["a", "b", "c"];
        let choose = |names: &[&str]| quick(names).choose(&all, &all[..2], |name| name);
        assert_eq!(choose(&[]).unwrap(), ["a", "b"]);
        assert_eq!(choose(&["c", "a"]).unwrap(), ["c", "a"]);
        let message = choose(&["d"]).unwrap_err().to_string();
        assert!(message.contains("\"d\"") && message.contains("a, b, c"), "{message}");
    }

    #[test]
    fn efforts_are_in_order() {
        assert_eq!(quick(&[]).pick([1, 2, 3]), 1);
        assert!(Effort::Quick < Effort::Usual && Effort::Usual < Effort::Full);
    }
}
