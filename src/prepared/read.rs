//! A file becomes a scene and its world.

use super::{ColorLengths, FORMAT, Head, Lengths, MAGIC, ORDER, PROGRAM, PreparedScene, Sky};
use crate::bvh::{Bvh, NodeRow};
use crate::image::Image;
use crate::memory::{self, Shortage};
use crate::scene::{Environment, EnvironmentMap, Rgb, Scene};
use crate::sealed::{SEAL, Unsealing};
use crate::spheres::{LEAF, SphereBlock, Spheres};
use crate::world::{Appearance, CameraVisible, Colors, Column, Materials, Parts};
use bytemuck::{Pod, cast_slice_mut};
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Longest head, in bytes.
const LONGEST_HEAD: u64 = 1 << 26;

/// Why a file is no prepared scene that can be rendered.
#[derive(Debug, thiserror::Error)]
pub enum PreparedError {
    /// It is not there, or the system does not let it be read.
    #[error("{}: cannot be read: {}", .0.display(), .1)]
    Read(PathBuf, io::Error),
    /// It is something else.
    #[error("{}: is not a prepared scene; name a file that `spherule render --prepare` wrote", .0.display())]
    Foreign(PathBuf),
    /// Bytes are missing or others.
    #[error("{}: is damaged: {}; prepare the scene again", .0.display(), .1)]
    Damaged(PathBuf, &'static str),
    /// Another version of the format or the program, or another kind of processor.
    #[error("{}: was written by {}; prepare the scene again", .0.display(), .1)]
    Other(PathBuf, String),
    /// There is not enough memory for what it holds.
    #[error("{}: needs {}", .0.display(), .1)]
    Memory(PathBuf, Shortage),
}

enum Fault {
    Read(io::Error),
    Foreign,
    Damaged(&'static str),
    Other(String),
    Memory(Shortage),
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Self {
        let short = error.kind() == ErrorKind::UnexpectedEof;
        if short { Self::Damaged("its end is missing") } else { Self::Read(error) }
    }
}

/// Whether a file begins as prepared scenes do. False if it cannot be read; pipes are not.
pub fn is_prepared(path: &Path) -> bool {
    let mut magic = [0; MAGIC.len()];
    let read = |mut file: File| file.read_exact(&mut magic).is_ok();
    path.is_file() && File::open(path).is_ok_and(read) && magic == MAGIC
}

/// Reads what [`super::write()`] wrote.
///
/// # Errors
/// It cannot be read, is no prepared scene, or not one of this version of the program and of this kind
/// of processor; a byte of it is missing or not what was written; or there is not enough memory.
pub fn read(path: &Path) -> Result<PreparedScene, PreparedError> {
    let failed = |error| PreparedError::Read(path.to_owned(), error);
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if !metadata.is_file() {
        return Err(PreparedError::Foreign(path.to_owned()));
    }
    let owned = || path.to_owned();
    read_from(file, metadata.len()).map_err(|fault| match fault {
        Fault::Read(error) => PreparedError::Read(owned(), error),
        Fault::Foreign => PreparedError::Foreign(owned()),
        Fault::Damaged(what) => PreparedError::Damaged(owned(), what),
        Fault::Other(writer) => PreparedError::Other(owned(), writer),
        Fault::Memory(shortage) => PreparedError::Memory(owned(), shortage),
    })
}

/// From a reader of so many bytes.
fn read_from(reader: impl Read, length: u64) -> Result<PreparedScene, Fault> {
    let mut file = Unsealing::new(reader);
    let head = head(&mut file, length)?;
    memory::check(length).map_err(Fault::Memory)?;
    let columns = Columns::read(&mut file, &head.lengths)?;
    if !file.verify()? {
        return Err(Fault::Damaged("its bytes are not those that were written"));
    }
    columns.scene(head)
}

fn head(file: &mut impl Read, length: u64) -> Result<Head, Fault> {
    let mut magic = Vec::new();
    file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic)?;
    if magic != MAGIC {
        return Err(Fault::Foreign);
    }
    let format = u32::from_le_bytes(array(file)?);
    if format != FORMAT {
        return Err(Fault::Other(format!("a program that writes version {format} of the format")));
    }
    let size = u64::from_le_bytes(array(file)?);
    if size > length.min(LONGEST_HEAD) {
        return Err(Fault::Damaged("its end is missing"));
    }
    let mut head = vec![0; size as usize];
    file.read_exact(&mut head)?;
    let unread = |_| Fault::Damaged("its head cannot be read");
    let (program, head) = postcard::take_from_bytes::<String>(&head).map_err(unread)?;
    if program != PROGRAM {
        return Err(Fault::Other(format!("spherule {program}, and this is {PROGRAM}")));
    }
    let (order, head) = postcard::take_from_bytes::<[u8; 4]>(head).map_err(unread)?;
    if order != ORDER.to_ne_bytes() {
        return Err(Fault::Other("a processor with another order of bytes".to_owned()));
    }
    let head: Head = postcard::from_bytes(head).map_err(unread)?;
    let fixed = MAGIC.len() as u64 + 4 + 8 + size + SEAL;
    if head.lengths.bytes() != length.checked_sub(fixed) {
        return Err(Fault::Damaged("it is not as long as its columns"));
    }
    Ok(head)
}

impl Lengths {
    /// Bytes of all columns; `None` for more than there can be.
    fn bytes(&self) -> Option<u64> {
        let column = |count: u64, size: usize| count.checked_mul(size as u64);
        let color = match &self.colors {
            ColorLengths::None => 0,
            ColorLengths::Rows => size_of::<Rgb>(),
            ColorLengths::Coded(_) => 1,
        };
        let material = if self.material.is_some() { 0 } else { size_of::<u32>() };
        let (seen, seen_nodes) = self.seen.unwrap_or_default();
        let sky = self.sky.as_ref().map_or(0, |sky| u64::from(sky.width) * u64::from(sky.height));
        let columns = [
            column(self.spheres.div_ceil(LEAF as u64), size_of::<SphereBlock>()),
            column(self.spheres, size_of::<u32>() + material + color),
            column(self.nodes, size_of::<NodeRow>()),
            column(seen, size_of::<u32>()),
            column(seen_nodes, size_of::<NodeRow>()),
            column(sky, size_of::<[f32; 3]>()),
        ];
        columns.into_iter().try_fold(0_u64, |sum, bytes| sum.checked_add(bytes?))
    }
}

/// The columns as a file has them.
struct Columns {
    blocks: Vec<SphereBlock>,
    id: Vec<u32>,
    nodes: Vec<NodeRow>,
    material: Vec<u32>,
    color: Vec<Rgb>,
    code: Vec<u8>,
    seen: Vec<u32>,
    seen_nodes: Vec<NodeRow>,
    sky: Vec<[f32; 3]>,
}

impl Columns {
    /// Reads columns that are as long as the file.
    fn read(file: &mut impl Read, lengths: &Lengths) -> io::Result<Self> {
        let Lengths { spheres, nodes, material, colors, seen, sky } = lengths;
        let only_if = |there: bool| if there { *spheres } else { 0 };
        let (seen, seen_nodes) = seen.unwrap_or_default();
        let pixels = sky.as_ref().map_or(0, |sky| u64::from(sky.width) * u64::from(sky.height));
        Ok(Self {
            blocks: column(file, spheres.div_ceil(LEAF as u64))?,
            id: column(file, *spheres)?,
            nodes: column(file, *nodes)?,
            material: column(file, only_if(material.is_none()))?,
            color: column(file, only_if(matches!(colors, ColorLengths::Rows)))?,
            code: column(file, only_if(matches!(colors, ColorLengths::Coded(_))))?,
            seen: column(file, seen)?,
            seen_nodes: column(file, seen_nodes)?,
            sky: column(file, pixels)?,
        })
    }

    /// The scene that they and the head make.
    fn scene(self, head: Head) -> Result<PreparedScene, Fault> {
        let Head { scene, identity, looks, builder, frame, placement, left_out, lengths } = head;
        let wrong = || Fault::Damaged("its head says what no scene is");
        let scene = Scene::parse(&scene, "", Path::new("")).ok();
        let mut scene = scene.filter(|scene| scene.spheres.is_empty()).ok_or_else(wrong)?;
        if let Some(sky) = lengths.sky {
            scene.environment = sky.environment(self.sky, &scene.environment);
        }
        let appearance = {
            let materials = Materials::build(&scene.materials);
            let rows = Looks { material: self.material, color: self.color, code: self.code };
            rows.appearance(&materials, lengths.material, lengths.colors)
        };
        let wrong = || Fault::Damaged("its columns are no spheres");
        let appearance = appearance.ok_or_else(wrong)?;
        let spheres = Spheres::from_blocks(self.blocks, self.id).ok_or_else(wrong)?;
        let no_tree = || Fault::Damaged("its nodes are no tree");
        let bvh = Bvh::from_rows(&self.nodes, spheres.blocks().len()).ok_or_else(no_tree)?;
        let camera_visible = match lengths.seen {
            Some(_) => Some(
                CameraVisible::of_rows(self.seen, &self.seen_nodes, &spheres)
                    .ok_or_else(no_tree)?,
            ),
            None => None,
        };
        let size = [scene.settings.width, scene.settings.height];
        let parts = Parts { frame, placement, spheres, bvh, appearance, camera_visible, left_out };
        if !parts.is_finite() {
            return Err(Fault::Damaged("its camera is nowhere"));
        }
        Ok(PreparedScene { scene, identity, looks, builder, size, parts })
    }
}

/// Materials and colors of spheres as a file has them.
struct Looks {
    material: Vec<u32>,
    color: Vec<Rgb>,
    code: Vec<u8>,
}

impl Looks {
    /// `None` if there are no such materials or colors.
    fn appearance(
        self,
        materials: &Materials,
        uniform: Option<u32>,
        colors: ColorLengths,
    ) -> Option<Appearance> {
        let material = match uniform {
            Some(bits) => Column::Uniform(materials.find(bits)?),
            // Without spheres there is no column, but a number in its place.
            None if self.material.is_empty() => Column::Uniform(materials.id(0)),
            None => Column::Rows(
                self.material.iter().map(|&bits| materials.find(bits)).collect::<Option<_>>()?,
            ),
        };
        let is_color =
            |color: &Rgb| color.to_array().iter().all(|value| (0.0..=1.0).contains(value));
        let color = match colors {
            ColorLengths::None => None,
            ColorLengths::Rows => Some(Colors::Rows(self.color)),
            ColorLengths::Coded(table) => {
                let table = table.into_iter().map(Rgb::from_array).collect();
                Some(Colors::Coded { table, codes: self.code })
            }
        };
        let right = match &color {
            None => true,
            Some(Colors::Rows(rows)) => rows.iter().all(is_color),
            Some(Colors::Coded { table, codes }) => {
                let known = codes.iter().all(|&code| usize::from(code) < table.len());
                known && table.iter().all(is_color)
            }
        };
        right.then_some(Appearance { material, color })
    }
}

impl Sky {
    fn environment(self, pixels: Vec<[f32; 3]>, environment: &Environment) -> Environment {
        let Self { width, height, up, rotation, scale } = self;
        let image = Arc::new(Image { width, height, pixels });
        let map = EnvironmentMap::Picture { image, up, rotation, scale };
        Environment { map, illuminates: environment.illuminates }
    }
}

/// A column of so many rows, no more of which are asked for than the file has.
fn column<T: Pod>(file: &mut impl Read, count: u64) -> io::Result<Vec<T>> {
    let mut rows = vec![T::zeroed(); count as usize];
    file.read_exact(cast_slice_mut(&mut rows))?;
    Ok(rows)
}

fn array<const N: usize>(reader: &mut impl Read) -> io::Result<[u8; N]> {
    let mut bytes = [0; N];
    reader.read_exact(&mut bytes)?;
    Ok(bytes)
}
