//! Descriptions of a world's contents and of skipped work.

use indicatif::HumanCount;
use serde::{Serialize, Serializer};
use spherule_render::World;
use spherule_render::body_rows::{BodyKind, BodyRows};
use spherule_render::shade::MaterialKind;
use std::fmt::{self, Display, Formatter};

/// Returns a phrase for each kind of content.
pub(super) fn found(world: &World) -> Vec<String> {
    let features = &world.features;
    let mut found = Vec::new();
    for kind in MaterialKind::ALL {
        if features.bodies_of(kind) > 0 {
            found.push(format!("{} of {}", BodyCounts(features.counts_of(kind)), kind.name()));
        }
    }
    if let Some(kind) = features.ground_kind {
        found.push(format!("a ground of {}", kind.name()));
    }
    let mut find = |present: bool, what: &str| {
        if present {
            found.push(what.to_owned());
        }
    };
    find(features.colors, "colors of single spheres");
    find(features.lights, &format!("{} to sample", plural(world.lights.len() as u64, "light")));
    find(features.environment, "a visible environment");
    find(features.lens, "a lens");
    find(features.cuts > 0, &format!("{} at which spheres end", plural(features.cuts, "plane")));
    find(features.unseen > 0, &format!("{} hidden from the camera", spheres(features.unseen)));
    let cut_away = features.cut_away;
    find(cut_away > 0, &format!("slices without {}", spheres(cut_away)));
    let around = features.glass_at_camera.len() as u64;
    find(around > 0, &format!("{} of glass around the camera", spheres(around)));
    found
}

/// `1 sphere`, `2 spheres`.
pub(super) fn spheres(count: u64) -> String {
    plural(count, "sphere")
}

/// Numbers of bodies, of each kind: in JSON `"spheres": 2, "sticks": 0` and so on.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BodyCounts(pub(super) [u64; BodyKind::ALL.len()]);

impl BodyCounts {
    /// Those of a scene or a world.
    pub(super) fn of(rows: BodyRows) -> Self {
        Self(rows.0.map(|count| count as u64))
    }

    /// The kinds and their numbers.
    fn all(self) -> impl Iterator<Item = (BodyKind, u64)> {
        BodyKind::ALL.into_iter().zip(self.0)
    }

    /// The kinds but spheres of which there are bodies, and their numbers.
    pub(super) fn besides_spheres(self) -> impl Iterator<Item = (BodyKind, u64)> {
        self.all().skip(1).filter(|(_, count)| *count > 0)
    }
}

/// `2 spheres`, or `2 spheres, 1 stick, 3 ellipsoids, 4 cones`: those that there are.
impl Display for BodyCounts {
    fn fmt(&self, formatter: &mut Formatter) -> fmt::Result {
        let there = self.all().filter(|(_, count)| *count > 0);
        let texts: Vec<String> = there.map(|(kind, count)| plural(count, kind.name())).collect();
        formatter.write_str(&if texts.is_empty() { spheres(0) } else { texts.join(", ") })
    }
}

impl Serialize for BodyCounts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.all().map(|(kind, count)| (format!("{}s", kind.name()), count)))
    }
}

/// A count and its noun.
pub(super) fn plural(count: u64, noun: &str) -> String {
    let ending = if count == 1 { "" } else { "s" };
    format!("{} {noun}{ending}", HumanCount(count))
}

/// Returns the reasons why spheres are left out, with their numbers.
pub(super) fn dropped(world: &World) -> Vec<String> {
    let left_out =
        |count: u64, why: &str| (count > 0).then(|| format!("{} left out: {why}", spheres(count)));
    let vanished = "too small for single precision relative to the scene's extent";
    let hidden = "each coincides with an earlier one, which hides it";
    let features = &world.features;
    [left_out(features.vanished, vanished), left_out(features.hidden, hidden)]
        .into_iter()
        .flatten()
        .collect()
}
