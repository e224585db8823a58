// The queue of shadow rays, which the kernels bind: as `queue.wgsl` reads it.

fn queue_shadow_ray(row: u32) {
    let place = atomicAdd(&shadow_queue[3], 1u);
    if place % 64u == 0u {
        atomicAdd(&shadow_queue[0], 1u);
    }
    atomicStore(&shadow_queue[QUEUE_HEAD + place], row);
}
