//! What surfaces are made of, sixteen at a time.

use super::stages::{ByKind, by_kind};
use crate::lanes::{F32x16, MAX_LANES, U32x16, look_up};
use crate::ray::{GROUND, MISS};
use crate::shade::{Each, Material, Numbers};
use crate::world::{Kind, MaterialId, World};

/// What all surfaces of a world of few spheres are made of, where registers hold it.
///
/// It is looked up by the last four bits of what is hit: those of the ground and of nothing are
/// other places than those of so few spheres.
pub struct Looks {
    /// Numbers of bins.
    bins: U32x16,
    /// By kind, the numbers of materials.
    numbers: [Vec<U32x16>; Kind::COUNT],
}

/// The most spheres there may be.
const FEW: usize = GROUND as usize % MAX_LANES;

/// What is hit at a place.
fn hit_at(place: usize) -> u32 {
    match place {
        _ if place == GROUND as usize % MAX_LANES => GROUND,
        _ if place == MISS as usize % MAX_LANES => MISS,
        _ => place as u32,
    }
}

/// The material of what is hit, if there is any such thing.
fn material(world: &World, hit: u32) -> Option<MaterialId> {
    let there = match hit {
        GROUND => world.ground.is_some(),
        _ => (hit as usize) < world.spheres.len(),
    };
    there.then(|| world.material(hit))
}

impl Looks {
    /// None if there are too many spheres; `nothing` is the bin of what is not there.
    pub fn of(world: &World, nothing: usize) -> Option<Self> {
        if world.spheres.len() > FEW {
            return None;
        }
        let bin = |place| {
            let id = material(world, hit_at(place));
            id.map_or(nothing, |id| id.kind() as usize) as u32
        };
        let mut looks =
            Self { bins: U32x16::new(std::array::from_fn(bin)), numbers: Default::default() };
        by_kind(world, &mut Fill { world, looks: &mut looks });
        Some(looks)
    }

    /// The bins of what is hit.
    #[inline(always)]
    pub fn bins(&self, hits: U32x16) -> U32x16 {
        look_up(self.bins, hits)
    }
}

/// Fills in the numbers.
struct Fill<'a> {
    world: &'a World,
    looks: &'a mut Looks,
}

impl ByKind for Fill<'_> {
    fn visit<M: Material>(&mut self, kind: Kind, table: impl Fn(MaterialId) -> M) {
        let number = |i: usize, place: usize| {
            let hit = hit_at(place);
            let id = material(self.world, hit).filter(|id| id.kind() == kind);
            id.map_or(0.0, |_| surface(self.world, &table, hit).number(i))
        };
        self.looks.numbers[kind as usize] = (0..M::NUMBERS)
            .map(|i| U32x16::new(std::array::from_fn(|place| number(i, place).to_bits())))
            .collect();
    }
}

/// Numbers of materials that are looked up.
struct LookedUp<'a> {
    numbers: &'a [U32x16],
    hits: U32x16,
}

impl Numbers<F32x16> for LookedUp<'_> {
    #[inline(always)]
    fn row(&self, i: usize) -> F32x16 {
        bytemuck::cast(look_up(self.numbers[i], self.hits))
    }
}

/// The surfaces that are hit, all of one kind; `table` finds their materials.
#[inline(always)]
pub(super) fn surfaces<M: Material>(
    (world, looks): (&World, Option<&Looks>),
    (kind, table): (Kind, &impl Fn(MaterialId) -> M),
    hits: &[u32; MAX_LANES],
) -> M::Bsdf<F32x16> {
    if let Some(looks) = looks {
        let numbers = &looks.numbers[kind as usize];
        return M::row(&LookedUp { numbers, hits: U32x16::new(*hits) });
    }
    let mut each = [surface(world, table, hits[0]); MAX_LANES];
    for (each, &hit) in each.iter_mut().zip(hits).skip(1) {
        *each = surface(world, table, hit);
    }
    M::row(&Each(&each))
}

/// The surface that is hit; not a closure, which might be a call.
#[inline(always)]
fn surface<M: Material>(world: &World, table: &impl Fn(MaterialId) -> M, hit: u32) -> M {
    table(world.material(hit)).tinted(world.color(hit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::bins::ESCAPED;
    use crate::scene::generate::default_scene;

    #[test]
    fn what_is_looked_up_is_what_is_there() {
        let mut scene = default_scene(3);
        assert!(Looks::of(&World::build(&scene).unwrap(), ESCAPED).is_none());
        let keep: Vec<bool> = (0..scene.spheres.len()).map(|row| row < FEW).collect();
        scene.spheres.retain(&keep);
        let world = World::build(&scene).unwrap();
        let looks = Looks::of(&world, ESCAPED).unwrap();
        let hits: [u32; MAX_LANES] = std::array::from_fn(hit_at);
        let bins = looks.bins(U32x16::new(hits)).to_array();
        for (&hit, bin) in hits.iter().zip(bins) {
            let expected = material(&world, hit).map_or(ESCAPED, |id| id.kind() as usize);
            assert_eq!(bin as usize, expected);
        }
        by_kind(&world, &mut Compare { world: &world, looks: &looks });
    }

    /// Compares what is looked up with the tables.
    struct Compare<'a> {
        world: &'a World,
        looks: &'a Looks,
    }

    impl ByKind for Compare<'_> {
        fn visit<M: Material>(&mut self, kind: Kind, table: impl Fn(MaterialId) -> M) {
            let of_kind =
                |&hit: &u32| material(self.world, hit).is_some_and(|id| id.kind() == kind);
            for hit in (0..MAX_LANES).map(hit_at).filter(of_kind) {
                let hits = [hit; MAX_LANES];
                let numbers = &self.looks.numbers[kind as usize];
                let looked_up = LookedUp { numbers, hits: U32x16::new(hits) };
                let surface = table(self.world.material(hit)).tinted(self.world.color(hit));
                for i in 0..M::NUMBERS {
                    assert_eq!(looked_up.row(i).to_array(), [surface.number(i); MAX_LANES]);
                }
            }
        }
    }
}
