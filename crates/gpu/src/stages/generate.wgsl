// Camera rays, the start of paths: `integrator/generate.rs`.

@group(0) @binding(1) var<storage, read> job: Job;
// Column and row of each pixel, 16 bits each.
@group(0) @binding(2) var<storage, read> pixels: array<u32>;
@group(0) @binding(3) var<storage, read> sobol: array<vec4<u32>>;
// The table of the pixel filter.
@group(0) @binding(4) var<storage, read> offsets: array<f32>;
// As `hits.wgsl` reads them.
@group(0) @binding(5) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read_write> sequences: array<Sequence>;
@group(0) @binding(7) var<storage, read_write> states: array<PathState>;
// Radiance, in bits; and a word that says whether it is unknown, and counts rays.
@group(0) @binding(8) var<storage, read_write> paths: array<vec4<u32>>;
// The queue of all paths.
@group(0) @binding(9) var<storage, read_write> queue: array<u32>;

const STEPS: u32 = 1024u;

// The offset from a pixel's center along an axis: `sampling/filter.rs`.
fn filter_offset(u: f32) -> f32 {
    if !has(FILTER_TABLE) {
        return keep(u - 0.5);
    }
    let signed = centered(u);
    let w = root(keep(1.0 - abs(signed))) * f32(STEPS);
    let row = min(u32(w), STEPS - 1u);
    let outer = offsets[row];
    let inner = offsets[row + 1u];
    let offset = keep(outer + keep(keep(inner - outer) * keep(w - f32(row))));
    return select(offset, -offset, signed < 0.0);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = id.x;
    if path >= params.count {
        return;
    }
    let pixel = pixels[path / params.samples];
    let x = pixel & 0xffffu;
    let y = pixel >> 16u;
    let index = params.first_sample + path % params.samples;
    let sequence = start_sample(vec2<u32>(job.seed[0], job.seed[1]), x, y, index);
    sequences[path] = sequence;
    let position = draw4(sequence, 0u);
    let offset = vec2<f64>(vec2<f32>(filter_offset(position.z), filter_offset(position.w)));
    var lens = vec2<f64>(0.0);
    if has(LENS) {
        lens = vec2<f64>(concentric(draw4(sequence, 1u).xy).point);
    }
    let place = vec2<f64>(vec2<f32>(f32(x) + 0.5, f32(y) + 0.5)) + offset;
    let ray = camera_ray(place, lens);
    let origin = vec3<f32>(ray.origin);
    let direction = vec3<f32>(ray.direction);
    let ground = cross_ground(origin, direction, MISS);
    write_ray(path, origin, direction, MISS, bounds_before(ground, INFINITELY_FAR));
    states[path].throughput = vec3<f32>(1.0);
    states[path].previous = CAMERA;
    states[path].inside = 0u;
    paths[path] = vec4<u32>(0u);
    queue[QUEUE_HEAD + path] = path;
}
