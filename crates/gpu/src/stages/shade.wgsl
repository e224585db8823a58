// BSDFs of opaque materials: `shade/mod.rs`. Directions are local, away from the surface.

const FRAC_1_PI: f32 = 0x1.45f306p-2f;
const PI: f32 = 0x1.921fb6p+1f;
const LEAST_NORMAL: f32 = 0x1p-126f;

// The BSDF of a surface.
struct Bsdf {
    kind: u32,
    // Albedo; the base of plastic; reflectance at normal incidence of a metal.
    color: vec3<f32>,
    // Numbers of the kind.
    numbers: vec3<f32>,
    // The complex index of a metal that has one, and the factor on its reflectance.
    eta: vec3<f32>,
    k: vec3<f32>,
    tint: vec3<f32>,
}

// A sampled direction.
struct Scatter {
    incoming: vec3<f32>,
    // BSDF times cosine over density.
    weight: vec3<f32>,
    // 0 for a mirrored direction.
    pdf: f32,
}

fn mirror(outgoing: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(-outgoing.xy, outgoing.z);
}

fn greatest_of(color: vec3<f32>) -> f32 {
    return max(max(color.x, color.y), color.z);
}

fn bsdf_at(hit: u32) -> Bsdf {
    return bsdf_of(hit, material_kind(material_at(hit)));
}

// The BSDF of a surface whose material is of this kind.
fn bsdf_of(hit: u32, kind: u32) -> Bsdf {
    let material = material_at(hit);
    let color = color_at(hit);
    let none = vec3<f32>(0.0);
    var bsdf = Bsdf(kind, none, material_numbers(material), none, none, none);
    switch kind {
        case CONDUCTOR: { set_conductor(&bsdf, material, color); }
        case PLASTIC: { set_plastic(&bsdf, material, color); }
        default: { bsdf.color = keep3(material_color(material, 2u) * color); }
    }
    return bsdf;
}

// True if light samples alone are best for lights that are not close.
fn is_diffuse(bsdf: ptr<function, Bsdf>) -> bool {
    return (*bsdf).kind == LAMBERTIAN || (*bsdf).kind == EMITTER;
}

fn has_diffuse_base(bsdf: ptr<function, Bsdf>) -> bool {
    return (*bsdf).kind != CONDUCTOR;
}

// True if no light sample can contribute.
fn is_delta(bsdf: ptr<function, Bsdf>) -> bool {
    switch (*bsdf).kind {
        case CONDUCTOR: { return (*bsdf).numbers.x <= 0.0; }
        case REFLECTIVE: { return (*bsdf).numbers.x <= 0.0; }
        default: { return greatest_of((*bsdf).color) <= 0.0; }
    }
}

// The BSDF times the cosine of `incoming`, without mirrored light.
fn bsdf_eval(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, incoming: vec3<f32>) -> vec3<f32> {
    switch (*bsdf).kind {
        case CONDUCTOR: { return conductor_eval(bsdf, outgoing, incoming); }
        case PLASTIC: { return plastic_eval(bsdf, outgoing, incoming); }
        case REFLECTIVE: { return reflective_eval(bsdf, incoming); }
        default: { return scaled((*bsdf).color, lambertian_pdf(incoming)); }
    }
}

fn bsdf_pdf(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, incoming: vec3<f32>) -> f32 {
    switch (*bsdf).kind {
        case CONDUCTOR: { return conductor_pdf(bsdf, outgoing, incoming); }
        case PLASTIC: { return plastic_pdf(bsdf, outgoing, incoming); }
        case REFLECTIVE: { return reflective_density(bsdf, max(incoming.z, 0.0)); }
        default: { return lambertian_pdf(incoming); }
    }
}

fn bsdf_sample(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>, direction: vec2<f32>, choice: f32) -> Scatter {
    switch (*bsdf).kind {
        case CONDUCTOR: { return conductor_sample(bsdf, outgoing, direction); }
        case PLASTIC: { return plastic_sample(bsdf, outgoing, direction, choice); }
        case REFLECTIVE: { return reflective_sample(bsdf, outgoing, direction, choice); }
        default: {
            let incoming = cosine_hemisphere(direction);
            return Scatter(incoming, (*bsdf).color, keep(FRAC_1_PI * incoming.z));
        }
    }
}

// The fraction of light that is mirrored.
fn bsdf_mirrored(bsdf: ptr<function, Bsdf>, outgoing: vec3<f32>) -> vec3<f32> {
    switch (*bsdf).kind {
        case PLASTIC: { return vec3<f32>(plastic_coat(bsdf, outgoing.z)); }
        case REFLECTIVE: { return scaled((*bsdf).color, (*bsdf).numbers.y); }
        default: { return vec3<f32>(0.0); }
    }
}
