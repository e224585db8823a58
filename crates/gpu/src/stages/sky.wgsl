// Pictures of skies: `world/environment/picture.rs`, `sampling/distribution2d.rs` and `sampling/bilinear.rs`.
//
// `sky_rows` is bound by the kernels: width, height, number of parts and scale; the rows where pixels and patches begin;
// three axes; of each part its region, and where its cumulative probabilities begin, of rows and of the columns of each,
// with the rows of these; then what they point to.

const SKY_PARTS: u32 = 5u;
const LEAST_SINE: f32 = 1e-18;
const LUMINANCE: vec3<f32> = vec3<f32>(0.2126, 0.7152, 0.0722);

// A patch between four pixel centers, and a position in it.
struct Patch {
    column: u32,
    row: u32,
    position: vec2<f32>,
    // Of the polar angle.
    sine: f32,
}

// Radiance at the corners of a patch, by row and column.
struct Corners {
    a: vec3<f32>,
    b: vec3<f32>,
    c: vec3<f32>,
    d: vec3<f32>,
}

// The density with which a direction is sampled, and the part that it belongs to.
struct SkyDensity {
    part: u32,
    pdf: f32,
}

fn sky_size() -> vec2<u32> {
    return sky_rows[0].xy;
}

fn sky_vector(row: u32) -> vec3<f32> {
    return bitcast<vec3<f32>>(sky_rows[row].xyz);
}

fn sky_axes() -> Basis {
    return Basis(sky_vector(2u), sky_vector(3u), sky_vector(4u));
}

fn sky_number(first: u32, place: u32) -> f32 {
    return bitcast<f32>(sky_rows[first + (place >> 2u)][place & 3u]);
}

fn sky_pixel(column: u32, row: u32) -> vec3<f32> {
    let pixels = sky_rows[1].x;
    return scaled(sky_vector(pixels + row * sky_size().x + column), bitcast<f32>(sky_rows[0].w));
}

fn sky_corners(place: Patch) -> Corners {
    let size = sky_size();
    let left = select(place.column - 1u, size.x - 1u, place.column == 0u);
    let above = max(place.row, 1u) - 1u;
    let below = min(place.row, size.y - 1u);
    return Corners(
        sky_pixel(left, above),
        sky_pixel(place.column, above),
        sky_pixel(left, below),
        sky_pixel(place.column, below),
    );
}

fn lerp(a: f32, b: f32, t: f32) -> f32 {
    return mul_add(t, b, keep(keep(1.0 - t) * a));
}

// A bilinear function at a position, by its values at the corners.
fn bilinear(corners: vec4<f32>, position: vec2<f32>) -> f32 {
    let low = lerp(corners.x, corners.y, position.x);
    let high = lerp(corners.z, corners.w, position.x);
    return lerp(low, high, position.y);
}

fn sky_at(corners: Corners, position: vec2<f32>) -> vec3<f32> {
    return vec3<f32>(
        bilinear(vec4<f32>(corners.a.x, corners.b.x, corners.c.x, corners.d.x), position),
        bilinear(vec4<f32>(corners.a.y, corners.b.y, corners.c.y, corners.d.y), position),
        bilinear(vec4<f32>(corners.a.z, corners.b.z, corners.c.z, corners.d.z), position),
    );
}

// The density in a patch, before it is scaled, at its corners.
fn sky_shape(row: u32, corners: Corners) -> vec4<f32> {
    let sines = sky_vector(sky_rows[1].y + row);
    return vec4<f32>(
        keep(dot_fused(corners.a, LUMINANCE) * sines.x),
        keep(dot_fused(corners.b, LUMINANCE) * sines.x),
        keep(dot_fused(corners.c, LUMINANCE) * sines.y),
        keep(dot_fused(corners.d, LUMINANCE) * sines.y),
    );
}

// The mean of a bilinear function.
fn bilinear_mean(corners: vec4<f32>) -> f32 {
    return keep(keep(keep(corners.x + corners.y) + keep(corners.z + corners.w)) * 0.25);
}

// The density by solid angle at a position in a patch, which is chosen with this probability; 0 in black patches.
fn sky_pdf(place: Patch, shape: vec4<f32>, probability: f32) -> f32 {
    let mean = bilinear_mean(shape);
    if !(0.0 < mean) {
        return 0.0;
    }
    let scale = sky_vector(sky_rows[1].y + place.row).z;
    let density = quotient(bilinear(shape, place.position), mean);
    return quotient(keep(keep(probability * scale) * density), place.sine);
}

// The patch of a direction.
fn sky_patch(toward: vec3<f32>) -> Patch {
    let size = vec2<f32>(sky_size());
    let local = to_local(sky_axes(), toward);
    let squared = mul_add(local.x, local.x, keep(local.y * local.y));
    let sine = root(max(squared, LEAST_SINE * LEAST_SINE));
    let x = mul_add(turns_of(local.y, local.x), size.x, 0.5);
    let number = u32(x);
    let column = select(0u, number, number < sky_size().x);
    let from_pole = keep(keep(turns_of(sine, abs(local.z)) * 2.0) * size.y);
    let lower = is_negative(local.z);
    let at_pole = from_pole <= 0.5;
    let y = keep(select(from_pole, keep(size.y - from_pole), lower) + 0.5);
    let above = min(max(f32(u32(y)), 1.0), size.y - 1.0);
    let pole = select(0.0, size.y, lower);
    let down = select(keep(y - above), keep(from_pole * 2.0), at_pole);
    let row = u32(select(above, pole, at_pole));
    return Patch(column, row, vec2<f32>(keep(x - f32(number)), min(down, 1.0)), sine);
}

fn picture_radiance(toward: vec3<f32>) -> vec3<f32> {
    let place = sky_patch(toward);
    return sky_at(sky_corners(place), place.position);
}

fn interval_share(first: u32, place: u32) -> f32 {
    return keep(sky_number(first, place + 1u) - sky_number(first, place));
}

fn picture_density(toward: vec3<f32>) -> SkyDensity {
    let place = sky_patch(toward);
    var found = SkyDensity(0u, 0.0);
    var probability = 0.0;
    for (var part = sky_rows[0].z; part > 0u; part--) {
        let region = sky_rows[SKY_PARTS + 2u * (part - 1u)];
        let tables = sky_rows[SKY_PARTS + 2u * (part - 1u) + 1u];
        let wrapped = select(place.column, place.column + sky_size().x, place.column < region.x);
        let column = wrapped - region.x;
        let row = place.row - region.y;
        if column < region.z && place.row >= region.y && row < region.w {
            found.part = part - 1u;
            let columns = tables.y + row * tables.z;
            probability = keep(interval_share(columns, column) * interval_share(tables.x, row));
            break;
        }
    }
    found.pdf = sky_pdf(place, sky_shape(place.row, sky_corners(place)), probability);
    return found;
}
