//! Camera framing: along the scene's principal axes, around the scene in a turn, and with additional
//! points in the picture.

mod sequence;
pub mod view;

pub use sequence::SequenceBounds;

use super::{WorldError, fit};
use crate::elementary::{atan, hypot, rotation, sin, tan};
use crate::scene::{Camera, FramedSphere, Insets, Pose, Projection, Rgb, Scene, Spheres};
use glam::{DMat3, DVec3};

/// Number of sweeps after which Jacobi's method has converged for any 3 x 3 matrix.
const SWEEPS: usize = 20;

/// Minimum cosine of the angle between view and normal of a face that counts as visible.
const MIN_COSINE: f64 = 0.25;

/// Sideways tilt of a view of several faces, which shows depth.
const TILT: f64 = 0.5;

/// Fixes a fitted camera of the scene so that it frames these points too. A camera with an `eye` of its
/// own stays there; in parallel projection it gets the height that shows them, if it has none.
///
/// # Errors
/// [`WorldError::NothingToFit`] without spheres, and [`WorldError::Camera`] for a camera that
/// sees nothing.
pub fn include_points(scene: &mut Scene, points: &[DVec3]) -> Result<(), WorldError> {
    let open = matches!(scene.camera.projection, Projection::Orthographic { height: None });
    let placed = matches!(scene.camera.pose, Pose::LookAt { .. }) && !open;
    if placed || scene.is_empty() {
        scene.camera.fold_zoom();
        return Ok(());
    }
    let count = scene.spheres.len();
    for &point in points {
        scene.spheres.push(point, 0.0, 0, Rgb::ONE);
    }
    let placed = fit::pose(scene);
    truncate(&mut scene.spheres, count);
    let placed = placed?;
    let distance = if placed.distance > 0.0 { placed.distance } else { placed.half_height };
    let camera = &mut scene.camera;
    camera.pose =
        Pose::LookAt { eye: placed.eye, target: placed.eye + placed.axes.forward * distance };
    (camera.insets, camera.framed) = (Insets::default(), None);
    if let Projection::Orthographic { height } = &mut camera.projection {
        *height = Some(2.0 * placed.half_height);
        camera.zoom = 1.0;
    }
    camera.fold_zoom();
    Ok(())
}

fn truncate(spheres: &mut Spheres, count: usize) {
    for column in [&mut spheres.x, &mut spheres.y, &mut spheres.z, &mut spheres.radius] {
        column.truncate(count);
    }
    spheres.material.truncate(count);
    spheres.color.truncate(count);
}

/// Turns the scene's camera by `angle`, in radians and to the right, about the vertical axis (the
/// camera's `up`) through its target.
///
/// A fitted camera frames the sphere around all spheres and `points` instead, from the same distance at
/// every angle.
pub fn orbit(scene: &mut Scene, points: &[DVec3], angle: f64) {
    let up = scene.camera.up.normalize_or(DVec3::Y);
    let rotation = rotation(up, angle);
    let (eye, target) = match scene.camera.pose {
        Pose::LookAt { eye, target } => (eye, target),
        Pose::Fit { .. } if scene.is_empty() => return,
        Pose::Fit { direction, margin } if scene.camera.insets != Insets::default() => {
            let (center, radius) = bounding_sphere(scene, points);
            scene.camera.pose = Pose::Fit { direction: rotation * direction, margin };
            fit_sphere(scene, center, radius);
            return;
        }
        Pose::Fit { direction, margin } => {
            let (center, radius) = bounding_sphere(scene, points);
            let used = 1.0 - margin;
            let distance = fit_distance(scene, radius / used);
            let direction = direction.normalize_or(DVec3::NEG_Z);
            (center - direction * distance, center)
        }
    };
    scene.camera.pose = Pose::LookAt { eye: target + rotation * (eye - target), target };
    scene.camera.framed = None;
}

/// Fixes a fitted camera so that it frames a sphere; it stays as it is if it sees nothing.
fn fit_sphere(scene: &mut Scene, center: DVec3, radius: f64) {
    let Scene { camera, settings, .. } = &*scene;
    let mut view = Scene { camera: camera.clone(), settings: settings.clone(), ..Scene::default() };
    view.spheres.push(center, radius, 0, Rgb::ONE);
    if include_points(&mut view, &[]).is_ok() {
        // The vertical axis stays, for a turn about it.
        view.camera.up = scene.camera.up;
        scene.camera = view.camera;
    }
}

/// Returns the axes of the picture of a camera: unit vectors to the right, upward, and into the scene;
/// `None` if it has no direction.
pub fn picture_axes(camera: &Camera) -> Option<[DVec3; 3]> {
    let forward = match camera.pose {
        Pose::LookAt { eye, target } => target - eye,
        Pose::Fit { direction, .. } => direction,
    };
    let axes = fit::Axes::new(forward, camera.up)?;
    Some([axes.right, axes.up, axes.forward])
}

/// Returns the distance along the view axis of a point from a camera that stands at a point; negative
/// behind it, and `None` for a camera that is fitted or has no direction.
pub fn depth(camera: &Camera, point: DVec3) -> Option<f64> {
    let Pose::LookAt { eye, .. } = camera.pose else { return None };
    let [_, _, forward] = picture_axes(camera)?;
    Some((point - eye).dot(forward))
}

/// Returns the distance from its center at which a camera sees all of a sphere; sets the height of a
/// parallel projection.
fn fit_distance(scene: &mut Scene, radius: f64) -> f64 {
    let aspect = f64::from(scene.settings.width) / f64::from(scene.settings.height);
    match &mut scene.camera.projection {
        Projection::Perspective { fov } => {
            let half = tan(fov.to_radians() / 2.0);
            radius / sin(atan(half.min(half * aspect)))
        }
        Projection::Orthographic { height } => {
            height.get_or_insert(2.0 * radius / aspect.min(1.0));
            2.0 * radius
        }
    }
}

/// Rolls a camera clockwise about its view axis by an angle in degrees, so that the picture turns counterclockwise.
pub fn roll(camera: &mut Camera, degrees: f64) {
    let Some([_, up, forward]) = picture_axes(camera) else { return };
    // A direction along the view is replaced, and could not be turned.
    let slanted = forward.cross(camera.up.normalize_or_zero()).length() > 1e-6;
    let own = if slanted { camera.up } else { up };
    camera.up = rotation(forward, degrees.to_radians()) * own;
}

/// Returns a sphere about the middle of the bounds that contains all spheres and points, or the sphere that the camera
/// frames.
pub fn bounding_sphere(scene: &Scene, points: &[DVec3]) -> (DVec3, f64) {
    if let Some(FramedSphere { center, radius }) = scene.camera.framed {
        return (center, radius);
    }
    let spheres = &scene.spheres;
    let rows = || (0..spheres.len()).map(|row| (spheres.center(row), spheres.radius[row]));
    let points = || points.iter().map(|&point| (point, 0.0));
    let all = || rows().chain(scene.other_hulls()).chain(points());
    let found = FramedSphere::around(all);
    found.map_or((DVec3::ZERO, 0.0), |sphere| (sphere.center, sphere.radius))
}

/// Returns the camera with the broadest view of the spheres: along the axis of least variance of the
/// centers, with the axis of greatest variance to the right. If `up` is given, a unit vector, it is up,
/// and only horizontal axes count.
pub fn broadside(spheres: &Spheres, camera: &Camera, up: Option<DVec3>) -> Camera {
    // Of the two directions along an axis, the one nearer to the default camera's.
    let toward = |axis: DVec3, like: DVec3| if axis.dot(like) < 0.0 { -axis } else { axis };
    let (right, up) = if let Some(up) = up {
        let [across, ..] = eigenvectors(flattened(covariance(spheres), up));
        (across.reject_from_normalized(up).normalize(), up)
    } else {
        let [right, up, _] = principal_axes(spheres);
        (right, toward(up, DVec3::new(0.01, 1.0, 0.1)))
    };
    let right = toward(right, DVec3::new(1.0, 0.1, 0.01));
    let margin = match camera.pose {
        Pose::Fit { margin, .. } => margin,
        Pose::LookAt { .. } => Camera::FIT_MARGIN,
    };
    let pose = Pose::Fit { direction: up.cross(right), margin };
    Camera { pose, up, ..camera.clone() }
}

/// Returns the direction from which the faces of cuts are visible: `direction` if it shows all of them,
/// or else its mirror image, or a direction toward the faces, that shows most.
///
/// `normals` are those of the planes, toward the part that is cut away. All directions are from the
/// camera into the scene.
pub fn facing(direction: DVec3, normals: &[DVec3]) -> DVec3 {
    let Some(usual) = direction.try_normalize() else { return direction };
    let signs = || (0..8).map(|bits: u32| DVec3::from([0, 1, 2].map(|axis| sign(bits, axis))));
    let toward = -normals.iter().sum::<DVec3>().normalize_or_zero();
    let mirrored = signs().map(|signs| usual * signs);
    let tilted = signs().filter_map(|signs| (toward + usual * signs * TILT).try_normalize());
    let shown = |candidate: DVec3| {
        let cosines = normals.iter().map(|normal| -candidate.dot(*normal));
        let seen = cosines.clone().filter(|cosine| *cosine >= MIN_COSINE).count();
        (seen, cosines.fold(f64::INFINITY, f64::min))
    };
    let best = mirrored.chain(tilted).fold(usual, |best, candidate| {
        let (old, new) = (shown(best), shown(candidate));
        let better = new.0 > old.0 || new.0 == old.0 && old.0 < normals.len() && new.1 > old.1;
        if better { candidate } else { best }
    });
    if best == usual { direction } else { best }
}

/// Returns -1 if a bit is set, and 1 otherwise.
fn sign(bits: u32, axis: u32) -> f64 {
    if bits >> axis & 1 == 1 { -1.0 } else { 1.0 }
}

/// Returns the principal axes: orthonormal vectors of greatest, middle and least variance of the
/// centers, the eigenvectors of their covariance. If variances are equal, the axes are arbitrary among
/// the valid ones.
pub fn principal_axes(spheres: &Spheres) -> [DVec3; 3] {
    eigenvectors(covariance(spheres))
}

/// Returns the covariance of the centers, in units of the square of their largest deviation.
fn covariance(spheres: &Spheres) -> DMat3 {
    let count = spheres.len().max(1) as f64;
    let centers = || (0..spheres.len()).map(|row| spheres.center(row));
    let mean = centers().sum::<DVec3>() / count;
    let largest = centers().map(|center| (center - mean).abs().max_element()).fold(0.0, f64::max);
    let scale = if largest > 0.0 { largest.recip() } else { 1.0 };
    let mut covariance = DMat3::ZERO;
    for center in centers() {
        let offset = (center - mean) * scale;
        covariance += DMat3::from_cols(offset * offset.x, offset * offset.y, offset * offset.z);
    }
    covariance * count.recip()
}

/// Returns the covariance without variance along `up`, a unit vector. Across it, 1 is added, so that the
/// eigenvectors of the two greatest eigenvalues are across it.
fn flattened(covariance: DMat3, up: DVec3) -> DMat3 {
    let across = DMat3::IDENTITY - DMat3::from_cols(up * up.x, up * up.y, up * up.z);
    across * covariance * across + across
}

/// Returns the eigenvectors of a symmetric matrix, greatest eigenvalue first, by Jacobi's rotations.
fn eigenvectors(mut matrix: DMat3) -> [DVec3; 3] {
    let mut vectors = DMat3::IDENTITY;
    for (row, column) in [(0, 1), (0, 2), (1, 2)].repeat(SWEEPS) {
        let off = matrix.col(column)[row];
        if off == 0.0 {
            continue;
        }
        // Golub and Van Loan, "Matrix Computations", 4th edition 2013, section 8.5.2.
        let tau = (matrix.col(column)[column] - matrix.col(row)[row]) / (2.0 * off);
        let tangent = tau.signum() / (tau.abs() + hypot(tau, 1.0));
        let cosine = hypot(tangent, 1.0).recip();
        let sine = tangent * cosine;
        let mut rotation = DMat3::IDENTITY;
        rotation.col_mut(row)[row] = cosine;
        rotation.col_mut(column)[column] = cosine;
        rotation.col_mut(column)[row] = sine;
        rotation.col_mut(row)[column] = -sine;
        matrix = rotation.transpose() * matrix * rotation;
        vectors *= rotation;
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| matrix.col(j)[j].total_cmp(&matrix.col(i)[i]));
    order.map(|i| vectors.col(i).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::particles::Particles;

    /// Spheres in a slab that is long along the first axis and thin along the third.
    fn slab(axes: [DVec3; 3]) -> Spheres {
        let mut spheres = Spheres::default();
        for i in 0..200 {
            let i = f64::from(i);
            let offsets = [(i * 12.9).sin() * 9.0, (i * 78.2).sin() * 4.0, (i * 37.7).sin()];
            let center = (0..3).map(|axis| axes[axis] * offsets[axis]).sum::<DVec3>();
            spheres.push(center + DVec3::splat(100.0), 0.3, 0, Rgb::ONE);
        }
        spheres
    }

    fn turned() -> [DVec3; 3] {
        let rotation = rotation(DVec3::new(1.0, 2.0, -0.5).normalize(), 0.7);
        [rotation * DVec3::X, rotation * DVec3::Y, rotation * DVec3::Z]
    }

    #[test]
    fn principal_axes_are_those_of_the_slab() {
        for axes in [turned(), [DVec3::Z, DVec3::X, DVec3::Y]] {
            for (found, axis) in principal_axes(&slab(axes)).into_iter().zip(axes) {
                assert!(found.dot(axis).abs() > 0.98, "{found} {axis}");
                assert!(found.is_normalized());
            }
        }
        let axes = principal_axes(&Spheres::default());
        assert!(axes[0].cross(axes[1]).dot(axes[2]).abs() > 0.999);
    }

    #[test]
    fn rolls_turn_what_is_up_to_the_right_and_back() {
        let pose = Pose::Fit { direction: DVec3::NEG_Z, margin: 0.0 };
        let camera = Camera { pose, up: DVec3::Y, ..Camera::default() };
        let mut rolled = camera.clone();
        roll(&mut rolled, 90.0);
        assert!(rolled.up.distance(DVec3::X) < 1e-12, "{}", rolled.up);
        let slanted = DVec3::new(0.0, 1.0, 0.7);
        let mut rolled = Camera { up: slanted, ..camera };
        roll(&mut rolled, 33.0);
        roll(&mut rolled, -33.0);
        assert!(rolled.up.distance(slanted) < 1e-12);
    }

    #[test]
    fn eigenvectors_solve_their_equation() {
        let matrix = DMat3::from_cols_array(&[2.0, -1.0, 0.5, -1.0, 3.0, 0.25, 0.5, 0.25, -4.0]);
        let vectors = eigenvectors(matrix);
        let values = vectors.map(|vector| vector.dot(matrix * vector));
        assert!(values[0] >= values[1] && values[1] >= values[2], "{values:?}");
        for (vector, value) in vectors.into_iter().zip(values) {
            assert!((matrix * vector - vector * value).length() < 1e-12);
        }
    }

    #[test]
    fn a_broadside_view_is_along_the_thin_axis_with_the_long_one_across() {
        let camera = broadside(&slab(turned()), &Camera::default(), None);
        let Pose::Fit { direction, .. } = camera.pose else { panic!("it frames the slab") };
        assert!(direction.dot(turned()[2]).abs() > 0.98 && camera.up.dot(turned()[1]).abs() > 0.98);
        // Of the two sides, the one with x to the right and y up.
        let right = direction.cross(camera.up);
        assert!(right.dot(DVec3::X) > 0.0 && camera.up.dot(DVec3::Y) > 0.0, "{right}");
    }

    #[test]
    fn a_broadside_view_keeps_what_is_up() {
        for axes in [turned(), [DVec3::Z, DVec3::X, DVec3::Y]] {
            for up in [DVec3::X, DVec3::Y, DVec3::NEG_Z, axes[1]] {
                let camera = broadside(&slab(axes), &Camera::default(), Some(up));
                let Pose::Fit { direction, .. } = camera.pose else { panic!("it frames the slab") };
                assert_eq!(camera.up, up);
                assert!(direction.dot(up).abs() < 1e-12 && direction.is_normalized());
                let across = axes[0].reject_from(up);
                if across.length() > 0.9 {
                    assert!(direction.dot(across).abs() < 0.3, "{up} {direction}");
                }
            }
        }
    }

    #[test]
    fn every_face_of_a_cut_is_visible() {
        let usual = Camera::FIT_DIRECTION;
        let seen =
            |direction: DVec3, normal: DVec3| -direction.normalize().dot(normal) >= MIN_COSINE;
        let axes = [DVec3::X, DVec3::Y, DVec3::Z];
        for axis in axes {
            assert_eq!(facing(usual, &[axis]), usual, "the usual view shows {axis}");
        }
        assert_eq!(facing(usual, &[]), usual);
        assert_eq!(
            facing(usual, &[DVec3::NEG_Z]),
            (usual * DVec3::new(1.0, 1.0, -1.0)).normalize()
        );
        for bits in 0..27 {
            let part = |divisor: i32| f64::from(bits / divisor % 3 - 1);
            let Some(normal) = DVec3::new(part(1), part(3), part(9)).try_normalize() else {
                continue;
            };
            assert!(seen(facing(usual, &[normal]), normal), "{normal}");
            let two = [normal, DVec3::new(normal.y, normal.z, normal.x)];
            if two[0].dot(two[1]) > -0.4 {
                let view = facing(usual, &two);
                assert!(two.iter().all(|normal| seen(view, *normal)), "{two:?} {view}");
            }
        }
        // Only one face of a slab can be visible.
        let view = facing(usual, &[DVec3::Y, DVec3::NEG_Y]);
        assert!(seen(view, DVec3::Y) || seen(view, DVec3::NEG_Y));
    }

    #[test]
    fn points_are_framed_without_adding_spheres() {
        for projection in
            [Projection::Perspective { fov: 30.0 }, Projection::Orthographic { height: None }]
        {
            let mut scene = Scene { spheres: slab(turned()), ..Scene::default() };
            scene.materials = Scene::of_particles(Particles::default(), "").materials;
            scene.camera.projection = projection;
            let before = scene.spheres.clone();
            let points = [DVec3::splat(70.0), DVec3::new(130.0, 100.0, 95.0)];
            include_points(&mut scene, &points).unwrap();
            assert_eq!(scene.spheres, before);
            check_inside(&scene, &points);
        }
    }

    #[test]
    fn every_image_of_a_turntable_shows_all_from_one_distance() {
        for projection in
            [Projection::Perspective { fov: 50.0 }, Projection::Orthographic { height: None }]
        {
            let mut distances = Vec::new();
            for step in 0..5 {
                let mut scene = Scene { spheres: slab(turned()), ..Scene::default() };
                scene.materials = Scene::of_particles(Particles::default(), "").materials;
                scene.camera.projection = projection;
                let points = [DVec3::splat(80.0)];
                orbit(&mut scene, &points, f64::from(step) * 1.2);
                check_inside(&scene, &points);
                let Pose::LookAt { eye, target } = scene.camera.pose else {
                    panic!("a fixed camera")
                };
                distances.push(eye.distance(target));
            }
            assert!(distances.iter().all(|d| (d / distances[0] - 1.0).abs() < 1e-12));
        }
    }

    fn check_inside(scene: &Scene, points: &[DVec3]) {
        let world = crate::World::build(scene).unwrap();
        let centers = (0..scene.spheres.len()).map(|row| scene.spheres.center(row));
        for point in centers.chain(points.iter().copied()) {
            let seen = world.camera.view(world.transform.point(point));
            let pixel = world.camera.pixel(seen);
            assert!(seen.z > 0.0 && pixel.x > 0.0 && pixel.y > 0.0, "{pixel}");
            assert!(pixel.x < 800.0 && pixel.y < 600.0, "{pixel}");
        }
    }

    #[test]
    fn turns_keep_insets_free() {
        for step in 0..4 {
            let mut scene = Scene { spheres: slab(turned()), ..Scene::default() };
            scene.materials = Scene::of_particles(Particles::default(), "").materials;
            scene.camera.insets = Insets { right: 0.25, bottom: 0.1, ..Insets::default() };
            orbit(&mut scene, &[], f64::from(step) * 1.2);
            let world = crate::World::build(&scene).unwrap();
            for row in 0..scene.spheres.len() {
                let center = world.transform.point(scene.spheres.center(row));
                let pixel = world.camera.pixel(world.camera.view(center));
                assert!(pixel.x > 0.0 && pixel.x < 600.0, "{pixel}");
                assert!(pixel.y > 0.0 && pixel.y < 540.0, "{pixel}");
            }
        }
    }

    #[test]
    fn depths_are_along_the_view() {
        let pose = Pose::LookAt { eye: DVec3::Z * 4.0, target: DVec3::Z };
        let camera = Camera { pose, ..Camera::default() };
        assert_eq!(depth(&camera, DVec3::new(3.0, -2.0, 1.0)), Some(3.0));
        assert_eq!(depth(&camera, DVec3::Z * 5.0), Some(-1.0));
        assert_eq!(depth(&Camera::default(), DVec3::ZERO), None);
        assert_eq!(picture_axes(&camera), Some([DVec3::X, DVec3::Y, DVec3::NEG_Z]));
    }

    #[test]
    fn a_turn_moves_the_camera_to_the_right() {
        let mut scene = Scene::default();
        scene.camera.up = DVec3::Y;
        scene.camera.pose = Pose::LookAt { eye: DVec3::Z * 5.0, target: DVec3::ZERO };
        orbit(&mut scene, &[], std::f64::consts::FRAC_PI_2);
        let Pose::LookAt { eye, target } = scene.camera.pose else { panic!("a fixed camera") };
        assert!(eye.distance(DVec3::X * 5.0) < 1e-12 && target == DVec3::ZERO, "{eye} {target}");
    }

    #[test]
    fn a_turn_frames_the_bounding_sphere() {
        for (width, height) in [(800, 400), (400, 800)] {
            let mut scene = Scene::default();
            scene.spheres.push(DVec3::ZERO, 1.0, 0, Rgb::ONE);
            scene.spheres.push(DVec3::X * 4.0, 3.0, 0, Rgb::ONE);
            (scene.settings.width, scene.settings.height) = (width, height);
            scene.camera.up = DVec3::Y;
            scene.camera.projection = Projection::Perspective { fov: 60.0 };
            scene.camera.pose = Pose::Fit { direction: DVec3::NEG_Z, margin: 0.2 };
            orbit(&mut scene, &[], 0.0);
            let Pose::LookAt { eye, target } = scene.camera.pose else { panic!("a fixed camera") };
            // Both spheres end at -1 or 7. The bounding sphere touches the nearer edges without the
            // margin.
            assert_eq!(target, DVec3::X * 3.0);
            let tangent = 30_f64.to_radians().tan() * f64::min(1.0, width as f64 / height as f64);
            let radius = eye.distance(target) * tangent.atan().sin();
            assert!((radius - 4.0 / 0.8).abs() < 1e-12, "{width} {radius}");
        }
    }
}
