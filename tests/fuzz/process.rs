//! The parent of the process that runs a target's cases, which may answer, end or hang.

use crate::worker;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::time::Duration;
use tempfile::TempDir;

/// Time limit of a case, also on a busy machine.
const TIME: Duration = Duration::from_secs(20);

/// Maximum number of bytes of an ended process's messages that are reported.
const REPORTED: usize = 1000;

/// A folder for a target's cases, and the process that runs them, if it was started.
pub(crate) struct Process<'t> {
    target: &'t str,
    folder: TempDir,
    running: Option<Running>,
}

struct Running {
    child: Child,
    input: ChildStdin,
    answers: Receiver<String>,
}

impl<'t> Process<'t> {
    /// Copies the files `beside` into a new folder.
    pub(crate) fn new(target: &'t str, beside: &[PathBuf]) -> Self {
        let folder = tempfile::tempdir_in(env!("CARGO_TARGET_TMPDIR")).expect("a folder");
        for path in beside {
            let name = path.file_name().expect("a file has a name");
            fs::copy(path, folder.path().join(name)).expect("a folder that takes files");
        }
        Self { target, folder, running: None }
    }

    /// Runs one case; the error says how it failed.
    pub(crate) fn run(&mut self, bytes: &[u8]) -> Result<(), String> {
        let path = self.folder.path().join("case");
        // Truncating a file that is there would wait for the disk.
        _ = fs::remove_file(&path);
        fs::write(&path, bytes).expect("a folder that takes files");
        let stderr = self.stderr();
        let running = self.running.get_or_insert_with(|| Running::start(self.target, &stderr));
        let asked = writeln!(running.input, "{}", path.display());
        let answer = match asked {
            Ok(()) => running.answers.recv_timeout(TIME),
            Err(_) => Err(RecvTimeoutError::Disconnected),
        };
        match answer {
            Ok(answer) if answer.is_empty() => return Ok(()),
            Ok(answer) => return Err(answer),
            Err(_) => self.running = None,
        }
        match answer {
            Err(RecvTimeoutError::Timeout) => Err(format!("takes more than {TIME:?}")),
            _ => Err(format!("ends the process: {}", self.last_messages())),
        }
    }

    /// Writes an input to a permanent file.
    pub(crate) fn keep(&self, bytes: &[u8], number: usize) -> PathBuf {
        let name = format!("failed-{}-{}-{number}", self.target, std::process::id());
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        fs::write(&path, bytes).expect("a folder that takes files");
        path
    }

    fn stderr(&self) -> PathBuf {
        self.folder.path().join("stderr")
    }

    fn last_messages(&self) -> String {
        let stderr = fs::read(self.stderr()).unwrap_or_default();
        let end = String::from_utf8_lossy(&stderr[stderr.len().saturating_sub(REPORTED)..]);
        end.trim().to_owned()
    }
}

impl Running {
    /// Starts this program as a [`worker`], with standard error in the file `stderr`.
    fn start(target: &str, stderr: &Path) -> Self {
        let mut child = Command::new(std::env::current_exe().expect("a program with a path"))
            .args(["worker::answers", "--exact", "--ignored", "--test-threads=1"])
            .env(worker::TARGET, target)
            .env("RUST_BACKTRACE", "0")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(File::create(stderr).expect("a folder that takes files"))
            .spawn()
            .expect("a program that runs");
        let input = child.stdin.take().expect("a pipe");
        let output = BufReader::new(child.stdout.take().expect("a pipe"));
        let (send, answers) = channel();
        std::thread::spawn(move || {
            // Skips the test harness's output.
            let lines = output.lines().map_while(Result::ok);
            for line in lines {
                let sent = line.split_once(worker::ANSWER).map(|(_, to)| send.send(to.to_owned()));
                if sent.is_some_and(|sent| sent.is_err()) {
                    break;
                }
            }
        });
        Self { child, input, answers }
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        // Fails if it has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
