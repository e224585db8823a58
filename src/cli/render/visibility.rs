//! Detection of images that show no sphere.

use crate::cli::contents::spheres;
use crate::cli::options::lists::region_text;
use spherule_render::World;
use spherule_render::film::Region;
use spherule_render::world::Visibility;

/// Returns the reason why an image with this many samples per pixel shows no sphere, and what to do about it;
/// `None` if it shows one.
pub(super) fn explain_empty(world: &World, region: Region, samples: u32) -> Option<String> {
    let all = world.spheres.len() as u64;
    let visibility = world.visibility(region, samples);
    match visibility {
        Visibility::Visible => None,
        _ if all == 0 => Some("no sphere is visible: the scene has none".to_owned()),
        _ if world.features.unseen >= all => Some(format!(
            "no sphere is visible: slices hide all of them ({}) from the camera",
            spheres(all)
        )),
        Visibility::OutOfView => {
            Some(format!("no sphere is visible: {}", out_of_view(world, region)))
        }
        Visibility::TooSmall { spheres: count, pixels } => Some(format!(
            "possibly no sphere is visible: {} in the image cover {pixels:.1e} pixels in total; move the \
             camera nearer, or use larger radii",
            spheres(count)
        )),
    }
}

fn out_of_view(world: &World, region: Region) -> String {
    let count = spheres(world.spheres.len() as u64);
    let (width, height) = (world.camera.width, world.camera.height);
    if region != (Region { x: 0, y: 0, width, height }) {
        let region = region_text(region);
        return format!("none of {count} is in the region {region}; use another --region");
    }
    format!(
        "none of {count} is in view; point the camera at them, or remove its `eye` and `target` to frame all \
         of them"
    )
}
