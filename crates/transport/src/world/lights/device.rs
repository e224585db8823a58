//! Lights as devices get them.

use super::sampler::LightSampler;
use super::tree::Tree;
use super::{Lights, Sun};
use crate::world::{
    DeviceLightChoice, DeviceLightNode, DeviceLightTree, DeviceLights, DevicePoint,
};
use glam::Vec3;

impl Lights {
    /// Returns the lights for devices.
    pub(crate) fn for_devices(&self) -> DeviceLights {
        let points = self.points.iter().map(|point| DevicePoint {
            position: point.position,
            intensity: point.intensity,
            falloff: point.falloff.unwrap_or(0.0),
        });
        DeviceLights {
            emitters: self.emitters.iter().copied().zip(self.radiance.iter().copied()).collect(),
            points: points.collect(),
            suns: self.suns.iter().map(Sun::terms).collect(),
            sky_parts: self.sky_parts,
            choice: self.sampler.for_devices(),
            reach: self.reach,
        }
    }
}

impl LightSampler {
    /// Returns the choice of a light for devices.
    pub(in crate::world) fn for_devices(&self) -> DeviceLightChoice {
        match self {
            Self::None => DeviceLightChoice::None,
            Self::Single => DeviceLightChoice::Single,
            Self::Tree(tree) => DeviceLightChoice::Tree(tree.for_devices()),
            Self::Table(table) => DeviceLightChoice::Table(table.cumulative().to_vec()),
        }
    }
}

impl Tree {
    fn for_devices(&self) -> DeviceLightTree {
        let node = |node: usize| DeviceLightNode {
            center: Vec3::new(self.x[node], self.y[node], self.z[node]),
            radius: self.radius[node],
            power: self.power[node],
            steady: self.steady[node],
            child: self.child[node],
            children: self.children[node].into(),
            parent: self.parent[node],
        };
        DeviceLightTree {
            nodes: (0..self.child.len()).map(node).collect(),
            top: self.top.into(),
            leaf: self.leaf.clone(),
        }
    }
}
