//! Options for annotations of the image.

use super::lists::{self, List};
use super::with_text::{self, WithText};
use spherule_render::compose::{
    AnnotationRequest, Axes, Bar, LabelText, MeasureRequest, ink, position,
};
use spherule_render::scene::{Anchor, LetterSize, Rgb};
use std::str::FromStr;

/// Options for annotations.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(
    next_help_heading = "Annotations (at POSITION: top-left, top, top-right, left, right, bottom-left, bottom or \
                         bottom-right)"
)]
pub(in crate::cli) struct AnnotationArgs {
    /// Draw a legend of the colors: of elements or types, or of the texts of --color-by; of more than 12 names,
    /// the 12 most frequent [default position: top-right]
    #[arg(
        long,
        value_name = "POSITION",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "top-right",
        value_parser = position
    )]
    legend: Option<Anchor>,
    /// Draw the directions of x, y and z, or with `cell` of the cell's edges a, b and c [default position:
    /// bottom-left]
    #[arg(
        long,
        value_name = "[cell:]POSITION",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "bottom-left",
        value_parser = |text: &str| text.parse::<WithText<Axes>>()
    )]
    axes: Option<WithText<Axes>>,
    /// Draw a scale bar in the file's unit, of a round or a given length [default position: bottom-right]. In
    /// perspective it holds at the depth of the camera's target: the middle of the particles, unless the scene
    /// places the camera; --projection orthographic makes it exact everywhere
    #[arg(
        long,
        value_name = "[LENGTH:]POSITION",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "bottom-right",
        value_parser = |text: &str| text.parse::<WithText<Bar>>()
    )]
    scale_bar: Option<WithText<Bar>>,
    /// Draw a line of text, as in 't = {time:.1} ps' or 'bottom:{file}'; may be repeated. Fields: {time},
    /// {step}, {frame}, {file}, {title}, {particles}, and values of the frame's header, as in {energy}; {time:.1}
    /// has one decimal, {{ and }} are braces, \n begins a line. After a selection the text is at each of its
    /// particles, at most 500, and columns are fields, too, as in 'resname LIG: {name}' [default position: top-left]
    #[arg(
        long = "label",
        value_name = "[POSITION:|SELECTION:]TEXT",
        allow_hyphen_values = true,
        value_parser = |text: &str| text.parse::<WithText<LabelText>>()
    )]
    labels: Vec<WithText<LabelText>>,
    /// Measure particles by their ids in the file, or if it has none by numbers from 0: the distance of two, as in
    /// 12-48, the angle of three at the second, the dihedral of four; drawn as lines with the value. With
    /// :periodic between nearest periodic images. May be repeated
    #[arg(
        long = "measure",
        value_name = "ID-ID[-ID[-ID]][:periodic]",
        value_parser = |text: &str| text.parse::<WithText<MeasureRequest>>()
    )]
    measures: Vec<WithText<MeasureRequest>>,
    /// Size of letters: on paper, as in 7pt or 2.5mm, or as a fraction of the image's smaller side, 0.005 to 0.2;
    /// smaller where annotations would overlap [default: 7pt if --size is a length or --dpi is given, or else 0.03]
    #[arg(
        long,
        value_name = "LENGTH|SHARE",
        allow_hyphen_values = true,
        value_parser = |text: &str| text.parse::<WithText<LetterSize>>()
    )]
    text_size: Option<WithText<LetterSize>>,
    /// Color of letters: #rrggbb or a CSS name [default: dark or light, in contrast with the background]
    #[arg(long, value_name = "COLOR", value_parser = |text: &str| text.parse::<WithText<Ink>>())]
    text_color: Option<WithText<Ink>>,
}

impl AnnotationArgs {
    /// Returns whether no option is given.
    pub(in crate::cli) fn is_empty(&self) -> bool {
        self.list().is_empty()
    }

    /// Settings for the image's metadata.
    pub(in crate::cli) fn list(&self) -> List {
        let mut list = List::new();
        lists::put(&mut list, "legend", self.legend.map(Anchor::name));
        with_text::insert(&mut list, "axes", &self.axes);
        with_text::insert(&mut list, "scale_bar", &self.scale_bar);
        with_text::insert(&mut list, "label", &self.labels);
        with_text::insert(&mut list, "measure", &self.measures);
        with_text::insert(&mut list, "text_size", &self.text_size);
        with_text::insert(&mut list, "text_color", &self.text_color);
        list
    }

    /// Returns the name of an option for letters, if one is given.
    pub(in crate::cli) fn lettering(&self) -> Option<&'static str> {
        let size = self.text_size.as_ref().map(|_| "--text-size");
        size.or_else(|| self.text_color.as_ref().map(|_| "--text-color"))
    }

    /// Returns the annotations to draw, with a color bar at `bar`.
    pub(in crate::cli) fn request(&self, bar: Option<Anchor>) -> AnnotationRequest {
        AnnotationRequest {
            color_bar: bar,
            legend: self.legend,
            axes: self.axes.as_deref().copied(),
            scale_bar: self.scale_bar.as_deref().copied(),
            labels: self.labels.iter().map(|label| (**label).clone()).collect(),
            measures: self.measures.iter().map(|measure| (**measure).clone()).collect(),
            text_size: self.text_size.as_deref().copied(),
            text_color: self.text_color.as_deref().map(|ink| ink.0),
        }
    }

    /// Returns the text of a label, as it was typed.
    pub(in crate::cli) fn label(&self, row: usize) -> &str {
        self.labels.get(row).map_or("", WithText::text)
    }

    /// Returns the text of a measure, as it was typed.
    pub(in crate::cli) fn measure(&self, row: usize) -> &str {
        self.measures.get(row).map_or("", WithText::text)
    }
}

/// A color of letters.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ink(Rgb);

impl FromStr for Ink {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        ink(text).map(Self)
    }
}
