// Point lights: `world/lights/point.rs`.

const BRIGHTEST: f32 = 1e30;

fn sample_point_light(point: vec3<f32>, light: u32) -> LightSample {
    let row = job.point_rows + 3u * light;
    let first = light_rows[row];
    let second = light_rows[row + 1u];
    let position = vec3<f64>(double_at(first.xy), double_at(first.zw), double_at(second.xy));
    let scale = double_at(second.zw);
    let toward = kept3(position - vec3<f64>(point));
    let distance = sqrt(dot_unfused(toward, toward));
    var sample = no_light();
    if !(0.0lf < distance) {
        return sample;
    }
    var falloff = 1.0lf;
    if 0.0lf < scale {
        let ratio = scale / distance;
        falloff = kept(ratio * ratio);
    }
    let intensity = vec3<f64>(light_vector(row + 2u));
    sample.lit = true;
    sample.direction = vec3<f32>(toward / distance);
    sample.t = distance;
    sample.weight = vec3<f32>(min(kept3(intensity * falloff), vec3<f64>(f64(BRIGHTEST))));
    return sample;
}
