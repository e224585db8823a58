//! The light sampler: chooses the light to sample.

use super::Lights;
use super::tree::{AllAround, BRANCHES, FAR, LightBounds, OneSided, Receiver, Tree};
use crate::sampling::Distribution;
use crate::scene::{LightChoice, Rgb};
use crate::spheres::Spheres;
use crate::world::environment::{Environment, Picture, luminance};
use std::f64::consts::PI;

/// A strategy for choosing a light among emitters, points, suns and sky, in this order.
#[derive(Clone, Debug, Default)]
#[expect(clippy::large_enum_variant, reason = "a world has one of them")]
pub(in crate::world) enum LightSampler {
    /// No light is luminous.
    #[default]
    None,
    /// There is only one light.
    Single,
    /// In proportion to the estimated contribution at the receiver.
    Tree(Tree),
    /// With the same probabilities everywhere.
    Table(Distribution),
}

impl LightSampler {
    /// Creates the sampler of these lights, with a unit of length, a power of two. If some lights fall
    /// off and others do not, the unit decides which are the brightest.
    pub(in crate::world) fn new(lights: &[LightBounds], by: LightChoice, unit: f64) -> Self {
        let lights: Vec<LightBounds> =
            lights.iter().map(|light| light.scaled(unit.recip())).collect();
        let weights = |of: fn(&LightBounds) -> f64| lights.iter().map(of).collect::<Vec<_>>();
        let table = |weights: Vec<f64>| Distribution::new(&weights).map(Self::Table);
        let choice = match by {
            LightChoice::Tree => {
                Tree::new(&lights).map(|tree| Self::Tree(tree.scaled(unit as f32)))
            }
            LightChoice::Power => table(weights(LightBounds::total)),
            LightChoice::Uniform => {
                table(weights(|light| f64::from(u8::from(light.is_luminous()))))
            }
        };
        match choice {
            Some(_) if lights.len() == 1 => Self::Single,
            Some(choice) => choice,
            None => Self::None,
        }
    }

    /// Chooses a light by a random number in [0, 1), in proportion to the light that reaches a point
    /// from any side: its index, the probability of the choice, and the place of the number in the
    /// light's share.
    #[inline]
    pub(in crate::world) fn choose_around(&self, at: &Receiver, draw: f64) -> (usize, f32, f64) {
        match self {
            Self::Tree(tree) => tree.choose::<AllAround>(at, draw),
            _ => (0, 1.0, draw),
        }
    }

    /// Returns the probability with which [`LightSampler::choose_around`] chooses a light.
    #[inline]
    pub(in crate::world) fn probability_around(&self, at: &Receiver, light: usize) -> f32 {
        match self {
            Self::Tree(tree) => tree.probability::<AllAround>(at, light),
            _ => 1.0,
        }
    }
}

impl Lights {
    /// Returns the bounds of each light.
    pub(in crate::world) fn light_bounds(
        &self,
        spheres: &Spheres,
        sky: &Environment,
    ) -> Vec<LightBounds> {
        let far = FAR * self.unit;
        let power = |color: Rgb| f64::from(luminance(color));
        let dark = LightBounds::default();
        let emitters = self.emitters.iter().zip(&self.radiance).map(|(&row, &radiance)| {
            let center = spheres.center(row as usize).as_dvec3();
            let radius = f64::from(spheres.radius(row as usize));
            LightBounds {
                center,
                radius,
                power: power(radiance) * PI * radius * radius,
                hollow: true,
                ..dark
            }
        });
        let points = self.points.iter().map(|point| {
            let at = LightBounds { center: point.position, ..dark };
            match point.falloff {
                Some(scale) => LightBounds { power: power(point.intensity) * scale * scale, ..at },
                None => LightBounds { steady: power(point.intensity), ..at },
            }
        });
        let suns = self.suns.iter().map(|sun| {
            let height = sun.disc.map_or(0.0, |cone| f64::from(cone.height()));
            let radius = far * (height * (2.0 - height)).sqrt();
            let center = sun.direction.as_dvec3() * far;
            LightBounds { center, radius, steady: power(sun.irradiance), ..dark }
        });
        let parts =
            sky.picture().filter(|_| self.sky_parts > 0).into_iter().flat_map(Picture::parts);
        let sky = parts.map(|part| match part.disc {
            Some((direction, radius)) => {
                let (center, radius) = (direction * far, radius * far);
                LightBounds { center, radius, steady: part.light, ..dark }
            }
            // A quarter of the light arrives on a plane; the tree's estimate within the enclosing sphere is
            // half of this. More light samples would be in vain: BSDF samples find the sky as well.
            None => LightBounds { radius: far, steady: part.light / 2.0, ..dark },
        });
        emitters.chain(points).chain(suns).chain(sky).collect()
    }

    /// Returns whether the choice depends on the receiver.
    pub fn by_receiver(&self) -> bool {
        matches!(self.sampler, LightSampler::Tree(_))
    }

    /// Returns the distance from its center, in radii, within which a diffuse surface finds an emissive
    /// sphere by BSDF samples as well.
    ///
    /// At larger distances, light samples alone have the least variance. In the box of
    /// `scenes/smallpt.toml`, whose emitter is close and nearly all occluded, the error at equal
    /// samples is 0.81 of that without BSDF samples (`spherule compare` of images of two seeds), and
    /// the same up to 1.6 radii. If there are more lights than one node has branches, the choice may
    /// miss an emitter next to a surface: with a third of 10 000 spheres glowing, variance times time
    /// is 0.7 of that without.
    pub(super) fn close_within(&self) -> f64 {
        if self.len() > BRANCHES { f64::INFINITY } else { 1.15 }
    }

    /// Chooses a light to sample, by a random number in [0, 1): its index and the probability of the
    /// choice.
    #[inline]
    pub fn choose(&self, at: &Receiver, draw: f64) -> Option<(usize, f32)> {
        match &self.sampler {
            LightSampler::None => None,
            LightSampler::Single => Some((0, 1.0)),
            LightSampler::Tree(tree) => {
                let (light, probability, _) = tree.choose::<OneSided>(at, draw);
                Some((light, probability))
            }
            LightSampler::Table(table) => {
                let choice = table.sample(draw as f32);
                Some((choice.index, choice.pmf))
            }
        }
    }

    /// Returns the probability with which [`Lights::choose`] chooses light `index`.
    #[inline]
    pub(super) fn probability(&self, at: &Receiver, index: usize) -> f32 {
        match &self.sampler {
            LightSampler::None => 0.0,
            LightSampler::Single => 1.0,
            LightSampler::Tree(tree) => tree.probability::<OneSided>(at, index),
            LightSampler::Table(table) => table.pmf(index),
        }
    }
}
