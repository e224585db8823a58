//! Kernels, as the files of WGSL that each is made of.

use crate::device::Device;
use crate::error::DeviceError;
use spherule_render::shade::MaterialKind;

/// Rays in a queue, and the queue.
const QUEUED_RAYS: &str = concat!(
    "@group(0) @binding(8) var<storage, read> queue: array<u32>;\n",
    include_str!("stages/queue.wgsl")
);

const PARAMS: &str = include_str!("stages/params.wgsl");
const ARITHMETIC: &str = include_str!("stages/arithmetic.wgsl");
const SPHERES: &str = include_str!("stages/spheres.wgsl");
const RAYS: &str = include_str!("stages/rays.wgsl");
const SPHERE_TERMS: &str = include_str!("stages/sphere_terms.wgsl");
const PATH_STATE: &str = include_str!("stages/path_state.wgsl");
const GROUND: &str = include_str!("stages/ground.wgsl");
const QUEUE: &str = include_str!("stages/queue.wgsl");
const SHADOW_RAYS: &str = include_str!("stages/shadow_rays.wgsl");
const SHADOW_SEGMENTS: &str = include_str!("stages/shadow_segments.wgsl");
const SHADOW_CLEAR: &str = include_str!("stages/shadow_clear.wgsl");
const CHAIN_COLUMNS: &str = include_str!("stages/chain_columns.wgsl");
const WORLD_BINDINGS: &str = include_str!("stages/world_bindings.wgsl");
const RADIANCE: &str = include_str!("stages/radiance.wgsl");
const INTERIOR: &str = include_str!("stages/interior.wgsl");
const MATERIALS: &str = include_str!("stages/materials.wgsl");
const SURFACES: &str = include_str!("stages/surface.wgsl");
const BASIS: &str = include_str!("stages/basis.wgsl");
const LIGHT_ROWS: &str = include_str!("stages/lights.wgsl");
const LIGHT_TREE: &str = include_str!("stages/light_tree.wgsl");
const SPHERE_LIGHT: &str = include_str!("stages/sphere_light.wgsl");
const SUN: &str = include_str!("stages/sun.wgsl");
/// Numbers of a job, and its arithmetic.
const JOB: [&str; 6] = [
    PARAMS,
    ARITHMETIC,
    SPHERE_TERMS,
    include_str!("stages/job.wgsl"),
    include_str!("stages/warp.wgsl"),
    GROUND,
];
/// Their samples.
const SAMPLES: [&str; 2] = [include_str!("stages/hash.wgsl"), include_str!("stages/sobol.wgsl")];
/// Surfaces, and what is around all of them.
const SURFACE: [&str; 7] = [
    SPHERES,
    MATERIALS,
    SURFACES,
    BASIS,
    include_str!("stages/angles.wgsl"),
    include_str!("stages/sky.wgsl"),
    include_str!("stages/environment.wgsl"),
];
/// Scattering.
const BSDFS: [&str; 7] = [
    include_str!("stages/shade.wgsl"),
    include_str!("stages/fresnel.wgsl"),
    include_str!("stages/ggx.wgsl"),
    include_str!("stages/lambertian.wgsl"),
    include_str!("stages/conductor.wgsl"),
    include_str!("stages/plastic.wgsl"),
    include_str!("stages/reflective.wgsl"),
];
/// Light samples.
const LIGHTS: [&str; 7] = [
    LIGHT_ROWS,
    LIGHT_TREE,
    SPHERE_LIGHT,
    include_str!("stages/point_light.wgsl"),
    SUN,
    include_str!("stages/sky_light.wgsl"),
    include_str!("stages/direct_light.wgsl"),
];
/// Rays, glass and roulette of bounces of all integrators.
const BOUNCE: [&str; 13] = [
    PATH_STATE,
    QUEUE,
    RAYS,
    SHADOW_RAYS,
    WORLD_BINDINGS,
    include_str!("stages/path_bindings.wgsl"),
    SHADOW_SEGMENTS,
    SHADOW_CLEAR,
    RADIANCE,
    include_str!("stages/path_columns.wgsl"),
    INTERIOR,
    include_str!("stages/glass.wgsl"),
    include_str!("stages/roulette.wgsl"),
];
/// Caustic samples and MIS weights.
const CAUSTICS: [&str; 7] = [
    include_str!("stages/casters.wgsl"),
    include_str!("stages/caster_tree.wgsl"),
    include_str!("stages/caustic_choice.wgsl"),
    include_str!("stages/specular_sphere.wgsl"),
    include_str!("stages/connection.wgsl"),
    include_str!("stages/caustic_sample.wgsl"),
    include_str!("stages/chain.wgsl"),
];
/// Bounces of path tracing.
const PATH: [&str; 3] = [
    include_str!("stages/mirrored_light.wgsl"),
    include_str!("stages/glass_mirror.wgsl"),
    include_str!("stages/path.wgsl"),
];

/// A kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kernel {
    /// Hits of rays: the first, or any if `any`; or, if `counts`, the visits of the search. Spheres may be `cut` into
    /// several columns. The rays are those in a queue if `queued`, else all.
    Hits { any: bool, counts: bool, cut: bool, queued: bool },
    /// The same in double precision, for the rays whose answer is not known.
    HitsAgain { any: bool, cut: bool, queued: bool },
    /// The test of double precision, and of what kernels make of it; sums of products are those of `fma` if `fused`.
    Doubles { fused: bool },
    /// Camera rays.
    Generate,
    /// Surfaces and shadow rays of ambient occlusion.
    Occlusion,
    /// Light of shadow rays.
    Shadows,
    /// Caustic samples.
    Caustics,
    /// Their second segments.
    SecondSegments,
    /// Surfaces that paths hit, which sample `caustics` or not.
    Surfaces { caustics: bool },
    /// A bounce of paths at surfaces of a kind of material.
    Path { caustics: bool, kind: MaterialKind },
    /// A step of a bounce of Whitted ray tracing.
    Whitted(WhittedStep),
    /// Sums of pixels.
    Film,
}

/// A step of a bounce of Whitted ray tracing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum WhittedStep {
    /// Light that the paths reach.
    Light,
    /// Shadow rays.
    Shadows,
    /// Next rays.
    Bounce,
}

impl Kernel {
    /// The number of kernels.
    pub(crate) const COUNT: usize = 49;

    /// Returns its place among all kernels.
    pub(crate) fn place(self) -> usize {
        match self {
            Self::Hits { any, counts, cut, queued } => {
                [any, counts, cut, queued].iter().fold(0, |place, &is| 2 * place + usize::from(is))
            }
            Self::Generate => 16,
            Self::Occlusion => 17,
            Self::Shadows => 18,
            Self::Surfaces { caustics: false } => 19,
            Self::Doubles { fused: false } => 20,
            Self::Doubles { fused: true } => 36,
            Self::Film => 21,
            Self::SecondSegments => 33,
            Self::Surfaces { caustics: true } => 34,
            Self::Path { caustics, kind } => 37 + 6 * usize::from(caustics) + kind as usize,
            Self::Caustics => 35,
            Self::Whitted(step) => 22 + step as usize,
            Self::HitsAgain { any, cut, queued } => {
                25 + [any, cut, queued].iter().fold(0, |place, &is| 2 * place + usize::from(is))
            }
        }
    }

    /// Returns whether any hit ends its search.
    pub(crate) fn is_any(self) -> bool {
        matches!(self, Self::Hits { any: true, .. })
    }

    /// Compiles it.
    pub(crate) fn compile(self, device: &Device) -> Result<wgpu::ComputePipeline, DeviceError> {
        let (name, files) = self.files();
        let mut constants = match self {
            Self::Hits { any, counts, cut, .. } => {
                vec![("ANY", any.into()), ("COUNT", counts.into()), ("CUT", cut.into())]
            }
            Self::HitsAgain { any, cut, .. } => {
                vec![("ANY", any.into()), ("AGAIN", 1), ("CUT", cut.into())]
            }
            Self::Whitted(step) => vec![("STEP", step as u8)],
            Self::Surfaces { caustics } => vec![("CAUSTICS", caustics.into())],
            Self::Path { caustics, kind } => {
                vec![("CAUSTICS", caustics.into()), ("KIND", kind as u8)]
            }
            _ => Vec::new(),
        };
        if files.contains(&ARITHMETIC) {
            let fused = match self {
                Self::Doubles { fused } => fused,
                _ => device.probe().fuses,
            };
            constants.push(("FUSED", fused.into()));
        }
        let constants: Vec<_> =
            constants.into_iter().map(|(name, value)| (name, f64::from(value))).collect();
        device.kernel(name, &files.concat(), &constants)
    }

    /// Returns its name, and its files.
    fn files(self) -> (&'static str, Vec<&'static str>) {
        let of = |groups: &[&[&'static str]]| groups.concat();
        match self {
            Self::Hits { queued, .. } => {
                let rows = if queued { QUEUED_RAYS } else { include_str!("stages/all_rows.wgsl") };
                let test = include_str!("stages/test_sphere.wgsl");
                ("hits", vec![PARAMS, rows, SPHERES, include_str!("hits.wgsl"), test])
            }
            Self::HitsAgain { queued, .. } => {
                let rows = if queued { QUEUED_RAYS } else { include_str!("stages/all_rows.wgsl") };
                let test = include_str!("stages/test_sphere_again.wgsl");
                let hits = include_str!("hits.wgsl");
                ("hits again", vec![PARAMS, ARITHMETIC, SPHERE_TERMS, rows, SPHERES, hits, test])
            }
            Self::Doubles { .. } => {
                ("doubles", vec![PARAMS, ARITHMETIC, include_str!("doubles.wgsl")])
            }
            Self::Generate => {
                let camera = include_str!("stages/camera.wgsl");
                let generate = include_str!("stages/generate.wgsl");
                ("generate", of(&[&JOB, &SAMPLES, &[PATH_STATE, RAYS, camera, generate]]))
            }
            Self::Occlusion => {
                let ao = include_str!("stages/ao.wgsl");
                (
                    "ao",
                    of(&[
                        &JOB,
                        &SAMPLES,
                        &SURFACE,
                        &[QUEUE, RAYS, SHADOW_RAYS, WORLD_BINDINGS, ao],
                    ]),
                )
            }
            Self::Shadows => {
                let shadows = include_str!("stages/shadow_queue.wgsl");
                ("shadow_queue", vec![PARAMS, QUEUE, RAYS, shadows])
            }
            Self::Caustics => {
                let surface = [SPHERES, MATERIALS, SURFACES, BASIS];
                let lights = [LIGHT_ROWS, LIGHT_TREE, SPHERE_LIGHT, SUN];
                let rays = [PATH_STATE, QUEUE, RAYS, SHADOW_RAYS, SHADOW_SEGMENTS, SHADOW_CLEAR];
                let own = [
                    CHAIN_COLUMNS,
                    WORLD_BINDINGS,
                    include_str!("stages/caustic_bindings.wgsl"),
                    include_str!("stages/caustics.wgsl"),
                ];
                (
                    "caustics",
                    of(&[&JOB, &SAMPLES, &surface, &BSDFS, &lights, &rays, &CAUSTICS, &own]),
                )
            }
            Self::SecondSegments => {
                let files = [
                    PARAMS,
                    ARITHMETIC,
                    SPHERE_TERMS,
                    include_str!("stages/job.wgsl"),
                    GROUND,
                    QUEUE,
                    RAYS,
                    SHADOW_RAYS,
                    include_str!("stages/second_segments.wgsl"),
                ];
                ("second_segments", files.to_vec())
            }
            Self::Film => ("film", vec![PARAMS, ARITHMETIC, include_str!("stages/film.wgsl")]),
            Self::Whitted(_) => {
                let whitted = include_str!("stages/whitted.wgsl");
                ("whitted", of(&[&JOB, &SAMPLES, &SURFACE, &BSDFS, &LIGHTS, &BOUNCE, &[whitted]]))
            }
            Self::Surfaces { .. } => {
                let rays = [PATH_STATE, QUEUE, RAYS, RADIANCE, INTERIOR];
                let own = [
                    CHAIN_COLUMNS,
                    WORLD_BINDINGS,
                    include_str!("stages/emission.wgsl"),
                    SHADOW_CLEAR,
                    include_str!("stages/surfaces.wgsl"),
                ];
                ("surfaces", of(&[&JOB, &SURFACE, &BSDFS, &LIGHTS, &rays, &CAUSTICS, &own]))
            }
            Self::Path { .. } => (
                "path",
                of(&[&JOB, &SAMPLES, &SURFACE, &BSDFS, &LIGHTS, &BOUNCE, &CAUSTICS, &PATH]),
            ),
        }
    }
}
