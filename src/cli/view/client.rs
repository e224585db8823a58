//! A page that looks: what waits to be sent to it, and what sends it.
//!
//! At most two images are on their way; of those that wait, only the newest is kept. A page that reads nothing therefore
//! costs two images, and is given up when a write takes too long.

use super::image::Picture;
use super::pace::Pace;
use super::save::{Saved, encode_picture};
use super::tiles::{self, Tile};
use serde_json::{Value, json};
use spherule_render::image::Format;
use std::collections::VecDeque;
use std::io::{self, Write};
use std::net::TcpStream;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::time::{Duration, Instant};
use tungstenite::protocol::{Message, Role, WebSocket};

/// Maximum number of images on their way.
const IN_FLIGHT: usize = 2;

/// Maximum number of replies that wait.
const REPLIES: usize = 64;

/// Maximum number of bytes of answers to pings that wait.
const ANSWERS: usize = 1 << 14;

/// Time that a write may take.
const PATIENCE: Duration = Duration::from_secs(10);

/// An image to send.
pub(super) struct Shot {
    pub(super) number: u64,
    /// Number of commands of the steering page that it follows.
    pub(super) heard: u64,
    /// Time of the last of them.
    asked: Instant,
    pub(super) picture: Arc<Picture>,
    /// The image with its scene, if it is finished.
    pub(super) finished: Option<Saved>,
    /// Marks and handles that the page draws over it.
    drawn: Value,
    /// The file of the finished image, once a page needs it.
    file: OnceLock<Option<Vec<u8>>>,
}

impl Shot {
    pub(super) fn new(
        picture: Arc<Picture>,
        number: u64,
        heard: u64,
        asked: Instant,
        finished: Option<Saved>,
        drawn: Value,
    ) -> Self {
        Self { number, heard, asked, picture, finished, drawn, file: OnceLock::new() }
    }

    /// The PNG file of a finished image, as `spherule render` writes it.
    fn file(&self) -> Option<&[u8]> {
        let encode = || encode_picture(&self.finished.as_ref()?.seen(), Format::Png).ok();
        self.file.get_or_init(encode).as_deref()
    }
}

/// A page that looks.
#[derive(Default)]
pub(super) struct Client {
    outbox: Mutex<Outbox>,
    wake: Condvar,
}

/// All that waits to be sent.
#[derive(Default)]
struct Outbox {
    /// Frames of the protocol, as answers to pings.
    answers: Vec<u8>,
    replies: VecDeque<Reply>,
    /// The newest state.
    state: Option<String>,
    shot: Option<Arc<Shot>>,
    /// Numbers of images on their way, and the times at which they were sent.
    in_flight: VecDeque<(u64, Instant)>,
    pace: Pace,
    closed: bool,
}

/// A message that is not replaced by a newer one.
pub(super) enum Reply {
    Text(String),
    /// A header in JSON, and a file.
    File(String, Vec<u8>),
}

/// A thing to send.
enum Parcel {
    Answers(Vec<u8>),
    Reply(Reply),
    Shot(Arc<Shot>, Pace),
}

impl Client {
    fn outbox(&self) -> MutexGuard<'_, Outbox> {
        self.outbox.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Changes the outbox, and wakes the thread that sends.
    fn change(&self, change: impl FnOnce(&mut Outbox)) {
        change(&mut self.outbox());
        self.wake.notify_one();
    }

    /// Sends a reply. A page that leaves too many unread is given up.
    pub(super) fn reply(&self, reply: Reply) {
        self.change(|outbox| {
            outbox.replies.push_back(reply);
            outbox.closed |= outbox.replies.len() > REPLIES;
        });
    }

    /// Sends a state, instead of one that waits.
    pub(super) fn state(&self, state: String) {
        self.change(|outbox| outbox.state = Some(state));
    }

    /// Sends the state after some commands, with their mark. A state that waits is older.
    pub(super) fn mark(&self, text: String) {
        self.change(|outbox| outbox.state = None);
        self.reply(Reply::Text(text));
    }

    /// Sends an image, instead of one that waits.
    pub(super) fn show(&self, shot: Arc<Shot>) {
        self.change(|outbox| outbox.shot = Some(shot));
    }

    /// Returns whether no image waits or is on its way; or, if the next one is `late`, whether it would be sent at once.
    pub(super) fn is_ready(&self, late: bool) -> bool {
        let outbox = self.outbox();
        outbox.shot.is_none() && outbox.in_flight.len() < if late { IN_FLIGHT } else { 1 }
    }

    /// Records that an image is shown.
    pub(super) fn shown(&self, number: u64) {
        self.change(|outbox| {
            while outbox.in_flight.front().is_some_and(|(own, _)| *own <= number)
                && let Some((_, sent)) = outbox.in_flight.pop_front()
            {
                outbox.pace.record(sent.elapsed());
            }
        });
    }

    /// Maximum number of pixels of an image while the camera moves.
    pub(super) fn pixels(&self) -> u64 {
        self.outbox().pace.pixels()
    }

    /// Ends the thread that sends.
    pub(super) fn close(&self) {
        self.change(|outbox| outbox.closed = true);
    }

    /// Waits for something to send; `None` at the end.
    fn next(&self) -> Option<Parcel> {
        let mut outbox = self.outbox();
        loop {
            if outbox.closed {
                return None;
            }
            if !outbox.answers.is_empty() {
                return Some(Parcel::Answers(std::mem::take(&mut outbox.answers)));
            }
            if let Some(reply) = outbox.replies.pop_front() {
                return Some(Parcel::Reply(reply));
            }
            if let Some(state) = outbox.state.take() {
                return Some(Parcel::Reply(Reply::Text(state)));
            }
            if outbox.in_flight.len() < IN_FLIGHT
                && let Some(shot) = outbox.shot.take()
            {
                outbox.in_flight.push_back((shot.number, Instant::now()));
                return Some(Parcel::Shot(shot, outbox.pace));
            }
            outbox = self.wake.wait(outbox).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// The stream of the thread that reads: what the protocol answers goes to the thread that writes.
pub(super) struct Ear {
    pub(super) stream: TcpStream,
    pub(super) client: Arc<Client>,
}

impl io::Read for Ear {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        self.stream.read(bytes)
    }
}

impl Write for Ear {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // The protocol writes whole frames at once.
        self.client.change(|outbox| {
            outbox.answers.extend_from_slice(bytes);
            outbox.closed |= outbox.answers.len() > ANSWERS;
        });
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Sends all that is for a client, until it is closed or lost.
pub(super) fn send(stream: &TcpStream, client: &Client) {
    // A lost connection ends the thread that reads, too.
    let _ = send_all(stream, client);
    client.close();
    let _ = stream.shutdown(std::net::Shutdown::Both);
}

fn send_all(stream: &TcpStream, client: &Client) -> Result<(), tungstenite::Error> {
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    let mut socket = WebSocket::from_raw_socket(stream, Role::Server, None);
    deliver(client, |outgoing| match outgoing {
        Outgoing::Frames(frames) => Ok(socket.get_mut().write_all(&frames)?),
        Outgoing::Text(text) => socket.send(Message::text(text)),
        Outgoing::Binary(bytes) => socket.send(Message::binary(bytes)),
    })
}

/// A thing to write to a connection.
pub(super) enum Outgoing {
    /// Frames of the protocol of sockets.
    Frames(Vec<u8>),
    Text(String),
    /// A header and files.
    Binary(Vec<u8>),
}

/// Writes all that is for a client, until it is closed.
///
/// # Errors
/// Those of `write`, after which nothing is written.
pub(super) fn deliver<E>(
    client: &Client,
    mut write: impl FnMut(Outgoing) -> Result<(), E>,
) -> Result<(), E> {
    // The image that the page shows.
    let mut before: Option<Arc<Picture>> = None;
    while let Some(parcel) = client.next() {
        write(match parcel {
            Parcel::Answers(frames) => Outgoing::Frames(frames),
            Parcel::Reply(Reply::Text(text)) => Outgoing::Text(text),
            Parcel::Reply(Reply::File(header, file)) => Outgoing::Binary(framed(&header, &[&file])),
            Parcel::Shot(shot, pace) => {
                let message = packed(&shot, before.as_deref(), pace);
                before = Some(Arc::clone(&shot.picture));
                Outgoing::Binary(message)
            }
        })?;
    }
    Ok(())
}

/// Returns the message of an image; `before` is the one that the page shows.
fn packed(shot: &Shot, before: Option<&Picture>, pace: Pace) -> Vec<u8> {
    let picture = &*shot.picture;
    let begun = Instant::now();
    let (width, height) = picture.size();
    let whole = Tile { x: 0, y: 0, width, height };
    let is_preview = picture.samples == 0;
    let (tiles, files, kind) = if let Some(file) = shot.file() {
        (vec![whole], vec![file.to_vec()], "image/png")
    } else {
        // Previews are compared with nothing: all of them changes while the camera moves.
        let same = before.filter(|own| own.size() == (width, height) && !is_preview);
        let tiles = match same {
            Some(own) => tiles::changed(&own.pixels, &picture.pixels, width),
            None => tiles::strips(width, height),
        };
        let quality = if is_preview { pace.moving() } else { pace.resting() };
        let files = tiles::encode(&picture.pixels, width, &tiles, quality);
        (tiles, files, "image/jpeg")
    };
    let rate = picture.rays as f64 / picture.elapsed.as_secs_f64().max(1e-9);
    let places: Vec<_> = tiles
        .iter()
        .zip(&files)
        .map(|(tile, file)| json!([tile.x, tile.y, tile.width, tile.height, file.len()]))
        .collect();
    let header = json!({
        "picture": shot.number,
        "heard": shot.heard,
        "width": width,
        "height": height,
        "samples": picture.samples,
        "error": picture.noise.map(|noise| noise.error),
        "denoised": picture.before.is_some(),
        "rate": rate,
        "finished": shot.finished.is_some(),
        "drawn": shot.drawn,
        "kind": kind,
        "tiles": places,
        // Milliseconds, to measure.
        "times": {
            "wait": milliseconds(picture.started.saturating_duration_since(shot.asked)),
            "render": milliseconds(picture.elapsed),
            "queue": milliseconds(begun.saturating_duration_since(picture.started + picture.elapsed)),
            "encode": milliseconds(begun.elapsed()),
        },
    });
    let files: Vec<&[u8]> = files.iter().map(Vec::as_slice).collect();
    framed(&header.to_string(), &files)
}

fn milliseconds(time: Duration) -> f64 {
    1000.0 * time.as_secs_f64()
}

/// Returns the length of the header in four bytes, lowest first, the header and the files.
fn framed(header: &str, files: &[&[u8]]) -> Vec<u8> {
    let mut message = (header.len() as u32).to_le_bytes().to_vec();
    message.extend_from_slice(header.as_bytes());
    for file in files {
        message.extend_from_slice(file);
    }
    message
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_older_state_follows_a_mark() {
        let client = Client::default();
        client.state("before".into());
        client.mark("after".into());
        client.state("later".into());
        let texts = [(); 2].map(|()| match client.next() {
            Some(Parcel::Reply(Reply::Text(text))) => text,
            _ => String::new(),
        });
        assert_eq!(texts, ["after", "later"]);
        client.mark("last".into());
        client.close();
        assert!(client.next().is_none());
    }
}
