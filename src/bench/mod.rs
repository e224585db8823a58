//! What `spherule bench` measures.
//!
//! A measurement is a function from [`Options`] to a [`Report`](crate::report::Report). Contestants
//! run by turns (`rounds`), so that a machine that is busy for a while is so for all of them;
//! medians are reported, with the least and the greatest. What they compute is compared, and a
//! difference is an error: the time of a wrong result means nothing.

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

/// What is asked of a measurement.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Options {
    /// Names of scenes; empty for the measurement's own choice.
    pub scenes: Vec<String>,
    /// How often each contestant has its turn.
    pub rounds: u32,
    /// The most threads that are compared; all else runs on those of the current pool.
    pub threads: usize,
    /// Where references are kept; `None` to render them each time.
    pub references: Option<PathBuf>,
    /// How much is measured.
    pub effort: Effort,
    /// The size of the pictures of the paper's tables.
    pub scale: paper::Scale,
}

/// How much is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Effort {
    /// Whether it runs at all: about a second, for tests. The numbers mean nothing.
    Quick,
    /// What takes about a minute.
    Usual,
    /// Everything, for as long as it takes.
    Full,
}

/// Where it is told what is being measured, a few words at a time.
pub type Tell<'a> = &'a (dyn Fn(&str) + Sync);

impl Options {
    /// What to take for each effort, from the least.
    pub fn pick<T>(&self, [quick, usual, full]: [T; 3]) -> T {
        match self.effort {
            Effort::Quick => quick,
            Effort::Usual => usual,
            Effort::Full => full,
        }
    }

    /// The chosen ones of all that there are, in the order chosen; `usual` if none is.
    ///
    /// # Errors
    /// One of them does not exist.
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

    /// What was asked for, for a report.
    pub(crate) fn settings(&self) -> Vec<(String, String)> {
        let effort = self.pick(["quick: the numbers mean nothing", "usual", "full"]);
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

    /// The least there is.
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
