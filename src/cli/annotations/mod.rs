//! Options for annotations of the image, and the annotations that they make.

mod facts;
mod template;

pub(super) use self::facts::FrameFacts;
use self::template::{Template, Value};
use super::appearance::BarPlace;
use super::failure::Failure;
use super::render::Job;
use super::settings::List;
use super::with_text::{self, WithText};
use serde_json::json;
use spherule_render::color;
use spherule_render::scene::particles::{Category, Coloring, Legend};
use spherule_render::scene::{
    Anchor, Annotations, AxisTripod, ColorBar, ColorLegend, Label, Lettering, Rgb, ScaleBar, Scene,
};
use spherule_render::suggest;
use std::cmp::Ordering;
use std::str::FromStr;

/// Maximum number of entries of a legend.
const ENTRIES: usize = 12;

/// Options for annotations.
#[derive(Clone, Debug, Default, clap::Args)]
#[command(
    next_help_heading = "Annotations (at POSITION: top-left, top, top-right, left, right, bottom-left, bottom or \
                         bottom-right)"
)]
pub(super) struct AnnotationArgs {
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
        value_parser = |text: &str| text.parse::<WithText<AxesArg>>()
    )]
    axes: Option<WithText<AxesArg>>,
    /// Draw a scale bar in the file's unit, of a round or a given length [default position: bottom-right]. In
    /// perspective it holds at the depth of the camera's target: the middle of the particles, unless the scene
    /// places the camera; --projection orthographic makes it exact everywhere
    #[arg(
        long,
        value_name = "[LENGTH:]POSITION",
        num_args = 0..=1,
        require_equals = true,
        default_missing_value = "bottom-right",
        value_parser = |text: &str| text.parse::<WithText<BarArg>>()
    )]
    scale_bar: Option<WithText<BarArg>>,
    /// Draw a line of text, as in 't = {time:.1} ps' or 'bottom:{file}'; may be repeated. Fields: {time},
    /// {step}, {frame}, {file}, {title}, {particles}, and values of the frame's header, as in {energy}; {time:.1}
    /// has one decimal, {{ and }} are braces, \n begins a line [default position: top-left]
    #[arg(
        long = "label",
        value_name = "[POSITION:]TEXT",
        allow_hyphen_values = true,
        value_parser = |text: &str| text.parse::<WithText<LabelArg>>()
    )]
    labels: Vec<WithText<LabelArg>>,
    /// Size of letters as a fraction of the image's smaller side, 0.005 to 0.2; smaller where annotations would
    /// overlap [default: 0.03]
    #[arg(long, value_name = "SHARE", allow_hyphen_values = true, value_parser = text_size)]
    text_size: Option<f64>,
    /// Color of letters: #rrggbb or a CSS name [default: dark or light, in contrast with the background]
    #[arg(long, value_name = "COLOR", value_parser = |text: &str| text.parse::<WithText<InkArg>>())]
    text_color: Option<WithText<InkArg>>,
}

/// Axes, and the position of their tripod.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxesArg {
    of_cell: bool,
    position: Anchor,
}

/// Length and position of a scale bar.
#[derive(Clone, Copy, Debug, PartialEq)]
struct BarArg {
    length: Option<f64>,
    position: Anchor,
}

/// Text and position of a label.
#[derive(Clone, Debug, PartialEq)]
struct LabelArg {
    template: Template,
    position: Anchor,
}

/// A color of letters.
#[derive(Clone, Copy, Debug, PartialEq)]
struct InkArg(Rgb);

/// Returns the anchor with this name.
pub(super) fn position(name: &str) -> Result<Anchor, String> {
    let names = || Anchor::ALL.into_iter().map(|(name, _)| name);
    Anchor::named(name).ok_or_else(|| suggest::help(name, names(), "positions are"))
}

impl FromStr for AxesArg {
    type Err = String;

    /// Parses a position, or `cell` with or without a position.
    fn from_str(text: &str) -> Result<Self, String> {
        let usual = AxisTripod::default().position;
        match text.strip_prefix("cell") {
            Some("") => Ok(Self { of_cell: true, position: usual }),
            Some(rest) if rest.starts_with(':') => {
                Ok(Self { of_cell: true, position: position(&rest[1..])? })
            }
            _ => {
                let found = position(text).map_err(|help| format!("{help}; or cell"))?;
                Ok(Self { of_cell: false, position: found })
            }
        }
    }
}

impl FromStr for BarArg {
    type Err = String;

    /// Parses a length, a position, or both.
    fn from_str(text: &str) -> Result<Self, String> {
        let (length, place) = match text.split_once(':') {
            Some((length, place)) => (Some(length), Some(place)),
            None if Anchor::named(text).is_some() => (None, Some(text)),
            None if text.starts_with(|letter: char| letter.is_ascii_alphabetic()) => {
                (None, Some(text))
            }
            None => (Some(text), None),
        };
        let number = |text: &str| {
            let length = text.trim().parse().ok().filter(|length: &f64| length.is_finite());
            let length = length.filter(|length| *length > 0.0);
            length.ok_or_else(|| "give a length greater than 0, as in 20 or 20:bottom".to_owned())
        };
        Ok(Self {
            length: length.map(number).transpose()?,
            position: place.map_or(Ok(Anchor::default()), position)?,
        })
    }
}

impl FromStr for LabelArg {
    type Err = String;

    /// Parses a template, with or without a position before it.
    fn from_str(text: &str) -> Result<Self, String> {
        let placed =
            text.split_once(':').and_then(|(name, rest)| Some((Anchor::named(name)?, rest)));
        let (position, text) = placed.unwrap_or((Anchor::TopLeft, text));
        Ok(Self { template: text.parse()?, position })
    }
}

impl FromStr for InkArg {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        color::parse(text).map(Self).ok_or_else(|| {
            let near = suggest::question(text, color::names());
            format!("give a CSS color such as black, or six digits as in \"#202020\"{near}")
        })
    }
}

fn text_size(text: &str) -> Result<f64, String> {
    let size = text.parse().ok().filter(|size| Lettering::SIZES.contains(size));
    size.ok_or_else(|| {
        "give a fraction of the image's smaller side from 0.005 to 0.2, as in 0.03".to_owned()
    })
}

impl AnnotationArgs {
    /// Returns whether no option is given.
    pub(super) fn is_empty(&self) -> bool {
        self.list().is_empty()
    }

    /// Settings for the image's metadata.
    pub(super) fn list(&self) -> List {
        let mut list = List::new();
        if let Some(position) = self.legend {
            list.insert("legend".to_owned(), json!(position.name()));
        }
        with_text::insert(&mut list, "axes", &self.axes);
        with_text::insert(&mut list, "scale_bar", &self.scale_bar);
        with_text::insert(&mut list, "label", &self.labels);
        if let Some(size) = self.text_size {
            list.insert("text_size".to_owned(), json!(size));
        }
        with_text::insert(&mut list, "text_color", &self.text_color);
        list
    }

    /// Returns the name of an option for letters, if one is given.
    pub(super) fn lettering(&self) -> Option<&'static str> {
        let size = self.text_size.map(|_| "--text-size");
        size.or_else(|| self.text_color.as_ref().map(|_| "--text-color"))
    }

    /// Returns whether a legend is drawn, which needs the categories of particles.
    pub(super) fn has_legend(&self) -> bool {
        self.legend.is_some()
    }

    /// Adds annotations to those of a scene, which they override; labels are added to those of the scene.
    fn add(&self, job: &Job, scene: &mut Scene, facts: &FrameFacts) -> Result<(), Failure> {
        let refuse = |message: &str| Err(Failure::usage("render", message));
        let mut annotations = std::mem::take(&mut scene.annotations);
        // Frames of a trajectory may be empty.
        let none = job.looks.allow_empty && scene.is_empty();
        match (self.legend, &facts.categories) {
            (Some(position), Some(categories)) => {
                let label = match &job.looks.coloring {
                    Coloring::Column(colors) => colors.column.clone(),
                    Coloring::Usual | Coloring::Elements(_) => String::new(),
                };
                annotations.legend = Some(color_legend(categories, label, position));
            }
            (Some(_), None) if !none => {
                return refuse(if facts.numeric {
                    "--legend needs colors that stand for names; use --color-bar for those of numbers"
                } else {
                    "--legend needs a particle file whose colors stand for elements, types or the texts of \
                     --color-by"
                });
            }
            _ => (),
        }
        if let Some(axes) = &self.axes {
            let mut tripod = AxisTripod { position: axes.position, ..AxisTripod::default() };
            if axes.of_cell {
                let Some(cell) = facts.cell else {
                    return refuse("--axes=cell needs a particle file with a cell; use --axes");
                };
                tripod.directions = cell.vectors;
                tripod.names = ["a", "b", "c"].map(str::to_owned);
            }
            annotations.axes = Some(tripod);
        }
        if let Some(bar) = &self.scale_bar {
            let own = annotations.scale_bar.take().unwrap_or_default().unit;
            let unit = if own.is_empty() { facts.unit.clone() } else { own };
            let BarArg { length, position } = **bar;
            annotations.scale_bar = Some(ScaleBar { length, unit, position });
        }
        for label in &self.labels {
            let fields = facts.fields(job, scene)?;
            let text = label.template.expand(&fields).map_err(|why| {
                Failure::usage("render", format!("--label '{}': {why}", label.text()))
            })?;
            annotations.labels.push(Label { text, position: label.position });
        }
        let Lettering { size, color } = &mut annotations.lettering;
        *size = self.text_size.unwrap_or(*size);
        *color = self.text_color.as_deref().map(|ink| ink.0).or(*color);
        scene.annotations = annotations;
        Ok(())
    }
}

/// Adds the annotations of the command line to those of a scene.
pub(super) fn annotate(
    job: &Job,
    scene: &mut Scene,
    legend: Option<&Legend>,
    facts: &FrameFacts,
) -> Result<(), Failure> {
    if let (Some(BarPlace::Inside(position)), Some(Legend { scale, label })) =
        (job.color_bar, legend)
    {
        let bar = ColorBar { scale: *scale, label: label.clone(), position: *position };
        scene.annotations.color_bar = Some(bar);
    }
    job.annotations.add(job, scene, facts)
}

/// Returns the legend of the most frequent categories, sorted by name.
fn color_legend(categories: &[Category], label: String, position: Anchor) -> ColorLegend {
    let mut chosen: Vec<&Category> = categories.iter().collect();
    chosen.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| by_name(a, b)));
    let omitted = chosen.len().saturating_sub(ENTRIES) as u64;
    chosen.truncate(ENTRIES);
    chosen.sort_by(|a, b| by_name(a, b));
    let entries = chosen.iter().map(|category| (category.color, category.name.clone()));
    ColorLegend { label, entries: entries.collect(), omitted, position }
}

/// Compares names: numbers by value, and before other names.
fn by_name(a: &Category, b: &Category) -> Ordering {
    let number = |category: &Category| category.name.parse::<f64>().unwrap_or(f64::INFINITY);
    number(a).total_cmp(&number(b)).then_with(|| a.name.cmp(&b.name))
}

/// Returns notes about names that the legend omits, and about colors that stand for several names.
pub(super) fn notes(annotations: &Annotations) -> Vec<String> {
    let Some(ColorLegend { entries, omitted, .. }) = &annotations.legend else { return Vec::new() };
    let mut notes = Vec::new();
    if *omitted > 0 {
        let (shown, all) = (entries.len(), entries.len() as u64 + omitted);
        notes.push(format!("the legend shows the {shown} most frequent of {all} names"));
    }
    let repeated = |(row, (color, _)): (usize, &(Rgb, String))| {
        entries[..row].iter().any(|(earlier, _)| earlier == color)
    };
    if entries.iter().enumerate().any(repeated) {
        let message = "several names of the legend have the same color; give some their own with --type, or \
                       draw fewer with --select";
        notes.push(message.to_owned());
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_and_their_prefixes_are_read() {
        let axes = |of_cell, position| Ok(AxesArg { of_cell, position });
        assert_eq!("top".parse(), axes(false, Anchor::Top));
        assert_eq!("cell".parse(), axes(true, Anchor::BottomLeft));
        assert_eq!("cell:left".parse(), axes(true, Anchor::Left));
        for text in ["", "cells", "cell:", "cell:middle", "middle"] {
            assert!(text.parse::<AxesArg>().is_err(), "{text}");
        }
        let bar = |length, position| Ok(BarArg { length, position });
        assert_eq!("2.5".parse(), bar(Some(2.5), Anchor::BottomRight));
        assert_eq!("top-left".parse(), bar(None, Anchor::TopLeft));
        assert_eq!("1e-3:bottom".parse(), bar(Some(1e-3), Anchor::Bottom));
        for text in ["", "0", "-1", "inf", "nan", "5:middle", "middle", ":left"] {
            assert!(text.parse::<BarArg>().is_err(), "{text}");
        }
        let label = |text: &str| text.parse::<LabelArg>().map(|label| label.position);
        assert_eq!(label("bottom:a"), Ok(Anchor::Bottom));
        assert_eq!(label("time: {time}"), Ok(Anchor::TopLeft));
        assert!(label("{time").is_err());
        for text in ["0", "0.3", "nan", "big"] {
            assert!(text_size(text).is_err(), "{text}");
        }
    }

    #[test]
    fn legends_show_the_most_frequent_names_in_order() {
        let category = |name: usize| Category {
            name: name.to_string(),
            color: Rgb::ONE,
            count: if name == 3 { 1 } else { 100 - name as u64 },
        };
        let categories: Vec<Category> = (1..=14).map(category).collect();
        let legend = color_legend(&categories, String::new(), Anchor::Top);
        let names: Vec<&str> = legend.entries.iter().map(|(_, name)| name.as_str()).collect();
        assert_eq!(names, ["1", "2", "4", "5", "6", "7", "8", "9", "10", "11", "12", "13"]);
        assert_eq!(legend.omitted, 2);
        let annotations = Annotations { legend: Some(legend), ..Annotations::default() };
        let notes = notes(&annotations);
        assert_eq!(notes[0], "the legend shows the 12 most frequent of 14 names");
        assert!(notes[1].contains("the same color"), "{notes:?}");
    }
}
