// Columns of paths, as the kernels of bounces bind them.

@group(0) @binding(8) var<storage, read> sobol: array<vec4<u32>>;
@group(0) @binding(9) var<storage, read> sequences: array<Sequence>;
@group(0) @binding(10) var<storage, read> found: array<u32>;
@group(0) @binding(11) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(12) var<storage, read_write> states: array<PathState>;
@group(0) @binding(13) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(14) var<storage, read_write> shadow_rays: array<vec4<u32>>;
@group(0) @binding(15) var<storage, read_write> lights: array<vec4<f32>>;
@group(0) @binding(16) var<storage, read> queue: array<u32>;
// Paths that go on.
@group(0) @binding(17) var<storage, read_write> next_queue: array<atomic<u32>>;
@group(0) @binding(18) var<storage, read_write> shadow_queue: array<atomic<u32>>;
@group(0) @binding(19) var<storage, read> light_rows: array<vec4<u32>>;
// The glass spheres that contain each path, or MISS.
@group(0) @binding(20) var<storage, read_write> interiors: array<u32>;
@group(0) @binding(21) var<storage, read> sky_rows: array<vec4<u32>>;
