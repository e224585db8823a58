// The Fresnel equations: `shade/fresnel.rs`.

struct Reflectance {
    reflected: f64,
    // The cosine of the refracted direction.
    refracted: f64,
}

fn fresnel_dielectric(cosine: f64, eta: f64) -> Reflectance {
    let sine2 = kept(kept(eta * eta) * kept(kept(1.0 - cosine) * kept(1.0 + cosine)));
    if !(sine2 < 1.0) {
        return Reflectance(1.0, 0.0);
    }
    let refracted = kept(sqrt(1.0 - sine2));
    let arriving = kept(eta * cosine);
    let leaving = kept(eta * refracted);
    let s = (arriving - refracted) / (arriving + refracted);
    let p = (cosine - leaving) / (cosine + leaving);
    return Reflectance(0.5 * (kept(s * s) + kept(p * p)), refracted);
}

fn schlick_rise(cosine: f32) -> f32 {
    let x = keep(min(max(1.0 - cosine, 0.0), 1.0));
    let x2 = keep(x * x);
    return keep(keep(x2 * x2) * x);
}

fn fresnel_conductor(c: f64, eta: f64, k: f64) -> f64 {
    let c2 = kept(c * c);
    let s2 = kept(1.0 - c2);
    let difference = kept(kept(kept(eta * eta) - kept(k * k)) - s2);
    let both = kept(kept(kept(kept(4.0 * eta) * eta) * k) * k);
    let a2_plus_b2 = kept(sqrt(kept(difference * difference) + both));
    let a2 = kept(0.5 * kept(a2_plus_b2 + difference));
    let a = kept(sqrt(select(0.0lf, a2, 0.0 < a2)));
    let twice = kept(kept(2.0 * a) * c);
    let sum = kept(a2_plus_b2 + c2);
    let s = kept((sum - twice) / (sum + twice));
    let along = kept(kept(c2 * a2_plus_b2) + kept(s2 * s2));
    let across = kept(twice * s2);
    let p = kept(s * kept(along - across)) / (along + across);
    return 0.5 * kept(s + p);
}
