//! Reads PLY point clouds, in text and binary (Turk, "The PLY Polygon File Format", 1994).
//!
//! The crates `ply-rs` and `ply-rs-bw` aren't used: they store a map of values for each vertex. This
//! reader stores the vertices in columns, and ignores the elements after them.

use crate::line;
use crate::lines::{Line, Lines};
use crate::scalar::{Order, Scalar};
use crate::schema::{Schema, Slot};
use crate::{
    FileError, Format, ParticleFrame, ReadOptions, builder::Builder, fields::Fields,
    frame_reader::FrameReader, source::Source, srgb::linear_from_srgb, undrawn::Undrawn,
};
use memchr::memmem;
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::Path;
use std::sync::Arc;

/// Reader of the vertices of a PLY file.
pub(crate) struct Ply {
    source: Option<Source>,
    options: ReadOptions,
}

impl Ply {
    pub(crate) fn new(source: Source, options: &ReadOptions) -> Self {
        Self { source: Some(source), options: options.clone() }
    }
}

/// The header.
pub(crate) struct Header {
    /// Byte order; `None` for text.
    pub(crate) order: Option<Order>,
    pub(crate) elements: Vec<Element>,
    title: String,
    pub(crate) lines: u64,
    /// Offset of the data.
    pub(crate) end: usize,
}

/// Declaration of an element.
pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) count: u64,
    pub(crate) properties: Vec<Property>,
}

pub(crate) struct Property {
    pub(crate) name: String,
    pub(crate) scalar: Scalar,
    /// Type of the number of items; `None` unless the property is a list.
    pub(crate) list: Option<Scalar>,
}

fn scalar(name: &[u8]) -> Option<Scalar> {
    Some(match name {
        b"char" | b"int8" => Scalar::I8,
        b"uchar" | b"uint8" => Scalar::U8,
        b"short" | b"int16" => Scalar::I16,
        b"ushort" | b"uint16" => Scalar::U16,
        b"int" | b"int32" => Scalar::I32,
        b"uint" | b"uint32" => Scalar::U32,
        b"float" | b"float32" => Scalar::F32,
        b"double" | b"float64" => Scalar::F64,
        _ => return None,
    })
}

impl Header {
    /// Reads the header of a file; lines of a text then end with newlines.
    pub(crate) fn read(source: &mut Source) -> Result<Self, FileError> {
        // Data of binary files may hold the bytes of line ends.
        if memmem::find(&source.head, b"format ascii").is_some() {
            line::end_lines(&mut source.head);
        }
        let (path, head) = (&source.path, &source.head[..]);
        let returns = head.starts_with(b"ply\r") && head.get(4) != Some(&b'\n');
        let ending = if returns { b'\r' } else { b'\n' };
        let (order, elements, title) = (None, Vec::new(), String::new());
        let mut header = Self { order, elements, title, lines: 0, end: 0 };
        loop {
            let rest = &head[header.end..];
            let Some(length) = memchr::memchr(ending, rest) else {
                let message = "the header does not end: no line is `end_header`";
                return Err(FileError::whole_file(path, message).with_help("the file is cut off"));
            };
            header.end += length + 1;
            header.lines += 1;
            let line = Line::new(path, header.lines as usize, rest[..length].trim_ascii_end());
            let words: Vec<&[u8]> = line.fields().collect();
            if words == [b"end_header"] {
                return Ok(header);
            }
            header.line(&line, &words)?;
        }
    }

    fn line(&mut self, line: &Line, words: &[&[u8]]) -> Result<(), FileError> {
        let fault = |message: &str| line.whole(message.to_owned());
        let text = |word: &[u8]| String::from_utf8_lossy(word).into_owned();
        let typed = |word: &[u8]| scalar(word).ok_or_else(|| fault("an unknown type of numbers"));
        match *words {
            [b"ply"] | [b"obj_info", ..] | [] => (),
            [b"comment", ..] => {
                let comment = line.text();
                let comment = comment.trim_start().strip_prefix("comment").unwrap_or_default();
                comment.trim().clone_into(&mut self.title);
            }
            [b"format", format, b"1.0"] => {
                self.order = match format {
                    b"ascii" => None,
                    b"binary_little_endian" => Some(Order::Little),
                    b"binary_big_endian" => Some(Order::Big),
                    _ => return Err(fault("an unknown format")),
                }
            }
            [b"element", name, count] => {
                let count = line.whole_number(count)?;
                self.elements.push(Element { name: text(name), count, properties: Vec::new() });
            }
            [b"property", b"list", count, item, name] => {
                self.property(line, text(name), typed(item)?, Some(typed(count)?))?;
            }
            [b"property", kind, name] => self.property(line, text(name), typed(kind)?, None)?,
            _ => return Err(fault("not a line of a PLY header")),
        }
        Ok(())
    }

    fn property(
        &mut self,
        line: &Line,
        name: String,
        scalar: Scalar,
        list: Option<Scalar>,
    ) -> Result<(), FileError> {
        let element = self.elements.last_mut();
        let element = element.ok_or_else(|| line.whole("a property before any element"))?;
        element.properties.push(Property { name, scalar, list });
        Ok(())
    }
}

impl FrameReader for Ply {
    fn next(&mut self) -> Result<Option<ParticleFrame>, FileError> {
        let Some(mut source) = self.source.take() else { return Ok(None) };
        let path = source.path.clone();
        let header = Header::read(&mut source)?;
        let fault = |message: String| FileError::whole_file(&path, message);
        let place = header.elements.iter().position(|element| element.name == "vertex");
        let place = place.ok_or_else(|| fault("has no vertices".to_owned()))?;
        let (before, vertex) = (&header.elements[..place], &header.elements[place]);
        // Lists are passed over.
        let columns = vertex.properties.iter().filter(|property| property.list.is_none());
        let names = columns.map(|property| property.name.clone()).collect();
        let schema = Arc::new(Schema::new(names, &self.options).map_err(fault)?);
        let mut builder = Builder::new(&path, Format::Ply, &schema);
        match header.order {
            None => {
                let mut lines = Lines::new(source);
                let skipped = before.iter().map(|element| element.count);
                lines.skip(skipped.fold(header.lines, u64::saturating_add))?;
                text(&mut lines, vertex, &mut builder)?;
            }
            Some(order) => {
                let head = source.head.split_off(header.end);
                let reader =
                    BufReader::with_capacity(1 << 16, Cursor::new(head).chain(source.reader));
                let mut body = Binary { reader, order, path: &path };
                before.iter().try_for_each(|element| body.skip(element))?;
                body.vertices(vertex, &mut builder)?;
            }
        }
        let mut frame = builder.finish();
        for element in &header.elements {
            match &element.name[..] {
                "face" | "tristrips" => frame.add_undrawn(Undrawn::Faces, element.count),
                "edge" => frame.add_undrawn(Undrawn::Edges, element.count),
                _ => (),
            }
        }
        Ok(Some(ParticleFrame { title: header.title, ..frame }))
    }
}

/// Returns a linear color channel: bytes are sRGB, other numbers are linear.
fn channel(scalar: Scalar, value: f64) -> f64 {
    if scalar == Scalar::U8 {
        return f64::from(linear_from_srgb((value / 255.0).clamp(0.0, 1.0) as f32));
    }
    value
}

fn text(lines: &mut Lines, vertex: &Element, builder: &mut Builder) -> Result<(), FileError> {
    let schema = builder.schema().clone();
    for row in 0..vertex.count {
        let line = lines.row(row, vertex.count, "vertices", "the file is cut off")?;
        let mut fields = Fields::blanks(line.bytes);
        let mut slots = schema.slots.iter().peekable();
        for property in &vertex.properties {
            if slots.peek().is_none() {
                break;
            }
            let too_few =
                || line.whole(format!("a vertex has {} numbers", vertex.properties.len()));
            let field = fields.next().ok_or_else(too_few)?;
            if property.list.is_some() {
                (0..line.whole_number(field)?)
                    .try_for_each(|_| fields.next().map(drop).ok_or_else(too_few))?;
                continue;
            }
            let Some(slot) = slots.next() else { break };
            match slot {
                Slot::Color(_) => {
                    let value = line.number(field)?;
                    builder.put_number(*slot, channel(property.scalar, value));
                }
                _ => builder.put(*slot, &line, field)?,
            }
        }
        builder.end_row()?;
    }
    Ok(())
}

/// Reader of the elements of a binary file.
pub(crate) struct Binary<'p, R> {
    pub(crate) reader: R,
    pub(crate) order: Order,
    pub(crate) path: &'p Path,
}

impl<R: BufRead> Binary<'_, R> {
    fn failed(&self, error: &io::Error) -> FileError {
        if error.kind() == io::ErrorKind::UnexpectedEof {
            let error = FileError::whole_file(self.path, "ends before its last vertex");
            return error.with_help("the file is cut off, or its header wrong");
        }
        FileError::whole_file(self.path, format!("cannot be read: {error}"))
    }

    /// Skips an element; its lists may have different lengths.
    fn skip(&mut self, element: &Element) -> Result<(), FileError> {
        // Elements without properties have no bytes in the file, whatever their count.
        let count = if element.properties.is_empty() { 0 } else { element.count };
        for _ in 0..count {
            element.properties.iter().try_for_each(|property| self.skip_property(property))?;
        }
        Ok(())
    }

    fn skip_property(&mut self, property: &Property) -> Result<(), FileError> {
        let items = match property.list {
            Some(kind) => self.number(kind)?.max(0.0) as u64,
            None => 1,
        };
        self.pass(items.saturating_mul(property.scalar.size() as u64))
    }

    /// Reads a number.
    pub(crate) fn number(&mut self, scalar: Scalar) -> Result<f64, FileError> {
        let mut bytes = [0; 8];
        let bytes = &mut bytes[..scalar.size()];
        self.reader.read_exact(bytes).map_err(|error| self.failed(&error))?;
        Ok(scalar.read(bytes, self.order))
    }

    fn pass(&mut self, length: u64) -> Result<(), FileError> {
        let passed = io::copy(&mut self.reader.by_ref().take(length), &mut io::sink());
        match passed {
            Ok(passed) if passed == length => Ok(()),
            Ok(_) => Err(self.failed(&io::ErrorKind::UnexpectedEof.into())),
            Err(error) => Err(self.failed(&error)),
        }
    }

    fn vertices(&mut self, vertex: &Element, builder: &mut Builder) -> Result<(), FileError> {
        let schema = builder.schema().clone();
        if vertex.properties.iter().any(|property| property.list.is_some()) {
            return self.vertices_with_lists(vertex, builder);
        }
        let sizes = vertex.properties.iter().map(|property| property.scalar.size());
        let mut row = vec![0; sizes.sum()];
        for _ in 0..vertex.count {
            self.reader.read_exact(&mut row).map_err(|error| self.failed(&error))?;
            let mut at = 0;
            for (slot, property) in schema.slots.iter().zip(&vertex.properties) {
                let value = property.scalar.read(&row[at..], self.order);
                at += property.scalar.size();
                put(builder, *slot, property, value);
            }
            builder.end_row()?;
        }
        Ok(())
    }

    /// Reads vertices of different lengths.
    fn vertices_with_lists(
        &mut self,
        vertex: &Element,
        builder: &mut Builder,
    ) -> Result<(), FileError> {
        let schema = builder.schema().clone();
        for _ in 0..vertex.count {
            let mut slots = schema.slots.iter();
            for property in &vertex.properties {
                if property.list.is_some() {
                    self.skip_property(property)?;
                    continue;
                }
                let value = self.number(property.scalar)?;
                if let Some(slot) = slots.next() {
                    put(builder, *slot, property, value);
                }
            }
            builder.end_row()?;
        }
        Ok(())
    }
}

/// Adds a number of a binary file to its column.
fn put(builder: &mut Builder, slot: Slot, property: &Property, value: f64) {
    let is_color = matches!(slot, Slot::Color(_));
    builder.put_number(slot, if is_color { channel(property.scalar, value) } else { value });
}

/// Returns whether a file with this head is PLY.
pub(crate) fn is_ply(head: &[u8]) -> bool {
    head.starts_with(b"ply\n") || head.starts_with(b"ply\r")
}
