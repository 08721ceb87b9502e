/* Coordinates relative to the origin of the model, and absolute coordinates for the user. */
#ifndef GN_BASE_POINT_H
#define GN_BASE_POINT_H

enum { GN_POINT_SIZE = 80 };

/* Returns an absolute coordinate. Without an origin it keeps its bits, including the sign of
 * zero. */
static inline double gn_point_out(double origin, double x) {
    return origin != 0.0 ? x + origin : x;
}

/* Writes a point in absolute coordinates as "(x, y, z)" in m, with enough digits to distinguish
 * points of a model far from the origin. Returns `text`. */
const char *gn_point_text(const double origin[3], const double x[3], char text[GN_POINT_SIZE]);

#endif
