//! Files that pages send to a view that was started without one.

use crate::cli::source::is_scene;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Maximum number of bytes of all files that pages send.
pub(super) const LARGEST: u64 = 1 << 30;

/// The file that is being received, and the bytes that were promised so far.
#[derive(Default)]
pub(super) struct SentFiles {
    promised: u64,
    incoming: Option<Incoming>,
}

/// A file that a page sends.
struct Incoming {
    page: u64,
    file: File,
    path: PathBuf,
    /// Number of bytes that are still to come.
    left: u64,
}

impl SentFiles {
    /// Begins to receive a file from a page, in a new folder.
    ///
    /// # Errors
    /// It is a scene, it is too large, or it cannot be written.
    pub(super) fn begin(
        &mut self,
        page: u64,
        name: &str,
        size: u64,
        folder: &Path,
    ) -> Result<(), String> {
        let known = |letter: char| letter.is_alphanumeric() || ".-_+".contains(letter);
        let name: String = name.chars().map(|own| if known(own) { own } else { '_' }).collect();
        if is_scene(Path::new(&name)) {
            return Err("a scene names other files; open it by `spherule view`".to_owned());
        }
        if self.promised.saturating_add(size) > LARGEST {
            let most = LARGEST >> 20;
            return Err(format!(
                "{name} is too large: files of {most} MiB can be sent; open it by `spherule view`"
            ));
        }
        self.promised += size;
        let path = folder.join(&name);
        let created = fs::create_dir(folder).and_then(|()| File::create(&path));
        let file = created.map_err(|error| error.to_string())?;
        self.incoming = Some(Incoming { page, file, path, left: size });
        Ok(())
    }

    /// Adds bytes to the file that a page sends; those of no file are dropped. Returns its path once it is whole.
    ///
    /// # Errors
    /// It has fewer bytes, or cannot be written; the rest of it is dropped.
    pub(super) fn take(&mut self, page: u64, bytes: &[u8]) -> Result<Option<PathBuf>, String> {
        let Some(mut incoming) = self.incoming.take_if(|own| own.page == page) else {
            return Ok(None);
        };
        let Some(left) = incoming.left.checked_sub(bytes.len() as u64) else {
            return Err("more bytes than the file has".to_owned());
        };
        incoming.left = left;
        incoming.file.write_all(bytes).map_err(|error| error.to_string())?;
        if left == 0 {
            return Ok(Some(incoming.path));
        }
        self.incoming = Some(incoming);
        Ok(None)
    }
}
