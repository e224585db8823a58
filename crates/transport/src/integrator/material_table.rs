//! Materials of hits, sixteen at a time: by table lookup in registers if the world has few spheres.

use crate::lanes::{F32x16, MAX_LANES, U32x16, look_up};
use crate::ray::{GROUND, MISS};
use crate::shade::{
    GatheredParams, KindVisitor, Material, MaterialId, MaterialKind, Params, floats,
};
use crate::world::World;
use bytemuck::Zeroable;

/// The materials of one kind: `table` returns them.
pub(super) struct MaterialsOfKind<T> {
    pub(super) kind: MaterialKind,
    pub(super) table: T,
}

/// The materials of all surfaces of a world of few spheres, in registers.
///
/// The index is the last four bits of a hit. [`GROUND`] and [`MISS`] have their own entries.
pub struct MaterialTable {
    /// Numbers of the material queues.
    queues: U32x16,
    /// By kind, the parameters of the materials.
    params: [Vec<U32x16>; MaterialKind::COUNT],
}

/// Most spheres of a world that has a table.
const MAX_SPHERES: usize = GROUND as usize % MAX_LANES;

/// Returns the hit of an entry.
fn hit_at(place: usize) -> u32 {
    match place {
        _ if place == GROUND as usize % MAX_LANES => GROUND,
        _ if place == MISS as usize % MAX_LANES => MISS,
        _ => place as u32,
    }
}

/// Returns the material of a hit, `None` if there is no such sphere or ground.
fn material(world: &World, hit: u32) -> Option<MaterialId> {
    let there = match hit {
        GROUND => world.ground.is_some(),
        _ => (hit as usize) < world.body_count(),
    };
    there.then(|| world.material(hit))
}

impl MaterialTable {
    /// Creates the table; `None` if there are too many spheres. `nothing` is the queue number of a
    /// miss.
    pub fn new(world: &World, nothing: usize) -> Option<Self> {
        if world.body_count() > MAX_SPHERES {
            return None;
        }
        let queue = |place| {
            let id = material(world, hit_at(place));
            id.map_or(nothing, |id| id.kind() as usize) as u32
        };
        let mut table =
            Self { queues: U32x16::new(std::array::from_fn(queue)), params: Default::default() };
        world.materials.for_each_kind(&mut Fill { world, table: &mut table });
        Some(table)
    }

    /// Returns the queue numbers of a row of hits.
    #[inline(always)]
    pub fn queues_of(&self, hits: U32x16) -> U32x16 {
        look_up(self.queues, hits)
    }
}

/// A visitor that fills in the parameters.
struct Fill<'a> {
    world: &'a World,
    table: &'a mut MaterialTable,
}

impl KindVisitor for Fill<'_> {
    fn visit<M: Material>(&mut self, kind: MaterialKind, table: impl Fn(MaterialId) -> M) {
        let params: [M::Params; MAX_LANES] = std::array::from_fn(|place| {
            let hit = hit_at(place);
            let id = material(self.world, hit).filter(|id| id.kind() == kind);
            id.map_or_else(Zeroable::zeroed, |_| params_of(self.world, &table, hit))
        });
        let column = |i: usize| params.each_ref().map(|params| floats(params)[i].to_bits());
        self.table.params[kind as usize] =
            (0..floats(&params[0]).len()).map(|i| U32x16::new(column(i))).collect();
    }
}

/// Parameters of a row of materials, looked up in the table.
struct TableParams<'a> {
    params: &'a [U32x16],
    hits: U32x16,
}

impl Params<F32x16> for TableParams<'_> {
    #[inline(always)]
    fn float(&self, offset: usize) -> F32x16 {
        bytemuck::cast(look_up(self.params[offset / size_of::<f32>()], self.hits))
    }
}

/// Returns the BSDFs of a row of hits, all of one kind, by `lookup` if there is such a table.
#[inline(always)]
pub(super) fn gather_bsdfs<M: Material>(
    world: &World,
    lookup: Option<&MaterialTable>,
    materials: &MaterialsOfKind<impl Fn(MaterialId) -> M>,
    hits: &[u32; MAX_LANES],
) -> M::Bsdf<F32x16> {
    let MaterialsOfKind { kind, table } = materials;
    if let Some(lookup) = lookup {
        let params = &lookup.params[*kind as usize];
        return M::row(&TableParams { params, hits: U32x16::new(*hits) });
    }
    let mut each = [params_of(world, table, hits[0]); MAX_LANES];
    for (each, &hit) in each.iter_mut().zip(hits).skip(1) {
        *each = params_of(world, table, hit);
    }
    M::row(&GatheredParams(each))
}

/// Returns the parameters of the BSDF at a hit; not a closure, which might not be inlined.
#[inline(always)]
fn params_of<M: Material>(world: &World, table: &impl Fn(MaterialId) -> M, hit: u32) -> M::Params {
    table(world.material(hit)).params(world.color(hit))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrator::material_queues::ESCAPED;
    use crate::scene::generate::default_scene;

    #[test]
    fn lookups_return_the_materials_of_hits() {
        let mut scene = default_scene(3);
        assert!(MaterialTable::new(&World::build(&scene).unwrap(), ESCAPED).is_none());
        let keep: Vec<bool> = (0..scene.spheres.len()).map(|row| row < MAX_SPHERES).collect();
        scene.spheres.retain(&keep);
        let world = World::build(&scene).unwrap();
        let table = MaterialTable::new(&world, ESCAPED).unwrap();
        let hits: [u32; MAX_LANES] = std::array::from_fn(hit_at);
        let queues = table.queues_of(U32x16::new(hits)).to_array();
        for (&hit, queue) in hits.iter().zip(queues) {
            let expected = material(&world, hit).map_or(ESCAPED, |id| id.kind() as usize);
            assert_eq!(queue as usize, expected);
        }
        world.materials.for_each_kind(&mut Compare { world: &world, table: &table });
    }

    /// A visitor that compares the lookups with the tables of materials.
    struct Compare<'a> {
        world: &'a World,
        table: &'a MaterialTable,
    }

    impl KindVisitor for Compare<'_> {
        fn visit<M: Material>(&mut self, kind: MaterialKind, table: impl Fn(MaterialId) -> M) {
            let of_kind =
                |&hit: &u32| material(self.world, hit).is_some_and(|id| id.kind() == kind);
            for hit in (0..MAX_LANES).map(hit_at).filter(of_kind) {
                let hits = [hit; MAX_LANES];
                let params = &self.table.params[kind as usize];
                let looked_up = TableParams { params, hits: U32x16::new(hits) };
                let params = params_of(self.world, &table, hit);
                for (i, &number) in floats(&params).iter().enumerate() {
                    let row = looked_up.float(i * size_of::<f32>());
                    assert_eq!(row.to_array(), [number; MAX_LANES]);
                }
            }
        }
    }
}
