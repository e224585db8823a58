//! Annotations that are asked for, and those that they become beside the facts of a frame.

use super::marks::{Marks, MeasureRequest};
use super::template::{Template, Value};
use super::{Fault, Request, Subject};
use crate::color;
use crate::scene::particles::{Applied, Category, Cell, Coloring, Legend, Particles, Selection};
use crate::scene::{
    Anchor, Annotations, AxisTripod, ColorBar, ColorLegend, Label, LetterSize, Lettering, Rgb,
    ScaleBar, Scene,
};
use crate::settings::Length;
use crate::suggest;
use std::cmp::Ordering;
use std::str::FromStr;

/// Maximum number of entries of a legend.
const ENTRIES: usize = 12;

/// Annotations to draw inside the image, beside those of the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AnnotationRequest {
    /// Position of the color bar, if colors stand for numbers.
    pub color_bar: Option<Anchor>,
    /// Position of the legend of names.
    pub legend: Option<Anchor>,
    /// The tripod of axes.
    pub axes: Option<Axes>,
    /// The scale bar.
    pub scale_bar: Option<Bar>,
    /// Lines of text.
    pub labels: Vec<LabelText>,
    /// Distances and angles.
    pub measures: Vec<MeasureRequest>,
    /// Size of letters.
    pub text_size: Option<LetterSize>,
    /// Color of letters.
    pub text_color: Option<Rgb>,
}

/// Axes, and the position of their tripod.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// True for the cell's edges, false for x, y and z.
    pub of_cell: bool,
    /// Its position.
    pub position: Anchor,
}

/// Length and position of a scale bar.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bar {
    /// Its length; `None` for a round one.
    pub length: Option<f64>,
    /// Its position.
    pub position: Anchor,
}

/// Text and position of a label.
#[derive(Clone, Debug, PartialEq)]
pub struct LabelText {
    /// The text with its fields.
    pub template: Template,
    /// Its position.
    pub position: Anchor,
    /// The particles at each of which it is, instead of a position.
    pub particles: Option<Selection>,
}

/// Returns the anchor with this name.
///
/// # Errors
/// The name is none; the names that there are.
pub fn position(name: &str) -> Result<Anchor, String> {
    let names = || Anchor::ALL.into_iter().map(|(name, _)| name);
    Anchor::named(name).ok_or_else(|| suggest::help(name, names(), "positions are"))
}

/// Returns the color of letters with this name.
///
/// # Errors
/// It is none; a name that is near.
pub fn ink(text: &str) -> Result<Rgb, String> {
    color::parse(text).ok_or_else(|| {
        let near = suggest::question(text, color::names());
        format!("give a CSS color such as black, or six digits as in \"#202020\"{near}")
    })
}

impl FromStr for Axes {
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

impl FromStr for Bar {
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

impl FromStr for LabelText {
    type Err = String;

    /// Parses a template, with or without a position or a selection of particles before it.
    fn from_str(text: &str) -> Result<Self, String> {
        let placed =
            text.split_once(':').and_then(|(name, rest)| Some((Anchor::named(name)?, rest)));
        if let Some((position, text)) = placed {
            return Ok(Self { template: text.parse()?, position, particles: None });
        }
        let (particles, text) =
            selected(text).map_or((None, text), |(selection, rest)| (Some(selection), rest));
        Ok(Self { template: text.parse()?, position: Anchor::TopLeft, particles })
    }
}

/// Splits a text that begins with a selection, a colon and a space or a field. A single word is no selection, since texts begin
/// with words: `time: {time}`.
fn selected(text: &str) -> Option<(Selection, &str)> {
    text.match_indices(':').find_map(|(at, _)| {
        let (before, rest) = (&text[..at], &text[at + 1..]);
        let ends = rest.starts_with([' ', '{']);
        let is_word = before.trim().chars().all(char::is_alphanumeric);
        let selection = (ends && !is_word).then(|| before.parse().ok()).flatten()?;
        Some((selection, rest.trim_start()))
    })
}

/// Facts about a frame that annotations show.
#[derive(Clone, Debug, Default)]
pub(super) struct Facts {
    /// The names that colors stand for, if they are asked for and exist.
    pub(super) categories: Option<Vec<Category>>,
    /// True if colors stand for numbers.
    numeric: bool,
    /// The title of what colors stand for, if it is one column.
    label: String,
    /// The cell, if the particles have one.
    pub(super) cell: Option<Cell>,
    /// Symbol of the unit of length; empty if the unit is unknown.
    unit: &'static str,
    /// Number of particles without images of them at the boundary of their cell; `None` if the scene is not of particles.
    pub(super) particles: Option<usize>,
    /// Step, time and the header's values; `None` if the scene is not of particles.
    header: Option<Header>,
    /// Annotations at particles.
    pub(super) marks: Marks,
}

#[derive(Clone, Debug)]
struct Header {
    step: Option<i64>,
    time: Option<f64>,
    title: String,
    values: Vec<(String, String)>,
}

impl Facts {
    /// Returns the facts about particles whose colors are final.
    pub(super) fn of(request: &Request, particles: &Particles, applied: &Applied) -> Self {
        let style = &request.style;
        let legend = request.annotations.legend.is_some();
        Self {
            categories: legend.then(|| particles.categories(style, applied)).flatten(),
            numeric: style.column_colors().any(|colors| colors.is_numeric(particles)),
            label: match &style.coloring {
                Coloring::Column(colors) if style.colorings().count() == 1 => {
                    colors.label(&particles.frame)
                }
                _ => String::new(),
            },
            cell: particles.frame.cell,
            unit: particles.frame.unit.symbol(),
            particles: Some(particles.spheres.len()),
            header: Some(Header {
                step: particles.frame.step,
                time: particles.frame.time,
                title: particles.frame.title.clone(),
                values: particles.header_values(),
            }),
            marks: Marks::default(),
        }
    }

    /// Returns the fields of labels with their values.
    fn fields(&self, subject: &Subject, scene: &Scene) -> Vec<(String, Value)> {
        const NO_FRAMES: Value = Value::Missing("only particle files have it");
        let (mut step, mut time, mut frame) = (NO_FRAMES, NO_FRAMES, NO_FRAMES);
        let mut title = scene.title.clone();
        let mut values = Vec::new();
        if let Some(header) = &self.header {
            step = header.step.map_or(Value::Missing("the file has no steps"), Value::Whole);
            time = header.time.map_or(Value::Missing("the file has no times"), Value::Number);
            frame = subject.frame.clone();
            title.clone_from(&header.title);
            values.clone_from(&header.values);
        }
        let path = subject.path.to_string_lossy();
        let file = path.rsplit(['/', '\\']).next().unwrap_or_default().to_owned();
        let drawn = scene.spheres.len() + scene.ellipsoids.len();
        let particles = self.particles.map_or(drawn, |particles| particles.min(drawn));
        let own = [
            ("time", time),
            ("step", step),
            ("frame", frame),
            ("file", Value::Text(file)),
            ("title", Value::Text(title)),
            ("particles", Value::Whole(particles as i64)),
        ];
        let own = own.map(|(name, value)| (name.to_owned(), value));
        let values = values.into_iter().map(|(name, value)| (name, Value::Text(value)));
        own.into_iter().chain(values).collect()
    }
}

impl AnnotationRequest {
    /// Returns the columns of particles that labels and measures need.
    pub fn columns(&self) -> Vec<String> {
        let at_particles =
            self.labels.iter().filter_map(|label| Some((label, label.particles.as_ref()?)));
        let mut columns: Vec<String> = at_particles
            .flat_map(|(label, own)| {
                label.template.fields().map(str::to_owned).chain(own.columns())
            })
            .collect();
        columns.extend((!self.measures.is_empty()).then(|| "id".to_owned()));
        columns
    }

    /// Returns whether a label has this field.
    pub fn shows(&self, field: &str) -> bool {
        self.labels.iter().any(|label| label.template.has(field))
    }
}

/// Adds the annotations of the request to those of a scene, which they override; labels are added to those of the
/// scene.
pub(super) fn add(
    request: &Request,
    subject: &Subject,
    scene: &mut Scene,
    legend: Option<&Legend>,
    facts: &Facts,
) -> Result<(), Fault> {
    let asked = &request.annotations;
    let mut annotations = std::mem::take(&mut scene.annotations);
    if let (Some(position), Some(Legend { scale, label })) = (asked.color_bar, legend) {
        annotations.color_bar = Some(ColorBar { scale: *scale, label: label.clone(), position });
    }
    // Frames of a trajectory may be empty.
    let none = request.style.allow_empty && scene.is_empty();
    match (asked.legend, &facts.categories) {
        (Some(position), Some(categories)) => {
            annotations.legend = Some(color_legend(categories, facts.label.clone(), position));
        }
        (Some(_), None) if !none => return Err(Fault::Legend { numeric: facts.numeric }),
        _ => (),
    }
    if let Some(axes) = &asked.axes {
        let mut tripod = AxisTripod { position: axes.position, ..AxisTripod::default() };
        if axes.of_cell {
            let Some(cell) = facts.cell else { return Err(Fault::AxesOfCell) };
            tripod.directions = cell.vectors;
            tripod.names = ["a", "b", "c"].map(str::to_owned);
        }
        annotations.axes = Some(tripod);
    }
    if let Some(Bar { length, position }) = asked.scale_bar {
        let own = annotations.scale_bar.take().unwrap_or_default().unit;
        let unit = if own.is_empty() { facts.unit.to_owned() } else { own };
        annotations.scale_bar = Some(ScaleBar { length, unit, position });
    }
    if !asked.labels.is_empty() {
        let fields = facts.fields(subject, scene);
        for (row, label) in asked.labels.iter().enumerate() {
            let fault = |why: String| Fault::Label { row, why };
            let position = label.position;
            if label.particles.is_none() {
                let text = label.template.expand(&fields).map_err(fault)?;
                annotations.labels.push(Label { text, position, at: None });
                continue;
            }
            if facts.header.is_none() {
                return Err(fault("labels at particles need a particle file".to_owned()));
            }
            let texts = facts.marks.labels(row, &label.template, &fields, &scene.slices);
            let texts = texts.map_err(fault)?.into_iter();
            annotations.labels.extend(texts.map(|(at, text)| Label {
                text,
                position,
                at: Some(at),
            }));
        }
    }
    if !asked.measures.is_empty() && facts.header.is_none() {
        let why = "measures need a particle file; a scene file has [[measure]]".to_owned();
        return Err(Fault::Measure { row: 0, why });
    }
    annotations.measures.extend(facts.marks.measures.iter().cloned());
    let Lettering { size, color } = &mut annotations.lettering;
    *size = asked.text_size.or(*size);
    *color = asked.text_color.or(*color);
    scene.annotations = annotations;
    Ok(())
}

/// Gives the image a resolution if its letters are a length on paper.
pub(super) fn set_resolution(scene: &mut Scene) {
    if let Some(LetterSize::Length(_)) = scene.annotations.lettering.size {
        scene.settings.dpi.get_or_insert(Length::RESOLUTION);
    }
}

/// Returns the legend of the most frequent categories, sorted by name.
fn color_legend(categories: &[Category], label: String, position: Anchor) -> ColorLegend {
    let mut chosen: Vec<&Category> = categories.iter().collect();
    chosen.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| by_name(a, b)));
    let omitted = chosen.len().saturating_sub(ENTRIES) as u64;
    chosen.truncate(ENTRIES);
    chosen.sort_by(|a, b| by_name(a, b));
    let entries = chosen.iter().map(|category| (category.color, entry(category, categories)));
    ColorLegend { label, entries: entries.collect(), omitted, position }
}

/// Returns the name of a category in a legend. Of several of one name, such as the chain C and carbon, each says what it is; of
/// those that are the same, the ones of styles say of which selection they are.
fn entry(category: &Category, all: &[Category]) -> String {
    let Category { name, source, selection, .. } = category;
    let twins = || all.iter().filter(|own| own.name == *name && *own != category);
    if twins().any(|own| own.source != *source) {
        return format!("{name} ({source})");
    }
    let is_told = twins().next().is_none() || selection.is_empty() || selection == name;
    if is_told { name.clone() } else { format!("{name} ({selection})") }
}

/// Compares names: numbers by value, and before other names.
fn by_name(a: &Category, b: &Category) -> Ordering {
    let number = |category: &Category| category.name.parse::<f64>().unwrap_or(f64::INFINITY);
    number(a).total_cmp(&number(b)).then_with(|| a.name.cmp(&b.name))
}

/// Returns notes about names that the legend omits, and about colors that stand for several names.
pub fn notes(annotations: &Annotations) -> Vec<String> {
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
        let axes = |of_cell, position| Ok(Axes { of_cell, position });
        assert_eq!("top".parse(), axes(false, Anchor::Top));
        assert_eq!("cell".parse(), axes(true, Anchor::BottomLeft));
        assert_eq!("cell:left".parse(), axes(true, Anchor::Left));
        for text in ["", "cells", "cell:", "cell:middle", "middle"] {
            assert!(text.parse::<Axes>().is_err(), "{text}");
        }
        let bar = |length, position| Ok(Bar { length, position });
        assert_eq!("2.5".parse(), bar(Some(2.5), Anchor::BottomRight));
        assert_eq!("top-left".parse(), bar(None, Anchor::TopLeft));
        assert_eq!("1e-3:bottom".parse(), bar(Some(1e-3), Anchor::Bottom));
        for text in ["", "0", "-1", "inf", "nan", "5:middle", "middle", ":left"] {
            assert!(text.parse::<Bar>().is_err(), "{text}");
        }
        let label = |text: &str| text.parse::<LabelText>().map(|label| label.position);
        assert_eq!(label("bottom:a"), Ok(Anchor::Bottom));
        assert_eq!(label("time: {time}"), Ok(Anchor::TopLeft));
        assert!(label("{time").is_err());
    }

    #[test]
    fn selections_before_labels_are_told_from_texts() {
        for (text, selection, field) in [
            ("resname LIG: {name}", "resname LIG", "name"),
            ("resid 5:10: {id}", "resid 5:10", "id"),
            ("z > 3 and name CA:{q}", "z > 3 and name CA", "q"),
            ("(ligand): {name}", "(ligand)", "name"),
        ] {
            let label: LabelText = text.parse().expect("a label");
            assert_eq!(label.particles, Some(selection.parse().unwrap()), "{text}");
            assert_eq!(label.template.fields().collect::<Vec<_>>(), [field], "{text}");
        }
        for text in ["time: {time}", "water: {time}", "t = {time}: a", "top:resname LIG: a", "a b"]
        {
            assert_eq!(text.parse::<LabelText>().expect("a label").particles, None, "{text}");
        }
    }

    #[test]
    fn names_that_are_alike_say_what_they_are() {
        let category = |name: &str, source: &str, selection: &str, red: f32| Category {
            name: name.to_owned(),
            color: Rgb::X * red,
            count: 1,
            source: source.to_owned(),
            selection: selection.to_owned(),
        };
        let own = category("C", "chain", "", 0.1);
        let carbon = category("C", "element", "ligand", 0.2);
        let others = [category("C", "element", "", 0.3), category("D", "chain", "", 0.4)];
        let names = |all: &[Category]| {
            let legend = color_legend(all, String::new(), Anchor::Top);
            legend.entries.into_iter().map(|(_, name)| name).collect::<Vec<_>>()
        };
        assert_eq!(
            names(&[own, carbon.clone(), others[1].clone()]),
            ["C (chain)", "C (element)", "D"]
        );
        assert_eq!(names(&[others[0].clone(), carbon]), ["C", "C (ligand)"]);
    }

    #[test]
    fn legends_show_the_most_frequent_names_in_order() {
        let category = |name: usize| Category {
            name: name.to_string(),
            color: Rgb::ONE,
            count: if name == 3 { 1 } else { 100 - name as u64 },
            source: "element".to_owned(),
            selection: String::new(),
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
