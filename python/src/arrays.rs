//! Arrays of Python as columns: checked, and read where they lie.

use crate::errors::error;
use numpy::ndarray::{ArrayView1, ArrayView2, Axis};
use numpy::{Element, PyArrayDyn, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use std::fmt::Display;

/// The most rows that are copied between two looks at signals: some milliseconds.
const CHUNK: usize = 1 << 20;

/// A column or a table of either precision, of any strides.
pub(crate) enum Floats<A, B> {
    Single(A),
    Double(B),
}

pub(crate) type Column<'py> = Floats<PyReadonlyArray1<'py, f32>, PyReadonlyArray1<'py, f64>>;
pub(crate) type Table<'py> = Floats<PyReadonlyArray2<'py, f32>, PyReadonlyArray2<'py, f64>>;

/// Numbers of a column, as doubles.
trait Number: Element + Copy + Into<f64> + Sync {}

impl Number for f32 {}
impl Number for f64 {}

fn is_single(array: &Bound<'_, PyAny>) -> bool {
    array.cast::<PyArrayDyn<f32>>().is_ok()
}

impl<'py> Column<'py> {
    /// The array, which is of floats with one dimension: the package's modules see to that.
    pub(crate) fn of(array: &Bound<'py, PyAny>) -> PyResult<Self> {
        Ok(if is_single(array) {
            Self::Single(array.extract()?)
        } else {
            Self::Double(array.extract()?)
        })
    }

    /// The values, in double precision.
    ///
    /// # Errors
    /// That of a signal.
    pub(crate) fn to_vec(&self, py: Python<'py>) -> PyResult<Vec<f64>> {
        match self {
            Self::Single(array) => collected(py, array.as_array()),
            Self::Double(array) => collected(py, array.as_array()),
        }
    }
}

impl<'py> Table<'py> {
    /// The array, which is of floats with two dimensions: the package's modules see to that.
    pub(crate) fn of(array: &Bound<'py, PyAny>) -> PyResult<Self> {
        Ok(if is_single(array) {
            Self::Single(array.extract()?)
        } else {
            Self::Double(array.extract()?)
        })
    }

    /// The columns, in double precision.
    ///
    /// # Errors
    /// That of a signal.
    pub(crate) fn to_columns(&self, py: Python<'py>) -> PyResult<Vec<Vec<f64>>> {
        fn columns<T: Number>(py: Python<'_>, table: ArrayView2<T>) -> PyResult<Vec<Vec<f64>>> {
            (0..table.ncols()).map(|column| collected(py, table.column(column))).collect()
        }
        match self {
            Self::Single(array) => columns(py, array.as_array()),
            Self::Double(array) => columns(py, array.as_array()),
        }
    }
}

/// The values of a column, in double precision; signals are looked at between chunks.
fn collected<T: Number>(py: Python<'_>, column: ArrayView1<T>) -> PyResult<Vec<f64>> {
    let mut values = Vec::with_capacity(column.len());
    for chunk in column.axis_chunks_iter(Axis(0), CHUNK) {
        py.detach(|| values.extend(chunk.iter().map(|&value| value.into())));
        py.check_signals()?;
    }
    Ok(values)
}

/// The exception for a value of an array: its name, its row, and what it must be.
pub(crate) fn refused(
    py: Python<'_>,
    name: &str,
    row: usize,
    value: &dyn Display,
    must: &str,
) -> PyErr {
    error(py, &format!("{name}[{row}] is {value}, but must be {must}"))
}

/// Checks that all values are finite and more than 0.
pub(crate) fn check_positive(py: Python<'_>, name: &str, column: &[f64]) -> PyResult<()> {
    let invalid = |&value: &f64| !(value > 0.0 && value < f64::INFINITY);
    match py.detach(|| column.iter().position(invalid)) {
        Some(row) => Err(refused(py, name, row, &column[row], "finite and greater than 0")),
        None => Ok(()),
    }
}

/// Checks that the rows of several columns are finite.
pub(crate) fn check_points(py: Python<'_>, name: &str, columns: &[Vec<f64>]) -> PyResult<()> {
    let invalid = |(axis, column): (usize, &Vec<f64>)| {
        Some((column.iter().position(|x| !x.is_finite())?, axis))
    };
    let first = py.detach(|| columns.iter().enumerate().filter_map(invalid).min());
    let Some((row, axis)) = first else { return Ok(()) };
    let value = columns[axis][row];
    Err(error(py, &format!("{name}[{row}, {axis}] is {value}, but must be finite")))
}
