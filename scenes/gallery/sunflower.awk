# The florets of a sunflower (Vogel, "A better way to construct the sunflower head", Mathematical Biosciences 44,
# 1979): floret n is turned by n times the golden angle, at the distance sqrt(n) from the center, here on a low dome.
BEGIN {
    golden = atan2(0, -1) * (3 - sqrt(5))
    print "x,y,z,radius,floret"
    for (n = 1; n <= 1600; n++) {
        r = sqrt(n)
        printf "%.5f,%.5f,%.5f,%.5f,%d\n", r * cos(n * golden), r * sin(n * golden), 4 * cos(r / 14), 0.84, n
    }
}
