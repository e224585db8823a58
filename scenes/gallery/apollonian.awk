# Spheres that fill a sphere, each touching others: the packing of Apollonius in three dimensions. Of five spheres
# that touch one another, curvatures b and centers times curvatures obey one equation (Soddy, "The Kiss Precise",
# Nature 137, 1936), whose other root for one of them is the sum of the other four less it.
function key(v,   i, s) {
    for (i = 0; i < 4; i++) s = s sprintf("%d ", v[i] * 1000 + (v[i] < 0 ? -0.5 : 0.5))
    return s
}
function visit(q,   i, j, k, v, p) {
    for (i = 0; i < 5; i++) {
        for (k = 0; k < 4; k++) {
            v[k] = -q[i * 4 + k]
            for (j = 0; j < 5; j++) if (j != i) v[k] += q[j * 4 + k]
        }
        if (v[0] > most || v[0] <= q[i * 4] + 1e-9) continue
        if (!(key(v) in seen)) {
            seen[key(v)] = 1
            printf "%.7f,%.7f,%.7f,%.7f\n", v[1] / v[0], v[2] / v[0], v[3] / v[0], 1 / v[0]
        }
        for (j = 0; j < 20; j++) p[j] = q[j]
        for (k = 0; k < 4; k++) p[i * 4 + k] = v[k]
        visit(p)
    }
}
BEGIN {
    most = 70
    print "x,y,z,radius"
    # Four equal spheres in the corners of a tetrahedron, in a ball of radius 1.
    r = 1 / (1 + sqrt(1.5)); d = r / sqrt(2)
    q[0] = -1; q[1] = q[2] = q[3] = 0
    split("1 1 1 1 -1 -1 -1 1 -1 -1 -1 1", s)
    for (i = 1; i <= 4; i++) {
        q[i * 4] = 1 / r
        for (k = 1; k <= 3; k++) q[i * 4 + k] = s[(i - 1) * 3 + k] * d / r
        printf "%.7f,%.7f,%.7f,%.7f\n", q[i * 4 + 1] * r, q[i * 4 + 2] * r, q[i * 4 + 3] * r, r
    }
    visit(q)
}
