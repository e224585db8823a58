//! The words of the command line, and what each of them means.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use spherule::image::{Depth, Format, PpmEncoding};
use spherule::layers::Layer;
use spherule::scene::{Filter, Integrator, LightChoice, SamplerKind, Tone};
use spherule::split::Split;
use spherule::stress::{REGIMES, Regime};
use spherule::trace::{PacketWidth, Traversal};
use std::mem::discriminant;

/// Names of values with their help, in the order in which they are listed; names without help are not
/// listed. Of a value with parameters only the kind counts.
pub(super) struct Names<T: 'static>(pub(super) &'static [(&'static str, T, &'static str)]);

impl<T: Clone + Send + Sync> Names<T> {
    /// Reads one of the names.
    pub(super) fn parser(&self) -> impl TypedValueParser<Value = T> + use<T> {
        let table = self.0;
        let names = table
            .iter()
            .map(|(name, _, help)| PossibleValue::new(*name).help(*help).hide(help.is_empty()));
        PossibleValuesParser::new(names).try_map(|name| {
            let row = table.iter().find(|row| row.0 == name);
            row.map(|row| row.1.clone()).ok_or("not one of the names")
        })
    }

    /// The name of a value.
    pub(super) fn name(&self, value: &T) -> &'static str {
        let row = self.0.iter().find(|row| discriminant(&row.1) == discriminant(value));
        row.map_or("", |row| row.0)
    }
}

/// Samples toward each light where neither scene nor command says how many.
const SHADOW_SAMPLES: u32 = 16;

/// Integrators, with their usual parameters.
pub(super) const INTEGRATORS: Names<Integrator> = Names(&[
    ("path", Integrator::Path, "Path tracing with light samples: everything there is"),
    (
        "whitted",
        Integrator::Whitted { shadow_samples: SHADOW_SAMPLES },
        "Direct light, mirrors and glass only",
    ),
    ("ao", Integrator::Ao { distance: f64::INFINITY }, "Ambient occlusion: shape without light"),
]);

/// Samplers.
pub(super) const SAMPLERS: Names<SamplerKind> = Names(&[
    ("sobol", SamplerKind::Sobol, "Owen-scrambled Sobol points: least noise"),
    ("stratified", SamplerKind::Stratified, "Jittered strata"),
    ("independent", SamplerKind::Independent, "Independent random numbers"),
]);

/// Choices of the light that a path looks for.
pub(super) const LIGHT_CHOICES: Names<LightChoice> = Names(&[
    ("tree", LightChoice::Tree, "By what each would give where it is looked for: least noise"),
    ("power", LightChoice::Power, "By power, the same everywhere"),
    ("uniform", LightChoice::Uniform, "All alike"),
]);

/// Pixel filters.
pub(super) const FILTERS: Names<Filter> = Names(&[
    ("box", Filter::Box, "The pixel's own square"),
    ("gaussian", Filter::Gaussian, "Standard deviation of half a pixel"),
    ("blackman-harris", Filter::BlackmanHarris, "4 pixels wide"),
]);

/// Tone curves.
pub(super) const TONES: Names<Tone> = Names(&[
    ("linear", Tone::Linear, "Clip at 1"),
    ("filmic", Tone::Filmic, "Roll highlights off"),
]);

/// Reads the name of a format that is written.
pub(super) fn formats() -> impl TypedValueParser<Value = Format> {
    let named =
        |name: &str| Format::WRITTEN.into_iter().find(|format| format.option_name() == name);
    PossibleValuesParser::new(Format::WRITTEN.map(Format::option_name))
        .try_map(move |name| named(&name).ok_or("not one of the names"))
}

/// Bits of a channel.
pub(super) const BITS: Names<Depth> =
    Names(&[("8", Depth::Eight, "0 to 255"), ("16", Depth::Sixteen, "0 to 65535")]);

/// Dialects of PPM.
pub(super) const PPM: Names<PpmEncoding> = Names(&[
    ("plain", PpmEncoding::Plain, "P3: numbers as text"),
    ("binary", PpmEncoding::Binary, "P6: bytes"),
]);

/// Layers of the picture's file; none is all of them.
pub(super) const LAYERS: Names<Option<Layer>> = Names(&[
    ("albedo", Some(Layer::Albedo), "albedo.R G B: the surface's color, black beside it"),
    ("normal", Some(Layer::Normal), "normal.X Y Z: toward the viewer, in the scene's axes"),
    ("depth", Some(Layer::Depth), "depth.Z: distance from the camera; inf where nothing is"),
    ("coverage", Some(Layer::Coverage), "coverage.Y: share of the pixel that is not sky"),
    (
        "id",
        Some(Layer::Id),
        "id.Y, integers: which sphere the pixel's center sees, from 0; 4294967295 for none, \
         4294967294 for the ground",
    ),
    (
        "variance",
        Some(Layer::Variance),
        "variance.R G B: of the pixel's mean, an estimate that takes some more samples",
    ),
    ("samples", Some(Layer::Samples), "samples.Y, integers: how many the pixel has"),
    ("all", None, "All of these"),
]);

/// Rays in a packet.
pub(super) const LANES: Names<PacketWidth> = Names(&[
    ("1", PacketWidth::One, "One ray at a time"),
    ("4", PacketWidth::Four, "Packets of four"),
    ("8", PacketWidth::Eight, "Packets of eight"),
    ("16", PacketWidth::Sixteen, "Packets of sixteen"),
]);

/// What parts of a render differ in.
pub(super) const SPLITS: Names<Split> = Names(&[
    ("samples", Split::Samples, "Each part has some samples of every pixel"),
    ("tiles", Split::Tiles, "Each part has some of the tiles, and takes less memory"),
]);

/// Reads the name of a regime.
pub(super) fn regime() -> impl TypedValueParser<Value = &'static Regime> {
    let names = REGIMES.iter().map(|regime| PossibleValue::new(regime.name).help(regime.about));
    PossibleValuesParser::new(names)
        .try_map(|name| Regime::named(&name).ok_or("not one of the names"))
}

/// Traversals; the last name is an earlier one.
pub(super) const TRAVERSALS: Names<Traversal> = Names(&[
    ("auto", Traversal::Auto, "The fastest: packets of coherent rays, other rays interleaved"),
    ("brute", Traversal::Brute, "Every ray against every sphere: slow, the reference"),
    ("scalar", Traversal::Single, "One ray after another"),
    ("stream", Traversal::Stream, "Single rays, many of them in flight"),
    ("packet", Traversal::Packet, "Packets of rays with equal signs of directions"),
    ("tree", Traversal::Packet, ""),
]);

/// How the tree over the spheres is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Builder {
    /// What is fastest in all, by the number of spheres and samples
    Auto,
    /// Halves on the longest axis
    Median,
    /// The surface-area heuristic: fastest to trace
    SurfaceArea,
    /// Along a curve that fills space: fastest to build
    Morton,
}
