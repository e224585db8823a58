//! Images whose radiance is known in closed form, or by a quadrature that is independent of the renderer.

mod camera;
mod caustics;
mod diffuse;
mod enclosed;
mod furnace;
mod glass;
mod lights;
mod occlusion;
mod sky;
mod specular;
