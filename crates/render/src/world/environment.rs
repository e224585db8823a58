//! The environment: radiance of rays that hit nothing.

use crate::sampling::{Distribution2d, ONE_BELOW};
use crate::scene::{self, EnvironmentMap, Rgb};
use glam::{DQuat, DVec3, Mat3, Vec3};
use std::f32::consts::{PI, TAU};
use std::sync::Arc;

/// The environment: radiance by direction, and whether it lights the scene.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Radiance by direction.
    pub radiance: Radiance,
    /// True if it lights diffuse surfaces: otherwise it is a backdrop for the camera, mirrors and
    /// glass.
    pub illuminates: bool,
}

/// Radiance by direction.
#[derive(Clone, Debug)]
pub enum Radiance {
    /// The same everywhere.
    Constant(Rgb),
    /// Linear in the cosine of the angle to `up`.
    Gradient {
        /// Mean of bottom and top.
        middle: Rgb,
        /// Half of top minus bottom.
        slope: Rgb,
        /// Unit vector.
        up: Vec3,
    },
    /// A latitude-longitude picture.
    Picture(Arc<Picture>),
}

/// A latitude-longitude picture and the distribution of its light.
#[derive(Debug)]
pub struct Picture {
    image: Arc<crate::image::Image>,
    scale: f32,
    /// Rotation from world space to the picture's, whose axis is z.
    from_world: Mat3,
    to_world: Mat3,
    /// Proportional to luminance times the row's sine; `None` if all is black.
    distribution: Option<Distribution2d>,
    mean_luminance: f32,
}

/// Peak bytes per pixel of the light distribution while it is built.
const PIXEL_BYTES: u64 = 20;

impl Environment {
    /// Returns the peak bytes of the environment while it is built, without the picture itself.
    pub(super) fn bytes(scene: &scene::Environment) -> u64 {
        match &scene.map {
            EnvironmentMap::Picture { image, .. } => image.pixels.len() as u64 * PIXEL_BYTES,
            EnvironmentMap::Constant(_) | EnvironmentMap::Gradient { .. } => 0,
        }
    }

    pub(super) fn build(scene: &scene::Environment) -> Self {
        let radiance = match &scene.map {
            EnvironmentMap::Constant(color) => Radiance::Constant(*color),
            EnvironmentMap::Gradient { bottom, top, up } => Radiance::Gradient {
                middle: (*bottom + *top) / 2.0,
                slope: (*top - *bottom) / 2.0,
                up: up.as_vec3(),
            },
            EnvironmentMap::Picture { image, up, rotation, scale } => Radiance::Picture(Arc::new(
                Picture::new(image.clone(), *up, rotation.to_radians(), *scale),
            )),
        };
        Self { radiance, illuminates: scene.illuminates }
    }

    /// Returns the radiance from unit direction `toward`.
    #[inline]
    pub fn radiance(&self, toward: Vec3) -> Rgb {
        match &self.radiance {
            Radiance::Constant(color) => *color,
            // Not below 0 if rounding makes the cosine greater than 1.
            Radiance::Gradient { middle, slope, up } => {
                (*middle + *slope * up.dot(toward)).max(Rgb::ZERO)
            }
            Radiance::Picture(picture) => picture.radiance(toward),
        }
    }

    /// Returns the radiance of all directions, if it is the same.
    pub fn constant(&self) -> Option<Rgb> {
        match &self.radiance {
            Radiance::Constant(color) => Some(*color),
            _ => None,
        }
    }

    /// Returns whether all directions are black.
    pub fn is_black(&self) -> bool {
        match &self.radiance {
            Radiance::Constant(color) => *color == Rgb::ZERO,
            Radiance::Gradient { middle, slope, .. } => *middle == Rgb::ZERO && *slope == Rgb::ZERO,
            Radiance::Picture(picture) => picture.distribution.is_none(),
        }
    }

    /// Returns the picture, if it is worth sampling: for a constant or a gradient, BSDF sampling
    /// suffices, with half as many rays.
    pub fn picture(&self) -> Option<&Picture> {
        match &self.radiance {
            Radiance::Picture(picture) if picture.distribution.is_some() => Some(picture),
            _ => None,
        }
    }
}

/// A light sample of the environment.
#[derive(Clone, Copy, Debug)]
pub struct SkySample {
    /// Unit vector.
    pub direction: Vec3,
    /// Radiance from this direction.
    pub radiance: Rgb,
    /// Density by solid angle; more than 0.
    pub pdf: f32,
}

impl Picture {
    fn new(image: Arc<crate::image::Image>, up: DVec3, rotation: f64, scale: f32) -> Self {
        let (width, height) = (image.width as usize, image.height as usize);
        let sine = |row: usize| (std::f64::consts::PI * (row as f64 + 0.5) / height as f64).sin();
        let luminances: Vec<_> =
            image.pixels.iter().map(|&pixel| f64::from(luminance(Rgb::from(pixel)))).collect();
        let weight =
            |column, row| mean_in_cell(&luminances, (width, height), (column, row)) * sine(row);
        let sum: f64 = (0..width * height).map(|i| weight(i % width, i / width)).sum();
        let sines: f64 = (0..height).map(sine).sum::<f64>() * width as f64;
        let distribution = Distribution2d::new(width, height, weight).filter(|_| scale > 0.0);
        // The picture's axis is z, and its middle column faces -y where up is z.
        let turn = DQuat::from_rotation_arc(DVec3::Z, up) * DQuat::from_rotation_z(rotation);
        let to_world = glam::DMat3::from_quat(turn).as_mat3();
        Self {
            scale,
            from_world: to_world.transpose(),
            to_world,
            distribution,
            mean_luminance: scale * (sum / sines) as f32,
            image,
        }
    }

    /// Returns the mean luminance over the sphere of directions.
    pub fn mean_luminance(&self) -> f32 {
        self.mean_luminance
    }

    /// Returns the radiance from unit direction `toward`, bilinear between pixel centers.
    fn radiance(&self, toward: Vec3) -> Rgb {
        let (u, v) = to_square(self.from_world * toward);
        let (width, height) = (self.image.width as usize, self.image.height as usize);
        let x = u * width as f32 - 0.5;
        let y = (v * height as f32 - 0.5).clamp(0.0, (height - 1) as f32);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let column = |dx: usize| (x.floor() as i64 + dx as i64).rem_euclid(width as i64) as usize;
        let row = |dy: usize| (y.floor() as usize + dy).min(height - 1);
        let pixel = |dx, dy| Rgb::from(self.image.pixels[row(dy) * width + column(dx)]);
        let top = pixel(0, 0).lerp(pixel(1, 0), fx);
        let bottom = pixel(0, 1).lerp(pixel(1, 1), fx);
        top.lerp(bottom, fy) * self.scale
    }

    /// Samples a direction with a density proportional to the picture's luminance.
    pub fn sample(&self, u: [f32; 2]) -> Option<SkySample> {
        let ([x, y], density) = self.distribution.as_ref()?.sample(u);
        let (sin, cos) = (PI * y).sin_cos();
        let (sin_phi, cos_phi) = (TAU * x).sin_cos();
        let direction = self.to_world * Vec3::new(sin * cos_phi, sin * sin_phi, cos);
        let pdf = density / (2.0 * PI * PI * sin);
        (pdf > 0.0 && pdf.is_finite()).then(|| SkySample {
            direction,
            radiance: self.radiance(direction),
            pdf,
        })
    }

    /// Returns the density of [`Picture::sample`] at unit direction `toward`, by solid angle.
    pub fn pdf(&self, toward: Vec3) -> f32 {
        let local = self.from_world * toward;
        let (u, v) = to_square(local);
        let sin = (PI * v).sin();
        match &self.distribution {
            Some(distribution) if sin > 0.0 => distribution.pdf([u, v]) / (2.0 * PI * PI * sin),
            _ => 0.0,
        }
    }
}

/// Returns the mean of the bilinear interpolation over the cell of a pixel: the pixel and its eight
/// neighbors, weighted 1 : 6 : 1 along each axis. So no cell is black that the light of a neighbor
/// reaches.
fn mean_in_cell(
    luminances: &[f64],
    (width, height): (usize, usize),
    (column, row): (usize, usize),
) -> f64 {
    let columns = [(column + width - 1) % width, column, (column + 1) % width];
    let rows = [row.saturating_sub(1), row, (row + 1).min(height - 1)];
    let across = |row: usize| {
        let [left, middle, right] = columns.map(|column| luminances[row * width + column]);
        (left + 6.0 * middle + right) / 8.0
    };
    let [above, here, below] = rows.map(across);
    (above + 6.0 * here + below) / 8.0
}

/// Maps a unit vector to longitude and latitude, each in 0..1.
fn to_square(d: Vec3) -> (f32, f32) {
    let u = d.y.atan2(d.x) / TAU;
    let v = d.x.hypot(d.y).atan2(d.z) / PI;
    ((if u < 0.0 { u + 1.0 } else { u }).min(ONE_BELOW), v.min(ONE_BELOW))
}

/// Returns the relative luminance of linear sRGB (Rec. 709).
pub(super) fn luminance(color: Rgb) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests;
