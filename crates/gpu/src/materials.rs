//! Materials and colors of spheres, as `materials.wgsl` has them.

use spherule_render::World;
use spherule_render::scene::Rgb;
use spherule_render::shade::{Material, MaterialId, MaterialKind, Materials, floats};

/// Words of four numbers of a material.
const ROWS: usize = 6;

/// A material: its kind, three numbers, and five colors, of which the first is the characteristic one.
struct Entry {
    kind: MaterialKind,
    numbers: [f32; 3],
    colors: [Rgb; ROWS - 1],
}

/// Returns the color of each sphere, and the row of its material; and, after these, the numbers of the spheres in the scene
/// where glass is nested.
pub(crate) fn appearance(world: &World) -> Vec<[u32; 4]> {
    let of = |sphere: u32| {
        let [x, y, z] = world.color(sphere).to_array().map(f32::to_bits);
        [x, y, z, row(&world.materials, world.material(sphere))]
    };
    let mut rows: Vec<[u32; 4]> = (0..world.spheres.len() as u32).map(of).collect();
    if world.features.nested_glass {
        rows.extend(words(&world.spheres.id[..world.spheres.len()]));
    }
    rows
}

/// Returns words in rows of four.
pub(crate) fn words(words: &[u32]) -> impl Iterator<Item = [u32; 4]> {
    words.chunks(4).map(|words| {
        let mut row = [0; 4];
        row[..words.len()].copy_from_slice(words);
        row
    })
}

/// Returns the place of a material among those of all kinds.
pub(crate) fn row(materials: &Materials, id: MaterialId) -> u32 {
    let before: usize = lengths(materials)[..id.kind() as usize].iter().sum();
    (before + id.row()) as u32
}

/// Returns the materials of all kinds, each in as many rows.
pub(crate) fn rows(materials: &Materials) -> Vec<[u32; 4]> {
    entries(materials).iter().flat_map(Entry::rows).collect()
}

/// Returns the number of materials of each kind.
fn lengths(materials: &Materials) -> [usize; MaterialKind::COUNT] {
    [
        materials.lambertian.len(),
        materials.conductor.len(),
        materials.dielectric.len(),
        materials.plastic.len(),
        materials.reflective.len(),
        materials.emitter.len(),
    ]
}

fn entries(materials: &Materials) -> Vec<Entry> {
    let entry = |kind, numbers, albedo, second| Entry {
        kind,
        numbers,
        colors: [albedo, second, Rgb::ZERO, Rgb::ZERO, Rgb::ONE],
    };
    let mut all = Vec::new();
    for row in &materials.lambertian {
        all.push(entry(MaterialKind::Lambertian, [0.0; 3], row.color, row.color));
    }
    for row in &materials.conductor {
        // Reflectance at normal incidence, numbers of the kind, index of refraction, and tint.
        let params = row.params(Rgb::ONE);
        let numbers: &[f32] = floats(&params);
        let color = |first: usize| Rgb::new(numbers[first], numbers[first + 1], numbers[first + 2]);
        all.push(Entry {
            kind: MaterialKind::Conductor,
            numbers: [numbers[4], numbers[3], numbers[5]],
            colors: [row.color(), color(0), color(6), color(9), color(12)],
        });
    }
    for row in &materials.dielectric {
        all.push(entry(MaterialKind::Dielectric, [row.ior, 0.0, 0.0], row.color, row.color));
    }
    for row in &materials.plastic {
        let numbers = [row.ior, row.internal_reflectance, 0.0];
        all.push(entry(MaterialKind::Plastic, numbers, row.color, row.color));
    }
    for row in &materials.reflective {
        let numbers = [row.diffuse, row.mirror, row.mirror_probability()];
        all.push(entry(MaterialKind::Reflective, numbers, row.color, row.color));
    }
    for row in &materials.emitter {
        let characteristic = row.radiance.min(Rgb::ONE);
        let mut emitter = entry(MaterialKind::Emitter, [0.0; 3], characteristic, row.albedo);
        emitter.colors[2] = row.radiance;
        all.push(emitter);
    }
    all
}

impl Entry {
    fn rows(&self) -> [[u32; 4]; ROWS] {
        let mut rows = [[0; 4]; ROWS];
        let [a, b, c] = self.numbers.map(f32::to_bits);
        rows[0] = [self.kind as u32, a, b, c];
        for (row, color) in rows[1..].iter_mut().zip(self.colors) {
            let [x, y, z] = color.to_array().map(f32::to_bits);
            *row = [x, y, z, 0];
        }
        rows
    }
}
