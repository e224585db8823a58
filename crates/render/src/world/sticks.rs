//! The sticks of a scene in world space.

use super::appearance::{Colors, Column};
use super::{Appearance, Materials, Transform};
use crate::bvh::builders::Builder;
use crate::capsules::{Capsule, CapsuleItem, CapsuleRow, Capsules};
use crate::scene::{Rgb, Scene};
use crate::shade::MaterialKind;
use std::borrow::Cow;

/// Sticks in world space, with their tree.
#[derive(Clone, Debug, Default)]
pub struct WorldSticks {
    /// All sticks.
    pub all: Capsules,
    /// The sticks that the camera sees; `None` if slices hide none.
    pub visible: Option<VisibleSticks>,
}

/// The sticks that camera rays are tested against.
#[derive(Clone, Debug, Default)]
pub struct VisibleSticks {
    /// Sticks, in the order of their tree.
    pub capsules: Capsules,
    /// Their rows among all.
    pub row: Vec<u32>,
}

impl WorldSticks {
    /// Transforms the sticks that slices leave, and builds their tree.
    pub(super) fn build(scene: &Scene, transform: &Transform) -> Self {
        let sticks = &scene.sticks;
        let place = |row: usize| {
            let ends = sticks.ends(row).map(|end| transform.point(end).as_vec3());
            let radius = transform.length(sticks.radius[row]) as f32;
            CapsuleItem { ends, radius, id: row as u32 }
        };
        let rows: Vec<_> =
            scene.shown_sticks().map(place).filter(|item| item.radius > 0.0).collect();
        let all = Capsules::build(&rows, Builder::default());
        let hidden =
            |row: u32| scene.slices.iter().any(|slice| slice.hides(sticks.middle(row as usize)));
        let seen: Vec<_> = rows.iter().copied().filter(|item| !hidden(item.id)).collect();
        let visible = (seen.len() < rows.len()).then(|| {
            let capsules = Capsules::build(&seen, Builder::default());
            let mut of_id = vec![0; sticks.len()];
            for (row, &id) in all.ids().iter().enumerate() {
                of_id[id as usize] = row as u32;
            }
            let row = capsules.ids().iter().map(|&id| of_id[id as usize]).collect();
            VisibleSticks { capsules, row }
        });
        Self { all, visible }
    }

    /// Number of sticks.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Returns whether there is none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns the stick of a hit in a world of so many spheres, and which half of it is hit.
    #[inline(always)]
    pub(crate) fn at(&self, hit: u32, spheres: usize) -> Option<(Capsule, CapsuleRow)> {
        let row = CapsuleRow::of_hit(hit, spheres).filter(|_| !self.is_empty())?;
        Some((self.all.body(row.capsule), row))
    }

    /// Number of sticks of a kind of material.
    pub(super) fn count_of(
        &self,
        appearance: &Appearance,
        spheres: usize,
        kind: MaterialKind,
    ) -> u64 {
        let is_kind = |&stick: &usize| appearance.material.row(spheres + 2 * stick).kind() == kind;
        (0..self.len()).filter(is_kind).count() as u64
    }
}

/// Appends rows for the halves of sticks to the appearance of `spheres` spheres.
pub(super) fn append_appearance(
    appearance: &mut Appearance,
    scene: &Scene,
    materials: &Materials,
    sticks: &Capsules,
    spheres: usize,
) {
    if sticks.is_empty() {
        return;
    }
    let (ids, of) = (sticks.ids(), &scene.sticks);
    let material = |id: &u32| [materials.id(of.material[*id as usize]); 2];
    let first = materials.id(of.material[ids[0] as usize]);
    let same = ids.iter().flat_map(material).all(|id| id == first);
    let uniform = match &appearance.material {
        Column::Uniform(id) => spheres == 0 || *id == first,
        Column::Rows(rows) => rows.is_empty(),
    };
    appearance.material = if same && uniform {
        Column::Uniform(first)
    } else {
        let own = (0..spheres).map(|row| appearance.material.row(row));
        Column::Rows(own.chain(ids.iter().flat_map(material)).collect())
    };
    let color = |id: &u32| of.colors[*id as usize];
    if appearance.color.is_some() || !ids.iter().flat_map(color).all(|color| color == Rgb::ONE) {
        let own = (0..spheres).map(|row| match &appearance.color {
            Some(colors) => colors.row(row),
            None => Rgb::ONE,
        });
        let all: Vec<Rgb> = own.chain(ids.iter().flat_map(color)).collect();
        appearance.color = Some(Colors::new(Cow::Owned(all)));
    }
}
