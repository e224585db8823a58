// Maps from the unit square to the disk and the hemisphere: `sampling/warp.rs` and `sampling/angles.rs`.

// The largest number below 1.
const ONE_BELOW: f32 = 1.0 - 0x1p-24f;
const FRAC_PI_4: f32 = 0x1.921fb6p-1f;

fn centered(u: f32) -> f32 {
    return keep(2.0 * u - ONE_BELOW);
}

// Sine and cosine of an angle of at most 45 degrees, in radians.
fn octant_sine_cosine(angle: f32) -> vec2<f32> {
    let s = keep(angle * angle);
    let sines = mul_add(mul_add(-1.9515296e-4, s, 8.332161e-3), s, -0.16666655);
    let cosines = mul_add(mul_add(2.4433157e-5, s, -1.3887316e-3), s, 4.1666646e-2);
    let sine = keep(sines * s);
    let cosine = keep(keep(cosines * s) - 0.5);
    return vec2<f32>(mul_add(sine, angle, angle), mul_add(cosine, s, 1.0));
}

struct DiskPoint {
    point: vec2<f32>,
    // Its distance from the center.
    radius: f32,
}

fn concentric(u: vec2<f32>) -> DiskPoint {
    let a = centered(u.x);
    let b = centered(u.y);
    let steep = abs(a) < abs(b);
    let longer = select(a, b, steep);
    let shorter = select(b, a, steep);
    let radius = abs(longer);
    if radius == 0.0 {
        return DiskPoint(vec2<f32>(0.0), 0.0);
    }
    let both = octant_sine_cosine(keep(FRAC_PI_4 * quotient(shorter, longer)));
    let across = keep(longer * both.x);
    let along = keep(longer * both.y);
    return DiskPoint(select(vec2<f32>(along, across), vec2<f32>(across, along), steep), radius);
}

// A local direction on the upper hemisphere, by the cosine.
fn cosine_hemisphere(u: vec2<f32>) -> vec3<f32> {
    let disk = concentric(u);
    let z = root(keep(keep(1.0 - disk.radius) * keep(1.0 + disk.radius)));
    return vec3<f32>(disk.point, z);
}

// A local direction, uniform over the cap about z of this height: 1 - cos of its half-angle.
fn cap(u: vec2<f32>, height: f32) -> vec3<f32> {
    let disk = concentric(u);
    let drop = keep(keep(height * disk.radius) * disk.radius);
    let scale = root(keep(height * keep(2.0 - drop)));
    return vec3<f32>(keep(disk.point.x * scale), keep(disk.point.y * scale), keep(1.0 - drop));
}
