//! Scene files: TOML, validated completely.
//!
//! Reading has two steps. `toml` parses tables that know the position of each key and value; then each
//! section's keys are read as `scene/keys` describes them, so that every error is reported with its line
//! and what to write instead. What refers to other sections or to files is checked here.
//! `scenes/README.md` describes every key.

pub(in crate::scene) mod block;
mod environment;
mod ground;
mod materials;
mod mesh;
mod render;
mod spheres;
mod styles;
pub(in crate::scene) mod value;

pub(in crate::scene) use block::Block;
pub(in crate::scene) use materials::{Materials, solid_row};

use self::value::Source;
use super::keys::{EnvironmentKeys, SECTIONS, Schema};
use super::particles::{self, Orientation, Particles, ReadOptions, TypeMaterial};
use super::{
    Annotations, Camera, Environment, EnvironmentMap, FileError, Light, Material, NamedMaterial,
    Preset, Rgb, Scene, Settings, Spheres,
};
use crate::memory::{self, Shortage, read_at_most};
use memchr::memchr_iter;
use spherule_particles::internals::{clipped, listed};
use std::fs::File;
use std::iter;
use std::path::{Path, PathBuf};
use std::rc::Rc;
use toml::de::DeTable;

/// Maximum length of a scene file, in bytes: about a million spheres. More belong in a particle file.
const MAX_BYTES: u64 = 1 << 26;

/// Name of the material of particles that have none of their own.
const PARTICLES: &str = "particles";

/// Bytes of memory per delimiter of a file while it is parsed: of keys, list items, lines and sections,
/// as measured with files of spheres.
const DELIMITER_BYTES: [(u8, u64); 4] = [(b'=', 106), (b',', 373), (b'\n', 71), (b'[', 270)];

/// Additional bytes of memory per byte of a file.
const TEXT_BYTES: u64 = 8;

/// Returns the files that a scene file names, whether they exist or not: particle files, meshes and the
/// environment map. A file that is not a scene names none; [`Scene::load`] reports what is wrong with
/// it. Nor does a pipe, which can be read only once.
pub fn included_files(path: &Path) -> Vec<PathBuf> {
    if !path.is_file() {
        return Vec::new();
    }
    let Some(text) = read_text(path).ok().filter(|text| check_memory(text).is_ok()) else {
        return Vec::new();
    };
    let Ok(document) = text.parse::<toml::Table>() else { return Vec::new() };
    let picture = document.get("environment").and_then(|environment| environment.get("file"));
    let sections = ["file", "mesh"].into_iter().filter_map(|name| document.get(name)?.as_array());
    let named = sections.flatten().flat_map(|file| [file.get("path"), file.get("topology")]);
    let names = named.flatten().chain(picture);
    let folder = path.parent().unwrap_or(Path::new(""));
    names.filter_map(toml::Value::as_str).map(|name| folder.join(name)).collect()
}

fn read_text(path: &Path) -> Result<String, FileError> {
    let bytes = File::open(path)
        .and_then(|file| read_at_most(file, MAX_BYTES))
        .map_err(|error| FileError::unreadable(path, &error))?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        FileError::whole_file(path, format!("is not UTF-8 text (byte {at})"))
            .with_help("a scene is a TOML file; a particle file must not be named .toml")
    })
}

/// Checks that memory suffices for the tables of a text.
fn check_memory(text: &str) -> Result<(), Shortage> {
    memory::check(parse_bytes(text))
}

/// Calls `read` with the sections of a scene.
fn with_root<T>(
    source: &Source,
    read: impl FnOnce(&Block) -> Result<T, FileError>,
) -> Result<T, FileError> {
    let text = source.text;
    check_memory(text)
        .map_err(|shortage| FileError::whole_file(source.path, format!("needs {shortage}")))?;
    let document = DeTable::parse(text).map_err(|error| {
        let end = text.len()..text.len();
        source.error(error.span().unwrap_or(end), error.message())
    })?;
    let names = iter::once("title").chain(SECTIONS.map(|(name, _)| name));
    let schema = Rc::new(Schema::plain("the scene", names));
    read(&Block::open(source, schema, 0..0, document.get_ref())?)
}

impl Camera {
    /// Reads the camera of a scene file, and nothing else of it: files that it names need not be there.
    ///
    /// # Errors
    ///
    /// The file cannot be read, is no TOML, or its `[camera]` is not valid.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let text = read_text(path)?;
        let source = Source { path, text: &text, folder: Path::new("") };
        with_root(&source, |root| {
            root.section()?.ok_or_else(|| {
                let error = FileError::whole_file(path, "has no [camera]");
                error.with_help("a camera is that of a scene file (.toml), as the viewer saves it")
            })
        })
    }
}

impl Camera {
    /// Returns whether a text is keys and values of a camera, and not the name of a file.
    pub fn is_line(text: &Path) -> bool {
        text.to_str().is_some_and(|text| text.contains('=')) && !text.exists()
    }

    /// Reads a camera from a scene file, or from keys and values as `[camera]` has them, in one line:
    /// `eye = [9, 2, 0], target = [0, 0, 0]`.
    ///
    /// # Errors
    ///
    /// Those of [`Camera::load`]; a key or a value is not valid.
    pub fn read(text: &Path) -> Result<Self, FileError> {
        if !Self::is_line(text) {
            return Self::load(text);
        }
        let text = format!("camera = {{ {} }}", text.to_string_lossy());
        let source = Source { path: Path::new("camera"), text: &text, folder: Path::new("") };
        with_root(&source, |root| root.section().map(Option::unwrap_or_default))
    }

    /// Returns the camera in one line, as [`Camera::read`] takes it.
    pub fn to_line(&self) -> String {
        let section = crate::scene::keys::section_text(self);
        let keys = section.lines().filter(|line| line.contains('='));
        keys.collect::<Vec<_>>().join(", ")
    }
}

impl Scene {
    /// Reads a scene file and the files that it names, with paths relative to the scene file.
    ///
    /// # Errors
    ///
    /// A file cannot be read or is not a valid scene: the error says where and what to write.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        let loaded =
            read_text(path).and_then(|text| Self::parse(&text, &path.to_string_lossy(), folder));
        loaded.map_err(|error| {
            let is_named =
                path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml"));
            if is_named || !path.is_file() {
                return error;
            }
            error.with_help("a scene is a TOML file; `Scene::from_particles` reads particle files")
        })
    }

    /// Reads a scene from text; `name` is its name in messages, and paths in it are relative to
    /// `folder`.
    ///
    /// # Errors
    ///
    /// Same as [`Scene::load`].
    pub fn parse(text: &str, name: &str, folder: &Path) -> Result<Self, FileError> {
        let source = Source { path: Path::new(name), text, folder };
        with_root(&source, |root| read(&source, root))
    }

    /// Reads a particle file into a scene with default settings and the look of the default [`Preset`],
    /// with a camera that frames all particles.
    ///
    /// # Errors
    ///
    /// The file cannot be read, or its format is not one that [`particles::read`] supports.
    pub fn from_particles(path: &Path, options: &ReadOptions) -> Result<Self, FileError> {
        let title = path.file_name().map(|name| name.to_string_lossy().into_owned());
        Ok(Self::of_particles(particles::read(path, options)?, &title.unwrap_or_default()))
    }

    /// Makes the same scene of particles that were read before.
    pub fn of_particles(particles: Particles, title: &str) -> Self {
        let of_first = particles.first_frame.as_ref().map(|first| first.orientation);
        let orientation = of_first.unwrap_or_else(|| Orientation::of(&particles));
        let preset = Preset::default();
        let mut scene = preset.scene(particles, title, &orientation);
        preset.light(&mut scene, orientation.up.vector());
        scene
    }

    /// Makes a scene with this material for particles without one, with the default camera under a white
    /// sky. Those whose material comes
    /// from a [`TypeStyle`](particles::TypeStyle), or from a file's column with names of
    /// [`TypeMaterial`], keep it.
    pub fn of_particles_with(mut particles: Particles, title: &str, usual: &Material) -> Self {
        let named = |name: &str| NamedMaterial { name: name.to_owned(), material: usual.clone() };
        let mut materials = Materials::default();
        materials.row_or_add(named(PARTICLES));
        let mut rows = Vec::new();
        let (mut unknown, mut refused) = (Vec::new(), false);
        for (code, name) in particles.material_names.iter().enumerate() {
            let own = particles.own_material(code as u32);
            if own.is_none() && !name.is_empty() {
                unknown.push(name.as_str());
            }
            let name = if name.is_empty() { PARTICLES } else { name };
            let mut own = own.unwrap_or_else(|| named(name));
            if let Some(opacity) = particles.opacities.get(code).copied().flatten() {
                let material = own.material.with_opacity(opacity);
                refused |= material.opacity() != opacity;
                if material != own.material {
                    own = NamedMaterial { name: format!("{name} {opacity:.4}"), material };
                }
            }
            rows.push(materials.row_or_add(own));
        }
        if refused {
            let message = "glass and emitters have no opacity, and stay as they are";
            particles.frame.warnings.push(format!("{title}: {message}"));
        }
        if !unknown.is_empty() {
            let known = TypeMaterial::ALL.map(|(name, _)| name).join(", ");
            let reason = format!("unknown materials, replaced by the default (known are {known})");
            particles
                .frame
                .warnings
                .push(format!("{title}: {}", clipped(listed(&reason, &unknown))));
        }
        let mut materials = materials.into_rows();
        let mut sticks = particles.sticks(&materials, &rows);
        let triangles = particles.append_polyhedra(&mut materials, &rows, &mut sticks);
        let cones = particles.cones(&materials, &rows);
        let ellipsoids = particles.take_ellipsoids(&materials, &rows, title);
        let mut spheres = Spheres::default();
        spheres.append(particles.spheres, &rows);
        Self {
            title: title.to_owned(),
            spheres,
            sticks,
            ellipsoids,
            cones,
            triangles,
            materials,
            warnings: particles.frame.warnings,
            ..Self::default()
        }
    }
}

/// Estimates the bytes of memory for parsing a text.
fn parse_bytes(text: &str) -> u64 {
    let of_delimiter =
        |(delimiter, bytes)| memchr_iter(delimiter, text.as_bytes()).count() as u64 * bytes;
    DELIMITER_BYTES.into_iter().map(of_delimiter).sum::<u64>() + text.len() as u64 * TEXT_BYTES
}

/// Reads all sections, each after those that it refers to.
fn read(source: &Source, root: &Block) -> Result<Scene, FileError> {
    let title = root.value("title").map_or(Ok(""), |value| value.text())?;
    let settings = root.block(Schema::render())?;
    let mut scene = Scene {
        title: title.to_owned(),
        settings: settings.map_or(Ok(Settings::default()), |block| render::read(&block))?,
        camera: root.section()?.unwrap_or_default(),
        look: root.section()?.unwrap_or_default(),
        annotations: Annotations {
            color_bar: root.section()?,
            legend: root.section()?,
            axes: root.section()?,
            scale_bar: root.section()?,
            labels: root.sections()?,
            measures: root.sections()?,
            lettering: root.section()?.unwrap_or_default(),
        },
        slices: root.sections()?,
        lights: root.sections()?,
        ..Scene::default()
    };
    let mut materials = materials::read(root)?;
    spheres::read(source, root, &mut scene, &mut materials)?;
    for bodies in scene.file_bodies_mut() {
        bodies.read(root, &mut materials)?;
    }
    mesh::read(source, root, &mut scene, &mut materials)?;
    scene.ground = ground::read(root, &mut materials)?;
    scene.materials = materials.into_rows();
    let environment = root.block(Schema::of::<EnvironmentKeys>())?;
    scene.environment = match environment {
        Some(block) => environment::read(source, &block)?,
        None => default_environment(&scene.lights, &scene.materials, &scene.spheres),
    };
    Ok(scene)
}

/// Returns a white environment if there are no other lights, or else a black one.
fn default_environment(
    lights: &[Light],
    materials: &[NamedMaterial],
    spheres: &Spheres,
) -> Environment {
    let emits = |row: usize| {
        let row = spheres.material_of(row) as usize;
        matches!(materials.get(row), Some(NamedMaterial { material: Material::Emitter { .. }, .. }))
    };
    let dark = lights.is_empty() && !(0..spheres.len()).any(emits);
    let color = if dark { Rgb::ONE } else { Rgb::ZERO };
    Environment { map: EnvironmentMap::Constant(color), illuminates: true }
}

#[cfg(test)]
mod tests;
