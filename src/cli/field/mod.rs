//! `spherule field`: writes a generated scene.

mod args;
mod scene;

pub(super) use self::args::{Args, EXAMPLES};
use self::args::{Kind, ParameterArgs};
use super::contents::spheres;
use super::failure::Failure;
use super::files::Files;
use super::options::values::Radii;
use super::output;
use clap::ValueEnum;
use indicatif::HumanCount;
use spherule_render::scene::generate::{
    DEFAULT_MIX, Field, Generator, Grid, Lattice, Sphereflake, Volume, Weekend,
};
use spherule_render::scene::write;
use std::path::Path;
use std::process::ExitCode;

/// Generates the scene and writes it.
pub(super) fn run(args: &Args) -> Result<ExitCode, Failure> {
    check_name(&args.output)?;
    let columns = args.output.with_extension("csv");
    let mut files = Files::new("field");
    files.writes("--output", &args.output);
    files.writes("the spheres of --output", &columns);
    files.check()?;
    let generator = args.parameters.generator(args.kind)?;
    if !args.quiet
        && let Some(count) = args.parameters.count
        && let Some(text) = product(&generator, count)
    {
        output::note(text);
    }
    let scene = scene::scene(&generator, args.seed)?;
    write(&scene, &args.output)?;
    if !args.quiet {
        let count = spheres(scene.spheres.len() as u64);
        output::print(format_args!("{}: {count} in {}", args.output.display(), columns.display()));
    }
    Ok(ExitCode::SUCCESS)
}

/// Returns the number of spheres as a product, of a generator whose count is that along an edge.
fn product(generator: &Generator, count: u64) -> Option<String> {
    let edge = HumanCount(count);
    let product = match generator {
        Generator::Grid(_) | Generator::Field(_) => format!("{edge} x {edge}"),
        Generator::Lattice(_) => format!("4 x {edge} x {edge} x {edge}"),
        Generator::Volume(_) | Generator::Sphereflake(_) | Generator::Weekend(_) => return None,
    };
    Some(format!("--count is that along each side: {product} = {}", spheres(generator.count())))
}

/// Rejects names that do not end in `.toml`, which are not read as scenes.
fn check_name(path: &Path) -> Result<(), Failure> {
    if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("toml")) {
        return Ok(());
    }
    let name = path.display();
    Err(Failure::usage("field", format!("--output {name}: use a name that ends in .toml")))
}

impl ParameterArgs {
    /// Returns the generator; an error if a parameter is not one of its own.
    fn generator(&self, kind: Kind) -> Result<Generator, Failure> {
        self.check_kind(kind)?;
        Ok(match kind {
            Kind::Grid => Generator::Grid(self.grid()?),
            Kind::Field => Generator::Field(self.field()),
            Kind::Volume => Generator::Volume(self.volume()),
            Kind::Lattice => Generator::Lattice(self.lattice()?),
            Kind::Sphereflake => Generator::Sphereflake(self.sphereflake()?),
            Kind::Weekend => Generator::Weekend(Weekend),
        })
    }

    fn grid(&self) -> Result<Grid, Failure> {
        let default = Grid::default();
        Ok(Grid {
            count: self.count.unwrap_or(default.count),
            spacing: self.spacing.unwrap_or(default.spacing),
            radius: self.one_radius()?.unwrap_or(default.radius),
        })
    }

    fn field(&self) -> Field {
        let default = Field::default();
        Field {
            count: self.count.unwrap_or(default.count),
            radius: self.radius.map_or(default.radius, Radii::range),
            colors: self.colors.unwrap_or(default.colors),
            mix: Some(self.mix.unwrap_or(DEFAULT_MIX)),
        }
    }

    fn volume(&self) -> Volume {
        let default = Volume::default();
        Volume {
            count: self.count.unwrap_or(default.count),
            size: self.size,
            radius: self.radius.map(Radii::range),
            colors: self.colors.unwrap_or(default.colors),
        }
    }

    fn lattice(&self) -> Result<Lattice, Failure> {
        let default = Lattice::default();
        Ok(Lattice {
            count: self.count.unwrap_or(default.count),
            radius: self.one_radius()?.unwrap_or(default.radius),
            jitter: self.jitter.unwrap_or(default.jitter),
        })
    }

    fn sphereflake(&self) -> Result<Sphereflake, Failure> {
        let default = Sphereflake::default();
        Ok(Sphereflake {
            level: self.level.unwrap_or(default.level),
            radius: self.one_radius()?.unwrap_or(default.radius),
        })
    }

    /// Returns the radius for generators whose spheres are all equal.
    fn one_radius(&self) -> Result<Option<f64>, Failure> {
        match self.radius {
            Some(radii) if radii.least != radii.greatest => {
                Err(Failure::usage("field", "--radius takes a single radius here, as in 0.4"))
            }
            radii => Ok(radii.map(|radii| radii.least)),
        }
    }

    fn check_kind(&self, kind: Kind) -> Result<(), Failure> {
        use Kind::{Field, Grid, Lattice, Sphereflake, Volume};
        let rules: [(&str, bool, &[Kind]); 8] = [
            ("count", self.count.is_some(), &[Grid, Field, Volume, Lattice]),
            ("radius", self.radius.is_some(), &[Grid, Field, Volume, Lattice, Sphereflake]),
            ("spacing", self.spacing.is_some(), &[Grid]),
            ("mix", self.mix.is_some(), &[Field]),
            ("colors", self.colors.is_some(), &[Field, Volume]),
            ("size", self.size.is_some(), &[Volume]),
            ("jitter", self.jitter.is_some(), &[Lattice]),
            ("level", self.level.is_some(), &[Sphereflake]),
        ];
        let stray = rules.iter().find(|(_, typed, kinds)| *typed && !kinds.contains(&kind));
        let Some((option, _, kinds)) = stray else { return Ok(()) };
        let owners: Vec<String> = kinds.iter().map(|kind| name(*kind)).collect();
        let (kind, owners) = (name(kind), owners.join(", "));
        Err(Failure::usage(
            "field",
            format!("--{option} does not apply to {kind}, only to {owners}"),
        ))
    }
}

impl Radii {
    fn range(self) -> [f64; 2] {
        [self.least, self.greatest]
    }
}

fn name(kind: Kind) -> String {
    kind.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}
