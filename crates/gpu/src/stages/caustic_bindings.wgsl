// Columns of paths, as the kernel of caustic samples binds them.

@group(0) @binding(8) var<storage, read> sobol: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read> sequences: array<Sequence>;
@group(0) @binding(10) var<storage, read> found: array<u32>;
@group(0) @binding(11) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(12) var<storage, read> states: array<PathState>;
@group(0) @binding(13) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(14) var<storage, read_write> shadow_rays: array<vec4<u32>>;
@group(0) @binding(15) var<storage, read_write> lights: array<vec4<f32>>;
@group(0) @binding(16) var<storage, read> queue: array<u32>;
@group(0) @binding(17) var<storage, read_write> shadow_queue: array<atomic<u32>>;
@group(0) @binding(18) var<storage, read> light_rows: array<vec4<u32>>;
@group(0) @binding(19) var<storage, read_write> chains: array<vec4<u32>>;
@group(0) @binding(20) var<storage, read_write> seconds: array<vec4<u32>>;
