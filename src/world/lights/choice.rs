//! The choice of the light to sample.

use super::Lights;
use super::tree::{BRANCHES, Ball, FAR, Receiver, Tree};
use crate::sampling::Distribution;
use crate::scene::{LightChoice, Rgb};
use crate::spheres::Spheres;
use crate::world::environment::{Environment, luminance};
use std::f64::consts::PI;

/// How the light to sample is chosen, among emitters, points, suns and sky, in this order.
#[derive(Clone, Debug, Default)]
#[expect(clippy::large_enum_variant, reason = "a world has one of them")]
pub(super) enum Choice {
    /// None of them shines.
    #[default]
    None,
    /// There is but one.
    Lone,
    /// By what each gives to the receiver.
    Tree(Tree),
    /// The same everywhere.
    Table(Distribution),
}

impl Choice {
    /// The choice among these lights, with a unit of length, a power of two: where some lights fall
    /// off and others do not, it decides on which are the brightest.
    pub(super) fn new(lights: &[Ball], by: LightChoice, unit: f64) -> Self {
        let lights: Vec<Ball> = lights.iter().map(|light| light.scaled(unit.recip())).collect();
        let weights = |of: fn(&Ball) -> f64| lights.iter().map(of).collect::<Vec<_>>();
        let table = |weights: Vec<f64>| Distribution::new(&weights).map(Self::Table);
        let choice = match by {
            LightChoice::Tree => {
                Tree::new(&lights).map(|tree| Self::Tree(tree.scaled(unit as f32)))
            }
            LightChoice::Power => table(weights(Ball::whole)),
            LightChoice::Uniform => table(weights(|light| f64::from(u8::from(light.shines())))),
        };
        match choice {
            Some(_) if lights.len() == 1 => Self::Lone,
            Some(choice) => choice,
            None => Self::None,
        }
    }
}

impl Lights {
    /// Each light as the choice sees it.
    pub(super) fn balls(&self, spheres: &Spheres, sky: &Environment) -> Vec<Ball> {
        let far = FAR * self.unit;
        let power = |color: Rgb| f64::from(luminance(color));
        let dark = Ball::default();
        let emitters = self.emitters.iter().zip(&self.radiance).map(|(&row, &radiance)| {
            let center = spheres.center(row as usize).as_dvec3();
            let radius = f64::from(spheres.radius(row as usize));
            Ball {
                center,
                radius,
                power: power(radiance) * PI * radius * radius,
                hollow: true,
                ..dark
            }
        });
        let points = self.points.iter().map(|point| {
            let at = Ball { center: point.position, ..dark };
            match point.falloff {
                Some(scale) => Ball { power: power(point.intensity) * scale * scale, ..at },
                None => Ball { steady: power(point.intensity), ..at },
            }
        });
        let suns = self.suns.iter().map(|sun| {
            let height = sun.disc.map_or(0.0, |cone| f64::from(cone.height()));
            let radius = far * (height * (2.0 - height)).sqrt();
            let center = sun.direction.as_dvec3() * far;
            Ball { center, radius, steady: power(sun.irradiance), ..dark }
        });
        let sky = sky.picture().filter(|_| self.sky).map(|picture| {
            let irradiance = PI * f64::from(picture.mean_luminance());
            // From the middle of a ball a quarter arrives.
            Ball { radius: far, steady: 4.0 * irradiance, ..dark }
        });
        emitters.chain(points).chain(suns).chain(sky).collect()
    }

    /// Whether the choice depends on the receiver.
    pub fn by_receiver(&self) -> bool {
        matches!(self.choice, Choice::Tree(_))
    }

    /// Radii from its center within which a diffuse surface looks for an emissive sphere by its own
    /// sampling as well.
    ///
    /// Farther off the cone alone has the least variance. In the box of `scenes/smallpt.toml`, whose
    /// lamp is all close and nearly all hidden, the error at equal samples is 0.81 of what it is
    /// without (`spherule compare` of pictures of two seeds), and the same up to 1.6 radii. Where
    /// there are more lights than are told apart at a glance, the choice may miss what is next to a
    /// surface: with a third of 10 000 spheres glowing, variance times time is 0.7 of what it is
    /// without.
    pub(super) fn close_within(&self) -> f64 {
        if self.len() > BRANCHES { f64::INFINITY } else { 1.15 }
    }

    /// Chooses a light to sample, by a draw in [0, 1): its index and the probability of the choice.
    #[inline]
    pub fn choose(&self, at: &Receiver, draw: f64) -> Option<(usize, f32)> {
        match &self.choice {
            Choice::None => None,
            Choice::Lone => Some((0, 1.0)),
            Choice::Tree(tree) => Some(tree.choose(at, draw)),
            Choice::Table(table) => {
                let choice = table.sample(draw as f32);
                Some((choice.index, choice.pmf))
            }
        }
    }

    /// The probability that [`Lights::choose`] chooses light `index`.
    #[inline]
    pub(super) fn probability(&self, at: &Receiver, index: usize) -> f32 {
        match &self.choice {
            Choice::None => 0.0,
            Choice::Lone => 1.0,
            Choice::Tree(tree) => tree.probability(at, index),
            Choice::Table(table) => table.pmf(index),
        }
    }
}
