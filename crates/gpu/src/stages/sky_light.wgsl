// Light samples of the sky's picture: `world/environment/picture.rs`.

const HALF_STEP: f32 = 0x1p-25f;
const MOST: f32 = 0x1.fffffep+127f;

// The interval of cumulative probabilities that a number below 1 falls into.
fn find_interval(first: u32, count: u32, u: f32) -> u32 {
    var low = 0u;
    var high = count - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if sky_number(first, middle + 1u) <= u {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

fn interval_start(first: u32, place: u32) -> f32 {
    return sky_number(first, place);
}

// A number with a density that is linear between its values at 0 and 1.
fn sample_linear(low: f32, high: f32, u: f32) -> f32 {
    let scale = quotient(1.0, keep(low + high));
    let a = keep(low * scale);
    let b = keep(high * scale);
    let divisor = keep(a + root(lerp(keep(a * a), keep(b * b), u)));
    if divisor <= 0.0 {
        return 0.0;
    }
    return min(quotient(u, divisor), 1.0);
}

// The direction of a position in a patch, in the picture's axes, and the sine of its polar angle.
fn sky_direction(column: u32, row: u32, position: vec2<f32>) -> vec4<f32> {
    let size = vec2<f32>(sky_size());
    let place = vec2<f32>(f32(column), f32(row));
    let at_pole = place.y < 0.5 || keep(size.y - 0.5) < place.y;
    let y = keep(keep(place.y - 0.5) + position.y);
    let lower = keep(size.y * 0.5) < select(y, place.y, at_pole);
    var from_pole = select(y, keep(size.y - y), lower);
    from_pole = max(select(from_pole, keep(position.y * 0.5), at_pole), LEAST_SINE);
    let polar = sine_cosine(keep(quotient(from_pole, size.y) * 0.5));
    let around = sine_cosine(quotient(keep(keep(place.x - 0.5) + position.x), size.x));
    let up = select(polar.y, -polar.y, lower);
    return vec4<f32>(keep(polar.x * around.y), keep(polar.x * around.x), up, polar.x);
}

fn sample_sky(part: u32, u: vec2<f32>) -> LightSample {
    let region = sky_rows[SKY_PARTS + 2u * part];
    let tables = sky_rows[SKY_PARTS + 2u * part + 1u];
    let y = find_interval(tables.x, region.w, u.y);
    let columns = tables.y + y * tables.z;
    let x = find_interval(columns, region.z, u.x);
    let along = interval_share(tables.x, y);
    let across = interval_share(columns, x);
    let probability = keep(across * along);
    let rest = vec2<f32>(
        min(quotient(keep(keep(u.x - interval_start(columns, x)) + HALF_STEP), across), ONE_BELOW),
        min(quotient(keep(keep(u.y - interval_start(tables.x, y)) + HALF_STEP), along), ONE_BELOW),
    );
    var column = x + region.x;
    column -= select(sky_size().x, 0u, column < sky_size().x);
    var place = Patch(column, y + region.y, vec2<f32>(0.0), 1.0);
    let corners = sky_corners(place);
    let shape = sky_shape(place.row, corners);
    var sample = no_light();
    if !(0.0 < bilinear_mean(shape)) {
        return sample;
    }
    let down = sample_linear(keep(shape.x + shape.y), keep(shape.z + shape.w), rest.y);
    place.position =
        vec2<f32>(sample_linear(lerp(shape.x, shape.z, down), lerp(shape.y, shape.w, down), rest.x), down);
    let local = sky_direction(place.column, place.row, place.position);
    place.sine = local.w;
    let pdf = sky_pdf(place, shape, probability);
    if !(0.0 < pdf && pdf <= MOST) {
        return sample;
    }
    sample.lit = true;
    sample.direction = to_world(sky_axes(), local.xyz);
    sample.weight = quotients(sky_at(corners, place.position), pdf);
    sample.pdf = pdf;
    sample.close = true;
    return sample;
}
