//! What can be sampled to find light: emissive spheres, points, suns and a picture of the sky.

mod choice;
mod disc;
mod discs;
mod grow;
mod point;
mod row;
mod sun;
mod tree;

pub use disc::Disc;
pub use point::Point;
pub use row::{LightRow, ROW, ReceiverRow};
pub use sun::Sun;
pub use tree::Receiver;

use super::appearance::Appearance;
use super::environment::{Environment, Picture};
use super::materials::{Kind, Materials};
use super::{Cut, Frame, World};
use crate::ray::MISS;
use crate::scene::{self, LightChoice, Rgb, Scene};
use crate::spheres::Spheres;
use choice::Choice;
use disc::toward_sphere;
use glam::Vec3;

/// The lights, each with a share of the samples: in proportion to what it would give to the point
/// that looks for light if nothing stood between, unless the settings say otherwise.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    /// Rows of emissive spheres, in the order of [`Spheres::key`]: what is sampled does not depend on
    /// the tree.
    pub emitters: Vec<u32>,
    /// What each of them emits.
    radiance: Vec<Rgb>,
    /// Points.
    pub points: Vec<Point>,
    /// Suns.
    pub suns: Vec<Sun>,
    /// Whether the environment is sampled as well, as the last light.
    pub sky: bool,
    choice: Choice,
    by: LightChoice,
    /// [`Frame::extent`].
    unit: f64,
    /// Radii from its center within which an emissive sphere is close.
    reach: f64,
}

/// Light that arrives from a direction, if nothing is in between.
#[derive(Clone, Copy, Debug)]
pub struct LightSample {
    /// Unit vector toward the light.
    pub direction: Vec3,
    /// Distance of the light; infinite for suns and sky.
    pub t: f64,
    /// The light's row if it is a sphere, which does not occlude itself; otherwise [`MISS`].
    pub target: u32,
    /// Radiance over density: what to multiply with the surface's response.
    pub weight: Rgb,
    /// Density by solid angle, without the choice of the light; `None` if the light has no extent.
    pub pdf: Option<f32>,
    /// Whether it is an emissive sphere, so near or one of so many that a diffuse surface should look
    /// for it too.
    pub close: bool,
}

/// A light as seen from a point, ready to be sampled any number of times.
pub enum Aim<'a> {
    /// An emissive sphere.
    Disc(Disc),
    /// Of no extent.
    Delta(LightSample),
    /// At infinity.
    Sun(&'a Sun),
    /// The environment's picture.
    Sky(&'a Picture),
}

/// A light in the order of the choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Light {
    Emitter(usize),
    Point(usize),
    Sun(usize),
    Sky,
}

impl Lights {
    pub(super) fn build(
        scene: &Scene,
        (frame, cut): (&Frame, &Cut),
        (spheres, appearance): (&Spheres, &Appearance),
        materials: &Materials,
        environment: &Environment,
    ) -> Self {
        let (emitters, radiance) = emitters((spheres, cut), appearance, materials);
        let (mut points, mut suns) = (Vec::new(), Vec::new());
        for light in &scene.lights {
            match *light {
                scene::Light::Point { position, intensity, falloff } => points.push(Point {
                    position: frame.point(position),
                    intensity,
                    falloff: falloff.then_some(frame.scale),
                }),
                scene::Light::Sun { direction, irradiance, angular_radius } => {
                    suns.push(Sun::new(direction, irradiance, angular_radius));
                }
            }
        }
        let sky = environment.illuminates && environment.picture().is_some();
        let (choice, by) = (Choice::None, scene.settings.light_choice);
        let unit = frame.extent();
        let mut lights =
            Self { emitters, radiance, points, suns, sky, by, choice, reach: 0.0, unit };
        lights.choice = Choice::new(&lights.balls(spheres, environment), by, unit);
        lights.reach = lights.close_within();
        lights
    }

    /// Those that are no spheres: the same where none is.
    pub(super) fn without_spheres(&self, environment: &Environment) -> Self {
        if self.emitters.is_empty() {
            return self.clone();
        }
        let (emitters, radiance) = (Vec::new(), Vec::new());
        let mut lights = Self { emitters, radiance, choice: Choice::None, ..self.clone() };
        let balls = lights.balls(&Spheres::default(), environment);
        lights.choice = Choice::new(&balls, self.by, self.unit);
        lights
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.emitters.len() + self.points.len() + self.suns.len() + usize::from(self.sky)
    }

    /// Whether there is nothing to sample, and so no shadow ray.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Whether light `index` has no extent, so that one shadow ray says all.
    pub fn is_delta(&self, index: usize) -> bool {
        match self.light(index) {
            Light::Point(_) => true,
            Light::Sun(i) => self.suns[i].disc.is_none(),
            Light::Emitter(_) | Light::Sky => false,
        }
    }

    /// The sun, if it is the only light: then there is nothing to choose, and it looks the same from
    /// everywhere.
    pub fn lone_sun(&self) -> Option<&Sun> {
        if self.len() == 1 { self.suns.first() } else { None }
    }

    fn light(&self, index: usize) -> Light {
        let (emitters, points) = (self.emitters.len(), self.points.len());
        if index < emitters {
            Light::Emitter(index)
        } else if index < emitters + points {
            Light::Point(index - emitters)
        } else if index < emitters + points + self.suns.len() {
            Light::Sun(index - emitters - points)
        } else {
            Light::Sky
        }
    }

    /// Light `index` as seen from a point of the surface of sphere `own`; `None` if the point is in
    /// or on the light: such light is found by the surface's own sampling.
    #[inline]
    pub fn aim<'a>(
        &'a self,
        world: &'a World,
        index: usize,
        (origin, own): (Vec3, u32),
    ) -> Option<Aim<'a>> {
        match self.light(index) {
            Light::Emitter(i) if self.emitters[i] == own => None,
            Light::Emitter(i) => {
                let row = self.emitters[i] as usize;
                let from = (origin, self.reach);
                Disc::new(&world.spheres, row, self.radiance[i], from).map(Aim::Disc)
            }
            Light::Point(i) => self.points[i].sample(origin).map(Aim::Delta),
            Light::Sun(i) => Some(Aim::Sun(&self.suns[i])),
            Light::Sky => world.environment.picture().map(Aim::Sky),
        }
    }

    /// One sample of light `index`: that of [`Lights::aim`], by the short way where there is one.
    #[inline(always)]
    pub fn sample(
        &self,
        world: &World,
        index: usize,
        from: (Vec3, u32),
        u: [f32; 2],
    ) -> Option<LightSample> {
        match self.light(index) {
            Light::Sun(i) => Some(self.suns[i].sample(u)),
            _ => self.aim(world, index, from)?.sample(u),
        }
    }

    /// Density with which `choose` and `sample` find emissive sphere `row`; 0 from in or on it,
    /// infinite if it is not close to a `diffuse` surface: then light samples alone count.
    pub fn emitter_pdf(&self, spheres: &Spheres, row: u32, at: &Receiver, diffuse: bool) -> f32 {
        let key = spheres.key(row as usize);
        let found = self.emitters.binary_search_by_key(&key, |&other| spheres.key(other as usize));
        let Some(index) = found.ok().filter(|&i| self.emitters[i] == row && row != at.own) else {
            return 0.0;
        };
        match toward_sphere(spheres, row as usize, (at.point, self.reach)) {
            Some((seen, _)) if diffuse && !seen.close => f32::INFINITY,
            Some((_, cone)) => self.probability(at, index) * cone.pdf(),
            None => 0.0,
        }
    }

    /// Density with which the environment's picture is sampled in unit direction `toward`.
    pub fn sky_pdf(&self, environment: &Environment, toward: Vec3, at: &Receiver) -> f32 {
        match environment.picture() {
            Some(picture) if self.sky => self.probability(at, self.len() - 1) * picture.pdf(toward),
            _ => 0.0,
        }
    }

    /// Whether there is a sun that can be seen.
    pub fn suns_have_discs(&self) -> bool {
        self.suns.iter().any(|sun| sun.disc.is_some())
    }

    /// Each sun that is seen in unit direction `toward`, and its radiance.
    pub fn suns_toward(&self, toward: Vec3) -> impl Iterator<Item = (usize, Rgb)> {
        self.suns.iter().enumerate().filter_map(move |(i, sun)| {
            let cone = sun.disc.as_ref()?;
            // 1 - cos from the chord, which does not cancel.
            let height = (toward - sun.direction).length_squared() / 2.0;
            (height <= cone.height()).then_some((i, sun.radiance))
        })
    }

    /// Density with which a direction toward sun `sun` is sampled.
    pub fn sun_pdf(&self, sun: usize, at: &Receiver) -> f32 {
        let index = self.emitters.len() + self.points.len() + sun;
        self.suns[sun].disc.map_or(0.0, |cone| self.probability(at, index) * cone.pdf())
    }
}

/// Rows and radiance of the spheres that emit and are whole: paths find the light of the others by
/// chance alone.
fn emitters(
    (spheres, cut): (&Spheres, &Cut),
    appearance: &Appearance,
    materials: &Materials,
) -> (Vec<u32>, Vec<Rgb>) {
    if materials.emitter.is_empty() {
        return Default::default();
    }
    let whole = |row: u32| {
        let (center, radius) = spheres.exact(row as usize);
        !cut.divides(center, radius)
    };
    let radiance = |row: u32| {
        let id = appearance.material.row(row as usize);
        (id.kind() == Kind::Emitter).then(|| materials.emitter[id.row()].radiance)
    };
    let emits = |row: u32| Some((row, radiance(row).filter(|&radiance| radiance != Rgb::ZERO)?));
    let emitters = (0..spheres.len() as u32).filter(|&row| emits(row).is_some() && whole(row));
    spheres.first_of_equals(emitters).into_iter().filter_map(emits).unzip()
}

impl Aim<'_> {
    /// Light from a point of the light, from two numbers in [0, 1); `None` if there is none from
    /// there.
    #[inline]
    pub fn sample(&self, u: [f32; 2]) -> Option<LightSample> {
        match self {
            Self::Disc(disc) => Some(disc.sample(u)),
            Self::Delta(sample) => Some(*sample),
            Self::Sun(sun) => Some(sun.sample(u)),
            Self::Sky(picture) => picture.sample(u).map(|sample| LightSample {
                direction: sample.direction,
                t: f64::INFINITY,
                target: MISS,
                weight: sample.radiance / sample.pdf,
                pdf: Some(sample.pdf),
                close: true,
            }),
        }
    }
}

#[cfg(test)]
mod tests;
