// The operations that kernels rely on, for the processor to compare with its own.

@group(0) @binding(0) var<storage, read> operands: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read_write> results: array<vec4<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = id.x;
    if row >= arrayLength(&operands) {
        return;
    }
    let x = bitcast<vec3<f32>>(operands[row].xyz);
    results[2u * row] =
        bitcast<vec4<u32>>(vec4<f32>(x.x + x.y, x.x - x.y, x.x * x.y, x.x / x.y));
    results[2u * row + 1u] =
        bitcast<vec4<u32>>(vec4<f32>(fma(x.x, x.y, x.z), x.x * x.y + x.z, sqrt(abs(x.x)), 0.0));
}
