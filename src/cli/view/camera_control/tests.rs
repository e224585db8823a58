use super::*;
use spherule_render::elementary::{cos, sin};

fn control() -> CameraControl {
    let pose = Pose::LookAt { eye: DVec3::new(3.0, 2.0, 7.0), target: DVec3::new(1.0, 0.0, 0.5) };
    CameraControl::new(Camera { pose, ..Camera::default() }, 5.0)
}

fn place(control: &CameraControl, point: DVec3) -> DVec2 {
    control.place_of(point).expect("a point before the eye")
}

fn near(a: DVec2, b: DVec2) -> bool {
    a.distance(b) < 1e-9
}

#[test]
fn orbiting_keeps_the_pivot_fixed_and_the_horizon_level() {
    for pivot in [DVec3::new(1.0, 0.0, 0.5), DVec3::new(2.0, 1.5, -1.0)] {
        let mut control = control();
        control.set_pivot(pivot);
        let before = (place(&control, pivot), control.eye().distance(pivot));
        for turn in [DVec2::new(0.4, 0.1), DVec2::new(-2.0, -0.7), DVec2::new(0.0, 9.0)] {
            control.orbit(turn);
            assert!(near(place(&control, pivot), before.0), "{turn}");
            assert!((control.eye().distance(pivot) - before.1).abs() < 1e-9);
            assert!(control.axes().right.dot(DVec3::Y).abs() < 1e-9);
        }
    }
}

#[test]
fn panning_follows_the_pointer() {
    let mut control = control();
    let start = DVec2::new(0.2, -0.1);
    let (origin, direction) = control.ray(start);
    let point = origin + direction * (control.distance() / direction.dot(control.axes().forward));
    assert!(near(place(&control, point), start));
    control.pan(DVec2::new(0.1, 0.3));
    assert!(near(place(&control, point), start + DVec2::new(0.1, 0.3)));
}

#[test]
fn zooming_keeps_the_point_at_the_pointer() {
    let mut perspective = control();
    let mut parallel = control();
    parallel.toggle_projection();
    for control in [&mut perspective, &mut parallel] {
        let pointer = DVec2::new(-0.4, 0.3);
        let (origin, direction) = control.ray(pointer);
        let point =
            origin + direction * (control.distance() / direction.dot(control.axes().forward));
        let height = control.height();
        for factor in [0.8, 0.5, 3.0] {
            control.zoom(factor, pointer);
            assert!(near(place(control, point), pointer), "{factor}");
        }
        assert!((control.height() / height - 1.2).abs() < 1e-9);
        control.zoom(0.0, pointer);
        assert!(control.eye().is_finite() && control.distance() > 0.0 && control.height() > 0.0);
    }
}

#[test]
fn toggling_the_projection_twice_changes_nothing() {
    let mut control = control();
    let (before, height) = (place(&control, DVec3::new(1.0, 0.0, 0.5)), control.height());
    control.toggle_projection();
    assert_eq!(control.camera.projection, Projection::Orthographic { height: Some(height) });
    control.toggle_projection();
    assert!(near(place(&control, DVec3::new(1.0, 0.0, 0.5)), before));
    assert!((control.height() - height).abs() < 1e-9);
}

#[test]
fn rays_at_an_outline_touch_the_sphere() {
    let (middle, radius) = (DVec3::new(-0.5, 1.0, 1.5), 1.2);
    let mut control = control();
    for _ in 0..2 {
        let Outline { center, radii, axis } = control.outline(middle, radius).unwrap();
        assert!(radii.x > radii.y - 1e-12 && radii.y > 0.1, "{radii}");
        for step in 0..16 {
            let angle = f64::from(step) * 0.4;
            let place = axis.rotate(DVec2::new(cos(angle), sin(angle)) * radii);
            let (origin, direction) = control.ray(center + place);
            let distance = (middle - origin).reject_from(direction).length();
            assert!((distance - radius).abs() < 1e-9, "{step} {distance}");
        }
        control.toggle_projection();
    }
    assert_eq!(control.outline(control.eye(), 0.1), None);
}

#[test]
fn rolling_turns_the_picture_and_orbiting_keeps_the_roll() {
    let mut control = control();
    let right = control.axes().right;
    control.roll(0.5);
    assert!((control.axes().right.angle_between(right) - 0.5).abs() < 1e-9);
    let point = control.pivot + control.axes().up;
    control.orbit(DVec2::new(0.3, 0.0));
    assert!(control.axes().right.dot(DVec3::Y).abs() > 0.1);
    control.focus(point);
    let focus = control.camera.lens.and_then(|lens| lens.focus).unwrap();
    assert!((focus - (point - control.eye()).dot(control.axes().forward)).abs() < 1e-9);
}
