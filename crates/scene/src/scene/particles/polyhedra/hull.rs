//! Convex hulls of few points, by trying all planes through three of them: coordination polyhedra have a dozen corners.

use glam::DVec3;
use std::collections::BTreeSet;

/// Maximum number of points.
pub(super) const MOST: usize = 64;

/// Distance from a plane within which points are on it, relative to the size of the polyhedron: coordinates of files have few
/// digits, and faces that are flat but for these are one.
const FLAT: f64 = 4e-3;

/// The least sine of the angle between two sides of a triangle whose plane is tried.
const THIN: f64 = 1e-2;

/// A convex hull, by numbers of its points.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(in super::super) struct Hull {
    /// Triangles of its faces.
    pub triangles: Vec<[u8; 3]>,
    /// Its edges, without those between triangles of one face.
    pub edges: Vec<[u8; 2]>,
}

impl Hull {
    /// Returns the hull of at most [`MOST`] points; `None` if they are in a plane, or more.
    pub(super) fn of(points: &[DVec3]) -> Option<Self> {
        let count = points.len();
        if !(4..=MOST).contains(&count) {
            return None;
        }
        let middle = points.iter().sum::<DVec3>() / count as f64;
        let size = points.iter().map(|point| point.distance(middle)).fold(0.0, f64::max);
        let mut faces: Vec<(u64, DVec3)> = Vec::new();
        for first in 0..count {
            for second in first + 1..count {
                for third in second + 1..count {
                    let [one, other] = [second, third].map(|at| points[at] - points[first]);
                    let normal = one.cross(other);
                    if normal.length() <= THIN * one.length() * other.length() {
                        continue;
                    }
                    let normal = normal.normalize();
                    let Some((on_plane, outward)) = plane(points, points[first], normal, size)
                    else {
                        continue;
                    };
                    if on_plane.count_ones() as usize == count {
                        return None;
                    }
                    faces.push((on_plane, outward));
                }
            }
        }
        // Planes that are one but for rounding have nearly the same points: the most are those of the face.
        faces.sort_unstable_by_key(|(points, _)| (std::cmp::Reverse(points.count_ones()), *points));
        let mut distinct: Vec<(u64, DVec3)> = Vec::new();
        for (own, normal) in faces {
            if distinct.iter().all(|(other, _)| own & !other != 0) {
                distinct.push((own, normal));
            }
        }
        let mut hull = Self::default();
        let mut edges = BTreeSet::new();
        for (own, normal) in distinct {
            let corners: Vec<usize> = (0..count).filter(|at| own >> at & 1 == 1).collect();
            let ring = outline(points, &corners, normal);
            for (at, &corner) in ring.iter().enumerate() {
                let next = ring[(at + 1) % ring.len()];
                edges.insert([corner.min(next), corner.max(next)].map(|corner| corner as u8));
            }
            let fan = ring.windows(2).skip(1).map(|pair| [ring[0], pair[0], pair[1]]);
            hull.triangles.extend(fan.map(|corners| corners.map(|corner| corner as u8)));
        }
        hull.edges = edges.into_iter().collect();
        (!hull.triangles.is_empty()).then_some(hull)
    }
}

/// Returns the points on a plane, as bits, and its normal away from the others; `None` if others are on both sides.
fn plane(points: &[DVec3], at: DVec3, normal: DVec3, size: f64) -> Option<(u64, DVec3)> {
    let (mut on_plane, mut above, mut below) = (0, false, false);
    for (row, point) in points.iter().enumerate() {
        let height = (*point - at).dot(normal);
        if height.abs() <= FLAT * size {
            on_plane |= 1 << row;
        } else if height > 0.0 {
            above = true;
        } else {
            below = true;
        }
    }
    let outward = if above { -normal } else { normal };
    (!(above && below)).then_some((on_plane, outward))
}

/// Returns the corners of the outline of points in a plane, counterclockwise about its normal: the gift wrapping of Jarvis
/// (Information Processing Letters 2, 1973). Points on an edge are no corners.
fn outline(points: &[DVec3], rows: &[usize], normal: DVec3) -> Vec<usize> {
    let across = normal.any_orthonormal_vector();
    let along = |row: usize| points[row].dot(across);
    let Some(start) = rows.iter().copied().min_by(|&a, &b| along(a).total_cmp(&along(b))) else {
        return Vec::new();
    };
    let mut ring = vec![start];
    // As many steps as there are points close the ring.
    for _ in 0..rows.len() {
        let last = ring[ring.len() - 1];
        let mut next = None;
        for row in rows.iter().copied().filter(|&row| row != last) {
            let Some(best) = next else {
                next = Some(row);
                continue;
            };
            let [to_best, to_row] = [best, row].map(|row| points[row] - points[last]);
            let turn = to_best.cross(to_row).dot(normal);
            let tiny = 1e-9 * to_best.length() * to_row.length();
            let farther = to_row.length_squared() > to_best.length_squared();
            if turn < -tiny || turn <= tiny && to_best.dot(to_row) > 0.0 && farther {
                next = Some(row);
            }
        }
        match next {
            Some(row) if row != start => ring.push(row),
            _ => break,
        }
    }
    ring
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of edges and triangles, and the volume.
    fn measures(points: &[DVec3]) -> (usize, usize, f64) {
        let hull = Hull::of(points).expect("a hull");
        let middle = points.iter().sum::<DVec3>() / points.len() as f64;
        let volume = |corners: &[u8; 3]| {
            let [a, b, c] = corners.map(|corner| points[usize::from(corner)] - middle);
            // Faces are counterclockwise from outside.
            let volume = a.dot(b.cross(c)) / 6.0;
            assert!(volume > 0.0);
            volume
        };
        let volume = hull.triangles.iter().map(volume).sum();
        (hull.edges.len(), hull.triangles.len(), volume)
    }

    fn signs() -> impl Iterator<Item = DVec3> {
        let sign = |corner: usize, axis: usize| if corner >> axis & 1 == 0 { 1.0 } else { -1.0 };
        (0..8).map(move |corner| [0, 1, 2].map(|axis| sign(corner, axis)).into())
    }

    #[test]
    fn regular_polyhedra_have_their_edges_and_volumes() {
        let cube: Vec<DVec3> = signs().collect();
        let tetrahedron: Vec<DVec3> =
            cube.iter().copied().filter(|at| at.x * at.y * at.z > 0.0).collect();
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        let octahedron: Vec<DVec3> = axes.iter().flat_map(|axis| [*axis, -*axis]).collect();
        let golden = f64::midpoint(1.0, 5_f64.sqrt());
        let mut icosahedron = Vec::new();
        for (one, other) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
            icosahedron.push(DVec3::new(0.0, one, other));
            icosahedron.push(DVec3::new(one, other, 0.0));
            icosahedron.push(DVec3::new(other, 0.0, one));
        }
        let cuboctahedron: Vec<DVec3> = (0..3)
            .flat_map(|axis| signs().map(move |sign| sign * (DVec3::ONE - DVec3::AXES[axis])))
            .collect::<Vec<DVec3>>();
        let mut distinct: Vec<DVec3> = Vec::new();
        for point in cuboctahedron {
            if !distinct.contains(&point) {
                distinct.push(point);
            }
        }
        let edge = 2.0;
        let of_icosahedron = 5.0 / 12.0 * (3.0 + 5_f64.sqrt()) * edge * edge * edge;
        for (name, points, edges, triangles, volume) in [
            ("tetrahedron", tetrahedron, 6, 4, 8.0 / 3.0),
            ("octahedron", octahedron, 12, 8, 4.0 / 3.0),
            ("cube", cube, 12, 12, 8.0),
            ("icosahedron", icosahedron, 30, 20, of_icosahedron),
            ("cuboctahedron", distinct, 24, 20, 20.0 / 3.0),
        ] {
            let (own, faces, found) = measures(&points);
            assert_eq!((own, faces), (edges, triangles), "{name}");
            assert!((found / volume - 1.0).abs() < 1e-12, "{name}: {found}");
            // Turned, moved, and with coordinates of four digits.
            let turn = glam::DQuat::from_rotation_x(0.7) * glam::DQuat::from_rotation_z(1.1);
            let rounded = |at: &DVec3| ((turn * *at + DVec3::splat(7.0)) * 1e3).round() / 1e3;
            let (own, faces, _) = measures(&points.iter().map(rounded).collect::<Vec<_>>());
            assert_eq!((own, faces), (edges, triangles), "{name}");
        }
    }

    #[test]
    fn points_inside_and_on_faces_are_no_corners() {
        let mut points: Vec<DVec3> = signs().collect();
        points.extend([DVec3::ZERO, DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::splat(0.3)]);
        assert_eq!(measures(&points).0, 12);
        let hull = Hull::of(&points).expect("a hull");
        assert!(hull.triangles.iter().flatten().all(|&corner| corner < 8));
    }

    #[test]
    fn points_in_a_plane_have_no_hull() {
        let square = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(1.0, 1.0, 1e-4)];
        assert_eq!(Hull::of(&square), None);
        assert_eq!(Hull::of(&square[..3]), None);
        assert_eq!(Hull::of(&[DVec3::ZERO; 6]), None);
        let line: Vec<DVec3> = (0..5).map(|at| DVec3::X * f64::from(at)).collect();
        assert_eq!(Hull::of(&line), None);
        assert_eq!(Hull::of(&vec![DVec3::X; MOST + 1]), None);
    }
}
