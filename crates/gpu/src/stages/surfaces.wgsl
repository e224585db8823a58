// Surfaces that paths hit, with the light that they reach, before `path.wgsl` scatters them: `integrator/emission.rs`, and
// `integrator/material_queues.rs`, which sorts them by their materials.

@group(0) @binding(8) var<storage, read> found: array<u32>;
@group(0) @binding(9) var<storage, read_write> rays: array<vec4<u32>>;
@group(0) @binding(10) var<storage, read> states: array<PathState>;
@group(0) @binding(11) var<storage, read_write> paths: array<vec4<u32>>;
@group(0) @binding(12) var<storage, read_write> shadow_rays: array<vec4<u32>>;
@group(0) @binding(13) var<storage, read> queue: array<u32>;
@group(0) @binding(14) var<storage, read_write> kind_queues: array<atomic<u32>>;
@group(0) @binding(15) var<storage, read> light_rows: array<vec4<u32>>;
@group(0) @binding(16) var<storage, read_write> interiors: array<u32>;
@group(0) @binding(17) var<storage, read> sky_rows: array<vec4<u32>>;
@group(0) @binding(18) var<storage, read_write> chains: array<vec4<u32>>;

// True if surfaces sample caustics.
override CAUSTICS: bool = true;

// Adds a path to the queue of a kind of material.
fn queue_by_kind(path: u32, kind: u32) {
    let first = kind * params.kind_stride;
    let place = atomicAdd(&kind_queues[first + 3u], 1u);
    if place % 64u == 0u {
        atomicAdd(&kind_queues[first], 1u);
    }
    atomicStore(&kind_queues[first + QUEUE_HEAD + place], path);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let path = row_of(id.x);
    if path == NO_ROW {
        return;
    }
    clear_shadow_rays(path);
    if params.bounce == 0u && has(NESTED_GLASS) && !begin_interiors(path) {
        paths[path].w |= 1u;
        return;
    }
    let state = states[path];
    var surface = surface_of(path, found[path], Entry(state.inside != 0u, state.entry));
    if !surface.known || (paths[path].w & 1u) != 0u {
        paths[path].w |= 1u;
        return;
    }
    var kind = EMITTER;
    if surface.hit != MISS {
        kind = material_kind(material_at(surface.hit));
    }
    if kind == EMITTER {
        add_light(path, reached_light(path, &surface, state));
        // What emissive surfaces reflect is diffuse.
        kind = LAMBERTIAN;
    }
    if params.bounce == job.depth || surface.hit == MISS {
        return;
    }
    if CAUSTICS && (kind == CONDUCTOR || kind == DIELECTRIC || kind == PLASTIC) {
        track_chain(path, surface.hit, state.previous);
    }
    queue_by_kind(path, kind);
}
