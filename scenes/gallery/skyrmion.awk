# A skyrmion: spins on a triangular lattice that point down in the middle and up around it, and turn by way of the
# directions toward the middle (Bogdanov and Yablonskii, "Thermodynamically stable vortices in magnetically ordered
# crystals", JETP 68, 1989).
BEGIN {
    pi = atan2(0, -1)
    print "x,y,z,radius,spx,spy,spz"
    for (i = -9; i <= 9; i++) {
        for (j = -9; j <= 9; j++) {
            x = i + j / 2
            y = j * sqrt(3) / 2
            r = sqrt(x * x + y * y)
            if (r > 6.2) continue
            turn = pi * (1 - r / 6.2)
            across = r > 0 ? -sin(turn) / r : 0
            printf "%.5f,%.5f,0,0.14,%.5f,%.5f,%.5f\n", x, y, across * x, across * y, cos(turn)
        }
    }
}
