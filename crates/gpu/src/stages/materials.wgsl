// Materials and colors of surfaces: `shade/materials.rs` and `world/appearance.rs`.
//
// `appearance` and `materials` are bound by the kernels: of each sphere its color and the row of its material, and of
// each material six rows.

// Kinds, in their order.
const LAMBERTIAN: u32 = 0u;
const CONDUCTOR: u32 = 1u;
const DIELECTRIC: u32 = 2u;
const PLASTIC: u32 = 3u;
const REFLECTIVE: u32 = 4u;
const EMITTER: u32 = 5u;

const MATERIAL_ROWS: u32 = 6u;

// The row of the material at a hit.
fn material_at(hit: u32) -> u32 {
    if hit == GROUND {
        return job.ground_material;
    }
    return appearance[hit].w;
}

// The factor on the material's color at a hit.
fn color_at(hit: u32) -> vec3<f32> {
    if hit == GROUND {
        return vec3<f32>(1.0);
    }
    return bitcast<vec3<f32>>(appearance[hit].xyz);
}

fn material_kind(material: u32) -> u32 {
    return materials[MATERIAL_ROWS * material].x;
}

// Three numbers of a material, which depend on its kind.
fn material_numbers(material: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(materials[MATERIAL_ROWS * material].yzw);
}

// A color of a material: 1 is the characteristic one, the others depend on its kind.
fn material_color(material: u32, place: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(materials[MATERIAL_ROWS * material + place].xyz);
}

// The characteristic color of a surface.
fn albedo_of(hit: u32) -> vec3<f32> {
    return keep3(material_color(material_at(hit), 1u) * color_at(hit));
}
