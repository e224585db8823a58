# A cholesteric liquid crystal: layers of long molecules, each turned by the same angle about the axis across the layers
# (de Gennes and Prost, "The Physics of Liquid Crystals", 1993, section 6.1).
BEGIN {
    pi = atan2(0, -1)
    print "x,y,z,semi_axes_x,semi_axes_y,semi_axes_z,quatw,quati,quatj,quatk,layer"
    for (k = 0; k < 9; k++) {
        turn = pi * k / 8
        for (i = 0; i < 5; i++) {
            for (j = 0; j < 5; j++) {
                printf "%.5f,%.5f,%.5f,0.95,0.3,0.3,%.6f,0,0,%.6f,%d\n", 2 * i, 2 * j, 1.05 * k, cos(turn / 2), sin(turn / 2), k
            }
        }
    }
}
