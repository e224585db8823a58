// Shadow rays that are not traced.

fn clear_shadow_rays(path: u32) {
    for (var slot = 0u; slot < params.shadows; slot++) {
        end_shadow_ray(path + slot * params.count);
    }
}

fn end_shadow_ray(row: u32) {
    shadow_rays[3u * row + 2u] = vec4<u32>(bitcast<vec2<u32>>(vec2<f32>(-1.0)), 0u, 0u);
}
