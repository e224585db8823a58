//! Exact ray queries on arrays.

use crate::arrays::refused;
use crate::errors::error;
use crate::pools::pool;
use numpy::ndarray::{ArrayView1, ArrayView2, Axis};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;
use spherule::query::{Hits, NOTHING, QueryError, RayColumns, RayRows, Surface};
use std::borrow::Cow;

/// The most rays of a task: as many as are put in order together.
const ROWS_AT_ONCE: usize = 1 << 16;

/// The fewest rays of a task.
const SMALL: usize = 1 << 11;

/// Spheres, ready for exact queries.
#[pyclass(frozen, module = "spherule._spherule")]
pub(crate) struct SphereTree {
    tree: spherule::query::SphereTree,
}

/// Distances, spheres, and points and normals if they were asked for.
type HitArrays<'py> = (
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<u32>>,
    Option<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)>,
);

#[pymethods]
impl SphereTree {
    #[new]
    fn new(
        py: Python<'_>,
        positions: PyReadonlyArray2<'_, f32>,
        radius: PyReadonlyArray1<'_, f32>,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let pool = pool(py, threads)?;
        let (centers, radii) = (positions.as_array(), radius.as_array());
        let invalid = |value: &f32| !(*value > 0.0 && *value < f32::INFINITY);
        if let Some(row) = radii.iter().position(invalid) {
            return Err(refused(py, "radius", row, &radii[row], "finite and greater than 0"));
        }
        for (row, center) in centers.rows().into_iter().enumerate() {
            if let Some(axis) = center.iter().position(|value| !value.is_finite()) {
                let value = center[axis];
                let text = format!("positions[{row}, {axis}] is {value}, but must be finite");
                return Err(error(py, &text));
            }
        }
        let tree = py.detach(|| pool.install(|| build(centers, radii)));
        Ok(Self { tree: tree.map_err(|why| error(py, &why))? })
    }

    /// The number of spheres.
    fn __len__(&self) -> usize {
        self.tree.len()
    }

    /// Bytes of the tree and its spheres.
    #[getter]
    fn nbytes(&self) -> usize {
        self.tree.bytes()
    }

    fn intersect<'py>(
        &self,
        py: Python<'py>,
        origins: PyReadonlyArray2<'py, f32>,
        directions: PyReadonlyArray2<'py, f32>,
        bound: Option<PyReadonlyArray1<'py, f64>>,
        surface: bool,
        threads: Option<usize>,
    ) -> PyResult<HitArrays<'py>> {
        let pool = pool(py, threads)?;
        let rays = RowsOfRays { origins: origins.as_array(), directions: directions.as_array() };
        let count = rays.len();
        let bound = bound.as_ref().map(|bound| bound.as_array());
        // Zeros are pages that nobody has touched: each task fills its own.
        let (mut t, mut sphere) = (vec![0.0; count], vec![0; count]);
        let rows = if surface { count } else { 0 };
        let mut points = vec![[f64::NAN; 3]; rows];
        let mut normals = vec![[f64::NAN; 3]; rows];
        let size = task(count, pool.current_num_threads());
        let traced = py.detach(|| {
            pool.install(|| {
                let tasks = t.par_chunks_mut(size).zip(sphere.par_chunks_mut(size)).enumerate();
                if !surface {
                    return tasks.try_for_each(|(chunk, (t, sphere))| {
                        let first = chunk * size;
                        fill_bounds(t, bound, first);
                        self.trace(rays.part(first, t.len()), t, sphere, None)?;
                        forget_misses(t, sphere);
                        Ok(())
                    });
                }
                let surfaces = points.par_chunks_mut(size).zip(normals.par_chunks_mut(size));
                tasks.zip(surfaces).try_for_each(|((chunk, (t, sphere)), (points, normals))| {
                    let first = chunk * size;
                    fill_bounds(t, bound, first);
                    let rays = rays.part(first, t.len());
                    let mut found = vec![Surface::default(); t.len()];
                    self.trace(rays, t, sphere, Some(&mut found))?;
                    let hits = sphere.iter().zip(&found).zip(points.iter_mut().zip(normals));
                    for ((&sphere, found), (point, normal)) in hits {
                        if sphere != NOTHING {
                            (*point, *normal) = (found.point, found.normal);
                        }
                    }
                    forget_misses(t, sphere);
                    Ok(())
                })
            })
        });
        traced.map_err(|why: QueryError| error(py, &why))?;
        let table =
            |rows: Vec<[f64; 3]>| PyArray1::from_vec(py, rows.into_flattened()).reshape([count, 3]);
        let surfaces = if surface { Some((table(points)?, table(normals)?)) } else { None };
        Ok((PyArray1::from_vec(py, t), PyArray1::from_vec(py, sphere), surfaces))
    }

    fn occluded<'py>(
        &self,
        py: Python<'py>,
        origins: PyReadonlyArray2<'py, f32>,
        directions: PyReadonlyArray2<'py, f32>,
        bound: Option<PyReadonlyArray1<'py, f64>>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyArray1<bool>>> {
        let rays = RowsOfRays { origins: origins.as_array(), directions: directions.as_array() };
        let occluded = self.shade_all(py, rays, bound, threads)?;
        Ok(PyArray1::from_vec(py, occluded))
    }

    fn count(
        &self,
        py: Python<'_>,
        origins: PyReadonlyArray2<'_, f32>,
        directions: PyReadonlyArray2<'_, f32>,
        bound: Option<PyReadonlyArray1<'_, f64>>,
        threads: Option<usize>,
    ) -> PyResult<u64> {
        let rays = RowsOfRays { origins: origins.as_array(), directions: directions.as_array() };
        let occluded = self.shade_all(py, rays, bound, threads)?;
        Ok(py.detach(|| occluded.iter().filter(|&&hit| hit).count() as u64))
    }
}

impl SphereTree {
    /// Finds whether each ray hits anything, on the threads of a pool.
    fn shade_all(
        &self,
        py: Python<'_>,
        rays: RowsOfRays,
        bound: Option<PyReadonlyArray1<'_, f64>>,
        threads: Option<usize>,
    ) -> PyResult<Vec<bool>> {
        let bound = bound.as_ref().map(|bound| bound.as_array());
        let mut occluded = vec![false; rays.len()];
        let pool = pool(py, threads)?;
        let size = task(rays.len(), pool.current_num_threads());
        let traced = py.detach(|| {
            pool.install(|| {
                let tasks = occluded.par_chunks_mut(size).enumerate();
                tasks.try_for_each_init(Vec::new, |t, (chunk, occluded)| {
                    let first = chunk * size;
                    t.resize(occluded.len(), 0.0);
                    fill_bounds(t, bound, first);
                    self.shade(rays.part(first, occluded.len()), t, occluded)
                })
            })
        });
        traced.map_err(|why: QueryError| error(py, &why))?;
        Ok(occluded)
    }

    fn trace(
        &self,
        rays: RowsOfRays,
        t: &mut [f64],
        sphere: &mut [u32],
        surface: Option<&mut [Surface]>,
    ) -> Result<(), QueryError> {
        let hits = Hits { t, sphere, surface };
        match rays.in_rows() {
            Some(rays) => self.tree.intersect_rows(&rays, hits)?,
            None => rays.in_columns(|rays| self.tree.intersect_columns(rays, hits))?,
        };
        Ok(())
    }

    fn shade(&self, rays: RowsOfRays, t: &[f64], occluded: &mut [bool]) -> Result<(), QueryError> {
        match rays.in_rows() {
            Some(rays) => self.tree.occluded_rows(&rays, t, occluded)?,
            None => rays.in_columns(|rays| self.tree.occluded_columns(rays, t, occluded))?,
        };
        Ok(())
    }
}

/// Builds the tree from what lies in memory, without a copy where rows or columns are contiguous.
fn build(
    centers: ArrayView2<f32>,
    radii: ArrayView1<f32>,
) -> Result<spherule::query::SphereTree, QueryError> {
    let owned;
    let radii = if let Some(radii) = radii.to_slice() {
        radii
    } else {
        owned = radii.to_vec();
        &owned
    };
    if let Some(rows) = centers.to_slice() {
        return spherule::query::SphereTree::from_centers(rows.as_chunks().0, radii);
    }
    let column = |axis| centers.index_axis(Axis(1), axis);
    let (x, y, z) = (column(0), column(1), column(2));
    if let (Some(x), Some(y), Some(z)) = (x.to_slice(), y.to_slice(), z.to_slice()) {
        return spherule::query::SphereTree::from_columns(x, y, z, radii);
    }
    let [x, y, z] = [x, y, z].map(|column| column.to_vec());
    spherule::query::SphereTree::from_columns(&x, &y, &z, radii)
}

/// Rays in rows of any strides.
#[derive(Clone, Copy)]
struct RowsOfRays<'a> {
    origins: ArrayView2<'a, f32>,
    directions: ArrayView2<'a, f32>,
}

impl<'a> RowsOfRays<'a> {
    fn len(&self) -> usize {
        self.origins.nrows()
    }

    fn part(&self, first: usize, count: usize) -> Self {
        let part = |table: ArrayView2<'a, f32>| {
            table.split_at(Axis(0), first).1.split_at(Axis(0), count).0
        };
        Self { origins: part(self.origins), directions: part(self.directions) }
    }

    /// The rays where they lie, if their rows are contiguous.
    fn in_rows(&self) -> Option<RayRows<'a>> {
        let rows = |table: ArrayView2<'a, f32>| table.to_slice().map(|rows| rows.as_chunks().0);
        Some(RayRows { origin: rows(self.origins)?, direction: rows(self.directions)? })
    }

    /// Calls `trace` with the rays in columns: where they lie if those are contiguous, or else copied.
    fn in_columns<T>(&self, trace: impl FnOnce(&RayColumns) -> T) -> T {
        let [origin, direction] = [self.origins, self.directions].map(columns_of);
        let origin = origin.each_ref().map(|column| &**column);
        let direction = direction.each_ref().map(|column| &**column);
        trace(&RayColumns { origin, direction })
    }
}

/// The columns of a table, copied unless they are contiguous.
fn columns_of(table: ArrayView2<f32>) -> [Cow<[f32]>; 3] {
    [0, 1, 2].map(|axis| {
        let column = table.index_axis_move(Axis(1), axis);
        column.to_slice().map_or_else(|| column.to_vec().into(), Cow::Borrowed)
    })
}

/// Sets the bounds of rays from number `first` on; infinity without bounds.
fn fill_bounds(t: &mut [f64], bound: Option<ArrayView1<f64>>, first: usize) {
    match bound {
        None => t.fill(f64::INFINITY),
        Some(bound) => {
            for (t, &bound) in t.iter_mut().zip(bound.iter().skip(first)) {
                *t = bound;
            }
        }
    }
}

/// The number of rays of a task.
fn task(count: usize, threads: usize) -> usize {
    count.div_ceil(4 * threads).clamp(SMALL, ROWS_AT_ONCE)
}

/// Sets the distance of rays that hit nothing to infinity; the query leaves them their bounds.
fn forget_misses(t: &mut [f64], sphere: &[u32]) {
    for (t, &sphere) in t.iter_mut().zip(sphere) {
        if sphere == NOTHING {
            *t = f64::INFINITY;
        }
    }
}
