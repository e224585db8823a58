// The GGX microfacet distribution: `shade/ggx.rs`.

fn facet_distribution(alpha: f32, normal: vec3<f32>) -> f32 {
    let a2 = keep(alpha * alpha);
    let slope2 = keep(keep(normal.x * normal.x) + keep(normal.y * normal.y));
    let t = keep(keep(normal.z * normal.z) + quotient(slope2, a2));
    return quotient(1.0, keep(keep(keep(PI * a2) * t) * t));
}

fn smith_lambda(alpha: f32, direction: vec3<f32>) -> f32 {
    let across2 = keep(keep(direction.x * direction.x) + keep(direction.y * direction.y));
    let tangent2 = quotient(across2, keep(direction.z * direction.z));
    let sum = keep(1.0 + keep(keep(alpha * alpha) * tangent2));
    return keep(keep(root(sum) - 1.0) * 0.5);
}

fn visible_normal_pdf(alpha: f32, outgoing: vec3<f32>, normal: vec3<f32>) -> f32 {
    let seen = keep(outgoing.z * keep(1.0 + smith_lambda(alpha, outgoing)));
    let share = quotient(max(dot_fused(outgoing, normal), 0.0), seen);
    return keep(share * facet_distribution(alpha, normal));
}

fn sample_visible_normal(alpha: f32, outgoing: vec3<f32>, u: vec2<f32>) -> vec3<f32> {
    let stretched = normalized(vec3<f32>(keep(alpha * outgoing.x), keep(alpha * outgoing.y), outgoing.z));
    let halfway = keep3(cap(u, keep(1.0 + stretched.z)) + stretched);
    return upward(vec3<f32>(keep(alpha * halfway.x), keep(alpha * halfway.y), max(halfway.z, 0.0)));
}

// A unit vector; z of a zero vector.
fn upward(direction: vec3<f32>) -> vec3<f32> {
    if 0.0 < dot_fused(direction, direction) {
        return normalized(direction);
    }
    return vec3<f32>(0.0, 0.0, 1.0);
}
