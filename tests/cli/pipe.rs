//! The view at the other end of a pipe.

use crate::folder::Folder;
use serde_json::Value;
use std::io::{Read, Write};
use std::process::{Child, ChildStdout, Stdio};

/// A running viewer, which is ended if a test fails.
struct View(Child);

impl Drop for View {
    fn drop(&mut self) {
        // It may have ended.
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// Reads a message: its text, or the header of its files.
fn read(output: &mut ChildStdout) -> Option<(u8, Value)> {
    let mut head = [0; 5];
    output.read_exact(&mut head).ok()?;
    let length = u32::from_le_bytes(head[1..].try_into().expect("four bytes"));
    let mut content = vec![0; length as usize];
    output.read_exact(&mut content).expect("a whole message");
    let text = if head[0] == b'T' {
        content
    } else {
        let (length, rest) = content.split_at(4);
        let length = u32::from_le_bytes(length.try_into().expect("four bytes"));
        rest[..length as usize].to_vec()
    };
    Some((head[0], serde_json::from_slice(&text).expect("JSON")))
}

#[test]
fn a_pipe_has_messages_alone_and_ends_with_its_input() {
    let folder = Folder::new();
    folder.write("pair.xyz", "2\n\nNa 0 0 0\nCl 3 0 0\n");
    let mut command = folder.command(&["view", "pair.xyz", "--radii", "9", "--spp", "1", "--pipe"]);
    let mut view = View(
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("the program starts"),
    );
    let mut input = view.0.stdin.take().expect("its input");
    let mut output = view.0.stdout.take().expect("its output");
    let mut find = |is_wanted: &dyn Fn(u8, &Value) -> bool| loop {
        let (kind, message) = read(&mut output).expect("a message");
        if is_wanted(kind, &message) {
            return message;
        }
    };
    let first = find(&|_, _| true);
    assert!(first["page"]["page.js"].as_str().is_some_and(|text| text.contains("export default")));
    let mut send = |lines: &str| input.write_all(lines.as_bytes()).expect("it listens");
    send("size 40x30\n");
    let is_image = |kind, message: &Value| {
        kind == b'B' && message["width"] == 40 && message["finished"] == true
    };
    let image = find(&is_image);
    // What is printed elsewhere is a message here.
    send(&format!("shown {}\nclick 20,15\n", image["picture"]));
    let picked = find(&|_, message| message["state"]["picked"][0]["id"].is_number());
    assert!(
        picked["state"]["drawn"]["marks"][0][2].as_f64().is_some_and(|radius| radius > 0.1),
        "{picked}"
    );
    send("nonsense\nframe 0\nmark 7\n");
    find(&|_, message| message["error"].is_string());
    let marked = find(&|_, message| message["mark"] == "7");
    assert!(marked["state"]["sampled"] == 1 && marked["state"]["spheres"] == 2, "{marked}");
    // A page that comes anew is told everything, and sent the whole image.
    send("join\n");
    find(&|_, message| message["hello"].is_object());
    let again = find(&is_image);
    assert_eq!(again["tiles"].as_array().map(Vec::len), Some(1));
    send("download raw\n");
    let raw = find(&|_, message| message["file"] == "view.raw");
    assert_eq!(raw["shape"], serde_json::json!([30, 40, 3]));
    drop(input);
    while read(&mut output).is_some() {}
    assert!(view.0.wait().expect("its end").success());
}

#[test]
fn a_pipe_without_a_scene_fails() {
    let folder = Folder::new();
    folder.write("bad.toml", "[camera]\nfov = 200\n");
    let mut command = folder.command(&["view", "bad.toml", "--pipe"]);
    let pipes = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut view = View(pipes.spawn().expect("the program starts"));
    // At its end, the view would end in peace.
    let _input = view.0.stdin.take();
    let mut output = view.0.stdout.take().expect("its output");
    while read(&mut output).is_some() {}
    let mut text = String::new();
    let mut errors = view.0.stderr.take().expect("its errors");
    errors.read_to_string(&mut text).expect("text");
    assert!(!view.0.wait().expect("its end").success() && text.contains("bad.toml"), "{text}");
}
