// Camera rays from points of the picture and of the lens: `Camera::rays` of `world/camera.rs`.

struct CameraRay {
    origin: vec3<f64>,
    direction: vec3<f64>,
}

fn camera_ray(place: vec2<f64>, lens: vec2<f64>) -> CameraRay {
    let across = kept(kept(2.0 * place.x / job.size[0] - 1.0) * job.half_size[0]);
    let upward = kept(kept(1.0 - 2.0 * place.y / job.size[1]) * job.half_size[1]);
    let right = vector64(job.right);
    let up = vector64(job.up);
    let offset = kept3(kept3(right * across) + kept3(up * upward));
    var origin = vector64(job.eye);
    var direction = vector64(job.forward);
    if has(ORTHOGRAPHIC) {
        origin = kept3(origin + offset);
    } else {
        direction = kept3(direction + offset);
    }
    if has(LENS) {
        let shift = kept3(
            kept3(right * kept(lens.x * job.lens_radius)) + kept3(up * kept(lens.y * job.lens_radius)),
        );
        origin = kept3(origin + shift);
        direction = kept3(direction - shift / job.focus);
    }
    origin = origin + kept3(direction * job.near);
    return CameraRay(origin, direction * inverse_length(direction));
}
