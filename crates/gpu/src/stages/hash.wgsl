// Hashing of counters into random bits: `sampling/hash.rs`. Numbers of 64 bits are pairs, lower halves first.

const GOLDEN_GAMMA: vec2<u32> = vec2<u32>(0x7f4a7c15u, 0x9e3779b9u);

fn sum64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    let low = a.x + b.x;
    return vec2<u32>(low, a.y + b.y + select(0u, 1u, low < a.x));
}

// The upper half of a product.
fn product_high(a: u32, b: u32) -> u32 {
    let low = vec2<u32>(a & 0xffffu, b & 0xffffu);
    let high = vec2<u32>(a >> 16u, b >> 16u);
    let first = high.x * low.y + ((low.x * low.y) >> 16u);
    let second = low.x * high.y + (first & 0xffffu);
    return high.x * high.y + (first >> 16u) + (second >> 16u);
}

fn product64(a: vec2<u32>, b: vec2<u32>) -> vec2<u32> {
    return vec2<u32>(a.x * b.x, product_high(a.x, b.x) + a.x * b.y + a.y * b.x);
}

fn shifted64(bits: vec2<u32>, by: u32) -> vec2<u32> {
    return vec2<u32>((bits.x >> by) | (bits.y << (32u - by)), bits.y >> by);
}

fn mix(start: vec2<u32>) -> vec2<u32> {
    var bits = start;
    bits = product64(bits ^ shifted64(bits, 30u), vec2<u32>(0x1ce4e5b9u, 0xbf58476du));
    bits = product64(bits ^ shifted64(bits, 27u), vec2<u32>(0x133111ebu, 0x94d049bbu));
    return bits ^ shifted64(bits, 31u);
}

fn stream(key: vec2<u32>, position: vec2<u32>) -> vec2<u32> {
    return mix(sum64(key, product64(sum64(position, vec2<u32>(1u, 0u)), GOLDEN_GAMMA)));
}
