//! Growing the tree of lights: a cluster is cut where that tells most, until it has sixteen parts.

use super::tree::{BRANCHES, Ball, ROOT, Tree};
use glam::DVec3;
use std::ops::Range;

/// Places along an axis where a cluster may be cut.
const BINS: usize = 16;

impl Ball {
    /// Whether it gives any light that can be reckoned with.
    pub(super) fn shines(&self) -> bool {
        self.whole() > 0.0 && self.whole().is_finite()
    }

    /// All that it gives from a distance of 1.
    pub(super) fn whole(&self) -> f64 {
        self.power + self.steady
    }
}

/// A part of the order of lights, and the ball about them.
#[derive(Clone)]
struct Cluster {
    lights: Range<usize>,
    ball: Ball,
}

/// The tree of the lights that shine; `None` if none does.
pub(super) fn grow(lights: &[Ball]) -> Option<Tree> {
    let brightest =
        lights.iter().filter(|light| light.shines()).map(Ball::whole).fold(0.0, f64::max);
    let mut order: Vec<u32> = (0..lights.len() as u32).collect();
    order.retain(|&light| lights[light as usize].shines());
    if order.is_empty() {
        return None;
    }
    let mut tree = Tree { leaf: vec![ROOT; lights.len()], ..Tree::default() };
    let mut open = vec![(ROOT, 0..order.len())];
    while let Some((parent, range)) = open.pop() {
        let clusters = parts(lights, &mut order, range);
        let first = tree.child.len();
        if let Some(parent) = tree.child.get_mut(parent as usize) {
            *parent = first as u32;
        } else {
            tree.top = clusters.len() as u8;
        }
        if let Some(children) = tree.children.get_mut(parent as usize) {
            *children = clusters.len() as u8;
        }
        for Cluster { lights, ball } in clusters {
            let node = tree.child.len() as u32;
            tree.push(&ball, brightest, parent);
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
    fn push(&mut self, ball: &Ball, brightest: f64, parent: u32) {
        self.x.push(ball.center.x as f32);
        self.y.push(ball.center.y as f32);
        self.z.push(ball.center.z as f32);
        let radius = ball.radius as f32;
        self.radius.push(if ball.hollow { -radius } else { radius });
        let relative = |power: f64| (power / brightest) as f32;
        self.power.push(relative(ball.power));
        self.steady.push(relative(ball.steady));
        self.child.push(0);
        self.children.push(0);
        self.parent.push(parent);
    }

    /// Lets rows of lanes begin at any node.
    fn pad(&mut self) {
        let Self { x, y, z, radius, power, steady, .. } = self;
        for column in [x, y, z, radius, power, steady] {
            column.extend([0.0; BRANCHES]);
            column.shrink_to_fit();
        }
    }
}

/// Cuts a part of the order, the widest and brightest first.
fn parts(lights: &[Ball], order: &mut [u32], range: Range<usize>) -> Vec<Cluster> {
    let mut clusters = vec![Cluster { ball: around(lights, &order[range.clone()]), lights: range }];
    while clusters.len() < BRANCHES {
        let spread = |cluster: &Cluster| cluster.ball.whole() * cluster.ball.radius.powi(2);
        let several = clusters.iter().enumerate().filter(|(_, cluster)| cluster.lights.len() > 1);
        // Of equals, the last.
        let widest = several.max_by(|(_, a), (_, b)| spread(a).total_cmp(&spread(b)));
        let Some((place, _)) = widest else { break };
        let Range { start, end } = clusters[place].lights.clone();
        let middle = start + cut(lights, &mut order[start..end]);
        let halves = [start..middle, middle..end].map(|lights_of| Cluster {
            ball: around(lights, &order[lights_of.clone()]),
            lights: lights_of,
        });
        clusters.splice(place..=place, halves);
    }
    clusters
}

/// The ball about some lights.
fn around(lights: &[Ball], rows: &[u32]) -> Ball {
    let balls = || rows.iter().map(|&row| &lights[row as usize]);
    if let [row] = rows {
        return lights[*row as usize];
    }
    let low = balls().map(|ball| ball.center - ball.radius).reduce(DVec3::min);
    let high = balls().map(|ball| ball.center + ball.radius).reduce(DVec3::max);
    let center = (low.unwrap_or_default() + high.unwrap_or_default()) / 2.0;
    let reach = |ball: &Ball| ball.center.distance(center) + ball.radius;
    Ball {
        center,
        radius: balls().map(reach).fold(0.0, f64::max),
        power: balls().map(|ball| ball.power).sum(),
        steady: balls().map(|ball| ball.steady).sum(),
        hollow: false,
    }
}

/// Divides two or more lights in two along the axis in which they spread most, where power times
/// squared extent is least on both sides together. Returns how many come first.
fn cut(lights: &[Ball], rows: &mut [u32]) -> usize {
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

/// Lights whose centers are in one part of an axis.
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
    fn add(&mut self, ball: &Ball) {
        *self = self.with(&Self {
            low: ball.center - ball.radius,
            high: ball.center + ball.radius,
            power: ball.whole(),
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
