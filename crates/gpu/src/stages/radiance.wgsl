// The light that paths have found: `paths` is bound by the kernels.

fn add_light(path: u32, light: vec3<f32>) {
    let radiance = keep3(bitcast<vec3<f32>>(paths[path].xyz) + light);
    paths[path] = vec4<u32>(bitcast<vec3<u32>>(radiance), paths[path].w);
}
