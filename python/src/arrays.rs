//! Arrays of Python as columns: checked, and read where they lie.

use crate::errors::error;
use numpy::ndarray::{ArrayView1, ArrayView2};
use numpy::{Element, PyArrayDyn, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use std::fmt::Display;

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
    pub(crate) fn to_vec(&self, py: Python<'py>) -> Vec<f64> {
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
    pub(crate) fn to_columns(&self, py: Python<'py>) -> Vec<Vec<f64>> {
        fn columns<T: Number>(py: Python<'_>, table: ArrayView2<T>) -> Vec<Vec<f64>> {
            (0..table.ncols()).map(|column| collected(py, table.column(column))).collect()
        }
        match self {
            Self::Single(array) => columns(py, array.as_array()),
            Self::Double(array) => columns(py, array.as_array()),
        }
    }
}

fn collected<T: Number>(py: Python<'_>, column: ArrayView1<T>) -> Vec<f64> {
    py.detach(|| column.iter().map(|&value| value.into()).collect())
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
    match column.iter().position(|&value| !(value > 0.0 && value < f64::INFINITY)) {
        Some(row) => Err(refused(py, name, row, &column[row], "finite and greater than 0")),
        None => Ok(()),
    }
}

/// Checks that the rows of several columns are finite.
pub(crate) fn check_points(py: Python<'_>, name: &str, columns: &[Vec<f64>]) -> PyResult<()> {
    let first = columns
        .iter()
        .enumerate()
        .filter_map(|(axis, column)| Some((column.iter().position(|x| !x.is_finite())?, axis)))
        .min();
    let Some((row, axis)) = first else { return Ok(()) };
    let value = columns[axis][row];
    Err(error(py, &format!("{name}[{row}, {axis}] is {value}, but must be finite")))
}
