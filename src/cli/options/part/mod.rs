//! `--part`: the part of a render for one machine.

mod environment;

use super::names::{self, SPLITS};
use crate::cli::failure::Failure;
use spherule_render::split::{Part, Split};
use std::num::NonZeroU32;

/// Value of `--part` that takes the part from the environment.
const FROM_ENVIRONMENT: &str = "from-env";

/// Heading of the options for several machines.
pub(in crate::cli) const HEADING: &str =
    "Distributed rendering (combine the parts with `spherule merge`)";

/// Options for rendering one part of an image.
#[derive(Clone, Copy, Debug, clap::Args)]
#[command(next_help_heading = HEADING)]
pub(in crate::cli) struct PartArgs {
    /// Render part K of N to a file named after --output with the suffix .K-of-N.part; from-env takes K, and
    /// N if it is not given, from the environment variables of Slurm, PBS, Grid Engine, LSF, AWS Batch,
    /// Kubernetes, MPI or GNU parallel. Of a sequence, part K is every Nth image
    #[arg(long, value_name = "K/N|from-env[/N]", value_parser = choice)]
    part: Option<Choice>,
    /// Split the image by samples or by tiles [default: tiles, or samples if each part has 16 or more per pixel]
    #[arg(long, requires = "part", value_parser = names::parser(&SPLITS))]
    pub(in crate::cli) split: Option<Split>,
}

/// Source of the part's number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Choice {
    User(Part),
    /// With the number of parts, if given.
    Environment(Option<NonZeroU32>),
}

impl PartArgs {
    /// Resolves the part from the environment if asked to, and returns it.
    pub(in crate::cli) fn resolve(&mut self) -> Result<Option<Part>, Failure> {
        if let Some(Choice::Environment(count)) = self.part {
            // Variables that are not valid Unicode are ignored.
            let variable = |name: &str| std::env::var(name).ok();
            let part = environment::part(&variable, count.map(NonZeroU32::get));
            let refuse = |error| Failure::usage("render", format!("--part: {error}"));
            self.part = Some(Choice::User(part.map_err(refuse)?));
        }
        Ok(self.resolved())
    }

    /// Returns whether there is a part, resolved or not.
    pub(in crate::cli) fn is_given(self) -> bool {
        self.part.is_some()
    }

    /// Returns the part, once it is resolved.
    pub(in crate::cli) fn resolved(self) -> Option<Part> {
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
    let hint = || {
        format!(
            "give {FROM_ENVIRONMENT}, or {FROM_ENVIRONMENT}/N with the number of parts, as in \
                    {FROM_ENVIRONMENT}/8"
        )
    };
    count.map(|count| Choice::Environment(Some(count))).ok_or_else(hint)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_given_or_read_from_the_environment() {
        assert_eq!(choice("3/8"), Ok(Choice::User(Part::new(3, 8).expect("there is one"))));
        assert_eq!(choice("from-env"), Ok(Choice::Environment(None)));
        assert_eq!(choice("from-env/64"), Ok(Choice::Environment(NonZeroU32::new(64))));
        for text in ["from-env/0", "from-env/", "from-env/x", "from-environment", "9/8", ""] {
            assert!(choice(text).is_err(), "{text}");
        }
    }
}
