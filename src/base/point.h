/* Points relative to an origin, and as the user sees them. */
#ifndef GN_BASE_POINT_H
#define GN_BASE_POINT_H

enum { GN_POINT_SIZE = 80 };

/* A coordinate as the user sees it. Without an origin it keeps its bits, the sign of zero too. */
static inline double gn_point_out(double origin, double x) {
    return origin != 0.0 ? x + origin : x;
}

/* "(x, y, z)" in m, as the user sees it: with as many digits as tell points of a model that lies
 * far away from each other. Returns `text`. */
const char *gn_point_text(const double origin[3], const double x[3], char text[GN_POINT_SIZE]);

#endif
