# Fullerenes in carbon nanotubes: armchair tubes (10, 10) of hexagons with bonds of 1.42 angstrom, and in them
# C60, whose corners are those of an icosahedron cut at a third of its edges.
function tube(y0, z0,   i, s, angle) {
    for (i = -row; i <= row; i++)
        for (s = 0; s < 2 * n; s++) {
            # Pairs of atoms lie side by side around the tube, every other ring half a pair further.
            angle = (int(s / 2) + (i % 2 ? 0.5 : 0) + (s % 2 ? 1 / 3 : 0)) * 2 * pi / n
            printf "tube,%.4f,%.4f,%.4f\n", i * bond * sqrt(3) / 2, y0 + radius * cos(angle), z0 + radius * sin(angle)
        }
}
function ball(x0, y0, z0,   a, b) {
    for (a = 0; a < 12; a++)
        for (b = 0; b < 12; b++)
            if (touch(a, b))
                printf "ball,%.4f,%.4f,%.4f\n", x0 + third(a, b, 0), y0 + third(a, b, 1), z0 + third(a, b, 2)
}
function touch(a, b,   k, d) {
    for (k = 0; k < 3; k++) d += (v[a, k] - v[b, k]) ^ 2
    return d > 0 && d < 4.1
}
# An edge of 2 has three bonds.
function third(a, b, k) { return (2 * v[a, k] + v[b, k]) * bond / 2 }
BEGIN {
    pi = atan2(0, -1); bond = 1.42; n = 10; radius = 3 * n * bond / (2 * pi); row = 60
    golden = (1 + sqrt(5)) / 2
    for (i = 0; i < 12; i++) {
        k = int(i / 4)
        v[i, k] = 0
        v[i, (k + 1) % 3] = i % 2 ? 1 : -1
        v[i, (k + 2) % 3] = (int(i / 2) % 2 ? 1 : -1) * golden
    }
    spacing = 2 * radius + 3.35
    print "type,x,y,z"
    for (p = -1; p <= 1; p++) for (q = -1; q <= 1; q++) {
        y0 = p * spacing + q * spacing / 2; z0 = q * spacing * sqrt(3) / 2
        if (p * q == 1) continue
        tube(y0, z0)
        for (x = -7; x <= 7; x++) ball(x * 9.9, y0, z0)
    }
}
