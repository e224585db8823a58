// A job and the spheres of its world, which all kernels of surfaces bind alike.

@group(0) @binding(1) var<storage, read> job: Job;
@group(0) @binding(2) var<storage, read> spheres_0: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read> spheres_1: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read> spheres_2: array<vec4<u32>>;
@group(0) @binding(5) var<storage, read> spheres_3: array<vec4<u32>>;
@group(0) @binding(6) var<storage, read> appearance: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read> materials: array<vec4<u32>>;
