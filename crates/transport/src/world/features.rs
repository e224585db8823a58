//! The features of a world, which decide which stages of a render run.

use crate::body_rows::BodyKind;
use crate::shade::MaterialKind;

/// The features of a world. Stages for absent features do not run.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
#[expect(clippy::struct_excessive_bools, reason = "each is one independent fact of the census")]
pub struct Features {
    /// Bodies of each kind ([`BodyKind::ALL`]), of each kind of material ([`MaterialKind::ALL`]).
    pub bodies_by_kind: [[u64; MaterialKind::COUNT]; BodyKind::ALL.len()],
    /// Spheres too small for single precision relative to the largest coordinate, omitted.
    pub vanished: u64,
    /// Spheres that coincide with an earlier one, among many about one center, omitted.
    pub hidden: u64,
    /// Spheres that slices remove completely.
    pub cut_away: u64,
    /// Planes that cut spheres.
    pub cuts: u64,
    /// True if the camera may be inside a sphere that is cut; determined only if there are cuts.
    pub around_camera: bool,
    /// Spheres that are hidden from the camera.
    pub unseen: u64,
    /// The ground's kind of material; `None` if there is no ground, and rays are not tested against it.
    pub ground_kind: Option<MaterialKind>,
    /// True if spheres have their own colors.
    pub colors: bool,
    /// True if bodies are translucent.
    pub translucent: bool,
    /// True if there are lights to sample: otherwise there are no shadow rays.
    pub lights: bool,
    /// True if rays start on a lens.
    pub lens: bool,
    /// True if rays that leave the scene find any light.
    pub environment: bool,
    /// Glass spheres in which a camera ray may start; if there are none, every ray starts outside.
    pub glass_at_camera: Vec<u32>,
    /// True if a ray may be in more than one glass sphere at a time, because some may touch,
    /// overlap or contain each other.
    pub nested_glass: bool,
}

impl Features {
    /// Returns the number of bodies with this kind of material.
    pub fn bodies_of(&self, kind: MaterialKind) -> u64 {
        self.counts_of(kind).iter().sum()
    }

    /// Returns the numbers of bodies of each kind with this kind of material.
    pub fn counts_of(&self, kind: MaterialKind) -> [u64; BodyKind::ALL.len()] {
        self.bodies_by_kind.map(|counts| counts[kind as usize])
    }

    /// Returns the number of spheres with this kind of material.
    pub(super) fn spheres_of(&self, kind: MaterialKind) -> u64 {
        self.bodies_by_kind[BodyKind::Sphere as usize][kind as usize]
    }

    /// Returns whether anything has this kind of material.
    pub fn has(&self, kind: MaterialKind) -> bool {
        self.bodies_of(kind) > 0 || self.ground_kind == Some(kind)
    }

    /// Returns descriptions of the work that the render omits.
    pub fn skipped(&self) -> Vec<String> {
        let mut skipped = Vec::new();
        let mut skip = |absent: bool, what: &str| {
            if absent {
                skipped.push(what.to_owned());
            }
        };
        skip(self.cuts == 0, "no flat cuts: no ray clipping");
        skip(self.ground_kind.is_none(), "no ground: no plane test");
        skip(!self.lights, "no lights to sample: no shadow rays");
        skip(!self.translucent, "no translucent bodies: every body that is hit ends its ray");
        skip(!self.lens, "no lens: no lens samples");
        skip(!self.colors, "no colors of single spheres: no color column");
        skip(!self.environment, "black environment: no environment lookup");
        skip(
            self.glass_at_camera.is_empty(),
            "no glass around the camera: every ray starts outside",
        );
        skip(!self.nested_glass, "no touching or nested glass: no interior lists");
        for kind in MaterialKind::ALL {
            skip(!self.has(kind), &format!("no {}: its shading stage does not run", kind.name()));
        }
        skipped
    }
}
