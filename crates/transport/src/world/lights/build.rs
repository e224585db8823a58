//! Building the light tree: splits clusters where that tells lights apart best, up to sixteen per node.

use super::tree::{BRANCHES, LightBounds, ROOT, Tree};
use glam::DVec3;
use std::ops::Range;

/// Candidate splits along an axis.
const BINS: usize = 16;

impl LightBounds {
    /// Returns whether the light has a finite positive contribution.
    pub(super) fn is_luminous(&self) -> bool {
        self.total() > 0.0 && self.total().is_finite()
    }

    /// Returns the irradiance at a distance of 1.
    pub(super) fn total(&self) -> f64 {
        self.power + self.steady
    }
}

/// A range of the order of lights, with its bounds.
#[derive(Clone)]
struct Cluster {
    lights: Range<usize>,
    bounds: LightBounds,
}

/// Builds the tree of the luminous lights; `None` if there is none.
pub(super) fn build_tree(lights: &[LightBounds]) -> Option<Tree> {
    let brightest = lights
        .iter()
        .filter(|light| light.is_luminous())
        .map(LightBounds::total)
        .fold(0.0, f64::max);
    let mut order: Vec<u32> = (0..lights.len() as u32).collect();
    order.retain(|&light| lights[light as usize].is_luminous());
    if order.is_empty() {
        return None;
    }
    let mut tree = Tree { leaf: vec![ROOT; lights.len()], ..Tree::default() };
    let mut open = vec![(ROOT, 0..order.len())];
    while let Some((parent, range)) = open.pop() {
        let clusters = split(lights, &mut order, range);
        let first = tree.child.len();
        if let Some(parent) = tree.child.get_mut(parent as usize) {
            *parent = first as u32;
        } else {
            tree.top = clusters.len() as u8;
        }
        if let Some(children) = tree.children.get_mut(parent as usize) {
            *children = clusters.len() as u8;
        }
        for Cluster { lights, bounds } in clusters {
            let node = tree.child.len() as u32;
            tree.push(&bounds, brightest, parent);
            if lights.len() > 1 {
                open.push((node, lights));
            } else {
                let light = order[lights.start];
                tree.child[node as usize] = light;
                tree.leaf[light as usize] = node;
            }
        }
    }
    tree.pad();
    Some(tree)
}

impl Tree {
    fn push(&mut self, bounds: &LightBounds, brightest: f64, parent: u32) {
        self.x.push(bounds.center.x as f32);
        self.y.push(bounds.center.y as f32);
        self.z.push(bounds.center.z as f32);
        let radius = bounds.radius as f32;
        self.radius.push(if bounds.hollow { -radius } else { radius });
        let relative = |power: f64| (power / brightest) as f32;
        self.power.push(relative(bounds.power));
        self.steady.push(relative(bounds.steady));
        self.child.push(0);
        self.children.push(0);
        self.parent.push(parent);
    }

    /// Pads the columns, so that rows of lanes can start at any node.
    fn pad(&mut self) {
        let Self { x, y, z, radius, power, steady, .. } = self;
        for column in [x, y, z, radius, power, steady] {
            column.extend([0.0; BRANCHES]);
            column.shrink_to_fit();
        }
    }
}

/// Splits a range of the order into at most [`BRANCHES`] clusters, the widest and brightest first.
fn split(lights: &[LightBounds], order: &mut [u32], range: Range<usize>) -> Vec<Cluster> {
    let mut clusters =
        vec![Cluster { bounds: enclosing_bounds(lights, &order[range.clone()]), lights: range }];
    while clusters.len() < BRANCHES {
        let spread = |cluster: &Cluster| cluster.bounds.total() * cluster.bounds.radius.powi(2);
        let several = clusters.iter().enumerate().filter(|(_, cluster)| cluster.lights.len() > 1);
        // Of equal clusters, the last.
        let widest = several.max_by(|(_, a), (_, b)| spread(a).total_cmp(&spread(b)));
        let Some((place, _)) = widest else { break };
        let Range { start, end } = clusters[place].lights.clone();
        let middle = start + partition(lights, &mut order[start..end]);
        let halves = [start..middle, middle..end].map(|lights_of| Cluster {
            bounds: enclosing_bounds(lights, &order[lights_of.clone()]),
            lights: lights_of,
        });
        clusters.splice(place..=place, halves);
    }
    clusters
}

/// Returns the bounds that enclose some lights.
fn enclosing_bounds(lights: &[LightBounds], rows: &[u32]) -> LightBounds {
    let light_bounds = || rows.iter().map(|&row| &lights[row as usize]);
    if let [row] = rows {
        return lights[*row as usize];
    }
    let low = light_bounds().map(|bounds| bounds.center - bounds.radius).reduce(DVec3::min);
    let high = light_bounds().map(|bounds| bounds.center + bounds.radius).reduce(DVec3::max);
    let center = (low.unwrap_or_default() + high.unwrap_or_default()) / 2.0;
    let reach = |bounds: &LightBounds| bounds.center.distance(center) + bounds.radius;
    LightBounds {
        center,
        radius: light_bounds().map(reach).fold(0.0, f64::max),
        power: light_bounds().map(|bounds| bounds.power).sum(),
        steady: light_bounds().map(|bounds| bounds.steady).sum(),
        hollow: false,
    }
}

/// Partitions two or more lights along the axis of largest spread, where power times squared extent is
/// least for both sides together. Returns the size of the first part.
fn partition(lights: &[LightBounds], rows: &mut [u32]) -> usize {
    let center = |row: u32| lights[row as usize].center;
    let low = rows.iter().map(|&row| center(row)).reduce(DVec3::min).unwrap_or_default();
    let high = rows.iter().map(|&row| center(row)).reduce(DVec3::max).unwrap_or_default();
    let axis = (high - low).max_position();
    let scale = BINS as f64 / (high - low)[axis];
    if !scale.is_finite() {
        return rows.len() / 2;
    }
    let bin = |row: u32| (((center(row) - low)[axis] * scale) as usize).min(BINS - 1);
    let mut bins = [Bin::default(); BINS];
    for &row in rows.iter() {
        bins[bin(row)].add(&lights[row as usize]);
    }
    let cost = |end: &usize| {
        let sum = |bins: &[Bin]| bins.iter().fold(Bin::default(), |sum, bin| sum.with(bin)).cost();
        sum(&bins[..*end]) + sum(&bins[*end..])
    };
    let best = (1..BINS).min_by(|a, b| cost(a).total_cmp(&cost(b))).unwrap_or(1);
    rows.sort_by_key(|&row| bin(row) >= best);
    // The outermost centers are in the outermost bins: neither side is empty.
    rows.partition_point(|&row| bin(row) < best)
}

/// Lights whose centers are in one bin of an axis.
#[derive(Clone, Copy)]
struct Bin {
    low: DVec3,
    high: DVec3,
    power: f64,
}

impl Default for Bin {
    fn default() -> Self {
        Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY, power: 0.0 }
    }
}

impl Bin {
    fn add(&mut self, bounds: &LightBounds) {
        *self = self.with(&Self {
            low: bounds.center - bounds.radius,
            high: bounds.center + bounds.radius,
            power: bounds.total(),
        });
    }

    fn with(&self, other: &Self) -> Self {
        Self {
            low: self.low.min(other.low),
            high: self.high.max(other.high),
            power: self.power + other.power,
        }
    }

    fn cost(&self) -> f64 {
        self.power * (self.high - self.low).max(DVec3::ZERO).length_squared()
    }
}
