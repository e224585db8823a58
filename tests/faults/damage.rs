//! Damaged checkpoints.

use crate::folder::{Folder, SMALL, text};
use spherule_render::sampling::mix;
use std::fs;

#[test]
fn damaged_checkpoints_are_refused_and_left_unchanged() {
    let folder = Folder::new();
    folder.succeed(&[&SMALL[..], &["--checkpoint", "c"]].concat());
    let whole = folder.read("c");
    let refused = |bytes: &[u8], what: &str| {
        fs::write(folder.path("c"), bytes).expect("a file");
        let output = folder.run(&["render", "--resume", "c", "-o", "b.png"]);
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{what}: {message}");
        let reasons = ["is damaged", "is not a checkpoint", "version"];
        assert!(reasons.iter().any(|reason| message.contains(reason)), "{what}: {message}");
        assert!(folder.read("c") == bytes && !folder.path("b.png").exists(), "{what}");
    };
    for chance in 0..20 {
        let at = mix(chance) as usize % whole.len();
        refused(&whole[..at], &format!("{at} bytes of {}", whole.len()));
        let mut flipped = whole.clone();
        flipped[at] ^= 1 << (chance % 8);
        refused(&flipped, &format!("a bit of byte {at}"));
    }
    refused(b"", "nothing");
    fs::write(folder.path("c"), &whole).expect("a file");
    folder.succeed(&["render", "--resume", "c"]);
}
