//! Names of option values, and the values that they stand for.

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use spherule_measure::stress::{REGIMES, Regime};
use spherule_render::image::{Depth, Format, PpmEncoding};
use spherule_render::layers::Layer;
pub(in crate::cli) use spherule_render::settings::Names;
use spherule_render::split::Split;
use spherule_render::trace::{PacketWidth, Traversal};

/// Returns a parser of names.
pub(in crate::cli) fn parser<T: Clone + Send + Sync>(
    names: &Names<T>,
) -> impl TypedValueParser<Value = T> + use<T> {
    let table = names.0;
    let names = table
        .iter()
        .map(|(name, _, help)| PossibleValue::new(*name).help(*help).hide(help.is_empty()));
    PossibleValuesParser::new(names).try_map(|name| {
        let row = table.iter().find(|row| row.0 == name);
        row.map(|row| row.1.clone()).ok_or("not one of the names")
    })
}

/// Returns a parser of the formats that can be written.
pub(in crate::cli) fn formats() -> impl TypedValueParser<Value = Format> {
    let named =
        |name: &str| Format::WRITTEN.into_iter().find(|format| format.option_name() == name);
    PossibleValuesParser::new(Format::WRITTEN.map(Format::option_name))
        .try_map(move |name| named(&name).ok_or("not one of the names"))
}

/// Bits of a channel.
pub(in crate::cli) const BITS: Names<Depth> =
    Names(&[("8", Depth::Eight, "0 to 255"), ("16", Depth::Sixteen, "0 to 65535")]);

/// Encodings of PPM.
pub(in crate::cli) const PPM: Names<PpmEncoding> = Names(&[
    ("plain", PpmEncoding::Plain, "P3: numbers as text"),
    ("binary", PpmEncoding::Binary, "P6: bytes"),
]);

/// Layers of the image file; `None` stands for all.
pub(in crate::cli) const LAYERS: Names<Option<Layer>> = Names(&[
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
pub(in crate::cli) const LANES: Names<PacketWidth> = Names(&[
    ("1", PacketWidth::One, "One ray at a time"),
    ("4", PacketWidth::Four, "Packets of 4 rays"),
    ("8", PacketWidth::Eight, "Packets of 8 rays"),
    ("16", PacketWidth::Sixteen, "Packets of 16 rays"),
]);

/// Ways to split a render into parts.
pub(in crate::cli) const SPLITS: Names<Split> = Names(&[
    ("samples", Split::Samples, "Each part takes some of the samples of every pixel"),
    ("tiles", Split::Tiles, "Each part renders some of the tiles, and uses less memory"),
]);

/// Returns a parser of the names of regimes.
pub(in crate::cli) fn regime() -> impl TypedValueParser<Value = &'static Regime> {
    let names = REGIMES.iter().map(|regime| PossibleValue::new(regime.name).help(regime.about));
    PossibleValuesParser::new(names)
        .try_map(|name| Regime::named(&name).ok_or("not one of the names"))
}

/// Traversals. The last name is a former one, kept for compatibility.
pub(in crate::cli) const TRAVERSALS: Names<Traversal> = Names(&[
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
pub(in crate::cli) enum Builder {
    /// The fastest in total, by the number of spheres and samples
    Auto,
    /// Median split on the longest axis
    Median,
    /// Surface area heuristic: fastest to trace
    SurfaceArea,
    /// Along a Morton curve: fastest to build
    Morton,
}

/// What follows paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(in crate::cli) enum Device {
    /// The processor, so far
    Auto,
    /// The processor
    Cpu,
    /// A GPU where it can, with the processor's image; needs a program that was built with it
    Gpu,
}
