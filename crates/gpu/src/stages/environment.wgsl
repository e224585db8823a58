// Radiance of rays that hit nothing: `world/environment.rs`.

fn environment_radiance(direction: vec3<f32>) -> vec3<f32> {
    if has(PICTURE) {
        return picture_radiance(direction);
    }
    let middle = vector32(job.middle);
    if !has(GRADIENT) {
        return middle;
    }
    let products = keep3(vector32(job.toward) * direction);
    let cosine = keep(keep(products.x + products.y) + products.z);
    return max(keep3(middle + scaled(vector32(job.slope), cosine)), vec3<f32>(0.0));
}

// What the camera sees.
fn seen_by_camera(direction: vec3<f32>) -> vec3<f32> {
    if has(BACKGROUND) {
        return vector32(job.background);
    }
    return environment_radiance(direction);
}
