//! `[[sphere]]`, `[[generate]]` and `[[file]]`: the spheres, in this order.

use super::block::{Block, Source};
use super::materials::{self, Materials};
use super::schema;
use super::value::{Limits, Value};
use crate::memory;
use crate::scene::Footprint;
use crate::scene::generate::{Field, Generator, Grid, Lattice, Sphereflake, Volume, Weekend};
use crate::scene::particles::{self, Format, Radii, ReadOptions};
use crate::scene::{FileError, Rgb, Scene, Spheres};
use std::path::PathBuf;

pub(super) fn read(
    source: &Source,
    root: &Block,
    scene: &mut Scene,
    materials: &mut Materials,
) -> Result<(), FileError> {
    for block in root.blocks("sphere", &schema::SPHERE)? {
        read_sphere(&block, &mut scene.spheres, materials)?;
    }
    for block in root.blocks("generate", &schema::GENERATE)? {
        read_generate(&block, &mut scene.spheres, materials)?;
    }
    for block in root.blocks("file", &schema::FILE)? {
        read_file(source, &block, scene, materials)?;
    }
    Ok(())
}

fn read_sphere(
    block: &Block,
    spheres: &mut Spheres,
    materials: &mut Materials,
) -> Result<(), FileError> {
    let center = block.need("center", "center = [x, y, z]")?.point()?;
    let radius = block.need("radius", "radius = a number greater than 0")?;
    let radius = radius.number(Limits::Positive)?;
    let color = block.value("color").map_or(Ok(Rgb::ONE), |value| value.color(Limits::Share))?;
    let material = materials::row(block, materials)?;
    spheres.push(center, radius, material, color);
    Ok(())
}

fn read_generate(
    block: &Block,
    spheres: &mut Spheres,
    materials: &mut Materials,
) -> Result<(), FileError> {
    let generator = generator(block)?;
    let seed = block.value("seed").map_or(Ok(0), |value| value.whole(0, u64::MAX))?;
    let own = block.has("material").then(|| materials::row(block, materials));
    let row = match &own {
        Some(Ok(row)) => *row,
        _ => materials.position(materials::DEFAULT).unwrap_or(materials.rows().len() as u32),
    };
    let mut added = generator.footprint();
    let emits = !added.materials && materials.emits(row);
    added.emitters = if emits { added.spheres } else { 0 };
    added.materials |= row > 0;
    check_capacity(spheres, &added, 0, materials).map_err(|message| {
        let count = block.value("count").or_else(|| block.value("level"));
        count.map_or_else(|| block.error(message.as_str()), |value| value.error(message.as_str()))
    })?;
    let group = generator.generate(seed).map_err(|error| {
        let message = format!("`{}` {}", error.parameter, error.message);
        let value = block.value(error.parameter);
        value.map_or_else(|| block.error(message.as_str()), |value| value.error(message.as_str()))
    })?;
    let rows = match own {
        _ if !group.materials.is_empty() => {
            let add = |own| materials.row_or_add(own);
            group.materials.into_iter().map(add).collect()
        }
        Some(row) => vec![row?],
        None => vec![materials::row(block, materials)?],
    };
    spheres.append(group.spheres, &rows);
    Ok(())
}

fn generator(block: &Block) -> Result<Generator, FileError> {
    let count = |usual| block.value("count").map_or(Ok(usual), |value| value.whole(1, u64::MAX));
    let number = |key, usual| {
        block.value(key).map_or(Ok(usual), |value: Value| value.number(Limits::Positive))
    };
    let radii =
        || block.value("radius").map(|value| value.numbers::<2>(Limits::Positive)).transpose();
    let colors = |usual| block.value("colors").map_or(Ok(usual), |value| value.flag());
    Ok(match block.kind()? {
        "grid" => {
            let usual = Grid::default();
            Generator::Grid(Grid {
                count: count(usual.count)?,
                spacing: number("spacing", usual.spacing)?,
                radius: number("radius", usual.radius)?,
            })
        }
        "field" => Generator::Field(field(block)?),
        "volume" => Generator::Volume(Volume {
            count: count(Volume::default().count)?,
            size: block.value("size").map(|value| value.number(Limits::Positive)).transpose()?,
            radius: radii()?,
            colors: colors(false)?,
        }),
        "lattice" => {
            let usual = Lattice::default();
            let jitter = block.value("jitter");
            Generator::Lattice(Lattice {
                count: count(usual.count)?,
                radius: number("radius", usual.radius)?,
                jitter: jitter.map_or(Ok(0.0), |value| value.number(Limits::NotNegative))?,
            })
        }
        "sphereflake" => {
            let usual = Sphereflake::default();
            let level = block.value("level");
            let level = level
                .map_or(Ok(u64::from(usual.level)), |value| value.whole(0, u64::from(u32::MAX)))?;
            let radius = number("radius", usual.radius)?;
            Generator::Sphereflake(Sphereflake { level: level as u32, radius })
        }
        _ => Generator::Weekend(Weekend),
    })
}

fn field(block: &Block) -> Result<Field, FileError> {
    let usual = Field::default();
    let mix =
        block.value("mix").map(|value| value.numbers::<3>(Limits::NotNegative)).transpose()?;
    if mix.is_some() {
        block.forbid("material", "mix", || {
            "a mix uses the materials diffuse, metal and glass, which the scene may define"
                .to_owned()
        })?;
    }
    let count = block.value("count");
    let radius = block.value("radius");
    let colors = block.value("colors");
    Ok(Field {
        count: count.map_or(Ok(usual.count), |value| value.whole(1, u64::MAX))?,
        radius: radius.map_or(Ok(usual.radius), |value| value.numbers(Limits::Positive))?,
        colors: colors.map_or(Ok(usual.colors), |value| value.flag())?,
        mix,
    })
}

fn read_file(
    source: &Source,
    block: &Block,
    scene: &mut Scene,
    materials: &mut Materials,
) -> Result<(), FileError> {
    let file = block.need("path", "path = \"particles.csv\"")?;
    let format = block.value("format").map(|value| format(&value)).transpose()?;
    let scale = block.value("scale");
    let radius = block.value("radius").map(|value| value.number(Limits::Positive)).transpose()?;
    let topology = block.value("topology").map(|value| existing(source, &value)).transpose()?;
    let options = ReadOptions {
        format,
        topology,
        radii: radius.map_or(Radii::Auto, Radii::Missing),
        scale: scale.map_or(Ok(1.0), |value| value.number(Limits::Positive))?,
        ..ReadOptions::default()
    };
    let path = existing(source, &file)?;
    let mut particles = particles::read(&path, &options)?;
    let ellipsoids = particles.shapes.semi_axes.len() as u64;
    let added = Footprint { ellipsoids, ..Footprint::of_columns(&particles.spheres, &[]) };
    check_capacity(&scene.spheres, &added, added.scene(), materials)
        .map_err(|message| file.error(message))?;
    let mut rows = Vec::new();
    for name in &particles.material_names {
        rows.push(if name.is_empty() {
            materials::row(block, materials)?
        } else {
            materials.position(name).ok_or_else(|| {
                let message = format!("{} names an unknown material \"{name}\"", path.display());
                file.error(message).with_help(materials.known(name))
            })?
        });
    }
    let mut ellipsoids =
        particles.take_ellipsoids(materials.rows(), &rows, &path.to_string_lossy());
    scene.ellipsoids.append(&mut ellipsoids);
    scene.spheres.append(particles.spheres, &rows);
    scene.warnings.extend(particles.warnings);
    Ok(())
}

/// Returns the path of a file that a value names.
fn existing(source: &Source, file: &Value) -> Result<PathBuf, FileError> {
    let path = source.folder.join(file.text()?);
    if path.is_file() {
        return Ok(path);
    }
    let error = file.error(format!("file not found: {}", path.display()));
    Err(error.with_help("paths are relative to the folder of the scene file"))
}

fn format(value: &Value) -> Result<Format, FileError> {
    let chosen = value.choice(&Format::ALL.map(|(name, _)| name))?;
    let format = Format::ALL.into_iter().find(|(name, _)| *name == chosen);
    Ok(format.map_or(Format::Xyzr, |(_, format)| format))
}

/// Checks that a scene can hold more spheres, of which `held` bytes are allocated already; the error
/// says what is missing.
fn check_capacity(
    before: &Spheres,
    added: &Footprint,
    held: u64,
    materials: &Materials,
) -> Result<(), String> {
    let before = Footprint::of_columns(before, materials.rows());
    let (total, added) = (before.with(added), added.spheres);
    if total.spheres <= Spheres::MAX {
        // The columns here, and then the world's: fail before a long wait if memory cannot suffice.
        let need = total.peak().saturating_sub(before.scene()).saturating_sub(held);
        return memory::check(need)
            .map_err(|shortage| format!("asks for {added} spheres, which need {shortage}"));
    }
    let most = Spheres::MAX;
    let amount = if added == u64::MAX { "more than 1e19".to_owned() } else { added.to_string() };
    Err(format!("asks for {amount} spheres; a scene holds at most {most} in total"))
}
