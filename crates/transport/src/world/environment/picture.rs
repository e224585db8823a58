//! Latitude-longitude pictures as lights.
//!
//! Radiance is bilinear between pixel centers. So the sphere of directions is divided into patches
//! between four neighboring centers, and the half patches at the poles. A sample chooses a patch by its
//! light, then a position in it by inverting a bilinear density: luminance times the sine of the polar
//! angle at the corners. Radiance over density is nearly constant then; only color varies, and what the
//! sine deviates from linear.
//!
//! A sun is a part of its own, with its own distribution, and the rest of the picture another: each patch
//! belongs to one of them. So the light tree chooses between them at each receiver.

use super::region::{Grid, Region};
use crate::elementary;
use crate::image::Image;
use crate::lanes::{Lanes, MAX_LANES, Mask, set_bits};
use crate::sampling::{Basis, Bilinear, CellRow, Distribution2d, sine_cosine, turns};
use crate::scene::Rgb;
use crate::vec3;
use crate::world::{DevicePicture, DeviceSkyPart};
use glam::{DMat3, DQuat, DVec3, Vec3};
use std::f64::consts::PI;
use std::sync::Arc;

/// Weights of the channels of linear sRGB in relative luminance (Rec. 709).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Peak bytes per patch of the distribution while it is built.
const PATCH_BYTES: u64 = 12;

/// Peak bytes per row of patches, in addition.
const ROW_BYTES: u64 = 128;

/// The least sine of a polar angle: the density stays finite at the poles.
const LEAST_SINE: f32 = 1e-18;

/// A latitude-longitude picture and the distributions of its light.
#[derive(Debug)]
pub struct Picture {
    image: Arc<Image>,
    scale: f32,
    /// The picture's axes in world space; its poles are on z.
    axes: Basis,
    /// By patch row, from the pole of +z to that of -z.
    rows: Box<[PatchRow]>,
    /// The sky without its sun, then the sun; as far as they are not black.
    parts: Vec<Part>,
}

/// A part of a picture that is sampled as a light of its own.
#[derive(Debug)]
struct Part {
    /// The patches, and some of those of later parts.
    region: Region,
    /// Proportional to the light of each patch of the part; 0 for those of later parts.
    distribution: Distribution2d,
    bounds: PartBounds,
}

/// A part of a picture as seen from anywhere.
#[derive(Clone, Copy, Debug)]
pub struct PartBounds {
    /// Integral of luminance over solid angle.
    pub light: f64,
    /// Unit vector toward the center, and the greatest distance of another direction of the part, at a
    /// distance of 1; `None` for light from everywhere.
    pub disc: Option<(DVec3, f64)>,
}

/// Constants of a row of patches: row `i` is between pixel rows `i - 1` and `i`.
#[derive(Clone, Copy, Debug)]
struct PatchRow {
    /// Sines of the polar angle at the ends, from the nearer pole for the rows at the poles.
    sines: [f32; 2],
    /// Reciprocal of a patch's area in longitude and latitude. Divided by the sine of the polar angle,
    /// the density by solid angle of directions that are uniform in the patch.
    density: f32,
}

/// Patches of the picture, in lanes.
#[derive(Clone, Copy, Debug)]
struct Patches {
    column: [u32; MAX_LANES],
    row: [u32; MAX_LANES],
}

/// Positions in patches, by longitude and latitude in 0..=1; in the rows at the poles, latitude is from
/// the pole.
type Position<L> = [L; 2];

/// Radiance at the corners of patches, by row and column.
type Corners<L> = [[vec3::Vec3<L>; 2]; 2];

/// Light of a picture in given directions, in lanes.
#[derive(Clone, Copy, Debug)]
pub struct SkyLight<L> {
    /// Radiance from these directions.
    pub radiance: vec3::Vec3<L>,
    /// Densities by solid angle with which [`Picture::sample`] of the part finds them.
    pub pdf: L,
    /// Parts of the picture; 0 for black patches.
    pub part: [u32; MAX_LANES],
}

/// Light samples of a picture, in lanes.
#[derive(Clone, Copy, Debug)]
pub struct SkySamples<L> {
    /// Unit vectors.
    pub direction: vec3::Vec3<L>,
    /// Radiance from these directions.
    pub radiance: vec3::Vec3<L>,
    /// Densities by solid angle; more than 0 and finite.
    pub pdf: L,
    /// Lanes that have a sample; the others have no light.
    pub lanes: u32,
}

impl Picture {
    /// Returns the peak bytes of the distribution of an image's light while it is built.
    pub(super) fn bytes(image: &Image) -> u64 {
        (u64::from(image.width) * PATCH_BYTES + ROW_BYTES) * (u64::from(image.height) + 1)
    }

    /// Creates the picture with its pole of +z in direction `up`, and turned about it by `rotation` in
    /// radians. Its middle column faces -x if up is z and there is no rotation.
    pub(super) fn new(image: Arc<Image>, up: DVec3, rotation: f64, scale: f32) -> Self {
        let (width, height) = (image.width as usize, image.height as usize);
        let turn =
            DQuat::from_rotation_arc(DVec3::Z, up) * elementary::rotation(DVec3::Z, rotation);
        let axes = DMat3::from_quat(turn).as_mat3();
        let rows: Box<[_]> = (0..=height).map(|row| PatchRow::new(row, width, height)).collect();
        let mut picture = Self {
            scale,
            // Columns run clockwise about the pole, so that from inside the picture is as painted.
            axes: Basis { tangent: axes.x_axis, bitangent: -axes.y_axis, normal: axes.z_axis },
            rows,
            parts: Vec::new(),
            image,
        };
        picture.parts = picture.divide();
        picture
    }

    /// Divides the picture into its sun and the rest.
    fn divide(&self) -> Vec<Part> {
        let (width, height) = (self.image.width as usize, self.rows.len());
        let light = |column, row| self.patch_light(column, row);
        let all = Region { column: 0, row: 0, width, height };
        let total: f64 = all.patches(width).map(|(column, row)| light(column, row)).sum();
        let solid_angle = |row: usize| self.rows[row].solid_angle();
        let grid = Grid { width, height, light: &light, solid_angle: &solid_angle };
        let sun = grid.sun(total);
        let rest = |column, row| match sun.and_then(|sun| sun.position(width, (column, row))) {
            Some(_) => 0.0,
            None => light(column, row),
        };
        let sun_light = |region: &Region, column, row| {
            light((region.column + column) % width, region.row + row)
        };
        let sun = sun.and_then(|region| {
            let weight = |column, row| sun_light(&region, column, row);
            let distribution = Distribution2d::new(region.width, region.height, weight)?;
            let light = region.patches(width).map(|(column, row)| light(column, row)).sum();
            let bounds = PartBounds { light, disc: Some(self.disc(&region)) };
            Some(Part { region, distribution, bounds })
        });
        let light = total - sun.as_ref().map_or(0.0, |sun| sun.bounds.light);
        let rest = Distribution2d::new(width, height, rest).map(|distribution| Part {
            region: all,
            distribution,
            bounds: PartBounds { light, disc: None },
        });
        rest.into_iter().chain(sun).collect()
    }

    /// Returns the disc that encloses the patches of a region, as in [`PartBounds`].
    fn disc(&self, region: &Region) -> (DVec3, f64) {
        let toward = |(column, row): (usize, usize), position: Position<f32>| {
            let patch = |number: usize| {
                let mut lanes = [0; MAX_LANES];
                lanes[0] = number as u32;
                lanes
            };
            let patches = Patches { column: patch(column), row: patch(row) };
            let (local, _) = self.direct(&patches, position);
            Vec3::from(self.axes.row_to_world(local)).as_dvec3()
        };
        let patches = || region.patches(self.image.width as usize);
        let weighted =
            |(column, row)| toward((column, row), [0.5; 2]) * self.patch_light(column, row);
        let sum: DVec3 = patches().map(weighted).sum();
        let center = sum.normalize_or(self.axes.normal.as_dvec3());
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let distance = |patch| corners.map(|corner| toward(patch, corner).distance(center));
        (center, patches().flat_map(distance).fold(0.0, f64::max))
    }

    /// Returns the picture for devices.
    pub(crate) fn for_devices(&self) -> DevicePicture {
        let part = |part: &Part| {
            let (rows, columns) = part.distribution.cumulative();
            let Region { column, row, width, height } = part.region;
            DeviceSkyPart {
                region: [column, row, width, height].map(|x| x as u32),
                rows: rows.to_vec(),
                columns: columns.map(<[f32]>::to_vec).collect(),
            }
        };
        let row = |row: &PatchRow| [row.sines[0], row.sines[1], row.density];
        DevicePicture {
            image: Arc::clone(&self.image),
            scale: self.scale,
            axes: self.axes,
            rows: self.rows.iter().map(row).collect(),
            parts: self.parts.iter().map(part).collect(),
        }
    }

    /// Returns the parts that are sampled as lights of their own: the sky without its sun, and the sun.
    pub fn parts(&self) -> impl Iterator<Item = PartBounds> {
        self.parts.iter().map(|part| part.bounds)
    }

    /// Whether all directions are black.
    pub fn is_black(&self) -> bool {
        self.parts.is_empty()
    }

    /// Returns the light of a patch: the integral of its density, before that is scaled to 1.
    fn patch_light(&self, column: usize, row: usize) -> f64 {
        let sines = self.rows[row].sines.map(f64::from);
        let means = self.corners(column, row).map(|[left, right]| {
            f64::from(luminance(Rgb::from(left))) + f64::from(luminance(Rgb::from(right)))
        });
        let sum = (means[0] * sines[0] + means[1] * sines[1]) * f64::from(self.scale);
        sum / (4.0 * f64::from(self.rows[row].density))
    }

    /// Returns the pixels at the corners of a patch, by row and column.
    #[inline(always)]
    fn corners(&self, column: usize, row: usize) -> [[[f32; 3]; 2]; 2] {
        let (width, height) = (self.image.width as usize, self.image.height as usize);
        let left = if column == 0 { width - 1 } else { column - 1 };
        let row_of = |row: usize| &self.image.pixels[row * width..(row + 1) * width];
        let (above, below) = (row_of(row.saturating_sub(1)), row_of(row.min(height - 1)));
        [[above[left], above[column]], [below[left], below[column]]]
    }

    /// Returns the radiance from unit direction `toward`, bilinear between pixel centers.
    pub(super) fn radiance(&self, toward: Vec3) -> Rgb {
        self.radiances::<f32>(toward.into(), 1).into()
    }

    /// Returns the radiance from the unit directions in `lanes`; anything in the other lanes.
    #[inline(always)]
    pub fn radiances<L: Lanes>(&self, toward: vec3::Vec3<L>, lanes: u32) -> vec3::Vec3<L> {
        let (patches, position, _) = self.locate(toward);
        interpolate(&self.gather(&patches, lanes), position)
    }

    /// Returns the light of the unit directions in `lanes`; anything in the other lanes.
    #[inline(always)]
    pub fn light<L: Lanes>(&self, toward: vec3::Vec3<L>, lanes: u32) -> SkyLight<L> {
        let (patches, position, sine) = self.locate(toward);
        let corners = self.gather(&patches, lanes);
        let (mut part, mut pmf) = ([0; MAX_LANES], [0.0; MAX_LANES]);
        for lane in set_bits(lanes) {
            let patch = (patches.column[lane] as usize, patches.row[lane] as usize);
            (part[lane], pmf[lane]) = self.part_of(patch);
        }
        let (shape, scale) = self.shape(&patches, &corners, lanes);
        let pdf = L::load(&pmf) * scale * shape.pdf(position) / sine;
        // The shape of a patch without light is undefined.
        let lit = L::splat(0.0).lt(pdf);
        SkyLight {
            radiance: interpolate(&corners, position),
            pdf: L::select(lit, pdf, L::splat(0.0)),
            part,
        }
    }

    /// Returns the part that a patch belongs to, and its probability in it.
    #[inline(always)]
    fn part_of(&self, patch: (usize, usize)) -> (u32, f32) {
        let width = self.image.width as usize;
        for (i, part) in self.parts.iter().enumerate().rev() {
            if let Some((column, row)) = part.region.position(width, patch) {
                return (i as u32, part.distribution.pmf(column, row));
            }
        }
        (0, 0.0)
    }

    /// Samples directions of a part of the picture in `lanes`, with a density in proportion to luminance,
    /// from two numbers in [0, 1) each.
    #[inline(always)]
    pub fn sample<L: Lanes>(&self, part: usize, u: [L; 2], lanes: u32) -> SkySamples<L> {
        let Part { region, distribution, .. } = &self.parts[part];
        let CellRow { mut column, mut row, pmf, remainder } = distribution.choose(u, lanes);
        for (column, row) in column.iter_mut().zip(&mut row) {
            *column += region.column as u32;
            *column -= if *column < self.image.width { 0 } else { self.image.width };
            *row += region.row as u32;
        }
        let patches = Patches { column, row };
        let corners = self.gather(&patches, lanes);
        let (shape, scale) = self.shape(&patches, &corners, lanes);
        let position = shape.sample(remainder);
        let (direction, sine) = self.direct(&patches, position);
        let pdf = pmf * scale * shape.pdf(position) / sine;
        let found = L::splat(0.0).lt(pdf) & pdf.lt(L::splat(f32::INFINITY));
        SkySamples {
            direction: self.axes.row_to_world(direction),
            radiance: interpolate(&corners, position),
            pdf,
            lanes: lanes & found.bits(),
        }
    }

    /// Gathers the radiance at the corners of patches; 0 in lanes that are not in `lanes`.
    #[inline(always)]
    fn gather<L: Lanes>(&self, patches: &Patches, lanes: u32) -> Corners<L> {
        let mut columns = [[[[0.0; MAX_LANES]; 3]; 2]; 2];
        for lane in set_bits(lanes) {
            let corners = self.corners(patches.column[lane] as usize, patches.row[lane] as usize);
            for (columns, pixels) in columns.iter_mut().zip(corners) {
                for (columns, pixel) in columns.iter_mut().zip(pixels) {
                    (columns[0][lane], columns[1][lane], columns[2][lane]) = pixel.into();
                }
            }
        }
        // Not `map`, whose closures might not be inlined.
        let scale = L::splat(self.scale);
        let load = |[r, g, b]: &[[f32; MAX_LANES]; 3]| {
            vec3::Vec3::new(L::load(r), L::load(g), L::load(b)) * scale
        };
        let [[a, b], [c, d]] = &columns;
        [[load(a), load(b)], [load(c), load(d)]]
    }

    /// Returns the densities in patches, before they are scaled: luminance times sine at the corners.
    /// Also returns the reciprocals of the patches' areas.
    #[inline(always)]
    fn shape<L: Lanes>(
        &self,
        patches: &Patches,
        corners: &Corners<L>,
        lanes: u32,
    ) -> (Bilinear<L>, L) {
        let (mut sines, mut density) = ([[0.0; MAX_LANES]; 2], [0.0; MAX_LANES]);
        for lane in set_bits(lanes) {
            let row = &self.rows[patches.row[lane] as usize];
            [sines[0][lane], sines[1][lane]] = row.sines;
            density[lane] = row.density;
        }
        let [red, green, blue] = LUMINANCE;
        let weights = vec3::Vec3::splat(red, green, blue);
        let (above, below) = (L::load(&sines[0]), L::load(&sines[1]));
        let [[a, b], [c, d]] = corners;
        let shape = Bilinear([
            [a.dot(weights) * above, b.dot(weights) * above],
            [c.dot(weights) * below, d.dot(weights) * below],
        ]);
        (shape, L::load(&density))
    }

    /// Returns the width and height in pixels.
    #[inline(always)]
    fn size<L: Lanes>(&self) -> [L; 2] {
        [L::splat(self.image.width as f32), L::splat(self.image.height as f32)]
    }

    /// Returns the unit directions of positions in the picture's axes, and the sines of their polar
    /// angles.
    #[inline(always)]
    fn direct<L: Lanes>(
        &self,
        patches: &Patches,
        [across, down]: Position<L>,
    ) -> (vec3::Vec3<L>, L) {
        let ([width, height], half) = (self.size::<L>(), L::splat(0.5));
        let (column, row) = (whole::<L>(&patches.column), whole::<L>(&patches.row));
        let at_pole = row.lt(half) | (height - half).lt(row);
        // In heights of pixels from the top, then from the nearer pole.
        let y = row - half + down;
        let lower = (height * half).lt(L::select(at_pole, row, y));
        let from_pole = L::select(lower, height - y, y);
        let from_pole = L::select(at_pole, down * half, from_pole).max(L::splat(LEAST_SINE));
        let (sine, cosine) = sine_cosine(from_pole / height * half);
        let (y, x) = sine_cosine((column - half + across) / width);
        (vec3::Vec3::new(sine * x, sine * y, L::select(lower, -cosine, cosine)), sine)
    }

    /// Returns the patches of unit directions, the positions in them, and the sines of the polar
    /// angles, more than 0.
    #[inline(always)]
    fn locate<L: Lanes>(&self, toward: vec3::Vec3<L>) -> (Patches, Position<L>, L) {
        let ([width, height], half) = (self.size::<L>(), L::splat(0.5));
        let local = self.axes.row_to_local(toward);
        let squared = local.x.mul_add(local.x, local.y * local.y);
        let sine = squared.max(L::splat(LEAST_SINE * LEAST_SINE)).sqrt();
        let x = turns(local.y, local.x).mul_add(width, half);
        let (left, mut column) = floor(x);
        for column in &mut column {
            *column = if *column < self.image.width { *column } else { 0 };
        }
        // In heights of pixels from the nearer pole, then from the top.
        let from_pole = turns(sine, local.z.abs()) * L::splat(2.0) * height;
        let (lower, at_pole) = (local.z.is_negative(), from_pole.le(half));
        let y = L::select(lower, height - from_pole, from_pole) + half;
        let above = floor(y).0.max(L::splat(1.0)).min(height - L::splat(1.0));
        let pole = L::select(lower, height, L::splat(0.0));
        let (_, row) = floor(L::select(at_pole, pole, above));
        let down = L::select(at_pole, from_pole * L::splat(2.0), y - above);
        (Patches { column, row }, [x - left, down.min(L::splat(1.0))], sine)
    }
}

impl PatchRow {
    fn new(row: usize, width: usize, height: usize) -> Self {
        // Of the center of a pixel row.
        let sine = |row: usize| sine_cosine((row as f32 + 0.5) / height as f32 * 0.5).0;
        let cells = (width * height) as f64 / (2.0 * PI * PI);
        if row == 0 || row == height {
            let density = (2.0 * cells) as f32;
            return Self { sines: [0.0, sine(row.min(height - 1))], density };
        }
        Self { sines: [sine(row - 1), sine(row)], density: cells as f32 }
    }

    /// Returns the solid angle of a patch.
    fn solid_angle(&self) -> f64 {
        let [above, below] = self.sines.map(f64::from);
        (above + below) / (2.0 * f64::from(self.density))
    }
}

/// Returns the radiance at positions in patches.
#[inline(always)]
fn interpolate<L: Lanes>(corners: &Corners<L>, position: Position<L>) -> vec3::Vec3<L> {
    let [[a, b], [c, d]] = corners;
    vec3::Vec3::new(
        Bilinear([[a.x, b.x], [c.x, d.x]]).at(position),
        Bilinear([[a.y, b.y], [c.y, d.y]]).at(position),
        Bilinear([[a.z, b.z], [c.z, d.z]]).at(position),
    )
}

/// Rounds numbers of 0 or more down.
#[inline(always)]
fn floor<L: Lanes>(x: L) -> (L, [u32; MAX_LANES]) {
    let mut row = [0.0; MAX_LANES];
    x.store(&mut row);
    let mut numbers = [0; MAX_LANES];
    numbers.iter_mut().zip(row).for_each(|(number, x)| *number = x as u32);
    (whole(&numbers), numbers)
}

/// Converts integers that single precision holds exactly.
#[inline(always)]
fn whole<L: Lanes>(numbers: &[u32; MAX_LANES]) -> L {
    let mut row = [0.0; MAX_LANES];
    row.iter_mut().zip(numbers).for_each(|(x, &number)| *x = number as f32);
    L::load(&row)
}

/// Returns the relative luminance of linear sRGB (Rec. 709).
pub(in crate::world) fn luminance(color: Rgb) -> f32 {
    color.dot(Vec3::from_array(LUMINANCE))
}

#[cfg(test)]
mod tests;
