// The sums of each pixel's samples: `film/sums.rs`. Sums are exact, or left to the processor with the samples.

struct PixelSums {
    // The sum of the samples.
    total: array<f64, 3>,
    // The sum of their squares in two levels.
    high: array<f64, 3>,
    low: array<f64, 3>,
    // NO_ROW, or the place of the samples of a pixel that is not summed.
    place: u32,
    bounce_rays: u32,
    shadow_rays: u32,
    unused: u32,
}

// Radiance, in bits; and a word that says whether it is unknown, and counts rays.
@group(0) @binding(1) var<storage, read> paths: array<vec4<u32>>;
@group(0) @binding(2) var<storage, read_write> pixels: array<PixelSums>;
// Rows of `paths`, of pixels that are not summed, and the number of these pixels.
@group(0) @binding(3) var<storage, read_write> samples: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> unsummed: atomic<u32>;

// Bits of the least normal number, and of infinity.
const NORMAL_BITS: u32 = 0x00800000u;
const INFINITE_BITS: u32 = 0x7f800000u;

// The bits of double precision beyond those of single precision: EXACT_RATIO.
const EXACT_RATIO: f64 = 0x1p29lf;

struct TwoSum {
    sum: vec3<f64>,
    error: vec3<f64>,
}

// `two_sum` of `film/exact.rs`.
fn two_sum(a: vec3<f64>, b: vec3<f64>) -> TwoSum {
    let sum = kept3(a + b);
    let of_b = kept3(sum - a);
    return TwoSum(sum, kept3(kept3(a - kept3(sum - of_b)) + kept3(b - of_b)));
}

fn triple(v: vec3<f64>) -> array<f64, 3> {
    return array<f64, 3>(v.x, v.y, v.z);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let pixel = id.x;
    let first = pixel * params.samples;
    if first >= params.count {
        return;
    }
    var total = vec3<f64>(0.0);
    var high = vec3<f64>(0.0);
    var low = vec3<f64>(0.0);
    // The least positive number, in bits, which have the same order; INFINITE_BITS if there is none.
    var least = INFINITE_BITS;
    var exact = true;
    var bounce_rays = 0u;
    var shadow_rays = 0u;
    for (var sample = 0u; sample < params.samples; sample++) {
        let path = paths[first + sample];
        let bits = path.xyz;
        // Not negative, infinite, or so small that the device may take it for 0.
        let ordinary = bits == vec3<u32>(0u)
            | (bits >= vec3<u32>(NORMAL_BITS) & bits < vec3<u32>(INFINITE_BITS));
        exact = exact && all(ordinary) && (path.w & 1u) == 0u;
        let positive = select(vec3<u32>(INFINITE_BITS), bits, bits > vec3<u32>(0u));
        least = min(least, min(min(positive.x, positive.y), positive.z));
        let term = vec3<f64>(bitcast<vec3<f32>>(select(vec3<u32>(0u), bits, ordinary)));
        total = kept3(total + term);
        let outer = two_sum(high, kept3(term * term));
        let inner = two_sum(low, outer.error);
        high = outer.sum;
        low = inner.sum;
        exact = exact && all(inner.error == vec3<f64>(0.0));
        bounce_rays += (path.w & 0xffffu) >> 1u;
        shadow_rays += path.w >> 16u;
    }
    if least < INFINITE_BITS {
        exact = exact && all(total <= vec3<f64>(EXACT_RATIO * f64(bitcast<f32>(least))));
    }
    var place = NO_ROW;
    if !exact {
        place = atomicAdd(&unsummed, 1u);
        for (var sample = 0u; sample < params.samples; sample++) {
            samples[place * params.samples + sample] = paths[first + sample];
        }
    }
    pixels[pixel] = PixelSums(triple(total), triple(high), triple(low), place, bounce_rays, shadow_rays, 0u);
}
