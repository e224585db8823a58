//! XMP packets (ISO 16684-1), used by JPEG, TIFF and WebP files: the metadata is the description, one
//! line per entry.

use super::Metadata;

const BEFORE: &str = "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\
    <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\
    <rdf:Description rdf:about=\"\" xmlns:dc=\"http://purl.org/dc/elements/1.1/\">\
    <dc:description><rdf:Alt><rdf:li xml:lang=\"x-default\">";

const AFTER: &str = "</rdf:li></rdf:Alt></dc:description></rdf:Description></rdf:RDF></x:xmpmeta>";

/// Characters that are escaped in XML; `&` first, which the other escapes contain.
const ESCAPES: [(&str, &str); 3] = [("&", "&amp;"), ("<", "&lt;"), (">", "&gt;")];

/// Returns the packet of metadata; empty if there is none.
pub(super) fn packet(metadata: &Metadata) -> Vec<u8> {
    if metadata.is_empty() {
        return Vec::new();
    }
    let mut text = metadata.to_lines("");
    for (character, escape) in ESCAPES {
        text = text.replace(character, escape);
    }
    [BEFORE, &text, AFTER].concat().into_bytes()
}

/// Returns the metadata of a packet that was written here; empty for other packets.
pub(super) fn metadata(packet: &[u8]) -> Metadata {
    let text = String::from_utf8_lossy(packet);
    let Some((_, rest)) = text.split_once("<dc:description>") else { return Metadata::new() };
    let inside = rest.split_once("xml:lang=\"x-default\">").map(|(_, inside)| inside);
    let Some((inside, _)) = inside.and_then(|inside| inside.split_once("</rdf:li>")) else {
        return Metadata::new();
    };
    let mut text = inside.to_owned();
    for (character, escape) in ESCAPES.iter().rev() {
        text = text.replace(escape, character);
    }
    Metadata::from_lines(text.lines())
}
