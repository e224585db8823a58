use crate::elementary::sincos;
use crate::scene::Scene;
use crate::world::World;
use std::fmt::Write;
use std::path::Path;

/// Returns the number of images of 130 lamps in as many spheres of glass, in a picture of this width.
fn count(width: u32) -> usize {
    let mut text = format!(
        r#"
        [render]
        size = [{width}, {width}]
        [material.glass]
        kind = "dielectric"
        ior = 1.5
        [material.lamp]
        kind = "emitter"
        radiance = 10
        [camera]
        eye = [0, 0, 12]
        target = [0, 0, 0]
        "#
    );
    for row in 0..130 {
        let (sine, cosine) = sincos(f64::from(row));
        let height = 0.03 * f64::from(row) - 1.5;
        for (material, radius, distance) in [("glass", 0.1, 2.0), ("lamp", 0.01, 3.0)] {
            let center = [distance * sine, height, distance * cosine];
            let rows = format!("center = {center:?}\nradius = {radius}\nmaterial = {material:?}");
            writeln!(text, "[[sphere]]\n{rows}").unwrap();
        }
    }
    let scene = Scene::parse(&text, "scene", Path::new(".")).unwrap();
    World::build(&scene).unwrap().light_images.images.len()
}

#[test]
fn crowds_of_images_are_left_to_paths() {
    let all = count(600);
    assert!(all > 10_000, "{all}");
    assert_eq!(count(200), all);
    // A cell alone has all of them.
    assert_eq!(count(12), 0);
}
