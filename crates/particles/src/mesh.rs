//! Reads the faces of a PLY file as triangles.

use super::lines::Lines;
use super::ply::{Binary, Element, Header};
use super::progress::ReadProgress;
use super::source::Source;
use crate::FileError;
use glam::DVec3;
use std::io::{BufRead, BufReader, Cursor, Read};
use std::path::Path;

/// Triangles that share vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<DVec3>,
    /// Rows of the vertices at the corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

/// Names of the list of a face's vertices.
const INDICES: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads the vertices and the faces of a PLY file, in text or binary. A face of more than three vertices becomes a fan of triangles about its
/// first one, so it should be convex.
///
/// # Errors
///
/// The file cannot be read, is no PLY file, has no faces, or a face names a vertex that is not there.
pub fn read_mesh(path: &Path) -> Result<Mesh, FileError> {
    let mut source = Source::open(path, &ReadProgress::default())?;
    if !super::ply::is_ply(&source.head) {
        let error = FileError::whole_file(path, "is no PLY file");
        return Err(error.with_help("meshes are read from PLY files with faces"));
    }
    let header = Header::read(&mut source)?;
    let mut mesh = Mesh::default();
    match header.order {
        None => {
            let mut lines = Lines::new(source);
            lines.skip(header.lines)?;
            mesh.read(path, &header.elements, |element, row, values| {
                text(&mut lines, element, row, values)
            })?;
        }
        Some(order) => {
            let head = source.head.split_off(header.end);
            let reader = BufReader::with_capacity(1 << 16, Cursor::new(head).chain(source.reader));
            let mut body = Binary { reader, order, path };
            mesh.read(path, &header.elements, |element, _, values| {
                binary(&mut body, element, values)
            })?;
        }
    }
    Ok(mesh)
}

impl Mesh {
    /// Reads all elements up to the last that counts; `next` reads a row: its numbers, and before those of a list how many they are.
    fn read(
        &mut self,
        path: &Path,
        elements: &[Element],
        mut next: impl FnMut(&Element, u64, &mut Vec<f64>) -> Result<(), FileError>,
    ) -> Result<(), FileError> {
        let fault = |message: String| FileError::whole_file(path, message);
        let place = |name: &str| elements.iter().position(|element| element.name == name);
        let vertices = place("vertex").ok_or_else(|| fault("has no vertices".to_owned()))?;
        let faces = place("face").ok_or_else(|| {
            let help = "points without faces are particles: write [[file]]";
            fault("has no faces".to_owned()).with_help(help)
        })?;
        let of = |element: usize, names: &[&str]| {
            let properties = &elements[element].properties;
            let found = properties.iter().position(|own| names.contains(&&*own.name));
            let message = || {
                format!(
                    "{} have no `{}`",
                    ["vertices", "faces"][usize::from(element == faces)],
                    names[0]
                )
            };
            found.ok_or_else(|| fault(message()))
        };
        let axes = [of(vertices, &["x"])?, of(vertices, &["y"])?, of(vertices, &["z"])?];
        let indices = of(faces, &INDICES)?;
        if elements[faces].properties[indices].list.is_none() {
            return Err(fault(format!(
                "`{}` is no list",
                elements[faces].properties[indices].name
            )));
        }
        let mut values = Vec::new();
        for (at, element) in elements.iter().enumerate().take(vertices.max(faces) + 1) {
            // Rows without properties have no bytes, whatever their number.
            let count = if element.properties.is_empty() { 0 } else { element.count };
            for row in 0..count {
                values.clear();
                next(element, row, &mut values)?;
                if at == vertices {
                    self.vertices.push(DVec3::from(
                        axes.map(|axis| values[place_of(element, &values, axis)]),
                    ));
                } else if at == faces {
                    let corners = list(element, &values, indices);
                    let count = elements[vertices].count;
                    let corner = |&index: &f64| {
                        let there = index >= 0.0 && index < count as f64 && index.fract() == 0.0;
                        let message = || format!("face {row} names vertex {index} of {count}");
                        let index = there.then_some(index as u32).ok_or_else(|| fault(message()));
                        index.map_err(|error| error.with_help("vertices are numbered from 0"))
                    };
                    let corners = corners.iter().map(corner).collect::<Result<Vec<_>, _>>()?;
                    let [first, rest @ ..] = &corners[..] else { continue };
                    self.triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
                }
            }
        }
        Ok(())
    }
}

/// Returns the place of a property among the values of a row: that of its length, if it is a list.
fn place_of(element: &Element, values: &[f64], property: usize) -> usize {
    element.properties[..property].iter().fold(0, |place, own| {
        place + if own.list.is_some() { 1 + values[place] as usize } else { 1 }
    })
}

/// The numbers of a list among the values of a row.
fn list<'a>(element: &Element, values: &'a [f64], property: usize) -> &'a [f64] {
    let rest = &values[place_of(element, values, property)..];
    &rest[1..=rest[0] as usize]
}

/// Reads a row of an element from a line of text.
fn text(
    lines: &mut Lines,
    element: &Element,
    row: u64,
    values: &mut Vec<f64>,
) -> Result<(), FileError> {
    let line = lines.row(row, element.count, "rows", "the file is cut off")?;
    let mut fields = line.fields();
    let mut number = || {
        let message = || {
            line.whole(format!(
                "a row of `{}` has fewer numbers than the header says",
                element.name
            ))
        };
        line.number(fields.next().ok_or_else(message)?)
    };
    for property in &element.properties {
        let mut count = 1;
        if property.list.is_some() {
            let length = number()?;
            count = length.max(0.0) as u64;
            values.push(count as f64);
        }
        for _ in 0..count {
            values.push(number()?);
        }
    }
    Ok(())
}

/// Reads a row of an element from bytes.
fn binary<R: BufRead>(
    body: &mut Binary<'_, R>,
    element: &Element,
    values: &mut Vec<f64>,
) -> Result<(), FileError> {
    for property in &element.properties {
        let mut count = 1;
        if let Some(kind) = property.list {
            count = body.number(kind)?.max(0.0) as u64;
            values.push(count as f64);
        }
        for _ in 0..count {
            values.push(body.number(property.scalar)?);
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(content: &[u8]) -> Result<Mesh, String> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("mesh.ply");
        std::fs::write(&path, content).unwrap();
        read_mesh(&path).map_err(|error| error.to_string())
    }

    const HEADER: &str = "element vertex 4\nproperty float x\nproperty uchar red\nproperty float y\n\
                          property float z\nelement face 2\nproperty list uchar int tags\n\
                          property list uchar int vertex_indices\nend_header\n";

    /// A square and a triangle; each face has a list before that of its vertices.
    fn square(format: &str, faces: [&[u32]; 2]) -> Vec<u8> {
        let vertices = [[0.0_f32, 0.0, 0.5], [1.0, 0.0, 0.5], [1.0, 1.0, 0.5], [0.0, 1.0, 0.5]];
        let mut bytes = format!("ply\nformat {format} 1.0\n{HEADER}").into_bytes();
        for [x, y, z] in vertices {
            match format {
                "ascii" => bytes.extend(format!("{x} 255 {y} {z}\n").bytes()),
                "binary_little_endian" => {
                    bytes.extend(x.to_le_bytes());
                    bytes.push(255);
                    bytes.extend([y, z].map(f32::to_le_bytes).as_flattened());
                }
                _ => {
                    bytes.extend(x.to_be_bytes());
                    bytes.push(255);
                    bytes.extend([y, z].map(f32::to_be_bytes).as_flattened());
                }
            }
        }
        for face in faces {
            if format == "ascii" {
                let words: Vec<String> = face.iter().map(u32::to_string).collect();
                bytes.extend(format!("1 7 {} {}\n", face.len(), words.join(" ")).bytes());
                continue;
            }
            let word = |number: u32| {
                if format == "binary_little_endian" {
                    number.to_le_bytes()
                } else {
                    number.to_be_bytes()
                }
            };
            bytes.push(1);
            bytes.extend(word(7));
            bytes.push(face.len() as u8);
            for &index in face {
                bytes.extend(word(index));
            }
        }
        bytes
    }

    #[test]
    fn faces_become_triangles_in_every_format() {
        for format in ["ascii", "binary_little_endian", "binary_big_endian"] {
            let mesh = read(&square(format, [&[0, 1, 2, 3], &[3, 1, 0]])).unwrap();
            assert_eq!(mesh.vertices[2], DVec3::new(1.0, 1.0, 0.5), "{format}");
            assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [3, 1, 0]], "{format}");
        }
    }

    #[test]
    fn what_is_no_mesh_is_refused() {
        for format in ["ascii", "binary_little_endian"] {
            let whole = square(format, [&[0, 1, 2, 3], &[3, 4, 0]]);
            let error = read(&whole).unwrap_err();
            assert!(error.contains("face 1 names vertex 4 of 4"), "{error}");
            let start = whole.len() - 60;
            for length in start..whole.len() - 10 {
                assert!(read(&whole[..length]).is_err(), "{format} {length}");
            }
        }
        let points = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n";
        assert!(read(points.as_bytes()).unwrap_err().contains("no faces"));
        assert!(read(b"solid cube\n").unwrap_err().contains("PLY"));
        let endless = "ply\nformat binary_little_endian 1.0\nelement none 99999999999999\nelement face 99999999999999\nproperty list uchar int vertex_index\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
        assert!(read(endless.as_bytes()).is_err());
    }
}
