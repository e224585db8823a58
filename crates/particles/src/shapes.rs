//! Shapes of particles: ellipsoids and their orientations, from columns of files.

use crate::{Columns, Format, ParticleFrame, Radii, ReadOptions, Role, Shapes, memory};
use glam::{DQuat, DVec3};

/// Names of columns of semi-axes.
pub(crate) const SEMI_AXES: [&str; 3] = ["semi_axes_x", "semi_axes_y", "semi_axes_z"];

/// Names of columns of semi-axes or diameters, and the factor that makes them semi-axes.
const AXES: [([&str; 3], f64); 6] = [
    // LAMMPS writes diameters. Its computes may have any names; these are usual.
    (["shapex", "shapey", "shapez"], 0.5),
    (["c_shape[1]", "c_shape[2]", "c_shape[3]"], 0.5),
    (["c_diameter[1]", "c_diameter[2]", "c_diameter[3]"], 0.5),
    // OVITO, in extended XYZ and in text files.
    (["aspherical_shape_x", "aspherical_shape_y", "aspherical_shape_z"], 1.0),
    (["aspherical shape.x", "aspherical shape.y", "aspherical shape.z"], 1.0),
    (SEMI_AXES, 1.0),
];

/// Names of columns of quaternions: of the real part, and of the parts along x, y and z.
const QUATERNIONS: [[&str; 4]; 5] = [
    ["quatw", "quati", "quatj", "quatk"],
    ["quat_w", "quat_x", "quat_y", "quat_z"],
    ["qw", "qx", "qy", "qz"],
    ["orientation_w", "orientation_x", "orientation_y", "orientation_z"],
    ["orientation.w", "orientation.x", "orientation.y", "orientation.z"],
];

/// Names of columns of quaternions whose parts are numbered, and whether the real part is the last one.
const NUMBERED: [([&str; 4], Last); 5] = [
    (["c_q[1]", "c_q[2]", "c_q[3]", "c_q[4]"], Last::Never),
    (["c_quat[1]", "c_quat[2]", "c_quat[3]", "c_quat[4]"], Last::Never),
    (["c_orient[1]", "c_orient[2]", "c_orient[3]", "c_orient[4]"], Last::Always),
    (["orientation_1", "orientation_2", "orientation_3", "orientation_4"], Last::InText),
    (["quaternion_1", "quaternion_2", "quaternion_3", "quaternion_4"], Last::InText),
];

/// The place of the real part of a numbered quaternion: first, or last.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Last {
    Never,
    Always,
    /// As OVITO writes text files, unlike HOOMD-blue and its tools, which write binary ones.
    InText,
}

/// The columns of shapes that are read in addition to those that were asked for.
pub(crate) struct ShapeColumns {
    /// Columns that were asked for, and stay.
    asked: Vec<String>,
    /// Values of all other columns that are kept ([`Columns::rest`]).
    rest: usize,
    /// True if radii are chosen, and not those of the shapes.
    keeps_radii: bool,
}

/// Returns the names of all columns of shapes.
fn names() -> impl Iterator<Item = &'static str> {
    let axes = AXES.iter().flat_map(|(names, _)| names);
    let numbered = NUMBERED.iter().flat_map(|(names, _)| names);
    axes.chain(QUATERNIONS.iter().flatten()).chain(numbered).copied()
}

impl ShapeColumns {
    /// Asks for all columns of shapes.
    pub(crate) fn ask(options: &mut ReadOptions) -> Self {
        let of_size = |(role, _): &(Role, String)| matches!(role, Role::Radius | Role::Diameter);
        let keeps_radii =
            matches!(options.radii, Radii::Column(_)) || options.columns.roles.iter().any(of_size);
        let Columns { kept, wanted, rest, .. } = &mut options.columns;
        let asked = [&kept[..], wanted].concat();
        wanted.extend(names().map(str::to_owned));
        Self { asked, rest: rest.unwrap_or(0), keeps_radii }
    }

    /// Makes shapes of the columns of a frame, and removes those columns that were not asked for. Warns of columns of shapes or
    /// orientations that it does not know.
    ///
    /// # Errors
    ///
    /// A message, if there is too little memory.
    pub(crate) fn apply(&self, frame: &mut ParticleFrame) -> Result<(), String> {
        let axes = AXES.iter().find_map(|(names, factor)| Some((find(frame, *names)?, *factor)));
        if let Some((at, factor)) = axes.filter(|_| !frame.is_empty()) {
            let bytes = frame.len() * (size_of::<DVec3>() + size_of::<DQuat>() + size_of::<f64>());
            memory::check(bytes as u64)
                .map_err(|shortage| format!("its shapes need {shortage}"))?;
            let first = frame.numbers[at[0]].name.as_str();
            if first.starts_with("c_") {
                let warning = format!("shapes from `{first}` on are taken as diameters");
                frame.warnings.push(warning);
            }
            let orientation = orientation(frame);
            if orientation.is_empty() && frame.format != Format::Gsd {
                frame.warnings.push("shapes without orientations are not turned".to_owned());
            }
            let axes =
                |row| DVec3::from(at.map(|column| frame.numbers[column].values[row])) * factor;
            let axes = (0..frame.len()).map(axes).collect();
            frame.set_shapes(axes, orientation, self.keeps_radii);
        } else {
            frame.add_undrawn_columns();
        }
        let columns = frame.numbers.len() + frame.texts.len();
        let fits = columns * frame.len() <= self.rest;
        let is =
            |list: &[String], name: &str| list.iter().any(|own| own.eq_ignore_ascii_case(name));
        let lent = |name: &str| {
            !fits && !is(&self.asked, name) && names().any(|own| own.eq_ignore_ascii_case(name))
        };
        frame.numbers.retain(|column| !lent(&column.name));
        frame.texts.retain(|column| !lent(&column.name));
        Ok(())
    }
}

/// Returns the places of columns of numbers, if all are there.
fn find<const N: usize>(frame: &ParticleFrame, names: [&str; N]) -> Option<[usize; N]> {
    let mut at = [0; N];
    for (at, name) in at.iter_mut().zip(names) {
        let is = |own: &str| own.eq_ignore_ascii_case(name);
        *at = frame.numbers.iter().position(|column| is(&column.name))?;
    }
    Some(at)
}

/// Returns the quaternions of a frame's columns, not normalized; none if there are no such columns.
fn orientation(frame: &mut ParticleFrame) -> Vec<DQuat> {
    let named = QUATERNIONS.iter().find_map(|names| find(frame, *names));
    let numbered = || {
        let at = |names: &[&str; 4]| find(frame, *names);
        NUMBERED.iter().find_map(|(names, last)| Some((at(names)?, names[0], *last)))
    };
    let [w, x, y, z] = match (named, numbered()) {
        (Some(at), _) => at,
        (None, Some((at, first, last))) => {
            let binary =
                matches!(frame.format, Format::Gsd | Format::Npy | Format::Npz | Format::Hdf5);
            let is_last = last == Last::Always || last == Last::InText && !binary;
            // HOOMD-blue defines the order.
            if frame.format != Format::Gsd {
                let order = if is_last { "x, y, z and w" } else { "w, x, y and z" };
                let warning = format!("orientations from `{first}` on are taken as {order}");
                frame.warnings.push(warning);
            }
            let [a, b, c, d] = at;
            if is_last { [d, a, b, c] } else { at }
        }
        (None, None) => return Vec::new(),
    };
    let part = |column: usize, row: usize| frame.numbers[column].values[row];
    let quaternion = |row| DQuat::from_xyzw(part(x, row), part(y, row), part(z, row), part(w, row));
    (0..frame.len()).map(quaternion).collect()
}

impl ParticleFrame {
    /// Makes ellipsoids of particles with these semi-axes, in the file's unit; three zeros or numbers that are missing make a sphere.
    /// There is a row for each particle, and one in `orientation` too, unless that is empty.
    /// The radius becomes the longest semi-axis unless `keeps_radii`. Quaternions need not be normalized; none at all turn nothing.
    pub fn set_shapes(
        &mut self,
        mut semi_axes: Vec<DVec3>,
        mut orientation: Vec<DQuat>,
        keeps_radii: bool,
    ) {
        let (mut spheres, mut bad) = (0_u64, 0_u64);
        let mut longest = vec![f64::NAN; semi_axes.len()];
        for (axes, longest) in semi_axes.iter_mut().zip(&mut longest) {
            if axes.is_finite() && axes.min_element() > 0.0 {
                *longest = axes.max_element();
                *axes /= *longest;
                continue;
            }
            let none = *axes == DVec3::ZERO || axes.is_nan_mask().all();
            *(if none { &mut spheres } else { &mut bad }) += 1;
            *axes = DVec3::ONE;
        }
        if spheres + bad == semi_axes.len() as u64 {
            if bad > 0 {
                let are = if bad == 1 { "shape is" } else { "shapes are" };
                self.warnings.push(format!("{bad} {are} not three lengths above 0, and not used"));
            }
            return;
        }
        self.set_radii(&longest, keeps_radii, spheres + bad);
        if bad > 0 {
            let (are, particles) = if bad == 1 {
                ("shape is", "this particle is a sphere")
            } else {
                ("shapes are", "these particles are spheres")
            };
            self.warnings.push(format!("{bad} {are} not three lengths above 0: {particles}"));
        }
        let is_sphere = |axes: &DVec3| *axes == DVec3::ONE;
        let mut unknown = 0_u64;
        for (quaternion, axes) in orientation.iter_mut().zip(&semi_axes) {
            let length = quaternion.length();
            if length.is_finite() && length > 0.0 {
                *quaternion /= length;
            } else {
                unknown += u64::from(!is_sphere(axes));
                *quaternion = DQuat::IDENTITY;
            }
        }
        if unknown > 0 {
            let (are, turn) = if unknown == 1 {
                ("orientation is no quaternion", "turns")
            } else {
                ("orientations are no quaternions", "turn")
            };
            self.warnings.push(format!("{unknown} {are}, and {turn} nothing"));
        }
        let turned = |quaternion: &DQuat| *quaternion != DQuat::IDENTITY;
        if !semi_axes.iter().all(is_sphere) {
            let orientation = if orientation.iter().any(turned) { orientation } else { Vec::new() };
            self.shapes = Shapes { semi_axes, orientation };
        }
    }

    /// Sets radii to the longest semi-axes, NaN for spheres, which keep theirs. If there are no radii, spheres get the median of the
    /// others.
    fn set_radii(&mut self, longest: &[f64], keeps_radii: bool, spheres: u64) {
        if keeps_radii && !self.radius.is_empty() {
            return;
        }
        if self.radius.is_empty() {
            let mut known: Vec<f64> =
                longest.iter().copied().filter(|own| own.is_finite()).collect();
            let half = known.len() / 2;
            let median = *known.select_nth_unstable_by(half, f64::total_cmp).1;
            self.radius = vec![median; longest.len()];
            if spheres > 0 {
                let are = if spheres == 1 {
                    "particle has no shape and no radius: it is a sphere"
                } else {
                    "particles have no shape and no radius: they are spheres"
                };
                self.warnings.push(format!(
                    "{spheres} {are} with a radius of {median}, the median of the longest semi-axes"
                ));
            }
        }
        for (radius, longest) in self.radius.iter_mut().zip(longest) {
            if longest.is_finite() {
                *radius = *longest;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NumberColumn;

    fn frame(format: Format, columns: &[(&str, &[f64])]) -> ParticleFrame {
        let count = columns[0].1.len();
        let numbers = columns.iter().map(|(name, values)| NumberColumn {
            name: (*name).to_owned(),
            values: values.to_vec(),
        });
        ParticleFrame {
            format,
            x: vec![0.0; count],
            y: vec![0.0; count],
            z: vec![0.0; count],
            numbers: numbers.collect(),
            ..ParticleFrame::default()
        }
    }

    fn apply(frame: &mut ParticleFrame, columns: &str) {
        let columns = columns.parse().expect("columns");
        let mut options = ReadOptions { columns, ..ReadOptions::default() };
        ShapeColumns::ask(&mut options).apply(frame).expect("memory");
    }

    #[test]
    fn diameters_of_lammps_become_semi_axes_relative_to_the_radius() {
        let columns: [(&str, &[f64]); 4] = [
            ("shapex", &[2.0, 0.0, 1.0, 4.0]),
            ("ShapeY", &[4.0, 0.0, 1.0, 0.0]),
            ("shapez", &[8.0, 0.0, 1.0, 4.0]),
            ("mass", &[1.0; 4]),
        ];
        let mut own = frame(Format::LammpsDump, &columns);
        apply(&mut own, "shapez");
        let ones = DVec3::ONE;
        assert_eq!(own.shapes.semi_axes, [DVec3::new(0.25, 0.5, 1.0), ones, ones, ones]);
        assert!(own.shapes.orientation.is_empty());
        // The second has no shape, and the fourth none that is possible.
        assert_eq!(own.radius, [4.0, 4.0, 0.5, 4.0]);
        let names: Vec<&str> = own.numbers.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["shapez", "mass"]);
        assert_eq!(own.warnings.len(), 3, "{:?}", own.warnings);

        let mut own = frame(Format::LammpsDump, &columns);
        own.radius = vec![9.0; 4];
        apply(&mut own, "radius=r");
        assert_eq!(own.radius, [9.0; 4]);
        assert_eq!(own.shapes.semi_axes[0], DVec3::new(0.25, 0.5, 1.0));
    }

    #[test]
    fn parts_of_quaternions_have_the_order_of_their_program() {
        let axes =
            [("aspherical_shape_x", 1.0), ("aspherical_shape_y", 2.0), ("aspherical_shape_z", 3.0)];
        let turned = |format, names: [&str; 4]| {
            let parts = [3.0, 0.0, 4.0, 0.0];
            let columns = axes.into_iter().chain(names.into_iter().zip(parts));
            let columns: Vec<_> = columns.map(|(name, value)| (name, vec![value])).collect();
            let columns: Vec<_> =
                columns.iter().map(|(name, values)| (*name, values.as_slice())).collect();
            let mut own = frame(format, &columns);
            apply(&mut own, "");
            assert_eq!(own.shapes.semi_axes, [DVec3::new(1.0 / 3.0, 2.0 / 3.0, 1.0)]);
            let [quaternion] = own.shapes.orientation[..] else { panic!("{names:?}") };
            (quaternion.to_array(), own.warnings.len())
        };
        let first = [0.0, 0.8, 0.0, 0.6];
        let last = [0.6, 0.0, 0.8, 0.0];
        let numbered = |name: &str| [1, 2, 3, 4].map(|part| format!("{name}_{part}"));
        let names = numbered("orientation");
        let names = [0, 1, 2, 3].map(|part| names[part].as_str());
        assert_eq!(turned(Format::Xyz, names), (last, 1));
        assert_eq!(turned(Format::Npz, names), (first, 1));
        let lammps = Format::LammpsDump;
        assert_eq!(turned(lammps, ["quatw", "quati", "quatj", "quatk"]), (first, 0));
        let computed = |name: &str| [1, 2, 3, 4].map(|part| format!("{name}[{part}]"));
        for (name, expected) in [("c_q", first), ("c_orient", last)] {
            let names = computed(name);
            let names = [0, 1, 2, 3].map(|part| names[part].as_str());
            assert_eq!(turned(lammps, names), (expected, 1), "{name}");
        }
    }

    #[test]
    fn quaternions_that_are_none_turn_nothing() {
        let mut own = frame(Format::Xyz, &[("x", &[0.0, 0.0])]);
        let axes = vec![DVec3::new(1.0, 2.0, 2.0); 2];
        let quaternions =
            vec![DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), DQuat::from_xyzw(2.0, 0.0, 0.0, 0.0)];
        own.set_shapes(axes, quaternions, false);
        assert_eq!(own.shapes.orientation, [DQuat::IDENTITY, DQuat::from_xyzw(1.0, 0.0, 0.0, 0.0)]);
        assert!(own.warnings[0].starts_with("1 orientation is"), "{:?}", own.warnings);
        own.retain(&[false, true]);
        own.repeat(2);
        assert_eq!(own.shapes.semi_axes, [DVec3::new(0.5, 1.0, 1.0); 2]);
        assert!(!own.shapes.is_sphere(1));
    }
}
