//! Placement of the camera: as given, or fitted to all spheres.

use super::WorldError;
use crate::elementary::{atan, cos, sin, tan};
use crate::scene::{Insets, Pose, Projection, Scene};
use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// The camera in the user's coordinates.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Placement {
    /// Origin of rays.
    pub eye: DVec3,
    /// Unit axes of the picture: to the right, up, and into the scene.
    pub axes: Axes,
    /// Half the picture's height: the tangent of an angle in perspective, a length in parallel
    /// projection.
    pub half_height: f64,
    /// Half the picture's width, likewise.
    pub half_width: f64,
    /// Distance of the target or of the spheres' middle: the default focal distance.
    pub distance: f64,
    /// Maximum distance of ray origins from the eye: half the picture in parallel projection, and the
    /// lens.
    pub reach: f64,
}

/// Unit axes of the picture.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Axes {
    pub right: DVec3,
    pub up: DVec3,
    pub forward: DVec3,
}

impl Axes {
    /// Creates the axes; `forward` need not be of unit length. If `up` is parallel to it, the
    /// coordinate axis along which it is smallest replaces `up`.
    pub(super) fn new(forward: DVec3, up: DVec3) -> Option<Self> {
        let forward = unit(forward)?;
        let up = unit(up)?;
        let right = forward.cross(up);
        // Closer than this to parallel, the picture's rotation would be noise.
        let right = if right.length() > 1e-9 { right } else { forward.cross(least_axis(forward)) };
        let right = right.normalize();
        Some(Self { right, up: right.cross(forward), forward })
    }

    /// Returns the coordinates of `p` along right, up and forward.
    fn coordinates(&self, p: DVec3) -> DVec3 {
        DVec3::new(self.right.dot(p), self.up.dot(p), self.forward.dot(p))
    }

    fn point(&self, coordinates: DVec3) -> DVec3 {
        self.right * coordinates.x + self.up * coordinates.y + self.forward * coordinates.z
    }
}

/// Normalizes a vector, even if the square of its length would overflow or underflow.
fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    (largest > 0.0 && largest < f64::INFINITY).then(|| (v / largest).normalize())
}

fn least_axis(v: DVec3) -> DVec3 {
    let v = v.abs();
    if v.z <= v.x && v.z <= v.y {
        DVec3::Z
    } else if v.y <= v.x {
        DVec3::Y
    } else {
        DVec3::X
    }
}

/// Places the scene's camera.
pub(super) fn pose(scene: &Scene) -> Result<Placement, WorldError> {
    let placement = match scene.camera.pose {
        Pose::LookAt { eye, target } => look_at(scene, eye, target)?,
        Pose::Fit { direction, margin } => fit(scene, direction, margin)?,
    };
    let extent = placement.eye.abs().max_element() + placement.reach + placement.distance;
    if extent.is_finite() && placement.half_height > 0.0 && placement.half_height.is_finite() {
        return Ok(placement);
    }
    Err(camera_error(placement.eye, "its distances overflow; scale the scene down"))
}

/// Returns the spheres that a fitted camera frames: its own, or those that hold all bodies.
pub(super) fn targets(scene: &Scene) -> impl Iterator<Item = (DVec3, f64)> {
    let own = scene.camera.framed.map(|sphere| (sphere.center, sphere.radius));
    let all = own.is_none().then(|| scene.framed());
    own.into_iter().chain(all.into_iter().flatten())
}

/// Returns whether there is nothing to frame.
fn is_empty(scene: &Scene) -> bool {
    scene.framed().next().is_none()
}

fn camera_error(eye: DVec3, why: &'static str) -> WorldError {
    WorldError::Camera { eye: eye.to_array(), why }
}

fn aspect(scene: &Scene) -> f64 {
    f64::from(scene.settings.width) / f64::from(scene.settings.height)
}

fn lens_radius(scene: &Scene) -> f64 {
    scene.camera.lens.map_or(0.0, |lens| lens.aperture / 2.0)
}

fn look_at(scene: &Scene, eye: DVec3, target: DVec3) -> Result<Placement, WorldError> {
    let axes = Axes::new(target - eye, scene.camera.up).ok_or_else(|| {
        camera_error(eye, "`eye` and `target` are the same point; move one of them")
    })?;
    let distance = (target - eye).dot(axes.forward);
    let (aspect, zoom) = (aspect(scene), scene.camera.zoom);
    let placed = |half_height: f64, reach: f64| Placement {
        eye,
        axes,
        half_height,
        half_width: half_height * aspect,
        distance,
        reach: reach + lens_radius(scene) + scene.camera.near,
    };
    Ok(match scene.camera.projection {
        Projection::Perspective { fov } => placed(tan(fov.to_radians() / 2.0) / zoom, 0.0),
        Projection::Orthographic { height } => {
            let half = match height {
                Some(height) => height / 2.0,
                None if is_empty(scene) => return Err(WorldError::NothingToFit),
                // The height that all spheres need around the target.
                None => {
                    let box3 = ViewBox::of(scene, &axes);
                    let at = axes.coordinates(eye);
                    let reach = (box3.high - at).max(at - box3.low);
                    reach.y.max(reach.x / aspect)
                }
            };
            let half = half / zoom;
            placed(half, half * (1.0 + aspect))
        }
    })
}

fn fit(scene: &Scene, direction: DVec3, margin: f64) -> Result<Placement, WorldError> {
    if is_empty(scene) {
        return Err(WorldError::NothingToFit);
    }
    let axes = Axes::new(direction, scene.camera.up)
        .ok_or_else(|| camera_error(DVec3::ZERO, "its `direction` is zero; give it a length"))?;
    let extent = ViewBox::of(scene, &axes);
    let zoom = scene.camera.zoom;
    let window = Window::of(scene.camera.insets, margin).ok_or_else(|| {
        camera_error(DVec3::ZERO, "its margin and insets leave no room; make them smaller")
    })?;
    let (window, aspect) = (window.zoomed(zoom), aspect(scene));
    let lens = lens_radius(scene) + scene.camera.near;
    let middle = (extent.low + extent.high) / 2.0;
    Ok(match scene.camera.projection {
        Projection::Perspective { fov } => {
            let half_height = tan(fov.to_radians() / 2.0) / zoom;
            let half_width = half_height * aspect;
            let at = nearest_eye(scene, &axes, &Sides::new(&window, half_width, half_height));
            let eye = axes.point(at);
            let distance = (middle.z - at.z).max(0.0);
            Placement { eye, axes, half_height, half_width, distance, reach: lens }
        }
        Projection::Orthographic { height } => {
            let size = (extent.high - extent.low) / 2.0;
            let used = (window.high - window.low) / 2.0;
            let half_height = height
                .map_or((size.y / used.y).max(size.x / aspect / used.x), |height| {
                    height / 2.0 / zoom
                });
            let depth = size.z.max(half_height);
            let shift = (window.low + window.high) / 2.0 * half_height;
            let (x, y) = (middle.x - shift.x * aspect, middle.y - shift.y);
            let eye = axes.point(DVec3::new(x, y, extent.low.z - depth));
            Placement {
                eye,
                axes,
                half_height,
                half_width: half_height * aspect,
                distance: middle.z - extent.low.z + depth,
                reach: lens + half_height * (1.0 + aspect),
            }
        }
    })
}

/// The part of the picture that contains all spheres, from -1 to 1 to the right and upward.
struct Window {
    low: DVec2,
    high: DVec2,
}

impl Window {
    /// Creates the part within insets and a margin; `None` if nothing is left.
    fn of(insets: Insets, margin: f64) -> Option<Self> {
        let used = DVec2::splat(1.0 - margin);
        let low = DVec2::new(insets.left, insets.bottom) * 2.0 - used;
        let high = used - DVec2::new(insets.right, insets.top) * 2.0;
        (high - low).cmpgt(DVec2::ZERO).all().then_some(Self { low, high })
    }

    /// Magnifies the part about its middle, for a picture whose angles are as much smaller: the camera stays where it is,
    /// and the picture shows less.
    fn zoomed(self, zoom: f64) -> Self {
        if zoom == 1.0 {
            return self;
        }
        let (middle, half) = ((self.low + self.high) / 2.0, (self.high - self.low) / 2.0);
        Self { low: middle - half * zoom, high: middle + half * zoom }
    }
}

/// Bounds of the spheres along the picture's axes.
struct ViewBox {
    low: DVec3,
    high: DVec3,
}

impl ViewBox {
    fn of(scene: &Scene, axes: &Axes) -> Self {
        let bounds = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };
        // Not a loop: that would ask for each whether it is the last sphere.
        targets(scene).fold(bounds, |Self { low, high }, (center, radius)| {
            let center = axes.coordinates(center);
            Self { low: low.min(center - radius), high: high.max(center + radius) }
        })
    }
}

/// Returns the foremost eye, along right, up and forward, from which every sphere is between the planes
/// of a frustum.
///
/// A sphere is inside a plane through the eye with inward unit normal `n` if `n . eye <= n . center -
/// radius`: the minimum of the right side over all spheres bounds the eye. The two planes of an axis
/// give its coordinate, and each pair gives how far forward it may go.
fn nearest_eye(scene: &Scene, axes: &Axes, sides: &Sides) -> DVec3 {
    let mut slack = [f64::INFINITY; 4];
    for (center, radius) in targets(scene) {
        let planes = sides.slack(axes.coordinates(center), radius);
        for (slack, plane) in slack.iter_mut().zip(planes) {
            *slack = slack.min(plane);
        }
    }
    let [left, right, bottom, top] = sides.0;
    let (across, upward) = ([left, right], [bottom, top]);
    let (of_x, of_y) = ([slack[0], slack[1]], [slack[2], slack[3]]);
    let forward = foremost(across, of_x).min(foremost(upward, of_y));
    DVec3::new(between(across, of_x, forward), between(upward, of_y, forward), forward)
}

/// Returns how far forward two opposite planes allow the eye.
fn foremost([low, high]: [Side; 2], slack: [f64; 2]) -> f64 {
    if low == high {
        return (slack[0] + slack[1]) / (2.0 * low.sin);
    }
    (slack[0] * high.cos + slack[1] * low.cos) / (low.sin * high.cos + high.sin * low.cos)
}

/// Returns the middle of the positions between two opposite planes, for an eye that is this far forward.
fn between([low, high]: [Side; 2], slack: [f64; 2], forward: f64) -> f64 {
    if low == high {
        return (slack[0] - slack[1]) / (2.0 * low.cos);
    }
    let most = (slack[0] - low.sin * forward) / low.cos;
    let least = (high.sin * forward - slack[1]) / high.cos;
    least.midpoint(most)
}

/// The normal of a plane at a side of a frustum: inward and forward component.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Side {
    cos: f64,
    sin: f64,
}

/// Normals of the planes at the left, the right, the bottom and the top side of a frustum.
#[derive(Clone, Copy, Debug)]
struct Sides([Side; 4]);

impl Sides {
    /// Creates the normals for a part of a picture with these tangents of half its width and height.
    fn new(window: &Window, half_width: f64, half_height: f64) -> Self {
        let side = |tangent: f64| {
            let angle = atan(tangent);
            Side { cos: cos(angle), sin: sin(angle) }
        };
        let Window { low, high } = window;
        Self([
            side(half_width * -low.x),
            side(half_width * high.x),
            side(half_height * -low.y),
            side(half_height * high.y),
        ])
    }

    /// Returns the largest offset of each plane for which a sphere is inside of it; `c` is its center
    /// along right, up and forward.
    fn slack(&self, c: DVec3, r: f64) -> [f64; 4] {
        let [left, right, bottom, top] = self.0;
        [
            left.cos * c.x + left.sin * c.z - r,
            -right.cos * c.x + right.sin * c.z - r,
            bottom.cos * c.y + bottom.sin * c.z - r,
            -top.cos * c.y + top.sin * c.z - r,
        ]
    }
}

/// Number of limits by which a sphere can determine the fitted camera.
pub(super) const LIMITS: usize = 11;

/// Axes and planes by which spheres determine the fitted camera: a sphere does if one of its values of
/// [`Limits::of`] is the minimum.
#[derive(Clone, Debug)]
pub(super) struct Limits {
    axes: Axes,
    sides: Sides,
    vertical: DVec3,
}

impl Limits {
    /// Creates the limits for the camera of a scene in which a direction is up; `None` if the camera has no direction or no
    /// room.
    pub(super) fn new(scene: &Scene, vertical: DVec3) -> Option<Self> {
        let (direction, margin) = match scene.camera.pose {
            Pose::Fit { direction, margin } => (direction, margin),
            Pose::LookAt { eye, target } => (target - eye, 0.0),
        };
        let zoom = scene.camera.zoom;
        let tangent = match scene.camera.projection {
            Projection::Perspective { fov } => tan(fov.to_radians() / 2.0) / zoom,
            Projection::Orthographic { .. } => 1.0,
        };
        let window = Window::of(scene.camera.insets, margin)?.zoomed(zoom);
        let sides = Sides::new(&window, tangent * aspect(scene), tangent);
        let vertical = vertical.normalize_or(DVec3::Y);
        Some(Self { axes: Axes::new(direction, scene.camera.up)?, sides, vertical })
    }

    /// Returns a sphere's limits: of all spheres, only those with a minimum limit matter. The limits
    /// are the ends of the box along the picture's axes, the planes of the frustum, and the lowest
    /// point.
    pub(super) fn of(&self, center: DVec3, radius: f64) -> [f64; LIMITS] {
        let c = self.axes.coordinates(center);
        let (low, high) = (c - radius, -(c + radius));
        let [left, right, bottom, top] = self.sides.slack(c, radius);
        let lowest = self.vertical.dot(center) - radius;
        [low.x, low.y, low.z, high.x, high.y, high.z, left, right, bottom, top, lowest]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Camera, FramedSphere, Rgb, Spheres};

    fn spheres() -> Spheres {
        let mut spheres = Spheres::default();
        for i in 0..50 {
            let i = f64::from(i);
            spheres.x.push((i * 12.9898).sin() * 3.0 + 1.0);
            spheres.y.push((i * 78.233).sin());
            spheres.z.push((i * 37.719).cos() * 5.0 - 40.0);
            spheres.radius.push(0.1 + 0.3 * (i * 4.1).cos().abs());
        }
        spheres
    }

    #[test]
    fn a_fitted_perspective_touches_the_edges_and_shows_all() {
        let mut scene = Scene { spheres: spheres(), ..Scene::default() };
        scene.camera.pose = Pose::Fit { direction: DVec3::new(0.3, -0.5, -1.0), margin: 0.0 };
        let placed = pose(&scene).unwrap();
        let mut largest: f64 = 0.0;
        for i in 0..scene.spheres.len() {
            let c = placed.axes.coordinates(scene.spheres.center(i) - placed.eye);
            // Extent of the sphere's outline on each axis, as the tangent of an angle.
            let edge = |along: f64, half: f64| {
                let distance = along.hypot(c.z);
                let angle = along.abs().atan2(c.z) + (scene.spheres.radius[i] / distance).asin();
                angle.tan() / half
            };
            largest = largest.max(edge(c.x, placed.half_width)).max(edge(c.y, placed.half_height));
        }
        assert!((largest - 1.0).abs() < 1e-9, "{largest}");
    }

    /// Bounds of the spheres in the picture, from -1 to 1, by the tangents of their outlines.
    fn outline(scene: &Scene, placed: &Placement) -> (DVec2, DVec2) {
        let mut bounds = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let parallel = matches!(scene.camera.projection, Projection::Orthographic { .. });
        for i in 0..scene.spheres.len() {
            let c = placed.axes.coordinates(scene.spheres.center(i) - placed.eye);
            let r = scene.spheres.radius[i];
            let ends = |along: f64, half: f64| {
                let (angle, reach) = (along.atan2(c.z), (r / along.hypot(c.z)).asin());
                let ends = [-1.0, 1.0].map(|side| (angle + side * reach).tan() / half);
                if parallel { [-r, r].map(|side| (along + side) / half) } else { ends }
            };
            let (x, y) = (ends(c.x, placed.half_width), ends(c.y, placed.half_height));
            bounds.0 = bounds.0.min(DVec2::new(x[0], y[0]));
            bounds.1 = bounds.1.max(DVec2::new(x[1], y[1]));
        }
        bounds
    }

    #[test]
    fn insets_stay_free_and_the_rest_is_used() {
        let mut scene = Scene { spheres: spheres(), ..Scene::default() };
        for projection in
            [Projection::Perspective { fov: 50.0 }, Projection::Orthographic { height: None }]
        {
            for insets in [[0.2, 0.0, 0.0, 0.0], [0.0, 0.3, 0.1, 0.0], [0.4, 0.1, 0.0, 0.25]] {
                let [left, right, bottom, top] = insets;
                scene.camera.insets = Insets { left, right, bottom, top };
                scene.camera.projection = projection;
                scene.camera.pose =
                    Pose::Fit { direction: DVec3::new(0.3, -0.5, -1.0), margin: 0.1 };
                let (low, high) = outline(&scene, &pose(&scene).unwrap());
                let room = [
                    low.x - (2.0 * left - 0.9),
                    0.9 - 2.0 * right - high.x,
                    low.y - (2.0 * bottom - 0.9),
                    0.9 - 2.0 * top - high.y,
                ];
                assert!(room.iter().all(|room| *room > -1e-9), "{insets:?} {room:?}");
                // Along one axis, spheres touch both ends.
                let used = (room[0].max(room[1])).min(room[2].max(room[3]));
                assert!(used < 1e-9, "{insets:?} {room:?}");
            }
        }
        scene.camera.insets = Insets { left: 0.5, right: 0.5, ..Insets::default() };
        assert!(matches!(pose(&scene), Err(WorldError::Camera { .. })));
    }

    #[test]
    fn zooms_magnify_about_the_middle_of_what_is_framed() {
        let insets = Insets { left: 0.3, right: 0.0, bottom: 0.1, top: 0.05 };
        let parallel = Projection::Orthographic { height: None };
        let central = Projection::Perspective { fov: 50.0 };
        for (projection, insets) in
            [(central, Insets::default()), (parallel, Insets::default()), (parallel, insets)]
        {
            let mut scene = Scene { spheres: spheres(), ..Scene::default() };
            let pose = Pose::Fit { direction: DVec3::new(0.3, -0.5, -1.0), margin: 0.1 };
            (scene.camera.projection, scene.camera.pose) = (projection, pose);
            scene.camera.insets = insets;
            let before = super::pose(&scene).unwrap();
            let (low, high) = outline(&scene, &before);
            let middle = DVec2::new(insets.left - insets.right, insets.bottom - insets.top);
            for zoom in [2.0, 0.4, 30.0] {
                let mut zoomed = scene.clone();
                zoomed.camera.zoom = zoom;
                let placed = super::pose(&zoomed).unwrap();
                let found = outline(&zoomed, &placed);
                let expected = [low, high].map(|end| middle + (end - middle) * zoom);
                let error = (found.0 - expected[0]).abs().max((found.1 - expected[1]).abs());
                assert!(error.max_element() < 1e-9 * zoom, "{projection:?} {zoom}: {error}");
                if insets == Insets::default() {
                    assert!(placed.eye.distance(before.eye) < 1e-9 || projection == parallel);
                }
                // A placed camera is the same with a narrower field of view.
                zoomed.camera.pose =
                    Pose::LookAt { eye: placed.eye, target: placed.eye + placed.axes.forward };
                if let Projection::Orthographic { height } = &mut zoomed.camera.projection {
                    *height = Some(2.0 * before.half_height);
                }
                let of_zoom = super::pose(&zoomed).unwrap().half_height;
                zoomed.camera.fold_zoom();
                let folded = super::pose(&zoomed).unwrap().half_height;
                assert!((folded / of_zoom - 1.0).abs() < 1e-12 && zoomed.camera.zoom == 1.0);
            }
        }
    }

    #[test]
    fn a_sphere_may_be_framed_instead_of_all() {
        let mut scene = Scene { spheres: spheres(), ..Scene::default() };
        let framed = FramedSphere { center: DVec3::new(7.0, -2.0, -30.0), radius: 1.5 };
        scene.camera.framed = Some(framed);
        let mut alone = Scene::default();
        alone.spheres.push(framed.center, framed.radius, 0, Rgb::ONE);
        let [of_scene, of_sphere] = [&scene, &alone].map(|scene| pose(scene).unwrap().eye);
        assert_eq!(of_scene, of_sphere);
    }

    #[test]
    fn up_parallel_to_the_view_gets_another_axis() {
        let axes = Axes::new(DVec3::new(0.0, -2.0, 0.0), DVec3::Y).unwrap();
        assert!(axes.right.is_normalized() && axes.up.is_normalized());
        assert_eq!(axes.right.dot(axes.forward), 0.0);
    }

    #[test]
    fn nothing_to_fit_and_an_eye_on_its_target_are_errors() {
        assert!(matches!(pose(&Scene::default()), Err(WorldError::NothingToFit)));
        let eye = DVec3::new(1.0, 2.0, 3.0);
        let camera = Camera { pose: Pose::LookAt { eye, target: eye }, ..Camera::default() };
        assert!(matches!(
            pose(&Scene { camera, ..Scene::default() }),
            Err(WorldError::Camera { .. })
        ));
    }

    #[test]
    fn parallel_views_frame_what_is_wide() {
        let placed = |pose: Pose| {
            let mut scene = Scene::default();
            for x in [-3.0, 5.0] {
                scene.spheres.push(DVec3::new(x, 0.0, -10.0), 1.0, 0, Rgb::ONE);
            }
            (scene.settings.width, scene.settings.height) = (200, 100);
            let projection = Projection::Orthographic { height: None };
            scene.camera = Camera { projection, pose, up: DVec3::Y, ..Camera::default() };
            super::pose(&scene).unwrap()
        };
        // The far end is 6 to the side of the eye.
        let looking = placed(Pose::LookAt { eye: DVec3::ZERO, target: DVec3::NEG_Z });
        assert_eq!((looking.half_width, looking.half_height), (6.0, 3.0));
        let framed = placed(Pose::Fit { direction: DVec3::NEG_Z, margin: 0.0 });
        assert_eq!((framed.half_width, framed.half_height), (5.0, 2.5));
        let middle = DVec3::new(1.0, 0.0, -10.0);
        assert_eq!(framed.eye + framed.axes.forward * framed.distance, middle);
    }
}
