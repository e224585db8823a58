//! Spherule renders scenes made of spheres: random sphere fields, particle simulations, molecules.
//!
//! Three things set it apart. **Visibility is exact**: which sphere a ray hits first is decided by
//! the numbers as they are stored, without an epsilon, at any scale ([`intersect`]). **There is one
//! picture**: the same scene, seed and settings give the same bytes at every lane width, thread
//! count and tree ([`render`]). And **what a scene does not need is skipped**: a census of the
//! world decides which stages run ([`world::Features`]).
//!
//! # The way of the data
//!
//! ```text
//! scene file, particle file, generator
//!    -> Scene     what the user wrote, validated, f64                             scene
//!    -> World     columns near the origin, f32; material tables; lights; census   world
//!    -> Bvh       built beside the columns, which are permuted to its order       bvh
//!    per tile, one task with one workspace of columns:                            render
//!      generate -> intersect -> escape, emit -> shade, kind by kind -> occlude -> compact,
//!      until no path is left                                                      integrator
//!    -> Film      sums in f64, tile by tile; probes that tell their error         film, noise
//!    -> Image     PNG, PPM, PFM, EXR                                              image
//! ```
//!
//! An entity is a row, a component is a column, and a system is a function from columns to columns.
//! Everything that the user can get wrong is found by the time there is a [`World`]; from there
//! nothing fails.
//!
//! # Example
//!
//! A sphere in the sun, drawn in characters:
//!
//! ```
//! use glam::DVec3;
//! use spherule::render::{Options, render};
//! use spherule::scene::{EnvironmentMap, Light, Material, NamedMaterial, Pose, Rgb, Scene};
//! use spherule::world::World;
//!
//! let mut scene = Scene::default();
//! scene.spheres.push(DVec3::ZERO, 1.0, 0, Rgb::ONE);
//! let material = Material::Lambertian { color: Rgb::ONE };
//! scene.materials.push(NamedMaterial { name: "white".into(), material });
//! scene.lights.push(Light::Sun {
//!     direction: DVec3::new(-1.0, 1.0, 1.0).normalize(),
//!     irradiance: Rgb::splat(3.0),
//!     angular_radius: 0.0,
//! });
//! scene.environment.map = EnvironmentMap::Constant(Rgb::ZERO);
//! scene.camera.pose = Pose::Fit { direction: DVec3::NEG_Z, margin: 0.0 };
//! (scene.settings.width, scene.settings.height) = (11, 11);
//!
//! let world = World::build(&scene)?;
//! let picture = render(&world, &scene.settings, &Options::default())?.image;
//!
//! let shades: Vec<char> = " .:-=+*#%@".chars().collect();
//! let rows: Vec<String> = picture
//!     .pixels
//!     .chunks(11)
//!     .map(|row| row.iter().map(|pixel| shades[(pixel[1] * 9.9) as usize]).collect())
//!     .collect();
//! assert_eq!(rows, [
//!     "  :=**+-.  ",
//!     " :*%%#*+=. ",
//!     ":#%%##*+=: ",
//!     "*%%##*++-: ",
//!     "*%##**+=-: ",
//!     "*##**+=-:. ",
//!     "+**++=--:  ",
//!     "-+++=--:.  ",
//!     ".-=--:..   ",
//!     " .:::.     ",
//!     "           ",
//! ]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![forbid(unsafe_code)]

#[cfg(doctest)]
#[doc = include_str!("../docs/library.md")]
struct LibraryGuide;

pub use spherule_core as query;
pub use spherule_particles as particles;
pub use spherule_render::*;
