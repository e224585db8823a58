//! The page of the viewer: its server, its protocol, and what bad clients get.

use crate::folder::Folder;
use crate::process::{Process, wait_for};
use serde_json::Value;
use spherule_render::image::Image;
use std::fs::{File, read_to_string};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

/// Time limit of everything that comes over a connection.
const LIMIT: Duration = Duration::from_secs(60);

const SALT: &str = "\
4
Properties=species:S:1:pos:R:3:q:R:1
Na 0 0 0 1
Cl 3 0 0 -1
Cl 0 3 0 -2
K 0 0 3 1
";

/// A running viewer.
pub(crate) struct Server {
    process: Process,
    /// `127.0.0.1:PORT`.
    host: String,
    token: String,
}

impl Server {
    pub(crate) fn start(folder: &Folder, args: &[&str]) -> Self {
        let file = File::create(folder.path("address.txt")).expect("a file");
        let mut command = folder.command(&[&["view", "--no-browser"], args].concat());
        std::fs::create_dir_all(folder.path("tmp")).expect("a folder");
        command.env("TMPDIR", folder.path("tmp"));
        let process = Process::start(command.stdout(file));
        let read = || read_to_string(folder.path("address.txt")).expect("a file");
        wait_for("the address", || read().ends_with('\n'));
        let text = read();
        let (host, token) = text
            .trim()
            .strip_prefix("http://")
            .and_then(|rest| rest.trim_end_matches('/').split_once('/'))
            .expect("an address");
        Self { process, host: host.to_owned(), token: token.to_owned() }
    }

    fn connect(&self) -> TcpStream {
        let stream = TcpStream::connect(&self.host).expect("a connection");
        stream.set_read_timeout(Some(LIMIT)).expect("a limit");
        stream
    }

    /// Sends a request, and returns the status and the content.
    fn get(&self, path: &str, host: &str, more: &str) -> (u16, String) {
        let mut stream = self.connect();
        write!(stream, "GET {path} HTTP/1.1\r\nHost: {host}\r\n{more}\r\n").expect("a request");
        let mut reply = String::new();
        stream.read_to_string(&mut reply).expect("a reply");
        let status = reply.split(' ').nth(1).and_then(|code| code.parse().ok()).expect("a status");
        let content = reply.split_once("\r\n\r\n").map(|(_, content)| content.to_owned());
        (status, content.unwrap_or_default())
    }

    /// Returns the page, unless it is not answered.
    pub(crate) fn try_get(&self) -> Option<String> {
        let mut stream = TcpStream::connect(&self.host).ok()?;
        stream.set_read_timeout(Some(LIMIT)).ok()?;
        let Self { host, token, .. } = self;
        write!(stream, "GET /{token}/ HTTP/1.1\r\nHost: {host}\r\n\r\n").ok()?;
        let mut reply = String::new();
        stream.read_to_string(&mut reply).ok()?;
        reply.starts_with("HTTP/1.1 200").then_some(reply)
    }

    pub(crate) fn host(&self) -> &str {
        &self.host
    }

    pub(crate) fn token(&self) -> &str {
        &self.token
    }

    /// Number of its process.
    pub(crate) fn id(&self) -> u32 {
        self.process.id()
    }

    /// Opens the page's socket.
    pub(crate) fn page(&self) -> Page {
        let address = format!("ws://{}/{}/socket", self.host, self.token);
        let request = address.into_client_request().expect("a request");
        let (socket, _) = tungstenite::client(request, self.connect()).expect("a socket");
        Page { socket, state: Value::Null, errors: Vec::new(), plot: Vec::new(), mark: Value::Null }
    }
}

/// A page that reads what comes.
pub(crate) struct Page {
    socket: WebSocket<TcpStream>,
    state: Value,
    errors: Vec<String>,
    /// Values over the frames.
    plot: Vec<Value>,
    /// The last mark that was answered.
    mark: Value,
}

/// An image as it comes: its header and files.
pub(crate) struct Sent {
    header: Value,
    files: Vec<Vec<u8>>,
}

impl Page {
    pub(crate) fn send(&mut self, line: &str) {
        self.socket.send(Message::text(line)).expect("a message");
    }

    /// Reads a message, and acknowledges it if it is an image.
    fn read(&mut self) -> Option<Sent> {
        let read = self.socket.read();
        match read.unwrap_or_else(|error| panic!("{error}: {:?}", self.errors)) {
            Message::Text(text) => {
                let message: Value = serde_json::from_str(&text).expect("JSON");
                if !message["state"].is_null() {
                    self.state = message["state"].clone();
                }
                self.plot
                    .extend(message["plot"]["values"].as_array().into_iter().flatten().cloned());
                self.mark = message["mark"].clone();
                self.errors.extend(message["error"].as_str().map(str::to_owned));
                None
            }
            Message::Binary(bytes) => {
                let (length, rest) = bytes.split_at(4);
                let length = u32::from_le_bytes(length.try_into().expect("four bytes")) as usize;
                let header: Value = serde_json::from_slice(&rest[..length]).expect("JSON");
                if let Some(number) = header["picture"].as_u64() {
                    self.send(&format!("shown {number}"));
                }
                let mut start = length;
                let empty = Vec::new();
                let tiles = header["tiles"].as_array().unwrap_or(&empty);
                let mut files: Vec<Vec<u8>> = tiles
                    .iter()
                    .map(|tile| {
                        let size = tile[4].as_u64().expect("a size") as usize;
                        start += size;
                        rest[start - size..start].to_vec()
                    })
                    .collect();
                if files.is_empty() {
                    files.push(rest[start..].to_vec());
                }
                Some(Sent { header, files })
            }
            _ => None,
        }
    }

    /// Reads until an image has a property.
    pub(crate) fn image(&mut self, is_wanted: impl Fn(&Value) -> bool) -> Sent {
        loop {
            if let Some(sent) = self.read().filter(|sent| is_wanted(&sent.header)) {
                return sent;
            }
        }
    }

    /// Reads until the state has a property.
    fn until(&mut self, is_wanted: impl Fn(&Value) -> bool) {
        while !is_wanted(&self.state) {
            self.read();
        }
    }

    /// Reads until a command is refused, and returns why.
    fn error(&mut self) -> String {
        while self.errors.is_empty() {
            self.read();
        }
        self.errors.remove(0)
    }
}

pub(crate) fn is_finished(header: &Value) -> bool {
    header["finished"] == true
}

#[test]
fn the_page_is_served_with_its_token_alone() {
    let folder = Folder::new();
    let server = Server::start(&folder, &[]);
    let Server { host, token, .. } = &server;
    let (status, page) = server.get(&format!("/{token}/"), host, "");
    assert!(status == 200 && page.contains("page.js"), "{status}");
    for name in ["page.css", "page.js", "icon.svg"] {
        assert_eq!(server.get(&format!("/{token}/{name}"), host, "").0, 200, "{name}");
    }
    let port = host.rsplit_once(':').expect("a port").1;
    assert_eq!(server.get(&format!("/{token}/"), &format!("localhost:{port}"), "").0, 200);
    for (path, name, more) in [
        ("/", host.as_str(), ""),
        ("/0123456789abcdef0123456789abcdef/", host, ""),
        (&format!("/{token}/"), "evil.example", ""),
        (&format!("/{token}/"), host, "Origin: http://evil.example\r\n"),
    ] {
        assert_eq!(server.get(path, name, more), (403, String::new()), "{path} {name}");
    }
    for path in ["../Cargo.toml", "etc/passwd", "%2e%2e/", "socket"] {
        assert_eq!(server.get(&format!("/{token}/{path}"), host, "").0, 404, "{path}");
    }
}

#[test]
fn the_finished_image_is_the_file_of_the_command_line() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let server = Server::start(&folder, &["salt.xyz", "--radii", "1", "--spp", "3"]);
    let mut page = server.page();
    page.send("size 64x48");
    page.send("drag 10,10 40,20 steps=3");
    page.send("set color-by q");
    page.send("hide K");
    page.send("set style 'q < 0: color=red'");
    page.send("key d");
    page.send("key o");
    page.send("key d");
    page.send("download png");
    let file = page.image(|header| header["file"] == "view.png").files.remove(0);
    let is_shown = |state: &Value| state["busy"] == false && state["sampled"] == 3;
    page.until(|state| is_shown(state) && state["hidden"][0] == "K" && state["outline"] == true);
    let line = page.state["command"].as_str().expect("a command").to_owned();
    let words = shlex::split(&line).expect("words");
    let words: Vec<&str> = words.iter().skip(1).map(String::as_str).collect();
    folder.succeed(&[&words[..], &["--quiet"]].concat());
    std::fs::write(folder.path("page.png"), &file).expect("a file");
    let read = |name: &str| Image::read(folder.path(name)).expect("a picture");
    assert!(read("view.png") == read("page.png"), "{line}");
}

#[test]
fn commands_change_the_view_and_bad_ones_are_refused() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let server = Server::start(&folder, &["salt.xyz", "--spp", "2"]);
    let mut page = server.page();
    page.send("size 40x30");
    page.until(|state| state["spheres"] == 4 && state["loading"].is_null());
    page.send("set select 'q < 0'");
    page.until(|state| state["spheres"] == 2);
    page.send("undo");
    page.until(|state| state["spheres"] == 4 && state["redo"] == true);
    for line in [
        "set select 'q <'",
        "set output x.png",
        "set topology /etc/passwd",
        "set camera /etc/passwd",
        "set color-bar x.svg",
        "set model cubes",
        "nonsense",
        "drag",
        "'",
        "save x.png",
        "window x.png",
        "wait 2",
        "quit",
    ] {
        page.send(line);
        assert!(!page.error().is_empty(), "{line}");
    }
    // What the file has not is found while it is loaded.
    page.send("set color-by nothing");
    page.until(|state| state["message"].as_str().is_some_and(|text| text.contains("nothing")));
    page.until(|state| state["options"]["color-by"].is_null());
    page.send("hover 20,15");
    page.send("set color-by q");
    page.until(|state| !state["legend"].is_null());
    assert!(page.errors.is_empty(), "{:?}", page.errors);
    assert!(!folder.path("x.png").exists(), "pages write no files");
}

#[test]
fn selected_particles_are_marked_beside_the_image() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let server = Server::start(&folder, &["salt.xyz", "--radii", "1", "--spp", "2"]);
    let mut page = server.page();
    page.send("size 64x48");
    let plain = page.image(|header| is_finished(header) && header["width"] == 64);
    assert_eq!(plain.header["drawn"]["marks"].as_array().map(Vec::len), Some(0));
    let ids = |state: &Value| {
        let picked = state["picked"].as_array().map_or(&[][..], Vec::as_slice);
        picked.iter().filter_map(|own| own["id"].as_f64()).collect::<Vec<_>>()
    };
    for (line, expected) in [
        ("pick 'q < 0'", &[1.0, 2.0][..]),
        ("pick 'id 3' 'id 0' 'x == 0'", &[3.0, 0.0, 2.0]),
        ("pick 'type Na or radius > 3'", &[0.0]),
        ("pick", &[]),
        ("pick 'id 3 1'", &[1.0, 3.0]),
    ] {
        page.send(line);
        page.send(&format!("mark {line}"));
        page.until(|state| ids(state) == expected);
        assert!(page.errors.is_empty(), "{line}: {:?}", page.errors);
        assert_eq!(
            page.state["drawn"]["marks"].as_array().map(Vec::len),
            Some(expected.len()),
            "{line}"
        );
    }
    // They follow the camera, and the saved image has none.
    let before = page.state["drawn"]["marks"].clone();
    page.send("turn 40 0");
    page.image(|header| {
        let marks = &header["drawn"]["marks"];
        is_finished(header) && marks[0].is_array() && *marks != before
    });
    page.send("turn -40 0");
    page.until(|state| state["measures"][0]["text"].is_string());
    page.send("key r");
    page.send("download png");
    let saved = page.image(|header| header["file"] == "view.png").files.remove(0);
    assert!(saved == plain.files[0], "marks are in the file");
    for line in ["pick 'q <'", "pick 'nothing > 1'"] {
        page.send(line);
        assert!(!page.error().is_empty(), "{line}");
    }
    page.until(|state| ids(state) == [1.0, 3.0]);
}

#[test]
fn one_page_steers_and_others_look() {
    let folder = Folder::new();
    let server = Server::start(&folder, &["--spp", "1"]);
    // The page that is there first steers.
    let mut first = server.page();
    first.until(|state| state["pages"] == 1);
    let mut second = server.page();
    first.send("size 40x30");
    let sent = first.image(|header| is_finished(header) && header["width"] == 40);
    assert_eq!(sent.header["kind"], "image/png");
    second.image(|header| header["width"] == 40);
    second.send("key 5");
    assert!(second.error().contains("steers"));
    second.send("steer");
    second.send("size 48x30");
    second.image(|header| header["width"] == 48);
    first.send("key 5");
    assert!(first.error().contains("steers"));
    drop(second);
    first.until(|state| state["pages"] == 1);
    first.send("size 52x30");
    first.image(|header| header["width"] == 52);
}

#[test]
fn missing_files_are_told_before_an_address() {
    let folder = Folder::new();
    for name in ["missing.xyz", "missing.toml"] {
        let output = folder.run(&["view", "--no-browser", name]);
        assert!(!output.status.success() && output.stdout.is_empty(), "{output:?}");
        assert!(String::from_utf8_lossy(&output.stderr).contains(name), "{output:?}");
    }
}

#[test]
fn motions_are_seen_at_last_and_told_ten_times_a_second() {
    let folder = Folder::new();
    let server = Server::start(&folder, &["--spp", "1"]);
    let mut page = server.page();
    page.send("size 64x48");
    page.image(is_finished);
    page.send("press 10,10");
    let start = Instant::now();
    for step in 0..100 {
        page.send(&format!("move {},{}", 20 + step % 30, 10 + step));
    }
    let mut states = 0;
    // The size, the press and all motions.
    while page.read().is_none_or(|sent| sent.header["heard"] != 102) {
        states += u128::from(page.state.take() != Value::Null);
    }
    let most = 3 + start.elapsed().as_millis() / 100;
    assert!(states <= most, "{states} states, at most {most}");
    page.send("release");
    let finished = page.image(is_finished);
    for stage in ["wait", "render", "queue", "encode"] {
        let time = finished.header["times"][stage].as_f64();
        assert!(time.is_some_and(|time| time >= 0.0), "{stage}: {time:?}");
    }
}

#[test]
fn frames_of_long_files_are_counted_while_the_first_is_seen() {
    let folder = Folder::new();
    let comment = "x".repeat(1_000_000);
    let frame = |x: u32| format!("2\n{comment}\nC 0 0 0\nC {x}.5 0 0\n");
    let frames: String = (0..70).map(frame).collect();
    folder.write("long.xyz", &frames);
    let server = Server::start(&folder, &["long.xyz", "--radii", "0.4", "--spp", "1"]);
    let mut page = server.page();
    page.send("size 40x30");
    page.until(|state| state["frames"] == 70);
    for frame in [69, 3, 4, 70] {
        page.send(&format!("frame {frame}"));
        let last = frame.min(69);
        page.until(|state| state["frame"] == last && state["busy"] == false);
    }
    page.until(|state| state["frames"] == 70);
}

#[test]
fn bad_clients_cost_nothing() {
    let folder = Folder::new();
    let mut server = Server::start(&folder, &["--spp", "1"]);
    let mut held = Vec::new();
    let head = vec![b'a'; 20_000];
    for round in 0..40 {
        let mut stream = server.connect();
        // Half open, garbage, a head without an end, and one of a socket that sends no frames.
        let sent: &[u8] = match round % 4 {
            0 => b"",
            1 => b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
            2 => &head,
            _ => b"GET / HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\n\r\n",
        };
        // It may be closed while it sends.
        let _ = stream.write_all(sent);
        if round % 2 == 0 {
            held.push(stream);
        }
    }
    let mut silent = server.page();
    silent.send("size 640x480");
    // It reads nothing, and floods.
    for _ in 0..2000 {
        silent.send("turn 1 0");
    }
    let mut long = server.page();
    // Longer than any command: the connection is closed.
    let _ = long.socket.send(Message::text("x".repeat(1 << 20)));
    while long.socket.read().is_ok() {}
    let mut page = server.page();
    page.send("steer");
    page.send("size 40x30");
    page.image(|header| header["width"] == 40);
    assert!(server.process.status().is_none(), "it runs");
}

#[test]
fn files_of_any_size_are_those_of_the_command_line_that_is_told() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let server = Server::start(&folder, &["salt.xyz", "--radii", "1", "--spp", "2"]);
    let mut page = server.page();
    page.send("size 64x48");
    page.send("drag 10,10 40,20 steps=3");
    page.image(is_finished);
    for choices in ["png size=100x60 spp=5", "exr size=80x60 until-error=20%"] {
        page.send(&format!("download {choices}"));
        let sent = page.image(|header| header["file"].is_string());
        let line = sent.header["command"].as_str().expect("a command").to_owned();
        let words = shlex::split(&line).expect("words");
        let words: Vec<&str> = words.iter().skip(1).map(String::as_str).collect();
        folder.succeed(&[&words[..], &["--quiet"]].concat());
        let name = sent.header["file"].as_str().expect("a name");
        assert!(folder.read(name) == sent.files[0], "{line}");
    }
    for (line, word) in [
        ("download png size=0x5", "size"),
        ("download png spp=many", "spp"),
        ("download png output=x.png", "output"),
        ("download xyz size=8x8", "xyz"),
    ] {
        page.send(line);
        let error = page.error();
        assert!(error.contains(word), "{line}: {error}");
    }
    page.send("download png size=4000x4000 spp=100000");
    page.send("download png size=64x64");
    assert!(page.error().contains("cancel"));
    // Looking goes on meanwhile, and another file can follow.
    page.send("turn 20 0");
    page.image(is_finished);
    page.send("download cancel");
    page.send("download jpg size=40x30 spp=1");
    page.image(|header| header["file"] == "view.jpg");
    assert!(page.errors.is_empty(), "{:?}", page.errors);
}

#[test]
fn files_of_scenes_are_rendered_beside_the_view() {
    let folder = Folder::new();
    let server = Server::start(&folder, &["--spp", "1"]);
    let mut page = server.page();
    page.send("size 64x48");
    page.image(is_finished);
    page.send("download png size=40x30 spp=2");
    let sent = page.image(|header| header["file"] == "view.png");
    std::fs::write(folder.path("page.png"), &sent.files[0]).expect("a file");
    let image = Image::read(folder.path("page.png")).expect("a picture");
    assert_eq!((image.width, image.height), (40, 30));
}

#[test]
fn slices_are_moved_along_their_normals() {
    let folder = Folder::new();
    folder.write("salt.xyz", SALT);
    let args =
        ["salt.xyz", "--radii", "1", "--spp", "1", "--slice", "z>50%", "--slice-mode", "caps"];
    let server = Server::start(&folder, &args);
    let mut page = server.page();
    page.send("size 64x48");
    page.image(|header| is_finished(header) && header["drawn"]["handles"][0].is_array());
    page.until(|state| state["slices"][0]["distance"] == 1.5);
    assert_eq!(page.state["slices"][0]["range"], serde_json::json!([-1.0, 4.0]));
    page.send("slice 0 2.25");
    page.until(|state| state["slices"][0]["distance"] == 2.25 && state["busy"] == false);
    assert_eq!(page.state["options"]["slice"], serde_json::json!(["z>2.25"]));
    // One that is drawn is moved, too, and taken back.
    page.send("key x");
    page.send("drag 32,47 32,0");
    page.until(|state| state["slices"][1]["distance"].is_number() && state["busy"] == false);
    let before = page.state["slices"][1]["distance"].as_f64().expect("a number");
    page.send(&format!("slice 1 {}", before + 0.5));
    let after = |state: &Value| state["slices"][1]["distance"].as_f64().unwrap_or(before);
    page.until(|state| after(state) > before + 0.4 && state["busy"] == false);
    page.send("undo");
    page.until(|state| after(state) == before && state["busy"] == false);
    for line in ["slice 2 1", "slice 0 nan", "slice -1 0"] {
        page.send(line);
        assert!(!page.error().is_empty(), "{line}");
    }
}

#[test]
fn measures_are_told_for_each_frame() {
    let folder = Folder::new();
    let frame = |x: u32| format!("2\n\nNa 0 0 0\nCl {x} 0 0\n");
    let frames: String = (1..=9).map(frame).collect();
    folder.write("run.xyz", &(frames + "1\n\nNa 0 0 0\n"));
    let server = Server::start(&folder, &["run.xyz", "--radii", "0.4", "--spp", "1"]);
    let mut page = server.page();
    page.send("size 40x30");
    page.until(|state| state["frames"] == 10);
    page.send("plot");
    assert!(page.error().contains("particles"));
    page.send("pick 'id 0' 'id 1'");
    page.until(|state| state["measures"][0]["text"].is_string());
    page.send("plot");
    while page.plot.last() != Some(&Value::Null) {
        page.read();
    }
    let values: Vec<Option<f64>> = page.plot.iter().map(Value::as_f64).collect();
    let expected: Vec<Option<f64>> = (1..=9).map(|x| Some(f64::from(x))).chain([None]).collect();
    assert_eq!(values, expected);
}

#[test]
fn a_file_that_a_page_sends_is_opened_and_removed_at_the_end() {
    let folder = Folder::new();
    let server = Server::start(&folder, &["--spp", "1"]);
    let mut page = server.page();
    page.send("size 40x30");
    page.image(is_finished);
    let most = page.state["opens"].as_u64().expect("a number of bytes");
    for (line, word) in [
        (format!("open a.xyz {}", most + 1), "large"),
        ("open scene.toml 9".to_owned(), "scene"),
        ("open a.xyz many".to_owned(), "many"),
    ] {
        page.send(&line);
        let error = page.error();
        assert!(error.contains(word), "{line}: {error}");
    }
    page.send(&format!("open '../my salt.extxyz' {}", SALT.len()));
    let (first, rest) = SALT.as_bytes().split_at(20);
    for bytes in [first, rest] {
        page.socket.send(Message::binary(bytes.to_vec())).expect("a message");
    }
    page.until(|state| state["spheres"] == 4 && state["busy"] == false);
    // All of it is seen, in the page's shape.
    let before = page.state["camera"]["line"].clone();
    page.send("key home");
    page.send("mark 1");
    while page.mark != "1" {
        page.read();
    }
    assert_eq!(page.state["camera"]["line"], before);
    let line = page.state["command"].as_str().expect("a command").to_owned();
    assert!(line.contains("my_salt.extxyz") && !line.contains("/my"), "{line}");
    page.send("download png size=30x20 spp=1");
    let sent = page.image(|header| header["file"] == "view.png");
    assert!(sent.header["command"].as_str().is_some_and(|line| line.contains("my_salt")));
    // Bytes of no file change nothing.
    page.socket.send(Message::binary(vec![1; 1000])).expect("a message");
    page.send("set color-by q");
    page.until(|state| !state["legend"].is_null());
    assert!(page.errors.is_empty(), "{:?}", page.errors);
    let kept = || folder.path("tmp").read_dir().expect("a folder").count();
    assert_eq!(kept(), 1);
    #[cfg(target_os = "linux")]
    {
        server.process.signal(&["TERM"]);
        wait_for("the end", || kept() == 0);
    }
}
