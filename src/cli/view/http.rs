//! Requests of browsers: their heads, the checks that keep others out, and replies (RFC 9112).

use std::io::{self, Read, Write};
use std::net::{IpAddr, TcpStream};
use std::time::{Duration, Instant};

/// Maximum length of a head, and the time within which it must arrive.
const LONGEST: usize = 16 << 10;
const PATIENCE: Duration = Duration::from_secs(5);

/// Maximum number of header fields.
const FIELDS: usize = 64;

/// The parts of a request's head that matter here.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Head {
    /// Path without its query.
    pub(super) path: String,
    host: String,
    origin: Option<String>,
    /// Key of a WebSocket, if the request asks for one.
    pub(super) key: Option<String>,
}

/// Guard against others: the secret part of the path, and the name that was listened at.
#[derive(Clone, Debug)]
pub(super) struct Door {
    pub(super) token: String,
    pub(super) address: String,
}

/// Status codes of replies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    Ok,
    BadRequest,
    Forbidden,
    NotFound,
}

impl Status {
    fn line(self) -> &'static str {
        match self {
            Self::Ok => "200 OK",
            Self::BadRequest => "400 Bad Request",
            Self::Forbidden => "403 Forbidden",
            Self::NotFound => "404 Not Found",
        }
    }
}

/// Reads the head of a request.
///
/// # Errors
/// The request is not a GET of HTTP/1.1 that can be understood, or the connection is slow or lost.
pub(super) fn read_head(stream: &mut TcpStream) -> Result<Head, Status> {
    let deadline = Instant::now() + PATIENCE;
    let mut bytes = Vec::new();
    let mut chunk = [0; 4096];
    while !bytes.windows(4).any(|four| four == b"\r\n\r\n") {
        let left = deadline.saturating_duration_since(Instant::now());
        if bytes.len() > LONGEST || left.is_zero() {
            return Err(Status::BadRequest);
        }
        let read = stream.set_read_timeout(Some(left)).and_then(|()| stream.read(&mut chunk));
        match read {
            Ok(count) if count > 0 => bytes.extend_from_slice(&chunk[..count]),
            _ => return Err(Status::BadRequest),
        }
    }
    parse(&bytes).ok_or(Status::BadRequest)
}

fn parse(bytes: &[u8]) -> Option<Head> {
    let mut fields = [httparse::EMPTY_HEADER; FIELDS];
    let mut request = httparse::Request::new(&mut fields);
    if !request.parse(bytes).ok()?.is_complete() || request.method? != "GET" {
        return None;
    }
    let field = |name: &str| {
        let own = request.headers.iter().find(|own| own.name.eq_ignore_ascii_case(name));
        own.and_then(|own| std::str::from_utf8(own.value).ok()).map(str::to_owned)
    };
    let path = request.path?.split('?').next()?.to_owned();
    let upgrades = field("Upgrade").is_some_and(|value| value.eq_ignore_ascii_case("websocket"));
    let versioned = field("Sec-WebSocket-Version").is_some_and(|version| version == "13");
    let key = field("Sec-WebSocket-Key").filter(|_| upgrades && versioned);
    Some(Head { path, host: field("Host")?, origin: field("Origin"), key })
}

impl Door {
    /// Returns the path after the token, for a request that may come in.
    ///
    /// A page of another site can make a browser send requests, and can give its own name the address of this machine (DNS
    /// rebinding): the host must be an address in digits, this machine, or the name that was listened at, and the origin
    /// the host. The token keeps out other users of this machine.
    pub(super) fn admit<'a>(&self, head: &'a Head) -> Result<&'a str, Status> {
        let own_page = |origin: &String| {
            let host = origin.strip_prefix("http://").or_else(|| origin.strip_prefix("https://"));
            host == Some(&head.host)
        };
        let name = host_name(&head.host);
        let known = name == "localhost" || name == self.address || name.parse::<IpAddr>().is_ok();
        let path = head.path.strip_prefix('/').unwrap_or_default();
        let (token, rest) = path.split_once('/').unwrap_or((path, ""));
        if known && head.origin.as_ref().is_none_or(own_page) && is_same(token, &self.token) {
            Ok(rest)
        } else {
            Err(Status::Forbidden)
        }
    }
}

/// Returns the host without its port.
fn host_name(host: &str) -> &str {
    match host.strip_prefix('[') {
        Some(rest) => rest.split(']').next().unwrap_or_default(),
        None => host.rsplit_once(':').map_or(host, |(name, _)| name),
    }
}

/// Compares in a time that does not depend on where the texts differ.
fn is_same(a: &str, b: &str) -> bool {
    let differs = a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b));
    a.len() == b.len() && differs == 0
}

/// Sends a reply, which ends the connection.
pub(super) fn reply(
    stream: &mut TcpStream,
    status: Status,
    kind: &str,
    content: &[u8],
) -> io::Result<()> {
    let head = format!(
        "HTTP/1.1 {}\r\nContent-Type: {kind}\r\nContent-Length: {}\r\nConnection: close\r\n\
         Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n\
         Content-Security-Policy: default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
         connect-src 'self'; frame-ancestors 'none'\r\n\r\n",
        status.line(),
        content.len()
    );
    stream.write_all(head.as_bytes())?;
    stream.write_all(content)?;
    stream.flush()
}

/// Accepts a WebSocket of this key (RFC 6455, section 4.2.2).
pub(super) fn accept_socket(stream: &mut TcpStream, key: &str) -> io::Result<()> {
    let accept = tungstenite::handshake::derive_accept_key(key.as_bytes());
    let head = format!(
        "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
         Sec-WebSocket-Accept: {accept}\r\n\r\n"
    );
    stream.write_all(head.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn head(path: &str, host: &str, origin: Option<&str>) -> Head {
        let origin = origin.map_or(String::new(), |origin| format!("Origin: {origin}\r\n"));
        let text = format!("GET {path} HTTP/1.1\r\nHost: {host}\r\n{origin}\r\n");
        parse(text.as_bytes()).expect("a head")
    }

    #[test]
    fn only_the_own_page_with_the_token_comes_in() {
        let door = Door { token: "abc".into(), address: "box.lan".into() };
        let admit = |path: &str, host: &str, origin: Option<&str>| {
            door.admit(&head(path, host, origin)).map(str::to_owned)
        };
        for host in ["127.0.0.1:8000", "localhost:9", "[::1]:80", "box.lan:8000", "192.168.0.7:1"] {
            assert_eq!(admit("/abc/", host, None), Ok(String::new()), "{host}");
            let origin = format!("http://{host}");
            assert_eq!(admit("/abc/socket?a", host, Some(&origin)), Ok("socket".into()), "{host}");
        }
        for (path, host, origin) in [
            ("/abd/", "localhost:1", None),
            ("/", "localhost:1", None),
            ("/abcd/", "localhost:1", None),
            ("/abc/", "evil.example:1", None),
            ("/abc/", "127.0.0.1.evil.example", None),
            ("/abc/", "localhost:1", Some("http://evil.example")),
            ("/abc/", "localhost:1", Some("http://localhost:2")),
            ("/abc/", "localhost:1", Some("null")),
        ] {
            assert_eq!(admit(path, host, origin), Err(Status::Forbidden), "{path} {host}");
        }
    }

    #[test]
    fn other_requests_are_no_heads() {
        for text in [
            "POST / HTTP/1.1\r\nHost: a\r\n\r\n",
            "GET / HTTP/1.1\r\n\r\n",
            "GET\r\n\r\n",
            "\r\n\r\n",
            "GET / HTTP/1.1\r\nHost: a\r\n",
            "\u{16}\u{3}\u{1}\r\n\r\n",
        ] {
            assert_eq!(parse(text.as_bytes()), None, "{text:?}");
        }
        let many = "A: b\r\n".repeat(FIELDS + 1);
        assert_eq!(parse(format!("GET / HTTP/1.1\r\nHost: a\r\n{many}\r\n").as_bytes()), None);
    }

    #[test]
    fn sockets_need_their_version_and_key() {
        let text = "GET / HTTP/1.1\r\nHost: a\r\nUpgrade: WebSocket\r\nSec-WebSocket-Version: 13\r\n\
                    Sec-WebSocket-Key: abc\r\n\r\n";
        let key = |text: &str| parse(text.as_bytes()).and_then(|head| head.key);
        assert_eq!(key(text), Some("abc".into()));
        assert_eq!(key(&text.replace("13", "12")), None);
        assert_eq!(key(&text.replace("WebSocket\r", "h2c\r")), None);
    }
}
