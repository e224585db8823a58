// Tests a sphere in single precision, by the bounds that docs/gpu.md derives.
fn test_sphere(ray: ptr<function, Ray>, search: ptr<function, Search>, row: u32) {
    let bits = sphere_row(row);
    if (bits.w & NEVER_HIT) != 0u {
        return;
    }
    let center = bitcast<vec3<f32>>(bits.xyz);
    let radius = bitcast<f32>(bits.w);
    let direction = (*ray).direction;
    let inverse_length2 = (*ray).inverse_length2;
    let to_center = keep3(center - (*ray).origin);
    let middle = keep(dot(to_center, direction) * inverse_length2);
    let perpendicular = keep3(to_center - middle * direction);
    let distance2 = dot(perpendicular, perpendicular);
    let slack = keep(abs(middle) * K);
    let band = keep(slack * (*ray).length + TINY);
    let reach = keep(radius * (1.0 + K) + band);
    let chord2 = keep(reach * reach - distance2);
    if chord2 < 0.0 {
        return;
    }
    // The hit, near or far, is in the larger interval about the middle.
    let half = keep(root_above(chord2 * inverse_length2) * (1.0 + 2.0 * K) + slack);
    let enter_low = middle - half;
    let leave_high = middle + half;
    if enter_low > (*search).t_far || leave_high < 0.0 {
        return;
    }
    if is_same(bits, row, (*ray).own) || is_same(bits, row, (*ray).goal) {
        return;
    }
    var near = max(enter_low, 0.0);
    var far = FAR;
    var certain = false;
    let inner = keep(radius * (1.0 - K) - band);
    let inner2 = keep(inner * inner - distance2);
    if inner > 0.0 && inner2 > 0.0 {
        // The line certainly meets the sphere, and no later than this.
        let least = keep(root_below(inner2 * inverse_length2) * (1.0 - 2.0 * K) - slack);
        let enter_high = middle - least;
        let leave_low = middle + least;
        // The origin is on the surface if the product of the distances to both ends is within this.
        var edge = TINY_SQUARE;
        if (*ray).own != MISS {
            let error = (*ray).origin_error;
            let size = dot(to_center, to_center) + radius * radius;
            edge += (error * (2.0 * radius + error) + size * 0x1p-36f) * (1.0 + 32.0 * E);
        }
        let scale = (*ray).length2 * (1.0 - 32.0 * E);
        let exact_origin = (*ray).own == MISS;
        if enter_low > 0.0 {
            certain = exact_origin || keep(keep(enter_low * leave_low) * scale) > edge;
            far = enter_high;
        } else if enter_high < 0.0 && leave_low > 0.0 {
            certain = exact_origin || keep(keep(-enter_high * leave_low) * scale) > edge;
            near = leave_low;
            far = leave_high;
        }
    }
    // Of a sphere around the origin, behind the end.
    if near > (*search).t_far {
        return;
    }
    if certain {
        keep_hit(search, row, near, far);
    } else {
        (*search).others = min((*search).others, max(enter_low, 0.0));
    }
}
