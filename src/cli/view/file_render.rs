//! Files that the program renders for pages beside the view, at a size and with samples of their own.
//!
//! Another process renders: its file is that of the command line that is shown, and looking goes on.

use super::client::{Client, Reply};
use super::options::Options;
use crate::cli::failure::Failure;
use serde_json::{Value, json};
use std::io::{self, BufRead, BufReader};
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

/// Options that a page chooses for a file.
const CHOICES: [&str; 3] = ["size", "spp", "until-error"];

/// A render of a file.
#[derive(Clone, Default)]
pub(super) struct FileRender(Arc<Mutex<State>>);

#[derive(Default)]
enum State {
    #[default]
    Preparing,
    Running(Child),
    Ended,
}

/// A file to render.
pub(super) struct Wanted {
    /// Options of the command line, without the file that is written.
    pub(super) options: Options,
    /// The suffix of its name.
    pub(super) suffix: String,
}

impl Wanted {
    /// Adds what a page chooses, as in `size=3840x2160 spp=256`.
    ///
    /// # Errors
    /// A word is none of the choices.
    pub(super) fn choose(&mut self, words: &[&str]) -> Result<(), String> {
        // An error is reached with as many samples as it takes.
        self.options = self.options.restricted(|name| !["spp", "until-error"].contains(&name));
        for word in words {
            match word.split_once('=') {
                Some((name, value)) if CHOICES.contains(&name) => self.options.put(name, value),
                _ => return Err(format!("`{word}` is none of {}=VALUE", CHOICES.join("=VALUE, "))),
            }
        }
        Ok(())
    }
}

impl FileRender {
    fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Returns whether it has ended, with a file or without.
    pub(super) fn has_ended(&self) -> bool {
        matches!(*self.state(), State::Ended)
    }

    /// Ends the render, without a file.
    pub(super) fn cancel(&self) {
        if let State::Running(mut child) = std::mem::replace(&mut *self.state(), State::Ended) {
            // It may have ended.
            let _ = child.kill();
            let _ = child.wait();
        }
    }

    /// Renders a file for a page on another thread, in a new folder, and tells the page how far it is. `prepare` writes files
    /// that are read.
    pub(super) fn start(
        &self,
        mut wanted: Wanted,
        client: Arc<Client>,
        folder: PathBuf,
        prepare: impl FnOnce(&Path, &mut Options) -> Result<(), Failure> + Send + 'static,
    ) {
        let own = self.clone();
        thread::spawn(move || {
            let tell = |message: Value| client.reply(Reply::Text(message.to_string()));
            tell(json!({ "rendering": "preparing" }));
            let rendered = own
                .render(&mut wanted, &folder, prepare, |line| tell(json!({ "rendering": line })));
            let cancelled =
                matches!(std::mem::replace(&mut *own.state(), State::Ended), State::Ended);
            // It may hold a part of the file.
            let _ = std::fs::remove_dir_all(&folder);
            tell(json!({ "rendering": null }));
            match rendered {
                Ok(file) => {
                    let name = format!("view.{}", wanted.suffix);
                    let header = json!({ "file": name, "command": wanted.options.command_line() });
                    client.reply(Reply::File(header.to_string(), file));
                }
                Err(message) if !cancelled => tell(json!({ "error": message })),
                Err(_) => (),
            }
        });
    }

    /// Returns the bytes of the file, or why there are none.
    fn render(
        &self,
        wanted: &mut Wanted,
        folder: &Path,
        prepare: impl FnOnce(&Path, &mut Options) -> Result<(), Failure>,
        tell: impl Fn(&str),
    ) -> Result<Vec<u8>, String> {
        let failed = |error: io::Error| error.to_string();
        std::fs::create_dir(folder).map_err(failed)?;
        prepare(folder, &mut wanted.options).map_err(|failure| failure.brief())?;
        let output = folder.join(format!("view.{}", wanted.suffix));
        let mut options = wanted.options.clone();
        options.put("output", &output);
        if options.last("threads").is_none() {
            // The others are for looking.
            let threads = thread::available_parallelism().map_or(1, NonZeroUsize::get);
            options.put("threads", threads.div_ceil(2).to_string());
        }
        wanted.options.put("output", format!("view.{}", wanted.suffix));
        let mut command = Command::new(std::env::current_exe().map_err(failed)?);
        command.arg("render").args(options.words());
        command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::piped());
        let stderr = {
            let mut state = self.state();
            if matches!(*state, State::Ended) {
                return Err(String::new());
            }
            let mut child = command.spawn().map_err(failed)?;
            let stderr = child.stderr.take();
            *state = State::Running(child);
            stderr
        };
        tell("rendering");
        let mut said = Vec::new();
        for line in stderr.into_iter().flat_map(|stderr| BufReader::new(stderr).lines()) {
            let line = line.map_err(failed)?;
            if !["note: ", "warning: "].iter().any(|kind| line.starts_with(kind)) {
                tell(&line);
            }
            said.push(line);
        }
        let mut state = self.state();
        let State::Running(child) = &mut *state else { return Err(String::new()) };
        if child.wait().map_err(failed)?.success() {
            return std::fs::read(&output).map_err(failed);
        }
        let error = said.iter().find_map(|line| line.strip_prefix("error: "));
        Err(error.map_or_else(|| said.join("; "), str::to_owned))
    }
}
