// Orthonormal bases about unit vectors: `sampling/basis.rs`.

struct Basis {
    tangent: vec3<f32>,
    bitangent: vec3<f32>,
    normal: vec3<f32>,
}

fn basis_about(normal: vec3<f32>) -> Basis {
    let sign = select(1.0, -1.0, (bitcast<u32>(normal.z) >> 31u) != 0u);
    let a = quotient(-1.0, keep(sign + normal.z));
    let b = keep(keep(normal.x * normal.y) * a);
    let x2 = keep(keep(keep(sign * normal.x) * normal.x) * a);
    let y2 = keep(keep(normal.y * normal.y) * a);
    let tangent = vec3<f32>(keep(1.0 + x2), sign * b, -sign * normal.x);
    return Basis(tangent, vec3<f32>(b, keep(sign + y2), -normal.y), normal);
}

// A local direction in world axes.
fn to_world(basis: Basis, local: vec3<f32>) -> vec3<f32> {
    let up = scaled(basis.normal, local.z);
    return along(along(up, basis.bitangent, local.y), basis.tangent, local.x);
}

// A direction of the world in local axes.
fn to_local(basis: Basis, world: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot_fused(world, basis.tangent),
        dot_fused(world, basis.bitangent),
        dot_fused(world, basis.normal),
    );
}
