//! Which way of light to look for from a point, if any: by about what each would give there.
//!
//! Everything here is a guess in few operations, made for every diffuse point: it decides on the
//! noise, not on the light.

use super::link::Way;
use super::{Casters, Pair};
use crate::lanes::{F32x16, Lanes, MAX_LANES, Mask};
use crate::vec3::Vec3;

/// How likely a way is looked for that gives as much light as reaches the ball: what pays best in the
/// pictures of `tools/references`, and hardly matters up to four times as much.
const EAGER: f64 = 0.5;

/// Least rate at which rays part that counts: a focus is not sharper than that.
const LEAST_RATE: f32 = 0.2;

/// What the guess knows of a pair.
#[derive(Clone, Debug, Default)]
pub(super) struct Guess {
    center: glam::Vec3,
    radius: f32,
    /// Unit vector from the ball to the lamp.
    axis: glam::Vec3,
    /// Radius of the ball over the distance of the lamp.
    near_lamp: f32,
    /// Squared angular radius of the lamp.
    lamp2: f32,
    index: f32,
    clear: bool,
    /// Share of the light that glass reflects of a ray along the normal.
    mirrored: f32,
    /// What irradiance is multiplied with, and what it then is at most.
    eager: f32,
    most: f32,
}

impl Pair {
    /// Knows what share its lamp has of the light that reaches the ball, and how many ways there are
    /// by all balls.
    pub(super) fn guessing(self, share: f64, ways: usize) -> Self {
        let far = self.offset.length();
        let index = self.index;
        let guess = Guess {
            center: self.center.as_vec3(),
            radius: self.radius as f32,
            axis: (self.offset / far).as_vec3(),
            near_lamp: (self.radius / far) as f32,
            lamp2: (self.lamp_radius / far).powi(2) as f32,
            index: index as f32,
            clear: self.clear,
            mirrored: ((1.0 - index) / (1.0 + index)).powi(2) as f32,
            eager: (EAGER * share) as f32,
            most: (share / ways as f64) as f32,
        };
        Self { guess, ..self }
    }
}

/// A row of choices.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chosen {
    /// Number of the pair, times [`Way::COUNT`], plus that of the way.
    pub(crate) code: [u32; MAX_LANES],
    /// How likely they are chosen.
    pub(crate) probability: F32x16,
    /// Lanes in which one was.
    pub(crate) lanes: u32,
}

impl Casters {
    /// Chooses for points on surfaces of these normals, by numbers in [0, 1).
    #[inline(always)]
    pub(crate) fn choose(&self, point: Vec3<F32x16>, normal: Vec3<F32x16>, draw: F32x16) -> Chosen {
        let zero = F32x16::splat(0.0);
        let (mut sum, mut probability, mut code) = (zero, zero, zero);
        let mut open = Lanes::le(zero, draw);
        for (number, pair) in self.pairs.iter().enumerate() {
            let chances = pair.guess.chances(point, normal);
            for (chance, way) in chances.into_iter().zip(pair.ways()) {
                sum += chance;
                let here = open & Lanes::lt(draw, sum);
                probability = Lanes::select(here, chance, probability);
                let this = number as u32 * Way::COUNT + *way as u32;
                code = Lanes::select(here, F32x16::splat(this as f32), code);
                open = open & !here;
            }
        }
        let code = code.to_array().map(|code| code as u32);
        Chosen { code, probability, lanes: (!open).bits() }
    }

    /// How likely [`Casters::choose`] chooses a way of a pair.
    pub(super) fn probability(
        &self,
        pair: usize,
        way: Way,
        [point, normal]: [glam::Vec3; 2],
    ) -> f32 {
        self.pairs[pair].guess.chances::<f32>(point.into(), normal.into())[way as usize]
    }
}

impl Guess {
    /// How likely each way is to be chosen: about the irradiance that it brings if nothing is in
    /// between, by that of the ball, and some times that.
    #[inline(always)]
    fn chances<L: Lanes>(&self, point: Vec3<L>, normal: Vec3<L>) -> [L; Way::COUNT as usize] {
        let splat = |v: glam::Vec3| Vec3::<L>::splat(v.x, v.y, v.z);
        let (zero, one, two) = (L::splat(0.0), L::splat(1.0), L::splat(2.0));
        let toward = splat(self.center) - point;
        let inverse = one / toward.dot(toward).sqrt();
        let near = L::splat(self.radius) * inverse;
        let above = (normal.dot(toward) * inverse + near).min(one).max(zero);
        let level = L::select(near.lt(one), above * near * near * L::splat(self.eager), zero);
        let most = L::splat(self.most);
        // Cosine of the angle at the ball between the point and the lamp.
        let between = -(toward.dot(splat(self.axis)) * inverse);
        let ends = near + L::splat(self.near_lamp);
        let facing = (one + between) * L::splat(0.5);
        let rate = two - ends * facing;
        let reflected = level / (rate * rate);
        if self.index == 0.0 {
            let seen = (near * L::splat(0.5) - one).lt(between);
            return [L::select(seen, reflected.min(most), zero), zero, zero, zero];
        }
        let rise = one - facing;
        let mirrored =
            L::splat(self.mirrored) + L::splat(1.0 - self.mirrored) * (rise * rise * rise);
        let reflected = (reflected * mirrored).min(most);
        if !self.clear {
            return [reflected, zero, zero, zero];
        }
        let through = self.through((between, ends), level).map(|chance| chance.min(most));
        [reflected, through[0], through[1], through[2]]
    }

    /// The same of the ways through glass.
    #[inline(always)]
    fn through<L: Lanes>(&self, (between, ends): (L, L), level: L) -> [L; 3] {
        let (zero, least) = (L::splat(0.0), L::splat(LEAST_RATE));
        // How fast rays part that are next to the axis: at a focus between both points, not at all.
        let straight = L::splat(2.0 - 2.0 * self.index);
        let rate = straight - ends;
        let beyond = zero.lt(rate);
        let edge = 2.0 * self.index * self.index - 1.0;
        let beam = ((-between - L::splat(edge)) * L::splat(1.0 / (1.0 - edge))).max(zero);
        let parting = L::select(beyond, rate.max(least), straight);
        let crossed = level * (beam * beam * beam) / (parting * parting);
        // On this side of the focus, the least turn is about so much.
        let depth = (-rate).max(zero);
        let bend = 0.7 + 2.0 * self.index * (1.0 - self.index * self.index);
        let least_turn2 = depth * depth * depth * L::splat(6.0 * 4.0 / 27.0 / bend);
        let reach = least_turn2 + L::splat(self.lamp2);
        let within = (L::splat(1.0) + between).lt(reach) & zero.lt(depth);
        let parting = depth.max(least);
        let paraxial = L::select(within, level / (parting * parting), zero);
        [crossed, paraxial, paraxial * L::splat(0.5)]
    }
}
