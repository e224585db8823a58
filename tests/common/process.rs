//! Processes of tests: with time limits, killed when a test fails, and with the default actions of signals.

#![allow(dead_code, reason = "each test crate uses its own part of this")]

use std::io::{ErrorKind, Read, Write};
use std::process::{Child, ChildStdin, Command, ExitStatus, Output, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

/// Time limit of everything that a test waits for.
const LIMIT: Duration = Duration::from_secs(120);

/// A process, which is killed when this is dropped.
pub(crate) struct Process {
    child: Child,
    /// The command line, for messages.
    line: String,
    /// The thread that writes standard input; it returns the pipe, which it leaves open.
    input: Option<JoinHandle<ChildStdin>>,
    /// All that is written to standard output and to standard error, if they are pipes.
    outputs: [Option<Receiver<Vec<u8>>>; 2],
}

/// Runs a command to its end, without input, and returns its output.
#[track_caller]
pub(crate) fn run(command: &mut Command) -> Output {
    command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    Process::start(command).end()
}

/// Runs a command to its end, with an input, and returns its output.
#[track_caller]
pub(crate) fn run_with_input(command: &mut Command, input: &str) -> Output {
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut process = Process::start(command);
    process.write(input);
    process.end()
}

/// Waits until a condition is true.
#[track_caller]
pub(crate) fn wait_for(what: &str, mut holds: impl FnMut() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < LIMIT, "{what} did not come within {LIMIT:?}");
        // Short beside the two milliseconds between checkpoints of tests that kill.
        thread::sleep(Duration::from_micros(200));
    }
}

impl Process {
    /// Starts a command. Its pipes are read from the start, so that they never fill up.
    #[track_caller]
    pub(crate) fn start(command: &mut Command) -> Self {
        #[cfg(target_os = "linux")]
        catch_ignored_signals();
        let line = format!("{command:?}");
        let mut started = None;
        // A program that was just copied is busy (ETXTBSY) while a process that another thread has started at
        // that moment still holds the file open.
        wait_for(&format!("the start of {line}"), || {
            let busy = |error: &std::io::Error| error.kind() == ErrorKind::ExecutableFileBusy;
            started = Some(command.spawn()).filter(|child| !child.as_ref().is_err_and(busy));
            started.is_some()
        });
        let child = started.expect("a result").unwrap_or_else(|error| panic!("{line}: {error}"));
        let mut process = Self { child, line, input: None, outputs: [None, None] };
        process.outputs =
            [process.child.stdout.take().map(collect), process.child.stderr.take().map(collect)];
        process
    }

    pub(crate) fn id(&self) -> u32 {
        self.child.id()
    }

    /// Writes to standard input, which stays open until [`Self::end`], without waiting for a reader.
    pub(crate) fn write(&mut self, input: &str) {
        let mut pipe = self.child.stdin.take().expect("a pipe");
        let input = input.to_owned();
        self.input = Some(thread::spawn(move || {
            // The process need not read everything.
            let _ = pipe.write_all(input.as_bytes());
            pipe
        }));
    }

    /// Sends signals by name, in this order.
    #[track_caller]
    pub(crate) fn signal(&self, names: &[&str]) {
        let kill: Vec<String> =
            names.iter().map(|name| format!("kill -{name} {}", self.id())).collect();
        let sent = run(Command::new("sh").args(["-c", &kill.join("; ")]));
        assert!(sent.status.success(), "{kill:?}: {sent:?}");
    }

    /// Returns the status if the process has ended.
    pub(crate) fn status(&mut self) -> Option<ExitStatus> {
        self.child.try_wait().expect("a process")
    }

    /// Kills the process, and waits for its end.
    #[track_caller]
    pub(crate) fn kill(&mut self) -> ExitStatus {
        self.child.kill().expect("a process");
        self.wait()
    }

    /// Waits until the process ends.
    #[track_caller]
    pub(crate) fn wait(&mut self) -> ExitStatus {
        let what = format!("the end of {}", self.line);
        wait_for(&what, || self.status().is_some());
        self.status().expect("a status")
    }

    /// Closes standard input once all is written, waits until the process ends, and returns its output.
    #[track_caller]
    pub(crate) fn end(mut self) -> Output {
        drop((self.child.stdin.take(), self.input.take()));
        // They end with the process, unless one that it has started holds them longer.
        let [stdout, stderr] = self.outputs.each_ref().map(|output| {
            let received = output.as_ref().map(|output| output.recv_timeout(LIMIT));
            received.map(|all| {
                all.unwrap_or_else(|_| {
                    panic!("the end of {} did not come within {LIMIT:?}", self.line)
                })
            })
        });
        let (stdout, stderr) = (stdout.unwrap_or_default(), stderr.unwrap_or_default());
        Output { status: self.wait(), stdout, stderr }
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        // Fails if it has already ended.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Reads a pipe to its end, on a thread that nothing waits for without a limit.
fn collect(mut pipe: impl Read + Send + 'static) -> Receiver<Vec<u8>> {
    let (send, receive) = channel();
    thread::spawn(move || {
        let mut bytes = Vec::new();
        let read = pipe.read_to_end(&mut bytes);
        // Nobody listens after a failure.
        let _ = read.and_then(|_| send.send(bytes).map_err(std::io::Error::other));
    });
    receive
}

/// Catches the termination signals that this process ignores, as background jobs of shells and what `nohup` starts
/// do. A process inherits what its parent ignores, but has the default action for what its parent catches.
#[cfg(target_os = "linux")]
fn catch_ignored_signals() {
    use signal_hook::consts::signal::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    static ONCE: std::sync::Once = std::sync::Once::new();
    ONCE.call_once(|| {
        let status = std::fs::read_to_string("/proc/self/status").expect("the state of a process");
        let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        let mask = ignored.expect("a mask of signals");
        for signal in [SIGHUP, SIGINT, SIGQUIT, SIGTERM] {
            if mask >> (signal - 1) & 1 == 1 {
                signal_hook::flag::register(signal, std::sync::Arc::default()).expect("a handler");
            }
        }
    });
}
