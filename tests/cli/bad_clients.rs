//! Bad clients of the viewer's page: random bytes, frames of sockets that break the protocol, commands without sense, and
//! connections that are left half open. Afterwards the page answers, and its memory has not grown.
//!
//! `SPHERULE_PAGE_SECONDS` says how long, and `SPHERULE_FUZZ_SEED` repeats a run.

use crate::folder::Folder;
use crate::page::{Server, is_finished};
use rand_xoshiro::SplitMix64;
use rand_xoshiro::rand_core::{Rng, SeedableRng};
use std::io::{Read, Write};
use std::net::{Shutdown, TcpStream};
use std::time::{Duration, Instant};

/// Seconds of the test, unless the environment says otherwise.
const SECONDS: u64 = 4;

/// Connections at once.
const CROWD: usize = 100;

/// Growth of memory that is allowed, in KiB: what allocators and pools of threads keep.
const GROWTH: u64 = 64 << 10;

/// Words of commands.
const WORDS: &str = "size scale key click double-click press move release drag wheel turn set camera unset frame hide show pick \
                     slice undo redo hover open plot download mark steer shown cancel periodic png exr toml raw \
                     color-by style select model slice-mode q z 'q z>1 id,0 1,2 3.5,-7 64x48 1e300 nan inf -1 0 \
                     99999999999999999999 size=8x8 spp=1 until-error=9% left shift steps=5 x.xyz \u{1F642} \\ \" ''";

struct Bad {
    random: SplitMix64,
    host: String,
    token: String,
}

impl Bad {
    fn below(&mut self, count: u64) -> u64 {
        self.random.next_u64() % count
    }

    fn bytes(&mut self, most: u64) -> Vec<u8> {
        let count = self.below(most) as usize;
        let mut bytes = vec![0; count];
        self.random.fill_bytes(&mut bytes);
        bytes
    }

    fn connect(&self) -> Option<TcpStream> {
        let stream = TcpStream::connect(&self.host).ok()?;
        let limit = Some(Duration::from_millis(20));
        stream.set_read_timeout(limit).ok()?;
        stream.set_write_timeout(Some(Duration::from_millis(500))).ok()?;
        Some(stream)
    }

    /// Opens a socket, which is one of a page.
    fn socket(&self) -> Option<TcpStream> {
        let mut stream = self.connect()?;
        write!(
            stream,
            "GET /{}/socket HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n\
             Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n",
            self.token, self.host
        )
        .ok()?;
        Some(stream)
    }

    /// Returns a request that is none, or nearly one.
    fn request(&mut self) -> Vec<u8> {
        let mut text = format!(
            "GET /{}/socket HTTP/1.1\r\nHost: {}\r\nUpgrade: websocket\r\n\r\n",
            self.token, self.host
        )
        .into_bytes();
        for _ in 0..self.below(6) {
            let at = self.below(text.len() as u64) as usize;
            text[at] = self.below(256) as u8;
        }
        let most = text.len() as u64 + 1;
        text.truncate(self.below(most) as usize);
        match self.below(4) {
            0 => self.bytes(40_000),
            1 => [&b"GET / HTTP/1.1\r\n"[..], &b"A: b\r\n".repeat(5000)].concat(),
            _ => text,
        }
    }

    fn line(&mut self) -> Vec<u8> {
        let words: Vec<&str> = WORDS.split_whitespace().collect();
        let count = 1 + self.below(4);
        let some = (0..count).map(|_| words[self.below(words.len() as u64) as usize]);
        let line: Vec<&str> = some.collect();
        line.join(" ").into_bytes()
    }

    /// Returns a frame of the protocol (RFC 6455, section 5.2), which is often wrong.
    fn frame(&mut self) -> Vec<u8> {
        let content = match self.below(6) {
            0 => self.bytes(70_000),
            1 => self.bytes(130),
            _ => self.line(),
        };
        let whole = self.below(5) > 0;
        let opcode = if self.below(2) == 0 { 1 } else { self.below(16) as u8 };
        let reserved = if self.below(12) == 0 { 0x70 & self.below(256) as u8 } else { 0 };
        let mask = if self.below(10) == 0 { 0 } else { 0x80 };
        let mut frame = vec![u8::from(whole) << 7 | reserved | opcode];
        let told = match self.below(12) {
            0 => self.random.next_u64(),
            1 => 1 << self.below(64),
            _ => content.len() as u64,
        };
        match told {
            0..=125 => frame.push(mask | told as u8),
            126..=0xFFFF => {
                frame.push(mask | 0x7E);
                frame.extend((told as u16).to_be_bytes());
            }
            _ => {
                frame.push(mask | 0x7F);
                frame.extend(told.to_be_bytes());
            }
        }
        if mask > 0 {
            let key = (self.random.next_u64() as u32).to_le_bytes();
            frame.extend(key);
            frame.extend(content.iter().enumerate().map(|(at, byte)| byte ^ key[at % 4]));
        } else {
            frame.extend(content);
        }
        frame
    }

    /// Does something bad; a connection that is left open is returned.
    fn act(&mut self) -> Option<TcpStream> {
        let mut read = vec![0; 1 << 16];
        match self.below(4) {
            0 => {
                let mut stream = self.connect()?;
                let bytes = self.request();
                // Which of these are refused is the server's choice.
                let _ = stream.write_all(&bytes);
                let _ = stream.read(&mut read);
                Some(stream)
            }
            1 => {
                let stream = self.connect()?;
                let _ = stream.shutdown(Shutdown::Write);
                Some(stream)
            }
            _ => {
                let mut stream = self.socket()?;
                for _ in 0..self.below(30) {
                    let frame = self.frame();
                    if stream.write_all(&frame).is_err() {
                        break;
                    }
                    if self.below(3) == 0 {
                        let _ = stream.read(&mut read);
                    }
                }
                (self.below(3) == 0).then_some(stream)
            }
        }
    }
}

/// Resident memory of a process in KiB; 0 where it is not told.
fn memory(id: u32) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"));
    line.and_then(|line| line.split_whitespace().next()?.parse().ok()).unwrap_or(0)
}

/// Waits until the page answers, and returns its memory.
#[track_caller]
fn settled(server: &Server) -> u64 {
    let start = Instant::now();
    while server.try_get().is_none() {
        // Half a request is waited for, five seconds.
        assert!(start.elapsed() < Duration::from_secs(30), "the page does not answer");
        std::thread::sleep(Duration::from_millis(100));
    }
    let mut page = server.page();
    page.send("steer");
    page.send("size 64x48");
    page.send("key r");
    page.image(|header| is_finished(header) && header["width"] == 64);
    page.send("size 80x60");
    page.image(|header| is_finished(header) && header["width"] == 80);
    memory(server.id())
}

#[test]
fn the_page_survives_bad_clients() {
    let number = |name: &str| std::env::var(name).ok().and_then(|text| text.parse().ok());
    let seconds = number("SPHERULE_PAGE_SECONDS").unwrap_or(SECONDS);
    let seed = number("SPHERULE_FUZZ_SEED").unwrap_or_else(|| {
        std::time::UNIX_EPOCH.elapsed().map_or(0, |time| time.as_micros() as u64)
    });
    let folder = Folder::new();
    folder.write("pair.xyz", "2\n\nNa 0 0 0\nCl 3 0 0\n");
    let server =
        Server::start(&folder, &["pair.xyz", "--radii", "1", "--spp", "1", "--threads", "1"]);
    let mut bad = Bad {
        random: SplitMix64::seed_from_u64(seed),
        host: server.host().to_owned(),
        token: server.token().to_owned(),
    };
    // Pools and allocators have what they need after as many connections at once.
    let warm: Vec<Option<TcpStream>> = (0..CROWD).map(|_| bad.act()).collect();
    drop(warm);
    let before = settled(&server);
    let start = Instant::now();
    let mut acts = 0;
    while start.elapsed() < Duration::from_secs(seconds) {
        let open: Vec<Option<TcpStream>> = (0..CROWD).map(|_| bad.act()).collect();
        acts += open.len();
    }
    let after = settled(&server);
    let told = format!(
        "{before} KiB before, {after} KiB after {acts} connections, SPHERULE_FUZZ_SEED={seed}"
    );
    assert!(after <= before + GROWTH, "{told}");
}

#[test]
fn silent_connections_make_room_for_others() {
    let folder = Folder::new();
    folder.write("pair.xyz", "2\n\nNa 0 0 0\nCl 3 0 0\n");
    let server = Server::start(&folder, &["pair.xyz", "--radii", "1", "--spp", "1"]);
    let silent: Vec<_> = (0..CROWD).map(|_| TcpStream::connect(server.host())).collect();
    assert!(silent.iter().all(Result::is_ok));
    assert!(server.try_get().is_some(), "the page does not answer");
}
