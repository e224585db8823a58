// The operations that paths rely on, in double precision and of it, for the processor to compare with its own.

// Three numbers each.
@group(0) @binding(1) var<storage, read> operands: array<f64>;
// Twelve numbers each.
@group(0) @binding(2) var<storage, read_write> results: array<f64>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = id.x;
    if row >= params.count {
        return;
    }
    let x = operands[3u * row];
    let y = operands[3u * row + 1u];
    let z = operands[3u * row + 2u];
    let first = 12u * row;
    results[first] = x + y;
    results[first + 1u] = x - y;
    results[first + 2u] = x * y;
    results[first + 3u] = x / y;
    results[first + 4u] = sqrt(abs(x));
    // Products that nothing else uses, which compilers like to fuse with the sum.
    results[first + 5u] = kept(x * z) + y;
    results[first + 6u] = f64(f32(x));
    results[first + 7u] = f64(mul_add(f32(x), f32(y), f32(z)));
    results[first + 8u] = f64(quotient(f32(x), f32(y)));
    results[first + 9u] = f64(root(abs(f32(x))));
    results[first + 10u] = dot_unfused(vec3<f64>(x, y, z), vec3<f64>(x, y, z));
    // Constants, which they like to add.
    results[first + 11u] = f64(keep(2.0 * keep(f32(x) - 1.0) - 0x1.fffffep-1f));
}
