//! Merging of the parts of a render.

use super::uncovered_parts;
use crate::render::{ImagePart, ResumableRender, difference};
use crate::scene::Identity;
use std::fmt;

/// Maximum number of missing parts in a message.
const MAX_LISTED: usize = 8;

/// A merge of the parts of a render, in any order.
#[derive(Debug, Default)]
pub struct Merge {
    /// True if parts may be missing.
    partial: bool,
    scene: Option<Identity>,
    names: Vec<String>,
    parts: Vec<ImagePart>,
    whole: Option<ResumableRender>,
}

/// Reasons why parts cannot be merged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MergeError {
    /// There are no parts.
    #[error("no parts to merge; name at least one")]
    Nothing,
    /// A part of another render.
    #[error(
        "{name}: is not a part of the same render as {first}: {what} is {theirs}, but {ours} there; \
         merge parts of one render"
    )]
    Foreign {
        /// The part.
        name: String,
        /// The first part.
        first: String,
        /// The setting in which they differ.
        what: &'static str,
        /// Its value in the part.
        theirs: String,
        /// Its value in the first part.
        ours: String,
    },
    /// A part of another scene.
    #[error(
        "{name}: is of another scene than {first} (different {what}); merge parts of one render"
    )]
    Scene {
        /// The part.
        name: String,
        /// The first part.
        first: String,
        /// The part of the scene that differs.
        what: &'static str,
    },
    /// Two parts have common samples.
    #[error("{second}: has {common}, as does {first}; remove one of them")]
    Overlap {
        /// The earlier part.
        first: String,
        /// The later part.
        second: String,
        /// Samples and tiles that both have.
        common: ImagePart,
    },
    /// A part was interrupted.
    #[error(
        "{name}: was interrupted, with {taken} of its {wanted} samples; finish it, or \
         merge its samples with --partial"
    )]
    Interrupted {
        /// The part.
        name: String,
        /// Number of its samples, of all pixels.
        taken: u64,
        /// Number of samples when it is complete.
        wanted: u64,
    },
    /// Parts are missing.
    #[error("{}; render the missing parts, or merge the others with --partial", Missing(.0))]
    Missing(Vec<ImagePart>),
}

struct Missing<'a>(&'a [ImagePart]);

impl fmt::Display for Missing<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let listed: Vec<String> =
            self.0.iter().take(MAX_LISTED).map(ImagePart::to_string).collect();
        write!(formatter, "no part has {}", listed.join("; nor "))?;
        match self.0.len() - listed.len() {
            0 => Ok(()),
            more => write!(formatter, "; nor {more} more pieces"),
        }
    }
}

impl Merge {
    /// Creates an empty merge. If it is `partial`, parts may be missing or unfinished: every pixel is
    /// then the mean of its samples, and black without samples.
    pub fn new(partial: bool) -> Self {
        Self { partial, ..Self::default() }
    }

    /// Adds a part of a render of `scene`, by its name in messages.
    ///
    /// # Errors
    /// The part belongs to another render, has samples that another part has too, or is unfinished. The
    /// merge is then unusable.
    pub fn add(
        &mut self,
        name: &str,
        scene: &Identity,
        part: ResumableRender,
    ) -> Result<(), MergeError> {
        let first = self.scene.get_or_insert_with(|| scene.clone());
        if let Some(what) = first.difference(scene) {
            let first = self.names.first().cloned().unwrap_or_default();
            return Err(MergeError::Scene { name: name.to_owned(), first, what });
        }
        self.check(name, &part)?;
        self.names.push(name.to_owned());
        self.parts.push(part.part().clone());
        let Some(whole) = &mut self.whole else {
            self.whole = Some(part);
            return Ok(());
        };
        // Settings are equal here; only a forged file gets here.
        if whole.merge(part) { Ok(()) } else { Err(self.foreign(name, "film", "other", "another")) }
    }

    fn check(&self, name: &str, part: &ResumableRender) -> Result<(), MergeError> {
        if let Some((what, theirs, ours)) =
            self.whole.as_ref().and_then(|whole| difference(part, whole))
        {
            return Err(self.foreign(name, what, &theirs, &ours));
        }
        for (first, other) in self.names.iter().zip(&self.parts) {
            if let Some(common) = other.common(part.part()) {
                let (first, second) = (first.clone(), name.to_owned());
                return Err(MergeError::Overlap { first, second, common });
            }
        }
        if !part.is_complete() && !self.partial {
            let pixels: u64 = part.film().tiles.iter().map(|tile| u64::from(tile.len())).sum();
            let wanted = pixels * part.part().samples.len() as u64;
            let (name, taken) = (name.to_owned(), part.samples().total);
            return Err(MergeError::Interrupted { name, taken, wanted });
        }
        Ok(())
    }

    fn foreign(&self, name: &str, what: &'static str, theirs: &str, ours: &str) -> MergeError {
        let first = self.names.first().cloned().unwrap_or_default();
        let (theirs, ours) = (theirs.to_owned(), ours.to_owned());
        MergeError::Foreign { name: name.to_owned(), first, what, theirs, ours }
    }

    /// Returns the whole render and its missing parts.
    ///
    /// # Errors
    /// There are no parts, or parts are missing and the merge is not partial.
    pub fn finish(self) -> Result<(ResumableRender, Vec<ImagePart>), MergeError> {
        let mut whole = self.whole.ok_or(MergeError::Nothing)?;
        let all = ImagePart::whole(whole.region(), whole.settings().spp);
        let missing = uncovered_parts(&all, &self.parts);
        if !missing.is_empty() && !self.partial {
            return Err(MergeError::Missing(missing));
        }
        // A single complete file keeps its state and the reason of its end.
        if self.parts.len() > 1 || !whole.is_whole() {
            whole.fill_missing();
        }
        Ok((whole, missing))
    }
}
