// Owen-scrambled Sobol points: `sampling/sobol.rs`, and the assignment of dimensions to decisions, `sampling/plan.rs`.
//
// `sobol` is bound by the kernels: for each set of four dimensions, and each nibble of an index from the lowest bits
// on, the sum of its direction vectors by value.

const INDEX_BITS: u32 = 16u;

// Sets of dimensions; the numbers of further ones are independent.
const SETS: u32 = 64u;

// Burley's constants, which distinguish the four dimensions of a set.
const DIMENSIONS: vec4<u32> = vec4<u32>(0x912f69bau, 0x174f18abu, 0x691e72cau, 0xb40cc1b8u);

// The position of a path in the sequence of its seed.
struct Sequence {
    position: u32,
    // The lower half of the path's key.
    seed: u32,
    // The upper half.
    upper: u32,
    // The number of the sample among those of the key.
    index: u32,
}

// `BEYOND` of `sampling/sampler.rs`.
const BEYOND: vec2<u32> = vec2<u32>(0xde82ef95u, 0xd1342543u);

fn hash_word(word: u32) -> u32 {
    var n = word ^ 0xe6fe3bebu;
    n ^= n >> 16u;
    n *= 0x7feb352du;
    n ^= n >> 15u;
    n *= 0x846ca68bu;
    return n ^ (n >> 16u);
}

fn hash_words(words: vec4<u32>) -> vec4<u32> {
    return vec4<u32>(hash_word(words.x), hash_word(words.y), hash_word(words.z), hash_word(words.w));
}

fn owen_scramble(reversed: vec4<u32>, scramble: vec4<u32>) -> vec4<u32> {
    var n = reversed;
    n ^= n * 0x3d20adeau;
    n += scramble;
    n *= (scramble >> vec4<u32>(16u)) | vec4<u32>(1u);
    n ^= n * 0x05526c56u;
    return n ^ (n * 0x53a22864u);
}

// The position of an index below 2^16.
fn shuffle(index: u32, seed: u32) -> u32 {
    let scramble = vec4<u32>(hash_word(seed ^ 0x79c68e4au));
    return owen_scramble(vec4<u32>(reverseBits(index)), scramble).x >> INDEX_BITS;
}

// `Sampler::start`: sample `index` of a pixel.
fn start_sample(seed: vec2<u32>, x: u32, y: u32, index: u32) -> Sequence {
    let pixel = stream(seed, vec2<u32>(x, y));
    let key = stream(pixel, vec2<u32>(index >> INDEX_BITS, 0u));
    let place = index & ((1u << INDEX_BITS) - 1u);
    return Sequence(shuffle(place, key.x), key.x, key.y, place);
}

fn rotated(x: u32, by: u32) -> u32 {
    return (x << by) | (x >> (32u - by));
}

// Four numbers of a generator of its own: xoshiro128++ (Blackman and Vigna, "Scrambled Linear Pseudorandom Number
// Generators", TOMS 2021), whose state comes from SplitMix64.
fn independent(key: vec2<u32>, dimensions: u32) -> vec4<f32> {
    let first = sum64(stream(key, vec2<u32>(dimensions, 0u)), GOLDEN_GAMMA);
    var state = vec4<u32>(mix(first), mix(sum64(first, GOLDEN_GAMMA)));
    var bits: vec4<u32>;
    for (var i = 0u; i < 4u; i++) {
        bits[i] = rotated(state.x + state.w, 7u) + state.x;
        let shifted = state.y << 9u;
        state.z ^= state.x;
        state.w ^= state.y;
        state.y ^= state.z;
        state.x ^= state.w;
        state.z ^= shifted;
        state.w = rotated(state.w, 11u);
    }
    return vec4<f32>(bits >> vec4<u32>(8u)) * 0x1p-24f;
}

// Four numbers in [0, 1) of a set of dimensions.
fn draw4(sequence: Sequence, dimensions: u32) -> vec4<f32> {
    if dimensions >= SETS {
        let key = stream(vec2<u32>(sequence.seed, sequence.upper) ^ BEYOND, vec2<u32>(sequence.index, 0u));
        return independent(key, dimensions);
    }
    var sum = vec4<u32>(0u);
    for (var nibble = 0u; nibble < 4u; nibble++) {
        let value = (sequence.position >> (4u * nibble)) & 15u;
        sum ^= sobol[(4u * dimensions + nibble) * 16u + value];
    }
    let scramble = DIMENSIONS ^ vec4<u32>((sequence.seed * 0x9c8f2d3bu) ^ dimensions);
    let bits = reverseBits(owen_scramble(sum, hash_words(scramble)));
    return keep4(bitcast<vec4<f32>>((bits >> vec4<u32>(9u)) | vec4<u32>(0x3f800000u)) - 1.0);
}

// The set with lobe and roulette of a bounce.
fn choices(bounce: u32) -> u32 {
    return 1u + 2u * bounce;
}

// The set with the direction of a bounce.
fn directions(bounce: u32) -> u32 {
    return select(choices(bounce), 0u, bounce == 0u);
}

// The set with the numbers of the light sample of a bounce.
fn lights_set(bounce: u32) -> u32 {
    return 2u + 2u * bounce;
}
