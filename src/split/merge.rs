//! Parts of a render, put together.

use super::holes;
use crate::render::{ImagePart, ResumableRender, difference};
use crate::scene::Identity;
use std::fmt;

/// Most holes that a message names.
const TOLD: usize = 8;

/// Parts of a render that are put together, in any order.
#[derive(Debug, Default)]
pub struct Merge {
    /// Whether parts may be missing.
    partial: bool,
    scene: Option<Identity>,
    names: Vec<String>,
    parts: Vec<ImagePart>,
    whole: Option<ResumableRender>,
}

/// Why parts do not make a whole.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeError {
    /// There are none.
    #[error("there is no part; name at least one")]
    Nothing,
    /// Parts of different renders.
    #[error(
        "{name}: is no part of the same render as {first}: {what} is {theirs}, and {ours} there; \
         merge parts of one render"
    )]
    Foreign {
        /// The part.
        name: String,
        /// The part that was there first.
        first: String,
        /// In what they differ.
        what: &'static str,
        /// Its value in the part.
        theirs: String,
        /// Its value in the first part.
        ours: String,
    },
    /// Pictures of different scenes.
    #[error(
        "{name}: is of another scene than {first}: it has other {what}; merge parts of one render"
    )]
    Scene {
        /// The part.
        name: String,
        /// The part that was there first.
        first: String,
        /// The part of the scene that differs.
        what: &'static str,
    },
    /// Samples would count twice.
    #[error("{second}: has {common}, which {first} has too; leave one of them out")]
    Overlap {
        /// The earlier one.
        first: String,
        /// The later one.
        second: String,
        /// Samples and tiles that both have.
        common: ImagePart,
    },
    /// A part was interrupted.
    #[error(
        "{name}: was interrupted, with {taken} of its {wanted} samples; render it to its end, or \
         merge what there is with --partial"
    )]
    ResumableRender {
        /// The part.
        name: String,
        /// Samples that it has, of all pixels.
        taken: u64,
        /// Samples that it should have.
        wanted: u64,
    },
    /// Parts are missing.
    #[error("{}; render what is missing, or merge what there is with --partial", Missing(.0))]
    Holes(Vec<ImagePart>),
}

struct Missing<'a>(&'a [ImagePart]);

impl fmt::Display for Missing<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let told: Vec<String> = self.0.iter().take(TOLD).map(ImagePart::to_string).collect();
        write!(formatter, "no part has {}", told.join("; nor "))?;
        match self.0.len() - told.len() {
            0 => Ok(()),
            more => write!(formatter, "; nor {more} more pieces"),
        }
    }
}

impl Merge {
    /// Of nothing yet. If it is to be `partial`, parts may be missing or unfinished: every pixel is then
    /// the mean of the samples that it has, and black if it has none.
    pub fn new(partial: bool) -> Self {
        Self { partial, ..Self::default() }
    }

    /// Adds a part of a render of `scene`, which messages call by a name.
    ///
    /// # Errors
    /// It is part of another render, has something that another part has too, or is unfinished.
    /// Then the parts are of no use any more.
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
        // They have the same settings; only a forged file comes here.
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
            return Err(MergeError::ResumableRender { name, taken, wanted });
        }
        Ok(())
    }

    fn foreign(&self, name: &str, what: &'static str, theirs: &str, ours: &str) -> MergeError {
        let first = self.names.first().cloned().unwrap_or_default();
        let (theirs, ours) = (theirs.to_owned(), ours.to_owned());
        MergeError::Foreign { name: name.to_owned(), first, what, theirs, ours }
    }

    /// The whole render, and what is missing of it.
    ///
    /// # Errors
    /// There is no part, or something is missing and nobody said that it may.
    pub fn finish(self) -> Result<(ResumableRender, Vec<ImagePart>), MergeError> {
        let mut whole = self.whole.ok_or(MergeError::Nothing)?;
        let all = ImagePart::whole(whole.region(), whole.settings().spp);
        let holes = holes(&all, &self.parts);
        if !holes.is_empty() && !self.partial {
            return Err(MergeError::Holes(holes));
        }
        // What is one file is as it was, whatever ended it.
        if self.parts.len() > 1 || !whole.is_whole() {
            whole.fill_missing();
        }
        Ok((whole, holes))
    }
}
