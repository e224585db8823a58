// Arithmetic that rounds as the processor's: `lanes/mod.rs`, `lanes/fused.rs` and `vec3.rs` of spherule-core.
//
// Sums, differences and products of both precisions, quotients and roots of double precision, and conversions are those
// of the device, which a probe has found to be correctly rounded. No product is fused with a sum, and no two sums are
// made one: results are kept before.

// 0, which no compiler knows.
fn zero64() -> u64 {
    return (u64(params.zero) << 32u) | u64(params.zero);
}

// The number of two words, lower half first.
fn double_at(bits: vec2<u32>) -> f64 {
    return bitcast<f64>((u64(bits.y) << 32u) | u64(bits.x));
}

// The same number, through which nothing is fused or reordered.
fn kept(x: f64) -> f64 {
    return bitcast<f64>(bitcast<u64>(x) ^ zero64());
}

fn kept3(v: vec3<f64>) -> vec3<f64> {
    return bitcast<vec3<f64>>(bitcast<vec3<u64>>(v) ^ vec3<u64>(zero64()));
}

// A quotient of single precision: that of double precision is never so close to the middle of two numbers that rounding
// it again would matter.
fn quotient(x: f32, y: f32) -> f32 {
    return keep(f32(f64(x) / f64(y)));
}

fn quotients(v: vec3<f32>, divisor: f32) -> vec3<f32> {
    return vec3<f32>(quotient(v.x, divisor), quotient(v.y, divisor), quotient(v.z, divisor));
}

// A square root of single precision; as for quotients.
fn root(x: f32) -> f32 {
    return keep(f32(sqrt(f64(x))));
}

// True if the device's `fma` rounds once, as a probe has found.
override FUSED: bool = false;

// x * y + z, rounded once.
fn mul_add(x: f32, y: f32, z: f32) -> f32 {
    if FUSED {
        return keep(fma(x, y, z));
    }
    // The product is exact. What rounding takes from the sum is found by Knuth's TwoSum.
    let product = kept(f64(x) * f64(y));
    let addend = f64(z);
    let sum = kept(product + addend);
    let rest = kept(sum - product);
    let lost = kept(product - kept(sum - rest)) + kept(addend - rest);
    let near = f32(sum);
    let above = sum - f64(near);
    // Only in the middle of two numbers does it matter what was lost.
    if lost == 0.0 || above == 0.0 {
        return near;
    }
    let step = select(0xffffffffu, 1u, (above > 0.0) == (near > 0.0));
    let other = bitcast<f32>(bitcast<u32>(near) + step);
    if near == 0.0 || f64(other) - sum != above {
        return near;
    }
    return select(near, other, (lost > 0.0) == (above > 0.0));
}

// A color or vector times a number.
fn scaled(v: vec3<f32>, factor: f32) -> vec3<f32> {
    return vec3<f32>(keep(v.x * factor), keep(v.y * factor), keep(v.z * factor));
}

fn dot_fused(a: vec3<f32>, b: vec3<f32>) -> f32 {
    return mul_add(a.x, b.x, mul_add(a.y, b.y, keep(a.z * b.z)));
}

fn along(base: vec3<f32>, direction: vec3<f32>, t: f32) -> vec3<f32> {
    return vec3<f32>(
        mul_add(direction.x, t, base.x),
        mul_add(direction.y, t, base.y),
        mul_add(direction.z, t, base.z),
    );
}

fn normalized(v: vec3<f32>) -> vec3<f32> {
    return scaled(v, quotient(1.0, root(dot_fused(v, v))));
}

// `normalize` of glam.
fn normalized_unfused(v: vec3<f32>) -> vec3<f32> {
    let squares = keep3(v * v);
    return scaled(v, quotient(1.0, root(keep(keep(squares.x + squares.y) + squares.z))));
}

fn dot_unfused(a: vec3<f64>, b: vec3<f64>) -> f64 {
    let products = kept3(a * b);
    return kept(kept(products.x + products.y) + products.z);
}

fn inverse_length(v: vec3<f64>) -> f64 {
    return 1.0 / sqrt(dot_unfused(v, v));
}
