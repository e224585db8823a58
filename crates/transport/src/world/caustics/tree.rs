//! The tree of specular spheres, from which one is chosen by its estimated contribution to a receiver.
//!
//! It has the structure of the light tree: a smooth sphere that an emitter illuminates is itself a light,
//! whose power is what it reflects and transmits.

use super::Caster;
use super::estimate::{ByPath, CasterNodes, EmitterView};
use crate::lanes::{F32x16, Lanes, Mask, first_lanes, set_bits};
use crate::ray::MISS;
use crate::vec3::Vec3;
use crate::world::lights::{BRANCHES, Chances, LightBounds, ROOT, Receiver, Siblings, Tree};

/// Specular spheres and clusters of them, in columns.
#[derive(Clone, Debug, Default)]
pub(super) struct CasterTree {
    /// Positions, children and parents.
    pub(super) nodes: Tree,
    pub(super) extent: Vec<f32>,
    pub(super) radius: Vec<f32>,
    pub(super) index: Vec<f32>,
    pub(super) reflected: Vec<f32>,
    pub(super) rise: Vec<f32>,
    pub(super) transmitted: Vec<f32>,
    /// Row of a leaf's sphere; [`MISS`] for clusters.
    pub(super) row: Vec<u32>,
}

/// Sums over the spheres of a node.
#[derive(Clone, Copy, Default)]
struct Sums {
    count: f64,
    radius2: f64,
    /// Of dielectrics.
    dielectric: f64,
    index: f64,
    reflected: f64,
    rise: f64,
    transmitted: f64,
}

impl Sums {
    fn add(&mut self, caster: &Caster) {
        let radius2 = caster.radius * caster.radius;
        let normal = caster.normal_reflectance;
        self.count += 1.0;
        self.radius2 += radius2;
        self.reflected += radius2 * normal;
        if caster.index > 0.0 {
            self.dielectric += radius2;
            self.index += radius2 * caster.index;
            self.rise += radius2 * (1.0 - normal);
        }
        if caster.clear {
            self.transmitted += radius2;
        }
    }

    /// Returns the mean index of refraction.
    fn index(&self) -> f64 {
        if self.dielectric > 0.0 { self.index / self.dielectric } else { 1.0 / 1.5 }
    }
}

/// Estimated contributions of sibling nodes.
pub(super) struct NodeChances {
    pub(super) each: ByPath<[f32; BRANCHES]>,
    /// Sums over the kinds of paths.
    pub(super) all: Chances,
}

impl CasterTree {
    /// Builds the tree of at least one sphere.
    pub(super) fn build(casters: &[Caster]) -> Self {
        let bounds = |caster: &Caster| {
            let mut sums = Sums::default();
            sums.add(caster);
            LightBounds {
                center: caster.center,
                radius: caster.radius,
                power: sums.reflected + sums.transmitted,
                ..LightBounds::default()
            }
        };
        let bounds: Vec<LightBounds> = casters.iter().map(bounds).collect();
        let Some(nodes) = Tree::new(&bounds) else { return Self::default() };
        let mut sums = vec![Sums::default(); nodes.child.len()];
        let mut row = vec![MISS; nodes.child.len()];
        for (caster, &leaf) in casters.iter().zip(&nodes.leaf) {
            let mut node = leaf;
            while node != ROOT {
                sums[node as usize].add(caster);
                node = nodes.parent[node as usize];
            }
            if leaf != ROOT {
                row[leaf as usize] = caster.row;
            }
        }
        let column = |of: &dyn Fn(usize, &Sums) -> f64| {
            let mut column: Vec<f32> =
                sums.iter().enumerate().map(|(node, sums)| of(node, sums) as f32).collect();
            column.extend([0.0; BRANCHES]);
            column
        };
        let radius = |sums: &Sums| (sums.radius2 / sums.count).sqrt();
        row.extend([MISS; BRANCHES]);
        Self {
            extent: column(&|node, sums| {
                let leaf = nodes.children[node] == 0;
                if leaf { 0.0 } else { (f64::from(nodes.radius[node]) - radius(sums)).max(0.0) }
            }),
            radius: column(&|_, sums| radius(sums)),
            index: column(&|_, sums| sums.index()),
            reflected: column(&|_, sums| sums.reflected),
            rise: column(&|_, sums| sums.rise),
            transmitted: column(&|_, sums| sums.transmitted),
            row,
            nodes,
        }
    }

    /// Returns the children of a node or [`ROOT`].
    #[inline(always)]
    pub(super) fn children(&self, node: u32) -> Siblings {
        self.nodes.below(node)
    }

    /// Returns the sphere of a leaf, as its index in the list that the tree was built from.
    #[inline(always)]
    pub(super) fn leaf(&self, node: usize) -> Option<usize> {
        (self.nodes.children[node] == 0).then(|| self.nodes.child[node] as usize)
    }

    /// Returns the nodes from the leaf of a sphere to a child of the root.
    pub(super) fn path_to_root(&self, caster: usize) -> impl Iterator<Item = u32> + '_ {
        let above = |&node: &u32| Some(self.nodes.parent[node as usize]).filter(|&up| up != ROOT);
        std::iter::successors(Some(self.nodes.leaf[caster]).filter(|&leaf| leaf != ROOT), above)
    }

    /// Returns the leaf of a sphere, as its index in the list that the tree was built from; [`ROOT`] if it has none.
    pub(super) fn leaf_of(&self, caster: usize) -> u32 {
        self.nodes.leaf.get(caster).copied().unwrap_or(ROOT)
    }

    /// Returns the number of the root's children.
    pub(super) fn top(&self) -> u32 {
        self.nodes.below(ROOT).count as u32
    }

    /// Returns the number of levels below the root.
    pub(super) fn levels(&self) -> usize {
        let levels = (0..self.nodes.leaf.len()).map(|caster| self.path_to_root(caster).count());
        levels.max().unwrap_or(0)
    }

    /// Returns the parent of a node, or [`ROOT`].
    pub(super) fn parent(&self, node: u32) -> u32 {
        self.nodes.parent[node as usize]
    }

    /// Estimates the contributions of nodes at a receiver. Estimates of clusters that contain the
    /// receiver are sums over their children.
    #[inline(always)]
    pub(super) fn chances(
        &self,
        nodes: Siblings,
        at: &Receiver,
        emitter: &EmitterView,
    ) -> NodeChances {
        let Siblings { first, count } = nodes;
        let (each, mut sum, vague) = self.estimates(nodes, at, emitter);
        for lane in set_bits(vague & first_lanes(count)) {
            sum[lane] = self.refined(self.children((first + lane) as u32), at, emitter);
        }
        NodeChances { all: Chances::new(F32x16::new(sum), count), each }
    }

    /// Returns the sum of the estimates of some nodes.
    fn refined(&self, nodes: Siblings, at: &Receiver, emitter: &EmitterView) -> f32 {
        let (_, mut sum, vague) = self.estimates(nodes, at, emitter);
        for lane in set_bits(vague & first_lanes(nodes.count)) {
            sum[lane] = self.refined(self.children((nodes.first + lane) as u32), at, emitter);
        }
        sum[..nodes.count].iter().sum()
    }

    /// Estimates the contributions of nodes at a receiver, by kind of path and in total; also returns the
    /// lanes of clusters that contain the receiver.
    #[inline(always)]
    fn estimates(
        &self,
        nodes: Siblings,
        at: &Receiver,
        emitter: &EmitterView,
    ) -> (ByPath<[f32; BRANCHES]>, [f32; BRANCHES], u32) {
        let Siblings { first, count } = nodes;
        let row = |column: &[f32]| F32x16::load(&column[first..]);
        let splat = |v: glam::Vec3| Vec3::splat(v.x, v.y, v.z);
        let nodes = CasterNodes {
            center: Vec3::new(row(&self.nodes.x), row(&self.nodes.y), row(&self.nodes.z)),
            extent: row(&self.extent),
            radius: row(&self.radius),
            index: row(&self.index),
            reflected: row(&self.reflected),
            rise: row(&self.rise),
            transmitted: row(&self.transmitted),
        };
        let found = nodes.contributions(splat(at.point), splat(at.normal), emitter);
        let [a, b, c, d] = found.paths;
        let mut sum = (a + b + (c + d)).to_array();
        // A sphere brings no light to itself.
        if let Some(own) = self.row[first..first + count].iter().position(|&row| row == at.own) {
            sum[own] = 0.0;
        }
        (found.paths.map(F32x16::to_array), sum, found.vague.bits())
    }
}
