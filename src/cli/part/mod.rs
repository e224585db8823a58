//! `--part`: one machine's share of a render.

mod environment;

use super::Failure;
use super::names::SPLITS;
use spherule::split::{Part, Split};
use std::num::NonZeroU32;

/// What says which part.
const FROM_ENVIRONMENT: &str = "from-env";

/// Heading of the options for several machines.
pub(super) const HEADING: &str = "Parts, for several machines; `spherule merge` puts them together";

/// Which share of the render this is.
#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = HEADING)]
pub(super) struct PartArgs {
    /// Render part K of N to a file named after --output with .K-of-N.part at its end; from-env takes
    /// K, and N unless it is given, from the environment variables of Slurm, PBS, Grid Engine, LSF,
    /// AWS Batch, Kubernetes, MPI or GNU parallel. Of a sequence, part K is every Nth picture, whole
    #[arg(long, value_name = "K/N|from-env[/N]", value_parser = choice)]
    part: Option<Choice>,
    /// What parts differ in [default: tiles, or samples where each part has 16 or more of every pixel]
    #[arg(long, requires = "part", value_parser = SPLITS.parser())]
    pub(super) split: Option<Split>,
}

/// Who says which part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    User(Part),
    /// Of so many, if that is said.
    Environment(Option<NonZeroU32>),
}

impl PartArgs {
    /// The part that is to be rendered, if it is but one; once the environment is asked, it need not be
    /// asked again.
    pub(super) fn settle(&mut self) -> Result<Option<Part>, Failure> {
        if let Some(Choice::Environment(count)) = self.part {
            // Variables that are no text are none of those that count.
            let variable = |name: &str| std::env::var(name).ok();
            let part = environment::part(&variable, count.map(NonZeroU32::get));
            let refuse = |silence| Failure::usage("render", format!("--part: {silence}"));
            self.part = Some(Choice::User(part.map_err(refuse)?));
        }
        Ok(self.settled())
    }

    /// The same after that.
    pub(super) fn settled(self) -> Option<Part> {
        match self.part {
            Some(Choice::User(part)) => Some(part),
            _ => None,
        }
    }
}

/// `K/N`, `from-env` or `from-env/N`.
fn choice(text: &str) -> Result<Choice, String> {
    let Some(rest) = text.strip_prefix(FROM_ENVIRONMENT) else {
        return text.parse().map(Choice::User).map_err(|error: String| {
            format!("{error}; or {FROM_ENVIRONMENT}, or {FROM_ENVIRONMENT}/N")
        });
    };
    if rest.is_empty() {
        return Ok(Choice::Environment(None));
    }
    let count = rest.strip_prefix('/').and_then(|count| count.parse().ok());
    let mend =
        || format!("give {FROM_ENVIRONMENT}, or with the number of parts {FROM_ENVIRONMENT}/8");
    count.map(|count| Choice::Environment(Some(count))).ok_or_else(mend)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_said_or_asked_for() {
        assert_eq!(choice("3/8"), Ok(Choice::User(Part::new(3, 8).expect("there is one"))));
        assert_eq!(choice("from-env"), Ok(Choice::Environment(None)));
        assert_eq!(choice("from-env/64"), Ok(Choice::Environment(NonZeroU32::new(64))));
        for text in ["from-env/0", "from-env/", "from-env/x", "from-environment", "9/8", ""] {
            assert!(choice(text).is_err(), "{text}");
        }
    }
}
