//! The server of the page: connections, the page's files, and its WebSocket.

use super::client::{Client, Ear, send};
use super::http::{Door, Head, Status, accept_socket, read_head, reply};
use std::collections::VecDeque;
use std::io;
use std::net::{Shutdown, TcpListener, TcpStream};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::SyncSender;
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::Duration;
use tungstenite::protocol::{Message, Role, WebSocket, WebSocketConfig};

/// Maximum number of connections.
const MOST: usize = 64;

/// Maximum length of a message from a page in bytes.
const LONGEST: usize = 1 << 16;

/// The page's files.
pub(super) const FILES: [(&str, &str, &str); 4] = [
    ("", "text/html; charset=utf-8", include_str!("page/index.html")),
    ("page.css", "text/css; charset=utf-8", include_str!("page/page.css")),
    ("page.js", "text/javascript; charset=utf-8", include_str!("page/page.js")),
    ("icon.svg", "image/svg+xml", include_str!("page/icon.svg")),
];

/// Actions of pages.
pub(super) enum Call {
    Joined(u64, Arc<Client>),
    /// A page has shown an image.
    Shown,
    /// A page sent a command.
    Line(u64, String),
    /// A page sent a part of a file.
    Bytes(u64, Vec<u8>),
    Left(u64),
}

/// A connection's share of those that are allowed.
struct Seat(Arc<AtomicUsize>);

impl Drop for Seat {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

/// Connections that have not said what they want, the oldest first: they make room for others.
#[derive(Default)]
struct Silent(Mutex<VecDeque<(u64, TcpStream)>>);

impl Silent {
    fn enter(&self, number: u64, stream: &TcpStream) {
        if let (Ok(mut silent), Ok(stream)) = (self.0.lock(), stream.try_clone()) {
            silent.push_back((number, stream));
        }
    }

    fn leave(&self, number: u64) {
        if let Ok(mut silent) = self.0.lock() {
            silent.retain(|(own, _)| *own != number);
        }
    }

    /// Ends the oldest connection; returns false if there is none.
    fn end_oldest(&self) -> bool {
        let oldest = self.0.lock().ok().and_then(|mut silent| silent.pop_front());
        // One that the other side has closed makes room, too.
        oldest.inspect(|(_, stream)| drop(stream.shutdown(Shutdown::Both))).is_some()
    }
}

/// Accepts connections for ever.
pub(super) fn serve<T: From<Call> + Send + 'static>(
    listener: &TcpListener,
    door: &Arc<Door>,
    calls: &SyncSender<T>,
) {
    let (seats, next) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicU64::new(0)));
    let silent = Arc::new(Silent::default());
    for (number, stream) in (0..).zip(listener.incoming()) {
        let Ok(stream) = stream else {
            // Too many open files, perhaps: others may close.
            thread::sleep(Duration::from_millis(100));
            continue;
        };
        let seat = Seat(Arc::clone(&seats));
        if seats.fetch_add(1, Ordering::Relaxed) >= MOST && !silent.end_oldest() {
            continue;
        }
        silent.enter(number, &stream);
        let (door, calls, next) = (Arc::clone(door), calls.clone(), Arc::clone(&next));
        let silent = Arc::clone(&silent);
        let answer = move || {
            let (_seat, mut stream) = (seat, stream);
            let head = read_head(&mut stream);
            silent.leave(number);
            // A connection that is lost ends here.
            let _ = answer(stream, head, &door, &calls, &next);
        };
        // Without a thread the connection is closed.
        let _ = thread::Builder::new().spawn(answer);
    }
}

fn answer<T: From<Call>>(
    mut stream: TcpStream,
    head: Result<Head, Status>,
    door: &Door,
    calls: &SyncSender<T>,
    next: &AtomicU64,
) -> io::Result<()> {
    stream.set_write_timeout(Some(Duration::from_secs(10)))?;
    let head = match head {
        Ok(head) => head,
        Err(status) => return reply(&mut stream, status, "text/plain", b""),
    };
    match (door.admit(&head), &head.key) {
        (Err(status), _) => reply(&mut stream, status, "text/plain", b""),
        (Ok("socket"), Some(key)) => {
            accept_socket(&mut stream, key)?;
            let number = next.fetch_add(1, Ordering::Relaxed);
            converse(stream, number, calls)
        }
        (Ok(path), _) => match FILES.iter().find(|(name, ..)| *name == path) {
            Some((_, kind, text)) => reply(&mut stream, Status::Ok, kind, text.as_bytes()),
            None => reply(&mut stream, Status::NotFound, "text/plain", b""),
        },
    }
}

/// Reads what a page sends, until it leaves.
fn converse<T: From<Call>>(
    stream: TcpStream,
    number: u64,
    calls: &SyncSender<T>,
) -> io::Result<()> {
    stream.set_read_timeout(None)?;
    let client = Arc::new(Client::default());
    let (writer, own) = (stream.try_clone()?, Arc::clone(&client));
    let sender = thread::Builder::new().spawn(move || send(&writer, &own))?;
    let config =
        WebSocketConfig::default().max_message_size(Some(LONGEST)).max_frame_size(Some(LONGEST));
    let ear = Ear { stream, client: Arc::clone(&client) };
    let mut socket = WebSocket::from_raw_socket(ear, Role::Server, Some(config));
    let call = |call| calls.send(T::from(call)).is_ok();
    let mut goes_on = call(Call::Joined(number, Arc::clone(&client)));
    while goes_on {
        goes_on = match socket.read() {
            Ok(Message::Text(text)) => match text.strip_prefix("shown ") {
                Some(shown) => {
                    shown.parse().into_iter().for_each(|shown| client.shown(shown));
                    call(Call::Shown)
                }
                None => call(Call::Line(number, text.to_string())),
            },
            Ok(Message::Binary(bytes)) => call(Call::Bytes(number, bytes.to_vec())),
            Ok(Message::Ping(_) | Message::Pong(_)) => true,
            Ok(_) | Err(_) => false,
        };
    }
    client.close();
    call(Call::Left(number));
    let _ = sender.join();
    Ok(())
}
