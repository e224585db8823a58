// Spheres in columns, which are cut where they are larger than a device binds. The columns are bound by the kernels.

// True if the spheres are cut.
override CUT: bool = true;

// Centers and radii, with the sign bit of the radius where there is no sphere.
fn sphere_row(row: u32) -> vec4<u32> {
    if !CUT {
        return spheres_0[row];
    }
    let place = row & ((1u << params.brick_bits) - 1u);
    switch row >> params.brick_bits {
        case 0u: { return spheres_0[place]; }
        case 1u: { return spheres_1[place]; }
        case 2u: { return spheres_2[place]; }
        default: { return spheres_3[place]; }
    }
}
