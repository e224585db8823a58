//! Names of option values, and the values that they stand for.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use spherule_measure::stress::{REGIMES, Regime};
use spherule_render::image::{Depth, Format, PpmEncoding};
use spherule_render::layers::Layer;
use spherule_render::scene::{Filter, Integrator, LightChoice, SamplerKind, Tone};
use spherule_render::split::Split;
use spherule_render::trace::{PacketWidth, Traversal};
use std::mem::discriminant;

/// Names of values with their help, in the order in which they are listed; names without help are not
/// listed. Of a value with parameters only the kind counts.
pub(super) struct Names<T: 'static>(pub(super) &'static [(&'static str, T, &'static str)]);

impl<T: Clone + Send + Sync> Names<T> {
    /// Returns a parser of the names.
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

    /// Returns the name of a value.
    pub(super) fn name(&self, value: &T) -> &'static str {
        let row = self.0.iter().find(|row| discriminant(&row.1) == discriminant(value));
        row.map_or("", |row| row.0)
    }
}

/// Default number of shadow rays to each light.
const SHADOW_SAMPLES: u32 = 16;

/// Integrators, with their default parameters.
pub(super) const INTEGRATORS: Names<Integrator> = Names(&[
    ("path", Integrator::Path, "Path tracing with direct light sampling: full global illumination"),
    (
        "whitted",
        Integrator::Whitted { shadow_samples: SHADOW_SAMPLES },
        "Whitted ray tracing: direct light, mirrors and glass only",
    ),
    (
        "ao",
        Integrator::Ao { distance: f64::INFINITY },
        "Ambient occlusion: shows shape, ignores lights and \
                                                        materials",
    ),
]);

/// Samplers.
pub(super) const SAMPLERS: Names<SamplerKind> = Names(&[
    ("sobol", SamplerKind::Sobol, "Owen-scrambled Sobol points: least noise"),
    ("stratified", SamplerKind::Stratified, "Jittered strata"),
    ("independent", SamplerKind::Independent, "Independent random numbers"),
]);

/// Strategies that select the light of a direct lighting sample.
pub(super) const LIGHT_CHOICES: Names<LightChoice> = Names(&[
    (
        "tree",
        LightChoice::Tree,
        "Light tree: by the estimated contribution at the shading point; least noise",
    ),
    ("power", LightChoice::Power, "By power, the same everywhere"),
    ("uniform", LightChoice::Uniform, "All lights with equal probability"),
]);

/// Pixel filters.
pub(super) const FILTERS: Names<Filter> = Names(&[
    ("box", Filter::Box, "The square of the pixel"),
    ("gaussian", Filter::Gaussian, "Gaussian with a standard deviation of half a pixel"),
    ("blackman-harris", Filter::BlackmanHarris, "Blackman-Harris window, 4 pixels wide"),
]);

/// Tone curves.
pub(super) const TONES: Names<Tone> = Names(&[
    ("linear", Tone::Linear, "Clip at 1"),
    ("filmic", Tone::Filmic, "Filmic curve that compresses highlights"),
]);

/// Returns a parser of the formats that can be written.
pub(super) fn formats() -> impl TypedValueParser<Value = Format> {
    let named =
        |name: &str| Format::WRITTEN.into_iter().find(|format| format.option_name() == name);
    PossibleValuesParser::new(Format::WRITTEN.map(Format::option_name))
        .try_map(move |name| named(&name).ok_or("not one of the names"))
}

/// Bits of a channel.
pub(super) const BITS: Names<Depth> =
    Names(&[("8", Depth::Eight, "0 to 255"), ("16", Depth::Sixteen, "0 to 65535")]);

/// Encodings of PPM.
pub(super) const PPM: Names<PpmEncoding> = Names(&[
    ("plain", PpmEncoding::Plain, "P3: numbers as text"),
    ("binary", PpmEncoding::Binary, "P6: bytes"),
]);

/// Layers of the image file; `None` stands for all.
pub(super) const LAYERS: Names<Option<Layer>> = Names(&[
    ("albedo", Some(Layer::Albedo), "albedo.R G B: surface color; black for the background"),
    ("normal", Some(Layer::Normal), "normal.X Y Z: toward the viewer, in the scene's axes"),
    ("depth", Some(Layer::Depth), "depth.Z: distance from the camera; inf for the background"),
    ("coverage", Some(Layer::Coverage), "coverage.Y: fraction of the pixel that is not background"),
    (
        "id",
        Some(Layer::Id),
        "id.Y, integers: index of the sphere at the pixel's center, from 0; 4294967295 for none, 4294967294 \
         for the ground",
    ),
    (
        "variance",
        Some(Layer::Variance),
        "variance.R G B: estimated variance of the pixel's mean; takes some more samples",
    ),
    ("samples", Some(Layer::Samples), "samples.Y, integers: number of samples of the pixel"),
    ("all", None, "All of these"),
]);

/// Rays in a packet.
pub(super) const LANES: Names<PacketWidth> = Names(&[
    ("1", PacketWidth::One, "One ray at a time"),
    ("4", PacketWidth::Four, "Packets of 4 rays"),
    ("8", PacketWidth::Eight, "Packets of 8 rays"),
    ("16", PacketWidth::Sixteen, "Packets of 16 rays"),
]);

/// Ways to split a render into parts.
pub(super) const SPLITS: Names<Split> = Names(&[
    ("samples", Split::Samples, "Each part takes some of the samples of every pixel"),
    ("tiles", Split::Tiles, "Each part renders some of the tiles, and uses less memory"),
]);

/// Returns a parser of the names of regimes.
pub(super) fn regime() -> impl TypedValueParser<Value = &'static Regime> {
    let names = REGIMES.iter().map(|regime| PossibleValue::new(regime.name).help(regime.about));
    PossibleValuesParser::new(names)
        .try_map(|name| Regime::named(&name).ok_or("not one of the names"))
}

/// Traversals. The last name is a former one, kept for compatibility.
pub(super) const TRAVERSALS: Names<Traversal> = Names(&[
    (
        "auto",
        Traversal::Auto,
        "Packets for coherent rays, interleaved single rays for incoherent rays: the \
                               fastest",
    ),
    ("brute", Traversal::Brute, "Test every ray against every sphere: slow, the reference"),
    ("scalar", Traversal::Single, "Single rays, one after another"),
    ("stream", Traversal::Stream, "Single rays, many in flight"),
    ("packet", Traversal::Packet, "Packets of rays whose directions have equal signs"),
    ("tree", Traversal::Packet, ""),
]);

/// Builders of the bounding volume hierarchy.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(super) enum Builder {
    /// The fastest in total, by the number of spheres and samples
    Auto,
    /// Median split on the longest axis
    Median,
    /// Surface area heuristic: fastest to trace
    SurfaceArea,
    /// Along a Morton curve: fastest to build
    Morton,
}
