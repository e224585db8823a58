//! Reading of prepared scenes.

use super::{
    ColorLengths, EnvironmentPicture, FORMAT, Header, Lengths, MAGIC, ORDER, PROGRAM, PreparedScene,
};
use crate::bvh::{Bvh, NodeRow};
use crate::image::Image;
use crate::memory::{self, Shortage};
use crate::scene::{Environment, EnvironmentMap, Rgb, Scene};
use crate::sealed::{HASH_BYTES, HashingReader, array};
use crate::shade::Materials;
use crate::spheres::{LEAF, SphereBlock, Spheres};
use crate::world::{Appearance, CameraVisible, Colors, Column, Parts};
use bytemuck::{Pod, cast_slice_mut};
use std::fs::File;
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Maximum length of the header, in bytes.
const MAX_HEADER: u64 = 1 << 26;

/// Reasons why a file is not a valid prepared scene.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum PreparedError {
    /// The file does not exist or cannot be read.
    #[error("{}: cannot be read: {}", .0.display(), .1)]
    Read(PathBuf, io::Error),
    /// The file is something else.
    #[error("{}: is not a prepared scene; name a file that `spherule render --prepare` wrote", .0.display())]
    Foreign(PathBuf),
    /// Bytes are missing or changed.
    #[error("{}: is damaged: {}; prepare the scene again", .0.display(), .1)]
    Damaged(PathBuf, &'static str),
    /// Another version of the format or the program, or another kind of processor.
    #[error("{}: was written by {}; prepare the scene again", .0.display(), .1)]
    Other(PathBuf, String),
    /// There is not enough memory for its content.
    #[error("{}: needs {}", .0.display(), .1)]
    Memory(PathBuf, Shortage),
}

enum ReadError {
    Read(io::Error),
    Foreign,
    Damaged(&'static str),
    Other(String),
    Memory(Shortage),
}

impl From<io::Error> for ReadError {
    fn from(error: io::Error) -> Self {
        let short = error.kind() == ErrorKind::UnexpectedEof;
        if short { Self::Damaged("its end is missing") } else { Self::Read(error) }
    }
}

/// Returns whether a file starts like a prepared scene. False for files that cannot be read; pipes
/// are not read.
pub fn is_prepared(path: &Path) -> bool {
    let mut magic = [0; MAGIC.len()];
    let read = |mut file: File| file.read_exact(&mut magic).is_ok();
    path.is_file() && File::open(path).is_ok_and(read) && magic == MAGIC
}

/// Reads a prepared scene of [`super::write()`].
///
/// # Errors
/// The file cannot be read, or is not a prepared scene of this version of the program and this byte
/// order; bytes are missing or changed; or there is not enough memory.
pub fn read(path: &Path) -> Result<PreparedScene, PreparedError> {
    let failed = |error| PreparedError::Read(path.to_owned(), error);
    let file = File::open(path).map_err(failed)?;
    let metadata = file.metadata().map_err(failed)?;
    if !metadata.is_file() {
        return Err(PreparedError::Foreign(path.to_owned()));
    }
    let owned = || path.to_owned();
    read_from(file, metadata.len()).map_err(|fault| match fault {
        ReadError::Read(error) => PreparedError::Read(owned(), error),
        ReadError::Foreign => PreparedError::Foreign(owned()),
        ReadError::Damaged(what) => PreparedError::Damaged(owned(), what),
        ReadError::Other(writer) => PreparedError::Other(owned(), writer),
        ReadError::Memory(shortage) => PreparedError::Memory(owned(), shortage),
    })
}

/// Reads a prepared scene of `length` bytes.
fn read_from(reader: impl Read, length: u64) -> Result<PreparedScene, ReadError> {
    let mut file = HashingReader::new(reader);
    let head = head(&mut file, length)?;
    memory::check(length).map_err(ReadError::Memory)?;
    let columns = Columns::read(&mut file, &head.lengths)?;
    if !file.verify()? {
        return Err(ReadError::Damaged("its bytes were changed"));
    }
    columns.scene(head)
}

fn head(file: &mut impl Read, length: u64) -> Result<Header, ReadError> {
    let mut magic = Vec::new();
    file.by_ref().take(MAGIC.len() as u64).read_to_end(&mut magic)?;
    if magic != MAGIC {
        return Err(ReadError::Foreign);
    }
    let format = u32::from_le_bytes(array(file)?);
    if format != FORMAT {
        return Err(ReadError::Other(format!("a program with version {format} of the format")));
    }
    let size = u64::from_le_bytes(array(file)?);
    if size > length.min(MAX_HEADER) {
        return Err(ReadError::Damaged("its end is missing"));
    }
    let mut head = vec![0; size as usize];
    file.read_exact(&mut head)?;
    let unread = |_| ReadError::Damaged("its header cannot be read");
    let (program, head) = postcard::take_from_bytes::<String>(&head).map_err(unread)?;
    if program != PROGRAM {
        return Err(ReadError::Other(format!("spherule {program}, but this is {PROGRAM}")));
    }
    let (order, head) = postcard::take_from_bytes::<[u8; 4]>(head).map_err(unread)?;
    if order != ORDER.to_ne_bytes() {
        return Err(ReadError::Other("a processor with another byte order".to_owned()));
    }
    let head: Header = postcard::from_bytes(head).map_err(unread)?;
    let fixed = MAGIC.len() as u64 + 4 + 8 + size + HASH_BYTES;
    if head.lengths.bytes() != length.checked_sub(fixed) {
        return Err(ReadError::Damaged("its length differs from that of its columns"));
    }
    Ok(head)
}

impl Lengths {
    /// Returns the bytes of all columns; `None` on overflow.
    fn bytes(&self) -> Option<u64> {
        let column = |count: u64, size: usize| count.checked_mul(size as u64);
        let color = match &self.colors {
            ColorLengths::None => 0,
            ColorLengths::Rows => size_of::<Rgb>(),
            ColorLengths::Coded(_) => 1,
        };
        let material = if self.material.is_some() { 0 } else { size_of::<u32>() };
        let (visible, visible_nodes) = self.visible.unwrap_or_default();
        let picture = self
            .picture
            .as_ref()
            .map_or(0, |picture| u64::from(picture.width) * u64::from(picture.height));
        let columns = [
            column(self.spheres.div_ceil(LEAF as u64), size_of::<SphereBlock>()),
            column(self.spheres, size_of::<u32>() + material + color),
            column(self.nodes, size_of::<NodeRow>()),
            column(visible, size_of::<u32>()),
            column(visible_nodes, size_of::<NodeRow>()),
            column(picture, size_of::<[f32; 3]>()),
        ];
        columns.into_iter().try_fold(0_u64, |sum, bytes| sum.checked_add(bytes?))
    }
}

/// The columns of a file.
struct Columns {
    blocks: Vec<SphereBlock>,
    id: Vec<u32>,
    nodes: Vec<NodeRow>,
    material: Vec<u32>,
    color: Vec<Rgb>,
    code: Vec<u8>,
    visible: Vec<u32>,
    visible_nodes: Vec<NodeRow>,
    picture: Vec<[f32; 3]>,
}

impl Columns {
    /// Reads columns, which are as long as the file.
    fn read(file: &mut impl Read, lengths: &Lengths) -> io::Result<Self> {
        let Lengths { spheres, nodes, material, colors, visible, picture } = lengths;
        let only_if = |exists: bool| if exists { *spheres } else { 0 };
        let (visible, visible_nodes) = visible.unwrap_or_default();
        let pixels = picture
            .as_ref()
            .map_or(0, |picture| u64::from(picture.width) * u64::from(picture.height));
        Ok(Self {
            blocks: column(file, spheres.div_ceil(LEAF as u64))?,
            id: column(file, *spheres)?,
            nodes: column(file, *nodes)?,
            material: column(file, only_if(material.is_none()))?,
            color: column(file, only_if(matches!(colors, ColorLengths::Rows)))?,
            code: column(file, only_if(matches!(colors, ColorLengths::Coded(_))))?,
            visible: column(file, visible)?,
            visible_nodes: column(file, visible_nodes)?,
            picture: column(file, pixels)?,
        })
    }

    /// Converts the columns and the header to a scene.
    fn scene(self, head: Header) -> Result<PreparedScene, ReadError> {
        let Header { scene, identity, metadata, builder, transform, placement, omitted, lengths } =
            head;
        let invalid = || ReadError::Damaged("its header is not a valid scene");
        let scene = Scene::parse(&scene, "", Path::new("")).ok();
        let mut scene = scene.filter(|scene| scene.spheres.is_empty()).ok_or_else(invalid)?;
        if let Some(picture) = lengths.picture {
            scene.environment = picture.environment(self.picture, &scene.environment);
        }
        let appearance = {
            let materials = Materials::build(&scene.materials);
            let rows =
                AppearanceColumns { material: self.material, color: self.color, code: self.code };
            rows.appearance(&materials, lengths.material, lengths.colors)
        };
        let invalid = || ReadError::Damaged("its columns are not valid spheres");
        let appearance = appearance.ok_or_else(invalid)?;
        let spheres = Spheres::from_blocks(self.blocks, self.id).ok_or_else(invalid)?;
        let invalid_tree = || ReadError::Damaged("its nodes are not a valid tree");
        let bvh = Bvh::from_rows(&self.nodes, spheres.blocks().len()).ok_or_else(invalid_tree)?;
        let camera_visible = match lengths.visible {
            Some(_) => Some(
                CameraVisible::of_rows(self.visible, &self.visible_nodes, &spheres)
                    .ok_or_else(invalid_tree)?,
            ),
            None => None,
        };
        let size = [scene.settings.width, scene.settings.height];
        let parts =
            Parts { transform, placement, spheres, bvh, appearance, camera_visible, omitted };
        if !parts.is_finite() {
            return Err(ReadError::Damaged("its camera is invalid"));
        }
        Ok(PreparedScene { scene, identity, metadata, builder, size, parts })
    }
}

/// Columns of materials and colors of a file.
struct AppearanceColumns {
    material: Vec<u32>,
    color: Vec<Rgb>,
    code: Vec<u8>,
}

impl AppearanceColumns {
    /// Returns the appearance; `None` if materials or colors are invalid.
    fn appearance(
        self,
        materials: &Materials,
        uniform: Option<u32>,
        colors: ColorLengths,
    ) -> Option<Appearance> {
        let material = match uniform {
            Some(bits) => Column::Uniform(materials.find(bits)?),
            // Without spheres there is no column, but a default value.
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
        let valid = match &color {
            None => true,
            Some(Colors::Rows(rows)) => rows.iter().all(is_color),
            Some(Colors::Coded { table, codes }) => {
                let known = codes.iter().all(|&code| usize::from(code) < table.len());
                known && table.iter().all(is_color)
            }
        };
        valid.then_some(Appearance { material, color })
    }
}

impl EnvironmentPicture {
    fn environment(self, pixels: Vec<[f32; 3]>, environment: &Environment) -> Environment {
        let Self { width, height, up, rotation, scale } = self;
        let image = Arc::new(Image { width, height, pixels });
        let map = EnvironmentMap::Picture { image, up, rotation, scale };
        Environment { map, illuminates: environment.illuminates }
    }
}

/// Reads a column of `count` rows, which must be at most as many as the file has.
fn column<T: Pod>(file: &mut impl Read, count: u64) -> io::Result<Vec<T>> {
    let mut rows = vec![T::zeroed(); count as usize];
    file.read_exact(cast_slice_mut(&mut rows))?;
    Ok(rows)
}
