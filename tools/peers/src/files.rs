//! Spheres and rays from files.

use crate::rays::Rays;
use crate::scenes::Columns;
use glam::Vec3;
use spherule_particles::{self as particles, FileError, ReadOptions, Role, read_frame};
use std::fs;
use std::path::Path;

/// Names of the columns that every ray has.
const RAY: [&str; 6] =
    ["origin x", "origin y", "origin z", "direction x", "direction y", "direction z"];

/// Bytes of a sphere in a file of raw numbers.
const RAW_ROW: usize = size_of::<[f32; 4]>();

/// Reads spheres: raw numbers of single precision from a `.raw` file, x, y, z and radius of each sphere, or any particle
/// file with radii, such as an NPY array of four columns.
///
/// # Errors
/// The file cannot be read, or holds something that is no sphere.
pub fn spheres(path: &Path) -> Result<Columns, FileError> {
    let spheres = if path.extension().is_some_and(|extension| extension == "raw") {
        raw_spheres(path)?
    } else {
        let frame = read_frame(path, &ReadOptions::default())?;
        if frame.radius.is_empty() {
            return Err(FileError::whole_file(path, "holds no radii")
                .with_help("give x, y, z and radius, such as an NPY array of shape (count, 4)"));
        }
        let column = |values: Vec<f64>| values.into_iter().map(|value| value as f32).collect();
        let [x, y, z, radius] = [frame.x, frame.y, frame.z, frame.radius].map(column);
        Columns { x, y, z, radius }
    };
    for row in 0..spheres.len() {
        let [x, y, z, radius] = spheres.row(row);
        let numbers = [("x", x), ("y", y), ("z", z), ("radius", radius)];
        if let Some((name, value)) = numbers.iter().find(|(_, value)| !value.is_finite()) {
            return Err(not_finite(path, row, name, *value));
        }
        if radius <= 0.0 {
            return Err(at(path, row, &format!("the radius is {radius}"))
                .with_help("leave out spheres whose radius is not more than 0"));
        }
    }
    Ok(spheres)
}

fn raw_spheres(path: &Path) -> Result<Columns, FileError> {
    let bytes = fs::read(path).map_err(|error| FileError::whole_file(path, error.to_string()))?;
    let (rows, rest) = bytes.as_chunks::<RAW_ROW>();
    if rows.is_empty() || !rest.is_empty() {
        let message = format!("has {} bytes, but a sphere takes {RAW_ROW}", bytes.len());
        let help = "write x, y, z and radius of each sphere in little-endian single precision";
        return Err(FileError::whole_file(path, message).with_help(help));
    }
    let mut spheres = Columns::default();
    let (numbers, _) = bytes.as_chunks::<4>();
    for row in numbers.chunks_exact(4) {
        let columns = [&mut spheres.x, &mut spheres.y, &mut spheres.z, &mut spheres.radius];
        for (column, &number) in columns.into_iter().zip(row) {
            column.push(f32::from_le_bytes(number));
        }
    }
    Ok(spheres)
}

/// Reads rays from an array of six to eight columns: origin x, y, z, direction x, y, z; a seventh is `t_max`; if there are
/// eight, the seventh is `t_min`, which is 0, and the eighth `t_max`. Numbers of double precision are rounded.
///
/// # Errors
/// The file cannot be read, or holds something that is no ray.
pub fn rays(path: &Path) -> Result<Rays, FileError> {
    let numbered = |column: usize| (column + 1).to_string();
    let roles = [Role::X, Role::Y, Role::Z].into_iter().enumerate();
    let columns = particles::Columns {
        roles: roles.map(|(column, role)| (role, numbered(column))).collect(),
        kept: (3..6).map(numbered).collect(),
        wanted: (6..9).map(numbered).collect(),
        rest: None,
    };
    let frame = read_frame(path, &ReadOptions { columns, ..ReadOptions::default() })?;
    let mut columns = vec![&frame.x, &frame.y, &frame.z];
    columns.extend(frame.numbers.iter().map(|column| &column.values));
    if !(6..=8).contains(&columns.len()) {
        let message = format!("has {} columns or more, which no ray has", columns.len());
        return Err(FileError::whole_file(path, message).with_help(
            "give origin x, y, z and direction x, y, z; after these t_max, or t_min and t_max",
        ));
    }
    let mut rays = Rays::default();
    for row in 0..frame.len() {
        let mut ray = [0.0; 8];
        for (number, column) in ray.iter_mut().zip(&columns) {
            *number = column[row] as f32;
        }
        let [x, y, z, dx, dy, dz, first, second] = ray;
        if let Some(i) = ray[..6].iter().position(|number| !number.is_finite()) {
            return Err(not_finite(path, row, RAY[i], ray[i]));
        }
        if [dx, dy, dz] == [0.0; 3] {
            return Err(at(path, row, "the direction is zero").with_help("leave out such rays"));
        }
        let (t_min, t_max) = match columns.len() {
            6 => (0.0, f32::INFINITY),
            7 => (0.0, first),
            _ => (first, second),
        };
        if t_min != 0.0 {
            return Err(at(path, row, &format!("t_min is {t_min}"))
                .with_help("move the origin to t_min: both systems search from 0"));
        }
        if t_max.is_nan() || t_max <= 0.0 {
            return Err(at(path, row, &format!("t_max is {t_max}"))
                .with_help("give a distance, or inf for none"));
        }
        rays.push_bounded(Vec3::new(x, y, z), Vec3::new(dx, dy, dz), t_max);
    }
    Ok(rays)
}

fn not_finite(path: &Path, row: usize, name: &str, value: f32) -> FileError {
    at(path, row, &format!("{name} is {value} in single precision"))
        .with_help("leave out the row, or scale all numbers")
}

/// An error in a row; the first is 0, as in NumPy.
fn at(path: &Path, row: usize, message: &str) -> FileError {
    FileError::whole_file(path, format!("in row {row}, {message}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;

    /// A file that is removed at the end.
    struct Scratch(PathBuf);

    impl Scratch {
        fn new(name: &str, bytes: &[u8]) -> Self {
            let name = format!("spherule-peers-{}-{name}", std::process::id());
            let path = std::env::temp_dir().join(name);
            fs::write(&path, bytes).unwrap();
            Self(path)
        }

        /// An NPY array of rows.
        fn npy<const N: usize, T: Copy>(
            name: &str,
            kind: &str,
            bytes: impl Fn(T) -> Vec<u8>,
            rows: &[[T; N]],
        ) -> Self {
            let shape = format!("({}, {N})", rows.len());
            let header =
                format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': {shape}, }}\n");
            let mut file = b"\x93NUMPY\x01\x00".to_vec();
            file.extend((header.len() as u16).to_le_bytes());
            file.extend(header.bytes());
            file.extend(rows.as_flattened().iter().flat_map(|&number| bytes(number)));
            Self::new(name, &file)
        }
    }

    impl Drop for Scratch {
        fn drop(&mut self) {
            // Nothing depends on it.
            let _ = fs::remove_file(&self.0);
        }
    }

    fn single(x: f32) -> Vec<u8> {
        x.to_le_bytes().to_vec()
    }

    fn double(x: f64) -> Vec<u8> {
        x.to_le_bytes().to_vec()
    }

    const SPHERES: [[f32; 4]; 5] = [
        [0.1, 2.0, -3.0, 0.5],
        [4.0, 5.0, 6.0, 1e-3],
        [7.0, 8.0, 9.0, 2.0],
        [1.0, 0.0, 0.0, 0.25],
        [0.0, 1.0, 0.0, 0.125],
    ];

    #[test]
    fn spheres_of_arrays_and_raw_numbers_are_those_that_were_written() {
        let raw: Vec<u8> = SPHERES.as_flattened().iter().flat_map(|&x| single(x)).collect();
        let files = [
            Scratch::npy("spheres.npy", "<f4", single, &SPHERES),
            Scratch::npy("wide.npy", "<f8", double, &SPHERES.map(|row| row.map(f64::from))),
            Scratch::new("spheres.raw", &raw),
        ];
        for file in &files {
            let read = spheres(&file.0).unwrap();
            assert_eq!(read.len(), SPHERES.len());
            assert!((0..SPHERES.len()).all(|row| read.row(row) == SPHERES[row]));
        }
    }

    #[test]
    fn rays_have_bounds_if_their_file_has() {
        let plain = [[1.0, 2.0, 3.0, 0.0, 0.5, -1.0], [4.0, 5.0, 6.0, 1.0, 0.1, 0.0]];
        let bounds = [f64::INFINITY, 2.5];
        let seven = [0, 1].map(|i| {
            let [a, b, c, d, e, f] = plain[i];
            [a, b, c, d, e, f, bounds[i]]
        });
        let eight = seven.map(|[a, b, c, d, e, f, t]| [a, b, c, d, e, f, 0.0, t]);
        let files = [
            (Scratch::npy("rays6.npy", "<f8", double, &plain), [f32::INFINITY; 2]),
            (Scratch::npy("rays7.npy", "<f8", double, &seven), bounds.map(|t| t as f32)),
            (Scratch::npy("rays8.npy", "<f8", double, &eight), bounds.map(|t| t as f32)),
            (
                Scratch::npy("single.npy", "<f4", single, &eight.map(|row| row.map(|x| x as f32))),
                bounds.map(|t| t as f32),
            ),
        ];
        for (file, bounds) in &files {
            let read = rays(&file.0).unwrap();
            assert_eq!(read.len(), 2);
            for i in 0..2 {
                let (origin, direction) = read.row(i);
                let numbers: Vec<f32> = plain[i].iter().map(|&x| x as f32).collect();
                assert_eq!(origin.to_array(), numbers[..3]);
                assert_eq!(direction.to_array(), numbers[3..]);
                assert_eq!(read.bound(i), bounds[i]);
            }
        }
    }

    #[test]
    fn errors_name_the_file_the_row_and_the_mend() {
        let mut bad = SPHERES;
        bad[2][3] = -1.0;
        let negative = Scratch::npy("negative.npy", "<f4", single, &bad);
        bad[2][3] = f32::NAN;
        let unknown = Scratch::npy("nan.npy", "<f4", single, &bad);
        let cut = Scratch::new("cut.raw", &[0; 18]);
        let flat = Scratch::npy("flat.npy", "<f4", single, &SPHERES.map(|[x, y, z, _]| [x, y, z]));
        for (file, says) in [
            (&negative, ["in row 2, the radius is -1", "leave out"]),
            (&unknown, ["in row 2, radius is NaN", "leave out"]),
            (&cut, ["has 18 bytes", "single precision"]),
            (&flat, ["no radii", "(count, 4)"]),
        ] {
            check(&file.0, &spheres(&file.0).unwrap_err(), says);
        }
        let ray = [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0];
        let with = |changes: &[(usize, f32)]| {
            let mut row = ray;
            for &(i, value) in changes {
                row[i] = value;
            }
            [ray, row]
        };
        for (name, rows, says) in [
            ("zero.npy", with(&[(3, 0.0)]), ["in row 1, the direction is zero", "leave out"]),
            ("late.npy", with(&[(6, 0.5)]), ["in row 1, t_min is 0.5", "move the origin"]),
            ("never.npy", with(&[(7, f32::NAN)]), ["in row 1, t_max is NaN", "inf"]),
            ("far.npy", with(&[(1, f32::INFINITY)]), ["in row 1, origin y is inf", "scale"]),
        ] {
            let file = Scratch::npy(name, "<f4", single, &rows);
            check(&file.0, &rays(&file.0).unwrap_err(), says);
        }
        let few = Scratch::npy("few.npy", "<f4", single, &SPHERES);
        let few = rays(&few.0).unwrap_err().to_string();
        assert!(few.contains("few.npy") && few.contains('5'), "{few}");
        let many = Scratch::npy("many.npy", "<f4", single, &[[1.0; 9]]);
        check(&many.0, &rays(&many.0).unwrap_err(), ["9 columns", "t_max"]);
    }

    #[track_caller]
    fn check(path: &Path, error: &FileError, says: [&str; 2]) {
        let text = error.to_string();
        assert!(text.starts_with(&path.display().to_string()), "{text}");
        assert!(says.iter().all(|part| text.contains(part)) && text.contains("help"), "{text}");
    }
}
