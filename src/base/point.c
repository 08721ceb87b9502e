#include "base/point.h"

#include <stdio.h>

const char *gn_point_text(const double origin[3], const double x[3], char text[GN_POINT_SIZE]) {
    int digits = origin[0] == 0.0 && origin[1] == 0.0 && origin[2] == 0.0 ? 6 : 12;
    snprintf(text, GN_POINT_SIZE, "(%.*g, %.*g, %.*g)", digits, gn_point_out(origin[0], x[0]),
             digits, gn_point_out(origin[1], x[1]), digits, gn_point_out(origin[2], x[2]));
    return text;
}
