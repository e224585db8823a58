//! The camera of a composed scene: its side, its position, its lens, and the lights that follow it.

use super::{Fault, Request, Sections, Shared, Staged};
use crate::overlay::annotations;
use crate::scene::particles::{Orientation, Particles, Selection};
use crate::scene::{Camera, FileError, FramedSphere, Insets, Lens, Pose, Projection, Scene};
use crate::world::framing::view::{self, View};
use crate::world::{WorldError, framing};
use glam::DVec3;
use std::path::Path;
use std::str::FromStr;

/// The view that is asked for.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraRequest {
    /// A camera that is used as it is, with its lens.
    pub own: Option<Camera>,
    /// The direction.
    pub view: Option<View>,
    /// The point that the camera looks at; particles that it frames are [`framed`](crate::scene::particles::ParticleStyle::framed).
    pub look_at: Option<DVec3>,
    /// Magnification, within [`Camera::ZOOMS`].
    pub zoom: Option<f64>,
    /// Angle in degrees by which the camera is rolled clockwise.
    pub roll: Option<f64>,
    /// The projection; one of the scene's kind leaves the scene's.
    pub projection: Option<Projection>,
    /// Margin around the scene as a fraction of the image, 0 to 0.9.
    pub margin: Option<f64>,
    /// True if the image is one of a turntable.
    pub turns: bool,
}

/// What the camera looks at: particles, or a point.
#[derive(Clone, Debug, PartialEq)]
pub enum LookAt {
    /// These particles.
    Selection(Selection),
    /// This point.
    Point(DVec3),
}

impl FromStr for LookAt {
    type Err = String;

    /// Parses three numbers, or else a selection.
    fn from_str(text: &str) -> Result<Self, String> {
        let number =
            |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
        match numbers.as_deref() {
            Some(&[x, y, z]) => Ok(Self::Point(DVec3::new(x, y, z))),
            Some(_) => Err("give a point as x,y,z, or a selection, as in 'resname LIG'".to_owned()),
            None => {
                let selection = text.parse::<Selection>().map_err(|fault| fault.to_string());
                selection.map(Self::Selection)
            }
        }
    }
}

/// Returns the magnification.
///
/// # Errors
/// It is out of range.
pub fn zoom(factor: f64) -> Result<f64, String> {
    let (least, most) = (*Camera::ZOOMS.start(), *Camera::ZOOMS.end());
    let message = || format!("give a factor from {least} to {most}, as in 2 for twice as large");
    Camera::ZOOMS.contains(&factor).then_some(factor).ok_or_else(message)
}

/// The lens that is asked for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LensRequest {
    /// Diameter of the lens, at least 0.
    pub aperture: Option<f64>,
    /// The point or particle in focus.
    pub focus: Option<Focus>,
}

/// The point or particle in focus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Focus {
    /// The center of the particle with this id.
    Particle(f64),
    /// A distance along the view axis, more than 0.
    Distance(f64),
}

impl FromStr for Focus {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number =
            |text: &str| text.trim().parse().ok().filter(|number: &f64| number.is_finite());
        let focus = match text.strip_prefix("id:") {
            Some(id) => number(id).map(Self::Particle),
            None => number(text).filter(|distance| *distance > 0.0).map(Self::Distance),
        };
        focus.ok_or_else(|| {
            "give the id of a particle, as in id:1234, or a distance greater than 0".to_owned()
        })
    }
}

impl LensRequest {
    /// Returns the columns of particles that the focus needs.
    pub fn columns(&self) -> Vec<String> {
        let is_particle = matches!(self.focus, Some(Focus::Particle(_)));
        is_particle.then(|| "id".to_owned()).into_iter().collect()
    }
}

/// Returns the center of the particle in focus, if the focus is a particle.
pub(super) fn point_in_focus(
    request: &Request,
    path: &Path,
    particles: &Particles,
) -> Result<Option<DVec3>, FileError> {
    let Some(Focus::Particle(id)) = request.lens.focus else { return Ok(None) };
    if request.style.allow_empty && particles.spheres.is_empty() {
        return Ok(None);
    }
    let point = particles.position_of(id);
    point.map(Some).ok_or_else(|| {
        let error =
            FileError::whole_file(path, format!("no particle that is drawn has the id {id}"));
        error.with_help(
            "--focus id:ID takes a value of the column id, or without one a number from 0",
        )
    })
}

/// Sets projection, side and margin of a scene's camera, but not its position. The default view shows the caps of
/// slices.
///
/// # Errors
/// [`Fault::Margin`].
pub fn choose(request: &Request, staged: &mut Staged) -> Result<(), Fault> {
    let Staged { scene, orientation, normals, .. } = staged;
    if let Some(own) = &request.camera.own {
        scene.camera = own.clone();
        return Ok(());
    }
    let CameraRequest { view, projection, margin, zoom, roll, .. } = request.camera;
    let sections = request.sections.as_ref();
    if let Some(sections) = sections {
        sections.set_camera(&mut scene.camera);
    }
    if !sections.is_some_and(Sections::places_camera) {
        let same = |projection: &Projection| {
            std::mem::discriminant(projection) == std::mem::discriminant(&scene.camera.projection)
        };
        if let Some(projection) = projection.filter(|projection| !same(projection)) {
            scene.camera.projection = projection;
        }
        view::choose(scene, view, orientation.as_ref(), normals);
    }
    if scene.camera.framed.is_some() {
        fit(&mut scene.camera);
    }
    match (&mut scene.camera.pose, margin) {
        (Pose::Fit { margin, .. }, Some(asked)) => *margin = asked,
        (Pose::LookAt { .. }, Some(_)) => return Err(Fault::Margin),
        (_, None) => (),
    }
    scene.camera.zoom *= zoom.unwrap_or(1.0);
    if let Some(degrees) = roll {
        framing::roll(&mut scene.camera, degrees);
    }
    Ok(())
}

/// Fits a camera that is placed, with the same direction.
fn fit(camera: &mut Camera) {
    if let Pose::LookAt { eye, target } = camera.pose {
        camera.pose = Pose::Fit { direction: target - eye, margin: Camera::FIT_MARGIN };
        camera.near = 0.0;
        if let Projection::Orthographic { height } = &mut camera.projection {
            *height = None;
        }
    }
}

/// Returns the sphere that the camera frames instead of all bodies, if something is looked at: about a point, with all
/// bodies as large as in a turntable.
pub(super) fn framed(request: &Request, scene: &Scene) -> Option<FramedSphere> {
    let of_point = |center: DVec3| {
        let (_, radius) = framing::bounding_sphere(scene, &[]);
        (radius > 0.0).then_some(FramedSphere { center, radius })
    };
    request.camera.look_at.and_then(of_point).or(scene.camera.framed)
}

/// Points that must be in view besides bodies: the corners of a cell that is drawn.
pub fn corners(scene: &Scene) -> Vec<DVec3> {
    scene.look.cell.map_or_else(Vec::new, |cell| cell.corners().to_vec())
}

/// Leaves room for annotations, also of a turntable if the image `turns`.
pub fn leave_room(scene: &mut Scene, turns: bool) {
    if scene.camera.insets == Insets::default() {
        scene.camera.insets = annotations::insets(scene, turns);
    }
}

/// Leaves room for annotations, and frames the cell that is drawn; for an image at an angle of a turntable, in
/// radians, places the camera. The scene's size is known.
///
/// # Errors
/// The scene cannot be framed.
pub fn frame(scene: &mut Scene, turns: bool, angle: Option<f64>) -> Result<(), WorldError> {
    leave_room(scene, turns);
    let corners = corners(scene);
    if let Some(angle) = angle {
        framing::orbit(scene, &corners, angle);
    }
    if corners.is_empty() { Ok(()) } else { framing::include_points(scene, &corners) }
}

/// Returns the direction that is up in a scene whose camera is chosen: that of the ground. In a view from above it is
/// not that of the image.
pub fn vertical(request: &Request, camera: &Camera, orientation: Option<&Orientation>) -> DVec3 {
    let asked = &request.camera;
    if let (Some(_), Some(orientation)) = (&asked.own, orientation) {
        return orientation.up.vector();
    }
    let Some(degrees) = asked.roll else { return view::vertical(asked.view, camera, orientation) };
    let mut upright = camera.clone();
    framing::roll(&mut upright, -degrees);
    view::vertical(asked.view, &upright, orientation)
}

/// Lights a scene whose camera is placed as its preset does, or as the sections say.
pub fn light(request: &Request, staged: &mut Staged) {
    let Staged { scene, orientation, preset, .. } = staged;
    if let Some(sections) = request.sections.as_ref().filter(|sections| sections.lights_scene()) {
        sections.set_lights(scene);
    } else if let (Some(preset), Some(camera)) = (*preset, &request.lit_from) {
        let own = std::mem::replace(&mut scene.camera, camera.clone());
        preset.light(scene, camera.up);
        scene.camera = own;
    } else if let Some(preset) = *preset {
        let vertical = vertical(request, &scene.camera, orientation.as_ref());
        preset.light(scene, vertical);
    }
}

/// Lights a scene whose camera is chosen, as if it were placed in an image of the size that is set now.
///
/// # Errors
/// The scene cannot be framed.
pub fn light_ahead(request: &Request, staged: &mut Staged) -> Result<(), Fault> {
    let camera = staged.scene.camera.clone();
    if !request.sections.as_ref().is_some_and(Sections::lights_scene) {
        frame_titled(request, staged, None)?;
    }
    light(request, staged);
    staged.scene.camera = camera;
    Ok(())
}

/// Places the camera, or takes that of the sequence, sets its lens, and lights the scene. `angle` is that of an image of
/// a turntable, in radians.
///
/// # Errors
/// The scene cannot be framed, or the lens or the margin has no effect.
pub fn place(
    request: &Request,
    staged: &mut Staged,
    shared: Option<&Shared>,
    angle: Option<f64>,
) -> Result<(), Fault> {
    if let Some(shared) = shared {
        staged.scene.camera = shared.camera.clone();
    } else {
        choose(request, staged)?;
        frame_titled(request, staged, angle)?;
    }
    set_lens(request.lens, &mut staged.scene, staged.focus)?;
    light(request, staged);
    if let (Some(ground), Some(shared)) = (&mut staged.scene.ground, shared) {
        ground.height = shared.ground.unwrap_or(ground.height);
    }
    Ok(())
}

fn frame_titled(request: &Request, staged: &mut Staged, angle: Option<f64>) -> Result<(), Fault> {
    let scene = &mut staged.scene;
    let framed = frame(scene, request.camera.turns, angle);
    framed.map_err(|error| Fault::World(scene.title.clone(), error))
}

/// Sets the lens of a scene's camera, whose view is chosen; `point` is the center of the particle in focus, if the focus
/// is a particle.
fn set_lens(asked: LensRequest, scene: &mut Scene, point: Option<DVec3>) -> Result<(), Fault> {
    if let Some(aperture) = asked.aperture {
        let focus = scene.camera.lens.and_then(|lens| lens.focus);
        scene.camera.lens = Some(Lens { aperture, focus });
    }
    let Some(focus) = asked.focus else { return Ok(()) };
    if scene.camera.lens.is_none() {
        return Err(Fault::FocusOfPinhole);
    }
    let distance = match (focus, point) {
        (Focus::Distance(distance), _) => distance,
        // Frames of a trajectory may be empty.
        (Focus::Particle(_), None) if scene.is_empty() => return Ok(()),
        (Focus::Particle(_), None) => return Err(Fault::FocusWithoutParticles),
        (Focus::Particle(id), Some(point)) => {
            // The vertical axis of the scene stays, which lights follow.
            let up = scene.camera.up;
            let name = scene.title.clone();
            framing::include_points(scene, &[]).map_err(|error| Fault::World(name, error))?;
            let depth = framing::depth(&scene.camera, point);
            scene.camera.up = up;
            depth.filter(|depth| *depth > 0.0).ok_or(Fault::FocusBehindCamera(id))?
        }
    };
    if let Some(lens) = &mut scene.camera.lens {
        lens.focus = Some(distance);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Rgb;

    #[test]
    fn focuses_are_particles_or_distances() {
        assert_eq!("id:12".parse(), Ok(Focus::Particle(12.0)));
        assert_eq!("2.5".parse(), Ok(Focus::Distance(2.5)));
        for text in ["", "id:", "id:a", "0", "-1", "inf", "nan", "12:id"] {
            assert!(text.parse::<Focus>().is_err(), "{text}");
        }
    }

    #[test]
    fn points_and_selections_are_told_apart() {
        assert_eq!("1,-2.5, 3e2".parse(), Ok(LookAt::Point(DVec3::new(1.0, -2.5, 300.0))));
        assert!(matches!("resname LIG".parse(), Ok(LookAt::Selection(_))));
        assert!(matches!("x > 1 and y < 2".parse(), Ok(LookAt::Selection(_))));
        for text in ["1,2", "1", "1,2,3,4", "1,2,inf", "", "x >"] {
            assert!(text.parse::<LookAt>().is_err(), "{text}");
        }
    }

    /// Four spheres in a row, staged with a camera that is asked for.
    fn chosen(camera: CameraRequest) -> (Request, Staged) {
        let mut scene = Scene::default();
        for x in 0..4 {
            scene.spheres.push(DVec3::X * f64::from(x), 0.5, 0, Rgb::ONE);
        }
        let request = Request { camera, ..Request::default() };
        let subject = crate::compose::Subject {
            path: Path::new("a.toml"),
            title: "",
            frame: &crate::compose::Value::Missing(""),
        };
        let content = crate::compose::Content::Scene(Box::new(scene));
        let mut staged = crate::compose::stage(&request, &subject, content, None).expect("a scene");
        place(&request, &mut staged, None, None).expect("a camera");
        framing::include_points(&mut staged.scene, &[]).expect("spheres");
        (request, staged)
    }

    #[test]
    fn points_that_are_looked_at_are_in_the_middle() {
        let view = "30,20".parse().ok();
        let point = DVec3::new(3.0, 0.5, 0.0);
        let (_, staged) = chosen(CameraRequest { view, look_at: Some(point), ..<_>::default() });
        let Pose::LookAt { eye, target } = staged.scene.camera.pose else { panic!("it is placed") };
        let aside = (point - eye).normalize().cross((target - eye).normalize()).length();
        assert!(aside < 1e-12, "{aside}");
    }

    #[test]
    fn lights_stay_upright_if_the_camera_is_rolled() {
        let view = "30,20".parse().ok();
        let (request, staged) = chosen(CameraRequest { view, roll: Some(40.0), ..<_>::default() });
        let camera = &staged.scene.camera;
        assert!(camera.up.distance(DVec3::Z) > 0.1);
        assert!(vertical(&request, camera, None).distance(DVec3::Z) < 1e-12);
    }

    #[test]
    fn own_cameras_are_used_as_they_are_and_alone() {
        let pose = Pose::LookAt { eye: DVec3::new(9.0, 8.0, 7.0), target: DVec3::X };
        let own = Camera { pose, near: 0.5, up: DVec3::Z, ..Camera::default() };
        let asked = CameraRequest { own: Some(own.clone()), ..<_>::default() };
        let (request, staged) = chosen(asked.clone());
        assert_eq!(staged.scene.camera, own);
        assert_eq!(request.contradiction(), None);
        let zoomed = CameraRequest { zoom: Some(2.0), ..asked };
        let request = Request { camera: zoomed, ..Request::default() };
        assert_eq!(request.contradiction(), Some("zoom"));
    }

    #[test]
    fn particles_are_in_focus_from_the_camera_that_frames_all() {
        let mut scene = Scene::default();
        for x in 0..4 {
            scene.spheres.push(DVec3::X * f64::from(x), 0.5, 0, Rgb::ONE);
        }
        scene.camera = Camera {
            pose: Pose::Fit { direction: DVec3::NEG_X, margin: 0.0 },
            ..Camera::default()
        };
        let lens = |focus| LensRequest { aperture: Some(0.2), focus: Some(focus) };
        let particle = lens(Focus::Particle(3.0));
        let mut focused = scene.clone();
        set_lens(particle, &mut focused, Some(DVec3::X)).expect("in front of the camera");
        let Pose::LookAt { eye, .. } = focused.camera.pose else { panic!("a fixed camera") };
        let focus = focused.camera.lens.and_then(|lens| lens.focus).expect("a focus");
        assert!((focus - (eye.x - 1.0)).abs() < 1e-9, "{focus} {eye}");
        assert!(set_lens(particle, &mut scene.clone(), Some(DVec3::X * 1e6)).is_err());
        assert!(set_lens(particle, &mut scene.clone(), None).is_err());
        assert!(set_lens(particle, &mut Scene::default(), None).is_ok(), "an empty frame");
        let distance = lens(Focus::Distance(4.0));
        let idle = LensRequest { aperture: None, ..distance };
        assert!(set_lens(idle, &mut scene, None).is_err(), "a pinhole");
        set_lens(distance, &mut scene, None).expect("a distance");
        assert_eq!(scene.camera.lens, Some(Lens { aperture: 0.2, focus: Some(4.0) }));
    }
}
