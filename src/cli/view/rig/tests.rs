use super::*;

fn rig() -> Rig {
    let pose = Pose::LookAt { eye: DVec3::new(3.0, 2.0, 7.0), target: DVec3::new(1.0, 0.0, 0.5) };
    Rig::new(Camera { pose, ..Camera::default() }, 5.0)
}

/// Where a point is in the picture, in heights of it from its middle.
fn place(rig: &Rig, point: DVec3) -> DVec2 {
    let (axes, offset) = (rig.axes(), point - rig.eye());
    let scale = match rig.camera.projection {
        Projection::Perspective { .. } => rig.height() / rig.distance() * offset.dot(axes.forward),
        Projection::Orthographic { .. } => rig.height(),
    };
    DVec2::new(offset.dot(axes.right), offset.dot(axes.up)) / scale
}

fn near(a: DVec2, b: DVec2) -> bool {
    a.distance(b) < 1e-9
}

#[test]
fn turning_keeps_the_pivot_in_its_place_and_the_horizon_level() {
    for pivot in [DVec3::new(1.0, 0.0, 0.5), DVec3::new(2.0, 1.5, -1.0)] {
        let mut rig = rig();
        rig.turn_about(pivot);
        let before = (place(&rig, pivot), rig.eye().distance(pivot));
        for turn in [DVec2::new(0.4, 0.1), DVec2::new(-2.0, -0.7), DVec2::new(0.0, 9.0)] {
            rig.orbit(turn);
            assert!(near(place(&rig, pivot), before.0), "{turn}");
            assert!((rig.eye().distance(pivot) - before.1).abs() < 1e-9);
            assert!(rig.axes().right.dot(DVec3::Y).abs() < 1e-9);
        }
    }
}

#[test]
fn what_is_dragged_goes_with_the_pointer() {
    let mut rig = rig();
    let start = DVec2::new(0.2, -0.1);
    let (origin, direction) = rig.ray(start);
    let point = origin + direction * (rig.distance() / direction.dot(rig.axes().forward));
    assert!(near(place(&rig, point), start));
    rig.pan(DVec2::new(0.1, 0.3));
    assert!(near(place(&rig, point), start + DVec2::new(0.1, 0.3)));
}

#[test]
fn zooming_keeps_what_is_at_the_pointer() {
    let mut perspective = rig();
    let mut parallel = rig();
    parallel.project();
    for rig in [&mut perspective, &mut parallel] {
        let pointer = DVec2::new(-0.4, 0.3);
        let (origin, direction) = rig.ray(pointer);
        let point = origin + direction * (rig.distance() / direction.dot(rig.axes().forward));
        let height = rig.height();
        for factor in [0.8, 0.5, 3.0] {
            rig.zoom(factor, pointer);
            assert!(near(place(rig, point), pointer), "{factor}");
        }
        assert!((rig.height() / height - 1.2).abs() < 1e-9);
        rig.zoom(0.0, pointer);
        assert!(rig.eye().is_finite() && rig.distance() > 0.0 && rig.height() > 0.0);
    }
}

#[test]
fn a_projection_and_back_is_the_same_picture() {
    let mut rig = rig();
    let (before, height) = (place(&rig, DVec3::new(1.0, 0.0, 0.5)), rig.height());
    rig.project();
    assert_eq!(rig.camera.projection, Projection::Orthographic { height: Some(height) });
    rig.project();
    assert!(near(place(&rig, DVec3::new(1.0, 0.0, 0.5)), before));
    assert!((rig.height() - height).abs() < 1e-9);
}

#[test]
fn rolling_turns_the_picture_and_turning_keeps_the_roll() {
    let mut rig = rig();
    let right = rig.axes().right;
    rig.roll(0.5);
    assert!((rig.axes().right.angle_between(right) - 0.5).abs() < 1e-9);
    let point = rig.pivot + rig.axes().up;
    rig.orbit(DVec2::new(0.3, 0.0));
    assert!(rig.axes().right.dot(DVec3::Y).abs() > 0.1);
    rig.focus(point);
    let focus = rig.camera.lens.and_then(|lens| lens.focus).unwrap();
    assert!((focus - (point - rig.eye()).dot(rig.axes().forward)).abs() < 1e-9);
}
