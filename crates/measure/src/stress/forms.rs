//! Ray-sphere intersection tests in single precision, for comparison.

use super::rays::Ray;
use glam::Vec3;

/// A ray-sphere intersection test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// The textbook's quadratic formula in single precision, with roots above 0.
    Naive,
    /// The same with roots above 1e-4, the usual remedy against self-intersection.
    NaiveOffset,
    /// The test of good single-precision ray tracers, by the middle of the chord relative to the center,
    /// as in Embree and in Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere
    /// Intersection", Ray Tracing Gems 2019.
    Good,
    /// Spherule's test.
    Spherule,
}

impl Form {
    /// All tests, in display order.
    pub const ALL: [Self; 4] = [Self::Naive, Self::NaiveOffset, Self::Good, Self::Spherule];

    /// Returns the name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Naive => "naive",
            Self::NaiveOffset => "naive_offset",
            Self::Good => "good_f32",
            Self::Spherule => "spherule",
        }
    }
}

/// The closest hit that a test found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Answer {
    pub(super) sphere: usize,
    pub(super) t: f64,
    pub(super) normal: glam::DVec3,
}

/// A function that intersects a ray with a sphere; returns distance and normal.
pub(super) type Intersect = fn(&Ray, [f32; 4]) -> Option<(f32, Vec3)>;

/// Returns the closest hit of a ray; of equal distances, that of the first sphere.
pub(super) fn closest(form: Intersect, spheres: &[[f32; 4]], ray: &Ray) -> Option<Answer> {
    let mut best: Option<(usize, f32, Vec3)> = None;
    for (sphere, row) in spheres.iter().enumerate() {
        if let Some((t, normal)) = form(ray, *row)
            && best.is_none_or(|best| t < best.1)
        {
            best = Some((sphere, t, normal));
        }
    }
    best.map(|(sphere, t, normal)| Answer { sphere, t: f64::from(t), normal: normal.as_dvec3() })
}

/// [`Form::Naive`].
pub(super) fn naive(ray: &Ray, sphere: [f32; 4]) -> Option<(f32, Vec3)> {
    quadratic(ray, sphere, 0.0)
}

/// [`Form::NaiveOffset`].
pub(super) fn naive_offset(ray: &Ray, sphere: [f32; 4]) -> Option<(f32, Vec3)> {
    quadratic(ray, sphere, 1e-4)
}

fn quadratic(ray: &Ray, [x, y, z, radius]: [f32; 4], t_min: f32) -> Option<(f32, Vec3)> {
    let (origin, direction) = (Vec3::from(ray.origin), Vec3::from(ray.direction));
    let center = Vec3::new(x, y, z);
    let from_center = origin - center;
    let a = direction.dot(direction);
    let b = 2.0 * from_center.dot(direction);
    let c = from_center.dot(from_center) - radius * radius;
    let discriminant = b * b - 4.0 * a * c;
    let root = discriminant.sqrt();
    let roots = [(-b - root) / (2.0 * a), (-b + root) / (2.0 * a)];
    // Both roots are NaN if the discriminant is negative.
    let t = roots.into_iter().find(|t| *t > t_min)?;
    Some((t, (origin + direction * t - center) / radius))
}

/// [`Form::Good`].
pub(super) fn good(ray: &Ray, [x, y, z, radius]: [f32; 4]) -> Option<(f32, Vec3)> {
    let direction = Vec3::from(ray.direction);
    let to_center = Vec3::new(x, y, z) - Vec3::from(ray.origin);
    let a = direction.dot(direction);
    let middle = to_center.dot(direction) / a;
    let perpendicular = to_center - direction * middle;
    let chord2 = radius * radius - perpendicular.dot(perpendicular);
    let half = (chord2 / a).sqrt();
    // Both values are NaN if `chord2` is negative.
    let side = [-half, half].into_iter().find(|side| middle + side > 0.0)?;
    Some((middle + side, (direction * side - perpendicular) / radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [Intersect; 2] = [naive, good];
    const SPHERE: [f32; 4] = [1.0, 0.0, 0.0, 2.0];

    fn ray(origin: [f32; 3], direction: [f32; 3]) -> Ray {
        Ray { origin, direction }
    }

    #[test]
    fn easy_rays_are_decided_correctly() {
        for form in BOTH {
            let outside = ray([-5.0, 0.0, 0.0], [2.0, 0.0, 0.0]);
            assert_eq!(form(&outside, SPHERE), Some((2.0, Vec3::NEG_X)));
            let inside = ray([1.0, 0.0, 0.0], [0.0, 0.0, -0.5]);
            assert_eq!(form(&inside, SPHERE), Some((4.0, Vec3::NEG_Z)));
            assert_eq!(form(&ray([-5.0, 0.0, 0.0], [-1.0, 0.0, 0.0]), SPHERE), None);
            assert_eq!(form(&ray([-5.0, 2.5, 0.0], [1.0, 0.0, 0.0]), SPHERE), None);
        }
    }

    #[test]
    fn the_nearest_sphere_is_hit_and_the_first_of_equal_ones() {
        let spheres = [[9.0, 0.0, 0.0, 1.0], [4.0, 0.0, 0.0, 1.0], [4.0, 0.0, 0.0, 1.0]];
        let ray = ray([0.0; 3], [1.0, 0.0, 0.0]);
        for form in BOTH {
            assert_eq!(
                closest(form, &spheres, &ray).map(|hit| (hit.sphere, hit.t)),
                Some((1, 3.0))
            );
        }
        assert_eq!(closest(good, &[], &ray), None);
    }

    #[test]
    fn only_the_good_form_resolves_distant_spheres() {
        let distant = ray([1e6, 0.0, 0.0], [-1.0, 0.0, 0.0]);
        let missed = [0.0, 1.5, 0.0, 1.0];
        assert!(naive(&distant, missed).is_some() && good(&distant, missed).is_none());
    }

    #[test]
    fn the_offset_drops_close_hits() {
        let close = ray([-1.5, 0.0, 0.0], [1.0, 0.0, 0.0]);
        let small = [0.0, 0.0, 0.0, 1.0];
        assert!(naive_offset(&close, small).is_some());
        let closer = ray([-1.0 - 1e-5, 0.0, 0.0], [1.0, 0.0, 0.0]);
        assert!(naive(&closer, small).unwrap().0 < 1e-4);
        assert!(naive_offset(&closer, small).unwrap().0 > 1.0);
    }
}
