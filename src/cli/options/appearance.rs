//! Options for the appearance of particles.

use super::lists::{self, List};
use super::values;
use super::with_text::{self, WithText};
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use spherule_render::color::{self, Map, Spacing};
use spherule_render::graphics::Format;
use spherule_render::scene::particles::{
    ArrowCentering, ArrowStyle, BondSource, ColorEnds, Coloring, ColumnColors, ElementColors,
    Legend, Model, NumberColors, Opacity, ParticleStyle, Polyhedra, SelectedStyle, Selection,
    TypeStyle, VectorColumns,
};
use spherule_render::scene::{Anchor, Rgb};
use spherule_render::suggest;
use std::ffi::OsStr;
use std::path::PathBuf;
use std::str::FromStr;

/// Options for the appearance of particles.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(next_help_heading = "Particle appearance")]
pub(in crate::cli) struct AppearanceArgs {
    /// Draw only particles for which EXPR is true, as in 'element != H and z > 10'. Operators: == != < <= > >=,
    /// and, or, not, + - * / ^, parentheses; functions: abs, sqrt, exp, log, log10, min, max, and norm, as in
    /// norm(velocity). Also words of VMD and MDAnalysis: protein, ligand, backbone, water, ion, hetero, name CA CB,
    /// resid 5 to 10, within 5 of resname LIG, same residue as name ZN. Strings are words or quoted; names with
    /// other characters than letters, digits and _ . : [ ] need backticks. Columns have the file's names, or the
    /// names of other programs: resname, resid, chainid, segid, name, bfactor, occ, serial, q, mol
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true, value_parser = |text: &str| text.parse::<WithText<Selection>>())]
    select: Option<WithText<Selection>>,
    /// Color scheme for elements, also where the file has colors [default: the file's colors, or else jmol]
    #[arg(long, value_enum, value_name = "SCHEME", conflicts_with = "color_by")]
    colors: Option<Scheme>,
    /// Color by an expression, as in 'charge / mass' or 'norm(force)' (see --select); or by a column: of the file, or
    /// x, y, z, radius, type, element, id, index, coordination (number of bonds), cluster (connected particles, by
    /// size) or speed (of vx, vy and vz): numbers by a color map, strings by thirty colors in turn, and so are at most 12
    /// different integers of labels such as cluster, coordination or mol. Names of other programs are accepted, as for --select
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true)]
    color_by: Option<String>,
    /// Color map for --color-by; append _r to reverse it, as in `viridis_r`; or evenly spaced colors, as in
    /// navy,white,firebrick; or categories, a color for each integer, of which there are thirty [default: viridis, or categories for at most 12 different integers of labels]
    #[arg(long, value_name = "MAP", requires = "color_by", value_parser = MapParser)]
    color_map: Option<MapChoice>,
    /// Values at the ends of the color map; values outside get the colors of the ends, and arrows in the color bar. An end
    /// is a number, a percentile of the values as in 2%,98%, or auto [default: auto, the minimum and the maximum; in a
    /// sequence, values are those of all frames]
    #[arg(
        long,
        value_name = "LOW,HIGH|auto",
        requires = "color_by",
        allow_hyphen_values = true,
        value_parser = |text: &str| text.parse::<ColorEnds>()
    )]
    color_range: Option<ColorEnds>,
    /// Title of the color bar or legend, as in 'speed (m/s)'; `v_x` and `m^2` have subscripts and superscripts, as has what is
    /// between braces, v_{max} [default: the name of the column, with the unit if it is a length]
    #[arg(long, value_name = "TEXT", requires = "color_by", allow_hyphen_values = true)]
    color_title: Option<String>,
    /// Logarithmic color scale
    #[arg(long, requires = "color_by")]
    color_log: bool,
    /// Model of molecules: spheres of the particles' radii, small spheres with sticks for bonds, or sticks alone
    /// [default: space-filling, or ball-and-stick with --bonds or --polyhedra and for crystals]
    #[arg(long, value_name = "MODEL", value_parser = model())]
    model: Option<Model>,
    /// Bonds to draw: file, those of the file; auto, those of the file or else by covalent radii, of metals not across
    /// anions; none; or rules
    /// for types or elements, in the file's unit, as in C-C<1.7,*-H<1.2 [default: auto with a model that draws
    /// bonds]
    #[arg(
        long,
        value_name = "auto|file|none|RULES",
        value_parser = |text: &str| text.parse::<WithText<BondSource>>()
    )]
    bonds: Option<WithText<BondSource>>,
    /// Radius of the sticks of bonds, in the file's unit [default: a tenth of the median radius, but less than the smallest
    /// ball; 0.15 in licorice]
    #[arg(long, value_name = "R", value_parser = values::positive)]
    bond_radius: Option<f64>,
    /// Draw coordination polyhedra, as in Ti-O or Ti-O<2.5,Si-O<2: the convex hulls of the neighbors of each center, of its
    /// color, which are bonded to it or closer than a distance in the file's unit; may be repeated. Corners outside the
    /// cell are drawn, too, unless with --outside none
    #[arg(
        long,
        value_name = "CENTER-CORNER[<R],...",
        value_parser = |text: &str| text.parse::<WithText<Polyhedra>>()
    )]
    polyhedra: Vec<WithText<Polyhedra>>,
    /// Opacity of the faces of polyhedra, 0 to 1 [default: 0.7]
    #[arg(long, value_name = "NUMBER", requires = "polyhedra", value_parser = values::opacity)]
    polyhedra_opacity: Option<f64>,
    /// Opacity of particles, and of their bonds: a number from 0 to 1, as in 0.3 or 30%, or a column or expression whose numbers it is,
    /// perhaps with those that become 0 and 1, as in charge:-1,1. What is behind is seen without refraction, and shadows are as
    /// thin [default: 1, or 0.2 with --translucent]
    #[arg(
        long,
        value_name = "NUMBER|EXPR[:LOW,HIGH]",
        value_parser = |text: &str| text.parse::<WithText<Opacity>>()
    )]
    opacity: Option<WithText<Opacity>>,
    /// Draw only particles for which EXPR is true with --opacity, the others opaque; as in --select
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true, value_parser = |text: &str| text.parse::<WithText<Selection>>())]
    translucent: Option<WithText<Selection>>,
    /// Draw an arrow for a vector of each particle: velocity, force, dipole or spin; three columns or expressions, as
    /// in vx,vy,0*vz; or what their names have in common before x, y and z
    #[arg(long, value_name = "VECTOR|X,Y,Z", allow_hyphen_values = true, value_parser = |text: &str| text.parse::<WithText<VectorColumns>>())]
    arrows: Option<WithText<VectorColumns>>,
    /// Length of the arrow of a vector of length 1, in the file's unit [default: the median arrow is four times as
    /// long as the median radius]
    #[arg(long, value_name = "FACTOR", value_parser = values::positive, requires = "arrows")]
    arrow_scale: Option<f64>,
    /// Radius of the shafts of arrows, in the file's unit; short arrows are thinner [default: a quarter of the
    /// median radius]
    #[arg(long, value_name = "R", value_parser = values::positive, requires = "arrows")]
    arrow_radius: Option<f64>,
    /// Color of all arrows, #rrggbb or a CSS name [default: that of each particle]
    #[arg(
        long,
        value_name = "COLOR",
        value_parser = |text: &str| text.parse::<WithText<ArrowColor>>(),
        requires = "arrows"
    )]
    arrow_color: Option<WithText<ArrowColor>>,
    /// Part of an arrow that is at its particle: tail, middle or head [default: tail]
    #[arg(long, value_name = "tail|middle|head", value_parser = |name: &str| values::named(&ArrowCentering::ALL, name, "parts of arrows are"), requires = "arrows")]
    arrow_center: Option<ArrowCentering>,
    /// Style of a selection, as in 'resname ATP MG: model=ball-and-stick color=magenta'; may be repeated, later ones
    /// win, and override all other options. Selections are those of --select. Properties: model; color, which is a
    /// CSS color, element, or a column or an expression, with map, range and log; radius; scale, a factor on radii;
    /// bonds (yes or no) and bond-radius; opacity; material: lambertian, plastic, metal, glass, mirror or emitter;
    /// visible (yes or no)
    #[arg(
        long = "style",
        value_name = "EXPR: PROPERTY=VALUE ...",
        allow_hyphen_values = true,
        value_parser = |text: &str| text.parse::<WithText<SelectedStyle>>()
    )]
    styles: Vec<WithText<SelectedStyle>>,
    /// Do not draw particles for which EXPR is true; as in --select
    #[arg(long, value_name = "EXPR", allow_hyphen_values = true, value_parser = |text: &str| text.parse::<WithText<Selection>>())]
    hide: Option<WithText<Selection>>,
    /// Style of a particle type, by its name or element, as in Na:radius=1.2,color=gold,material=glass: the properties
    /// of --style, which overrides it, and element, which gives the type radii, colors and bonds, as in 1:element=O;
    /// may be repeated
    #[arg(
        long = "type",
        value_name = "NAME:PROPERTY=VALUE,...",
        value_parser = |text: &str| text.parse::<WithText<TypeStyle>>()
    )]
    types: Vec<WithText<TypeStyle>>,
    /// Draw a color bar: to a .png, .svg or .pdf file, or inside the image at a position: top-left, top,
    /// top-right, left, right, bottom-left, bottom, bottom-right, or inside, which is bottom-right
    #[arg(
        long,
        value_name = "FILE|POSITION",
        value_parser = bar
    )]
    pub(in crate::cli) color_bar: Option<BarPlace>,
}

/// The color of arrows.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ArrowColor(Rgb);

impl FromStr for ArrowColor {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        color::of_name(text).map(Self)
    }
}

/// Place of a color bar.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(in crate::cli) enum BarPlace {
    /// A separate file.
    File(PathBuf, Format),
    /// A position in the image.
    Inside(Anchor),
}

/// Color schemes for elements.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Scheme {
    /// Jmol's
    Jmol,
    /// Corey, Pauling and Koltun's
    Cpk,
}

impl Scheme {
    fn name(self) -> &'static str {
        match self {
            Self::Jmol => "jmol",
            Self::Cpk => "cpk",
        }
    }
}

/// Names of reversed maps, in the order of [`Map::ALL`].
const REVERSED: [&str; 7] =
    ["viridis_r", "cividis_r", "inferno_r", "magma_r", "plasma_r", "turbo_r", "coolwarm_r"];

/// The name of colors of their own, instead of a color map.
const CATEGORIES: &str = "categories";

/// The colors of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum MapChoice {
    /// A color for each integer.
    Categories,
    /// A color map, which may be reversed.
    Map { map: Map, reversed: bool },
}

/// A parser of the names of color maps, and of colors with commas between them.
#[derive(Clone)]
struct MapParser;

impl TypedValueParser for MapParser {
    type Value = MapChoice;

    fn parse_ref(
        &self,
        command: &clap::Command,
        option: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<MapChoice, clap::Error> {
        let colors = |text: &str| text.parse().map(|map| MapChoice::Map { map, reversed: false });
        match value.to_str().filter(|text| text.contains(',')) {
            Some(_) => colors.parse_ref(command, option, value),
            None => named_map().parse_ref(command, option, value),
        }
    }

    fn possible_values(&self) -> Option<Box<dyn Iterator<Item = PossibleValue> + '_>> {
        Some(Box::new(map_names()))
    }
}

/// Returns the names of color maps.
fn map_names() -> impl Iterator<Item = PossibleValue> {
    let names = Map::ALL.map(|map| PossibleValue::new(map.name()));
    let reversed = REVERSED.map(|name| PossibleValue::new(name).hide(true));
    names.into_iter().chain([PossibleValue::new(CATEGORIES)]).chain(reversed)
}

fn named_map() -> impl TypedValueParser<Value = MapChoice> {
    PossibleValuesParser::new(map_names()).try_map(|name| {
        if name == CATEGORIES {
            return Ok(MapChoice::Categories);
        }
        let row = REVERSED.iter().position(|own| *own == name);
        let map = row.map(|row| Map::ALL[row]).or_else(|| Map::named(&name));
        let choice = |map| MapChoice::Map { map, reversed: row.is_some() };
        map.map(choice).ok_or("not one of the names")
    })
}

fn model() -> impl TypedValueParser<Value = Model> {
    let names = Model::ALL.map(|(name, _)| PossibleValue::new(name));
    PossibleValuesParser::new(names).try_map(|name| {
        let found = Model::ALL.iter().find(|(own, _)| *own == name);
        found.map(|(_, model)| *model).ok_or("not one of the names")
    })
}

/// A position, perhaps after `inside:`, or a name that ends in `.png`, `.svg` or `.pdf`.
fn bar(text: &str) -> Result<BarPlace, String> {
    let name = text.strip_prefix("inside:").unwrap_or(text);
    let inside = if text == "inside" { Some(Anchor::default()) } else { Anchor::named(name) };
    let path = PathBuf::from(text);
    match (inside, Format::of_suffix(&path)) {
        (Some(position), _) => Ok(BarPlace::Inside(position)),
        (None, Some(format)) => Ok(BarPlace::File(path, format)),
        (None, None) => {
            let names = Anchor::ALL.map(|(name, _)| name);
            let (near, names) = (suggest::question(name, names), names.join(", "));
            Err(format!(
                "give a name that ends in .png, .svg or .pdf, or a position: inside, {names}{near}"
            ))
        }
    }
}

impl BarPlace {
    /// Returns whether the text of an option is a position, not a file.
    pub(in crate::cli) fn is_inside(text: &str) -> bool {
        matches!(bar(text), Ok(Self::Inside(_)))
    }
}

impl AppearanceArgs {
    /// Converts the options for the reader; `radius_scale` multiplies the radii.
    pub(in crate::cli) fn looks(&self, radius_scale: f64) -> ParticleStyle {
        let mut types: Vec<TypeStyle> = self.types.iter().map(|look| (**look).clone()).collect();
        let hidden = self.hide.as_deref().cloned().map(SelectedStyle::hidden);
        let own = self.styles.iter().map(|look| (**look).clone());
        let mut styles: Vec<SelectedStyle> = hidden.into_iter().chain(own).collect();
        let properties = types.iter_mut().map(|look| &mut look.properties);
        let properties = properties.chain(styles.iter_mut().map(|look| &mut look.properties));
        let radii = properties.filter_map(|own| own.radius.as_mut());
        radii.for_each(|radius| *radius *= radius_scale);
        let select = self.select.as_deref().cloned();
        let coloring = self.coloring();
        ParticleStyle {
            select,
            coloring,
            model: self.model,
            bonds: self.bonds.as_deref().cloned(),
            bond_radius: self.bond_radius,
            polyhedra: self.polyhedra(),
            opacity: self.opacity.as_deref().cloned(),
            translucent: self.translucent.as_deref().cloned(),
            arrows: self.arrows(),
            types,
            styles,
            ..ParticleStyle::default()
        }
    }

    /// Settings for the image's metadata; the color range is that of the `legend`.
    pub(in crate::cli) fn list(&self, legend: Option<&Legend>) -> List {
        let mut list = List::new();
        with_text::insert(&mut list, "select", &self.select);
        match &self.color_by {
            Some(column) => lists::put(&mut list, "color_by", Some(&**column)),
            None => lists::put(&mut list, "colors", self.colors.map(Scheme::name)),
        }
        if let Some(Legend { scale, .. }) = legend {
            let reversed = if scale.reversed { "_r" } else { "" };
            let ends = format!("{},{}", scale.range.low(), scale.range.high());
            lists::put(&mut list, "color_map", Some(format!("{}{reversed}", scale.map.name())));
            lists::put(&mut list, "color_range", Some(ends));
            lists::put(&mut list, "color_log", self.color_log.then_some(true));
        } else if self.color_map == Some(MapChoice::Categories) {
            lists::put(&mut list, "color_map", Some(CATEGORIES));
        }
        lists::put(&mut list, "color_title", self.color_title.as_deref());
        lists::put(&mut list, "model", self.model.map(Model::name));
        lists::put(&mut list, "bond_radius", self.bond_radius);
        with_text::insert(&mut list, "bonds", &self.bonds);
        with_text::insert(&mut list, "polyhedra", &self.polyhedra);
        lists::put(&mut list, "polyhedra_opacity", self.polyhedra_opacity);
        with_text::insert(&mut list, "opacity", &self.opacity);
        with_text::insert(&mut list, "translucent", &self.translucent);
        with_text::insert(&mut list, "arrows", &self.arrows);
        lists::put(&mut list, "arrow_scale", self.arrow_scale);
        lists::put(&mut list, "arrow_radius", self.arrow_radius);
        with_text::insert(&mut list, "arrow_color", &self.arrow_color);
        let named = |(_, own): &&(&str, ArrowCentering)| Some(*own) == self.arrow_center;
        let center = ArrowCentering::ALL.iter().find(named);
        lists::put(&mut list, "arrow_center", center.map(|(name, _)| *name));
        with_text::insert(&mut list, "type", &self.types);
        with_text::insert(&mut list, "hide", &self.hide);
        with_text::insert(&mut list, "style", &self.styles);
        list
    }

    /// The polyhedra that are asked for.
    fn polyhedra(&self) -> Polyhedra {
        let mut all = Polyhedra::default();
        self.polyhedra.iter().for_each(|own| all.extend((**own).clone()));
        all.opacity = self.polyhedra_opacity;
        all
    }

    /// The arrows that are asked for.
    fn arrows(&self) -> Option<ArrowStyle> {
        Some(ArrowStyle {
            columns: self.arrows.as_deref()?.clone(),
            scale: self.arrow_scale,
            radius: self.arrow_radius,
            color: self.arrow_color.as_deref().map(|ArrowColor(color)| *color),
            centering: self.arrow_center.unwrap_or_default(),
        })
    }

    fn coloring(&self) -> Coloring {
        if let Some(column) = self.color_by.clone() {
            let (numbers, map, reversed) = match self.color_map {
                None => (NumberColors::Auto, None, false),
                Some(MapChoice::Categories) => (NumberColors::Categories, None, false),
                Some(MapChoice::Map { map, reversed }) => (NumberColors::Map, Some(map), reversed),
            };
            let mut coloring = Coloring::Column(ColumnColors {
                column,
                numbers,
                map,
                reversed,
                ends: self.color_range.unwrap_or_default(),
                spacing: if self.color_log { Spacing::Logarithmic } else { Spacing::Linear },
                title: self.color_title.clone(),
                shared: None,
            });
            if self.color_bar.is_some() {
                coloring.prefer_map();
            }
            return coloring;
        }
        match self.colors {
            None => Coloring::Usual,
            Some(Scheme::Jmol) => Coloring::Elements(ElementColors::Jmol),
            Some(Scheme::Cpk) => Coloring::Elements(ElementColors::Cpk),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn color_bars_go_to_files_and_positions() {
        let at = |position| Ok(BarPlace::Inside(position));
        assert_eq!(bar("inside"), at(Anchor::BottomRight));
        assert_eq!(bar("inside:top-left"), at(Anchor::TopLeft));
        assert_eq!((bar("right"), bar("bottom")), (at(Anchor::Right), at(Anchor::Bottom)));
        assert_eq!(bar("a.pdf"), Ok(BarPlace::File("a.pdf".into(), Format::Pdf)));
        assert_eq!(bar("inside.svg"), Ok(BarPlace::File("inside.svg".into(), Format::Svg)));
        for text in ["inside:middle", "a.exr", "insider", "inside:inside", ""] {
            assert!(bar(text).is_err(), "{text}");
        }
    }

    #[test]
    fn every_map_can_be_reversed() {
        for (map, reversed) in Map::ALL.into_iter().zip(REVERSED) {
            assert_eq!(reversed, format!("{}_r", map.name()));
        }
    }
}
