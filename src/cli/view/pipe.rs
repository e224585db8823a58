//! A view for the program that started this one, as the Python package does for notebooks: commands are lines on standard
//! input, and messages go to standard output.
//!
//! A message is `T` for text or `B` for binary, the length in four bytes, lowest first, and the content, which is that of
//! the page's socket. The first one has the page's files. The line `join` is a page that comes anew: it is told everything.

use super::client::{Client, Outgoing, deliver};
use super::host::{Host, Input};
use super::listen::{Call, FILES};
use super::options::Options;
use super::page::QUEUE_LENGTH;
use super::state::greeting;
use crate::cli::failure::Failure;
use crate::cli::output;
use crate::cli::render::RenderSetup;
use serde_json::{Map, Value, json};
use std::io::{self, BufRead, Write};
use std::sync::Arc;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::{self, JoinHandle};

/// Opens a view of the setup's scene, until the end of standard input.
///
/// # Errors
/// The scene cannot be loaded, or a thread cannot be started.
pub(super) fn open(setup: &RenderSetup, options: Options) -> Result<(), Failure> {
    // Of messages alone.
    output::reserve_for_picture();
    let failed = |error| Failure::View(format!("the pipe: {error}"));
    let files: Map<String, Value> =
        FILES.iter().map(|(name, _, text)| ((*name).to_owned(), json!(text))).collect();
    write(&Outgoing::Text(json!({ "page": files }).to_string())).map_err(failed)?;
    let (sender, inputs) = sync_channel(QUEUE_LENGTH);
    let host = Host::start(setup, options, greeting()?, &sender)?;
    let listen = move || {
        // The reader or the session has ended.
        let _ = listen(&sender);
        let _ = sender.send(Input::End);
    };
    thread::Builder::new().spawn(listen).map_err(failed)?;
    host.run(&inputs)
}

/// A page at the other end, and the thread that writes what is for it.
struct Page {
    number: u64,
    client: Arc<Client>,
    writer: JoinHandle<()>,
}

impl Page {
    fn join(number: u64, inputs: &SyncSender<Input>) -> io::Result<Self> {
        let client = Arc::new(Client::default());
        let own = Arc::clone(&client);
        let writer = thread::Builder::new().spawn(move || {
            // A reader that is gone closes standard input, too.
            let _ = deliver(&own, |outgoing| write(&outgoing));
            own.close();
        })?;
        tell(inputs, Call::Joined(number, Arc::clone(&client)))?;
        Ok(Self { number, client, writer })
    }

    /// Ends the page. What is written for another one then follows what was for this one.
    fn leave(self, inputs: &SyncSender<Input>) -> io::Result<()> {
        self.client.close();
        let _ = self.writer.join();
        tell(inputs, Call::Left(self.number))
    }
}

fn tell(inputs: &SyncSender<Input>, call: Call) -> io::Result<()> {
    inputs.send(Input::Call(call)).map_err(|_| io::ErrorKind::BrokenPipe.into())
}

/// Reads commands, to the end of standard input.
fn listen(inputs: &SyncSender<Input>) -> io::Result<()> {
    let mut page = Page::join(0, inputs)?;
    for line in io::stdin().lock().lines() {
        let line = line?;
        if line == "join" {
            let next = page.number + 1;
            page.leave(inputs)?;
            page = Page::join(next, inputs)?;
        } else if let Some(shown) = line.strip_prefix("shown ") {
            shown.parse().into_iter().for_each(|shown| page.client.shown(shown));
            tell(inputs, Call::Shown)?;
        } else {
            tell(inputs, Call::Line(page.number, line))?;
        }
    }
    page.leave(inputs)
}

fn write(outgoing: &Outgoing) -> io::Result<()> {
    let (kind, content) = match outgoing {
        Outgoing::Text(text) => (b'T', text.as_bytes()),
        Outgoing::Binary(bytes) => (b'B', bytes.as_slice()),
        // There is no protocol that asks.
        Outgoing::Frames(_) => return Ok(()),
    };
    let length = u32::try_from(content.len())
        .map_err(|_| io::Error::other("a message is larger than 4 GiB"))?;
    let mut output = io::stdout().lock();
    output.write_all(&[kind])?;
    output.write_all(&length.to_le_bytes())?;
    output.write_all(content)?;
    output.flush()
}
