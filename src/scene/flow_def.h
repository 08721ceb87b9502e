/* Definitions of sources and sinks of particles. */
#ifndef GN_SCENE_FLOW_DEF_H
#define GN_SCENE_FLOW_DEF_H

#include "scene/place.h"
#include "scene/size_def.h"
#include "scene/values.h"

/* A region of space: exactly one of rectangle, disc, polygon (2D), box, cylinder (3D). */
typedef struct gn_flow_region {
    bool has_rectangle, has_disc, has_box, has_cylinder;
    double size[3];   /* m, rectangle (two sides) and box */
    double diameter;  /* m, disc and cylinder */
    double height;    /* m, cylinder */
    double origin[3]; /* m, see the shapes of a specimen; 0 with a polygon */
    size_t corner_count;
    double *corners; /* polygon corners, [corner_count][2], m */
} gn_flow_region;

/* A source creates particles at a rate, the first one at `start`. */
typedef struct gn_source_def {
    char name[GN_NAME_SIZE], material[GN_NAME_SIZE];
    gn_flow_region region;  /* region of the particles' centres */
    double rate, mass_rate; /* 1/s, kg/s; one of the two is 0 */
    double start, end;      /* s; end 0: the source does not end */
    int64_t total;          /* 0: no limit */
    double mean_radius;     /* m, mean by number */
    gn_pack_sizes sizes;    /* not GN_SIZES_FITTED */
    double size_ratio;      /* largest over smallest */
    double size_variation;  /* normal: standard deviation over the mean; -1: automatic */
    size_t sieve_count;
    double *sieve;      /* [sieve_count][2]: size over the largest, share of the mass that passes */
    double velocity[3]; /* m/s */
    double random_velocity; /* m/s: components uniform in +- this are added */
    gn_scene_place where;
} gn_source_def;

/* A sink removes particles that are entirely inside a region or beyond a plane. */
typedef struct gn_sink_def {
    char name[GN_NAME_SIZE];
    bool has_plane;
    double point[3], normal[3]; /* m; outward, a unit vector once read */
    gn_flow_region region;
    bool remove; /* false: particles stay, and centres that cross the plane are counted, less those
                    that return */
    gn_scene_place where;
} gn_sink_def;

#endif
