//! Particles and their style, from tables that the package's Python modules fill.

use crate::arrays::{Column, Table, check_points, check_positive, refused};
use crate::errors::error;
use crate::first_frame::FirstFrameTable;
use glam::{DQuat, DVec3};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use spherule::color::{Rgb, Spacing};
use spherule::particles::{
    Bonds, Cell, Codes, Element, Format, Kind, Kinds, LengthUnit, NumberColumn, ParticleFrame,
    Radii, ReadOptions, TextColumn,
};
use spherule::scene::particles::{
    ArrowCentering, ArrowStyle, BondSource, ColorEnds, Coloring, ColumnColors, ElementColors,
    Model, Opacity, ParticleStyle, Polyhedra, Properties, SelectedStyle, Selection, TypeMaterial,
    TypeStyle, accept_radii_expression,
};
use std::str::FromStr;

/// Names, and the row in them of each particle.
pub(crate) type Coded<'py> = (Vec<String>, Bound<'py, PyAny>);

/// Origin, the edges a, b and c, and whether the cell is periodic along each.
pub(crate) type CellTuple = ([f64; 3], [[f64; 3]; 3], [bool; 3]);

/// Columns of particles. Arrays are of floats, and have as many rows as there are particles.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct ParticleTable<'py> {
    positions: Bound<'py, PyAny>,
    /// `vdw`, `covalent`, `ionic` or a number.
    radii: Option<String>,
    radius: Option<Bound<'py, PyAny>>,
    radius_scale: f64,
    /// (n, 3) semi-axes, and (n, 4) quaternions with the real part first.
    semi_axes: Option<Bound<'py, PyAny>>,
    orientation: Option<Bound<'py, PyAny>>,
    color: Option<Bound<'py, PyAny>>,
    kinds: Option<Coded<'py>>,
    /// The symbol of the element of each kind, where it has one.
    elements: Vec<Option<String>>,
    /// True for kinds of virtual sites, which are not drawn; empty if there are none.
    virtual_sites: Vec<bool>,
    materials: Option<Coded<'py>>,
    numbers: Vec<(String, Bound<'py, PyAny>)>,
    texts: Vec<(String, Coded<'py>)>,
    cell: Option<CellTuple>,
    bonds: Option<BondTuple<'py>>,
    title: String,
    unit: String,
    /// The format of the file that the particles were read from, which decides what is up. Rows of files that cannot be
    /// drawn are left out; those of arrays are refused.
    format: Option<String>,
    /// The choices by the first frame of the file.
    pub(crate) first_frame: Option<FirstFrameTable>,
}

/// Rows of bonded particles, and the edges of the cell to add to each second one, if they are known.
pub(crate) type BondTuple<'py> = (PyReadonlyArray2<'py, u32>, Option<PyReadonlyArray2<'py, i8>>);

/// The style of a type: name, radius, color, material, opacity.
type TypeTuple = (String, Option<f64>, Option<[f32; 3]>, Option<String>, Option<f64>);

/// The style of particles.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct StyleTable {
    select: Option<String>,
    colors: Option<String>,
    color_by: Option<String>,
    color_map: Option<String>,
    /// Both ends, as in `2%,98%`.
    color_range: Option<String>,
    color_title: Option<String>,
    color_log: bool,
    model: Option<String>,
    bonds: Option<String>,
    bond_radius: Option<f64>,
    polyhedra: Option<String>,
    polyhedra_opacity: Option<f64>,
    opacity: Option<String>,
    translucent: Option<String>,
    arrows: Option<String>,
    arrow_scale: Option<f64>,
    arrow_radius: Option<f64>,
    arrow_color: Option<[f32; 3]>,
    arrow_center: Option<String>,
    types: Vec<TypeTuple>,
    hide: Option<String>,
    /// The styles of selections, as the program's option `--style` has them, and linear colors that replace theirs.
    styles: Vec<(String, Option<[f32; 3]>)>,
}

impl ParticleTable<'_> {
    /// The frame, and the options that complete it.
    pub(crate) fn frame(self, py: Python<'_>) -> PyResult<(ParticleFrame, ReadOptions)> {
        let columns = Table::of(&self.positions)?.to_columns(py)?;
        let format = self.format.as_deref().and_then(|name| {
            Format::ALL.iter().find(|(own, _)| *own == name).map(|(_, format)| *format)
        });
        if format.is_none() {
            check_points(py, "positions", &columns)?;
        }
        let count = columns.first().map_or(0, Vec::len);
        let [x, y, z] = <[_; 3]>::try_from(columns)
            .map_err(|columns| lengths(py, "positions", 3, columns.len()))?;
        let mut frame = ParticleFrame { x, y, z, title: self.title, ..ParticleFrame::default() };
        if let Some(radius) = &self.radius {
            frame.radius = Column::of(radius)?.to_vec(py)?;
            if format.is_none() {
                check_positive(py, "radius", &frame.radius)?;
            }
            check_length(py, "radius", count, frame.radius.len())?;
        }
        if let Some(semi_axes) = &self.semi_axes {
            let columns = Table::of(semi_axes)?.to_columns(py)?;
            let turned = self.orientation.as_ref().map(|quaternions| {
                let columns = Table::of(quaternions)?.to_columns(py)?;
                if format.is_none() {
                    check_points(py, "orientation", &columns)?;
                }
                quaternions_of(py, &columns, count)
            });
            let axes = axes_of(py, &columns, count, format.is_none())?;
            let keeps_radii = !frame.radius.is_empty();
            frame.set_shapes(axes, turned.transpose()?.unwrap_or_default(), keeps_radii);
        }
        if let Some(color) = &self.color {
            let columns = Table::of(color)?.to_columns(py)?;
            check_points(py, "color", &columns)?;
            let [red, green, blue] = <[_; 3]>::try_from(columns)
                .map_err(|columns| lengths(py, "color", 3, columns.len()))?;
            check_length(py, "color", count, red.len())?;
            let rows = red.iter().zip(&green).zip(&blue);
            let color =
                |((r, g), b): ((&f64, &f64), &f64)| Rgb::new(*r as f32, *g as f32, *b as f32);
            frame.color = rows.map(color).collect();
            if let Some(row) = frame.color.iter().position(|color| !is_share(*color)) {
                let message = format!("color[{row}] is {}, but must be 0 to 1", frame.color[row]);
                return Err(error(py, &message));
            }
        }
        if let Some((names, codes)) = &self.kinds {
            let kind = |(row, (name, element)): (usize, (&String, &Option<String>))| Kind {
                name: name.clone(),
                element: element.as_deref().and_then(Element::from_symbol),
                virtual_site: self.virtual_sites.get(row).copied().unwrap_or(false),
                ..Kind::default()
            };
            let table = names.iter().zip(&self.elements).enumerate().map(kind).collect();
            frame.kinds = Kinds { table, codes: codes_of(py, "kinds", names, codes, count)? };
        }
        if let Some((names, codes)) = self.materials {
            frame.materials = text_column(py, "materials", names, &codes, count)?;
        }
        for (name, values) in self.numbers {
            let values = Column::of(&values)?.to_vec(py)?;
            check_length(py, &name, count, values.len())?;
            frame.numbers.push(NumberColumn { name, values });
        }
        for (name, (names, codes)) in self.texts {
            frame.texts.push(text_column(py, &name, names, &codes, count)?);
        }
        frame.columns = frame.numbers.iter().map(|column| column.name.clone()).collect();
        frame.columns.extend(frame.texts.iter().map(|column| column.name.clone()));
        let cell =
            self.cell.map(|(origin, vectors, periodic)| cell_of(py, origin, vectors, periodic));
        frame.cell = cell.transpose()?;
        let bonds = self.bonds.as_ref();
        let bonds = bonds.map(|(pairs, shifts)| bonds_of(py, pairs, shifts.as_ref(), count));
        frame.bonds = bonds.transpose()?;
        frame.unit = unit_of(&self.unit);
        frame.format = format.unwrap_or_default();
        let radii = self.radii.as_deref().map_or(Ok(Radii::Auto), Radii::from_str);
        let mut options = ReadOptions {
            radii: radii.map_err(|message| error(py, &message))?,
            radius_scale: self.radius_scale,
            ..ReadOptions::default()
        };
        accept_radii_expression(&mut options);
        Ok((frame, options))
    }
}

impl StyleTable {
    /// The style of the program's options of the same names.
    pub(crate) fn style(self, py: Python<'_>, radius_scale: f64) -> PyResult<ParticleStyle> {
        let fault = |message: String| error(py, &message);
        let selection = |text: Option<&str>| {
            text.map(Selection::from_str).transpose().map_err(|why| fault(why.to_string()))
        };
        let select = selection(self.select.as_deref())?;
        let translucent = selection(self.translucent.as_deref())?;
        let opacity = self.opacity.as_deref().map(Opacity::from_str).transpose();
        let opacity = opacity.map_err(|why| fault(format!("`opacity`: {why}")))?;
        let arrows = self.arrows().map_err(fault)?;
        let coloring = match (self.color_by, self.colors.as_deref()) {
            (Some(column), _) => {
                let ends = self.color_range.as_deref().map(ColorEnds::from_str).transpose();
                let mut colors = ColumnColors {
                    column,
                    ends: ends
                        .map_err(|why| fault(format!("`color_range`: {why}")))?
                        .unwrap_or_default(),
                    title: self.color_title,
                    ..ColumnColors::default()
                };
                if self.color_log {
                    colors.spacing = Spacing::Logarithmic;
                }
                if let Some(name) = &self.color_map {
                    colors.set_map(name).map_err(fault)?;
                }
                Coloring::Column(colors)
            }
            (None, None) => Coloring::Usual,
            (None, Some("jmol")) => Coloring::Elements(ElementColors::Jmol),
            (None, Some("cpk")) => Coloring::Elements(ElementColors::Cpk),
            (None, Some(other)) => {
                return Err(fault(format!("`colors` is \"{other}\", but must be jmol or cpk")));
            }
        };
        let bonds = self.bonds.as_deref().map(BondSource::from_str).transpose().map_err(fault)?;
        let model = self.model.as_deref().map(model_of).transpose().map_err(fault)?;
        if let Some(radius) =
            self.bond_radius.filter(|radius| !(*radius > 0.0 && radius.is_finite()))
        {
            return Err(fault(format!("`bond_radius` is {radius}, but must be more than 0")));
        }
        let bond_radius = self.bond_radius;
        let polyhedra = self.polyhedra.as_deref().map(Polyhedra::from_str).transpose();
        let polyhedra = polyhedra.map_err(|why| fault(format!("`polyhedra`: {why}")))?;
        let mut polyhedra = polyhedra.unwrap_or_default();
        polyhedra.opacity = self.polyhedra_opacity;
        if let Some(opacity) = polyhedra.opacity.filter(|opacity| !(0.0..=1.0).contains(opacity)) {
            return Err(fault(format!("`polyhedra_opacity` is {opacity}, but must be 0 to 1")));
        }
        let types = self.types.into_iter().map(|(name, radius, color, material, opacity)| {
            let named = |word: &String| TypeMaterial::ALL.iter().find(|(own, _)| own == word);
            let known = material.as_ref().map(|word| {
                let names = TypeMaterial::ALL.map(|(name, _)| name).join(", ");
                let message = || format!("unknown material \"{word}\"; materials are {names}");
                named(word).map(|(_, material)| *material).ok_or_else(message)
            });
            let radius = radius.map(|radius| radius * radius_scale);
            let color = color.map(Rgb::from);
            if let Some(opacity) = opacity.filter(|opacity| !(0.0..=1.0).contains(opacity)) {
                return Err(format!("the opacity of `{name}` is {opacity}, but must be 0 to 1"));
            }
            let properties = Properties {
                radius,
                color: color.map(Coloring::Uniform),
                material: known.transpose()?,
                opacity: opacity.map(Opacity::Number),
                ..Properties::default()
            };
            Ok(TypeStyle { name, properties, element: None })
        });
        let types = types.collect::<Result<_, _>>().map_err(fault)?;
        let hidden = selection(self.hide.as_deref())?.map(SelectedStyle::hidden);
        let mut styles: Vec<SelectedStyle> = hidden.into_iter().collect();
        for (row, (text, color)) in self.styles.iter().enumerate() {
            let parsed = text.parse::<SelectedStyle>();
            let mut own = parsed.map_err(|why| fault(format!("styles[{row}]: {why}")))?;
            own.properties.color =
                color.map(Rgb::from).map(Coloring::Uniform).or(own.properties.color);
            styles.push(own);
        }
        let radii = styles.iter_mut().filter_map(|own| own.properties.radius.as_mut());
        radii.for_each(|radius| *radius *= radius_scale);
        Ok(ParticleStyle {
            select,
            coloring,
            model,
            bonds,
            bond_radius,
            polyhedra,
            opacity,
            translucent,
            arrows,
            types,
            styles,
            ..ParticleStyle::default()
        })
    }
}

impl StyleTable {
    /// The arrows that are asked for.
    fn arrows(&self) -> Result<Option<ArrowStyle>, String> {
        let Some(columns) = &self.arrows else { return Ok(None) };
        for (name, size) in [("arrow_scale", self.arrow_scale), ("arrow_radius", self.arrow_radius)]
        {
            if let Some(size) = size.filter(|size| !(*size > 0.0 && size.is_finite())) {
                return Err(format!("`{name}` is {size}, but must be more than 0"));
            }
        }
        let centering = self.arrow_center.as_deref().map(|name| {
            let found = ArrowCentering::ALL.iter().find(|(own, _)| *own == name);
            let names = ArrowCentering::ALL.map(|(name, _)| name).join(", ");
            let fault = || format!("`arrow_center` is \"{name}\", but must be one of {names}");
            found.map(|(_, own)| *own).ok_or_else(fault)
        });
        Ok(Some(ArrowStyle {
            columns: columns.parse()?,
            scale: self.arrow_scale,
            radius: self.arrow_radius,
            color: self.arrow_color.map(Rgb::from),
            centering: centering.transpose()?.unwrap_or_default(),
        }))
    }
}

fn model_of(name: &str) -> Result<Model, String> {
    Model::named(name).ok_or_else(|| {
        let names = Model::ALL.map(|(name, _)| name).join(", ");
        format!("unknown model \"{name}\"; models are {names}")
    })
}

fn is_share(color: Rgb) -> bool {
    (0..3).all(|channel| (0.0..=1.0).contains(&color[channel]))
}

/// The cell, if its edges span a volume.
pub(crate) fn cell_of(
    py: Python<'_>,
    origin: [f64; 3],
    vectors: [[f64; 3]; 3],
    periodic: [bool; 3],
) -> PyResult<Cell> {
    let [a, b, c] = vectors.map(DVec3::from);
    let cell = Cell { origin: origin.into(), vectors: [a, b, c], periodic };
    let finite = [a, b, c, cell.origin].iter().all(|vector| vector.is_finite());
    if finite && a.cross(b).dot(c) != 0.0 {
        return Ok(cell);
    }
    Err(error(py, &"`cell` must be finite, with three edges that span a volume"))
}

/// The semi-axes of `count` particles, three zeros for spheres; if `checks`, others must be more than 0.
fn axes_of(
    py: Python<'_>,
    columns: &[Vec<f64>],
    count: usize,
    checks: bool,
) -> PyResult<Vec<DVec3>> {
    let [x, y, z] = columns else { return Err(lengths(py, "semi_axes", 3, columns.len())) };
    check_length(py, "semi_axes", count, x.len())?;
    let axes: Vec<DVec3> = (0..count).map(|row| DVec3::new(x[row], y[row], z[row])).collect();
    let invalid =
        |axes: &DVec3| *axes != DVec3::ZERO && !(axes.is_finite() && axes.min_element() > 0.0);
    match axes.iter().position(invalid).filter(|_| checks) {
        Some(row) => {
            let must = "three finite numbers greater than 0, or three zeros for a sphere";
            Err(refused(py, "semi_axes", row, &axes[row], must))
        }
        None => Ok(axes),
    }
}

/// The quaternions of `count` particles.
fn quaternions_of(py: Python<'_>, columns: &[Vec<f64>], count: usize) -> PyResult<Vec<DQuat>> {
    let [w, x, y, z] = columns else { return Err(lengths(py, "orientation", 4, columns.len())) };
    check_length(py, "orientation", count, w.len())?;
    Ok((0..count).map(|row| DQuat::from_xyzw(x[row], y[row], z[row], w[row])).collect())
}

/// Sorted bonds of `count` particles.
fn bonds_of(
    py: Python<'_>,
    pairs: &PyReadonlyArray2<'_, u32>,
    shifts: Option<&PyReadonlyArray2<'_, i8>>,
    count: usize,
) -> PyResult<Bonds> {
    let (pairs, shifts) = (pairs.as_array(), shifts.map(|shifts| shifts.as_array()));
    if pairs.ncols() != 2 || shifts.is_some_and(|shifts| shifts.dim() != (pairs.nrows(), 3)) {
        return Err(error(
            py,
            &"`bonds` must have two columns, and three edges of the cell for each",
        ));
    }
    let mut bonds = Bonds::default();
    for (row, pair) in pairs.rows().into_iter().enumerate() {
        if let Some(&end) = pair.iter().find(|&&end| end as usize >= count) {
            let must = format!("a row of the {count} particles");
            return Err(refused(py, "bonds", row, &end, &must));
        }
        bonds.first.push(pair[0]);
        bonds.second.push(pair[1]);
    }
    if let Some(shifts) = shifts {
        bonds.shift =
            shifts.rows().into_iter().map(|edges| [0, 1, 2].map(|axis| edges[axis])).collect();
    }
    Ok(bonds)
}

/// The unit with a name; unknown ones are unknown.
fn unit_of(name: &str) -> LengthUnit {
    use LengthUnit::{Angstrom, Bohr, Centimeter, Meter, Micrometer, Nanometer};
    let known = [Angstrom, Nanometer, Bohr, Micrometer, Centimeter, Meter];
    known.into_iter().find(|unit| unit.name() == name).unwrap_or_default()
}

fn text_column(
    py: Python<'_>,
    name: &str,
    names: Vec<String>,
    codes: &Bound<'_, PyAny>,
    count: usize,
) -> PyResult<TextColumn> {
    let codes = codes_of(py, name, &names, codes, count)?;
    Ok(TextColumn { name: name.to_owned(), names, codes })
}

/// Rows in a table of names, in the narrowest type.
fn codes_of(
    py: Python<'_>,
    name: &str,
    names: &[String],
    codes: &Bound<'_, PyAny>,
    count: usize,
) -> PyResult<Codes> {
    let codes: numpy::PyReadonlyArray1<u32> = codes.extract()?;
    let codes = codes.as_array();
    check_length(py, name, count, codes.len())?;
    if let Some(row) = codes.iter().position(|&code| code as usize >= names.len()) {
        let (code, most) = (codes[row], names.len());
        return Err(error(py, &format!("{name}[{row}] is {code}, but there are {most} names")));
    }
    Ok(match names.len() {
        0..=0x100 => Codes::Bytes(codes.iter().map(|&code| code as u8).collect()),
        0x101..=0x1_0000 => Codes::Shorts(codes.iter().map(|&code| code as u16).collect()),
        _ => Codes::Words(codes.iter().copied().collect()),
    })
}

fn check_length(py: Python<'_>, name: &str, expected: usize, found: usize) -> PyResult<()> {
    if found == expected { Ok(()) } else { Err(lengths(py, name, expected, found)) }
}

fn lengths(py: Python<'_>, name: &str, expected: usize, found: usize) -> PyErr {
    error(py, &format!("`{name}` has {found} entries, but must have {expected}"))
}
