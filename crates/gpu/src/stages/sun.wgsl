// Suns: `world/lights/sun.rs`.

fn sun_row(sun: u32) -> u32 {
    return job.sun_rows + 5u * sun;
}

// 1 - cos of the angular radius; less than 0 without extent.
fn sun_height(sun: u32) -> f32 {
    return bitcast<f32>(light_rows[sun_row(sun)].w);
}

// The density of directions toward the disc.
fn sun_pdf(sun: u32) -> f32 {
    return bitcast<f32>(light_rows[sun_row(sun) + 1u].w);
}

fn sun_radiance(sun: u32) -> vec3<f32> {
    return light_vector(sun_row(sun) + 3u);
}

// True if the disc is visible in a direction.
fn sun_is_toward(sun: u32, direction: vec3<f32>) -> bool {
    let offset = keep3(direction - light_vector(sun_row(sun) + 2u));
    let squares = keep3(offset * offset);
    let height = keep(keep(squares.x + squares.y) + squares.z) / 2.0;
    return height <= sun_height(sun);
}

fn sample_sun(sun: u32, u: vec2<f32>) -> LightSample {
    let row = sun_row(sun);
    var sample = no_light();
    sample.lit = true;
    sample.direction = light_vector(row + 2u);
    sample.weight = light_vector(row + 4u);
    if sun_height(sun) > 0.0 {
        let basis = Basis(light_vector(row), light_vector(row + 1u), sample.direction);
        sample.direction = to_world(basis, cap(u, sun_height(sun)));
        sample.pdf = sun_pdf(sun);
    }
    return sample;
}
