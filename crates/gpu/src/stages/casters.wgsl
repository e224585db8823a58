// Smooth specular spheres and the emitters whose caustics are sampled: `world/caustics/mod.rs`.
//
// `light_rows` has them after all lights. Five rows say where the others begin: of the spheres, ordered by row, these and
// their numbers; of each of them one row, and three of each node of their tree; of each emitter four, of each node of the
// emitters' tree two, the leaf of each emitter, and bounds of the number of samples.

// Sine of an emitter's angular radius as seen from a sphere, from which on caustics are not sampled.
const MAX_EMITTER_SINE: f64 = 0x1.999999999999ap-2lf;
// 1 and the overlap up to which spheres touch.
const TOUCH: f64 = 0x1.000010c6f7a0bp+0lf;

// A specular sphere and an emitter.
struct CasterPair {
    // False if the emitter is large as seen from the sphere.
    valid: bool,
    // The sphere: its row, center, radius, and the index of refraction outside over that inside, 0 for a mirror.
    sphere: u32,
    center: vec3<f64>,
    radius: f64,
    index: f64,
    // Vector from its center to the emitter's, and the emitter's radius.
    offset: vec3<f64>,
    emitter_radius: f64,
    // The emitter as seen from the sphere's center.
    cone: Cone,
}

fn caster_head(place: u32) -> vec4<u32> {
    return light_rows[job.caster_rows + place];
}

// The number of a sphere among those that cast caustics; MISS for another.
fn caster_of(sphere: u32) -> u32 {
    let head = caster_head(0u);
    return number_of(sphere, head.y, head.x);
}

fn caster_row(caster: u32) -> vec4<u32> {
    return light_rows[caster_head(0u).z + caster];
}

// One of the rows of an emitter: center and radius, then the place or direction and the size for estimates, and its
// radiance.
fn emitter_row(emitter: u32, place: u32) -> vec4<u32> {
    return light_rows[caster_head(0u).w + 4u * emitter + place];
}

// True for suns, which come after emissive spheres.
fn is_sun(emitter: u32) -> bool {
    return emitter >= job.emitters;
}

// The number of a sun with a disc among the emitters.
fn emitter_of_sun(sun: u32) -> u32 {
    var number = job.emitters;
    for (var other = 0u; other < sun; other++) {
        number += select(0u, 1u, sun_height(other) > 0.0);
    }
    return number;
}

fn caster_pair(caster: u32, emitter: u32) -> CasterPair {
    let row = caster_row(caster);
    let sphere = sphere_row(row.z);
    let first = emitter_row(emitter, 0u);
    let second = emitter_row(emitter, 1u);
    var pair: CasterPair;
    pair.sphere = row.z;
    pair.center = vec3<f64>(bitcast<vec3<f32>>(sphere.xyz));
    pair.radius = f64(bitcast<f32>(sphere.w));
    pair.index = double_at(row.xy);
    let place = vec3<f64>(double_at(first.xy), double_at(first.zw), double_at(second.xy));
    pair.offset = kept3(place - pair.center);
    pair.emitter_radius = double_at(second.zw);
    let distance = kept(sqrt(dot_unfused(pair.offset, pair.offset)));
    let small = pair.emitter_radius < kept(distance * MAX_EMITTER_SINE);
    let apart = distance > kept(kept(pair.radius + pair.emitter_radius) * TOUCH);
    pair.cone = cone_toward(kept(distance * distance), pair.emitter_radius);
    pair.valid = small && apart && pair.cone.outside;
    return pair;
}
