//! Specular spheres and emitters as devices get them.

use super::estimate::EmitterView;
use super::tree::CasterTree;
use super::{CausticCasters, CausticEmitter, CausticSource};
use crate::world::device_tables::MAX_CASTER_LEVELS;
use crate::world::{DeviceCaster, DeviceCasterNode, DeviceCaustics, DeviceEmitter};
use glam::Vec3;

impl CausticCasters {
    /// Returns whether the tree has more levels than devices keep.
    pub(crate) fn is_deep(&self) -> bool {
        self.tree.levels() > MAX_CASTER_LEVELS
    }

    /// Returns the specular spheres and emitters for devices.
    pub(crate) fn for_devices(&self) -> DeviceCaustics {
        let caster = |(index, caster): (usize, &super::Caster)| DeviceCaster {
            sphere: caster.row,
            index: caster.index,
            leaf: self.tree.leaf_of(index),
        };
        let (low, cells_per_length, cells, bounds) = self.bounds.for_devices();
        DeviceCaustics {
            sampled: self.has_pairs(),
            casters: self.casters.iter().enumerate().map(caster).collect(),
            nodes: self.tree.for_devices(),
            top: self.tree.top(),
            emitters: self.emitters.iter().map(CausticEmitter::for_devices).collect(),
            choice: self.emitter_sampler.for_devices(),
            low,
            cells_per_length,
            cells,
            bounds: bounds.to_vec(),
        }
    }
}

impl CausticEmitter {
    fn for_devices(&self) -> DeviceEmitter {
        let (place, radius2) = match self.view {
            EmitterView::Near { center, radius2, .. } => (center, radius2),
            EmitterView::Far { direction, sine2 } => (direction, sine2),
        };
        let source = match self.source {
            CausticSource::Sphere(row) => row,
            CausticSource::Sun(sun) => sun as u32,
        };
        let Self { center, radius, radiance, .. } = *self;
        DeviceEmitter { center, radius, place, radius2, radiance, source }
    }
}

impl CasterTree {
    /// Returns the nodes for devices.
    pub(super) fn for_devices(&self) -> Vec<DeviceCasterNode> {
        let nodes = &self.nodes;
        let node = |node: usize| DeviceCasterNode {
            center: Vec3::new(nodes.x[node], nodes.y[node], nodes.z[node]),
            extent: self.extent[node],
            radius: self.radius[node],
            index: self.index[node],
            reflected: self.reflected[node],
            rise: self.rise[node],
            transmitted: self.transmitted[node],
            sphere: self.row[node],
            child: nodes.child[node],
            children: nodes.children[node].into(),
            parent: nodes.parent[node],
        };
        (0..nodes.child.len()).map(node).collect()
    }
}
